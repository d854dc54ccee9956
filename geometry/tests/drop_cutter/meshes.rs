//! Meshes to test with.

use carvegraph_geometry::{DVec2, DVec3, Mesh};
use fastrand::Rng;
use std::sync::Arc;

pub fn mesh(corners: impl IntoIterator<Item = [DVec3; 3]>) -> Mesh {
    let vertices: Vec<_> = corners.into_iter().flatten().collect();
    let triangles = (0..vertices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh { vertices: Arc::new(vertices), triangles }
}

/// The surface z(x, y) over a grid of nodes, two triangles a cell.
pub fn sheet(columns: u32, rows: u32, pitch: f64, z: impl Fn(f64, f64) -> f64) -> Mesh {
    let node = |k: u32| {
        let (x, y) = (f64::from(k % columns) * pitch, f64::from(k / columns) * pitch);
        DVec3::new(x, y, z(x, y))
    };
    let cells = (0..rows - 1).flat_map(|j| (0..columns - 1).map(move |i| j * columns + i));
    Mesh {
        vertices: Arc::new((0..columns * rows).map(node).collect()),
        triangles: cells
            .flat_map(|k| [[k, k + 1, k + columns + 1], [k, k + columns + 1, k + columns]])
            .collect(),
    }
}

/// Kinds of soup. The last three have slopes without bound.
pub const SOUPS: [&str; 8] =
    ["mixed sizes", "small", "shared", "level", "upright", "degenerate", "needles", "steep"];

fn point(random: &mut Rng, size: DVec3) -> DVec3 {
    DVec3::new(random.f64(), random.f64(), random.f64()) * size
}

/// Triangles without order in a box of 10 × 10 × 4 mm about `middle`.
pub fn soup(random: &mut Rng, kind: &str, count: usize, middle: DVec3) -> Mesh {
    let whole = DVec3::new(10.0, 10.0, 4.0);
    if kind == "shared" {
        let vertices: Vec<_> = (0..count / 2 + 3).map(|_| middle + point(random, whole)).collect();
        let any = |random: &mut Rng| random.u32(..vertices.len() as u32);
        let triangles = (0..count).map(|_| [any(random), any(random), any(random)]).collect();
        return Mesh { vertices: Arc::new(vertices), triangles };
    }
    mesh((0..count).map(|_| {
        let a = middle + point(random, whole);
        let size = match kind {
            "small" => 0.2,
            _ => [0.01, 0.3, 2.0, 8.0][random.usize(..4)],
        };
        let way = |random: &mut Rng| (point(random, DVec3::ONE) - 0.5) * size;
        let (mut b, mut c) = (way(random), way(random));
        match kind {
            "level" => (b.z, c.z) = (0.0, 0.0),
            "upright" if random.bool() => c = DVec3::new(b.x * 2.0, b.y * 2.0, c.z),
            "upright" => c = DVec3::new(0.0, 0.0, c.z),
            "degenerate" if random.bool() => c = b,
            "degenerate" if random.bool() => (b, c) = (DVec3::ZERO, DVec3::ZERO),
            "degenerate" => c = b * 0.25,
            "needles" => c = b * 0.7 + way(random) * 10_f64.powi(-random.i32(2..12)),
            "steep" => {
                let thin = 10_f64.powi(-random.i32(2..12));
                c = DVec3::new(b.x, b.y, 0.0) * 1.3 + DVec3::new(thin, -thin, c.z);
            }
            _ => {}
        }
        let mut corners = [a, a + b, a + c];
        random.shuffle(&mut corners);
        corners
    }))
}

/// A binary STL, as it is, without shared vertices.
pub fn binary_stl(bytes: &[u8]) -> Mesh {
    let number = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
    let corner = |at: usize| DVec3::new(number(at), number(at + 4), number(at + 8));
    let triangle = |record: usize| [12, 24, 36].map(|k| corner(84 + 50 * record + k));
    mesh((0..(bytes.len() - 84) / 50).map(triangle))
}

/// The bust's points and strips, as its header describes them.
pub fn igea(bytes: &[u8]) -> Mesh {
    const VERTICES: usize = 134_345;
    let head = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let word = |at: usize| bytes[head + 4 * at..head + 4 * at + 4].try_into().unwrap();
    let number = |at: usize| f64::from(f32::from_le_bytes(word(at)));
    let vertices: Vec<_> = (0..VERTICES)
        .map(|v| DVec3::new(number(3 * v), number(3 * v + 1), number(3 * v + 2)) * 100.0)
        .collect();
    let count = i32::from_le_bytes(word(3 * VERTICES)) as usize;
    let strip: Vec<i32> = (1..=count).map(|k| i32::from_le_bytes(word(3 * VERTICES + k))).collect();
    let corners = strip.windows(3).filter_map(|w| {
        let [a, b, c] = [w[0], w[1], w[2]].map(|v| u32::try_from(v).ok());
        Some([a?, b?, c?])
    });
    Mesh { triangles: corners.collect(), vertices: Arc::new(vertices) }
}

/// Places over a mesh's box and a little around it.
pub fn places(random: &mut Rng, mesh: &Mesh, count: usize) -> Vec<DVec2> {
    let plan = || mesh.vertices.iter().map(|v| v.truncate());
    let low = plan().reduce(DVec2::min).unwrap();
    let size = plan().reduce(DVec2::max).unwrap() - low;
    (0..count).map(|_| low + (DVec2::new(random.f64(), random.f64()) * 1.1 - 0.05) * size).collect()
}

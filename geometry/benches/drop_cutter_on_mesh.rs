//! The drop cutter on meshes: bumpy ones of 10⁴ to 10⁷ triangles, and real ones if the folder of
//! `CARVE_DATA` (or `../../shared/data`) has them. Throughput is in cutter locations.

use carvegraph_geometry::{
    Bounds, DVec3, Mesh, Pattern, PointCloud, Profile, Raster, RasterStyle, drop_on_mesh,
    drop_on_points,
};
use divan::counter::ItemsCount;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

fn main() {
    divan::main();
}

/// Side of the bumpy mesh in mm: 676 × 676 cutter locations 0.3 mm apart.
const SIDE: f64 = 203.0;

/// Waves of many lengths, 0 to some 5 mm high.
fn height(x: f64, y: f64) -> f64 {
    let wave = |k: u32| {
        let (f, turn) = (0.03 * 2_f64.powi(k as i32), f64::from(k) * 1.3);
        let (u, v) = (x * turn.cos() + y * turn.sin(), y * turn.cos() - x * turn.sin());
        (u * f + turn).sin() * (v * f * 1.1).cos() * 0.6_f64.powi(k as i32)
    };
    1.5 * (0..8).map(wave).sum::<f64>()
}

/// About `count` triangles in an order that tells nothing.
fn bumpy(count: usize) -> Mesh {
    let nodes = (count as f64 / 2.0).sqrt() as usize + 1;
    let pitch = SIDE / (nodes - 1) as f64;
    let node = |k: usize| {
        // Not on a grid, so that nothing is gained by its being one.
        let jitter = |salt: usize| {
            ((k.wrapping_mul(2_654_435_761).wrapping_add(salt) >> 7) % 1000) as f64 / 2500.0 - 0.2
        };
        let (x, y) = ((k % nodes) as f64 + jitter(0), (k / nodes) as f64 + jitter(77_777));
        DVec3::new(x * pitch, y * pitch, height(x * pitch, y * pitch))
    };
    let cells = (nodes - 1) * (nodes - 1);
    // A prime greater than 10⁷: all cells in another order.
    let cell = |c: usize| {
        let c = c.wrapping_mul(15_485_863) % cells;
        (c / (nodes - 1) * nodes + c % (nodes - 1)) as u32
    };
    let n = nodes as u32;
    Mesh {
        vertices: Arc::new((0..nodes * nodes).into_par_iter().map(node).collect()),
        triangles: (0..cells)
            .into_par_iter()
            .map(cell)
            .flat_map_iter(|k| [[k, k + 1, k + n + 1], [k, k + n + 1, k + n]])
            .collect(),
    }
}

/// `count` × `count` places over the box of a mesh.
fn passes(mesh: &Mesh, count: u32) -> Pattern {
    let bounds = Bounds {
        min: mesh.vertices.iter().copied().reduce(DVec3::min).unwrap_or_default(),
        max: mesh.vertices.iter().copied().reduce(DVec3::max).unwrap_or_default(),
    };
    let step = bounds.size() / f64::from(count - 1) * (1.0 + 1e-12);
    let (stepover_mm, feed_step_mm) = (step.y, step.x);
    Raster { stepover_mm, feed_step_mm, direction_rad: 0.0, style: RasterStyle::Zigzag }
        .pattern(&bounds)
}

fn drop_on(bencher: divan::Bencher, mesh: &Mesh, count: u32, profile: Profile) {
    let pattern = passes(mesh, count);
    bencher
        .counter(ItemsCount::new(pattern.points.len()))
        .bench_local(|| drop_on_mesh(mesh, &profile, &pattern, 0.0, &|_| true));
}

fn ball() -> Profile {
    Profile::ball(3.0).expect("the radius is sound")
}

#[divan::bench(args = [10_000, 100_000, 1_000_000, 10_000_000], sample_count = 3)]
fn bumpy_ball(bencher: divan::Bencher, count: usize) {
    drop_on(bencher, &bumpy(count), 676, ball());
}

/// The index by itself.
#[divan::bench(args = [10_000, 100_000, 1_000_000, 10_000_000], sample_count = 3)]
fn bumpy_index(bencher: divan::Bencher, count: usize) {
    let (mesh, none) = (bumpy(count), Pattern { points: Vec::new(), spans: Vec::new() });
    bencher
        .counter(ItemsCount::new(mesh.triangles.len()))
        .bench_local(|| drop_on_mesh(&mesh, &ball(), &none, 0.0, &|_| true));
}

#[divan::bench(sample_count = 3)]
fn bumpy_flat(bencher: divan::Bencher) {
    drop_on(bencher, &bumpy(1_000_000), 676, Profile::flat(3.0).expect("the radius is sound"));
}

#[divan::bench(sample_count = 3)]
fn bumpy_bull_nose(bencher: divan::Bencher) {
    let bull = Profile::bull_nose(3.0, 1.0).expect("the radii are sound");
    drop_on(bencher, &bumpy(1_000_000), 676, bull);
}

#[divan::bench(args = [100_000, 1_000_000], sample_count = 3)]
fn bumpy_points(bencher: divan::Bencher, count: usize) {
    let mesh = bumpy(2 * count);
    let pattern = passes(&mesh, 676);
    let cloud = PointCloud { points: mesh.vertices, grid: None };
    bencher
        .counter(ItemsCount::new(pattern.points.len()))
        .bench_local(|| drop_on_points(&cloud, &ball(), &pattern, 0.0, &|_| true));
}

#[divan::bench(args = ["mount_rush 100", "mount_rush 676", "spider 100", "spider 676"], sample_count = 9)]
fn real(bencher: divan::Bencher, job: &str) {
    let (name, count) = job.split_once(' ').expect("a name and a count");
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data");
    let folder = std::env::var_os("CARVE_DATA").map_or(beside.into(), PathBuf::from);
    match std::fs::read(folder.join(name).with_extension("stl")) {
        Ok(bytes) => drop_on(bencher, &binary_stl(&bytes), count.parse().unwrap_or(100), ball()),
        Err(fault) => eprintln!("skipped: {name}.stl in {}: {fault}", folder.display()),
    }
}

/// A binary STL, as it is.
fn binary_stl(bytes: &[u8]) -> Mesh {
    let numbers = |record: &[u8]| -> Vec<f64> {
        let four = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        record[12..48].chunks(4).map(four).collect()
    };
    let corners = |n: Vec<f64>| [0, 3, 6].map(|k| DVec3::new(n[k], n[k + 1], n[k + 2]));
    let vertices: Vec<_> =
        bytes[84..].chunks_exact(50).flat_map(|record| corners(numbers(record))).collect();
    let triangles = (0..vertices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh { vertices: Arc::new(vertices), triangles }
}

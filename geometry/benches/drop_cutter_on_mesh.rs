//! The drop cutter on meshes: bumpy ones of 10⁴ to 10⁷ triangles, and real ones if the folder of
//! `CARVE_DATA` (or `../../shared/data`) has them. Words on the command line choose jobs.

#![allow(clippy::print_stdout, reason = "the figures are what this program is for")]

mod measure;

use carvegraph_geometry::{
    Bounds, DVec3, Mesh, Pattern, PointCloud, Profile, Raster, RasterStyle, Surface,
};
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

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

fn main() {
    let pools = measure::begin();
    for count in [10_000, 100_000, 1_000_000, 10_000_000] {
        let jobs = jobs(&format!("{count:e} bumpy"), count == 1_000_000);
        if !jobs.is_empty() {
            let mesh = bumpy(count);
            drop_all(&pools, &jobs, Surface::Mesh(&mesh), &passes(&mesh, 676));
        }
    }
    for count in [100_000, 1_000_000] {
        let jobs = jobs(&format!("{count:e} points"), false);
        if !jobs.is_empty() {
            let mesh = bumpy(2 * count);
            let pattern = passes(&mesh, 676);
            let cloud = PointCloud { points: mesh.vertices, grid: None };
            drop_all(&pools, &jobs, Surface::Points(&cloud), &pattern);
        }
    }
    for (name, count) in
        [("mount_rush", 100), ("mount_rush", 676), ("spider", 100), ("spider", 676)]
    {
        let jobs = jobs(&format!("{name} {count}"), count == 676);
        if let Some(mesh) = real(name).filter(|_| !jobs.is_empty()) {
            drop_all(&pools, &jobs, Surface::Mesh(&mesh), &passes(&mesh, count));
        }
    }
}

/// The jobs of a surface that are asked for: its ball, or every cutter.
fn jobs(surface: &str, all: bool) -> Vec<(String, Profile)> {
    let cutters = measure::cutters().into_iter().take(if all { usize::MAX } else { 1 });
    let jobs = cutters.map(|(cutter, profile)| (format!("{surface} {cutter}"), profile));
    jobs.filter(|(name, _)| measure::asked_for(name)).collect()
}

fn drop_all(
    pools: &measure::Pools,
    jobs: &[(String, Profile)],
    surface: Surface,
    pattern: &Pattern,
) {
    for (name, profile) in jobs {
        measure::row(pools, name, surface, pattern, profile);
    }
}

/// A mesh of the data folder.
fn real(name: &str) -> Option<Mesh> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data");
    let folder = std::env::var_os("CARVE_DATA").map_or(beside.into(), PathBuf::from);
    match std::fs::read(folder.join(name).with_extension("stl")) {
        Ok(bytes) => Some(binary_stl(&bytes)),
        Err(fault) => {
            eprintln!("skipped: {name}.stl in {}: {fault}", folder.display());
            None
        }
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

//! Drops a ball on a binary STL over its box, for comparison with other programs.
//!
//! `drop_on_stl MESH RADIUS COUNT THREADS [FILE]` lowers a ball of the radius, in mm, at COUNT × COUNT
//! places over the box of the mesh, says what the index and each location took, and writes the tips
//! into FILE: x, y, z as little-endian f64, NaN for z where nothing lies under the ball.

#![allow(clippy::print_stdout, reason = "the figures are what this program is for")]

use carvegraph_geometry::{
    ContactKind, DVec3, DropCutter, DropError, Mesh, Profile, Raster, RasterStyle, Surface,
    Toolpath,
};
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [mesh, radius, count, threads, rest @ ..] = &arguments[..] else {
        return Err("drop_on_stl MESH RADIUS COUNT THREADS [FILE]".into());
    };
    let mesh = binary_stl(&std::fs::read(mesh)?);
    let (ball, threads) = (Profile::ball(radius.parse()?)?, threads.parse()?);
    let count: u32 = count.parse()?;
    let bounds = mesh.bounds().ok_or("no triangles")?;
    // A hair more than a share, so that rounding adds no row.
    let step = bounds.size() / f64::from(count - 1) * (1.0 + 1e-12);
    let (stepover_mm, feed_step_mm, style) = (step.y, step.x, RasterStyle::Zigzag);
    let passes = Raster { stepover_mm, feed_step_mm, direction_rad: 0.0, style }.pattern(&bounds);

    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let (index_s, drop_s, path) = pool.install(|| -> Result<(f64, f64, Toolpath), DropError> {
        let begin = Instant::now();
        let cutter = DropCutter::new(Surface::Mesh(&mesh), &ball, 0.0, &|_| true)?;
        let index_s = begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        let path = cutter.path(&passes, 0.0, &|_| true).ok_or(DropError::Stopped)?;
        Ok((index_s, begin.elapsed().as_secs_f64(), path))
    })?;
    let (triangles, locations) = (mesh.triangles.len(), path.tips.len());
    let each_us = drop_s / locations as f64 * 1e6;
    println!("{triangles} triangles, {locations} locations");
    println!("index_s {index_s:.6}");
    println!("drop_s {drop_s:.6}");
    println!("each_us {each_us:.4}");
    if let Some(file) = rest.first() {
        std::fs::write(file, tips(&path))?;
    }
    Ok(())
}

fn tips(path: &Toolpath) -> Vec<u8> {
    let tip = |(tip, kind): (&DVec3, ContactKind)| {
        let z = if kind == ContactKind::None { f64::NAN } else { tip.z };
        [tip.x, tip.y, z].map(f64::to_le_bytes)
    };
    let kinds = path.contacts.iter().map(|contact| contact.kind);
    path.tips.iter().zip(kinds).flat_map(tip).flatten().collect()
}

/// Without shared vertices, which the drop cutter does not need.
fn binary_stl(bytes: &[u8]) -> Mesh {
    let number = |at: &[u8]| f64::from(f32::from_le_bytes([at[0], at[1], at[2], at[3]]));
    let corner = |at: &[u8]| DVec3::new(number(at), number(&at[4..]), number(&at[8..]));
    let records = bytes.get(84..).unwrap_or_default().chunks_exact(50);
    let vertices: Vec<_> = records.flat_map(|r| [12, 24, 36].map(|k| corner(&r[k..]))).collect();
    let triangles = (0..vertices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh { vertices: Arc::new(vertices), triangles }
}

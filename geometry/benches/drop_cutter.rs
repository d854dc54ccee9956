//! The drop cutter on photo-like reliefs, 676 × 676 cutter locations 0.3 mm apart at most. Words on the
//! command line choose jobs: `cargo bench -p carvegraph-geometry --bench drop_cutter -- 480x480`.
//!
//! Photographs as they are: `carve run relief --set image=photo.jpg --set surface=mesh --only drop
//! --report report.json` tells the `wall_s` of the node `drop`.

#![allow(clippy::print_stdout, reason = "the figures are what this program is for")]

mod measure;

use carvegraph_geometry::{Against, HeightField, Pattern, Raster, RasterStyle, Surface};
use rayon::prelude::*;

/// A number from 0 to 1 for each node of a lattice, always the same.
fn noise(x: i64, y: i64, octave: u64) -> f64 {
    let mut bits = (x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ (y as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F)
        ^ octave.wrapping_mul(0x1656_67B1_9E37_79F9);
    bits = (bits ^ (bits >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Noise between the nodes, softened.
fn smooth_noise(x: f64, y: f64, octave: u64) -> f64 {
    let (i, j) = (x.floor() as i64, y.floor() as i64);
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (s, t) = (ease(x - x.floor()), ease(y - y.floor()));
    let near = noise(i, j, octave) * (1.0 - s) + noise(i + 1, j, octave) * s;
    let far = noise(i, j + 1, octave) * (1.0 - s) + noise(i + 1, j + 1, octave) * s;
    near * (1.0 - t) + far * t
}

/// Heights 0 to 5 mm over 203 mm: octaves of noise, and the sharp outlines of a picture.
fn relief(columns: usize, rows: usize) -> HeightField {
    let longest = columns.max(rows) as f64;
    let height = |k: usize| {
        let (x, y) = ((k % columns) as f64 / longest, (k / columns) as f64 / longest);
        let mut sum = 0.0;
        for octave in 0..7 {
            let scale = f64::from(4 << octave);
            sum += smooth_noise(x * scale, y * scale, octave) / f64::from(1 << octave);
        }
        let outline = smooth_noise(x * 6.0, y * 6.0, 99) > 0.55;
        (1.7 * sum + if outline { 1.5 } else { 0.0 }).min(5.0) as f32
    };
    let heights = (0..columns * rows).into_par_iter().map(height).collect();
    HeightField::new(columns, rows, 203.0 / longest, heights).expect("the size is sound")
}

fn passes(field: &HeightField) -> Pattern {
    let (stepover_mm, feed_step_mm, style) = (0.3, 0.3, RasterStyle::Zigzag);
    let long = field.rows() > field.columns();
    let direction_rad = if long { std::f64::consts::FRAC_PI_2 } else { 0.0 };
    Raster { stepover_mm, feed_step_mm, direction_rad, style }.pattern(&field.bounds())
}

/// Columns, rows and what counts of the field.
const JOBS: [(usize, usize, Against); 5] = [
    (480, 480, Against::Mesh),
    (1104, 1392, Against::Mesh),
    (480, 480, Against::Points),
    (4000, 4000, Against::Points),
    (10_000, 10_000, Against::Points),
];

fn main() {
    let pools = measure::begin();
    for (columns, rows, against) in JOBS {
        let jobs = measure::cutters().into_iter().map(|(cutter, profile)| {
            (format!("{columns}x{rows} {against:?} {cutter}").to_lowercase(), profile)
        });
        // Finishing is done with balls: the others are shown where it matters.
        let jobs: Vec<_> = jobs
            .filter(|(name, _)| name.ends_with("s ball") || name.contains("mesh"))
            .filter(|(name, _)| measure::asked_for(name))
            .collect();
        if jobs.is_empty() {
            continue;
        }
        let field = relief(columns, rows);
        let pattern = passes(&field);
        for (name, profile) in jobs {
            measure::row(&pools, &name, Surface::Field(&field, against), &pattern, &profile);
        }
    }
}

//! Simulation of whole jobs on a relief of 203 × 203 mm, a finishing raster and the same reduced, with every
//! cutter; and the deviation of what is left from the relief. Words on the command line choose jobs.

#![allow(clippy::print_stdout, reason = "the figures are what this program is for")]

mod measure;

use carvegraph_geometry::{
    Against, Bounds, Cut, DVec2, DVec3, DropCutter, FieldGrid, HeightField, Motion, Move, MoveKind,
    Profile, Raster, RasterStyle, Stock, Surface, Target, Toolpath, deviation, reduce_chord,
    simulate,
};

/// Side of the relief in mm.
const SIDE: f64 = 203.0;

/// Waves of many lengths, some 5 mm high.
fn relief() -> HeightField {
    let nodes = 677;
    let pitch = SIDE / (nodes - 1) as f64;
    let height = |x: f64, y: f64| {
        let wave = |k: u32| {
            let (f, turn) = (0.03 * 2_f64.powi(k as i32), f64::from(k) * 1.3);
            let (u, v) = (x * turn.cos() + y * turn.sin(), y * turn.cos() - x * turn.sin());
            (u * f + turn).sin() * (v * f * 1.1).cos() * 0.55_f64.powi(k as i32)
        };
        2.5 + 1.2 * (0..7).map(wave).sum::<f64>()
    };
    let heights = (0..nodes * nodes)
        .map(|k| height((k % nodes) as f64 * pitch, (k / nodes) as f64 * pitch) as f32)
        .collect();
    HeightField::new(nodes, nodes, pitch, heights).expect("the relief is sound")
}

fn path(field: &HeightField, profile: &Profile) -> Toolpath {
    let raster = Raster {
        stepover_mm: 0.3,
        feed_step_mm: 0.3,
        direction_rad: 0.0,
        style: RasterStyle::Zigzag,
    };
    let bounds: Bounds = field.bounds();
    let cutter = DropCutter::new(Surface::Field(field, Against::Mesh), profile, 0.0, &|_| true);
    let cutter = cutter.expect("the relief is sound");
    cutter.path(&raster.pattern(&bounds), 0.0, &|_| true).expect("nobody stops it")
}

fn motion(path: &Toolpath) -> Motion {
    let line = |to: DVec3| Move { to, mm_per_min: 1000.0, kind: MoveKind::Line };
    let start = path.tips[0].with_z(20.0);
    Motion { start, moves: path.tips.iter().copied().map(line).collect(), arcs: Vec::new() }
}

fn main() {
    let field = relief();
    let pools = measure::begin_jobs("moves");
    for (name, profile) in measure::cutters() {
        for (pitch, reduced) in [(0.1, false), (0.05, false), (0.1, true)] {
            let name = format!("{name} {pitch}{}", if reduced { " reduced" } else { "" });
            if !measure::asked_for(&name) {
                continue;
            }
            let mut path = path(&field, &profile);
            if reduced {
                let less = reduce_chord(&path, 0.01, 0.001, &|_| true);
                path = less.expect("nobody stops it").0;
            }
            let motion = motion(&path);
            let stock = Stock {
                corner: DVec2::ZERO,
                grid: FieldGrid::over(field.bounds(), pitch),
                top_mm: field.bounds().max.z,
            };
            let cuts = [Cut { motion: &motion, profile: &profile }];
            measure::job(&pools, &name, motion.moves.len(), || {
                simulate(&stock, &cuts, &|_| true).expect("the moves are sound")
            });
            let made = simulate(&stock, &cuts, &|_| true).expect("the moves are sound");
            let target = Target::Field(&field, DVec2::ZERO);
            measure::job(
                &pools,
                &format!("  deviation of {name}"),
                made.surface.heights().len(),
                || {
                    deviation(&made.surface, DVec2::ZERO, target, 0.0, &|_| true)
                        .expect("it is sound")
                },
            );
        }
    }
}

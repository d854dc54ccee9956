//! How long it takes to tell how long a program takes: 676 passes of 676 moves, 0.3 mm each.

use carvegraph_geometry::{DVec3, Kinematics, Motion, Move, MoveKind, machining_time};
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

const PASSES: usize = 676;

/// A zigzag over hills, fed at 1500 mm/min.
fn relief() -> Motion {
    let point = |pass: usize, k: usize| {
        let along = if pass.is_multiple_of(2) { k } else { PASSES - 1 - k };
        let (x, y) = (0.3 * along as f64, 0.3 * pass as f64);
        DVec3::new(x, y, (0.21 * x).sin() + (1.7 * x + y).cos() * 0.3)
    };
    let tips = (0..PASSES).flat_map(|pass| (0..PASSES).map(move |k| point(pass, k)));
    let moves = tips.map(|to| Move { to, mm_per_min: 1500.0, kind: MoveKind::Line });
    Motion { start: DVec3::ZERO, moves: moves.collect(), arcs: vec![] }
}

#[divan::bench(args = [15, 1000])]
fn dense_passes(bencher: divan::Bencher, look_ahead: usize) {
    let motion = relief();
    let kinematics = Kinematics {
        feed_mm_per_min: [5000.0; 3],
        rapid_mm_per_min: [5000.0; 3],
        acceleration_mm_per_s2: [400.0, 400.0, 100.0],
        junction_deviation_mm: 0.02,
        look_ahead,
        lines_per_s: 400.0,
    };
    bencher
        .counter(ItemsCount::new(motion.moves.len()))
        .bench(|| machining_time(&motion, &kinematics, &|_| true));
}

//! Taking points out of the path of a whole plaque: 676 passes of 676 points, 457,000 in all, over ground as
//! a photograph's: hills, steps, and a grain of some hundredths of a millimetre.
//!
//! `cargo bench -p carvegraph-geometry --bench reduce`

use carvegraph_geometry::{
    Contact, DVec3, Reduction, Span, SpanKind, Toolpath, fit_arcs, reduce_chord, reduce_z_band,
};
use divan::Bencher;

fn main() {
    divan::main();
}

const SIDE: usize = 676;

fn plaque(grain_mm: f64) -> Toolpath {
    let mut random = fastrand::Rng::with_seed(1);
    let mut path = Toolpath::default();
    for row in 0..SIDE {
        let y = row as f64 * 0.3;
        for k in 0..SIDE {
            let x = 0.3 * if row % 2 == 0 { k } else { SIDE - 1 - k } as f64;
            let hills = (0.11 * x + 0.03 * y).sin() + 0.5 * (0.6 * x).sin() * (0.2 * y).cos();
            let step = if (x - 100.0).hypot(y - 100.0) < 60.0 { 1.0 } else { 0.0 };
            path.tips.push(DVec3::new(x, y, hills + step + grain_mm * random.f64()));
        }
        let points = row * SIDE..(row + 1) * SIDE;
        path.spans.push(Span { points, kind: SpanKind::Pass, joined: row > 0 });
    }
    path.contacts = vec![Contact::NONE; path.tips.len()];
    path
}

/// Grains in mm: a mesh, a smooth and a sharp photograph.
const GRAINS_MM: [f64; 3] = [0.0, 0.02, 0.1];

fn reduce(
    bencher: Bencher<'_, '_>,
    grain_mm: f64,
    reduce: impl Fn(&Toolpath) -> Option<(Toolpath, Reduction)> + Sync,
) {
    let path = plaque(grain_mm);
    bencher.counter(path.tips.len()).bench(|| reduce(&path));
}

#[divan::bench(args = GRAINS_MM)]
fn z_band(bencher: Bencher<'_, '_>, grain_mm: f64) {
    reduce(bencher, grain_mm, |path| reduce_z_band(path, 0.01, &|_| true));
}

#[divan::bench(args = GRAINS_MM)]
fn chord(bencher: Bencher<'_, '_>, grain_mm: f64) {
    reduce(bencher, grain_mm, |path| reduce_chord(path, 0.01, 0.0, &|_| true));
}

#[divan::bench(args = GRAINS_MM)]
fn arcs(bencher: Bencher<'_, '_>, grain_mm: f64) {
    reduce(bencher, grain_mm, |path| fit_arcs(path, 0.01, 0.0, &|_| true));
}

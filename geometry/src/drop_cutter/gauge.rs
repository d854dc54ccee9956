//! Quick tests, four at a time, of whether a height can reach up to a cutter.
//!
//! Lengths are relative to the cutter's radius R. A height that rises by t above the tip reaches
//! the cutter within a certain distance of the axis only: h⁻¹(t). For a ball that is
//! √(t·(2 − t)), up to t = 1; no square root is needed to compare squares.

use super::shape::Shape;
use wide::f32x4;

/// Answers which of four heights can matter, as bits. See [`super::search::Probe::may_touch`].
pub(super) trait Gauge: Sync + Send {
    /// `x` and `y` are distances from the axis, not negative.
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32;
}

/// What a gauge says when blocks count as nearer along each axis by this much, / R.
pub(super) struct Nearer<G> {
    pub(super) by: f32x4,
    pub(super) gauge: G,
}

impl<G: Gauge> Gauge for Nearer<G> {
    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        let nearer = |d: f32x4| (d - self.by).fast_max(f32x4::ZERO);
        self.gauge.may_touch(nearer(x), nearer(y), rise)
    }
}

/// Squared distance within which a ball is reached by a rise.
#[inline]
pub(super) fn ball_reach2(rise: f32x4) -> f32x4 {
    let t = rise.fast_min(f32x4::ONE);
    t * (f32x4::splat(2.0) - t)
}

/// A ball nose.
#[derive(Clone, Copy)]
pub(super) struct BallGauge;

impl Gauge for BallGauge {
    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        (x * x + y * y).simd_lt(ball_reach2(rise)).to_bitmask()
    }
}

/// A flat end mill.
pub(super) struct FlatGauge;

impl Gauge for FlatGauge {
    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        (rise.simd_gt(f32x4::ZERO) & (x * x + y * y).simd_lt(f32x4::ONE)).to_bitmask()
    }
}

/// Any cutter: h⁻¹ from a table.
pub(super) struct TableGauge {
    /// R / h(R), or 0 where h(R) is.
    per_height: f32,
    /// Squared distance reached by all rises of a bin; bin k begins at h(R)·(k / BINS)².
    reach2: Vec<f32>,
}

/// Enough that a bin is far smaller than the rises that matter near the tip.
const BINS: usize = 512;

/// Raises what a table says, for the rounding of the lookup.
pub(super) const ROUND_UP: f64 = 1.0 + 1e-5;

impl TableGauge {
    /// For a shape whose greatest height is `full_height`, in mm.
    pub(super) fn new(shape: &impl Shape, full_height: f64) -> Self {
        let radius = shape.radius();
        let reached = |k: usize| {
            let rise = full_height * ((k + 1) as f64 / BINS as f64).powi(2) * ROUND_UP;
            (greatest_radius(shape, rise) / radius).powi(2) * ROUND_UP
        };
        let per_height = if full_height > 0.0 { (radius / full_height) as f32 } else { 0.0 };
        Self { per_height, reach2: (0..BINS).map(|k| reached(k) as f32).collect() }
    }
}

/// The greatest r in mm with h(r) ≤ `rise`, rounded up.
fn greatest_radius(shape: &impl Shape, rise: f64) -> f64 {
    let (mut low, mut high) = (0.0, shape.radius());
    if shape.height(high * high) <= rise {
        return high;
    }
    // 60 halvings go from R to the last bit of it.
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if shape.height(middle * middle) <= rise { low = middle } else { high = middle }
    }
    high
}

impl Gauge for TableGauge {
    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        let d2 = x * x + y * y;
        let mut hits = (rise.simd_gt(f32x4::ZERO) & d2.simd_lt(f32x4::ONE)).to_bitmask();
        let (d2, bins) = (d2.to_array(), (rise * f32x4::splat(self.per_height)).sqrt());
        let bins = (bins * f32x4::splat(BINS as f32)).to_array();
        for k in 0..4 {
            // A bin beyond the table is as good as the whole radius.
            let reach2 = self.reach2.get(bins[k] as usize).copied().unwrap_or(2.0);
            if d2[k] >= reach2 {
                hits &= !(1 << k);
            }
        }
        hits
    }
}

//! A gauge for the nodes of a field's mesh, whose triangles may bulge up to a ball between them.
//!
//! Over a triangle the clearance c(x, y) = tip + h(r) − z is convex, and where all three nodes have
//! c ≥ g it is at least g − ½·h″·w², h″ the greatest second derivative of h over the triangle and
//! w² = ½q² the greatest mean of squared distances from a place in the triangle to the nodes,
//! weighted by that place. So a triangle matters only if one of its nodes has a clearance below
//!
//! gap(r) = ¼q²·(1 − (r + √2·q)²)^(−3/2),
//!
//! h″ being (1 − r²)^(−3/2) for a ball. With (r + w)² ≤ α·r² + β the gap is a convex function of r²
//! and lies below two chords.
//!
//! That holds for triangles whose nodes are all within √`near2`. Any other is touched, if at all,
//! at a distance of `far` or more, where the ball has risen by `least_rise`. So its highest node
//! rises by more, and is no farther from the contact than a pitch along either axis.
//!
//! # Limits
//! For corners of bull noses it does not pay: their slope grows without bound within a few pitches, so
//! that nearly all triangles are of the second kind. Other shapes are gauged by their highest nodes.

use super::gauge::{BallGauge, Gauge, Nearer, ROUND_UP, ball_reach2};
use wide::f32x4;

/// A ball nose against nodes whose triangles may bulge up to it between them.
pub(super) struct BulgeGauge {
    /// Offset and slope over r² of the chords.
    inner: (f32, f32),
    outer: (f32, f32),
    near2: f32,
    least_rise: f32,
    pitch: f32,
}

/// Least of 1 − α·r² − β: the gap grows without bound toward the rim. The first for which the chords
/// still rise less steeply than h is taken; less than the first costs more than it gains.
const LEAST_ROOM: [f64; 4] = [0.15, 0.2, 0.3, 0.4];

/// Where (r + w)² ≤ α·r² + β holds with equality: amid the range.
const TIGHT_AT: f64 = 0.5;

/// Slope of h over r² at the axis, ½, less rounding: the gap must not outgrow it, so that h − gap
/// rises with r and blocks can be judged by their nearest place.
const LEAST_SLOPE_OF_H: f64 = 0.49;

impl BulgeGauge {
    /// For a pitch relative to R; `None` if the cutter is too small for this to be of use.
    pub(super) fn new(pitch: f64) -> Option<Self> {
        LEAST_ROOM.into_iter().find_map(|room| Self::with_room(pitch, room))
    }

    fn with_room(pitch: f64, least_room: f64) -> Option<Self> {
        let w = std::f64::consts::SQRT_2 * pitch;
        let (alpha, beta) = (1.0 + w / TIGHT_AT, w * w + w * TIGHT_AT);
        let near2 = (1.0 - beta - least_room) / alpha;
        let far = near2.max(0.0).sqrt() - w;
        if far <= 0.0 {
            return None;
        }
        let gap = |r2: f64| 0.25 * pitch * pitch * (1.0 - alpha * r2 - beta).powf(-1.5);
        let chord = |from: f64, to: f64| {
            let slope = (gap(to) - gap(from)) / (to - from);
            (gap(from) - slope * from, slope)
        };
        let knot = 0.6 * near2;
        let (inner, outer) = (chord(0.0, knot), chord(knot, near2));
        let rounded = |(a, b): (f64, f64)| ((a + 1e-7) as f32, (b * ROUND_UP) as f32);
        (outer.1 < LEAST_SLOPE_OF_H).then(|| Self {
            inner: rounded(inner),
            outer: rounded(outer),
            near2: (near2 * ROUND_UP) as f32,
            least_rise: ((1.0 - (1.0 - far * far).sqrt()) / ROUND_UP) as f32,
            pitch: (pitch * ROUND_UP) as f32,
        })
    }
}

impl Gauge for BulgeGauge {
    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        let line = |(a, b): (f32, f32), d2| f32x4::splat(a) + f32x4::splat(b) * d2;
        let d2 = x * x + y * y;
        let gap = line(self.inner, d2).fast_max(line(self.outer, d2));
        let near = d2.simd_le(f32x4::splat(self.near2));
        let hits = (near & d2.simd_lt(ball_reach2(rise + gap))).to_bitmask();
        let high = rise.simd_gt(f32x4::splat(self.least_rise)).to_bitmask();
        if high == 0 {
            return hits;
        }
        hits | (high & Nearer { by: self.pitch, gauge: BallGauge }.may_touch(x, y, rise))
    }
}

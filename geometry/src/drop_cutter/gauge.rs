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

    /// Which of four tilted lids surely stay clear of the cutter, as bits. None is a right answer.
    #[inline]
    fn clears(&self, _lids: &Lids) -> u32 {
        0
    }
}

/// Four planes over rectangles, below which all of a surface lies there; / R.
pub(super) struct Lids {
    /// Middle of the rectangle, from the axis.
    pub(super) x: f32x4,
    pub(super) y: f32x4,
    /// From the middle of the rectangle to its sides.
    pub(super) half_x: f32x4,
    pub(super) half_y: f32x4,
    /// Height of the plane at the middle above the tip.
    pub(super) rise: f32x4,
    /// Slope of the plane.
    pub(super) slope_x: f32x4,
    pub(super) slope_y: f32x4,
}

/// What a gauge says when blocks count as nearer along each axis by this much, / R.
pub(super) struct Nearer<G> {
    pub(super) by: f32,
    pub(super) gauge: G,
}

impl<G: Gauge> Gauge for Nearer<G> {
    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        let nearer = |d: f32x4| (d - f32x4::splat(self.by)).fast_max(f32x4::ZERO);
        self.gauge.may_touch(nearer(x), nearer(y), rise)
    }
}

/// Squared distance within which a ball is reached by a rise.
#[inline]
fn ball_reach2(rise: f32x4) -> f32x4 {
    let t = rise.fast_min(f32x4::ONE);
    t * (f32x4::splat(2.0) - t)
}

/// A ball nose.
pub(super) struct BallGauge;

/// Lids whose middle is farther from the axis than the root of this, / R, are not asked for: the
/// ball's slope there, 3 and more, would multiply the rounding.
const TANGENT_WITHIN2: f32 = 0.9;

/// Allowance for f32 in the clearance under a tangent, as a share of its terms: a dozen roundings of
/// 6e-8, and of slopes up to 3.
const TANGENT_ROUNDING: f32 = 3e-6;

impl Gauge for BallGauge {
    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        (x * x + y * y).simd_lt(ball_reach2(rise)).to_bitmask()
    }

    /// By the ball's tangent plane at the middle of each rectangle, which lies below the ball: it
    /// comes nearest to the lid at a corner.
    #[inline]
    fn clears(&self, lids: &Lids) -> u32 {
        let d2 = lids.x * lids.x + lids.y * lids.y;
        let near = d2.simd_lt(f32x4::splat(TANGENT_WITHIN2));
        // Where it is not near the root is NaN, and so is no clearance.
        let root = (f32x4::ONE - d2).sqrt();
        let steep = f32x4::ONE / root;
        let nears_x = (lids.x * steep - lids.slope_x).abs() * lids.half_x;
        let nears_y = (lids.y * steep - lids.slope_y).abs() * lids.half_y;
        let nears = nears_x + nears_y;
        let clearance = (f32x4::ONE - root) - lids.rise - nears;
        let size = lids.half_x + lids.half_y;
        let terms = f32x4::ONE + lids.rise.abs() + nears + size + size;
        let clear = clearance.simd_ge(terms * f32x4::splat(TANGENT_ROUNDING));
        (near & clear).to_bitmask()
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
const ROUND_UP: f64 = 1.0 + 1e-5;

impl TableGauge {
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

/// A ball nose against nodes whose triangles may bulge up to it between them.
///
/// Over a triangle the clearance c(x, y) = tip + h(r) − z is convex, and where all three nodes have
/// c ≥ g it is at least g − ½·h″·w², h″ the greatest second derivative of h over the triangle and
/// w² = ½q² the greatest mean of squared distances from a place in the triangle to the nodes,
/// weighted by that place. So a triangle matters only if one of its nodes has a clearance below
///
/// gap(r) = ¼q²·(1 − (r + √2·q)²)^(−3/2),
///
/// h″ being (1 − r²)^(−3/2) for a ball. With (r + w)² ≤ α·r² + β the gap is a convex function of r²
/// and lies below two chords.
///
/// That holds for triangles whose nodes are all within √`near2`. Any other is touched, if at all,
/// at a distance of `far` or more, where the ball has risen by `least_rise`. So its highest node
/// rises by more, and is no farther from the contact than a pitch along either axis.
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

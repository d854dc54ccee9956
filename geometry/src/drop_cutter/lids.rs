//! Quick tests, four at a time, of whether tilted lids stay clear of a cutter.
//!
//! Below a lid, a plane over a rectangle, lies all of a surface there. A cutter that is convex lies
//! above each of its tangent planes, and a plane comes nearest to a lid at a corner: so what is between
//! the tangent plane at the middle of the rectangle and the lid is a clearance. Lengths are / R.

use super::gauge::{BallGauge, FlatGauge, Gauge, TableGauge};
use super::shape::Shape;
use wide::f32x4;

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

/// Answers how far lids stay clear of a cutter.
pub(super) trait LidGauge: Gauge {
    /// How far four lids stay clear at least, / R. Less, even −∞, is a right answer; what is less than 0
    /// may touch, and the least most likely does.
    fn clearance(&self, lids: &Lids) -> f32x4;
}

/// Lids whose middle is farther from the axis than the root of this, / R, are not asked for: the
/// ball's slope there, 3 and more, would multiply the rounding.
const TANGENT_WITHIN2: f32 = 0.9;

/// Allowance for f32 in the clearance under a tangent, as a share of its terms: a dozen roundings of
/// 6e-8, and of slopes up to 3.
const TANGENT_ROUNDING: f32 = 3e-6;

impl Lids {
    /// How far the lids lie below the plane that is `height` above the tip at their middles and slopes as
    /// given: it comes nearest to a lid at a corner. Where the plane is a tangent of a cutter that is
    /// convex, all of the cutter lies above.
    #[inline]
    fn below_tangent(&self, height: f32x4, slope_x: f32x4, slope_y: f32x4) -> f32x4 {
        let nears_x = (slope_x - self.slope_x).abs() * self.half_x;
        let nears_y = (slope_y - self.slope_y).abs() * self.half_y;
        let nears = nears_x + nears_y;
        let size = self.half_x + self.half_y;
        let terms = f32x4::ONE + self.rise.abs() + nears + size + size;
        height - self.rise - nears - terms * f32x4::splat(TANGENT_ROUNDING)
    }
}

impl LidGauge for BallGauge {
    #[inline]
    fn clearance(&self, lids: &Lids) -> f32x4 {
        let d2 = lids.x * lids.x + lids.y * lids.y;
        let near = d2.simd_lt(f32x4::splat(TANGENT_WITHIN2));
        // Where it is not near the root is NaN or small, and the answer is not taken.
        let root = (f32x4::ONE - d2).sqrt();
        let steep = f32x4::ONE / root;
        let clearance = lids.below_tangent(f32x4::ONE - root, lids.x * steep, lids.y * steep);
        near.select(clearance, f32x4::splat(f32::NEG_INFINITY))
    }
}

impl LidGauge for FlatGauge {
    /// Its floor is a plane as wide as can be.
    #[inline]
    fn clearance(&self, lids: &Lids) -> f32x4 {
        lids.below_tangent(f32x4::ZERO, f32x4::ZERO, f32x4::ZERO)
    }
}

/// Any cutter, with supports of it from a table.
pub(super) struct TangentGauge {
    table: TableGauge,
    /// Supports a + b·r of all of h, about as steep as h in each of [`PARTS`] parts of R, / R.
    tangents: Vec<[f32; 2]>,
}

/// Enough that a tangent is one for any place of its part: its slope is off by some 0.2 %.
const PARTS: usize = 512;

impl TangentGauge {
    /// For a shape whose greatest height is `full_height`, in mm.
    pub(super) fn new(shape: &impl Shape, full_height: f64) -> Self {
        let radius = shape.radius();
        let tangent = |k: usize| {
            let (a, b) = shape.tangent_of_hull((k as f64 + 0.5) * (radius / PARTS as f64));
            // The slope as stored, and a below by what that changes at the rim, and by what a search
            // rounds that multiplies with the slope.
            let slope = b as f32;
            let lost = (b - f64::from(slope)).abs()
                + f64::from(f32::EPSILON) * (a.abs() / radius)
                + f64::from(TANGENT_ROUNDING) * b;
            [(a / radius - lost) as f32, slope]
        };
        let tangents = (0..PARTS).map(tangent).collect();
        Self { table: TableGauge::new(shape, full_height), tangents }
    }
}

impl Gauge for TangentGauge {
    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        self.table.may_touch(x, y, rise)
    }
}

impl LidGauge for TangentGauge {
    #[inline]
    fn clearance(&self, lids: &Lids) -> f32x4 {
        let d = (lids.x * lids.x + lids.y * lids.y).sqrt();
        let parts = (d * f32x4::splat(PARTS as f32)).to_array();
        // Beyond the rim that at the rim is as good.
        let tangents = parts.map(|part| self.tangents[(part as usize).min(PARTS - 1)]);
        let a = f32x4::from(tangents.map(|[a, _]| a));
        let b = f32x4::from(tangents.map(|[_, b]| b));
        // Outward; no longer than 1, or the plane would not be a support. On the axis any way is.
        let per_d = f32x4::splat(1.0 - 1e-6) / d.fast_max(f32x4::splat(1e-9));
        let (slope_x, slope_y) = (b * lids.x * per_d, b * lids.y * per_d);
        lids.below_tangent(a + slope_x * lids.x + slope_y * lids.y, slope_x, slope_y)
    }
}

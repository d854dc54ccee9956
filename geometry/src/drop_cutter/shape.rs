//! What the drop cutter needs to know of a cutter's shape.

use super::best::{Best, Place};
use super::edge::Edge;
use super::facet::Facet;
use crate::profile::{Profile, Segment};
use glam::DVec2;

/// A cutter's shape, with its contacts in closed form or solved.
///
/// Every contact handed to [`Best::raise`] must be a point of the surface, given with the height of
/// the tip at which the cutter passes through it: then no answer can be too high, and it is exact if
/// every local maximum of the tip over a triangle or edge is among them.
pub(super) trait Shape: Sync + Send {
    /// R, in mm.
    fn radius(&self) -> f64;

    /// h at the squared distance `r2` from the axis, in mm; infinite beyond R.
    fn height(&self, r2: f64) -> f64;

    /// A line (a, b), b ≥ 0, below h: h ≥ a + b·r at all distances within `wide` of `r`. Of a convex
    /// shape it is the tangent at `r`; of any other, which has none, it is as steep as `slope` and as
    /// high as can be.
    fn support(&self, r: f64, wide: f64, slope: f64) -> (f64, f64);

    /// A line (a, b) that no place of h is below, b ≥ 0 and finite, about as steep as h at `r`.
    fn tangent_of_hull(&self, r: f64) -> (f64, f64);

    /// h, and the tangent's slope / r, at the squared distance `r2`; `None` where h has no tangent that
    /// lies below all of it.
    fn tangent(&self, r2: f64) -> Option<(f64, f64)>;

    /// How many layers [`Shape::touch_planes`] knows: a shape that is convex has one.
    fn layers(&self) -> usize {
        1
    }

    /// Where planes of the given squared slopes g² are touched, straight uphill: r / g, and what the tip
    /// is raised by there, g·r − h. What is greatest over a plane is on one of the layers. NaN gives NaN.
    fn touch_planes(&self, layer: usize, slope2: &[f64; 6]) -> [[f64; 6]; 2];

    /// Drops on the inside of a triangle. Returns the tip on the triangle's whole plane, in mm,
    /// which no contact with the triangle, its edges or vertices exceeds.
    fn drop_on_triangle(&self, triangle: &Facet, at: DVec2, best: &mut Best) -> f64;

    /// Drops on the inside of an edge; `node` is one of its ends.
    fn drop_on_edge(&self, edge: &Edge, at: DVec2, node: Place, best: &mut Best);
}

/// Supports are not steeper than this: near the rim their rounding grows with the slope without bound.
/// With this little it stays below 1e-13·R.
pub(super) const STEEPEST_SUPPORT: f64 = 16.0;

/// Shapes with kernels of their own.
pub(crate) enum ShapeKind {
    Ball,
    Flat,
    General,
}

impl ShapeKind {
    /// Upright segments after the last that goes outward touch nothing that its end does not.
    pub(crate) fn of(profile: &Profile) -> Self {
        let radius = profile.radius_mm();
        let outward = profile.pieces().filter(|(from, segment)| segment.to()[0] > from[0]);
        let mut outward = outward.map(|(_, segment)| *segment);
        match (outward.next(), outward.next()) {
            (Some(Segment::Arc { to, center }), None)
                if to == [radius; 2] && center == [0.0, radius] =>
            {
                Self::Ball
            }
            (Some(Segment::Line { to }), None) if to[1] == 0.0 => Self::Flat,
            _ => Self::General,
        }
    }
}

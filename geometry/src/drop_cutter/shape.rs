//! What the drop cutter needs to know of a cutter's shape, and a shape of the inside of triangles.

use super::best::{Best, Place};
use super::edge::Edge;
use crate::profile::{Profile, Segment};
use glam::{DVec2, DVec3};

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

    /// A slope of h at the squared distance `r2`, between its slopes inward and outward, if h is
    /// convex as a whole and the slope is finite.
    fn slope(&self, r2: f64) -> Option<f64>;

    /// Drops on the inside of a triangle. Returns the tip on the triangle's whole plane, in mm,
    /// which no contact with the triangle, its edges or vertices exceeds.
    fn drop_on_triangle(&self, triangle: &impl Facet, at: DVec2, best: &mut Best) -> f64;

    /// Drops on the inside of an edge; `node` is one of its ends.
    fn drop_on_edge(&self, edge: &Edge, at: DVec2, node: Place, best: &mut Best);
}

/// A triangle that is a part of a plane with a slope. Places are told from the axis, in mm.
pub(super) trait Facet {
    /// Where the index has it.
    fn place(&self) -> Place;

    /// Slope of the plane.
    fn slope(&self) -> DVec2;

    /// Height of the plane at the axis, in mm. Where it cannot be told to the last digits it is
    /// rounded up by enough that no tip on the plane that follows from it is too low.
    fn height_at_axis(&self) -> f64;

    /// Whether a place of the plane lies in the triangle; its border counts.
    fn holds(&self, place: DVec2) -> bool;

    /// The point of the plane at a place; `at` is the axis.
    fn point(&self, at: DVec2, place: DVec2) -> DVec3;

    /// The tip at which a cutter touches the triangle at a place it holds, where the cutter is `h`
    /// above its tip. `on_plane` is what follows from the height at the axis.
    fn tip(&self, on_plane: f64, place: DVec2, h: f64) -> f64;
}

/// Shapes with kernels of their own.
pub(super) enum ShapeKind {
    Ball,
    Flat,
    General,
}

impl ShapeKind {
    /// Upright segments after the last that goes outward touch nothing that its end does not.
    pub(super) fn of(profile: &Profile) -> Self {
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

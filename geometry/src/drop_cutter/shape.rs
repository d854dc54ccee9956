//! What the drop cutter needs to know of a cutter's shape.

use super::best::Best;
use super::cell::{Edge, Triangle};
use glam::DVec2;

/// A cutter's shape, with its contacts in closed form or solved.
///
/// Every contact handed to [`Best::raise`] must be a point of the surface, given with the height of
/// the tip at which the cutter passes through it: then no answer can be too high, and it is exact if
/// every local maximum of the tip over a triangle or edge is among them.
pub(super) trait Shape: Sync {
    /// R, in mm.
    fn radius(&self) -> f64;

    /// h at the squared distance `r2` from the axis, in mm; infinite beyond R.
    fn height(&self, r2: f64) -> f64;

    /// A slope of h at the squared distance `r2`, between its slopes inward and outward, if h is
    /// convex as a whole and the slope is finite.
    fn slope(&self, r2: f64) -> Option<f64>;

    /// Drops on the inside of a triangle. Returns the tip on the triangle's whole plane, in mm,
    /// which no contact with the triangle, its edges or vertices exceeds.
    fn drop_on_triangle(&self, triangle: &Triangle, at: DVec2, best: &mut Best) -> f64;

    /// Drops on the inside of an edge; `node` is one of its ends.
    fn drop_on_edge(&self, edge: &Edge, at: DVec2, node: (usize, usize), best: &mut Best);
}

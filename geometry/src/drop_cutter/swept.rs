//! The drop cutter upside down: what a cutter leaves of the stock along a straight stroke of its tip.
//!
//! min over the stroke of z + h(r) is −max over it of (−z − h(r)), which is the drop of the same cutter on
//! the stroke as an edge with its sign turned, its ends as vertices.

use super::best::Best;
use super::edge::Edge;
use super::general::General;
use super::shape::Shape;
use crate::{ContactKind, Profile};
use glam::{DVec2, DVec3};

/// A cutter of any shape, to be swept along strokes.
pub(crate) struct Swept(General);

impl Swept {
    /// The cutter of a profile.
    pub(crate) fn new(profile: &Profile) -> Self {
        Self(General::new(profile))
    }

    /// The height in mm that is left above a node by a stroke `away` mm beside it; infinite if the cutter
    /// does not reach it. The stroke's `ends` are told by their way from the node along the stroke and their
    /// heights, in mm, the lesser way first.
    #[inline]
    pub(crate) fn height(&self, away: f64, ends: [(f64, f64); 2]) -> f64 {
        let mut best = Best::NONE;
        let corners = ends.map(|(way, z)| DVec3::new(way, away, -z));
        for corner in corners {
            let h = self.0.height(corner.truncate().length_squared());
            best.raise(corner.z - h, ContactKind::Vertex, (0, 0), || corner);
        }
        if let Some(edge) = Edge::between(corners[0], corners[1]) {
            self.0.drop_on_edge(&edge, DVec2::ZERO, (0, 0), &mut best);
        }
        -best.tip
    }
}

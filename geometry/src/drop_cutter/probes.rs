//! What is looked at around a node that the search could not rule out.

use super::best::Best;
use super::cell::{AROUND, Edge, Triangle};
use super::gauge::{Gauge, Nearer};
use super::search::{Ground, Probe};
use super::shape::Shape;
use crate::ContactKind;
use glam::DVec2;
use wide::f32x4;

/// The nodes by themselves.
pub(super) struct Vertices<'a, S, G> {
    pub(super) shape: &'a S,
    pub(super) gauge: G,
}

impl<S: Shape, G: Gauge> Probe for Vertices<'_, S, G> {
    #[inline]
    fn reach(&self) -> f64 {
        0.0
    }

    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        self.gauge.may_touch(x, y, rise)
    }

    #[inline]
    fn visit(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        drop_on_node(self.shape, ground, at, i, j, best);
    }
}

#[inline]
pub(super) fn drop_on_node(
    shape: &impl Shape,
    ground: &Ground,
    at: DVec2,
    i: usize,
    j: usize,
    best: &mut Best,
) {
    let node = DVec2::new(i as f64, j as f64) * ground.pitch;
    let z = ground.height(i, j);
    let tip = z - shape.height((node - at).length_squared());
    best.raise(tip, ContactKind::Vertex, (i, j), || node.extend(z));
}

/// Nodes with all that belongs to them: the six triangles and edges around.
///
/// A triangle matters only if its highest node is near enough: no place of it is farther from that
/// node than a pitch along either axis, which is the margin.
pub(super) struct Peaks<'a, S, G> {
    pub(super) shape: &'a S,
    pub(super) gauge: Nearer<G>,
    /// Pitch / R.
    pub(super) pitch: f64,
}

impl<S: Shape, G: Gauge> Probe for Peaks<'_, S, G> {
    #[inline]
    fn reach(&self) -> f64 {
        self.pitch
    }

    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        self.gauge.may_touch(x, y, rise)
    }

    fn visit(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        drop_on_node(self.shape, ground, at, i, j, best);
        let on_planes: [f64; 6] = std::array::from_fn(|k| {
            Triangle::around(ground, at, i, j, k).map_or(f64::NEG_INFINITY, |triangle| {
                self.shape.drop_on_triangle(&triangle, at, best)
            })
        });
        for (k, &(di, dj)) in AROUND.iter().enumerate() {
            // An edge lies in two planes and is never higher than the lower of them; at the border
            // it lies in one.
            let least = least_plane(on_planes[(k + 5) % 6], on_planes[k]);
            if least <= best.tip {
                continue;
            }
            let (i, j) =
                if k < 3 { (i, j) } else { (i.wrapping_add_signed(di), j.wrapping_add_signed(dj)) };
            let edge = Edge::new(ground, at, i, j, k % 3);
            self.shape.drop_on_edge(&edge, at, (i, j), best);
        }
    }
}

/// The lower of two tips, of which −∞ stands for a triangle beyond the border; −∞ where both do.
fn least_plane(a: f64, b: f64) -> f64 {
    if a == f64::NEG_INFINITY {
        b
    } else if b == f64::NEG_INFINITY {
        a
    } else {
        a.min(b)
    }
}

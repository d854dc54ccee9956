//! What is looked at around a node that the search could not rule out.

use super::best::Best;
use super::gauge::Gauge;
use super::search::{Ground, Probe};
use super::shape::Shape;
use crate::ContactKind;
use glam::DVec2;
use wide::f32x4;

/// The nodes by themselves.
pub(super) struct Vertices<S, G> {
    pub(super) shape: S,
    pub(super) gauge: G,
}

impl<S: Shape, G: Gauge> Probe for Vertices<S, G> {
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
        drop_on_node(&self.shape, ground, at, i, j, best);
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

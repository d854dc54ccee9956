//! What is looked at around a node that the search could not rule out.

use super::best::Best;
use super::cell::{ALL_EDGES, AROUND, Triangle, edge_from, falling_edges, heights_around};
use super::gauge::{Gauge, Nearer};
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

/// Nodes with the triangles and edges around of which they are the highest.
///
/// A triangle matters only if its highest node does: no place of it is higher, or farther from that
/// node than a pitch along either axis.
pub(super) struct Peaks<S, G> {
    pub(super) shape: S,
    pub(super) gauge: Nearer<G>,
    /// Pitch / R.
    pub(super) pitch: f64,
}

impl<S: Shape, G: Gauge> Probe for Peaks<S, G> {
    #[inline]
    fn reach(&self) -> f64 {
        self.pitch
    }

    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        self.gauge.may_touch(x, y, rise)
    }

    fn visit(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        drop_on_node(&self.shape, ground, at, i, j, best);
        let (z, around) = (ground.height(i, j), heights_around(ground, i, j));
        let falls = self.falling_edges(ground, at, (i, j), z, &around, best);
        let mut lower = 0;
        for (k, &end) in around.iter().enumerate() {
            lower |= u32::from(end <= z) << k;
        }
        // Triangle k lies between edges k and k + 1.
        let following = |edges: u32| edges >> 1 | (edges & 1) << 5;
        let triangles = lower & following(lower) & (falls | following(falls));
        let mut on_planes = [f64::INFINITY; 6];
        for k in bits(triangles) {
            if let Some(triangle) = Triangle::around(ground, at, i, j, k) {
                on_planes[k] = self.shape.drop_on_triangle(&triangle, at, best);
            }
        }
        for k in bits(lower & falls) {
            // An edge lies in two planes and is not higher than either.
            if on_planes[(k + 5) % 6].min(on_planes[k]) <= best.tip {
                continue;
            }
            let (di, dj) = if k < 3 { (0, 0) } else { AROUND[k] };
            let first = (i.wrapping_add_signed(di), j.wrapping_add_signed(dj));
            let edge = edge_from(ground, at, first.0, first.1, k % 3);
            self.shape.drop_on_edge(&edge, at, (i, j), best);
        }
    }
}

impl<S: Shape, G> Peaks<S, G> {
    /// Bits of the edges along which the clearance can fall below 0: told by its tangent if the
    /// shape is convex, else all.
    fn falling_edges(
        &self,
        ground: &Ground,
        at: DVec2,
        (i, j): (usize, usize),
        z: f64,
        around: &[f64; 6],
        best: &Best,
    ) -> u32 {
        let out = DVec2::new(i as f64, j as f64) * ground.pitch - at;
        let r2 = out.length_squared();
        let Some(slope) = self.shape.slope(r2) else {
            return ALL_EDGES;
        };
        // On the axis level is a tangent of every convex shape.
        let climb = if r2 > 0.0 { out * (slope * ground.pitch / r2.sqrt()) } else { DVec2::ZERO };
        let clearance = best.tip - (z - self.shape.height(r2));
        falling_edges(z, around, climb, clearance)
    }
}

/// Numbers of the bits that are set.
fn bits(mut set: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let k = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (k < 32).then_some(k)
    })
}

//! What is looked at around a node that the search could not rule out.

use super::ball::Ball;
use super::best::Best;
use super::cell::{AROUND, Edge, Triangle};
use super::gauge::Gauge;
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
    fn margin(&self) -> f64 {
        0.0
    }

    #[inline]
    fn may_touch(&self, d2: f32x4, rise: f32x4) -> u32 {
        self.gauge.may_touch(d2, rise)
    }

    #[inline]
    fn visit(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        drop_on_node(self.shape, ground, at, i, j, best);
    }
}

#[inline]
fn drop_on_node(
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
    pub(super) gauge: G,
    /// Pitch / R.
    pub(super) pitch: f64,
}

impl<S: Shape, G: Gauge> Probe for Peaks<'_, S, G> {
    #[inline]
    fn reach(&self) -> f64 {
        self.pitch
    }

    #[inline]
    fn margin(&self) -> f64 {
        self.pitch
    }

    #[inline]
    fn may_touch(&self, d2: f32x4, rise: f32x4) -> u32 {
        self.gauge.may_touch(d2, rise)
    }

    fn visit(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        super::CNT[1].fetch_add(1, std::sync::atomic::Ordering::Relaxed);
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

/// Nodes and their triangles against a ball.
///
/// The clearance tip + h(r) − z is convex over each triangle, so it is nowhere less than its tangent
/// at a node: a triangle can only be touched if the clearance falls, along one of its two edges from
/// the node, by more than it is at the node.
pub(super) struct Around<'a, G> {
    pub(super) ball: &'a Ball,
    pub(super) gauge: G,
    /// See [`Probe::margin`].
    pub(super) margin: f64,
    /// Pitch / R.
    pub(super) pitch: f64,
}

impl<G: Gauge> Probe for Around<'_, G> {
    #[inline]
    fn reach(&self) -> f64 {
        self.pitch
    }

    #[inline]
    fn margin(&self) -> f64 {
        self.margin
    }

    #[inline]
    fn may_touch(&self, d2: f32x4, rise: f32x4) -> u32 {
        self.gauge.may_touch(d2, rise)
    }

    #[inline]
    fn visit(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        super::CNT[if self.margin > 0.0 { 1 } else { 0 }].fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let place = DVec2::new(i as f64, j as f64) * ground.pitch;
        let (out, z) = (place - at, ground.height(i, j));
        let inside = self.ball.radius * self.ball.radius - out.length_squared();
        // Beyond the rim, or on it, there is no tangent.
        let mut falls = ALL_EDGES;
        if inside >= 0.0 {
            let root = inside.sqrt();
            let tip = z - (self.ball.radius - root);
            best.raise(tip, ContactKind::Vertex, (i, j), || place.extend(z));
            if root > 0.0 {
                let climb = out * (ground.pitch / root);
                falls = falling_edges(ground, i, j, z, climb, best.tip - tip);
            }
        }
        if falls != 0 {
            self.visit_triangles(ground, at, (i, j), falls, best);
        }
    }

    #[inline]
    fn glance(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        drop_on_node(self.ball, ground, at, i, j, best);
    }
}

const ALL_EDGES: u32 = 0b11_1111;

/// Bits of the edges around node (i, j) along which the clearance's tangent falls below 0. `climb`
/// is the rise of h over a pitch along x and y.
#[inline]
fn falling_edges(ground: &Ground, i: usize, j: usize, z: f64, climb: DVec2, clearance: f64) -> u32 {
    let mut falls = 0;
    for (k, &(di, dj)) in AROUND.iter().enumerate() {
        let (i, j) = (i.wrapping_add_signed(di), j.wrapping_add_signed(dj));
        if i < ground.columns && j < ground.rows {
            let slope = climb.x * di as f64 + climb.y * dj as f64 + (z - ground.height(i, j));
            falls |= u32::from(clearance + slope < 0.0) << k;
        }
    }
    falls
}

impl<G> Around<'_, G> {
    #[inline(never)]
    fn visit_triangles(
        &self,
        ground: &Ground,
        at: DVec2,
        (i, j): (usize, usize),
        falls: u32,
        best: &mut Best,
    ) {
        for k in 0..6 {
            if falls & (1 << k | 1 << ((k + 1) % 6)) == 0 || !best.is_new(ground, i, j, k) {
                continue;
            }
            super::CNT[2].fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            if let Some(triangle) = Triangle::around(ground, at, i, j, k) {
                self.ball.drop_on_closed_triangle(ground, &triangle, at, best);
            }
        }
    }
}

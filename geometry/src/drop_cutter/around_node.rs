//! A ball on the six triangles around a node: the inner loop of finishing.
//!
//! The clearance c = tip + h(r) − z of a ball is convex over each triangle. So
//!
//! * it is nowhere less than its tangent at the node: a triangle can only be touched if the tangent
//!   falls, along one of its two edges from the node, by more than the clearance there;
//! * along an edge it falls so from the node, or nothing of the edge can be touched.
//!
//! All six planes are computed at once, without a branch, which is faster than to choose among them.
//! Of two neighbours around which all could be touched, what they share is tested once.
//!
//! Places of a triangle are told from the node: node + α·e + β·e′, e and e′ the two edges.

use super::ball::Ball;
use super::best::Best;
use super::cell::{ALL_EDGES, AROUND, falling_edges, heights_around};
use super::gauge::{BulgeGauge, Gauge};
use super::probes::drop_on_node;
use super::search::{Ground, Probe};
use crate::ContactKind;
use glam::DVec2;
use wide::f32x4;

/// Edges around a node, in pitches.
const EDGES: [DVec2; 6] = {
    let mut edges = [DVec2::ZERO; 6];
    let mut k = 0;
    while k < 6 {
        edges[k] = DVec2::new(AROUND[k].0 as f64, AROUND[k].1 as f64);
        k += 1;
    }
    edges
};

/// α = x · first + y · second, x and y a place in pitches from the node.
const ALPHA: [[f64; 6]; 2] = [[1.0, 1.0, 0.0, -1.0, -1.0, 0.0], [-1.0, 0.0, 1.0, 1.0, 0.0, -1.0]];

/// β, likewise.
const BETA: [[f64; 6]; 2] = [[0.0, -1.0, -1.0, 0.0, 1.0, 1.0], [1.0, 1.0, 0.0, -1.0, -1.0, 0.0]];

/// Probe for a ball against the mesh.
pub(super) struct AroundNode {
    pub(super) ball: Ball,
    pub(super) gauge: BulgeGauge,
    /// Pitch / R.
    pub(super) pitch: f64,
}

impl Probe for AroundNode {
    #[inline]
    fn reach(&self) -> f64 {
        self.pitch
    }

    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        self.gauge.may_touch(x, y, rise)
    }

    #[inline]
    fn visit(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        let place = DVec2::new(i as f64, j as f64) * ground.pitch;
        let (out, z) = (place - at, ground.height(i, j));
        let around = heights_around(ground, i, j);
        let inside = self.ball.radius * self.ball.radius - out.length_squared();
        // Beyond the rim, or on it, there is no tangent.
        let mut falls = ALL_EDGES;
        if inside >= 0.0 {
            let root = inside.sqrt();
            let tip = z - (self.ball.radius - root);
            best.raise(tip, ContactKind::Vertex, (i, j), || place.extend(z));
            if root > 0.0 {
                falls = falling_edges(z, &around, out * (ground.pitch / root), best.tip - tip);
            }
        }
        falls = not_done(falls, i, j, best);
        if falls != 0 {
            best.mark_done((i, j));
            let node = Node {
                ij: (i, j),
                at,
                out,
                z,
                around,
                pitch: ground.pitch,
                per_pitch: ground.per_pitch,
            };
            node.drop_on_star(self.ball.radius, falls, best);
        }
    }

    #[inline]
    fn glance(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        drop_on_node(&self.ball, ground, at, i, j, best);
    }
}

/// The edges in `falls` but those to nodes around which all was tested already: all that can be
/// touched where the clearance falls along an edge has both of its ends for corners.
#[inline]
fn not_done(falls: u32, i: usize, j: usize, best: &Best) -> u32 {
    let (mut left, mut edges) = (falls, falls);
    while edges != 0 {
        let k = edges.trailing_zeros() as usize;
        edges &= edges - 1;
        let (di, dj) = AROUND[k];
        // Beyond the border the number wraps and is no node's.
        let end = (i.wrapping_add_signed(di), j.wrapping_add_signed(dj));
        left &= !(u32::from(best.is_done(end)) << k);
    }
    left
}

/// Contacts of a ball with the planes of the triangles around a node; NaN beyond the border.
struct Planes {
    /// Height of the tip, in mm.
    tip: [f64; 6],
    /// Contact from the node, in mm.
    x: [f64; 6],
    y: [f64; 6],
    /// Least of α, β and 1 − α − β, times the pitch: not negative in the triangle.
    room: [f64; 6],
}

impl Planes {
    /// Bits of the planes on which the tip is not below `tip`; NaN counts.
    #[inline(always)]
    fn above(&self, tip: f64) -> u32 {
        let below = |k: usize| u32::from(self.tip[k] <= tip) << k;
        let below = below(0) | below(1) | below(2) | below(3) | below(4) | below(5);
        !below & ALL_EDGES
    }

    /// Bits of the planes whose contact lies in the triangle.
    #[inline(always)]
    fn held(&self) -> u32 {
        let held = |k: usize| u32::from(self.room[k] >= 0.0) << k;
        held(0) | held(1) | held(2) | held(3) | held(4) | held(5)
    }
}

/// A node and what is around it.
struct Node {
    ij: (usize, usize),
    /// The axis, in mm.
    at: DVec2,
    /// From the axis to the node, in mm.
    out: DVec2,
    z: f64,
    around: [f64; 6],
    pitch: f64,
    /// 1 / pitch.
    per_pitch: f64,
}

impl Node {
    /// Drops a ball on the triangles around, and on those edges from the node that are in `falls`.
    ///
    /// The edges across from the node are left to the visits of their own ends: an edge can only be
    /// touched if one of its two ends could not be ruled out.
    fn drop_on_star(&self, radius: f64, falls: u32, best: &mut Best) {
        let planes = self.planes(radius);
        let mut held = planes.above(best.tip) & planes.held();
        while held != 0 {
            let k = held.trailing_zeros() as usize;
            held &= held - 1;
            let (x, y) = (planes.x[k], planes.y[k]);
            best.raise(planes.tip[k], ContactKind::Facet, self.ij, || {
                let next = if k == 5 { 0 } else { k + 1 };
                let alpha = (ALPHA[0][k] * x + ALPHA[1][k] * y) * self.per_pitch;
                let beta = (BETA[0][k] * x + BETA[1][k] * y) * self.per_pitch;
                let rise = alpha * (self.around[k] - self.z) + beta * (self.around[next] - self.z);
                (self.at + self.out + DVec2::new(x, y)).extend(self.z + rise)
            });
        }
        // An edge lies in two planes and is not higher than either.
        let above = planes.above(best.tip);
        let mut edges = falls & above & (above << 1 | above >> 5);
        while edges != 0 {
            let k = edges.trailing_zeros() as usize;
            edges &= edges - 1;
            self.drop_on_edge(radius, k, best);
        }
    }

    /// The planes of the six triangles.
    #[inline(always)]
    fn planes(&self, radius: f64) -> Planes {
        let (z, n) = (self.z, &self.around);
        let across = [n[0] - z, n[1] - n[2], z - n[3], z - n[3], n[5] - n[4], n[0] - z];
        let along = [n[1] - n[0], n[2] - z, n[2] - z, n[3] - n[4], z - n[5], z - n[5]];
        let (mut tip, mut x, mut y, mut room) = ([0.0; 6], [0.0; 6], [0.0; 6], [0.0; 6]);
        for k in 0..6 {
            let (slope_x, slope_y) = (across[k] * self.per_pitch, along[k] * self.per_pitch);
            let steep = (1.0 + (slope_x * slope_x + slope_y * slope_y)).sqrt();
            let at_axis = z - (slope_x * self.out.x + slope_y * self.out.y);
            tip[k] = at_axis + radius * (steep - 1.0);
            let reach = radius / steep;
            (x[k], y[k]) = (slope_x * reach - self.out.x, slope_y * reach - self.out.y);
            let alpha = ALPHA[0][k] * x[k] + ALPHA[1][k] * y[k];
            let beta = BETA[0][k] * x[k] + BETA[1][k] * y[k];
            let rest = self.pitch - (alpha + beta);
            let least = if alpha < beta { alpha } else { beta };
            room[k] = if rest < least { rest } else { least };
        }
        Planes { tip, x, y, room }
    }

    /// Drops a ball on edge `k` from the node.
    #[inline]
    fn drop_on_edge(&self, radius: f64, k: usize, best: &mut Best) {
        let (from, z, rise) = (self.out, self.z, self.around[k] - self.z);
        let way = EDGES[k];
        // Everything in terms of t, the share of the edge, whose length in pitches is 1 or √2.
        let length = self.pitch * if k % 3 == 1 { std::f64::consts::SQRT_2 } else { 1.0 };
        let unit = way * (self.pitch / length);
        let (along, across) = (from.dot(unit), unit.perp_dot(from));
        let inside = radius * radius - across * across;
        if inside <= 0.0 {
            return;
        }
        let slope = rise / length;
        let (rho, steep) = (inside.sqrt(), (1.0 + slope * slope).sqrt());
        let way_along = rho * slope / steep - along;
        if way_along >= 0.0 && way_along <= length {
            let tip = (z - slope * along) + (rho * steep - radius);
            best.raise(tip, ContactKind::Edge, self.ij, || {
                (self.at + from + unit * way_along).extend(z + slope * way_along)
            });
        }
    }
}

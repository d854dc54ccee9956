//! A ball on the six triangles around a node: the inner loop of finishing.
//!
//! The clearance c = tip + h(r) − z of a ball is convex over each triangle. So
//!
//! * it is nowhere less than its tangent at the node: a triangle can only be touched if the tangent
//!   falls, along one of its two edges from the node, by more than the clearance there;
//! * it is least at the contact with the triangle's plane, and if that is outside, on an edge that
//!   it lies beyond.
//!
//! Places of a triangle are told from the node: node + α·e + β·e′, e and e′ the two edges.

use super::ball::Ball;
use super::best::Best;
use super::cell::{AROUND, TRIANGLES};
use super::gauge::{BulgeGauge, Gauge};
use super::probes::drop_on_node;
use super::search::{Ground, Probe};
use crate::ContactKind;
use glam::DVec2;
use wide::f32x4;

/// Bits of all edges.
const ALL_EDGES: u32 = 0b11_1111;

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

/// α = first · place, β = second · place, place in pitches from the node.
const SHARES: [[DVec2; 2]; 6] = {
    let (x, y, xy) = (DVec2::X, DVec2::Y, DVec2::new(1.0, -1.0));
    let (mx, my, yx) = (DVec2::NEG_X, DVec2::NEG_Y, DVec2::new(-1.0, 1.0));
    [[xy, y], [x, yx], [y, mx], [yx, my], [mx, xy], [my, x]]
};

/// Probe for a ball against the mesh.
pub(super) struct AroundNode<'a> {
    pub(super) ball: &'a Ball,
    pub(super) gauge: BulgeGauge,
    /// Pitch / R.
    pub(super) pitch: f64,
}

impl Probe for AroundNode<'_> {
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
        if falls != 0 {
            let node = Node {
                ij: (i, j),
                at,
                out,
                z,
                around,
                pitch: ground.pitch,
                per_pitch: ground.per_pitch,
            };
            node.drop_on_triangles(self.ball.radius, falls, best);
        }
    }

    #[inline]
    fn glance(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        drop_on_node(self.ball, ground, at, i, j, best);
    }
}

/// Heights at the other ends of the edges around a node; NaN beyond the border.
#[inline]
fn heights_around(ground: &Ground, i: usize, j: usize) -> [f64; 6] {
    let (columns, at) = (ground.columns, j * ground.columns + i);
    if i > 0 && j > 0 && i + 1 < columns && j + 1 < ground.rows {
        let h = |k: usize| f64::from(ground.heights[k]);
        let up = at + columns;
        let down = at - columns;
        return [h(at + 1), h(up + 1), h(up), h(at - 1), h(down - 1), h(down)];
    }
    AROUND.map(|(di, dj)| {
        let (i, j) = (i.wrapping_add_signed(di), j.wrapping_add_signed(dj));
        if i < columns && j < ground.rows { ground.height(i, j) } else { f64::NAN }
    })
}

/// Bits of the edges along which the clearance's tangent falls below 0. `climb` is the rise of h
/// over a pitch along x and y.
#[inline]
fn falling_edges(z: f64, around: &[f64; 6], climb: DVec2, clearance: f64) -> u32 {
    let base = clearance + z;
    let (x, y, xy) = (climb.x, climb.y, climb.x + climb.y);
    // NaN, beyond the border, does not fall.
    u32::from(base + x < around[0])
        | u32::from(base + xy < around[1]) << 1
        | u32::from(base + y < around[2]) << 2
        | u32::from(base - x < around[3]) << 3
        | u32::from(base - xy < around[4]) << 4
        | u32::from(base - y < around[5]) << 5
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
    /// Drops a ball on the triangles next to the edges in `falls`.
    fn drop_on_triangles(&self, radius: f64, falls: u32, best: &mut Best) {
        // Triangle k lies between edges k and k + 1.
        let mut triangles = falls | falls >> 1 | (falls & 1) << 5;
        while triangles != 0 {
            let k = triangles.trailing_zeros() as usize;
            triangles &= triangles - 1;
            let (di, dj, upper) = TRIANGLES[k];
            // Beyond the border the number wraps, and the heights are NaN.
            let cell = (self.ij.0.wrapping_add_signed(di), self.ij.1.wrapping_add_signed(dj));
            if best.is_new(cell, upper) {
                self.drop_on_triangle(radius, k, falls, best);
            }
        }
    }

    #[inline(always)]
    fn drop_on_triangle(&self, radius: f64, k: usize, falls: u32, best: &mut Best) {
        let next = if k == 5 { 0 } else { k + 1 };
        let [a, b] = SHARES[k];
        let (rise_a, rise_b) = (self.around[k] - self.z, self.around[next] - self.z);
        let (slope_x, slope_y) = (
            (a.x * rise_a + b.x * rise_b) * self.per_pitch,
            (a.y * rise_a + b.y * rise_b) * self.per_pitch,
        );
        let steep = (1.0 + (slope_x * slope_x + slope_y * slope_y)).sqrt();
        let at_axis = self.z - (slope_x * self.out.x + slope_y * self.out.y);
        let tip = at_axis + radius * (steep - 1.0);
        // Written so that NaN, beyond the border, is not above.
        if !(tip > best.tip) {
            return;
        }
        let reach = radius / steep;
        let (x, y) = (slope_x * reach - self.out.x, slope_y * reach - self.out.y);
        let (alpha, beta) = (a.x * x + a.y * y, b.x * x + b.y * y);
        if alpha >= 0.0 && beta >= 0.0 && alpha + beta <= self.pitch {
            let z = self.z + (slope_x * x + slope_y * y);
            let point = || (self.at + self.out + DVec2::new(x, y)).extend(z);
            return best.raise(tip, ContactKind::Facet, self.ij, point);
        }
        if beta < 0.0 && falls & (1 << k) != 0 {
            self.drop_on_edge(radius, self.out, self.z, rise_a, k, best);
        }
        if alpha < 0.0 && falls & (1 << next) != 0 {
            self.drop_on_edge(radius, self.out, self.z, rise_b, next, best);
        }
        if alpha + beta > self.pitch {
            let from = self.out + EDGES[k] * self.pitch;
            let across = if next == 5 { 0 } else { next + 1 };
            self.drop_on_edge(radius, from, self.around[k], rise_b - rise_a, across, best);
        }
    }

    /// Drops a ball on the edge that goes from a node at `from` the way of [`EDGES`] `k`.
    #[inline]
    fn drop_on_edge(&self, radius: f64, from: DVec2, z: f64, rise: f64, k: usize, best: &mut Best) {
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

//! A cutter on the six triangles around a node: the inner loop of finishing.
//!
//! The clearance c = tip + h(r) − z of a convex cutter is convex over each triangle. So
//!
//! * it is nowhere less than its tangent at the node: a triangle can only be touched if the tangent
//!   falls, along one of its two edges from the node, by more than the clearance there;
//! * along an edge it falls so from the node, or nothing of the edge can be touched;
//! * nothing is touched of what lies under the cutter's tangent plane at the contact known so far.
//!
//! Where a cutter has no tangent, it is beyond its rim or not convex, a support that is below it all over
//! the triangles does the first two.
//!
//! All six planes are computed at once, without a branch, which is faster than to choose among them:
//! [`super::layer`] has them for profiles of any kind. Of two neighbours around which all could be
//! touched, what they share is tested once.
//!
//! Places of a triangle are told from the node: node + α·e + β·e′, e and e′ the two edges.

use super::best::Best;
use super::cell::{ALL_EDGES, AROUND, ends_above, heights_around};
use super::edge::Edge;
use super::gauge::Gauge;
use super::probes::drop_on_node;
use super::search::{Ground, Probe};
use super::shape::Shape;
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

/// Probe for a cutter against the mesh.
pub(super) struct AroundNode<S, G> {
    pub(super) shape: S,
    pub(super) gauge: G,
    /// Pitch / R.
    pub(super) pitch: f64,
}

impl<S: Shape, G: Gauge> Probe for AroundNode<S, G> {
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
        if best.done.has((i, j)) {
            return;
        }
        let place = DVec2::new(i as f64, j as f64) * ground.pitch;
        let (out, z) = (place - at, ground.height(i, j));
        let around = heights_around(ground, i, j);
        let mut falls = if let Some((h, climb)) = self.shape.tangent(out.length_squared()) {
            let tip = z - h;
            best.raise(tip, ContactKind::Vertex, (i, j), || place.extend(z));
            ends_above(&around, best.tip + h, out * (ground.pitch * climb))
        } else {
            drop_on_node(&self.shape, ground, at, i, j, best);
            self.above_support(ground, out, z, &around, best.tip)
        };
        // All that can be touched where the clearance falls along an edge has both of its ends for corners.
        falls &= !best.done.ends_around((i, j));
        if falls == 0 {
            return;
        }
        // What lies under the tangent at the contact is not touched.
        let (level, climb) = best.tangent(&self.shape, at);
        let base = level + climb.dot(out);
        let above = ends_above(&around, base, climb * ground.pitch);
        let above = if z > base { ALL_EDGES } else { above };
        if triangles_at(falls) & triangles_at(above) != 0 {
            falls &= above;
            best.done.mark((i, j));
            let node = Node {
                ij: (i, j),
                at,
                out,
                z,
                around,
                pitch: ground.pitch,
                per_pitch: ground.per_pitch,
            };
            node.drop_on_star(&self.shape, falls, best);
        }
    }

    #[inline]
    fn glance(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        let node = DVec2::new(i as f64, j as f64) * ground.pitch;
        if (node - at).length_squared() <= self.shape.radius() * self.shape.radius() {
            drop_on_node(&self.shape, ground, at, i, j, best);
        } else {
            // Itself it is not under the cutter, but what is around it may be.
            self.visit(ground, at, i, j, best);
        }
    }
}

impl<S: Shape, G> AroundNode<S, G> {
    /// Bits of the edges of which an end lies above a support of the shape that is about as steep as the
    /// surface outward: no others can be touched. `out` leads from the axis to the node.
    fn above_support(
        &self,
        ground: &Ground,
        out: DVec2,
        z: f64,
        around: &[f64; 6],
        tip: f64,
    ) -> u32 {
        let (r, wide) = (out.length(), std::f64::consts::SQRT_2 * ground.pitch);
        // On the axis any way is outward.
        let outward = if r > 0.0 { out / r } else { DVec2::X };
        let rise = DVec2::new(around[0] - around[3], around[2] - around[5]);
        // NaN, at the border, is as good as level.
        let slope = (outward.dot(rise) * 0.5 * ground.per_pitch).max(0.0);
        let (a, b) = self.shape.support(r, wide, slope);
        let base = tip + a + b * r;
        if z > base { ALL_EDGES } else { ends_above(around, base, outward * (b * ground.pitch)) }
    }
}

/// Bits of the triangles beside edges: triangle k lies between edges k and k + 1.
#[inline]
fn triangles_at(edges: u32) -> u32 {
    (edges | edges >> 1 | edges << 5) & ALL_EDGES
}

/// Contacts with the planes of the triangles around a node; NaN beyond the border.
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
    /// Drops a cutter on the triangles around, and on those edges from the node that are in `falls`.
    ///
    /// The edges across from the node are left to the visits of their own ends: an edge can only be
    /// touched if one of its two ends could not be ruled out.
    fn drop_on_star(&self, shape: &impl Shape, falls: u32, best: &mut Best) {
        let slopes = self.slopes();
        let mut planes = self.planes(shape.touch_planes(0, &slopes.squared()), &slopes);
        self.drop_on_planes(&planes, best);
        for layer in 1..shape.layers() {
            let others = self.planes(shape.touch_planes(layer, &slopes.squared()), &slopes);
            self.drop_on_planes(&others, best);
            for k in 0..6 {
                // NaN stays.
                planes.tip[k] =
                    if others.tip[k] > planes.tip[k] { others.tip[k] } else { planes.tip[k] };
            }
        }
        // An edge lies in two planes and is not higher than either.
        let above = planes.above(best.tip);
        let mut edges = falls & above & (above << 1 | above >> 5);
        while edges != 0 {
            let k = edges.trailing_zeros() as usize;
            edges &= edges - 1;
            self.drop_on_edge(shape, k, best);
        }
    }

    #[inline]
    fn drop_on_planes(&self, planes: &Planes, best: &mut Best) {
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
    }

    /// Slopes of the six triangles.
    #[inline(always)]
    fn slopes(&self) -> Slopes {
        let (z, n) = (self.z, &self.around);
        let x = [n[0] - z, n[1] - n[2], z - n[3], z - n[3], n[5] - n[4], n[0] - z];
        let y = [n[1] - n[0], n[2] - z, n[2] - z, n[3] - n[4], z - n[5], z - n[5]];
        Slopes { x: x.map(|rise| rise * self.per_pitch), y: y.map(|rise| rise * self.per_pitch) }
    }

    /// The planes of the six triangles, from where they are touched.
    #[inline(always)]
    fn planes(&self, [per_slope, raised]: [[f64; 6]; 2], slopes: &Slopes) -> Planes {
        let (mut tip, mut x, mut y, mut room) = ([0.0; 6], [0.0; 6], [0.0; 6], [0.0; 6]);
        for k in 0..6 {
            let (slope_x, slope_y) = (slopes.x[k], slopes.y[k]);
            let at_axis = self.z - (slope_x * self.out.x + slope_y * self.out.y);
            tip[k] = at_axis + raised[k];
            let reach = per_slope[k];
            (x[k], y[k]) = (slope_x * reach - self.out.x, slope_y * reach - self.out.y);
            let alpha = ALPHA[0][k] * x[k] + ALPHA[1][k] * y[k];
            let beta = BETA[0][k] * x[k] + BETA[1][k] * y[k];
            let rest = self.pitch - (alpha + beta);
            let least = if alpha < beta { alpha } else { beta };
            room[k] = if rest < least { rest } else { least };
        }
        Planes { tip, x, y, room }
    }

    /// Drops a cutter on edge `k` from the node.
    #[inline]
    fn drop_on_edge(&self, shape: &impl Shape, k: usize, best: &mut Best) {
        // Length in pitches 1 or √2.
        let length = self.pitch * if k % 3 == 1 { std::f64::consts::SQRT_2 } else { 1.0 };
        let unit = EDGES[k] * (self.pitch / length);
        let edge = Edge::new(self.out, self.z, unit, length, self.around[k] - self.z);
        shape.drop_on_edge(&edge, self.at, self.ij, best);
    }
}

/// Slopes of the triangles around a node.
struct Slopes {
    x: [f64; 6],
    y: [f64; 6],
}

impl Slopes {
    #[inline(always)]
    fn squared(&self) -> [f64; 6] {
        std::array::from_fn(|k| self.x[k] * self.x[k] + self.y[k] * self.y[k])
    }
}

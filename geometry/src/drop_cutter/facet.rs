//! A triangle that lies anywhere, seen from the axis of a cutter: facet, edges and vertices.
//!
//! Facets that point down count as those that point up: which side is out is not believed, and of a
//! closed solid the top is touched first anyway. Upright and degenerate triangles have no facet, but
//! edges and vertices; upright edges have vertices only.
//!
//! # Exactness
//! With slope a triangle's plane becomes ill-conditioned: of the height at the axis digits are lost.
//! So that height only rules triangles out, raised by what may be lost; the tip that counts is that of
//! a place between the corners, and is no further off than the triangle is high. What remains is that
//! of a surface of slope g the tip is exact for a place within some 1e-15·R of the one asked for.

use super::best::{Best, Place};
use super::edge::Edge;
use super::shape::Shape;
use crate::ContactKind;
use glam::{DVec2, DVec3};

/// Share of a plane's terms that rounding can take: four roundings of 1.1e-16 in the normal, as many
/// in what follows, doubled.
const LOST: f64 = 2e-15;

/// Edges of a touched facet are not looked at for the sake of fewer mm than this: a hundredth of
/// the exactness promised.
const NOT_WORTH_AN_EDGE: f64 = 1e-11;

/// A triangle as a part of a plane with a slope. Places are told from the axis, in mm.
pub(super) struct Facet {
    item: usize,
    /// First corner, from the axis.
    first: DVec3,
    /// From the first corner to the others.
    to_second: DVec3,
    to_third: DVec3,
    /// Twice the area in plan, with the sign of the winding.
    area2: f64,
    slope: DVec2,
    height_at_axis: f64,
    /// What `height_at_axis` was raised by.
    raised: f64,
}

impl Facet {
    /// `None` for an upright or degenerate triangle.
    #[inline]
    fn new(
        [first, second, third]: [DVec3; 3],
        normal: DVec3,
        item: usize,
        radius: f64,
    ) -> Option<Self> {
        let (to_second, to_third) = (second - first, third - first);
        let (area2, slope) = (normal.z, normal.truncate() / -normal.z);
        let narrow = (to_second.length_squared() * to_third.length_squared()).sqrt() / area2.abs();
        let far = first.x.abs() + first.y.abs() + radius;
        let steep = 1.0 + slope.x.abs() + slope.y.abs();
        let raised = LOST * (first.z.abs() + narrow * far * steep);
        let height_at_axis = first.z + raised - slope.dot(first.truncate());
        height_at_axis.is_finite().then_some(Self {
            item,
            first,
            to_second,
            to_third,
            area2,
            slope,
            height_at_axis,
            raised,
        })
    }

    /// Shares of the second and third corner in a place.
    #[inline]
    fn shares(&self, place: DVec2) -> (f64, f64) {
        let way = place - self.first.truncate();
        let second = way.perp_dot(self.to_third.truncate()) / self.area2;
        let third = self.to_second.truncate().perp_dot(way) / self.area2;
        (second, third)
    }

    #[inline]
    fn height(&self, place: DVec2) -> f64 {
        let (second, third) = self.shares(place);
        self.first.z + (second * self.to_second.z + third * self.to_third.z)
    }

    /// Where the index has it.
    #[inline]
    pub(super) fn place(&self) -> Place {
        (self.item, 0)
    }

    /// Slope of the plane.
    #[inline]
    pub(super) fn slope(&self) -> DVec2 {
        self.slope
    }

    /// Height of the plane at the axis, in mm, rounded up by enough that no tip on the plane that follows
    /// from it is too low.
    #[inline]
    pub(super) fn height_at_axis(&self) -> f64 {
        self.height_at_axis
    }

    /// Whether a place of the plane lies in the triangle; its border counts.
    #[inline]
    pub(super) fn holds(&self, place: DVec2) -> bool {
        let (second, third) = self.shares(place);
        second >= 0.0 && third >= 0.0 && second + third <= 1.0
    }

    /// The point of the plane at a place; `at` is the axis.
    #[inline]
    pub(super) fn point(&self, at: DVec2, place: DVec2) -> DVec3 {
        (at + place).extend(self.height(place))
    }

    /// The tip at which a cutter touches the triangle at a place it holds, where the cutter is `h` above
    /// its tip.
    #[inline]
    pub(super) fn tip(&self, place: DVec2, h: f64) -> f64 {
        self.height(place) - h
    }
}

/// Drops a shape on a triangle, item `item` of the index: its facet, edges and vertices.
#[inline]
pub(super) fn drop_on_triangle(
    shape: &impl Shape,
    corners: [DVec3; 3],
    item: usize,
    at: DVec2,
    best: &mut Best,
) {
    let seen = corners.map(|corner| corner - at.extend(0.0));
    let (level, climb) = best.tangent(shape, at);
    if seen.iter().all(|corner| corner.z <= level + climb.dot(corner.truncate())) {
        return;
    }
    let normal = (seen[1] - seen[0]).cross(seen[2] - seen[0]);
    let high = above_support(shape, &seen, normal, best.tip);
    if high == [false; 3] {
        return;
    }
    if let Some(facet) = Facet::new(seen, normal, item, shape.radius()) {
        let on_plane = shape.drop_on_triangle(&facet, at, best);
        // If the facet itself is touched, its edges are not higher but by what was rounded up.
        if on_plane - (2.0 * facet.raised).min(NOT_WORTH_AN_EDGE) <= best.tip {
            return;
        }
    }
    for k in (0..3).filter(|&k| high[k]) {
        let (corner, r2) = (corners[k], seen[k].truncate().length_squared());
        best.raise(corner.z - shape.height(r2), ContactKind::Vertex, (item, 0), || corner);
    }
    for (k, next) in [(0, 1), (1, 2), (2, 0)] {
        // The cutter is nowhere lower than its tip.
        let may_touch = (high[k] || high[next]) && seen[k].z.max(seen[next].z) > best.tip;
        if may_touch && let Some(edge) = Edge::between(seen[k], seen[next]) {
            shape.drop_on_edge(&edge, at, (item, 0), best);
        }
    }
}

/// Which corners lie above a support of the shape at the height `tip`: what is between two that do
/// not stays clear.
#[inline]
fn above_support(shape: &impl Shape, corners: &[DVec3; 3], normal: DVec3, tip: f64) -> [bool; 3] {
    let plan = corners.map(|corner| corner.truncate());
    let middle = (plan[0] + plan[1] + plan[2]) / 3.0;
    let wide2 = plan.map(|corner| corner.distance_squared(middle));
    let (wide, r) = (wide2[0].max(wide2[1]).max(wide2[2]).sqrt(), middle.length());
    // On the axis any way is outward.
    let outward = if r > 0.0 { middle / r } else { DVec2::X };
    // NaN, of an upright triangle, is as good as level.
    let slope = (outward.dot(normal.truncate()) / -normal.z).max(0.0);
    let (a, b) = shape.support(r, wide, slope);
    let (base, climb) = (tip + a, outward * b);
    [0, 1, 2].map(|k| corners[k].z > base + climb.dot(plan[k]))
}

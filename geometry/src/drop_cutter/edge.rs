//! An edge of a surface, seen from the axis of a cutter.

use glam::{DVec2, DVec3};

/// An edge, seen from the axis: its line as z = foot_z + slope · s, s the way along it in plan from
/// the foot of the perpendicular from the axis.
pub(super) struct Edge {
    /// The ends' s, in mm; the first is less.
    pub(super) s: [f64; 2],
    /// Distance of the axis from the line in plan, squared, mm².
    pub(super) away2: f64,
    /// Height of the line at its foot, in mm.
    pub(super) foot_z: f64,
    /// Rise per mm along s.
    pub(super) slope: f64,
    /// From the axis to the first node.
    to_first: DVec2,
    direction: DVec2,
    z0: f64,
}

impl Edge {
    /// The edge from a point, given from the axis in plan, and its height `z0`, on the way of a
    /// unit vector.
    #[inline]
    pub(super) fn new(to_first: DVec2, z0: f64, direction: DVec2, length: f64, rise: f64) -> Self {
        let (along, across) = (to_first.dot(direction), direction.perp_dot(to_first));
        let slope = rise / length;
        Self {
            s: [along, along + length],
            away2: across * across,
            foot_z: z0 - slope * along,
            slope,
            to_first,
            direction,
            z0,
        }
    }

    /// The edge between two points, given from the axis; `None` if it stands upright, so that it
    /// is touched at an end only, or has no length.
    #[inline]
    pub(super) fn between(a: DVec3, b: DVec3) -> Option<Self> {
        let way = (b - a).truncate();
        let length = way.length();
        let edge = Self::new(a.truncate(), a.z, way / length, length, b.z - a.z);
        edge.slope.is_finite().then_some(edge)
    }

    /// The point of the line at `s`.
    #[inline]
    pub(super) fn point(&self, at: DVec2, s: f64) -> DVec3 {
        let way = s - self.s[0];
        (at + self.to_first + self.direction * way).extend(self.z0 + self.slope * way)
    }

    /// Whether `s` lies between the ends.
    #[inline]
    pub(super) fn holds(&self, s: f64) -> bool {
        self.s[0] <= s && s <= self.s[1]
    }
}

//! The moves that a machine makes with one cutter, lines and arcs, each at its speed.
//!
//! A [`crate::Toolpath`] is a path as it is planned, with its passes and contacts. A [`Motion`] is what is
//! left of it for a machine, or what a program says when it is read.

use crate::Bounds;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A sense of turning: of the spindle seen from above the work, of an arc seen against the axis
/// that stands on its plane.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Direction {
    /// As the hands of a clock: M3, G2.
    Clockwise,
    /// Against the hands of a clock: M4, G3.
    CounterClockwise,
}

/// The plane an arc lies in. First and second axis are named in their right-handed order.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Plane {
    /// Seen from +Z (G17).
    Xy,
    /// Seen from +Y (G18).
    Zx,
    /// Seen from +X (G19).
    Yz,
}

impl Plane {
    /// Indices into x, y, z of the plane's first axis, its second, and the one that stands on it.
    #[must_use]
    pub const fn axes(self) -> [usize; 3] {
        match self {
            Self::Xy => [0, 1, 2],
            Self::Zx => [2, 0, 1],
            Self::Yz => [1, 2, 0],
        }
    }
}

/// How an arc leads from one point to another: about an axis that stands on a plane, along it too if the
/// ends lie at different heights above the plane (a helix).
///
/// Exactly equal start and end in the plane mean one full turn. If the two are not equally far from the
/// centre the radius changes evenly with the angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathArc {
    /// The plane it lies in.
    pub plane: Plane,
    /// The way it turns.
    pub direction: Direction,
    /// Its centre in mm; the coordinate off the plane does not count.
    pub center: DVec3,
}

impl PathArc {
    /// The angle from `from` to `to`, in (0, 2π].
    #[must_use]
    pub fn sweep_rad(&self, from: DVec3, to: DVec3) -> f64 {
        let [first, second, _] = self.plane.axes();
        if from[first] == to[first] && from[second] == to[second] {
            return TAU;
        }
        let turn = match self.direction {
            Direction::Clockwise => self.angle(from) - self.angle(to),
            Direction::CounterClockwise => self.angle(to) - self.angle(from),
        };
        let turn = turn.rem_euclid(TAU);
        // The remainder of a tiny negative angle rounds to a whole turn.
        if turn == 0.0 { TAU } else { turn }
    }

    /// Distance of a point from the axis, in mm.
    #[must_use]
    pub fn radius_mm(&self, point: DVec3) -> f64 {
        let [first, second, _] = self.plane.axes();
        (point[first] - self.center[first]).hypot(point[second] - self.center[second])
    }

    /// The length of the arc in mm, by the mean of its radii.
    #[must_use]
    pub fn length_mm(&self, from: DVec3, to: DVec3) -> f64 {
        let [.., normal] = self.plane.axes();
        let radius = (self.radius_mm(from) + self.radius_mm(to)) / 2.0;
        (radius * self.sweep_rad(from, to)).hypot(to[normal] - from[normal])
    }

    /// The point after a share of the way, 0 to 1.
    #[must_use]
    pub fn point(&self, from: DVec3, to: DVec3, share: f64) -> DVec3 {
        let [first, second, normal] = self.plane.axes();
        let sweep = self.sweep_rad(from, to);
        let turn = if self.direction == Direction::Clockwise { -sweep } else { sweep };
        let angle = self.angle(from) + share * turn;
        let (start, end) = (self.radius_mm(from), self.radius_mm(to));
        let radius = start + share * (end - start);
        let mut point = DVec3::ZERO;
        point[first] = self.center[first] + radius * angle.cos();
        point[second] = self.center[second] + radius * angle.sin();
        point[normal] = from[normal] + share * (to[normal] - from[normal]);
        point
    }

    /// The ends of equal chords that stay within `tolerance_mm` of the arc, `to` last.
    pub fn chords(
        &self,
        from: DVec3,
        to: DVec3,
        tolerance_mm: f64,
    ) -> impl Iterator<Item = DVec3> + use<> {
        let arc = *self;
        let radius = arc.radius_mm(from).max(arc.radius_mm(to));
        // A chord of half angle a has the sagitta r (1 - cos a).
        let half = (1.0 - tolerance_mm / radius).clamp(-1.0, 1.0).acos().max(LEAST_HALF_CHORD_RAD);
        let count = (arc.sweep_rad(from, to) / (2.0 * half)).ceil().max(1.0) as usize;
        (1..=count).map(move |k| match k {
            _ if k == count => to,
            _ => arc.point(from, to, k as f64 / count as f64),
        })
    }

    /// The box around it, where it bulges beyond its ends too.
    #[must_use]
    pub fn bounds(&self, from: DVec3, to: DVec3) -> Bounds {
        let (sweep, start) = (self.sweep_rad(from, to), self.angle(from));
        let mut around = Bounds { min: from.min(to), max: from.max(to) };
        for quarter in 0..4 {
            let ahead = f64::from(quarter) * FRAC_PI_2 - start;
            let turn = if self.direction == Direction::Clockwise { -ahead } else { ahead };
            let turn = turn.rem_euclid(TAU);
            if turn < sweep {
                let place = self.point(from, to, turn / sweep);
                around = Bounds { min: around.min.min(place), max: around.max.max(place) };
            }
        }
        around
    }

    fn angle(&self, point: DVec3) -> f64 {
        let [first, second, _] = self.plane.axes();
        (point[second] - self.center[second]).atan2(point[first] - self.center[first])
    }
}

/// A full circle has no more than some 30,000 chords: finer ones are shorter than any controller's steps
/// on all that can be carved.
const LEAST_HALF_CHORD_RAD: f64 = 1e-4;

/// How a move leads to its end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum MoveKind {
    /// Travels without cutting, in a straight line.
    Rapid,
    /// Feeds in a straight line.
    Line,
    /// Feeds along an arc.
    Arc {
        /// Index into [`Motion::arcs`].
        arc: u32,
    },
}

/// A move from wherever the tip is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Move {
    /// Where the tip goes, in mm.
    pub to: DVec3,
    /// How fast, in mm/min; infinite where the machine goes as fast as it can.
    pub mm_per_min: f64,
    /// How.
    pub kind: MoveKind,
}

/// The moves of one cutter's tip, in order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Where the tip is before the first move, in mm.
    pub start: DVec3,
    /// The moves.
    pub moves: Vec<Move>,
    /// The arcs that moves refer to.
    pub arcs: Vec<PathArc>,
}

impl Motion {
    /// All moves, each with the point that it comes from.
    pub fn legs(&self) -> impl Iterator<Item = (DVec3, &Move)> {
        let starts = std::iter::once(self.start).chain(self.moves.iter().map(|m| m.to));
        starts.zip(&self.moves)
    }

    /// The arc of a move, if it is one.
    #[must_use]
    pub fn arc(&self, moved: &Move) -> Option<&PathArc> {
        match moved.kind {
            MoveKind::Arc { arc } => self.arcs.get(arc as usize),
            MoveKind::Rapid | MoveKind::Line => None,
        }
    }

    /// Length of a move in mm.
    #[must_use]
    pub fn leg_length_mm(&self, from: DVec3, moved: &Move) -> f64 {
        match self.arc(moved) {
            Some(arc) => arc.length_mm(from, moved.to),
            None => from.distance(moved.to),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const QUARTER: PathArc =
        PathArc { plane: Plane::Xy, direction: Direction::CounterClockwise, center: DVec3::ZERO };

    #[test]
    fn a_quarter_turn_is_three_the_other_way() {
        let (from, to) = (DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0));
        assert!((QUARTER.sweep_rad(from, to) - PI / 2.0).abs() < 1e-12);
        assert!((QUARTER.length_mm(from, to) - PI).abs() < 1e-12);
        let back = PathArc { direction: Direction::Clockwise, ..QUARTER };
        assert!((back.sweep_rad(from, to) - 1.5 * PI).abs() < 1e-12);
        assert_eq!(QUARTER.sweep_rad(from, from), TAU);
    }

    #[test]
    fn the_middle_of_a_helix_is_half_way_up() {
        for plane in [Plane::Xy, Plane::Zx, Plane::Yz] {
            let [first, second, normal] = plane.axes();
            let (mut from, mut to, mut middle) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
            (from[first], to[second], to[normal]) = (3.0, 3.0, 4.0);
            (middle[first], middle[second], middle[normal]) =
                (3.0 / 2_f64.sqrt(), 3.0 / 2_f64.sqrt(), 2.0);
            let arc = PathArc { plane, ..QUARTER };
            assert!(arc.point(from, to, 0.5).distance(middle) < 1e-12);
            assert!(arc.point(from, to, 1.0).distance(to) < 1e-12);
        }
    }

    #[test]
    fn chords_stay_within_their_tolerance_and_end_at_the_end() {
        let (from, to) = (DVec3::new(5.0, 0.0, 0.0), DVec3::new(-5.0, 0.0, 1.0));
        for tolerance in [1.0, 0.01, 1e-4] {
            let ends: Vec<DVec3> = QUARTER.chords(from, to, tolerance).collect();
            assert_eq!(ends.last(), Some(&to));
            let starts = std::iter::once(&from).chain(&ends);
            let worst = starts.zip(&ends).map(|(a, b)| {
                let middle = (*a + *b) / 2.0;
                5.0 - middle.truncate().length()
            });
            let worst = worst.fold(0.0, f64::max);
            assert!(worst <= tolerance && worst > tolerance / 8.0, "{worst} of {tolerance}");
        }
    }

    #[test]
    fn the_box_holds_what_bulges_and_no_more() {
        for plane in [Plane::Xy, Plane::Zx, Plane::Yz] {
            for direction in [Direction::Clockwise, Direction::CounterClockwise] {
                for (start, end) in [(0.2, 1.3), (0.2, 2.0), (1.3, 0.2), (6.0, 3.5), (3.0, 3.2)] {
                    let arc = PathArc { plane, direction, center: DVec3::new(1.0, -2.0, 3.0) };
                    let [first, second, normal] = plane.axes();
                    let [from, to] = [(start, 0.0), (end, 0.5)].map(|(angle, up): (f64, f64)| {
                        let mut point = arc.center;
                        point[first] += 4.0 * angle.cos();
                        point[second] += 4.0 * angle.sin();
                        point[normal] += up;
                        point
                    });
                    let places = (0..=4000).map(|k| arc.point(from, to, f64::from(k) / 4000.0));
                    let (mut min, mut max) = (from, from);
                    places.for_each(|place| (min, max) = (min.min(place), max.max(place)));
                    let around = arc.bounds(from, to);
                    assert!(around.min.distance(min) < 1e-4 && around.max.distance(max) < 1e-4);
                }
            }
        }
    }

    #[test]
    fn legs_know_where_they_come_from() {
        let (a, b) = (DVec3::X, DVec3::new(1.0, 4.0, 0.0));
        let line = |to| Move { to, mm_per_min: 100.0, kind: MoveKind::Line };
        let motion = Motion { start: DVec3::ZERO, moves: vec![line(a), line(b)], arcs: Vec::new() };
        let legs: Vec<(DVec3, DVec3)> = motion.legs().map(|(from, m)| (from, m.to)).collect();
        assert_eq!(legs, [(DVec3::ZERO, a), (a, b)]);
        let length: f64 = motion.legs().map(|(from, m)| motion.leg_length_mm(from, m)).sum();
        assert_eq!(length, 5.0);
    }
}

//! A straight piece of a motion with the limits that hold on it. Units: mm, s.

use super::Kinematics;
use crate::{Motion, Move, MoveKind};
use glam::DVec3;

/// How far a chord may lie off its arc: GRBL's $12 as it is shipped.
const ARC_TOLERANCE_MM: f64 = 0.002;

/// Cosines beyond this are taken for straight on, or for turning back, as in GRBL.
const STRAIGHT: f64 = 0.999_999;

/// What a block is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sort {
    Cut,
    Plunge,
    Rapid,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub(super) sort: Sort,
    /// Whether it is the first that comes of a line of the program.
    pub(super) begins_line: bool,
    pub(super) length: f64,
    /// The speed that is asked for, in mm/s.
    pub(super) asked: f64,
    /// The speed that the axes allow of it, in mm/s.
    pub(super) speed: f64,
    /// In mm/s².
    acceleration: f64,
    /// The square of the greatest speed at which it may be entered.
    pub(super) most_entry2: f64,
    direction: DVec3,
}

/// The straight pieces of a move: from, to, whether it is the first.
pub(super) fn pieces<'a>(
    motion: &'a Motion,
    from: DVec3,
    moved: &'a Move,
) -> impl Iterator<Item = (DVec3, DVec3, bool)> + use<'a> {
    let arc = motion.arc(moved);
    let chords = arc.map(|arc| arc.chords(from, moved.to, ARC_TOLERANCE_MM));
    let line = arc.is_none().then_some(moved.to);
    let mut at = from;
    let ends = chords.into_iter().flatten().chain(line).enumerate();
    ends.map(move |(index, to)| (std::mem::replace(&mut at, to), to, index == 0))
}

impl Block {
    /// `None` if it has no length. `before` is the block that it follows without a stop.
    pub(super) fn new(
        from: DVec3,
        to: DVec3,
        moved: &Move,
        kinematics: &Kinematics,
        before: Option<&Self>,
    ) -> Option<Self> {
        let along = to - from;
        let length = along.length();
        if length == 0.0 {
            return None;
        }
        let direction = along / length;
        let is_rapid = moved.kind == MoveKind::Rapid;
        let rates = if is_rapid { kinematics.rapid_mm_per_min } else { kinematics.feed_mm_per_min };
        let rate = within_axes(direction, rates) / 60.0;
        let asked =
            if is_rapid || moved.mm_per_min.is_infinite() { rate } else { moved.mm_per_min / 60.0 };
        let speed = asked.min(rate);
        let acceleration = within_axes(direction, kinematics.acceleration_mm_per_s2);
        let most_entry2 = before.map_or(0.0, |before| {
            let slower = before.speed.min(speed);
            corner2(before.direction, direction, kinematics).min(slower * slower)
        });
        let sort = match (is_rapid, direction == DVec3::NEG_Z) {
            (true, _) => Sort::Rapid,
            (false, true) => Sort::Plunge,
            (false, false) => Sort::Cut,
        };
        let begins_line = false;
        Some(Self { sort, begins_line, length, asked, speed, acceleration, most_entry2, direction })
    }

    /// What the square of the speed gains from one end to the other: 2ad.
    pub(super) fn gain2(&self) -> f64 {
        2.0 * self.acceleration * self.length
    }

    /// The time it takes from the entry's to the exit's speed, given by their squares: a trapezoid, or a
    /// triangle where it is too short to reach its speed.
    pub(super) fn seconds(&self, entry2: f64, exit2: f64) -> f64 {
        let Self { length, speed, acceleration, .. } = *self;
        if acceleration.is_infinite() {
            return length / speed;
        }
        let top2 = ((entry2 + exit2 + self.gain2()) / 2.0).min(speed * speed);
        let top = top2.sqrt();
        let ramps = (2.0 * top2 - entry2 - exit2) / (2.0 * acceleration);
        // Rounding may leave a triangle a flat top, above or below zero.
        let flat = (length - ramps).max(0.0);
        (2.0 * top - entry2.sqrt() - exit2.sqrt()) / acceleration + flat / top
    }
}

/// The most along a unit vector that keeps each axis within its own limit.
fn within_axes(direction: DVec3, limits: [f64; 3]) -> f64 {
    let share = direction.abs().to_array();
    let moving = share.into_iter().zip(limits).filter(|(share, _)| *share > 0.0);
    moving.map(|(share, limit)| limit / share).fold(f64::INFINITY, f64::min)
}

/// The square of the greatest speed for a corner.
fn corner2(before: DVec3, after: DVec3, kinematics: &Kinematics) -> f64 {
    // The angle between the sides as seen from the corner is half a turn where the way goes straight on.
    let cos_theta = -before.dot(after);
    if cos_theta > STRAIGHT {
        return 0.0;
    }
    let Some(inward) = (after - before).try_normalize().filter(|_| cos_theta >= -STRAIGHT) else {
        return f64::INFINITY;
    };
    let acceleration = within_axes(inward, kinematics.acceleration_mm_per_s2);
    let sin_half = (0.5 * (1.0 - cos_theta)).sqrt();
    acceleration * kinematics.junction_deviation_mm * sin_half / (1.0 - sin_half)
}

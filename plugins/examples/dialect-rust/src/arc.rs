//! Arcs, cut into what the control can be told.
//!
//! Each part ends on a rounded point, so parts are chosen that rounding cannot spoil: arcs of a quarter
//! turn at most, which it can neither turn around nor close, and lines where an arc would be tiny.

use crate::{Sheet, number};
use carvegraph_sdk::{Arc, Direction, Plane, PostError};
use std::f64::consts::{FRAC_PI_2, TAU};

/// An arc whose radii differ by more before rounding is not what anybody meant.
const RADIUS_TOLERANCE_MM: f64 = 0.001;

/// An arc with its ends nearer than this is a line, which departs from it by two steps at most.
const LEAST_CHORD_STEPS: f64 = 10.0;

/// Chords leave their arc by this much where the program does not say how much they may.
const CHORD_TOLERANCE_MM: f64 = 0.002;

/// More than any arc within the limits needs at a micrometre.
const MOST_CHORDS: f64 = 10_000.0;

impl Sheet<'_> {
    pub(crate) fn arc(&mut self, arc: &Arc) -> Result<(), PostError> {
        let mut from = self.cutting_from()?;
        let (meant, end, feed) =
            (self.meant, self.steps(arc.to)?, self.feed_steps(arc.mm_per_min)?);
        let [first, second, normal] = arc.plane.axes();
        let mut center = meant;
        [center[first], center[second]] = [arc.center[first], arc.center[second]];
        let middle = self.steps(center)?;
        let [u, v] = [meant[first] - center[first], meant[second] - center[second]];
        let [s, t] = [arc.to[first] - center[first], arc.to[second] - center[second]];
        let (start_mm, end_mm) = (u.hypot(v), s.hypot(t));
        if (start_mm - end_mm).abs() > RADIUS_TOLERANCE_MM {
            let limit_mm = RADIUS_TOLERANCE_MM;
            return Err(PostError::ArcRadius { command: self.index, start_mm, end_mm, limit_mm });
        }
        let turn = if arc.direction == Direction::Clockwise { -1.0 } else { 1.0 };
        let sweep = match turn * (u * t - v * s).atan2(u * s + v * t) {
            _ if [u, v] == [s, t] => TAU,
            angle if angle < 0.0 => angle + TAU,
            angle => angle,
        };
        let round =
            arc.plane == Plane::Xy && end[normal] == from[normal] && !self.program.lines_only;
        let piece = if round { FRAC_PI_2 } else { self.chord(start_mm) };
        let count = (sweep / piece).ceil().clamp(1.0, MOST_CHORDS) as u32;
        for k in 1..=count {
            let share = f64::from(k) / f64::from(count);
            let (sin, cos) = (turn * sweep * share).sin_cos();
            let mut next = meant;
            next[first] = center[first] + u * cos - v * sin;
            next[second] = center[second] + u * sin + v * cos;
            next[normal] += share * (arc.to[normal] - meant[normal]);
            let next = if k == count { end } else { self.steps(next)? };
            let [x, y] = [next[first] - from[first], next[second] - from[second]];
            if round && (x as f64).hypot(y as f64) >= LEAST_CHORD_STEPS {
                let [i, j] = [middle[0] - from[0], middle[1] - from[1]].map(number);
                let word = if turn < 0.0 { "G02" } else { "G03" };
                let rest = format!(" I{i} J{j}{}", self.feed_word(feed));
                self.at = Some(next);
                self.motion(word, next, [true, true, false], &rest)?;
            } else {
                self.straight(from, next, feed)?;
            }
            from = next;
        }
        self.meant = arc.to;
        Ok(())
    }

    /// The angle whose chord leaves a circle by no more than it may.
    fn chord(&self, radius_mm: f64) -> f64 {
        let given = self.program.path_tolerance_mm;
        let tolerance = if given > 0.0 { given } else { CHORD_TOLERANCE_MM };
        2.0 * (1.0 - tolerance / radius_mm).clamp(0.0, 1.0).acos()
    }
}

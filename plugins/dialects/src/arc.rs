//! Rounds an arc's end and centre together.
//!
//! A controller gets start and end in whole steps and the centre as whole steps from the start. Each
//! rounded alone, start and end may lie on different circles (arcs are rejected, GRBL: 0.005 mm), a
//! short arc may turn into a full circle and a full circle into nothing. Here start and end are
//! rounded as every point is, then:
//!
//! 1. What bulges from its chord by less than [`LEAST_BULGE_STEPS`], or is rounder than
//!    [`LEAST_RADIUS_STEPS`], is a line.
//! 2. What comes back to within [`CLOSED_STEPS`] of its start is a full circle, then a line to the
//!    end: rounding might have moved the end past the start.
//! 3. Otherwise the centre moves along the chord towards the bisector of the *rounded* start and end,
//!    where both radii are equal, and from there to the corner of its grid cell that is the best in
//!    radii and in place together. Up to half a circle the way may be long and the arc stays where
//!    it is, for its ends hold it; beyond, the far side moves with the centre, so it goes by
//!    [`FAR_SIDE_STEPS`] at most.
//!
//! The tests measure what is left, over radii from nothing to ten metres: the radii differ by less
//! than 1.25 steps, which is 0.0032 mm in a program in inches, and what is cut leaves the meant arc
//! by less than 2.75 steps.

use carvegraph_sdk::Direction;
use std::f64::consts::{PI, TAU};

/// Least bulge of an arc, in steps. A line in its place departs by little more than a written arc.
const LEAST_BULGE_STEPS: f64 = 2.0;

/// Least radius of an arc, in steps. LinuxCNC rejects radii below 0.00127 mm or 0.00005 in, GRBL
/// divides by zero at 0.001 mm. Rounding takes up to 1.7 steps away.
const LEAST_RADIUS_STEPS: f64 = 3.0;

/// Rounding moves start and end towards each other by at most √2 steps, which turns no arc around
/// whose ends are this far apart.
const CLOSED_STEPS: f64 = 4.0;

/// How far the centre of more than half a circle may move to make radii agree. One step suffices:
/// there, rounding parts the radii by at most √2 steps to begin with.
const FAR_SIDE_STEPS: f64 = 1.0;

/// A full turn of ten metres' radius to within a step takes 7,025 chords.
const MOST_CHORDS: u32 = 10_000;

/// An arc in its plane, in steps: as it is meant, and its start and end as they are written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneArc {
    pub(crate) meant_start: [f64; 2],
    pub(crate) meant_end: [f64; 2],
    pub(crate) center: [f64; 2],
    pub(crate) direction: Direction,
    pub(crate) start: [i64; 2],
    pub(crate) end: [i64; 2],
    /// What is rounder is a line, beside [`LEAST_RADIUS_STEPS`].
    pub(crate) least_radius: f64,
}

/// What to write for an arc, in steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Written {
    /// A line to its end.
    Line,
    /// An arc, and if `to` is not its end a line from there to its end.
    Arc {
        /// Where it ends; the start for a full circle.
        to: [i64; 2],
        /// From the start to the centre.
        offset: [i64; 2],
    },
}

impl PlaneArc {
    /// Distances of the meant start and end from the centre.
    pub(crate) fn radii(&self) -> [f64; 2] {
        [length(sub(self.meant_start, self.center)), length(sub(self.meant_end, self.center))]
    }

    /// The angle turned through, in (0, 2π]; 2π exactly where start and end are equal.
    pub(crate) fn sweep(&self) -> f64 {
        if self.meant_start == self.meant_end {
            return TAU;
        }
        let from = sub(self.meant_start, self.center);
        let to = sub(self.meant_end, self.center);
        let cross = from[0] * to[1] - from[1] * to[0];
        let angle = cross.atan2(from[0] * to[0] + from[1] * to[1]);
        let angle = if self.direction == Direction::Clockwise { -angle } else { angle };
        if angle < 0.0 { angle + TAU } else { angle }
    }

    /// The arc that is written, as the controller understands it; its start is at 0.
    pub(crate) fn understood(&self, to: [i64; 2], offset: [i64; 2]) -> Self {
        Self {
            meant_start: [0.0, 0.0],
            meant_end: [0, 1].map(|k| (to[k] - self.start[k]) as f64),
            center: offset.map(|o| o as f64),
            ..*self
        }
    }

    /// The point of the meant arc after a fraction of its sweep, in steps.
    pub(crate) fn point(&self, fraction: f64) -> [f64; 2] {
        let [start, end] = self.radii();
        let radius = start + fraction * (end - start);
        let turn =
            if self.direction == Direction::Clockwise { -self.sweep() } else { self.sweep() };
        let from = sub(self.meant_start, self.center);
        let angle = from[1].atan2(from[0]) + fraction * turn;
        [self.center[0] + radius * angle.cos(), self.center[1] + radius * angle.sin()]
    }

    /// How many equal chords of the meant arc stay within `tolerance` steps of it.
    pub(crate) fn chords(&self, tolerance: f64) -> u32 {
        let radius = self.radii()[0].max(self.radii()[1]);
        let half = (1.0 - tolerance / radius).clamp(0.0, 1.0).acos();
        (self.sweep() / (2.0 * half)).ceil().clamp(1.0, f64::from(MOST_CHORDS)) as u32
    }

    /// See the module's description.
    pub(crate) fn written(&self) -> Written {
        let [start_radius, end_radius] = self.radii();
        let radius = start_radius.min(end_radius);
        let sweep = self.sweep();
        let bulge = radius * (1.0 - (sweep / 2.0).cos());
        if radius < LEAST_RADIUS_STEPS.max(self.least_radius) || bulge < LEAST_BULGE_STEPS {
            return Written::Line;
        }
        let chord = [0, 1].map(|k| (self.end[k] - self.start[k]) as f64);
        let center = [0, 1].map(|k| self.center[k] - self.start[k] as f64);
        if sweep > PI && length(chord) < CLOSED_STEPS {
            return Written::Arc { to: self.start, offset: center.map(|c| c.round() as i64) };
        }
        let reach = if sweep > PI { FAR_SIDE_STEPS } else { f64::INFINITY };
        let center = towards_bisector(chord, center, reach);
        Written::Arc { to: self.end, offset: fairest_corner(chord, center) }
    }
}

/// Moves `center` along `chord`, at most by `reach`, to where 0 and `chord` are equally far.
fn towards_bisector(chord: [f64; 2], center: [f64; 2], reach: f64) -> [f64; 2] {
    let length = length(chord);
    let shift = (length / 2.0 - dot(center, chord) / length).clamp(-reach, reach);
    [0, 1].map(|k| center[k] + shift * chord[k] / length)
}

/// The corner of the grid cell around `center` whose distances to 0 and to `chord` differ least,
/// weighed against its distance from `center`, by which it takes the arc out of place.
fn fairest_corner(chord: [f64; 2], center: [f64; 2]) -> [i64; 2] {
    let low = center.map(f64::floor);
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let corners = corners.map(|c| [low[0] + c[0], low[1] + c[1]]);
    let fault = |c: [f64; 2]| (length(c) - length(sub(c, chord))).abs() + length(sub(c, center));
    let fairest = corners.into_iter().min_by(|a, b| fault(*a).total_cmp(&fault(*b)));
    fairest.unwrap_or(low).map(|c| c as i64)
}

fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn length(a: [f64; 2]) -> f64 {
    a[0].hypot(a[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use Direction::{Clockwise, CounterClockwise};

    fn arc(radius: f64, from: f64, sweep: f64, center: [f64; 2]) -> PlaneArc {
        let at = |angle: f64| [center[0] + radius * angle.cos(), center[1] + radius * angle.sin()];
        let direction = if sweep < 0.0 { Clockwise } else { CounterClockwise };
        let meant_start = at(from);
        let meant_end = if sweep.abs() == TAU { meant_start } else { at(from + sweep) };
        let [start, end] = [meant_start, meant_end].map(|p| p.map(|c| c.round() as i64));
        PlaneArc { meant_start, meant_end, center, direction, start, end, least_radius: 0.0 }
    }

    /// Farthest that the written arc, a spiral if its radii differ, lies off the meant circle.
    fn departure(arc: &PlaneArc, read: &PlaneArc) -> f64 {
        let ([start, end], sweep) = (read.radii(), read.sweep());
        let signed = if arc.direction == Clockwise { -sweep } else { sweep };
        let from = (-read.center[1]).atan2(-read.center[0]);
        let point = |t: f64| {
            let (radius, angle) = (start + t * (end - start), from + t * signed);
            let about = [radius * angle.cos(), radius * angle.sin()];
            [0, 1].map(|k| arc.start[k] as f64 + read.center[k] + about[k])
        };
        let off = |t: f64| (length(sub(point(t), arc.center)) - arc.radii()[0]).abs();
        (0..=16).map(|k| off(f64::from(k) / 16.0)).fold(0.0, f64::max)
    }

    /// 0.00127 mm, in steps.
    const LINUXCNC_LEAST_RADIUS: f64 = 1.27;

    /// All that is to hold for one arc; answers by how many steps the radii differ and how far the
    /// written arc leaves the meant one.
    fn check(arc: &PlaneArc) -> [f64; 2] {
        let radius = arc.radii()[0];
        match arc.written() {
            Written::Line => {
                let bulge = radius * (1.0 - (arc.sweep() / 2.0).cos());
                assert!(bulge < LEAST_BULGE_STEPS || radius < LEAST_RADIUS_STEPS, "{arc:?}");
                [0.0; 2]
            }
            Written::Arc { to, offset } => {
                let read = arc.understood(to, offset);
                let turned = (read.sweep() - arc.sweep()).abs() * radius;
                assert!(turned < 2.0 * CLOSED_STEPS * (1.0 + arc.sweep()), "{arc:?} {read:?}");
                let left = [0, 1].map(|k| (to[k] - arc.end[k]) as f64);
                assert!(length(left) < CLOSED_STEPS);
                let least = read.radii()[0].min(read.radii()[1]);
                assert!(least > LINUXCNC_LEAST_RADIUS, "{arc:?} {read:?}");
                [(read.radii()[0] - read.radii()[1]).abs(), departure(arc, &read)]
            }
        }
    }

    #[test]
    fn radii_agree_after_rounding() {
        let mut worst = [0.0_f64; 2];
        let mut seed = 7_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        for _ in 0..400_000 {
            let radius = 10_f64.powf(7.0 * random());
            // Half of them short: a fitter's arcs.
            let sweep = TAU * if random() < 0.5 { random() } else { random().powi(6) };
            let sweep = if random() < 0.5 { sweep } else { -sweep };
            let center = [100.0 * random(), 100.0 * random()];
            let found = check(&arc(radius, TAU * random(), sweep, center));
            worst = [0, 1].map(|k| worst[k].max(found[k]));
        }
        let [radii, departure] = worst;
        println!("radii differ by {radii:.3} steps at most, arcs depart by {departure:.3}");
        assert!(radii < 1.25 && departure < 2.75, "{radii} {departure}");
    }

    #[test]
    fn chords_stay_within_their_tolerance() {
        for (radius, sweep) in [(5.0, 1.0), (1000.0, 6.0), (1e7, TAU), (40_000.0, -2.0), (0.5, TAU)]
        {
            let arc = arc(radius, 0.4, sweep, [0.0, 0.0]);
            let chords = arc.chords(2.0);
            let half = sweep.abs() / f64::from(chords) / 2.0;
            assert!(radius * (1.0 - half.cos()) <= 2.0 + 1e-6, "{radius} {sweep} {chords}");
            let end = sub(arc.point(1.0), arc.meant_end);
            assert!(length(end) < 1e-6 * radius, "{end:?}");
        }
    }

    #[test]
    fn full_circles_stay_full() {
        for direction in [TAU, -TAU] {
            let circle = arc(1234.4, 0.3, direction, [0.5, 0.25]);
            let Written::Arc { to, .. } = circle.written() else { panic!("a line") };
            assert_eq!(to, circle.start);
            check(&circle);
        }
    }

    #[test]
    fn nearly_full_circles_do_not_shrink_to_nothing() {
        for k in 0..1000 {
            let sweep = TAU - f64::from(k) * 1e-6;
            let circle = arc(5000.0, 0.1 * f64::from(k), sweep, [0.3, 0.7]);
            let Written::Arc { to, offset } = circle.written() else { panic!("a line") };
            assert!(circle.understood(to, offset).sweep() > 6.0, "{circle:?}");
        }
    }

    #[test]
    fn short_arcs_do_not_grow_to_full_circles() {
        for k in 1..100_000 {
            let k = f64::from(k);
            let short = arc(5000.0, 0.1 * k, 1e-6 * k, [0.3, 0.7]);
            if let Written::Arc { to, offset } = short.written() {
                assert!(short.understood(to, offset).sweep() < 0.2, "{short:?}");
            }
        }
    }
}

//! Whether moves that were read back are the meant ones.

use super::{Arcs, Centers, Fault, Job, Move, Reading};
use crate::{Arc, Direction, Plane, Units};
use std::f64::consts::TAU;

/// By how many steps rounding may take an arc out of place.
const FLAT_STEPS: f64 = 2.75;

/// Holds moves that were read back against those that a job means, to within rounding; an arc may have
/// become several, or lines, if that is the dialect's habit.
///
/// # Errors
/// The first move that is not as meant.
pub fn compare(job: &Job, read: &[Move], reading: &Reading) -> Result<(), String> {
    let meant = job.meant(reading);
    let scale = Scale::new(job, reading);
    let mut rest = read;
    let mut from = [f64::NAN; 3];
    for (index, meant) in meant.iter().enumerate() {
        let Some(first) = rest.first() else { return Err(format!("only {index} moves: {read:?}")) };
        let (to, taken) = match (meant, first) {
            (Move::Rapid { to: a }, Move::Rapid { to: b }) if near(*a, *b, scale.point) => (*a, 1),
            (Move::Feed { to: a, mm_per_min: f }, Move::Feed { to: b, mm_per_min: g })
                if near(*a, *b, scale.point) && (f - g).abs() < scale.feed_step =>
            {
                (*a, 1)
            }
            (Move::Arc(arc), _) => {
                let pieces = |lines| Pieces { scale: &scale, lines, arcs: &reading.arcs };
                let lines = becomes_lines(job, arc, from, reading);
                let taken = match pieces(lines).take(arc, from, rest) {
                    0 if is_flat(arc, from, scale.step) => pieces(true).take(arc, from, rest),
                    taken => taken,
                };
                (arc.to, taken)
            }
            _ => return Err(format!("move {index}: meant {meant:?}, read {first:?}")),
        };
        if taken == 0 {
            return Err(format!("move {index}: meant {meant:?} from {from:?}, read {first:?}"));
        }
        rest = &rest[taken..];
        from = to;
    }
    match rest {
        [] => Ok(()),
        [more, ..] => Err(format!("more than was meant: {more:?}")),
    }
}

/// What rounding may take or add.
struct Scale {
    step: f64,
    /// Half a step, and what reading takes away.
    point: f64,
    feed_step: f64,
    /// By how much a chord's middle may leave its arc.
    sag: f64,
}

impl Scale {
    fn new(job: &Job, reading: &Reading) -> Self {
        let [mm, inch] = reading.decimals.map(|decimals| 0.1_f64.powi(decimals as i32));
        let (step, feed_step) = match job.units {
            Units::Mm => (mm, reading.feed_steps[0]),
            Units::Inch => (25.4 * inch, 25.4 * reading.feed_steps[1]),
        };
        let sag = job.path_tolerance_mm.max(step) + 2.0 * step;
        Self { step, point: 0.55 * step, feed_step, sag }
    }
}

fn becomes_lines(job: &Job, arc: &Arc, from: [f64; 3], reading: &Reading) -> bool {
    let [.., normal] = arc.plane.axes();
    let helix = (arc.to[normal] - from[normal]).abs() > 1e-3;
    let can = &reading.arcs;
    job.lines_only || can.never || can.xy_only && arc.plane != Plane::Xy || can.flat_only && helix
}

/// Whether an arc bulges so little that a line departs no more from it than a rounded arc may.
fn is_flat(arc: &Arc, from: [f64; 3], step: f64) -> bool {
    let [first, second, _] = arc.plane.axes();
    let radius = (from[first] - arc.center[first]).hypot(from[second] - arc.center[second]);
    let turn = turned(arc, from, arc.to, arc.center);
    from != arc.to && radius * (1.0 - (turn / 2.0).cos()) < FLAT_STEPS * step
}

/// How an arc may be divided.
struct Pieces<'s> {
    scale: &'s Scale,
    lines: bool,
    arcs: &'s Arcs,
}

/// One of them: where it ends, how fast, and how far it turns.
struct Piece {
    to: [f64; 3],
    mm_per_min: f64,
    turn: f64,
}

impl Pieces<'_> {
    /// How many moves make up an arc; 0 if they do not.
    fn take(&self, arc: &Arc, from: [f64; 3], moves: &[Move]) -> usize {
        let Scale { step, point, feed_step, .. } = *self.scale;
        let [first, second, normal] = arc.plane.axes();
        let radius = (from[first] - arc.center[first]).hypot(from[second] - arc.center[second]);
        // Each piece has its own centre, up to three steps off.
        let slack = (6.0 * step / radius).min(0.5);
        let whole = |turn: f64| if turn < slack || turn > TAU - slack { TAU } else { turn };
        let sweep = if from == arc.to { TAU } else { whole(turned(arc, from, arc.to, arc.center)) };
        let (mut at, mut sum) = (from, 0.0);
        for (k, moved) in moves.iter().enumerate() {
            let Some(piece) = self.piece(arc, at, moved, radius, slack) else { return 0 };
            sum += piece.turn;
            let to = piece.to;
            let radial = (to[first] - arc.center[first]).hypot(to[second] - arc.center[second]);
            let rise = arc.to[normal] - from[normal];
            let height = (from[normal] + rise * (sum / sweep).min(1.0) - to[normal]).abs();
            if (radial - radius).abs() > 1.5 * step
                || height > step + rise.abs() * slack / sweep
                || (piece.mm_per_min - arc.mm_per_min).abs() > feed_step
            {
                return 0;
            }
            if sum > sweep + slack {
                return 0;
            }
            if sum > sweep - slack && near(arc.to, to, point) {
                return k + 1;
            }
            at = to;
        }
        0
    }

    /// A move as a piece of an arc; `None` if it is none.
    fn piece(
        &self,
        arc: &Arc,
        at: [f64; 3],
        moved: &Move,
        radius: f64,
        slack: f64,
    ) -> Option<Piece> {
        let [first, second, _] = arc.plane.axes();
        match *moved {
            Move::Feed { to, mm_per_min } if self.lines => {
                let turn = turned(arc, at, to, arc.center);
                let sag = radius * (1.0 - (turn / 2.0).cos());
                (sag <= self.scale.sag).then_some(Piece { to, mm_per_min, turn })
            }
            Move::Arc(part) if !self.lines => {
                let off = self.off(arc, at, &part);
                let same = part.plane == arc.plane && part.direction == arc.direction;
                let closed = [first, second]
                    .iter()
                    .all(|&k| (at[k] - part.to[k]).abs() < 0.6 * self.scale.step);
                let turn = if closed && self.arcs.sweep_limit_deg > 180.0 {
                    TAU
                } else {
                    turned(arc, at, part.to, part.center)
                };
                let fits = same
                    && off <= 3.0 * self.scale.step
                    && turn <= self.arcs.sweep_limit_deg.to_radians() + slack;
                fits.then_some(Piece { to: part.to, mm_per_min: part.mm_per_min, turn })
            }
            _ => None,
        }
    }
}

impl Pieces<'_> {
    /// By how much a part of an arc is out of place: its centre or, where a radius gives it, its middle;
    /// a short arc's centre may then be anywhere behind it.
    fn off(&self, arc: &Arc, at: [f64; 3], part: &Arc) -> f64 {
        let [first, second, _] = arc.plane.axes();
        let across = |p: [f64; 3]| [first, second].map(|k| p[k] - part.center[k]);
        let apart = [first, second].map(|k| part.center[k] - arc.center[k]);
        if self.arcs.centers != Centers::Radius {
            return apart[0].abs().max(apart[1].abs());
        }
        let [x, y] = across(at);
        let half = turned(arc, at, part.to, part.center) / 2.0;
        let sign = if arc.direction == Direction::Clockwise { -1.0 } else { 1.0 };
        let (sin, cos) = (sign * half).sin_cos();
        let middle = [apart[0] + x * cos - y * sin, apart[1] + x * sin + y * cos];
        let meant = [first, second].map(|k| at[k] - arc.center[k]);
        (middle[0].hypot(middle[1]) - meant[0].hypot(meant[1])).abs()
    }
}

/// The angle from `a` to `b` about `center`, the way that `arc` turns.
fn turned(arc: &Arc, a: [f64; 3], b: [f64; 3], center: [f64; 3]) -> f64 {
    let [first, second, _] = arc.plane.axes();
    let angle = |p: [f64; 3]| (p[second] - center[second]).atan2(p[first] - center[first]);
    let sign = if arc.direction == Direction::Clockwise { -1.0 } else { 1.0 };
    (sign * (angle(b) - angle(a))).rem_euclid(TAU)
}

/// Where `a` is not known anything will do.
fn near(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| a.is_nan() || (a - b).abs() <= tolerance)
}

/// `Err` with the fault of a job, for messages.
pub(super) fn compared(job: &Job, read: &[Move], reading: &Reading) -> Fault {
    compare(job, read, reading).map_err(|fault| format!("in {:?}: {fault}", job.units))
}

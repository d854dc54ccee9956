//! Lines and arcs over as many points as a tolerance lets them pass.
//!
//! A span is cut into runs that lie in a plane of arcs ([`super::sheet`]); what is in none becomes chords.
//! In an upright run a line or an arc may lead from each point to any that it reaches ([`super::arc_fit`]),
//! and the fewest moves are found as in [`super::chord`], among equally many those with fewer arcs. Looking
//! at all arcs over m points takes m² time, so the look ahead is short, and only one way goes on, by
//! doubling and halving, to the farthest that fits. Where moves of that way are long, as on smooth surfaces,
//! no others are looked for. In a level run that way is all there is.
//!
//! So the number of moves is not always the least, but never more than by going farthest.

use super::arc_fit::{Arc, Fit, Gauge};
use super::chord::{Band, LOOK};
use super::fewest::Fewest;
use super::sheet::{Run, Sheet, runs};
use super::{Deviation, Kept};
use glam::{DVec2, DVec3};

/// How many points arcs are looked for ahead, where moves are short. On photographs an arc within 0.01 mm
/// passes two to ten.
const ARC_LOOK: usize = 24;

/// A point from which so many arcs in turn do not hold is left. A run that a short arc cannot follow is
/// seldom followed by a longer one.
const ARC_PATIENCE: usize = 3;

/// What a move costs: first their number counts, then that of arcs.
const LINE: u64 = 1 << 32;
const ARC: u64 = LINE + 1;

/// A move: an arc or, without one, a line.
type Bend = Option<Arc>;

/// What is left of a span.
pub(super) fn keep(tips: &[DVec3], band: &Band) -> Kept {
    let mut kept = Kept { indices: vec![0], arcs: Vec::new(), deviation: Deviation::default() };
    for Run { points, sheet } in runs(tips) {
        let start = points.start;
        let run = &tips[points];
        let moves: Vec<(usize, Bend)> = match sheet {
            None => band.keep(run).into_iter().skip(1).map(|end| (end, None)).collect(),
            Some(sheet) => {
                let points: Vec<DVec2> = run.iter().map(|tip| sheet.flat(*tip)).collect();
                let gauge = match sheet {
                    Sheet::Upright { .. } => Gauge::Upright(band),
                    Sheet::Level => Gauge::Level(band.above),
                };
                let bends = Bends { tips: run, points: &points, band, gauge };
                match sheet {
                    Sheet::Upright { .. } => bends.fewest(),
                    Sheet::Level => bends.farthest_first(),
                }
            }
        };
        let mut from = 0;
        for (end, bend) in moves {
            match bend.zip(sheet) {
                Some((arc, sheet)) => {
                    kept.arcs.push((start + end, sheet.arc(arc.center, run[from], run[end])));
                    kept.deviation.widen(&arc.deviation);
                }
                None => kept.deviation.widen(&Deviation::of_line(&run[from..=end])),
            }
            kept.indices.push(start + end);
            from = end;
        }
    }
    kept
}

/// A run with all that moves over it are held against.
struct Bends<'a> {
    tips: &'a [DVec3],
    points: &'a [DVec2],
    band: &'a Band,
    gauge: Gauge<'a>,
}

impl Bends<'_> {
    /// The moves over an upright run, as few as are found.
    fn fewest(&self) -> Vec<(usize, Bend)> {
        let last = self.tips.len() - 1;
        let mut route: Fewest<Bend> = Fewest::new(self.tips.len(), None);
        let (mut landmark, mut short) = (0, true);
        for from in 0..last {
            let far = from == landmark;
            let end = if far { last } else { last.min(from + LOOK) };
            let line = self.band.walk(self.tips, from, end, |to| route.lead(from, to, LINE, None));
            if far {
                landmark = line;
                if let Some((to, arc)) = self.farthest_arc(from).filter(|(to, _)| *to > line) {
                    route.lead(from, to, ARC, Some(arc));
                    landmark = to;
                }
                short = landmark - from < ARC_LOOK;
            }
            if short {
                self.look_for_arcs(from, &mut route);
            }
        }
        route.moves()
    }

    /// Notes the arcs from one point that are the best way to where they lead.
    fn look_for_arcs(&self, from: usize, route: &mut Fewest<Bend>) {
        let last = self.tips.len() - 1;
        let mut failed = 0;
        for to in from + 2..=last.min(from + ARC_LOOK) {
            if !route.gains(from, to, ARC) {
                continue;
            }
            match self.gauge.fit(&self.points[from..=to]) {
                Fit::Arc(arc) => route.lead(from, to, ARC, Some(arc)),
                Fit::Flat => {}
                Fit::Nothing => failed += 1,
            }
            if failed == ARC_PATIENCE {
                break;
            }
        }
    }

    /// The moves over a level run, each going as far as it can.
    fn farthest_first(&self) -> Vec<(usize, Bend)> {
        let last = self.tips.len() - 1;
        let mut moves: Vec<(usize, Bend)> = Vec::new();
        let mut from = 0;
        while from < last {
            let line = self.band.farthest_that_fits(self.tips, from);
            let arc = self.farthest_arc(from).filter(|(to, _)| *to > line);
            moves.push(arc.map_or((line, None), |(to, arc)| (to, Some(arc))));
            from = moves[moves.len() - 1].0;
        }
        moves
    }

    /// A far point that an arc reaches from one.
    fn farthest_arc(&self, from: usize) -> Option<(usize, Arc)> {
        let last = self.points.len() - 1;
        let (mut good, mut bad, mut found) = (from + 1, last + 1, None);
        let mut step = 2;
        while good < last && bad > last {
            let to = (from + step).min(last);
            self.try_arc(from, to, &mut good, &mut bad, &mut found);
            step *= 2;
        }
        while bad - good > 1 {
            let to = good + (bad - good) / 2;
            self.try_arc(from, to, &mut good, &mut bad, &mut found);
        }
        found
    }

    fn try_arc(
        &self,
        from: usize,
        to: usize,
        good: &mut usize,
        bad: &mut usize,
        found: &mut Option<(usize, Arc)>,
    ) {
        match self.gauge.fit(&self.points[from..=to]) {
            Fit::Arc(arc) => (*good, *found) = (to, Some((to, arc))),
            Fit::Flat => *good = to,
            Fit::Nothing => *bad = to,
        }
    }
}

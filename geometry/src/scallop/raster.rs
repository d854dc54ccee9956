//! Straight passes, each the largest step from the one before: bidirectional scallop control.
//!
//! After Sood (thesis, 2015), section 5.3: lines across the passes are laid first, whose places are where the
//! cutter is located along the passes; then the passes themselves. A line's step is the one that holds the
//! scallop everywhere along it. Unlike the source's, what is measured are the passes with the points that
//! are put in where they bend.
//!
//! A pass on the border leaves half of what it could cut beside the part. [`Borders::Inset`] lays the first
//! and last pass in from the border by what leaves no more than the scallop *on* it, about half a step, and
//! so does with a pass less. What is left over at the end is spread over all steps, as far as the scallop
//! holds then as well.

use super::lines::{Bench, Line};
use super::search::{Tried, largest_step};
use super::strip::{Ridge, highest_mm};
use super::{Finish, Finished, Held, ScallopError};
use crate::{DropError, Tick};
use glam::DVec2;
use rayon::prelude::*;
use std::ops::Range;

/// Plans aim at this share of the scallop, for what stands between probes.
pub(super) const TARGET: f64 = 0.98;

/// No step is more than so many flat steps. Only in a hollow about as narrow as the cutter more would hold,
/// and there the flat beside it does not.
const MOST_STEPS: f64 = 2.0;

/// Feed positions of probes lie no farther apart than this share of the cutter's radius: what it rolls over
/// within less changes its path little.
const PROBE_SPACING: f64 = 0.1;

/// What of the remainder is spread: all of it, or as much as holds.
const SPREADS: [f64; 2] = [1.0, 0.5];

/// What is left over is spread if steps change by more than this share.
const WORTH_SPREADING: f64 = 0.01;

/// A step is tried at every so many-th feed position of probes first: most of those that are too large are
/// found out by these.
const GLANCE: usize = 6;

/// Units that `tick` is told of: thousandths of the way across, of both sets of lines.
pub(super) const UNITS: usize = 1000;

/// Straight passes.
#[derive(Clone, Copy, Debug)]
pub struct ScallopRaster<'a> {
    /// What is finished, and how.
    pub finish: Finish<'a>,
    /// Where the first and last pass lie.
    pub borders: Borders,
}

impl ScallopRaster<'_> {
    /// Units that `tick` is told of in all.
    pub const UNITS: usize = 2 * UNITS;

    /// Plans the passes.
    ///
    /// # Errors
    /// If the cutter's tip is not round, a length makes no sense, there would be too many points, or `tick`
    /// stopped the work.
    pub fn plan(&self, tick: Tick<'_>) -> Result<Finished, ScallopError> {
        let finish = &self.finish;
        let bench = Bench::new(finish, tick)?.turned();
        let places = even(&bench.extent()[0], bench.flat_mm);
        // What these lines leave is measured again by the passes that are cut: probes at their places will do.
        let lines = Planner { feeds: places.clone(), ..Planner::new(&bench, places) };
        let feeds = lines.planned(Borders::On)?.places;
        let bench = bench.turned();
        let lines = Planner::new(&bench, feeds);
        let plan = lines.planned(self.borders)?;
        Ok(Finished { path: bench.path(plan.lines)?, held: plan.held })
    }
}

/// Places a step apart at the most, both ends among them.
pub(super) fn even(range: &Range<f64>, step: f64) -> Vec<f64> {
    let length = range.end - range.start;
    let count = (length / step).ceil().max(1.0);
    if length <= 0.0 {
        return vec![range.start];
    }
    (0..=count as usize).map(|k| range.start + length * (k as f64 / count)).collect()
}

/// Feed positions of probes: the cutter's own, and what lies between them.
pub(super) fn probe_feeds(positions: &[f64], finish: &Finish<'_>) -> Vec<f64> {
    let mut feeds = Vec::with_capacity(2 * positions.len());
    for pair in positions.windows(2) {
        let parts = probes_to(pair[1] - pair[0], finish) as f64;
        feeds.extend(
            (0..parts as usize).map(|k| pair[0] + (pair[1] - pair[0]) * (k as f64 / parts)),
        );
    }
    feeds.extend(positions.last());
    feeds
}

/// Probes to a way along the feed: two at least, for moves are straight in between.
pub(super) fn probes_to(way_mm: f64, finish: &Finish<'_>) -> usize {
    // A way has fewer than there are points in all.
    ((way_mm / (PROBE_SPACING * finish.profile.radius_mm())).ceil() as usize).max(2)
}

/// Where the first and last pass lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Borders {
    /// On the border.
    On,
    /// In from it, as far as the scallop holds there.
    Inset,
}

/// Passes, and where they are across.
struct Plan {
    places: Vec<f64>,
    lines: Vec<Line>,
    held: Held,
}

/// Lays passes that have the same positions along the feed.
pub(super) struct Planner<'a, 'b> {
    bench: &'a Bench<'b>,
    positions: Vec<f64>,
    /// Feed positions of probes.
    feeds: Vec<f64>,
    /// Some of them.
    glanced: Vec<f64>,
}

/// A pass that was tried, with what stands beside it.
pub(super) type Beside = (Line, Vec<Ridge>);

impl<'a, 'b> Planner<'a, 'b> {
    pub(super) fn new(bench: &'a Bench<'b>, positions: Vec<f64>) -> Self {
        let feeds = probe_feeds(&positions, bench.finish);
        let glanced = feeds.iter().copied().step_by(GLANCE).collect();
        Self { bench, positions, feeds, glanced }
    }

    fn line(&self, across: f64) -> Result<Line, ScallopError> {
        let places: Vec<DVec2> = self.positions.iter().map(|f| DVec2::new(*f, across)).collect();
        self.bench.line(&places)
    }

    fn beside_border(&self, line: &Line, border: f64) -> Result<Vec<Ridge>, ScallopError> {
        let places: Vec<DVec2> = self.feeds.iter().map(|f| DVec2::new(*f, border)).collect();
        self.bench.left_at(line, &places)
    }

    fn target(&self) -> f64 {
        TARGET * self.bench.finish.scallop_mm
    }

    /// Steps at the least and at the most, in mm.
    fn steps(&self) -> [f64; 2] {
        let most = MOST_STEPS * self.bench.flat_mm;
        [self.bench.finish.least_step_mm.min(most), most]
    }

    /// Passes at the largest steps, then spread. `tick` is told of all units.
    fn planned(&self, borders: Borders) -> Result<Plan, ScallopError> {
        self.spread(self.laid(borders)?, borders)
    }

    /// Passes at the largest steps.
    fn laid(&self, borders: Borders) -> Result<Plan, ScallopError> {
        let finish = self.bench.finish;
        let [_, across] = self.bench.extent();
        let (mut at, (line, ridges)) = match borders {
            Borders::On => (across.start, (self.line(across.start)?, Vec::new())),
            Borders::Inset => self.first()?,
        };
        let mut plan = Plan { places: vec![at], lines: vec![line], held: self.bench.held(&ridges) };
        let (mut guess, mut points, mut told) = (self.bench.flat_mm, 0, 0);
        while let Some(last) = plan.lines.last().filter(|_| at < across.end) {
            if borders == Borders::Inset
                && let Some(ridges) = self.last(last, at)?
            {
                plan.held = plan.held.with(self.bench.held(&ridges));
                break;
            }
            points += last.tips.len();
            if points > finish.most_points {
                return Err(ScallopError::TooManyPoints(finish.most_points));
            }
            let tried = self.next(last, at, guess)?;
            plan.held = plan.held.with(self.bench.held(&tried.found.1));
            (at, guess) = ((at + tried.step_mm).min(across.end), tried.step_mm);
            plan.places.push(at);
            plan.lines.push(tried.found.0);
            let share = (at - across.start) / (across.end - across.start);
            let now = (share * UNITS as f64) as usize;
            if !(self.bench.tick)(now.saturating_sub(told)) {
                return Err(DropError::Stopped.into());
            }
            told = told.max(now);
        }
        Ok(plan)
    }

    /// The first pass, as far in from the border as the scallop holds there.
    pub(super) fn first(&self) -> Result<(f64, Beside), ScallopError> {
        let [_, across] = self.bench.extent();
        let flat = self.bench.flat_mm;
        let place = |inset: f64| (across.start + inset).min(across.end);
        let range = [self.steps()[0] / 2.0, flat];
        let tried = largest_step(range, flat / 2.0, self.target(), |inset| {
            let line = self.line(place(inset))?;
            let ridges = self.beside_border(&line, across.start)?;
            Ok::<_, ScallopError>((highest_mm(&ridges), (line, ridges)))
        })?;
        Ok((place(tried.step_mm), tried.found))
    }

    /// What stands at the far border, if a pass is the last one.
    fn last(&self, line: &Line, at: f64) -> Result<Option<Vec<Ridge>>, ScallopError> {
        let [_, across] = self.bench.extent();
        let beside = across.end - at;
        if beside > self.bench.flat_mm {
            return Ok(None);
        }
        let ridges = self.beside_border(line, across.end)?;
        let is_last = highest_mm(&ridges) <= self.target() || beside <= self.steps()[0] / 2.0;
        Ok(is_last.then_some(ridges))
    }

    /// The pass after one.
    fn next(&self, last: &Line, at: f64, guess: f64) -> Result<Tried<Beside>, ScallopError> {
        let [_, across] = self.bench.extent();
        let room = across.end - at;
        let [least, most] = self.steps().map(|step| step.min(room));
        largest_step([least, most], guess, self.target(), |step| {
            // To the border itself, not beside it by a rounding.
            let line = self.line(if step >= room { across.end } else { at + step })?;
            let mut ridges = self.bench.ridges(last, &line, &self.glanced)?;
            if highest_mm(&ridges) <= self.target() {
                ridges = self.bench.ridges(last, &line, &self.feeds)?;
            }
            Ok((highest_mm(&ridges), (line, ridges)))
        })
    }

    /// The same number of passes, with the remainder spread over them as far as that holds.
    fn spread(&self, plan: Plan, borders: Borders) -> Result<Plan, ScallopError> {
        let [_, across] = self.bench.extent();
        let &[.., first, before, last] = &plan.places[..] else { return Ok(plan) };
        let whole = across.end - across.start;
        let spare = match borders {
            Borders::On => (before - first) - (last - before),
            Borders::Inset => (last - before) / 2.0 - (across.end - last),
        };
        if spare <= WORTH_SPREADING * whole {
            return Ok(plan);
        }
        for share in SPREADS {
            let scale = whole / (whole + spare * share);
            let mut places: Vec<f64> =
                plan.places.iter().map(|at| across.start + (at - across.start) * scale).collect();
            if borders == Borders::On {
                places.last_mut().into_iter().for_each(|last| *last = across.end);
            }
            let spread = self.at(places, borders)?;
            if spread.held.worst_mm <= plan.held.worst_mm.max(self.target()) {
                return Ok(spread);
            }
        }
        Ok(plan)
    }

    /// Passes at places across.
    fn at(&self, places: Vec<f64>, borders: Borders) -> Result<Plan, ScallopError> {
        let [_, across] = self.bench.extent();
        let lines: Result<Vec<Line>, _> = places.par_iter().map(|at| self.line(*at)).collect();
        let lines = lines?;
        let between = |pair: &[Line]| self.bench.ridges(&pair[0], &pair[1], &self.feeds);
        let ridges: Result<Vec<_>, _> = lines.par_windows(2).map(between).collect();
        let mut ridges = ridges?.concat();
        if borders == Borders::Inset {
            ridges.extend(self.beside_border(&lines[0], across.start)?);
            ridges.extend(self.beside_border(&lines[lines.len() - 1], across.end)?);
        }
        Ok(Plan { held: self.bench.held(&ridges), places, lines })
    }
}

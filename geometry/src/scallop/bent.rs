//! Passes that bend, so that the scallop between them is the same all along.
//!
//! Passes are graphs a(f), across over feed, with knots some steps apart. From one to the next each knot
//! advances by its own step: what the two passes leave is measured ([`super::strip`]), and the steps are set
//! right by the square root of what is too much or too little, as on smooth surfaces scallops grow with the
//! square. After some such tries steps only shrink, until all hold or are the least. So on a slope across passes lie
//! closer, on level ground beside it they do not.
//!
//! A pass is never steeper than [`STEEPEST`] in plan: of the graphs that advance no farther at any place it
//! is the upper envelope under that slope, so that a place where steps are small holds back what lies beside
//! it, and passes neither cross nor fold.
//!
//! The first pass is straight, in from the border. Where a pass holds the far border it ends; what is still
//! open gets passes of its own.
//!
//! Limits: hills are not gone round, as passes lead from side to side. Where steps differ much over the
//! width, what lags behind ends in short passes at the far border.

use super::lines::{Bench, Line};
use super::raster::{Planner, TARGET, UNITS, even, probes_to};
use super::strip::Ridge;
use super::{Finish, Finished, Held, ScallopError};
use crate::{DropError, Tick};
use glam::DVec2;
use std::ops::Range;

/// The steepest that a pass runs against the feed in plan: 45°.
const STEEPEST: f64 = 1.0;

/// Flat steps from one knot to the next: a pass is straight in plan between them, and what is straight can be
/// reduced.
const KNOTS: f64 = 2.0;

/// Cutter locations to a knot.
const LOCATIONS: usize = 2;

/// Tries that may lengthen steps, and all tries of a pass.
const TRIES: [usize; 2] = [4, 10];

/// What is aimed at, as a share of the target.
const AIM: f64 = 0.99;

/// A step changes by no more at once: the square holds near by only.
const CHANGES: [f64; 2] = [0.5, 1.3];

/// Passes that bend.
#[derive(Clone, Copy, Debug)]
pub struct ConstantScallop<'a> {
    /// What is finished, and how.
    pub finish: Finish<'a>,
}

impl ConstantScallop<'_> {
    /// Units that `tick` is told of in all.
    pub const UNITS: usize = UNITS;

    /// Plans the passes.
    ///
    /// # Errors
    /// As [`super::ScallopRaster::plan`].
    pub fn plan(&self, tick: Tick<'_>) -> Result<Finished, ScallopError> {
        let bench = Bench::new(&self.finish, tick)?;
        let [along, across] = bench.extent();
        let knots = even(&along, bench.flat_mm * KNOTS);
        let interval = (along.end - along.start) / (knots.len() - 1).max(1) as f64;
        let probes = probes_to(interval / LOCATIONS as f64, &self.finish) * LOCATIONS;
        let (at, (line, ridges)) = Planner::new(&bench, parted(&knots, LOCATIONS)).first()?;
        let mut front = Front {
            bench: &bench,
            end: across.end,
            feeds: parted(&knots, probes),
            probes,
            at: vec![at; knots.len()],
            steps: vec![bench.flat_mm; knots.len()],
            open: vec![true; knots.len()],
            knots,
        };
        let mut held = bench.held(&ridges);
        let (mut passes, mut points, mut told) = (vec![line.clone()], line.tips.len(), 0);
        let mut last = line;
        while front.is_open(&last)? {
            let (line, more) = front.advance(&last)?;
            held = held.with(more);
            passes.extend(front.runs().into_iter().filter_map(|run| line.part(run)));
            points += line.tips.len();
            if points > self.finish.most_points {
                return Err(ScallopError::TooManyPoints(self.finish.most_points));
            }
            let now = (front.share(&across) * UNITS as f64) as usize;
            if !tick(now.saturating_sub(told)) {
                return Err(DropError::Stopped.into());
            }
            told = told.max(now);
            last = line;
        }
        Ok(Finished { path: bench.path(passes)?, held })
    }
}

/// Knots, and what parts the ways between them.
fn parted(knots: &[f64], parts: usize) -> Vec<f64> {
    let between = |pair: &[f64]| {
        let (from, way) = (pair[0], pair[1] - pair[0]);
        (0..parts).map(move |k| from + way * (k as f64 / parts as f64)).collect::<Vec<f64>>()
    };
    knots.windows(2).flat_map(between).chain(knots.last().copied()).collect()
}

/// The pass that was laid last.
struct Front<'a, 'b> {
    bench: &'a Bench<'b>,
    /// The far border.
    end: f64,
    /// Feed positions of the knots.
    knots: Vec<f64>,
    /// Feed positions of probes.
    feeds: Vec<f64>,
    /// Probes to a knot.
    probes: usize,
    /// Where it is across at each knot.
    at: Vec<f64>,
    /// How far it advanced at each, in mm.
    steps: Vec<f64>,
    /// Where the far border is not reached yet.
    open: Vec<bool>,
}

impl Front<'_, '_> {
    fn finish(&self) -> &Finish<'_> {
        self.bench.finish
    }

    fn target(&self) -> f64 {
        TARGET * self.finish().scallop_mm
    }

    /// Closes what holds the far border; whether anything is open still.
    fn is_open(&mut self, last: &Line) -> Result<bool, ScallopError> {
        let near = |k: &usize| self.open[*k] && self.end - self.at[*k] <= self.bench.flat_mm;
        let near: Vec<usize> = (0..self.at.len()).filter(near).collect();
        let places: Vec<DVec2> =
            near.iter().map(|&k| DVec2::new(self.knots[k], self.end)).collect();
        let ridges = self.bench.left_at(last, &places)?;
        for (k, ridge) in near.into_iter().zip(ridges) {
            let reached = self.end - self.at[k] <= self.finish().least_step_mm / 2.0;
            self.open[k] = !(reached || ridge.left_mm <= self.target());
        }
        Ok(self.open.contains(&true))
    }

    /// How far the least advanced of what is open has come.
    fn share(&self, across: &Range<f64>) -> f64 {
        let open = self.at.iter().zip(&self.open).filter(|(_, open)| **open).map(|(at, _)| *at);
        (open.fold(across.end, f64::min) - across.start) / (across.end - across.start)
    }

    /// The feed positions that are open, in runs; nearer than a few steps they are one.
    fn runs(&self) -> Vec<Range<f64>> {
        let mut runs: Vec<Range<f64>> = Vec::new();
        for k in (0..self.open.len()).filter(|&k| self.open[k]) {
            let from = self.knots[k.saturating_sub(1)];
            let to = self.knots[(k + 1).min(self.open.len() - 1)];
            match runs.last_mut().filter(|run| from - run.end < 2.0 * self.bench.flat_mm) {
                Some(run) => run.end = to,
                None => runs.push(from..to),
            }
        }
        runs
    }

    /// The next pass, and what stands between.
    fn advance(&mut self, last: &Line) -> Result<(Line, Held), ScallopError> {
        let mut tried = 0;
        loop {
            let next = self.limited();
            let places = parted(&self.knots, LOCATIONS).into_iter().zip(parted(&next, LOCATIONS));
            let places: Vec<DVec2> = places.map(|(f, a)| DVec2::new(f, a)).collect();
            let line = self.bench.line(&places)?;
            let ridges = self.bench.ridges(last, &line, &self.feeds)?;
            let left = self.left(&ridges);
            let target = self.target();
            let holds = left.iter().all(|left| *left <= target);
            tried += 1;
            if tried >= TRIES[1] || holds && tried >= TRIES[0] {
                let counts = |k: &usize| self.open[k / self.probes];
                let open: Vec<Ridge> =
                    (0..ridges.len()).filter(counts).map(|k| ridges[k]).collect();
                self.at = next;
                return Ok((line, self.bench.held(&open)));
            }
            self.correct(&next, &left, tried < TRIES[0]);
        }
    }

    /// What stands at each knot and as far as the next ones; nothing where it is not open.
    fn left(&self, ridges: &[Ridge]) -> Vec<f64> {
        let around = |k: usize| {
            let low = (self.probes * k + 1).saturating_sub(self.probes);
            let beside = low..=(self.probes * (k + 1) - 1).min(ridges.len() - 1);
            let left = ridges[beside].iter().map(|ridge| ridge.left_mm).fold(0.0, f64::max);
            if self.open[k] { left } else { 0.0 }
        };
        (0..self.at.len()).map(around).collect()
    }

    /// Steps by what the last ones left.
    fn correct(&mut self, next: &[f64], left: &[f64], may_grow: bool) {
        let (target, most) = (self.target(), 2.0 * self.bench.flat_mm);
        let [low, high] = CHANGES;
        let right = |k: usize| {
            let made = next[k] - self.at[k];
            if left[k] <= target && !may_grow {
                return made;
            }
            let factor = (AIM * target / left[k].max(target / 16.0)).sqrt().clamp(low, high);
            made * if may_grow { factor } else { factor.min(AIM) }
        };
        self.steps = (0..left.len()).map(|k| right(k).min(most)).collect();
    }

    /// Where the next pass goes: no farther than the steps, no less than the least step, nowhere too steep.
    fn limited(&self) -> Vec<f64> {
        let mut next: Vec<f64> =
            self.at.iter().zip(&self.steps).map(|(at, step)| at + step).collect();
        let rise = |k: usize| STEEPEST * (self.knots[k + 1] - self.knots[k]);
        for k in 0..next.len().saturating_sub(1) {
            next[k + 1] = next[k + 1].min(next[k] + rise(k));
        }
        for k in (0..next.len().saturating_sub(1)).rev() {
            next[k] = next[k].min(next[k + 1] + rise(k));
        }
        let least = self.finish().least_step_mm.min(self.bench.flat_mm);
        let far = |(next, at): (&f64, &f64)| next.max(at + least).min(self.end);
        next.iter().zip(&self.at).map(far).collect()
    }
}

//! What two neighbouring passes leave between them.
//!
//! At each feed position the cutter is dropped at a few places between the passes. What the lower pass leaves
//! grows on the way across, what the upper one leaves falls, nearly as the square of the way; the ridge
//! stands where both are equal, and there a few more drops go.

use super::lines::{Bench, Line};
use super::sweep::Touched;
use super::{Held, ScallopError};
use glam::DVec2;
use rayon::prelude::*;

/// Where probes go first, as shares of the way across; where passes lie close, fewer.
const FIRST: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
const FIRST_IF_CLOSE: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];

/// Passes lie close if a flat step is less than this share of the cutter's radius.
const CLOSE: f64 = 0.2;

/// How often a probe is put where the ridge should be: each time it is nearer by far.
const REFINED: usize = 2;

/// So near to the ridge, in shares of the way across, its height is known from a probe beside it; from afar
/// it is a guess.
const BESIDE: f64 = 0.01;

/// What stands at a feed position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ridge {
    /// How high, in mm.
    pub(super) left_mm: f64,
    /// Where on the surface, as (f, a, z).
    pub(super) at: glam::DVec3,
}

/// A probe: how far across, and what either pass leaves there.
#[derive(Clone, Copy)]
struct Probe {
    share: f64,
    left_mm: [f64; 2],
    at: Touched,
}

impl Probe {
    fn least_mm(&self) -> f64 {
        self.left_mm[0].min(self.left_mm[1])
    }

    /// How far the ridge should be from here, in shares, and how high it should be.
    fn ridge(&self) -> (f64, f64) {
        let roots = self.left_mm.map(f64::sqrt);
        let (up, down) = (roots[0] / self.share, roots[1] / (1.0 - self.share));
        let way = (roots[1] - roots[0]) / (up + down).max(f64::MIN_POSITIVE);
        let root = roots[0] + up * way;
        (way, root * root)
    }
}

impl Bench<'_> {
    /// The ridges between two passes at feed positions.
    pub(super) fn ridges(
        &self,
        low: &Line,
        high: &Line,
        feeds: &[f64],
    ) -> Result<Vec<Ridge>, ScallopError> {
        let close = self.flat_mm < CLOSE * self.finish.profile.radius_mm();
        let first: &[f64] = if close { &FIRST_IF_CLOSE } else { &FIRST };
        let shares: Vec<(usize, f64)> =
            first.iter().flat_map(|&share| (0..feeds.len()).map(move |k| (k, share))).collect();
        let mut probes: Vec<Vec<Probe>> = vec![Vec::new(); feeds.len()];
        let mut wanted = shares;
        for round in 0..=REFINED {
            for (k, probe) in self.probed(low, high, feeds, &wanted)? {
                probes[k].push(probe);
            }
            if round < REFINED {
                let next = |(k, probes): (usize, &Vec<Probe>)| Some((k, next_share(probes)?));
                wanted = probes.iter().enumerate().filter_map(next).collect();
            }
        }
        Ok(probes.iter().map(|probes| ridge_of(probes)).collect())
    }

    fn probed(
        &self,
        low: &Line,
        high: &Line,
        feeds: &[f64],
        wanted: &[(usize, f64)],
    ) -> Result<Vec<(usize, Probe)>, ScallopError> {
        let place = |&(k, share): &(usize, f64)| {
            let (a, b) = (low.across_at(feeds[k]), high.across_at(feeds[k]));
            DVec2::new(feeds[k], a + share * (b - a))
        };
        let places: Vec<DVec2> = wanted.par_iter().map(place).collect();
        let touched = self.touched(&places)?;
        let probe = |(n, at): (usize, &Option<Touched>)| {
            let (k, share) = wanted[n];
            let left_mm = [low, high].map(|line| self.left_by(line, &(*at)?, feeds[k]));
            Some((k, Probe { share, left_mm: [left_mm[0]?, left_mm[1]?], at: (*at)? }))
        };
        Ok(touched.par_iter().enumerate().filter_map(probe).collect())
    }

    /// What the cutter touches at places (f, a), where that counts.
    fn touched(&self, places: &[DVec2]) -> Result<Vec<Option<Touched>>, ScallopError> {
        let path = self.drop_at(places)?;
        let finish = self.finish;
        let level = finish.steepest_rad.cos();
        let counts = |(tip, contact): (&glam::DVec3, &crate::Contact)| {
            let touched = self.sweep.touched(*tip, contact, finish.allowance_mm)?;
            // Below the floor the cutter is not let.
            (touched.normal.z >= level && tip.z >= finish.floor_mm).then_some(touched)
        };
        Ok(path.tips.par_iter().zip(&path.contacts).map(counts).collect())
    }

    /// What a pass leaves on a point that the cutter touches at a feed position. Moves beside which the cutter
    /// could not touch it are not looked at.
    fn left_by(&self, line: &Line, at: &Touched, f: f64) -> Option<f64> {
        let around = self.around_mm();
        let moves = line.moves(f - around..f + around);
        let left = moves.map(|(from, to)| self.sweep.left_mm(at, from, to));
        // No ball is nearer than its own size.
        left.reduce(f64::min).map(|left| left.min(self.finish.profile.radius_mm()))
    }

    /// How far along the feed moves are looked at.
    fn around_mm(&self) -> f64 {
        0.5 * self.flat_mm
    }

    /// What a pass alone leaves at places (f, a): the border beside the first or last pass.
    pub(super) fn left_at(
        &self,
        line: &Line,
        places: &[DVec2],
    ) -> Result<Vec<Ridge>, ScallopError> {
        let touched = self.touched(places)?;
        let ridge = |(at, place): (&Option<Touched>, &DVec2)| {
            let left = at.and_then(|at| Some((at.point, self.left_by(line, &at, place.x)?)));
            left.map_or_else(Ridge::default, |(at, left_mm)| Ridge { left_mm, at })
        };
        Ok(touched.par_iter().zip(places).map(ridge).collect())
    }

    /// What ridges say together. `at` is in plan.
    pub(super) fn held(&self, ridges: &[Ridge]) -> Held {
        let worst = ridges.iter().copied().reduce(|a, b| if b.left_mm > a.left_mm { b } else { a });
        let worst = worst.unwrap_or_default();
        let above = ridges.iter().filter(|ridge| ridge.left_mm > self.finish.scallop_mm).count();
        Held { worst_mm: worst.left_mm, at: self.turn(worst.at), probes: ridges.len(), above }
    }
}

/// The highest of ridges, in mm.
pub(super) fn highest_mm(ridges: &[Ridge]) -> f64 {
    ridges.iter().map(|ridge| ridge.left_mm).fold(0.0, f64::max)
}

fn nearest(probes: &[Probe]) -> Option<&Probe> {
    let off = |probe: &&Probe| probe.ridge().0.abs();
    probes.iter().min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// Where the next probe goes; nowhere if the ridge is found. Between two probes of which one lies on either
/// side of it, and half way where the guess leads beside them: under a flat bottom nothing grows evenly.
fn next_share(probes: &[Probe]) -> Option<f64> {
    let nearest = nearest(probes)?;
    let (way, _) = nearest.ridge();
    let (mut low, mut high) = (0.02_f64, 0.98_f64);
    for probe in probes {
        if probe.left_mm[0] < probe.left_mm[1] {
            low = low.max(probe.share);
        } else {
            high = high.min(probe.share);
        }
    }
    let guess = nearest.share + way;
    let share =
        if low < high && !(low..=high).contains(&guess) { low.midpoint(high) } else { guess };
    (way.abs() > BESIDE).then(|| share.clamp(0.02, 0.98))
}

fn ridge_of(probes: &[Probe]) -> Ridge {
    let highest = probes.iter().max_by(|a, b| a.least_mm().total_cmp(&b.least_mm()));
    let (Some(highest), Some(nearest)) = (highest, nearest(probes)) else {
        return Ridge::default();
    };
    let (way, ridge_mm) = nearest.ridge();
    let beside = if way.abs() < 2.0 * BESIDE { ridge_mm } else { 0.0 };
    Ridge { left_mm: highest.least_mm().max(beside), at: highest.at.point }
}

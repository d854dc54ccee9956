//! What a cutter has to bear: how deep it goes into the stock, and how fast it takes it away.
//!
//! Depth is the height of the stock above the tip where a move cuts, not what the move lowers a node by: of
//! a path of short moves each lowers by little what all of them cut through.
//!
//! The rate of removal is that of a stretch of the path at least as long as the cutter's radius. Of a single
//! move that is shorter than the nodes lie apart it would depend on whether it just reaches one.

use super::stroke::Stroke;
use crate::{Motion, MoveKind};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The most that a cut asks of its cutter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Load {
    /// Where a feed goes deepest into the stock; `None` if none cuts.
    pub step_down: Option<StepDown>,
    /// Where most is removed a minute; `None` if no feed cuts.
    pub removal: Option<Removal>,
    /// What feeds take away in all, in mm³.
    pub removed_mm3: f64,
}

/// A place where the cutter is deep in the stock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepDown {
    /// Height of the stock above the tip, in mm.
    pub depth_mm: f64,
    /// The node, and the height that is left there, in mm.
    pub at: DVec3,
    /// Index of the move in the cut's motion.
    pub index: usize,
}

/// A stretch of the path where much is taken away.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Removal {
    /// How much a minute, in mm³.
    pub mm3_per_min: f64,
    /// How much a mm of the path, in mm²: the area of the cutter's engagement, seen along the path.
    pub section_mm2: f64,
    /// Index of the stretch's last move in the cut's motion.
    pub index: usize,
}

/// A place by its move and what counts there, in mm.
type Found = (u32, f32, DVec3);

/// What a batch of strokes took from a tile.
#[derive(Default)]
pub(super) struct Shaved {
    /// By move, in order; several of one move if it has several strokes. In mm³.
    removed: Vec<(u32, f64)>,
    deepest: Option<Found>,
    /// The deepest place of each rapid, in order.
    rapids: Vec<Found>,
}

impl Shaved {
    /// Adds what a move took away, in mm³.
    pub(super) fn take(&mut self, index: u32, removed_mm3: f64) {
        if removed_mm3 > 0.0 {
            self.removed.push((index, removed_mm3));
        }
    }

    /// Whether a depth in mm is worth a [`Self::note`].
    #[inline]
    pub(super) fn wants(&self, stroke: &Stroke, depth: f32) -> bool {
        let last = if stroke.rapid {
            self.rapids.last().filter(|found| found.0 == stroke.index)
        } else {
            self.deepest.as_ref()
        };
        depth > last.map_or(0.0, |found| found.1)
    }

    /// Notes a place that is deeper than the one before.
    pub(super) fn note(&mut self, stroke: &Stroke, depth: f32, at: DVec3) {
        let found = (stroke.index, depth, at);
        if !stroke.rapid {
            self.deepest = Some(found);
            return;
        }
        self.rapids.pop_if(|last| last.0 == stroke.index);
        self.rapids.push(found);
    }
}

/// What the moves of a cut took away.
pub(super) struct Loads {
    /// By move, in mm³.
    removed: Vec<f64>,
    deepest: Option<Found>,
    rapids: BTreeMap<u32, (f32, DVec3)>,
}

impl Loads {
    /// Of so many moves, nothing yet.
    pub(super) fn new(moves: usize) -> Self {
        Self { removed: vec![0.0; moves], deepest: None, rapids: BTreeMap::new() }
    }

    /// Adds a tile's share.
    pub(super) fn add(&mut self, shaved: Shaved) {
        for (index, removed) in shaved.removed {
            self.removed[index as usize] += removed;
        }
        for (index, depth, at) in shaved.rapids {
            let most = self.rapids.entry(index).or_insert((depth, at));
            if depth > most.0 {
                *most = (depth, at);
            }
        }
        let deeper = |(_, depth, _): &Found| self.deepest.is_none_or(|most| *depth > most.1);
        self.deepest = shaved.deepest.filter(deeper).or(self.deepest);
    }

    /// Rapids that went through stock: their indices, depths in mm and deepest places.
    pub(super) fn rapids(&self) -> impl Iterator<Item = (usize, f64, DVec3)> + '_ {
        self.rapids.iter().map(|(index, (depth, at))| (*index as usize, f64::from(*depth), *at))
    }

    /// All in all, for a cutter of the given radius in mm.
    pub(super) fn load(&self, motion: &Motion, radius: f64) -> Load {
        let step_down = self.deepest.map(|(index, depth, at)| StepDown {
            depth_mm: f64::from(depth),
            at,
            index: index as usize,
        });
        let feeds = motion.moves.iter().zip(&self.removed);
        let removed_mm3 =
            feeds.filter(|(moved, _)| moved.kind != MoveKind::Rapid).map(|(_, removed)| removed);
        Load {
            step_down,
            removal: self.most_removed(motion, radius),
            removed_mm3: removed_mm3.sum(),
        }
    }

    /// The stretch of feeds of which most is removed a minute: as few moves as are as long as `least_mm`, or
    /// all between two rapids.
    fn most_removed(&self, motion: &Motion, least_mm: f64) -> Option<Removal> {
        let legs: Vec<Leg> = motion
            .legs()
            .zip(&self.removed)
            .map(|((from, moved), removed)| Leg {
                length: motion.leg_length_mm(from, moved),
                mm_per_min: moved.mm_per_min,
                removed: *removed,
                rapid: moved.kind == MoveKind::Rapid,
            })
            .collect();
        let mut most = None;
        let mut begin = 0;
        for stretch in legs.chunk_by(|a, b| !a.rapid && !b.rapid) {
            if !stretch[0].rapid {
                most_of_stretch(stretch, begin, least_mm, &mut most);
            }
            begin += stretch.len();
        }
        most
    }
}

/// A move.
struct Leg {
    length: f64,
    mm_per_min: f64,
    removed: f64,
    rapid: bool,
}

/// Looks through moves without a rapid between them; `begin` is the index of the first.
fn most_of_stretch(legs: &[Leg], begin: usize, least_mm: f64, most: &mut Option<Removal>) {
    let mut first = 0;
    let mut within = Sums::default();
    for (last, leg) in legs.iter().enumerate() {
        within.add(leg, 1.0);
        while first < last && within.length - legs[first].length >= least_mm {
            within.add(&legs[first], -1.0);
            first += 1;
        }
        if within.length < least_mm && last + 1 < legs.len() {
            continue;
        }
        let rate = within.removed / within.minutes;
        let counts = within.removed > LEAST_REMOVED_MM3 && rate.is_finite();
        if counts && most.is_none_or(|most| rate > most.mm3_per_min) {
            let section_mm2 = within.removed / within.length;
            *most = Some(Removal { mm3_per_min: rate, section_mm2, index: begin + last });
        }
    }
}

/// Less is not said to be removed, in mm³: far more than rounding leaves of what was added and taken off,
/// far less than a chip.
const LEAST_REMOVED_MM3: f64 = 1e-6;

/// Sums over moves.
#[derive(Default)]
struct Sums {
    length: f64,
    minutes: f64,
    removed: f64,
}

impl Sums {
    fn add(&mut self, leg: &Leg, times: f64) {
        self.length += times * leg.length;
        self.minutes += times * leg.length / leg.mm_per_min;
        self.removed += times * leg.removed;
    }
}

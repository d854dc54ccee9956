//! Simulation: what is left of a block after all moves of all cutters, in the order in which they are
//! made.
//!
//! The stock is a height above each node of a grid. Over a node p a move of the tip leaves
//!
//! ```text
//! min over the move of z(t) + h(|p - xy(t)|)
//! ```
//!
//! h the cutter's [`Profile`]. That is the drop cutter upside down, so a stroke is swept exactly, not
//! stamped: what a ball leaves is a cylinder and two spheres ([`ball`]), a flat end mill a ramp ([`flat`]), a
//! convex cutter the lowest of a convex function ([`convex`]), any other what the drop cutter's kernels say
//! of the stroke with its sign turned ([`general`]).
//!
//! # Method
//! 1. Moves become straight strokes ([`stroke`]).
//! 2. Strokes are told to the tiles of 64 × 64 nodes that they reach ([`bins`]), a batch at a time, so that
//!    memory is that of the nodes, a few numbers a move and one batch.
//! 3. Each tile takes its strokes in the order of time ([`tile`]). Of its blocks of 8 × 8 nodes those are
//!    left out that lie below the stroke already; of the others eight nodes are swept at a time.
//! 4. What each move took away is added up for the loads ([`load`]).
//!
//! Tiles know nothing of each other and sums go in the order of tiles, so the result does not depend
//! on the number of threads.
//!
//! # Limits
//! * Heights are exact for a place within some 1e-6 mm of the node (single precision beside the
//!   node) and to the last bit of `f32`. Arcs are cut in chords that stay within [`ARC_TOLERANCE_MM`].
//! * What stands between two nodes is not seen: neither a thin wall nor a rapid that runs through it.
//! * One height a node: no undercuts, and only cutters that a profile can say. Shank and holder are
//!   not looked at.

mod ball;
mod bins;
mod convex;
mod flat;
mod general;
mod load;
mod reach;
mod stroke;
mod sweep;
mod tile;

#[cfg(test)]
mod tests;

pub use load::{Load, Removal, StepDown};

use crate::drop_cutter::ShapeKind;
use crate::{FieldGrid, HeightField, HeightFieldError, Motion, Profile, Tick};
use ball::Ball;
use bins::Bins;
use convex::Convex;
use flat::Flat;
use general::General;
use glam::{DVec2, DVec3};
use load::Loads;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use stroke::{Stroke, strokes};
use sweep::Sweep;
use tile::{Tile, Tiles};

/// Chords of arcs stay this close to them: half of a program's last decimal, and a tenth of the finest scallop
/// that anybody asks for.
pub const ARC_TOLERANCE_MM: f64 = 5e-4;

/// A rapid that takes away less does not count: programs have three decimals.
pub const RAPID_TOLERANCE_MM: f64 = 1e-3;

/// Coordinates beyond this are no machine's: 1 km.
const FARTHEST_MM: f64 = 1e6;

/// Strokes in a batch: their bins take a few megabytes.
const BATCH: usize = 1 << 16;

/// The block that is cut from, seen from above, as nodes of a grid. It has no bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stock {
    /// Where the first node stands, in mm.
    pub corner: DVec2,
    /// The nodes.
    pub grid: FieldGrid,
    /// Height of its level top, in mm.
    pub top_mm: f64,
}

/// What one cutter does.
#[derive(Clone, Copy, Debug)]
pub struct Cut<'a> {
    /// Its moves, in order.
    pub motion: &'a Motion,
    /// Its shape.
    pub profile: &'a Profile,
}

/// What comes of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// The machined surface; its first node stands at the stock's corner.
    pub surface: HeightField,
    /// Rapids that went through stock, in order.
    pub rapids: Vec<RapidCut>,
    /// What each cut had to bear, as many as cuts.
    pub loads: Vec<Load>,
}

/// A rapid that went through stock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RapidCut {
    /// Index of the cut.
    pub cut: usize,
    /// Index of the move in the cut's motion.
    pub index: usize,
    /// The node where it took away most, and the height that is left, in mm.
    pub at: DVec3,
    /// How much it took away there, in mm.
    pub depth_mm: f64,
}

/// Why nothing can be simulated. Cuts and moves are counted from 0.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum SimulateError {
    /// A stock without nodes, or at no place.
    #[error("the stock is no block: {0}")]
    BadStock(HeightFieldError),
    /// A coordinate that is NaN, infinite or beyond any machine.
    #[error("move {index} of cut {cut} leads to {at}, which no machine can reach")]
    TooFar {
        /// The cut.
        cut: usize,
        /// The move.
        index: usize,
        /// Where it leads.
        at: DVec3,
    },
    /// An arc that is not there.
    #[error("move {index} of cut {cut} is arc {arc}, of {arcs}")]
    NoSuchArc {
        /// The cut.
        cut: usize,
        /// The move.
        index: usize,
        /// The arc it names.
        arc: u32,
        /// Arcs in all.
        arcs: usize,
    },
    /// More moves in a cut than can be counted.
    #[error("{0} moves are more than can be simulated")]
    TooMany(usize),
    /// The tick answered no.
    #[error("stopped")]
    Stopped,
}

/// Cuts a block with one cutter after the other.
///
/// `tick` is told of moves.
///
/// # Errors
/// If the stock has no nodes, a move leads to no place or `tick` stopped the work.
pub fn simulate(stock: &Stock, cuts: &[Cut<'_>], tick: Tick) -> Result<Simulation, SimulateError> {
    for (cut, Cut { motion, .. }) in cuts.iter().enumerate() {
        check(cut, motion)?;
    }
    let mut tiles = Tiles::new(stock)?;
    let (mut rapids, mut loads) = (Vec::new(), Vec::new());
    for (cut, Cut { motion, profile }) in cuts.iter().enumerate() {
        let mut found = Loads::new(motion.moves.len());
        match ShapeKind::of(profile) {
            ShapeKind::Ball => {
                tiles.cut(motion, &Ball::new(profile.radius_mm()), &mut found, tick)?;
            }
            ShapeKind::Flat => {
                tiles.cut(motion, &Flat::new(profile.radius_mm()), &mut found, tick)?;
            }
            ShapeKind::General => match Convex::new(profile) {
                Some(convex) => tiles.cut(motion, &convex, &mut found, tick)?,
                None => tiles.cut(motion, &General::new(profile), &mut found, tick)?,
            },
        }
        rapids.extend(found.rapids().map(|(index, depth_mm, at)| RapidCut {
            cut,
            index,
            at,
            depth_mm,
        }));
        loads.push(found.load(motion, profile.radius_mm()));
    }
    let surface = tiles.surface().map_err(SimulateError::BadStock)?;
    Ok(Simulation { surface, rapids, loads })
}

/// Refuses moves that lead nowhere.
fn check(cut: usize, motion: &Motion) -> Result<(), SimulateError> {
    let near = |at: DVec3| at.abs().max_element() <= FARTHEST_MM && at.is_finite();
    let too_far = |index, at| Err(SimulateError::TooFar { cut, index, at });
    if u32::try_from(motion.moves.len()).is_err() {
        return Err(SimulateError::TooMany(motion.moves.len()));
    }
    if !near(motion.start) {
        return too_far(0, motion.start);
    }
    for (index, (from, moved)) in motion.legs().enumerate() {
        if !near(moved.to) {
            return too_far(index, moved.to);
        }
        if let crate::MoveKind::Arc { arc } = moved.kind {
            let arcs = motion.arcs.len();
            let Some(found) = motion.arc(moved) else {
                return Err(SimulateError::NoSuchArc { cut, index, arc, arcs });
            };
            if !near(found.center) || !near(found.point(from, moved.to, 0.5)) {
                return too_far(index, found.center);
            }
        }
    }
    Ok(())
}

impl Tiles {
    /// Cuts with one cutter, a batch of strokes at a time.
    fn cut(
        &mut self,
        motion: &Motion,
        cutter: &impl Sweep,
        loads: &mut Loads,
        tick: Tick,
    ) -> Result<(), SimulateError> {
        let mut rest = strokes(motion).peekable();
        let mut done = 0;
        while rest.peek().is_some() {
            let batch: Vec<Stroke> = rest.by_ref().take(BATCH).collect();
            self.cut_batch(&batch, cutter, loads, tick).ok_or(SimulateError::Stopped)?;
            let now = batch.last().map_or(done, |stroke| stroke.index as usize + 1);
            tick(now - done).then_some(()).ok_or(SimulateError::Stopped)?;
            done = now;
        }
        Ok(())
    }

    fn cut_batch(
        &mut self,
        batch: &[Stroke],
        cutter: &impl Sweep,
        loads: &mut Loads,
        tick: Tick,
    ) -> Option<()> {
        let frame = self.frame;
        let bins = Bins::new(&frame, batch, cutter.radius());
        let shaved = self.tiles_mut().enumerate().map(|(index, tile): (usize, Tile<'_>)| {
            let strokes = bins.of_tile(index).iter().map(|k| &batch[*k as usize]);
            tile.shave(&frame, index, strokes, cutter, tick)
        });
        let shaved: Option<Vec<_>> = shaved.collect();
        shaved?.into_iter().for_each(|one| loads.add(one));
        Some(())
    }
}

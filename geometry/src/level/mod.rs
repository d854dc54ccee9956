//! What a cutter reaches at one height: the ground of roughing in levels and of waterlines.
//!
//! At the height z the tip may be wherever the drop cutter finds it at z or lower; that part of the
//! plane is *free*. Its outline is the line along which the cutter touches the surface at that height.
//! It is found for whatever the drop cutter can be dropped on, and with any cutter, in three steps:
//!
//! 1. Tips on a grid ([`ground`]): once, for all heights.
//! 2. Marching squares tell between which nodes of the grid the outline passes, and in what order
//!    ([`trace`](crate::trace)).
//! 3. Between a free node and one that is not, the crossing is found by halving, with the exact drop
//!    cutter; and so is where the outline bulges between two crossings ([`refine`]).
//!
//! All corners of an outline are free; the lines between them may lie beyond it by the tolerance. So
//! outlines are made for a cutter that is grown by the tolerance ([`crate::Profile::grown`]), and the
//! passes along them ([`passes`]) are dropped once more with the cutter itself: where it would touch
//! they rise. It hardly ever does, but no pass depends on what the grid has not seen.
//!
//! # Limits
//! What is not free, but smaller than the grid and between its nodes, is not seen: passes rise over it,
//! and no line is drawn around it. A cutter of radius R makes of any peak a disc, for a flat of radius
//! R, for a ball that is δ below the peak of radius √(2Rδ): on a grid of R/8 peaks of up to R/256 can
//! be missed.

mod ground;
mod passes;
mod refine;
mod rough;
#[cfg(test)]
mod tests;
mod waterline;

pub use passes::{Entry, LevelError, Levels};
pub use rough::{Rough, RoughStyle};
pub use waterline::Waterline;

use glam::DVec2;

/// A place this far above a height, in mm, counts as at it: levels of a flat floor meet it exactly.
const LEVEL_SLACK_MM: f64 = 1e-7;

/// A closed line around what is free, which lies to the left of it.
#[derive(Clone, Debug, PartialEq)]
struct Outline {
    /// Its corners; the last is joined to the first.
    corners: Vec<Corner>,
}

/// A corner of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Corner {
    at: DVec2,
    /// Whether it is the border of the area, and not the surface, that ends the free part here.
    border: bool,
}

/// Whether the cutter, turning clockwise, bites thickly first or last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Milling {
    /// The material is to the right: thick chips first, a better surface.
    Climb,
    /// The material is to the left: for machines with play.
    Conventional,
}

/// Heights from `top` down to `bottom`, equally spaced, no more than `step_mm` apart; without `top`
/// itself.
fn heights(top_mm: f64, bottom_mm: f64, step_mm: f64) -> Vec<f64> {
    let depth = top_mm - bottom_mm;
    if !(depth > 0.0 && step_mm > 0.0) {
        return Vec::new();
    }
    // A hair less than a whole number of steps is that number.
    let count = (depth / step_mm - 1e-9).ceil().max(1.0) as usize;
    (1..=count).map(|k| top_mm - depth * (k as f64 / count as f64)).collect()
}

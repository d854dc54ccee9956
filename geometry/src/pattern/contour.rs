//! Rectangles within a rectangle, parallel to its border.
//!
//! The first runs along the border, each further one a stepover s inside the last, while there is
//! room. Where the innermost leaves more than s across, one more follows that leaves s. So every
//! place is within s/2 of a pass, but on the diagonals near corners: there it is up to (2 - √2)·s,
//! 0.59 s, where the outer sides and the inner corner are equally far.
//!
//! Limits: rectangles only. A boundary is refused by [`ContourParallel::pattern`] as an empty
//! pattern; callers tell so.

use super::even::{along, parts};
use super::{Layer, Layout, Pace, Pattern, Region, Start, Stroke, Turn};
use crate::pattern::region::rectangle;
use glam::DVec2;

/// Rings parallel to the border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourParallel {
    /// Distances between rings and between points.
    pub pace: Pace,
    /// Which ring comes first.
    pub start: Start,
    /// Which way round they are passed.
    pub turn: Turn,
}

impl Layout for ContourParallel {
    fn count(&self, region: &Region) -> f64 {
        if !self.pace.is_sound() {
            return f64::INFINITY;
        }
        let size = region.size();
        let rings = (size.min_element() / 2.0 / self.pace.stepover_mm).floor() + 1.0;
        // Perimeters fall by 8s from ring to ring.
        let outer_mm = 2.0 * (size.x + size.y);
        let length_mm = rings * (outer_mm - 4.0 * self.pace.stepover_mm * (rings - 1.0));
        parts(length_mm, self.pace.feed_step_mm) + 2.0 * rings
    }

    fn pattern(&self, region: &Region) -> Pattern {
        if region.has_boundary() {
            return Pattern::EMPTY;
        }
        let mut layer = match Layer::new(region, self.pace) {
            Ok(layer) => layer,
            Err(pattern) => return pattern,
        };
        for inset_mm in insets(region.size().min_element() / 2.0, self.pace.stepover_mm) {
            let mut corners = rectangle(region.min() + inset_mm, region.max() - inset_mm);
            // Drawn from outside; from the middle they are passed backwards.
            if (self.turn == Turn::Clockwise) != (self.start == Start::Middle) {
                corners.reverse();
            }
            let points: Vec<DVec2> = along(&corners, self.pace.feed_step_mm).collect();
            layer.add(Stroke::Closed(points.into_iter()));
        }
        layer.into_pattern(self.start == Start::Middle)
    }
}

/// How far inside the border the rings of a rectangle run whose shorter side is `2·half_mm`.
fn insets(half_mm: f64, stepover_mm: f64) -> impl Iterator<Item = f64> {
    let whole = (half_mm / stepover_mm * (1.0 + super::STEP_SLACK)).floor();
    let left_mm = half_mm - whole * stepover_mm;
    let last = (left_mm > stepover_mm / 2.0 * (1.0 + super::STEP_SLACK))
        .then_some(half_mm - stepover_mm / 2.0);
    (0..=whole as usize).map(move |k| (k as f64 * stepover_mm).min(half_mm)).chain(last)
}

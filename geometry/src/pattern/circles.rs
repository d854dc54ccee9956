//! Circles about the middle of a region, a stepover apart.
//!
//! Their radii are 0, s, 2s … up to the far corners; each has equal arcs between its points, none
//! longer than the feed step. From one to the next the cutter goes straight out or in.
//!
//! Limits: between the last circle and a corner of the region up to a stepover is left; the border
//! pass covers it.

use super::even::{angle_step, points_on_disc};
use super::{Layer, Layout, Pace, Pattern, Region, Start, Stroke, Turn};
use glam::DVec2;
use std::f64::consts::TAU;

/// Rings about the middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circles {
    /// Distances between circles and between points.
    pub pace: Pace,
    /// Which circle comes first.
    pub start: Start,
    /// Which way round they are passed.
    pub turn: Turn,
    /// Whether a pass around the region covers what the circles leave of its corners.
    pub border: bool,
}

impl Layout for Circles {
    fn count(&self, region: &Region) -> f64 {
        if !self.pace.is_sound() {
            return f64::INFINITY;
        }
        points_on_disc(region.reach_mm(), self.pace) + 1.0
    }

    fn pattern(&self, region: &Region) -> Pattern {
        let mut layer = match Layer::new(region, self.pace) {
            Ok(layer) => layer,
            Err(pattern) => return pattern,
        };
        let center = region.center();
        layer.add(Stroke::Open(std::iter::once(center)));
        for k in 1..=(region.reach_mm() / self.pace.stepover_mm) as usize {
            layer.add(Stroke::Closed(self.circle(center, k as f64 * self.pace.stepover_mm)));
        }
        if self.border {
            layer.add_border();
        }
        layer.into_pattern(self.start == Start::Outside)
    }
}

impl Circles {
    fn circle(&self, center: DVec2, radius: f64) -> impl Iterator<Item = DVec2> {
        let points = (TAU / angle_step(radius, self.pace)).ceil() as usize;
        let sign = self.start.sign() * self.turn.sign();
        // The last is the first, to the bit.
        (0..=points).map(move |k| {
            let share = (k % points) as f64 / points as f64;
            center + radius * DVec2::from_angle(sign * TAU * share)
        })
    }
}

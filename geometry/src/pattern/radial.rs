//! Spokes from the middle of a region, fewer near it.
//!
//! At a radius r spokes that are a stepover s apart number 2πr / s. So that the middle is not worn
//! by all of them, they come in levels: `n·2^j` equal angles at level j, of which every second is
//! new. A new spoke begins at the radius where those of the levels before are s apart,
//! `s·n·2^(j-1) / 2π`; level 0 begins in the middle. So neighbouring spokes are between s/2 and s
//! apart, but for the innermost circle.
//!
//! Limits: up to a stepover is left in corners between the ends of two spokes; the border pass
//! covers it.

use super::even::{along, parts};
use super::{Layer, Layout, Pace, Pattern, Region, Stroke};
use glam::DVec2;
use std::f64::consts::TAU;

/// Lines through the middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radial {
    /// Largest distance between spokes, and that between points.
    pub pace: Pace,
    /// Whether a pass around the region covers what the spokes leave of its corners.
    pub border: bool,
}

/// Between half as many spokes as this and this many meet in the middle. With six, level 1 begins
/// where they are a stepover apart, about a stepover from the middle.
const MOST_IN_MIDDLE: f64 = 6.0;

/// The spokes that begin at one radius.
struct Level {
    start_mm: f64,
    /// New spokes.
    spokes: usize,
    /// Angle of the first, and from one to the next, in turns.
    first: f64,
    step: f64,
}

impl Layout for Radial {
    fn count(&self, region: &Region) -> f64 {
        if !self.pace.is_sound() {
            return f64::INFINITY;
        }
        let reach_mm = region.reach_mm();
        self.levels(reach_mm)
            .map(|level| {
                let length_mm = (reach_mm - level.start_mm).max(0.0);
                level.spokes as f64 * (parts(length_mm, self.pace.feed_step_mm) + 1.0)
            })
            .sum()
    }

    fn pattern(&self, region: &Region) -> Pattern {
        let mut layer = match Layer::new(region, self.pace) {
            Ok(layer) => layer,
            Err(pattern) => return pattern,
        };
        let (center, reach_mm) = (region.center(), region.reach_mm());
        for level in self.levels(reach_mm) {
            for k in 0..level.spokes {
                let out = DVec2::from_angle(TAU * (level.first + level.step * k as f64));
                let mut ends = [center + out * level.start_mm, center + out * reach_mm];
                if k % 2 == 1 {
                    ends.reverse();
                }
                self.add_spoke(&mut layer, region, ends);
            }
        }
        if self.border {
            layer.add_border();
        }
        layer.into_pattern(false)
    }
}

impl Radial {
    /// The levels that a region of radius `reach_mm` needs, from the middle.
    fn levels(&self, reach_mm: f64) -> impl Iterator<Item = Level> {
        let needed = (TAU * reach_mm / self.pace.stepover_mm).max(3.0);
        let doublings = (needed / MOST_IN_MIDDLE).log2().ceil().max(0.0) as i32;
        let in_middle = (needed / f64::from(doublings).exp2()).ceil();
        let stepover_mm = self.pace.stepover_mm;
        (0..=doublings).map(move |j| {
            let all = in_middle * f64::from(j).exp2();
            if j == 0 {
                return Level { start_mm: 0.0, spokes: all as usize, first: 0.0, step: 1.0 / all };
            }
            let start_mm = stepover_mm * all / 2.0 / TAU;
            Level { start_mm, spokes: (all / 2.0) as usize, first: 1.0 / all, step: 2.0 / all }
        })
    }

    /// Cuts a spoke before its points are spaced, so that they are even from end to end.
    fn add_spoke(&self, layer: &mut Layer<'_>, region: &Region, [from, to]: [DVec2; 2]) {
        for (enter, leave) in region.inside(from, to) {
            let ends = [from.lerp(to, enter), from.lerp(to, leave)];
            layer.add(Stroke::Open(along(&ends, self.pace.feed_step_mm)));
        }
    }
}

//! Spokes about the middle of a region, fewer near it.
//!
//! At a radius r spokes that are a stepover s apart number 2πr / s. So the region is divided into rings
//! about the middle, each of twice the radius of the one in it, with `n·2^j` spokes in ring j: it begins
//! where those of ring j - 1 are s apart, at `s·n·2^(j-1) / 2π`, and ring 0 in the middle. So neighbouring
//! spokes are between s/2 and s apart, but for the innermost circle.
//!
//! The first spoke goes from the border to the middle through all rings. Then ring by ring is passed, out
//! on one spoke and in on the next, from beside the first spoke around to its other side. That is an odd
//! number of spokes, so that each ring is left at its outer end, where the next begins: in a round region
//! the cutter is never lifted and crosses no pass.
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

/// Between half as many spokes as this and this many meet in the middle. With six, ring 1 begins
/// where they are a stepover apart, about a stepover from the middle.
const MOST_IN_MIDDLE: f64 = 6.0;

/// The spokes between two radii.
struct Ring {
    from_mm: f64,
    to_mm: f64,
    /// All of them, the first one included.
    spokes: usize,
}

impl Layout for Radial {
    fn count(&self, region: &Region) -> f64 {
        if !self.pace.is_sound() {
            return f64::INFINITY;
        }
        let points = |length_mm: f64| parts(length_mm, self.pace.feed_step_mm) + 1.0;
        let rings = self.rings(region.reach_mm());
        points(region.reach_mm())
            + rings.map(|ring| ring.spokes as f64 * points(ring.to_mm - ring.from_mm)).sum::<f64>()
    }

    fn pattern(&self, region: &Region) -> Pattern {
        let mut layer = match Layer::new(region, self.pace) {
            Ok(layer) => layer,
            Err(pattern) => return pattern,
        };
        let (center, reach_mm) = (region.center(), region.reach_mm());
        self.add_spoke(&mut layer, region, [center + DVec2::X * reach_mm, center]);
        for ring in self.rings(reach_mm) {
            for k in 1..ring.spokes {
                let out = DVec2::from_angle(TAU * k as f64 / ring.spokes as f64);
                let mut ends = [center + out * ring.from_mm, center + out * ring.to_mm];
                if k % 2 == 0 {
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
    /// The rings of a region of radius `reach_mm`, from the middle.
    fn rings(&self, reach_mm: f64) -> impl Iterator<Item = Ring> {
        let needed = (TAU * reach_mm / self.pace.stepover_mm).max(3.0);
        let doublings = (needed / MOST_IN_MIDDLE).log2().ceil().max(0.0) as i32;
        let in_middle = (needed / f64::from(doublings).exp2()).ceil();
        let stepover_mm = self.pace.stepover_mm;
        (0..=doublings).map(move |j| {
            let spokes = in_middle * f64::from(j).exp2();
            let radius_mm = |spokes: f64| (stepover_mm * spokes / TAU).min(reach_mm);
            Ring {
                from_mm: if j == 0 { 0.0 } else { radius_mm(spokes / 2.0) },
                to_mm: if j == doublings { reach_mm } else { radius_mm(spokes) },
                spokes: spokes as usize,
            }
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

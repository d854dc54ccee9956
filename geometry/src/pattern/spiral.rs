//! An Archimedean spiral about the middle of a region.
//!
//! r = bφ with b = s / 2π, s the stepover: neighbouring turns are s apart along every ray. Its arc
//! length is `(b/2)·(φ√(1 + φ²) + asinh φ)`; points follow each other at equal steps of it, found by
//! Newton's method.
//!
//! Limits: turns are s apart along the ray, less across by the factor 1/√(1 + 1/φ²), which is 0.99
//! from the second turn on. Between the last turn and a corner of the region up to a stepover is
//! left; the border pass covers it.

use super::even::{angle_step, points_on_disc};
use super::{Layer, Layout, Pace, Pattern, Region, Start, Stroke, Turn};
use glam::DVec2;
use std::f64::consts::TAU;

/// One line that winds about the middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spiral {
    /// Distances between turns and between points.
    pub pace: Pace,
    /// Where it begins.
    pub start: Start,
    /// Which way round it is drawn from the middle; from outside it is passed backwards.
    pub turn: Turn,
    /// Whether a pass around the region covers what the turns leave of its corners.
    pub border: bool,
}

impl Layout for Spiral {
    fn count(&self, region: &Region) -> f64 {
        if !self.pace.is_sound() {
            return f64::INFINITY;
        }
        points_on_disc(region.reach_mm(), self.pace)
    }

    fn pattern(&self, region: &Region) -> Pattern {
        let mut layer = match Layer::new(region, self.pace) {
            Ok(layer) => layer,
            Err(pattern) => return pattern,
        };
        let center = region.center();
        let sign = self.start.sign() * self.turn.sign();
        let place = |(radius, phi): (f64, f64)| center + radius * DVec2::from_angle(sign * phi);
        layer.add(Stroke::Open(self.polar(region.reach_mm()).map(place)));
        if self.border {
            layer.add_border();
        }
        layer.into_pattern(self.start == Start::Outside)
    }
}

impl Spiral {
    /// Radius and angle of its points, from the middle to the first beyond `reach_mm`.
    fn polar(&self, reach_mm: f64) -> impl Iterator<Item = (f64, f64)> {
        let b = self.pace.stepover_mm / TAU;
        let mut last = Some(0.0);
        std::iter::from_fn(move || {
            let phi = last?;
            let radius = b * phi;
            last = (radius < reach_mm).then(|| self.next_angle(phi));
            Some((radius, phi))
        })
    }

    /// The angle one step further along the curve.
    fn next_angle(&self, phi: f64) -> f64 {
        let b = self.pace.stepover_mm / TAU;
        // The radius of curvature b(1 + φ²)^(3/2) / (2 + φ²): b/2 in the middle, about r far out.
        let square = 1.0 + phi * phi;
        let curvature_mm = b * square.sqrt() * square / (1.0 + square);
        let step_mm = curvature_mm * angle_step(curvature_mm, self.pace);
        let wanted = arc_length(phi) + step_mm / b;
        let mut next = phi + step_mm / (b * square.sqrt());
        // Length grows as √(1 + φ²), convex, so Newton's steps come down to the root without fail;
        // they double the digits each time.
        for _ in 0..NEWTON_STEPS {
            next -= (arc_length(next) - wanted) / (1.0 + next * next).sqrt();
        }
        next
    }
}

/// From a first guess that is good to a tenth, three doublings reach 16 digits; one to spare.
const NEWTON_STEPS: usize = 4;

/// Length of the spiral r = φ from its middle.
pub(super) fn arc_length(phi: f64) -> f64 {
    (phi * (1.0 + phi * phi).sqrt() + phi.asinh()) / 2.0
}

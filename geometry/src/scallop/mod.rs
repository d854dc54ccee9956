//! Finishing passes by the scallop that they leave.
//!
//! Between two passes a round tip leaves a ridge, the *scallop*, measured along the surface's normal. Two
//! planners lay passes over a rectangle, each as far from the one before as a scallop allows:
//!
//! * [`ScallopRaster`]: straight lines, after Sood, *Novel algorithms for CAD-free machining* (thesis,
//!   2015), chapter 5. Lines across are laid first, at the largest steps that hold the scallop; their
//!   places are the feed positions of the lines that are cut, which get the largest side steps in turn.
//! * [`ConstantScallop`]: lines that bend; each advances, place by place, as far as the scallop allows
//!   there.
//!
//! # How a scallop is measured
//! The source takes two spheres at one feed position and a ray down from where they meet (eq. 5.1 to 5.12).
//! That breaks where spheres do not meet or the ray hits what no cutter reaches, and knows nothing of the
//! straight moves between positions. Here ([`strip`], [`sweep`]) it is what the two passes really leave: the
//! cutter is dropped at probes between them; there it touches a point P of the surface, with the normal n,
//! and what stands on P after both passes is the way along n from P into what their moves sweep out. On
//! level ground with feed positions side by side it is the source's h = R - √(R² - s²/4). What the cutter
//! cannot touch, narrow grooves, counts as no scallop.
//!
//! The moves measured are those that are cut: with points put in where the path bends
//! ([`crate::DropCutter::bend`]), so that a chord that cuts off a ridge is within a tolerance, and one that
//! bridges a hollow is counted as scallop.
//!
//! # Cutters
//! Any whose tip is round, h(r) convex: balls, bull noses, tapered balls, barrels. What counts is all of the
//! profile, as the cutter touches with it; the flat step, from which the search begins, is twice the radius
//! at the height of the scallop. For balls the sweep is that of the sphere, in closed form; for others it
//! is taken upward and counted along the normal, which is the same on planes. What touches a flat bottom
//! counts under its axis.
//!
//! # Limits
//! * Probes lie at some places only: four across, then where the ridge is, and a tenth of the radius apart
//!   along. What is narrower than that may
//!   stand higher; plans aim 2 % below the scallop for it.
//! * Surfaces steeper than [`Finish::steepest_rad`] do not count: on a wall beside a pass no step would do.
//! * Steps are never less than [`Finish::least_step_mm`]; what is not held is told ([`Held`]).

mod bent;
mod lines;
mod raster;
mod search;
mod strip;
mod sweep;

pub use bent::ConstantScallop;
pub use raster::{Borders, ScallopRaster};

use crate::{Bounds, DropError, Profile, RasterStyle, Segment, Surface, Toolpath};
use glam::DVec3;

/// What is to be finished, and how.
#[derive(Clone, Copy, Debug)]
pub struct Finish<'a> {
    /// The surface.
    pub surface: Surface<'a>,
    /// The cutter's shape.
    pub profile: &'a Profile,
    /// The tip stays over its rectangle.
    pub area: Bounds,
    /// Whether passes run along y; else along x.
    pub along_y: bool,
    /// How passes follow each other.
    pub style: RasterStyle,
    /// The highest scallop, in mm.
    pub scallop_mm: f64,
    /// No step is less, in mm.
    pub least_step_mm: f64,
    /// What is steeper than this does not count, in radians from level.
    pub steepest_rad: f64,
    /// The tip goes no lower, in mm.
    pub floor_mm: f64,
    /// What is left on the surface, in mm.
    pub allowance_mm: f64,
    /// How far the path may be off between two points, in mm: where it bends by more, points are put in.
    pub chord_tolerance_mm: f64,
    /// No path has more points.
    pub most_points: usize,
}

/// A path and what it leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    /// The path of the tip, without the travel between passes that are not joined.
    pub path: Toolpath,
    /// What the probes between its passes found.
    pub held: Held,
}

/// What was found between passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Held {
    /// Highest scallop expected, in mm.
    pub worst_mm: f64,
    /// The point of the surface where.
    pub at: DVec3,
    /// Probes in all.
    pub probes: usize,
    /// Those where more than the scallop stands: for want of room between passes.
    pub above: usize,
}

impl Held {
    fn with(self, other: Self) -> Self {
        let worse = if other.worst_mm > self.worst_mm { other } else { self };
        let (probes, above) = (self.probes + other.probes, self.above + other.above);
        Self { probes, above, ..worse }
    }
}

/// Why there are no passes.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum ScallopError {
    /// The cutter leaves no scallop that a step could hold.
    #[error(
        "a cutter without a round tip leaves no even scallop: on level ground none, on a slope steps; take \
         a ball, a bull nose or a tapered ball"
    )]
    NotRound,
    /// A cutter that is hollow, so that it may touch beside the place that is looked at.
    #[error("the cutter's profile must steepen outward all the way, as that of a ball does")]
    NotConvex,
    /// No height for scallops.
    #[error(
        "the scallop must be a positive height of less than the radius of the tip, {tip_mm} mm, not \
         {scallop_mm} mm"
    )]
    BadScallop {
        /// What was given, in mm.
        scallop_mm: f64,
        /// Radius of the cutter's rounding, in mm.
        tip_mm: f64,
    },
    /// Another length that is none.
    #[error("the {what} must be {must}, not {value}")]
    BadNumber {
        /// Which.
        what: &'static str,
        /// What it has to be.
        must: &'static str,
        /// What was given.
        value: f64,
    },
    /// Nowhere to cut.
    #[error("the area is no box of finite size")]
    NoArea,
    /// The path would be too long.
    #[error("more than {0} points would be needed: the scallop or the least step is too small")]
    TooManyPoints(usize),
    /// The cutter cannot be dropped.
    #[error(transparent)]
    Drop(#[from] DropError),
}

impl Finish<'_> {
    /// Whether it can be done at all.
    fn check(&self) -> Result<(), ScallopError> {
        let tip_mm = rounding_mm(self.profile).ok_or(ScallopError::NotRound)?;
        if !is_convex(self.profile) {
            return Err(ScallopError::NotConvex);
        }
        let scallop_mm = self.scallop_mm;
        if !(scallop_mm > 0.0 && scallop_mm < tip_mm) {
            return Err(ScallopError::BadScallop { scallop_mm, tip_mm });
        }
        let bad = |what, must, value| Err(ScallopError::BadNumber { what, must, value });
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if !positive(self.least_step_mm) {
            return bad("least step", "a positive length in mm", self.least_step_mm);
        }
        if !(self.chord_tolerance_mm.is_finite() && self.chord_tolerance_mm >= 0.0) {
            return bad("chord tolerance", "a length in mm", self.chord_tolerance_mm);
        }
        if !positive(self.steepest_rad) {
            return bad("steepest slope", "an angle", self.steepest_rad);
        }
        let (min, max) = (self.area.min.truncate(), self.area.max.truncate());
        let sound = min.is_finite() && max.is_finite() && min.cmple(max).all();
        let size = (max - min) / self.flat_step_mm();
        if !(sound && self.floor_mm.is_finite()) {
            return Err(ScallopError::NoArea);
        }
        // A plane would have as many.
        if (size.x + 1.0) * (size.y + 1.0) > self.most_points as f64 {
            return Err(ScallopError::TooManyPoints(self.most_points));
        }
        Ok(())
    }

    /// The step at which the scallop on level ground is as high as it may be, in mm: 2·√(2Rε - ε²) for a ball
    /// of radius R.
    fn flat_step_mm(&self) -> f64 {
        let (mut low, mut high) = (0.0, self.profile.radius_mm());
        if self.profile.height(high) <= self.scallop_mm {
            return 2.0 * high;
        }
        // As often as f64 can be halved to no effect.
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            let below = self.profile.height(middle) < self.scallop_mm;
            (low, high) = if below { (middle, high) } else { (low, middle) };
        }
        2.0 * low
    }
}

/// The radius of the first arc of a profile, in mm: what rounds its tip.
fn rounding_mm(profile: &Profile) -> Option<f64> {
    let arc = |segment: &Segment| match *segment {
        Segment::Arc { to, center } => Some((to[0] - center[0]).hypot(to[1] - center[1])),
        Segment::Line { .. } => None,
    };
    profile.segments().iter().find_map(arc)
}

/// Whether a profile steepens outward.
fn is_convex(profile: &Profile) -> bool {
    let mut steepest = 0.0;
    let mut from = [0.0; 2];
    for segment in profile.segments() {
        let to = segment.to();
        // Directions as angles from level.
        let (first, last) = match *segment {
            Segment::Line { .. } => {
                let angle = (to[1] - from[1]).atan2(to[0] - from[0]);
                (angle, angle)
            }
            Segment::Arc { center, .. } => {
                let at = |p: [f64; 2]| (p[0] - center[0]).atan2(center[1] - p[1]);
                (at(from), at(to))
            }
        };
        // Shapes come with ten digits or so.
        if first < steepest - 1e-8 {
            return false;
        }
        (steepest, from) = (last, to);
    }
    true
}

#[cfg(test)]
mod tests;

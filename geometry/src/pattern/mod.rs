//! Where a cutter is to be dropped: lines over the XY plane.
//!
//! Every layout but the [`Raster`](crate::Raster) works alike: it draws its *strokes* (a spiral, a
//! ring, a spoke) over all of the part, [`Region`] cuts them down to what lies inside, and
//! `Layer` puts the pieces in order and links those that lie close to each other. The raster's
//! lines are cut in closed form.

mod circles;
mod contour;
mod cross;
mod even;
mod hilbert;
mod layer;
mod radial;
mod region;
mod remnant;
mod spiral;
#[cfg(test)]
mod tests;

pub use circles::Circles;
pub use contour::ContourParallel;
pub use cross::CrossRaster;
pub use hilbert::Hilbert;
pub use radial::Radial;
pub use region::Region;
pub use spiral::Spiral;

pub(crate) use even::{STEP_SLACK, along, between};
pub(crate) use layer::{Layer, Stroke, push};

use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A run of points that the cutter visits in order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatternSpan {
    /// Indices into [`Pattern::points`]; never empty.
    pub points: Range<usize>,
    /// Whether this only joins one pass to the next (true) or is a pass itself (false).
    pub link: bool,
    /// Whether the cutter comes to the first point along the surface from the last point of the
    /// span before; if not it retracts, travels and plunges.
    pub joined: bool,
}

/// A plan view of a tool path: passes and the links between them, in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pattern {
    /// All points in the order they are visited.
    pub points: Vec<DVec2>,
    /// The runs they make up, in order, without gaps.
    pub spans: Vec<PatternSpan>,
}

impl Pattern {
    /// No passes at all.
    pub(crate) const EMPTY: Self = Self { points: Vec::new(), spans: Vec::new() };

    /// Adds the passes of another pattern, which are not joined to these.
    pub(crate) fn append(&mut self, other: Self) {
        let moved = self.points.len();
        self.points.extend(other.points);
        self.spans.extend(other.spans.into_iter().map(|span| PatternSpan {
            points: span.points.start + moved..span.points.end + moved,
            ..span
        }));
    }
}

/// A way to lay passes over a region.
pub trait Layout {
    /// About how many points have to be worked out for [`Self::pattern`]; infinite when a step is
    /// not a positive number. Strokes are drawn over the circle around the region or its box and
    /// then cut down, so that the pattern may have fewer.
    fn count(&self, region: &Region) -> f64;

    /// The passes over `region`. Empty when a step is not a positive number.
    ///
    /// Time and memory grow with [`Self::count`]: look at it first.
    fn pattern(&self, region: &Region) -> Pattern;
}

/// Distances that every layout keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Distance between neighbouring passes, in mm, positive.
    pub stepover_mm: f64,
    /// Distance between points along a pass, in mm, positive. Less where a pass ends, where it
    /// would cut a corner, and where a chord would lie off a curve by more than [`Self::sagitta_mm`].
    pub feed_step_mm: f64,
}

/// How far a straight move may lie off the curve it stands for, as a share of the stepover. The
/// height left between passes goes with the square of their distance, so 2 % more of it leaves 4 %.
const SAGITTA_SHARE: f64 = 0.02;

impl Pace {
    /// How far a straight move may lie off its curve, in mm: 2 % of the stepover.
    #[must_use]
    pub fn sagitta_mm(&self) -> f64 {
        SAGITTA_SHARE * self.stepover_mm
    }

    pub(crate) fn is_sound(&self) -> bool {
        [self.stepover_mm, self.feed_step_mm].iter().all(|s| s.is_finite() && *s > 0.0)
    }
}

/// Which end of a layout comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// The middle of the area; passes go outwards.
    Middle,
    /// The border of the area; passes go inwards.
    Outside,
}

impl Start {
    /// 1 from the middle. -1 from outside, for strokes that are drawn from the middle and passed
    /// backwards: drawn the other way round, they are passed as wanted.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Middle => 1.0,
            Self::Outside => -1.0,
        }
    }
}

/// Which way round passes go, seen from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// As the angle grows.
    CounterClockwise,
    /// The other way.
    Clockwise,
}

impl Turn {
    /// 1 counter-clockwise, -1 clockwise.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::CounterClockwise => 1.0,
            Self::Clockwise => -1.0,
        }
    }
}

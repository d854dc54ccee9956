//! Two rasters at right angles, the second after the first.
//!
//! The first leaves scallops between its passes; the second goes across them. It only adds passes:
//! the first is the plain [`Raster`], point by point.

use super::{Layout, Pattern, PatternSpan, Region};
use crate::Raster;
use std::f64::consts::FRAC_PI_2;

/// A raster and another one across it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossRaster {
    /// The first; the second is turned a quarter turn from it.
    pub first: Raster,
}

impl CrossRaster {
    fn second(&self) -> Raster {
        Raster { direction_rad: self.first.direction_rad + FRAC_PI_2, ..self.first }
    }
}

impl Layout for CrossRaster {
    fn count(&self, region: &Region) -> f64 {
        Layout::count(&self.first, region) + Layout::count(&self.second(), region)
    }

    fn pattern(&self, region: &Region) -> Pattern {
        let mut pattern = Layout::pattern(&self.first, region);
        let second = Layout::pattern(&self.second(), region);
        let before = pattern.points.len();
        pattern.points.extend(second.points);
        pattern.spans.extend(second.spans.into_iter().map(|span| PatternSpan {
            points: span.points.start + before..span.points.end + before,
            ..span
        }));
        pattern
    }
}

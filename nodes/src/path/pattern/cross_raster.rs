//! Two rasters at right angles.

use super::{Area, Passes, laid};
use crate::path::raster::Style;
use carvegraph_core::{Context, Node, NodeError, Params};
use carvegraph_geometry::{CrossRaster, Pace, Raster};

/// Lays parallel passes over a part, and then others across them that take off what those left.
#[derive(Clone, Debug, Params)]
pub(crate) struct CrossRasterNode {
    /// Distance between neighbouring passes.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) stepover: f64,
    /// Distance between points along a pass.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) feed_step: f64,
    /// Which way the passes follow each other.
    #[param(default = Style::Zigzag)]
    pub(crate) style: Style,
    /// Angle of the first passes from the x axis, counter-clockwise.
    #[param(unit = "deg", default = 0.0, range = -180.0..=180.0)]
    pub(crate) angle: f64,
}

impl Node for CrossRasterNode {
    const KIND: &'static str = "cross_raster";
    type Inputs<'a> = Area<'a>;
    type Outputs = Passes;

    fn run(&self, area: Area<'_>, _: &Context<'_>) -> Result<Passes, NodeError> {
        let pace = Pace { stepover_mm: self.stepover, feed_step_mm: self.feed_step };
        let first = Raster {
            stepover_mm: self.stepover,
            feed_step_mm: self.feed_step,
            direction_rad: self.angle.to_radians(),
            style: self.style.into(),
        };
        laid(&CrossRaster { first }, pace, &area)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{over, over_half, refusal};
    use super::*;
    use crate::testing::run;

    const NODE: CrossRasterNode =
        CrossRasterNode { stepover: 1.0, feed_step: 0.5, style: Style::Zigzag, angle: 0.0 };

    #[test]
    fn it_goes_both_ways_and_keeps_to_a_boundary() {
        let all = over((10.0, 6.0), |area| run(|cx| NODE.run(area, cx))).unwrap();
        let passes = all.spans.iter().filter(|span| !span.link).count();
        assert_eq!(passes, 7 + 11);
        assert_eq!(all.spans.iter().filter(|span| !span.joined).count(), 2);
        let half = over_half((10.0, 6.0), |area| run(|cx| NODE.run(area, cx)));
        assert!(half.points.len() < all.points.len());
    }

    #[test]
    fn too_many_points_are_refused_with_their_number() {
        let fine = CrossRasterNode { stepover: 1e-9, ..NODE };
        let (param, message) = refusal(over((10.0, 10.0), |area| run(|cx| fine.run(area, cx))));
        assert_eq!(param, "stepover");
        assert!(message.contains("would make 4.200e11 points; the limit is 5e7"), "{message}");
    }
}

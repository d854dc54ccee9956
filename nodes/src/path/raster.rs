//! Parallel passes over a part.

use super::pattern::{Area, Passes, laid};
use carvegraph_core::{Choice, Context, Node, NodeError, Params};
use carvegraph_geometry::{Pace, Raster, RasterStyle};
use std::f64::consts::FRAC_PI_2;

/// Lays parallel passes over a part, along its longer side if nothing else is said.
#[derive(Clone, Debug, Params)]
pub(crate) struct RasterNode {
    /// Distance between neighbouring passes.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) stepover: f64,
    /// Distance between points along a pass.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) feed_step: f64,
    /// Which way the passes follow each other.
    #[param(default = Style::Zigzag)]
    pub(crate) style: Style,
    /// The side that passes run along.
    #[param(default = Along::Longer)]
    pub(crate) along: Along,
    /// Angle that the passes are turned by, counter-clockwise.
    #[param(unit = "deg", default = 0.0, range = -180.0..=180.0)]
    pub(crate) angle: f64,
}

/// How passes follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Style {
    /// There and back, linked along the surface.
    Zigzag,
    /// All the same way, lifted back in between.
    OneWay,
    /// As one way, in the order that leaves material on the right: climb with a clockwise spindle.
    Climb,
    /// As one way, in the order that leaves material on the left.
    Conventional,
}

/// The side that passes run along.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Along {
    /// The part's longer side; x if both are equal.
    Longer,
    /// The x axis.
    X,
    /// The y axis.
    Y,
}

impl From<Style> for RasterStyle {
    fn from(style: Style) -> Self {
        match style {
            Style::Zigzag => Self::Zigzag,
            Style::OneWay => Self::OneWay,
            Style::Climb => Self::Climb,
            Style::Conventional => Self::Conventional,
        }
    }
}

impl Node for RasterNode {
    const KIND: &'static str = "raster";
    type Inputs<'a> = Area<'a>;
    type Outputs = Passes;

    fn run(&self, area: Area<'_>, _: &Context<'_>) -> Result<Passes, NodeError> {
        let size = area.area.size();
        let along_y = match self.along {
            Along::Longer => size.y > size.x,
            Along::X => false,
            Along::Y => true,
        };
        let base_rad = if along_y { FRAC_PI_2 } else { 0.0 };
        let raster = Raster {
            stepover_mm: self.stepover,
            feed_step_mm: self.feed_step,
            direction_rad: base_rad + self.angle.to_radians(),
            style: self.style.into(),
        };
        let pace = Pace { stepover_mm: self.stepover, feed_step_mm: self.feed_step };
        laid(&raster, pace, &area)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::pattern::testing::{over, over_half, refusal};
    use crate::testing::run;
    use carvegraph_geometry::{DVec2, Pattern};

    const NODE: RasterNode = RasterNode {
        stepover: 1.0,
        feed_step: 1.0,
        style: Style::Zigzag,
        along: Along::Longer,
        angle: 0.0,
    };

    fn pattern(node: &RasterNode, width: f64, height: f64) -> Result<Pattern, NodeError> {
        over((width, height), |area| run(|cx| node.run(area, cx)))
    }

    fn first_step(node: &RasterNode, width: f64, height: f64) -> DVec2 {
        let points = pattern(node, width, height).unwrap().points;
        (points[1] - points[0]).round()
    }

    #[test]
    fn passes_run_along_the_longer_side_unless_told_otherwise() {
        assert_eq!(first_step(&NODE, 9.0, 5.0), DVec2::X);
        assert_eq!(first_step(&NODE, 5.0, 9.0), DVec2::Y);
        assert_eq!(first_step(&NODE, 5.0, 5.0), DVec2::X);
        let along = |along| RasterNode { along, ..NODE };
        assert_eq!(first_step(&along(Along::X), 5.0, 9.0), DVec2::X);
        assert_eq!(first_step(&along(Along::Y), 9.0, 5.0), DVec2::Y);
        assert_eq!(first_step(&RasterNode { angle: 90.0, ..NODE }, 9.0, 5.0), DVec2::Y);
    }

    #[test]
    fn climb_keeps_what_is_uncut_on_the_right() {
        for (style, first_y) in
            [(Style::OneWay, 0.0), (Style::Climb, 5.0), (Style::Conventional, 0.0)]
        {
            let points = pattern(&RasterNode { style, ..NODE }, 9.0, 5.0).unwrap().points;
            assert_eq!((points[0], points[1].x), (DVec2::new(0.0, first_y), 1.0), "{style:?}");
        }
    }

    #[test]
    fn too_many_points_are_refused_with_their_number() {
        let fine = RasterNode { stepover: 1e-9, ..NODE };
        let (param, message) = refusal(pattern(&fine, 10.0, 10.0));
        assert_eq!(param, "stepover");
        assert!(message.contains("would make 1.100e11 points; the limit is 5e7"), "{message}");
    }

    #[test]
    fn passes_end_at_a_boundary() {
        let half = over_half((10.0, 10.0), |area| run(|cx| NODE.run(area, cx)));
        let lengths: Vec<usize> =
            half.spans.iter().filter(|span| !span.link).map(|span| span.points.len()).collect();
        // The last line only touches a corner.
        assert_eq!(lengths, [11, 10, 9, 8, 7, 6, 5, 4, 3, 2]);
    }
}

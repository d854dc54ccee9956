//! Parallel passes over a part.

use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Bounds, Pattern, Raster, RasterStyle};
use std::f64::consts::FRAC_PI_2;

/// No pattern has more points: from the path of them to its program they take some 7 GB.
pub(crate) const MAX_POINTS: f64 = 5e7;

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

#[derive(Inputs)]
pub(crate) struct Area<'a> {
    /// The box that holds the part.
    area: &'a Bounds,
}

#[derive(Outputs)]
pub(crate) struct Passes {
    /// The passes as seen from above.
    pattern: Pattern,
}

impl Node for RasterNode {
    const KIND: &'static str = "raster";
    type Inputs<'a> = Area<'a>;
    type Outputs = Passes;

    fn run(&self, inputs: Area<'_>, _: &Context<'_>) -> Result<Passes, NodeError> {
        let size = inputs.area.size();
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
            style: match self.style {
                Style::Zigzag => RasterStyle::Zigzag,
                Style::OneWay => RasterStyle::OneWay,
            },
        };
        self.check_count(raster.count(inputs.area))?;
        Ok(Passes { pattern: raster.pattern(inputs.area) })
    }
}

impl RasterNode {
    fn check_count(&self, count: f64) -> Result<(), NodeError> {
        if count <= MAX_POINTS {
            return Ok(());
        }
        let param = if self.stepover <= self.feed_step { "stepover" } else { "feed_step" };
        Err(NodeError::refused(
            param,
            format!(
                "stepover {} mm and feed_step {} mm would make {count:.3e} points; the limit is \
                 {MAX_POINTS:.0e}",
                self.stepover, self.feed_step
            ),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::{DVec2, DVec3};

    const NODE: RasterNode = RasterNode {
        stepover: 1.0,
        feed_step: 1.0,
        style: Style::Zigzag,
        along: Along::Longer,
        angle: 0.0,
    };

    fn pattern(node: &RasterNode, width: f64, height: f64) -> Result<Pattern, NodeError> {
        let area = Bounds { min: DVec3::ZERO, max: DVec3::new(width, height, 5.0) };
        run(|cx| node.run(Area { area: &area }, cx)).map(|passes| passes.pattern)
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
    fn too_many_points_are_refused_with_their_number() {
        let fine = RasterNode { stepover: 1e-9, ..NODE };
        let Err(NodeError::Refused { param, message }) = pattern(&fine, 10.0, 10.0) else {
            panic!("it must be refused")
        };
        assert_eq!(param, "stepover");
        assert!(message.contains("would make 1.100e11 points; the limit is 5e7"), "{message}");
    }
}

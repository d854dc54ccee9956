//! Parallel passes over a part.

use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Bounds, Pattern, Raster, RasterStyle};
use std::f64::consts::FRAC_PI_2;

/// No pattern has more points: from the path of them to its program they take some 7 GB.
const MAX_POINTS: f64 = 5e7;

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

//! How far the machined surface lies from the one that was meant, in figures and as a picture.
//!
//! Distances are those to the nearest point of the target, see [`carvegraph_geometry::deviation`]. What no
//! cutter can reach counts as excess; held against the surface that a cutter leaves (`rest_area.left`)
//! only what this program left of what could be reached does.

use crate::output::{draw_deviation, save_png};
use carvegraph_core::{Context, Inputs, Node, NodeError, OutputName, Outputs, Params};
use carvegraph_geometry::{
    Bounds, DVec2, Deviation, DeviationError, FIRST_ORDER_MM, HeightField, Mesh, Target, deviation,
};

/// Compares the machined surface with the one that was meant and draws where it lies above and below. Without
/// one there is nothing to compare with, and nothing is drawn.
#[derive(Clone, Debug, Params)]
pub(crate) struct DeviationNode {
    /// The file's name without its extension; {prefix} stands for the input's name.
    #[param(default = "{prefix}-deviation")]
    pub(crate) name: OutputName,
    /// The deviation at which the colours end. 0 takes what 99 % of the nodes stay within.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1000.0)]
    pub(crate) range: f64,
    /// Width of a band along the target's border that does not count.
    #[param(unit = "mm", default = 0.0, range = 0.0..=10_000.0)]
    pub(crate) border: f64,
    /// The longer side of the picture.
    #[param(unit = "px", default = 1000, range = 64..=4096)]
    pub(crate) size: u32,
}

#[derive(Inputs)]
pub(crate) struct Compared<'a> {
    /// The machined surface.
    machined: &'a HeightField,
    /// The box that holds the part; the machined surface begins at its near left corner.
    part: &'a Bounds,
    /// The surface that was meant.
    surface: Option<&'a HeightField>,
    /// The mesh that was meant, instead of a surface.
    mesh: Option<&'a Mesh>,
}

#[derive(Outputs)]
pub(crate) struct Found {
    /// How far each node is off.
    deviation: Deviation,
}

impl Node for DeviationNode {
    const KIND: &'static str = "deviation";
    type Inputs<'a> = Compared<'a>;
    type Outputs = Found;

    fn run(&self, inputs: Compared<'_>, cx: &Context<'_>) -> Result<Found, NodeError> {
        let target = match (inputs.surface, inputs.mesh) {
            (Some(surface), None) => Target::Field(surface, DVec2::ZERO),
            (None, Some(mesh)) => Target::Mesh(mesh),
            (None, None) => return Ok(Found { deviation: Deviation::nowhere() }),
            (Some(_), Some(_)) => {
                let message = "there are two things to compare with: connect a surface or a mesh";
                return Err(NodeError::failed(message));
            }
        };
        let machined = inputs.machined;
        let corner = inputs.part.min.truncate();
        let ticker = cx.ticker(machined.heights().len());
        let found = deviation(machined, corner, target, self.border, &|n| ticker.tick(n));
        let deviation = found.map_err(|fault| match fault {
            DeviationError::Stopped => NodeError::Cancelled,
            fault => NodeError::failed(fault),
        })?;
        if deviation.extent.nodes == 0 {
            let message =
                "no node of the machined surface lies over the target: is the border too wide?";
            return Err(NodeError::failed(message));
        }
        let range = self.range(&deviation);
        save_png(&self.name, &draw_deviation(&deviation, range, self.size), cx)?;
        Ok(Found { deviation })
    }
}

impl DeviationNode {
    /// Where the colours end, in mm.
    fn range(&self, deviation: &Deviation) -> f64 {
        if self.range > 0.0 {
            return self.range;
        }
        let extent = &deviation.extent;
        // Rounded up, so that the scale has room for whole figures.
        let within = extent.p99_excess_mm.max(extent.p99_gouge_mm).max(10.0 * FIRST_ORDER_MM);
        let unit = 10_f64.powf(within.log10().floor());
        (within / unit).ceil() * unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::DVec3;

    const NODE: fn() -> DeviationNode = || DeviationNode {
        name: OutputName::new("map").unwrap(),
        range: 0.0,
        border: 0.0,
        size: 200,
    };

    const PART: Bounds =
        Bounds { min: DVec3::new(3.0, 2.0, 0.0), max: DVec3::new(13.0, 12.0, 1.0) };

    fn level(z: f32) -> HeightField {
        HeightField::new(11, 11, 1.0, vec![z; 121]).unwrap()
    }

    fn compare(node: &DeviationNode, inputs: Compared<'_>) -> Result<Deviation, String> {
        let found = run(|cx| node.run(inputs, cx)).map_err(|fault| fault.to_string());
        found.map(|found| found.deviation)
    }

    #[test]
    fn the_nearest_is_counted_and_colours_end_at_a_round_figure() {
        let (machined, target) = (level(1.23), level(1.0));
        let node = NODE();
        let inputs =
            Compared { machined: &machined, part: &PART, surface: Some(&target), mesh: None };
        let found = compare(&node, inputs).unwrap();
        assert!((found.extent.max_excess_mm - 0.23).abs() < 1e-6);
        assert!((node.range(&found) - 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_target_must_lie_below_and_without_one_nothing_is_compared() {
        let machined = level(1.0);
        let inputs = Compared { machined: &machined, part: &PART, surface: None, mesh: None };
        assert_eq!(compare(&NODE(), inputs).unwrap().extent.nodes, 0);
        let inputs =
            Compared { machined: &machined, part: &PART, surface: Some(&machined), mesh: None };
        let node = DeviationNode { border: 6.0, ..NODE() };
        let fault = compare(&node, inputs).unwrap_err();
        assert!(
            fault.starts_with("no node of the machined surface lies over the target"),
            "{fault}"
        );
    }
}

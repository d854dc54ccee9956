//! How far the machined surface lies from the one that was meant.
//!
//! Distances are those to the nearest point of the target, see [`carvegraph_geometry::deviation`]. What no
//! cutter can reach counts as excess; held against the surface that a cutter leaves (`rest_area.left`)
//! only what this program left of what could be reached does.

use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{
    Bounds, DVec2, Deviation, DeviationError, HeightField, Mesh, Target, deviation,
};

/// Compares the machined surface with the one that was meant: how far it lies above or below at each node, along
/// the normal. Without one there is nothing to compare with, and no node counts.
#[derive(Clone, Debug, Params)]
pub(crate) struct DeviationNode {
    /// Width of a band along the target's border that does not count.
    #[param(unit = "mm", default = 0.0, range = 0.0..=10_000.0)]
    pub(crate) border: f64,
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
        Ok(Found { deviation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::DVec3;

    const NODE: DeviationNode = DeviationNode { border: 0.0 };

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
    fn distances_have_their_sign() {
        let (machined, target) = (level(1.23), level(1.0));
        let inputs =
            Compared { machined: &machined, part: &PART, surface: Some(&target), mesh: None };
        let found = compare(&NODE, inputs).unwrap();
        assert!((found.extent.max_excess_mm - 0.23).abs() < 1e-6);
        assert_eq!(found.extent.max_gouge_mm, 0.0);
    }

    #[test]
    fn a_target_must_lie_below_and_without_one_nothing_is_compared() {
        let machined = level(1.0);
        let inputs = Compared { machined: &machined, part: &PART, surface: None, mesh: None };
        assert_eq!(compare(&NODE, inputs).unwrap().extent.nodes, 0);
        let inputs =
            Compared { machined: &machined, part: &PART, surface: Some(&machined), mesh: None };
        let node = DeviationNode { border: 6.0 };
        let fault = compare(&node, inputs).unwrap_err();
        assert!(
            fault.starts_with("no node of the machined surface lies over the target"),
            "{fault}"
        );
    }
}

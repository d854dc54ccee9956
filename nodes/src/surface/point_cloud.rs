//! The points of a surface.

use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{HeightField, PointCloud, point_cloud};

/// Takes the points of a surface, one a pixel, row by row from the near left corner.
#[derive(Clone, Debug, Params)]
pub(crate) struct PointCloudNode {}

#[derive(Inputs)]
pub(crate) struct Surface<'a> {
    /// The surface.
    surface: &'a HeightField,
}

#[derive(Outputs)]
pub(crate) struct Points {
    /// Its points, in the order of the grid.
    points: PointCloud,
}

impl Node for PointCloudNode {
    const KIND: &'static str = "point_cloud";
    type Inputs<'a> = Surface<'a>;
    type Outputs = Points;

    fn run(&self, inputs: Surface<'_>, cx: &Context<'_>) -> Result<Points, NodeError> {
        let ticker = cx.ticker(inputs.surface.rows());
        let points = cx.completed(point_cloud(inputs.surface, &|n| ticker.tick(n)))?;
        Ok(Points { points })
    }
}

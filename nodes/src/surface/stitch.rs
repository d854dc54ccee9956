//! Points in the order of a grid, stitched into triangles.
//!
//! Two triangles a cell, (columns - 1)·(rows - 1)·2 in all, wound so that normals point up (Sood
//! 2015, section 3.2.5). A closed solid gets walls and a base as well.

use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Mesh, PointCloud, StitchError, close_solid, stitch};

/// Stitches points into a surface of triangles, or a solid that can be printed.
#[derive(Clone, Debug, Params)]
pub(crate) struct Stitch {
    /// Whether to close the surface into a solid.
    #[param(default = Shape::Open)]
    pub(crate) shape: Shape,
    /// How far below the lowest point the base of a closed solid lies.
    #[param(unit = "mm", default = 2.0, range = 0.01..=1000.0)]
    pub(crate) base: f64,
}

/// What the stitcher makes.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Shape {
    /// The surface alone.
    Open,
    /// A watertight solid with walls and a base.
    Closed,
}

#[derive(Inputs)]
pub(crate) struct Ordered<'a> {
    /// Points in the order of a grid.
    points: &'a PointCloud,
}

#[derive(Outputs)]
pub(crate) struct Stitched {
    /// The triangles.
    mesh: Mesh,
}

impl Node for Stitch {
    const KIND: &'static str = "stitch";
    type Inputs<'a> = Ordered<'a>;
    type Outputs = Stitched;

    fn run(&self, inputs: Ordered<'_>, cx: &Context<'_>) -> Result<Stitched, NodeError> {
        let rows = inputs.points.grid.map_or(1, |(_, rows)| rows);
        let ticker = cx.ticker(rows);
        let mesh = stitch(inputs.points, &|n| ticker.tick(n)).map_err(|fault| match fault {
            StitchError::Stopped => NodeError::Cancelled,
            fault => NodeError::failed(fault),
        })?;
        let (Shape::Closed, Some(grid)) = (self.shape, inputs.points.grid) else {
            return Ok(Stitched { mesh });
        };
        let lowest = mesh.vertices.iter().map(|vertex| vertex.z).fold(f64::INFINITY, f64::min);
        let mesh = close_solid(&mesh, grid, lowest - self.base).map_err(NodeError::failed)?;
        Ok(Stitched { mesh })
    }
}

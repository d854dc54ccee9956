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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::DVec3;
    use std::sync::Arc;

    fn stitched(shape: Shape, grid: Option<(usize, usize)>) -> Result<Mesh, NodeError> {
        let point = |i: usize| DVec3::new((i % 3) as f64, (i / 3) as f64, 1.0 + (i % 2) as f64);
        let points = PointCloud { points: Arc::new((0..6).map(point).collect()), grid };
        run(|cx| Stitch { shape, base: 2.0 }.run(Ordered { points: &points }, cx)).map(|s| s.mesh)
    }

    #[test]
    fn a_closed_solid_stands_on_its_base() {
        let open = stitched(Shape::Open, Some((3, 2))).unwrap();
        let closed = stitched(Shape::Closed, Some((3, 2))).unwrap();
        assert_eq!(open.triangles.len(), 4);
        // Six edges of rim get two triangles of wall and one of base each.
        assert_eq!(closed.triangles.len(), 4 + 3 * 6);
        let lowest = closed.vertices.iter().map(|v| v.z).fold(f64::INFINITY, f64::min);
        assert_eq!(lowest, 1.0 - 2.0);
    }

    #[test]
    fn points_in_no_order_are_refused() {
        let message = stitched(Shape::Open, None).unwrap_err().to_string();
        assert!(message.contains("only the points of a grid can be stitched"), "{message}");
    }
}

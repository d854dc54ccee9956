//! Points in the order of a grid, stitched into triangles.
//!
//! Two triangles a cell, (columns - 1)·(rows - 1)·2 in all, wound so that normals point up (Sood
//! 2015, section 3.2.5). A closed solid gets walls and a base as well.

use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params, Yielding};
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
    /// Height of the base of a closed solid, in place of that; for solids whose thickness counts.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) base_z: Yielding<f64>,
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
        let base_z = self.base_z.or(Some(lowest - self.base));
        if base_z >= lowest {
            let message = format!(
                "{base_z} mm is not below the surface, whose lowest point is at {lowest:.4} mm"
            );
            return Err(NodeError::refused("base_z", message));
        }
        let mesh = close_solid(&mesh, grid, base_z).map_err(NodeError::failed)?;
        Ok(Stitched { mesh })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::DVec3;
    use std::sync::Arc;

    const LEFT: Yielding<f64> = Yielding::left(0.0);

    fn stitched(
        shape: Shape,
        base_z: Yielding<f64>,
        grid: Option<(usize, usize)>,
    ) -> Result<Mesh, NodeError> {
        let point = |i: usize| DVec3::new((i % 3) as f64, (i / 3) as f64, 1.0 + (i % 2) as f64);
        let points = PointCloud { points: Arc::new((0..6).map(point).collect()), grid };
        let node = Stitch { shape, base: 2.0, base_z };
        run(|cx| node.run(Ordered { points: &points }, cx)).map(|stitched| stitched.mesh)
    }

    fn lowest(mesh: &Mesh) -> f64 {
        mesh.vertices.iter().map(|v| v.z).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_closed_solid_stands_on_its_base() {
        let open = stitched(Shape::Open, LEFT, Some((3, 2))).unwrap();
        let closed = stitched(Shape::Closed, LEFT, Some((3, 2))).unwrap();
        assert_eq!(open.triangles.len(), 4);
        // Six edges of rim get two triangles of wall and one of base each.
        assert_eq!(closed.triangles.len(), 4 + 3 * 6);
        assert_eq!(lowest(&closed), 1.0 - 2.0);
    }

    #[test]
    fn a_base_at_a_height_of_its_own_must_lie_below_the_surface() {
        let at = |z| stitched(Shape::Closed, Yielding::given(z), Some((3, 2)));
        assert_eq!(lowest(&at(0.25).unwrap()), 0.25);
        let told = at(1.0).unwrap_err().to_string();
        assert_eq!(told, "1 mm is not below the surface, whose lowest point is at 1.0000 mm");
    }

    #[test]
    fn points_in_no_order_are_refused() {
        let message = stitched(Shape::Open, LEFT, None).unwrap_err().to_string();
        assert!(message.contains("only the points of a grid can be stitched"), "{message}");
    }
}

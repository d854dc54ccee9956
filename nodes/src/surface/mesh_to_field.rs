//! The top of a mesh as a surface with one height a node, so that all that works on reliefs works on
//! meshes.
//!
//! Exact at every node: the highest facet, edge or vertex over it, see
//! [`mesh_to_field`]. Between nodes the surface is flat in pieces,
//! so an edge of the mesh between two nodes is rounded off over one pitch. What lies below an overhang
//! is not seen; no three-axis cutter gets there either.

use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params, Yielding};
use carvegraph_geometry::{Bounds, FieldGrid, HeightField, Mesh, mesh_to_field};

use crate::picture::MAX_PIXELS;

/// Looks at a mesh from above and notes the highest point over each node of a grid.
#[derive(Clone, Debug, Params)]
pub(crate) struct MeshToField {
    /// Distance between the nodes.
    #[param(unit = "mm", default = 0.2, range = 0.001..=1000.0)]
    pub(crate) pitch: f64,
    /// Height where the mesh has nothing. Left alone, it is that of the mesh's lowest point.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) floor: Yielding<f64>,
}

#[derive(Inputs)]
pub(crate) struct Solid<'a> {
    /// The mesh.
    mesh: &'a Mesh,
}

#[derive(Outputs)]
pub(crate) struct Seen {
    /// The surface; its near left corner, that of the mesh's box, is the origin.
    surface: HeightField,
    /// The box that holds the surface.
    bounds: Bounds,
}

impl Node for MeshToField {
    const KIND: &'static str = "mesh_to_field";
    type Inputs<'a> = Solid<'a>;
    type Outputs = Seen;

    fn run(&self, inputs: Solid<'_>, cx: &Context<'_>) -> Result<Seen, NodeError> {
        let mesh = inputs.mesh;
        let bounds = mesh.bounds().ok_or_else(|| NodeError::failed("the mesh has no triangles"))?;
        let grid = self.grid(bounds)?;
        let (x, y) = (bounds.min.x, bounds.min.y);
        if (x, y) != (0.0, 0.0) {
            cx.note(format!("the surface begins at 0, 0; in the mesh that was {x:.4}, {y:.4} mm"));
        }
        let floor = self.floor.or(Some(bounds.min.z)) as f32;
        let ticker = cx.ticker(mesh.triangles.len() * grid.rows.min(32));
        let heights = mesh_to_field(mesh, bounds, grid, floor, &|n| ticker.tick(n));
        let heights = cx.completed(heights)?;
        let surface = HeightField::new(grid.columns, grid.rows, grid.pitch_mm, heights);
        let surface = surface.map_err(NodeError::failed)?;
        let bounds = surface.bounds();
        Ok(Seen { surface, bounds })
    }
}

impl MeshToField {
    /// The nodes over the mesh's box, if they are neither too few nor too many.
    fn grid(&self, bounds: Bounds) -> Result<FieldGrid, NodeError> {
        let grid = FieldGrid::over(bounds, self.pitch);
        let (FieldGrid { columns, rows, .. }, size) = (grid, bounds.size());
        let of = format!("{:.3} × {:.3} mm", size.x, size.y);
        if columns < 2 || rows < 2 {
            let message = format!(
                "{} mm is too wide for a mesh of {of}: it leaves {columns} × {rows} nodes, and a \
                 surface needs 2 × 2",
                self.pitch
            );
            return Err(NodeError::refused("pitch", message));
        }
        if columns.saturating_mul(rows) as u64 > MAX_PIXELS {
            let message = format!(
                "{} mm makes {columns} × {rows} nodes over a mesh of {of}; the limit is {MAX_PIXELS}: \
                 take a wider pitch",
                self.pitch
            );
            return Err(NodeError::refused("pitch", message));
        }
        Ok(grid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::DVec3;
    use std::sync::Arc;

    fn seen(pitch: f64, floor: Yielding<f64>) -> Result<HeightField, String> {
        let corners = [[5., 7., 2.], [9., 7., 4.], [5., 11., 6.]].map(DVec3::from_array);
        let mesh = Mesh { vertices: Arc::new(corners.to_vec()), triangles: vec![[0, 1, 2]] };
        let seen = run(|cx| MeshToField { pitch, floor }.run(Solid { mesh: &mesh }, cx));
        seen.map(|seen| seen.surface).map_err(|fault| fault.to_string())
    }

    #[test]
    fn the_corner_of_the_mesh_is_the_origin_and_its_bottom_the_floor() {
        let field = seen(1.0, Yielding::left(0.0)).unwrap();
        assert_eq!((field.columns(), field.rows()), (5, 5));
        assert_eq!((field.height(0, 0), field.height(4, 0), field.height(0, 4)), (2.0, 4.0, 6.0));
        assert_eq!(field.height(4, 4), 2.0);
        assert_eq!(seen(1.0, Yielding::given(-3.0)).unwrap().height(4, 4), -3.0);
    }

    #[test]
    fn absurd_pitches_are_refused_with_their_limit() {
        let wide = seen(5.0, Yielding::left(0.0)).unwrap_err();
        assert!(wide.starts_with("5 mm is too wide for a mesh of 4.000 × 4.000 mm"), "{wide}");
        let fine = seen(0.0001, Yielding::left(0.0)).unwrap_err();
        assert!(fine.contains("the limit is 400000000"), "{fine}");
    }
}

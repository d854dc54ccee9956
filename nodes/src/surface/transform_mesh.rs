//! Turning, scaling, mirroring and placing of a mesh; the order is the kernel's
//! ([`Placing`](carvegraph_geometry::Placing)). A mirrored mesh is wound the other way, so that its
//! outside stays outside.

use super::placing::placing_params;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs};
use carvegraph_geometry::{Bounds, Mesh};
use rayon::prelude::*;
use std::sync::Arc;

placing_params! {
    /// Mirrors, turns, scales and places a mesh.
    TransformMesh
}

#[derive(Inputs)]
pub(crate) struct Before<'a> {
    /// The mesh.
    mesh: &'a Mesh,
}

#[derive(Outputs)]
pub(crate) struct After {
    /// The mesh in its new place.
    mesh: Mesh,
    /// The box that holds it.
    bounds: Bounds,
}

impl Node for TransformMesh {
    const KIND: &'static str = "transform_mesh";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn run(&self, inputs: Before<'_>, _: &Context<'_>) -> Result<After, NodeError> {
        let (mesh, placing) = (inputs.mesh, self.placing());
        let used = mesh.triangles.par_iter().flat_map_iter(|triangle| *triangle);
        let map =
            placing.map(used.map(|v| mesh.vertices[v as usize])).map_err(NodeError::failed)?;
        let vertices = mesh.vertices.par_iter().map(|v| map.transform_point3(*v)).collect();
        let mut triangles = mesh.triangles.clone();
        if placing.is_mirrored() {
            triangles.par_iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        let mesh = Mesh { vertices: Arc::new(vertices), triangles };
        let bounds = mesh.bounds().ok_or_else(|| NodeError::failed("the mesh has no triangles"))?;
        Ok(After { mesh, bounds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::placing::{HeightPlace, Mirror, Place};
    use crate::testing::run;
    use carvegraph_geometry::DVec3;

    fn transformed(node: &TransformMesh) -> After {
        let corners = [[1., 1., 1.], [3., 1., 1.], [1., 5., 3.], [99., 99., 99.]];
        let vertices = corners.map(DVec3::from_array).to_vec();
        let mesh = Mesh { vertices: Arc::new(vertices), triangles: vec![[0, 1, 2]] };
        run(|cx| node.run(Before { mesh: &mesh }, cx)).unwrap()
    }

    fn normal(mesh: &Mesh) -> DVec3 {
        let [a, b, c] = mesh.corners(0);
        (b - a).cross(c - a)
    }

    #[test]
    fn left_alone_it_changes_nothing() {
        let after = transformed(&TransformMesh::neutral());
        assert_eq!(after.mesh.corners(0)[2], DVec3::new(1.0, 5.0, 3.0));
        assert_eq!(after.bounds.max, DVec3::new(3.0, 5.0, 3.0));
    }

    #[test]
    fn a_mirrored_mesh_still_faces_up() {
        let node = TransformMesh { mirror: Mirror::X, ..TransformMesh::neutral() };
        assert!(normal(&transformed(&node).mesh).z > 0.0);
    }

    #[test]
    fn the_order_is_turn_scale_fit_place_shift() {
        let node = TransformMesh {
            turn_z: 90.0,
            scale_z: 50.0,
            fit_x: 8.0,
            place: Place::Corner,
            z_place: HeightPlace::Top,
            shift_x: 1.0,
            ..TransformMesh::neutral()
        };
        // Turned, the part is 4 × 2 × 2 mm, then 4 × 2 × 1; to be 8 mm wide it is doubled. The vertex
        // that no triangle uses does not count.
        let bounds = transformed(&node).bounds;
        assert_eq!(bounds.min, DVec3::new(1.0, 0.0, -2.0));
        assert_eq!(bounds.max, DVec3::new(9.0, 4.0, 0.0));
    }
}

//! Cutting away what of a mesh lies beside a box, exactly at its planes, or beside an outline, triangle by
//! triangle; see [`Crop`](carvegraph_geometry::Crop). The cut is left open.

use super::cropping::{check, crop, crop_params, nothing_left};
use carvegraph_core::{Conflict, Context, Inputs, Node, NodeError, Outputs};
use carvegraph_geometry::{Bounds, Mesh, Polygon};

crop_params! {
    /// Keeps what of a mesh lies within a box and, if one is connected, within an outline.
    CropMesh
}

#[derive(Inputs)]
pub(crate) struct Before<'a> {
    /// The mesh.
    mesh: &'a Mesh,
    /// What of it is kept, seen from above; triangles that lie across its border are kept whole.
    polygon: Option<&'a Polygon>,
}

#[derive(Outputs)]
pub(crate) struct After {
    /// What is left of the mesh.
    mesh: Mesh,
    /// The box that holds it.
    bounds: Bounds,
}

impl Node for CropMesh {
    const KIND: &'static str = "crop_mesh";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn check(&self) -> Result<(), Conflict> {
        check(&self.sides())
    }

    fn run(&self, inputs: Before<'_>, _: &Context<'_>) -> Result<After, NodeError> {
        let mesh = crop(&self.sides(), inputs.polygon)?.mesh(inputs.mesh);
        let bounds =
            mesh.bounds().ok_or_else(|| nothing_left("triangles", inputs.mesh.bounds()))?;
        Ok(After { mesh, bounds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_core::Yielding;
    use carvegraph_geometry::{DVec2, DVec3};
    use std::sync::Arc;

    fn cropped(node: &CropMesh, polygon: Option<&Polygon>) -> Result<After, String> {
        let corners = [[0., 0., 0.], [10., 0., 0.], [0., 10., 5.]].map(DVec3::from_array);
        let mesh = Mesh { vertices: Arc::new(corners.to_vec()), triangles: vec![[0, 1, 2]] };
        run(|cx| node.run(Before { mesh: &mesh, polygon }, cx)).map_err(|fault| fault.to_string())
    }

    #[test]
    fn left_alone_it_cuts_nothing_away() {
        let after = cropped(&CropMesh::neutral(), None).unwrap();
        assert_eq!((after.mesh.triangles.len(), after.bounds.max.y), (1, 10.0));
    }

    #[test]
    fn sides_that_are_set_cut_at_their_place() {
        let node = CropMesh {
            x_min: Yielding::given(1.0),
            y_max: Yielding::given(4.0),
            z_min: Yielding::given(1.0),
            ..CropMesh::neutral()
        };
        node.check().unwrap();
        let bounds = cropped(&node, None).unwrap().bounds;
        assert_eq!(
            (bounds.min, bounds.max),
            (DVec3::new(1.0, 2.0, 1.0), DVec3::new(8.0, 4.0, 2.0))
        );
    }

    #[test]
    fn an_outline_keeps_whole_triangles() {
        let around = Polygon::rectangle(DVec2::splat(1.0), DVec2::splat(2.0)).unwrap();
        assert_eq!(cropped(&CropMesh::neutral(), Some(&around)).unwrap().bounds.max.x, 10.0);
    }

    #[test]
    fn a_box_without_inside_and_one_beside_the_mesh_are_told() {
        let bad = CropMesh {
            x_min: Yielding::given(2.0),
            x_max: Yielding::given(1.0),
            ..CropMesh::neutral()
        };
        let conflict = bad.check().unwrap_err();
        assert_eq!(conflict.param, "x_max");
        assert_eq!(conflict.message, "x_max (1 mm) must be more than its lower side (2 mm)");
        let beside = CropMesh { z_min: Yielding::given(6.0), ..CropMesh::neutral() };
        let told = "nothing is left: the triangles lie between 0.000, 0.000, 0.000 and 10.000, 10.000, 5.000 mm";
        assert_eq!(cropped(&beside, None).err().unwrap(), told);
    }
}

//! What is wrong with a mesh.
//!
//! Defects are told and never stop anything: a cutter can be dropped on any triangles. Open edges are
//! what a relief's rim has; a hole inside of it lets the cutter down to what lies below.

use crate::values::Remark;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Defects, Mesh, find_defects};

/// Counts the defects of a mesh: open, non-manifold and flipped edges, duplicate and degenerate
/// triangles.
#[derive(Clone, Debug, Params)]
pub(crate) struct InspectMesh {}

#[derive(Inputs)]
pub(crate) struct Suspect<'a> {
    /// The mesh.
    mesh: &'a Mesh,
}

#[derive(Outputs)]
pub(crate) struct Inspected {
    /// The counts.
    defects: Defects,
    /// The same in words.
    remark: Remark,
}

impl Node for InspectMesh {
    const KIND: &'static str = "inspect_mesh";
    type Inputs<'a> = Suspect<'a>;
    type Outputs = Inspected;

    fn run(&self, inputs: Suspect<'_>, cx: &Context<'_>) -> Result<Inspected, NodeError> {
        let ticker = cx.ticker(inputs.mesh.triangles.len());
        let defects = cx.completed(find_defects(inputs.mesh, &|n| ticker.tick(n)))?;
        let text = told(&defects);
        cx.note(&text);
        Ok(Inspected { defects, remark: Remark { text } })
    }
}

fn told(defects: &Defects) -> String {
    let counts = [
        (defects.open_edges, "open edges"),
        (defects.non_manifold_edges, "edges of more than two triangles"),
        (defects.flipped_edges, "edges between triangles that face opposite ways"),
        (defects.duplicate_triangles, "duplicate triangles"),
        (defects.degenerate_triangles, "triangles without area"),
    ];
    let found: Vec<String> = counts
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{count} {what}"))
        .collect();
    match found.is_empty() {
        true => "the mesh is closed and sound".to_owned(),
        false => format!("the mesh has {}", found.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::DVec3;
    use std::sync::Arc;

    #[test]
    fn defects_are_told_and_stop_nothing() {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mesh =
            Mesh { vertices: Arc::new(vertices), triangles: vec![[0, 1, 2], [0, 1, 2], [0, 0, 1]] };
        let inspected = run(|cx| InspectMesh {}.run(Suspect { mesh: &mesh }, cx)).unwrap();
        assert_eq!(
            inspected.remark.text,
            "the mesh has 3 edges between triangles that face opposite ways, 1 duplicate triangles, \
             1 triangles without area"
        );
        assert_eq!(inspected.defects.duplicate_triangles, 1);
    }

    #[test]
    fn a_sound_mesh_is_called_so() {
        assert_eq!(told(&Defects::default()), "the mesh is closed and sound");
    }
}

//! Loading a mesh.
//!
//! The format is told from the file's contents, whatever its name says; see [`read`](super::read).
//! STL repeats a vertex in each triangle around it: those that are equal bit by bit become one. Cracks
//! are not closed and nothing is repaired; `inspect_mesh` counts what is wrong.

use super::read::{ReadError, ReadMesh, read_mesh};
use super::unit::{Unit, check_reach, doubt, size_text};
use carvegraph_core::{Context, InputFile, Inputs, Node, NodeError, Outputs, Params, Yielding};
use carvegraph_geometry::{Bounds, Mesh};
use rayon::prelude::*;
use std::sync::Arc;

/// Loads a mesh: STL (binary or ASCII), OBJ, PLY or 3MF, whatever the file's name says.
#[derive(Clone, Debug, Params)]
pub(crate) struct LoadMesh {
    /// The mesh's file; none takes the mesh that is wired in.
    #[param()]
    pub(crate) path: Option<InputFile>,
    /// Unit of the file's numbers. Left alone, a 3MF file's own is taken.
    #[param(default = Unit::Mm)]
    pub(crate) unit: Yielding<Unit>,
}

#[derive(Inputs)]
pub(crate) struct Instead<'a> {
    /// What is taken where there is no file.
    instead: Option<&'a Mesh>,
}

#[derive(Outputs)]
pub(crate) struct Loaded {
    /// The mesh.
    mesh: Mesh,
    /// The box that holds it.
    bounds: Bounds,
}

impl Node for LoadMesh {
    const KIND: &'static str = "load_mesh";
    type Inputs<'a> = Instead<'a>;
    type Outputs = Loaded;

    fn run(&self, inputs: Instead<'_>, cx: &Context<'_>) -> Result<Loaded, NodeError> {
        let Some(path) = &self.path else {
            let mesh = inputs.instead.ok_or_else(|| {
                NodeError::failed("there is neither a file nor a mesh to take in its place")
            })?;
            return finish(mesh.clone(), "no file", cx);
        };
        let bytes = cx.read(path)?;
        let ticker = cx.ticker(bytes.len());
        let read = read_mesh(&bytes, &|n| ticker.tick(n)).map_err(|fault| match fault {
            ReadError::Stopped => NodeError::Cancelled,
            fault => NodeError::Failed(format!("{path} {fault}")),
        })?;
        drop(bytes);
        read.oddities.iter().for_each(|oddity| cx.warn(format!("{path}: {oddity}")));
        self.of_unit(path, read, cx)
    }
}

impl LoadMesh {
    fn of_unit(
        &self,
        path: &InputFile,
        read: ReadMesh,
        cx: &Context<'_>,
    ) -> Result<Loaded, NodeError> {
        let (format, mut vertices) = (read.format, read.vertices);
        let unit_mm = match (self.unit.is_set(), read.unit_mm) {
            (false, Some(mm)) => mm,
            _ => self.unit.or(None).mm(),
        };
        vertices.par_iter_mut().for_each(|vertex| *vertex *= unit_mm);
        let mesh = Mesh { vertices: Arc::new(vertices), triangles: read.triangles };
        if mesh.triangles.is_empty() {
            return Err(NodeError::Failed(format!("{path} holds no triangles")));
        }
        finish(mesh, format, cx)
    }
}

fn finish(mesh: Mesh, from: &str, cx: &Context<'_>) -> Result<Loaded, NodeError> {
    let bounds = mesh.bounds().ok_or_else(|| NodeError::failed("the mesh has no triangles"))?;
    check_reach(&bounds)?;
    let (count, size) = (mesh.triangles.len(), size_text(&bounds));
    cx.note(format!("{from}: {count} triangles, {size}"));
    doubt(&bounds).into_iter().for_each(|doubt| cx.warn(doubt));
    Ok(Loaded { mesh, bounds })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_core::Origin;

    const TRIANGLE: &str = "v 0 0 0\nv 2 0 0\nv 0 3 1\nf 1 2 3\n";

    fn loaded(text: &str, unit: Yielding<Unit>) -> Result<Loaded, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("part.stl"), text).unwrap();
        let path = Some(Origin::Folder(folder.path().to_owned()).locate("part.stl"));
        run(|cx| LoadMesh { path, unit }.run(Instead { instead: None }, cx))
            .map_err(|fault| fault.to_string())
    }

    #[test]
    fn contents_tell_the_format_and_the_unit_makes_mm() {
        for (unit, mm) in [(Unit::Mm, 1.0), (Unit::Cm, 10.0), (Unit::M, 1e3), (Unit::Inch, 25.4)] {
            let loaded = loaded(TRIANGLE, Yielding::given(unit)).unwrap();
            assert_eq!(loaded.mesh.triangles, [[0, 1, 2]]);
            assert_eq!(loaded.bounds.size().to_array(), [2.0 * mm, 3.0 * mm, mm]);
        }
    }

    #[test]
    fn without_a_file_what_is_wired_in_is_taken() {
        let given = loaded(TRIANGLE, Yielding::left(Unit::Mm)).unwrap().mesh;
        let node = LoadMesh { path: None, unit: Yielding::left(Unit::Mm) };
        let taken = run(|cx| node.run(Instead { instead: Some(&given) }, cx)).unwrap();
        assert_eq!((taken.mesh, taken.bounds.size().y), (given, 3.0));
        let neither = run(|cx| node.run(Instead { instead: None }, cx)).map(|_| ()).unwrap_err();
        assert!(neither.to_string().contains("neither a file nor a mesh"), "{neither}");
    }

    #[test]
    fn a_fault_names_file_and_line() {
        let message = loaded("v 0 0 0\nv 1 0 x\n", Yielding::left(Unit::Mm)).err().unwrap();
        let end = "part.stl is no sound OBJ file: line 2: \"x\" is no finite number of a vertex";
        assert!(message.ends_with(end), "{message}");
    }

    #[test]
    fn lengths_beyond_all_measure_are_refused() {
        let text = TRIANGLE.replace('3', "1e300").replace("f 1 2 1e300", "f 1 2 3");
        let message = loaded(&text, Yielding::left(Unit::Mm)).err().unwrap();
        assert!(message.contains("1e300 mm is beyond the limit of 4e13 mm"), "{message}");
    }
}

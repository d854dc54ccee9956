//! A mesh saved as 3MF (3MF Consortium, *Core Specification 1.3*, 2021), for slicers.
//!
//! A zip archive of three parts: the types of the others, a relation that names the model, and the
//! model, with one object and a build that holds it. Lengths are mm, as `f32` in the fewest digits that
//! tell it from the next. The parts are written as a stream, so the model's XML, some 70 bytes a
//! triangle, is never in memory. No time is noted: same mesh, same bytes.
//!
//! An object of type `model` must be a closed surface that agrees on its outside (section 4.1). A mesh
//! that is none is saved as type `surface`, with a warning. Triangles with two corners in one vertex are
//! not allowed and left out (section 4.1.4.1).

use carvegraph_core::{Context, Inputs, Node, NodeError, OutputName, Params};
use carvegraph_geometry::{DVec3, Defects, Mesh, find_defects};
use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::{self, Write};
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Lines that one thread formats at a time.
const CHUNK: usize = 1 << 12;

/// Lines that are formatted between two looks at the cancel token.
const BATCH: usize = 1 << 16;

/// Deflate's fastest level: digits pack little better at higher ones, which take several times as long.
const LEVEL: i64 = 1;

/// Readers keep indices in 31 bits (section 4.1.4.1).
const MAX_VERTICES: usize = i32::MAX as usize;

/// No line of the model is longer, numbers of 1e-38 aside, which no part has.
const MAX_LINE_BYTES: u64 = 100;

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"#;

const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"#;

const MODEL_HEAD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<metadata name="Application">Carvegraph</metadata>
<resources>
"#;

const MODEL_FOOT: &str = r#"</triangles>
</mesh>
</object>
</resources>
<build>
<item objectid="1"/>
</build>
</model>
"#;

/// Saves a mesh as 3MF, for 3-D printing.
#[derive(Clone, Debug, Params)]
pub(crate) struct Save3mf {
    /// Whether it is saved.
    #[param(default = true)]
    pub(crate) on: bool,
    /// The file's name without its extension; {prefix} stands for the input's name.
    #[param(default = "{prefix}")]
    pub(crate) name: OutputName,
}

#[derive(Inputs)]
pub(crate) struct Model<'a> {
    /// The mesh.
    mesh: &'a Mesh,
}

impl Node for Save3mf {
    const KIND: &'static str = "save_3mf";
    type Inputs<'a> = Model<'a>;
    type Outputs = ();

    fn idle(&self) -> Option<&'static str> {
        (!self.on).then_some("no 3MF is to be saved (on: false)")
    }

    fn run(&self, Model { mesh }: Model<'_>, cx: &Context<'_>) -> Result<(), NodeError> {
        let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.len());
        if vertices > MAX_VERTICES {
            let message =
                format!("{vertices} vertices are too many for 3MF; it takes {MAX_VERTICES}");
            return Err(NodeError::Failed(message));
        }
        // Looking for defects and writing take about as long.
        let ticker = cx.ticker(2 * triangles + vertices);
        let defects = cx.completed(find_defects(mesh, &|n| ticker.tick(n)))?;
        let is_solid = is_solid(&defects);
        if !is_solid {
            cx.warn(
                "the mesh is not closed: slicers may refuse it or repair it (stitch with shape: closed \
                 makes a solid)",
            );
        }
        let mut file = cx.create(&self.name, "3mf")?;
        let tick = |n| if ticker.tick(n) { Ok(()) } else { Err(io::Error::other("interrupted")) };
        write(mesh, is_solid, &mut file, &tick).map_err(|fault| match cx.is_cancelled() {
            true => NodeError::Cancelled,
            false => file.error(fault).into(),
        })?;
        file.finish()?;
        Ok(())
    }
}

fn is_solid(defects: &Defects) -> bool {
    [defects.open_edges, defects.non_manifold_edges, defects.flipped_edges] == [0; 3]
}

/// Writes the whole archive; `tick` is told of vertices and triangles.
fn write(
    mesh: &Mesh,
    is_solid: bool,
    file: impl Write,
    tick: &dyn Fn(usize) -> io::Result<()>,
) -> io::Result<()> {
    let mut zip = ZipWriter::new_stream(file);
    let lines = (mesh.vertices.len() + mesh.triangles.len()) as u64;
    let plain = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(LEVEL))
        .last_modified_time(DateTime::DEFAULT);
    let large = plain.large_file(lines * MAX_LINE_BYTES > u64::from(u32::MAX));
    for (part, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        zip.start_file(part, plain)?;
        zip.write_all(text.as_bytes())?;
    }
    zip.start_file("3D/3dmodel.model", large)?;
    zip.write_all(MODEL_HEAD.as_bytes())?;
    let kind = if is_solid { "model" } else { "surface" };
    write!(zip, "<object id=\"1\" type=\"{kind}\">\n<mesh>\n<vertices>\n")?;
    write_lines(&mut zip, &mesh.vertices, vertex, tick)?;
    zip.write_all(b"</vertices>\n<triangles>\n")?;
    write_lines(&mut zip, &mesh.triangles, triangle, tick)?;
    zip.write_all(MODEL_FOOT.as_bytes())?;
    zip.finish()?;
    Ok(())
}

/// Writes what `line` adds to a text for each of some things.
fn write_lines<T: Sync>(
    zip: &mut ZipWriter<StreamWriter<impl Write>>,
    things: &[T],
    line: impl Fn(&T, &mut String) + Sync,
    tick: &dyn Fn(usize) -> io::Result<()>,
) -> io::Result<()> {
    for batch in things.chunks(BATCH) {
        let lines = |chunk: &[T]| {
            let mut text = String::with_capacity(64 * chunk.len());
            chunk.iter().for_each(|thing| line(thing, &mut text));
            text
        };
        let texts: Vec<String> = batch.par_chunks(CHUNK).map(lines).collect();
        texts.iter().try_for_each(|text| zip.write_all(text.as_bytes()))?;
        tick(batch.len())?;
    }
    Ok(())
}

fn vertex(place: &DVec3, text: &mut String) {
    let [x, y, z] = place.to_array().map(|length| length as f32);
    // Writing to a string cannot fail.
    let _ = writeln!(text, r#"<vertex x="{x}" y="{y}" z="{z}"/>"#);
}

fn triangle(&[a, b, c]: &[u32; 3], text: &mut String) {
    if a != b && b != c && c != a {
        let _ = writeln!(text, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::read_mesh;
    use std::io::Read;
    use std::sync::Arc;

    const CORNERS: [[f64; 3]; 4] = [[0., 0., 0.], [1.5, 0., 0.], [0., 0.1, 0.], [0., 0., -2e-7]];
    const FACES: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

    fn mesh(triangles: &[[u32; 3]]) -> Mesh {
        let vertices = CORNERS.map(DVec3::from_array).to_vec();
        Mesh { vertices: Arc::new(vertices), triangles: triangles.to_vec() }
    }

    fn written(mesh: &Mesh, is_solid: bool) -> Vec<u8> {
        let mut bytes = Vec::new();
        write(mesh, is_solid, &mut bytes, &|_| Ok(())).unwrap();
        bytes
    }

    fn model(bytes: &[u8]) -> String {
        let mut archive = zip::ZipArchive::new(io::Cursor::new(bytes)).unwrap();
        let mut text = String::new();
        archive.by_name("3D/3dmodel.model").unwrap().read_to_string(&mut text).unwrap();
        text
    }

    #[test]
    fn what_was_written_is_read_again_to_the_last_bit() {
        let solid = mesh(&FACES);
        let read = read_mesh(&written(&solid, true), &|_| true).unwrap();
        assert_eq!((read.format, read.unit_mm), ("3MF", Some(1.0)));
        let rounded = |v: &DVec3| v.to_array().map(|length| length as f32);
        assert!(read.vertices.iter().map(rounded).eq(solid.vertices.iter().map(rounded)));
        assert_eq!(read.triangles, solid.triangles);
    }

    #[test]
    fn the_parts_stand_in_order_and_name_each_other() {
        let bytes = written(&mesh(&FACES), true);
        let mut archive = zip::ZipArchive::new(io::Cursor::new(&bytes)).unwrap();
        for (k, name) in
            ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"].iter().enumerate()
        {
            let part = archive.by_index(k).unwrap();
            assert_eq!(part.name().unwrap(), *name);
            assert_eq!(part.last_modified(), Some(DateTime::DEFAULT));
        }
        assert_eq!(bytes, written(&mesh(&FACES), true));
    }

    #[test]
    fn a_triangle_without_three_vertices_is_left_out_and_a_crack_is_no_model() {
        let broken = mesh(&[[0, 1, 2], [1, 1, 2]]);
        let text = model(&written(&broken, false));
        assert_eq!(text.matches("<triangle ").count(), 1);
        assert!(text.contains(r#"<object id="1" type="surface">"#), "{text}");
        assert!(text.contains(r#"<vertex x="1.5" y="0" z="0"/>"#), "{text}");
        let is_solid_of = |triangles| is_solid(&find_defects(&mesh(triangles), &|_| true).unwrap());
        assert!(is_solid_of(&FACES) && !is_solid_of(&FACES[1..]));
    }
}

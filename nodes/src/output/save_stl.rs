//! A mesh saved as STL.
//!
//! Binary STL: 80 bytes of header, the number of triangles, then 50 bytes a triangle (normal,
//! three corners, two spare bytes), all little-endian, lengths as `f32`. ASCII STL says the same in
//! words. A triangle without area gets the normal (0, 0, 0), as readers expect.

use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, OutputName, Params};
use carvegraph_geometry::{DVec3, Mesh};
use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::Write;

/// Triangles that are written between two looks at the cancel token.
const BATCH: usize = 1 << 16;

/// Triangles that one thread encodes at a time.
const CHUNK: usize = 1 << 12;

/// Longer files are no STL: the count of triangles has 32 bits.
pub(crate) const MAX_TRIANGLES: usize = u32::MAX as usize;

/// Saves a mesh as STL.
#[derive(Clone, Debug, Params)]
pub(crate) struct SaveStl {
    /// How it is written.
    #[param(default = Format::Binary)]
    pub(crate) format: Format,
    /// The file's name without its extension; {prefix} stands for the input's name.
    #[param(default = "{prefix}")]
    pub(crate) name: OutputName,
}

/// How an STL file is written.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Format {
    /// Compact, 50 bytes a triangle.
    Binary,
    /// Readable, about 250 bytes a triangle.
    Ascii,
    /// Not at all.
    None,
}

#[derive(Inputs)]
pub(crate) struct Model<'a> {
    /// The mesh.
    mesh: &'a Mesh,
}

impl Node for SaveStl {
    const KIND: &'static str = "save_stl";
    type Inputs<'a> = Model<'a>;
    type Outputs = ();

    fn idle(&self) -> Option<&'static str> {
        (self.format == Format::None).then_some("no mesh is to be saved (format: none)")
    }

    fn run(&self, inputs: Model<'_>, cx: &Context<'_>) -> Result<(), NodeError> {
        let mesh = inputs.mesh;
        let count = mesh.triangles.len();
        if count > MAX_TRIANGLES {
            let message =
                format!("{count} triangles are too many for STL; it takes {MAX_TRIANGLES}");
            return Err(NodeError::Failed(message));
        }
        let mut file = cx.create(&self.name, "stl")?;
        let ticker = cx.ticker(count);
        write(mesh, self.format, &mut file, &|n| ticker.tick(n)).map_err(|e| file.error(e))?;
        if cx.is_cancelled() {
            return Err(NodeError::Cancelled);
        }
        file.finish()?;
        Ok(())
    }
}

/// Writes the whole file, or stops early if `tick` says so.
fn write(
    mesh: &Mesh,
    format: Format,
    file: &mut dyn Write,
    tick: &dyn Fn(usize) -> bool,
) -> std::io::Result<()> {
    let encode = match format {
        Format::Ascii => encode_ascii,
        Format::Binary | Format::None => encode_binary,
    };
    file.write_all(&head(format, mesh.triangles.len()))?;
    for first in (0..mesh.triangles.len()).step_by(BATCH) {
        let last = (first + BATCH).min(mesh.triangles.len());
        let chunks: Vec<usize> = (first..last).step_by(CHUNK).collect();
        let encoded: Vec<Vec<u8>> =
            chunks.par_iter().map(|&at| encode(mesh, at..(at + CHUNK).min(last))).collect();
        for bytes in encoded {
            file.write_all(&bytes)?;
        }
        if !tick(last - first) {
            return Ok(());
        }
    }
    if format == Format::Ascii {
        file.write_all(b"endsolid carvegraph\n")?;
    }
    Ok(())
}

fn head(format: Format, count: usize) -> Vec<u8> {
    if format == Format::Ascii {
        return b"solid carvegraph\n".to_vec();
    }
    // A binary file must not begin with "solid", or readers take it for an ASCII one.
    let mut head = b"Carvegraph binary STL, mm".to_vec();
    head.resize(80, b' ');
    head.extend((count as u32).to_le_bytes());
    head
}

/// The normal and the corners of a triangle.
fn facet(mesh: &Mesh, triangle: usize) -> [DVec3; 4] {
    let [a, b, c] = mesh.corners(triangle);
    [(b - a).cross(c - a).normalize_or_zero(), a, b, c]
}

fn encode_binary(mesh: &Mesh, triangles: std::ops::Range<usize>) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(triangles.len() * 50);
    for triangle in triangles {
        for vector in facet(mesh, triangle) {
            for length in vector.to_array() {
                bytes.extend((length as f32).to_le_bytes());
            }
        }
        bytes.extend([0, 0]);
    }
    bytes
}

fn encode_ascii(mesh: &Mesh, triangles: std::ops::Range<usize>) -> Vec<u8> {
    let mut text = String::with_capacity(triangles.len() * 256);
    for triangle in triangles {
        let [normal, a, b, c] = facet(mesh, triangle).map(|vector| {
            let [x, y, z] = vector.to_array().map(|length| length as f32);
            format!("{x} {y} {z}")
        });
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "facet normal {normal}\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\n\
             endfacet\n"
        );
    }
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn written(format: Format) -> Vec<u8> {
        let corner = |x, y| DVec3::new(x, y, 0.25);
        let vertices = vec![corner(0.0, 0.0), corner(1.5, 0.0), corner(0.0, 1.5)];
        // The second one has no area.
        let mesh = Mesh { vertices: Arc::new(vertices), triangles: vec![[0, 1, 2], [0, 1, 1]] };
        let mut bytes = Vec::new();
        write(&mesh, format, &mut bytes, &|_| true).unwrap();
        bytes
    }

    #[test]
    fn binary_has_50_bytes_a_triangle_after_84() {
        let bytes = written(Format::Binary);
        assert_eq!(bytes.len(), 84 + 2 * 50);
        assert_eq!(bytes[80..84], 2u32.to_le_bytes());
        assert!(!bytes.starts_with(b"solid"));
        let lengths: Vec<f32> = bytes[84..84 + 48]
            .chunks(4)
            .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
            .collect();
        assert_eq!(lengths, [0., 0., 1., 0., 0., 0.25, 1.5, 0., 0.25, 0., 1.5, 0.25]);
        assert!(bytes[134..146].iter().all(|byte| *byte == 0), "no area, no normal");
    }

    #[test]
    fn ascii_says_the_same() {
        let text = String::from_utf8(written(Format::Ascii)).unwrap();
        let first = "solid carvegraph\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0.25\n\
                     vertex 1.5 0 0.25\nvertex 0 1.5 0.25\nendloop\nendfacet\n";
        assert!(text.starts_with(first), "{text}");
        assert!(text.ends_with("endfacet\nendsolid carvegraph\n"));
    }
}

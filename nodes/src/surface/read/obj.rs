//! OBJ (Alias|Wavefront, *Advanced Visualizer* manual, appendix B1): `v` and `f` lines.
//!
//! Faces may have any number of corners; a negative index counts back from the last vertex so far.
//! Everything else (normals, textures, groups, materials, lines, curves) is passed over.
//!
//! The crate `tobj` makes fans of concave faces and says neither line nor word of what is wrong.

use super::polygon::{MAX_CORNERS, triangulate};
use super::text::{lines, number, quoted, skip_mark, words};
use super::{MAX_POINTS, MAX_TRIANGLES, ReadError, ReadMesh, go_on, limited};
use carvegraph_geometry::{DVec3, Tick};

const OBJ: &str = "OBJ";

/// First words of lines that an OBJ file begins with, before or at its first vertex.
const FIRST_WORDS: [&[u8]; 9] =
    [b"v", b"vn", b"vt", b"o", b"g", b"s", b"mtllib", b"usemtl", b"call"];

/// Whether the first line that is no comment is one of an OBJ file.
pub(super) fn is_obj(bytes: &[u8]) -> bool {
    let words = lines(bytes, skip_mark(bytes)..bytes.len())
        .filter_map(|(_, line)| words(line).next().filter(|word| !word.starts_with(b"#")));
    words.take(1).any(|word| FIRST_WORDS.contains(&word))
}

/// Reads vertices and faces.
pub(super) fn read_mesh(bytes: &[u8], tick: Tick<'_>) -> Result<ReadMesh, ReadError> {
    let mut mesh = ReadMesh { format: OBJ, ..ReadMesh::default() };
    let (mut told, mut joined, mut corners) = (0, Vec::new(), Vec::new());
    for (at, line) in lines(bytes, skip_mark(bytes)..bytes.len()) {
        let fault = |what: String| ReadError::at_line(OBJ, bytes, at, what);
        // A line that ends in a backslash goes on in the next one.
        if let Some(part) = line.strip_suffix(b"\\") {
            joined.extend_from_slice(part);
            joined.push(b' ');
            continue;
        }
        if !joined.is_empty() && line.is_empty() {
            // The second half of CRLF.
            continue;
        }
        joined.extend_from_slice(line);
        take(&joined, &mut mesh, &mut corners).map_err(fault)?;
        joined.clear();
        limited("vertices", mesh.vertices.len() as u64, MAX_POINTS)?;
        limited("triangles", mesh.triangles.len() as u64, MAX_TRIANGLES)?;
        if at - told >= 1 << 20 {
            go_on(tick, at - told)?;
            told = at;
        }
    }
    Ok(mesh)
}

/// Takes a line.
fn take(line: &[u8], mesh: &mut ReadMesh, corners: &mut Vec<u32>) -> Result<(), String> {
    let mut words = words(line);
    match words.next() {
        Some(b"v") => mesh.vertices.push(vertex(words)?),
        Some(b"f") => {
            corners.clear();
            for word in words.take_while(|word| !word.starts_with(b"#")) {
                corners.push(index(word, mesh.vertices.len())?);
            }
            if corners.len() < 3 {
                return Err(format!("a face needs 3 corners; this one has {}", corners.len()));
            }
            triangulate(corners, &mesh.vertices, &mut mesh.triangles).map_err(|_| {
                let count = corners.len();
                format!("a concave face has {count} corners; the limit is {MAX_CORNERS}: split it")
            })?;
        }
        _ => {}
    }
    Ok(())
}

fn vertex<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Result<DVec3, String> {
    let mut length = || {
        let word = words.next().unwrap_or_default();
        let length = number(word).filter(|length| length.is_finite());
        length.ok_or_else(|| format!("{} is no finite number of a vertex", quoted(word)))
    };
    Ok(DVec3::new(length()?, length()?, length()?))
}

/// The vertex that a corner such as `7`, `7/1`, `7//3` or `-1/2/3` means.
fn index(word: &[u8], vertices: usize) -> Result<u32, String> {
    let text = word.split(|byte| *byte == b'/').next().unwrap_or_default();
    let parsed = std::str::from_utf8(text).ok().and_then(|text| text.parse::<i64>().ok());
    let parsed = parsed.ok_or_else(|| format!("{} is no corner of a face", quoted(word)))?;
    let index = if parsed < 0 { vertices as i64 + parsed } else { parsed - 1 };
    match usize::try_from(index) {
        Ok(index) if index < vertices => Ok(index as u32),
        _ => Err(format!("a face names vertex {parsed}; {vertices} vertices stand before it")),
    }
}

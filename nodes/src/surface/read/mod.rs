//! Readers of mesh and point files: bytes in, triangles or points out.
//!
//! They stand here and not in geometry, which knows no files and would hand their crates (zip, XML,
//! LAZ) on to everybody who writes a plugin. They know neither nodes nor recipes.
//!
//! A file is what its contents say, whatever its name. What a header promises is believed only as
//! far as the file's own length bears it out: nothing is allocated for a count that the bytes cannot
//! hold. Coordinates are `f64` from the first moment on.

mod error;
mod las;
mod lzf;
mod obj;
mod pcd;
mod ply;
mod polygon;
mod stl;
mod table;
mod text;
mod three_mf;
mod weld;

use carvegraph_geometry::{DVec3, Tick};

pub(crate) use error::ReadError;
pub(crate) use weld::Welder;

/// No mesh has more triangles: as many take some 5 GB with the file they were read from.
pub(crate) const MAX_TRIANGLES: usize = 50_000_000;

/// No file gives more vertices or points: as many take 2.4 GB.
pub(crate) const MAX_POINTS: usize = 100_000_000;

/// Records that are read between two looks at the cancel token.
const BATCH: usize = 1 << 16;

/// A mesh as its file has it.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct ReadMesh {
    /// Vertices in the file's unit; finite.
    pub(crate) vertices: Vec<DVec3>,
    /// Three indices into the vertices each.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The file's format.
    pub(crate) format: &'static str,
    /// Its unit in mm, where the file says it.
    pub(crate) unit_mm: Option<f64>,
    /// What is odd about the file, each a clause such as "5 bytes follow the last triangle".
    pub(crate) oddities: Vec<String>,
}

/// Points as their file has them.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct ReadPoints {
    /// The points in the file's unit; finite.
    pub(crate) points: Vec<DVec3>,
    /// The file's format.
    pub(crate) format: &'static str,
    /// Points left out because a coordinate is no number; scanners mark what they missed so.
    pub(crate) missed: usize,
}

impl ReadPoints {
    /// Takes a point, or counts it as missed.
    fn push(&mut self, point: DVec3) {
        match point.is_finite() {
            true => self.points.push(point),
            false => self.missed += 1,
        }
    }
}

/// Reads a mesh: STL, OBJ, PLY or 3MF. `tick` is told of bytes.
///
/// # Errors
/// If the file is none of these, or not sound.
pub(crate) fn read_mesh(bytes: &[u8], tick: Tick<'_>) -> Result<ReadMesh, ReadError> {
    let mesh = match () {
        () if ply::is_ply(bytes) => ply::read_mesh(bytes, tick)?,
        () if three_mf::is_zip(bytes) => three_mf::read_mesh(bytes, tick)?,
        () if stl::has_honest_count(bytes) => stl::read_binary(bytes, tick)?,
        () if stl::is_ascii(bytes) => stl::read_ascii(bytes, tick)?,
        () if text::is_text(bytes) && obj::is_obj(bytes) => obj::read_mesh(bytes, tick)?,
        () if stl::could_be_binary(bytes) => stl::read_binary(bytes, tick)?,
        () => {
            return Err(ReadError::Unknown("no mesh that can be read: STL, OBJ, PLY and 3MF can"));
        }
    };
    if mesh.triangles.is_empty() {
        return Err(ReadError::Empty { format: mesh.format, what: "triangles" });
    }
    Ok(mesh)
}

/// Reads points: text, PLY, PCD, LAS or LAZ. `tick` is told of bytes.
///
/// # Errors
/// If the file is none of these, or not sound.
pub(crate) fn read_points(bytes: &[u8], tick: Tick<'_>) -> Result<ReadPoints, ReadError> {
    let points = match () {
        () if ply::is_ply(bytes) => ply::read_points(bytes, tick)?,
        () if pcd::is_pcd(bytes) => pcd::read_points(bytes, tick)?,
        () if las::is_las(bytes) => las::read_points(bytes, tick)?,
        () if text::is_text(bytes) => table::read_points(bytes, tick)?,
        () => {
            let known = "no point file that can be read: XYZ, CSV, PLY, PCD, LAS and LAZ can";
            return Err(ReadError::Unknown(known));
        }
    };
    if points.points.is_empty() {
        return Err(ReadError::Empty { format: points.format, what: "points" });
    }
    Ok(points)
}

/// Goes on, or not, after `units` more of work.
fn go_on(tick: Tick<'_>, units: usize) -> Result<(), ReadError> {
    if tick(units) { Ok(()) } else { Err(ReadError::Stopped) }
}

/// Refuses a count beyond its limit.
fn limited(what: &'static str, count: u64, limit: usize) -> Result<(), ReadError> {
    match count > limit as u64 {
        true => Err(ReadError::TooMany { what, count, limit }),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests;

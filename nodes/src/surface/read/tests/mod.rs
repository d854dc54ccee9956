//! The readers held against files written here, damaged ones, and real ones.

mod damaged;
mod meshes;
mod points;
mod real;
mod samples;

use super::*;

fn mesh(bytes: &[u8]) -> Result<ReadMesh, String> {
    read_mesh(bytes, &|_| true).map_err(|fault| fault.to_string())
}

fn points(bytes: &[u8]) -> Result<ReadPoints, String> {
    read_points(bytes, &|_| true).map_err(|fault| fault.to_string())
}

/// The corners of all triangles.
fn corners(mesh: &ReadMesh) -> Vec<[DVec3; 3]> {
    mesh.triangles.iter().map(|t| t.map(|v| mesh.vertices[v as usize])).collect()
}

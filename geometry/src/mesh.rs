//! A triangle mesh.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Triangles over shared vertices, counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Vertices in mm.
    pub vertices: Arc<Vec<DVec3>>,
    /// Three indices into `vertices` a triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The corners of triangle `t`, in mm.
    #[must_use]
    pub fn corners(&self, t: usize) -> [DVec3; 3] {
        self.triangles[t].map(|v| self.vertices[v as usize])
    }
}

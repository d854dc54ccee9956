//! A triangle mesh.

use crate::Bounds;
use glam::DVec3;
use rayon::prelude::*;
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

    /// The box that just holds the triangles, in mm; `None` if there are none. Vertices that no
    /// triangle uses do not count.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let corners = self.triangles.par_iter().flat_map_iter(|triangle| *triangle);
        Bounds::of(corners.map(|v| self.vertices[v as usize]))
    }
}

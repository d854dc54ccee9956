//! Cutting away what lies beside a box or an outline.
//!
//! A mesh is cut along the planes of the box, one after the other (Sutherland and Hodgman, "Reentrant
//! polygon clipping", Communications of the ACM 17(1), 1974): a triangle that crosses a plane becomes one
//! or two, with new vertices on the plane. The vertex on an edge is computed from the end outside and
//! shared by the triangles that share the edge; where a file repeats vertices it is the same to the bit. So
//! no cracks open. It lies in the plane exactly. What lies in the plane itself is kept. Nothing is closed:
//! the cut is an open edge.
//!
//! At an outline, triangles are not cut: one is kept if it meets the inside, seen from above, so that
//! nothing that a cutter may touch there is lost. What stands out does no harm where passes end at the
//! same outline.
//!
//! Points are kept or not. Heights keep their grid: the columns and rows that lie in the box, and the
//! outline's; nodes beside the outline are lowered to a floor.

use crate::{Bounds, HeightField, HeightFieldError, Mesh, PointCloud, Polygon, Region};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// What is to be kept of a part.
#[derive(Clone, Debug)]
pub struct Crop {
    /// The box, which may be infinite on any side.
    bounds: Bounds,
    outline: Option<Outline>,
}

#[derive(Clone, Debug)]
struct Outline {
    /// All inside of it.
    region: Region,
    polygon: Polygon,
}

impl Crop {
    /// What lies in a box, whose sides may be infinite, and seen from above inside of an outline.
    ///
    /// `None` if a side is not a number or lies beyond its other one.
    #[must_use]
    pub fn new(bounds: Bounds, outline: Option<&Polygon>) -> Option<Self> {
        let outline = match outline {
            Some(polygon) => {
                let (min, max) = polygon.extent();
                let around = Bounds { min: min.extend(0.0), max: max.extend(0.0) };
                let region = Region::new(&around)?.within(polygon.clone())?;
                Some(Outline { region, polygon: polygon.clone() })
            }
            None => None,
        };
        bounds.min.cmple(bounds.max).all().then_some(Self { bounds, outline })
    }

    fn has(&self, point: DVec3) -> bool {
        let Bounds { min, max } = self.bounds;
        point.cmpge(min).all() && point.cmple(max).all() && self.surrounds(point.truncate())
    }

    fn surrounds(&self, place: DVec2) -> bool {
        self.outline.as_ref().is_none_or(|outline| outline.region.contains(place))
    }

    /// Whether the inside of the outline meets a triangle: one of its sides, or all of one loop.
    fn meets(&self, [a, b, c]: [DVec2; 3]) -> bool {
        let Some(Outline { region, polygon }) = &self.outline else { return true };
        let holds = |place: DVec2| {
            let turns = [[a, b], [b, c], [c, a]].map(|[p, q]| (q - p).perp_dot(place - p));
            turns.iter().all(|turn| *turn >= 0.0) || turns.iter().all(|turn| *turn <= 0.0)
        };
        [[a, b], [b, c], [c, a]].iter().any(|[p, q]| !region.inside(*p, *q).is_empty())
            || polygon.loops().iter().any(|corners| holds(corners[0]))
    }

    /// The points that lie inside, in their order; in no grid's any more, unless all are kept.
    #[must_use]
    pub fn points(&self, cloud: &PointCloud) -> PointCloud {
        let kept: Vec<DVec3> =
            cloud.points.par_iter().copied().filter(|point| self.has(*point)).collect();
        if kept.len() == cloud.points.len() {
            return cloud.clone();
        }
        PointCloud { points: Arc::new(kept), grid: None }
    }

    /// The mesh inside. Vertices that no triangle uses are left out; those left keep their order, new
    /// ones come after them. Where nothing bounds it, it is the mesh as it is.
    #[must_use]
    pub fn mesh(&self, mesh: &Mesh) -> Mesh {
        let Bounds { min, max } = self.bounds;
        if self.outline.is_none() && min == DVec3::NEG_INFINITY && max == DVec3::INFINITY {
            return mesh.clone();
        }
        let surrounded = |triangle: &&[u32; 3]| {
            self.meets(triangle.map(|v| mesh.vertices[v as usize].truncate()))
        };
        let mut cut = Cut { vertices: mesh.vertices.to_vec(), triangles: Vec::new() };
        cut.triangles = mesh.triangles.par_iter().filter(surrounded).copied().collect();
        for axis in 0..3 {
            cut.behind(Plane { axis, at: self.bounds.min[axis], side: 1.0 });
            cut.behind(Plane { axis, at: self.bounds.max[axis], side: -1.0 });
        }
        cut.packed()
    }

    /// The part of a field whose nodes lie in the box along x and y, and in that of the outline; nodes
    /// beside the outline have the height `floor`, or where that is `None` that of the lowest node inside.
    /// A field begins at 0, 0, so the part does; the column and row of the whole where that was come
    /// with it.
    ///
    /// # Errors
    /// If less than two columns or rows are left.
    pub fn field(
        &self,
        field: &HeightField,
        floor: Option<f32>,
    ) -> Result<(HeightField, [usize; 2]), HeightFieldError> {
        let pitch_mm = field.pitch_mm();
        let (low, high) = match &self.outline {
            Some(Outline { polygon, .. }) => polygon.extent(),
            None => (DVec2::NEG_INFINITY, DVec2::INFINITY),
        };
        let kept = |axis: usize, count: usize| {
            let (low, high) =
                (low[axis].max(self.bounds.min[axis]), high[axis].min(self.bounds.max[axis]));
            let first = (low / pitch_mm - NODE_SLACK).ceil().max(0.0) as usize;
            let end = (high / pitch_mm + NODE_SLACK + 1.0).floor().max(0.0) as usize;
            first..end.min(count).max(first)
        };
        let (columns, rows) = (kept(0, field.columns()), kept(1, field.rows()));
        let nodes = rows.clone().flat_map(|row| columns.clone().map(move |column| (column, row)));
        let mut heights: Vec<Option<f32>> = nodes
            .map(|(column, row)| {
                let node = field.point(column, row);
                self.surrounds(node.truncate()).then_some(node.z as f32)
            })
            .collect();
        let lowest = heights.iter().flatten().copied().reduce(f32::min);
        let floor = floor.or(lowest);
        heights.iter_mut().for_each(|height| *height = height.or(floor));
        // Without a node inside there is no floor either.
        let heights: Vec<f32> = heights.into_iter().flatten().collect();
        let (columns, rows, first) = (columns.len(), rows.len(), [columns.start, rows.start]);
        if lowest.is_none() {
            return Err(HeightFieldError::TooSmall { columns: 0, rows: 0 });
        }
        Ok((HeightField::new(columns, rows, pitch_mm, heights)?, first))
    }
}

/// How far, in pitches, a node may lie beside the box and count as on its side: 0.3 · 10 is not 3.
const NODE_SLACK: f64 = 1e-9;

/// A plane across an axis; kept is what lies on the side of greater (1) or lesser (-1) coordinates.
#[derive(Clone, Copy)]
struct Plane {
    axis: usize,
    at: f64,
    side: f64,
}

impl Plane {
    /// How far inside, in mm; negative outside.
    fn depth(self, point: DVec3) -> f64 {
        (point[self.axis] - self.at) * self.side
    }
}

/// A mesh in the cutting.
struct Cut {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Cut {
    fn behind(&mut self, plane: Plane) {
        if plane.at.is_infinite() {
            return;
        }
        let mut on_edges: HashMap<[u32; 2], u32> = HashMap::new();
        let mut kept = Vec::with_capacity(self.triangles.len());
        for triangle in std::mem::take(&mut self.triangles) {
            let depths = triangle.map(|v| plane.depth(self.vertices[v as usize]));
            if depths.iter().all(|depth| *depth >= 0.0) {
                kept.push(triangle);
            } else if depths.iter().any(|depth| *depth > 0.0) {
                let corners = self.inside(triangle, depths, plane, &mut on_edges);
                kept.extend((2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]));
            }
        }
        self.triangles = kept;
    }

    /// The corners of what is inside of a triangle, in its order.
    fn inside(
        &mut self,
        triangle: [u32; 3],
        depths: [f64; 3],
        plane: Plane,
        on_edges: &mut HashMap<[u32; 2], u32>,
    ) -> Vec<u32> {
        let mut corners = Vec::with_capacity(4);
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            let (deep, next) = (depths[k], depths[(k + 1) % 3]);
            if deep >= 0.0 {
                corners.push(a);
            }
            if (deep > 0.0 && next < 0.0) || (deep < 0.0 && next > 0.0) {
                let edge = [a.min(b), a.max(b)];
                let vertices = &mut self.vertices;
                corners.push(*on_edges.entry(edge).or_insert_with(|| {
                    let (out, deep) = if deep < 0.0 { (a, b) } else { (b, a) };
                    let [from, to] = [out, deep].map(|v| vertices[v as usize]);
                    let share = plane.depth(from) / (plane.depth(from) - plane.depth(to));
                    // What lies in a plane that was cut at before stays in it.
                    let mut vertex = from.lerp(to, share).clamp(from.min(to), from.max(to));
                    vertex[plane.axis] = plane.at;
                    vertices.push(vertex);
                    vertices.len() as u32 - 1
                }));
            }
        }
        corners
    }

    fn packed(self) -> Mesh {
        let mut is_used = vec![false; self.vertices.len()];
        self.triangles.iter().flatten().for_each(|v| is_used[*v as usize] = true);
        let mut number = vec![0_u32; self.vertices.len()];
        let mut vertices = Vec::new();
        for (v, vertex) in self.vertices.into_iter().enumerate().filter(|(v, _)| is_used[*v]) {
            number[v] = vertices.len() as u32;
            vertices.push(vertex);
        }
        let triangles = self.triangles.par_iter().map(|t| t.map(|v| number[v as usize])).collect();
        Mesh { vertices: Arc::new(vertices), triangles }
    }
}

#[cfg(test)]
mod tests;

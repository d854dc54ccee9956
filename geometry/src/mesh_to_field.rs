//! The top of a mesh, seen from above, as a height field.
//!
//! Each node of the grid gets the height of the highest facet, edge or vertex above or below it. A row
//! of nodes lies in a plane y = const, which cuts a triangle in a segment (or in the whole triangle if
//! it stands in that plane): the cuts of its edges are found, and between each two of them the node's
//! height is interpolated. So vertical facets, whose edges may be all that a node sees, need no case
//! of their own, and nothing falls between two triangles.
//!
//! A node within [`SLACK`] units in the last place of an edge counts as on it, with heights of the
//! edge: never above the triangle's highest point. Memory: eight bytes a triangle. Time: the triangles
//! once a slab of rows, and the nodes that they cover.

use crate::{Bounds, Mesh, Tick};
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How many units in the last place of the largest coordinate two lengths may differ and still be
/// taken for equal: a node's place is made of a product and a sum, a vertex' of a subtraction.
const SLACK: f64 = 8.0;

/// Slabs of rows that are worked on by themselves. More would look at all triangles more often, fewer
/// would leave threads without work.
const SLABS: usize = 32;

/// Triangles between two looks at the cancel token.
const BATCH: usize = 1 << 16;

/// Where the nodes of a field stand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldGrid {
    /// Nodes along x.
    pub columns: usize,
    /// Nodes along y.
    pub rows: usize,
    /// Distance of neighbours, in mm.
    pub pitch_mm: f64,
}

impl FieldGrid {
    /// The grid that starts at the near left corner of a box and has all the nodes that lie in it.
    #[must_use]
    pub fn over(bounds: Bounds, pitch_mm: f64) -> Self {
        let slack = slack(bounds) / pitch_mm;
        let nodes =
            |length: f64| ((length / pitch_mm + slack).floor().max(0.0) as usize).saturating_add(1);
        let size = bounds.size();
        Self { columns: nodes(size.x), rows: nodes(size.y), pitch_mm }
    }
}

/// How far two equal lengths may seem apart, in mm.
fn slack(bounds: Bounds) -> f64 {
    let reach = bounds.min.abs().max(bounds.max.abs());
    SLACK * f64::EPSILON * reach.max_element().max(bounds.size().max_element())
}

/// Heights of the top of `mesh` over `grid`, which starts at the near left corner of `bounds`, the
/// mesh's own. Row by row from y = 0; `floor` where there is nothing. `tick` is told of triangles, all
/// of them `SLABS` times.
pub fn mesh_to_field(
    mesh: &Mesh,
    bounds: Bounds,
    grid: FieldGrid,
    floor: f32,
    tick: Tick<'_>,
) -> Option<Vec<f32>> {
    let top = Top { mesh, grid, corner: bounds.min, slack: slack(bounds) };
    let rows: Vec<[u32; 2]> =
        (0..mesh.triangles.len()).into_par_iter().map(|t| top.rows_of(top.corners(t))).collect();
    let mut heights = vec![f32::NEG_INFINITY; grid.columns * grid.rows];
    let slab = grid.rows.div_ceil(SLABS);
    heights.par_chunks_mut(slab * grid.columns).enumerate().try_for_each(|(index, heights)| {
        let first = index * slab;
        let last = first + heights.len() / grid.columns - 1;
        for (batch, rows) in rows.chunks(BATCH).enumerate() {
            for (t, &[low, high]) in rows.iter().enumerate() {
                let within = (low as usize).max(first)..=(high as usize).min(last);
                if !within.is_empty() {
                    let corners = top.corners(batch * BATCH + t);
                    for row in within {
                        let at = (row - first) * grid.columns;
                        top.lift(corners, row, &mut heights[at..at + grid.columns]);
                    }
                }
            }
            tick(rows.len()).then_some(())?;
        }
        let open = heights.iter_mut().filter(|height| **height == f32::NEG_INFINITY);
        open.for_each(|height| *height = floor);
        Some(())
    })?;
    Some(heights)
}

/// The work on one mesh.
struct Top<'a> {
    mesh: &'a Mesh,
    grid: FieldGrid,
    corner: DVec3,
    slack: f64,
}

impl Top<'_> {
    /// A triangle in the grid's own frame: x and y from its corner.
    fn corners(&self, t: usize) -> [DVec3; 3] {
        self.mesh.corners(t).map(|v| DVec3::new(v.x - self.corner.x, v.y - self.corner.y, v.z))
    }

    /// The nodes of a line that lie from `low` to `high`: first and last, 1 and 0 if there are none.
    fn nodes(&self, low: f64, high: f64, count: usize) -> [usize; 2] {
        let pitch = self.grid.pitch_mm;
        let first = ((low - self.slack) / pitch).ceil().max(0.0);
        let last = ((high + self.slack) / pitch).floor().min((count - 1) as f64);
        if first <= last { [first as usize, last as usize] } else { [1, 0] }
    }

    fn rows_of(&self, corners: [DVec3; 3]) -> [u32; 2] {
        let y = corners.map(|corner| corner.y);
        let (low, high) = (y[0].min(y[1]).min(y[2]), y[0].max(y[1]).max(y[2]));
        self.nodes(low, high, self.grid.rows).map(|row| row as u32)
    }

    /// Lifts the nodes of a row to a triangle.
    fn lift(&self, corners: [DVec3; 3], row: usize, heights: &mut [f32]) {
        let (cuts, count) = self.cuts(corners, row as f64 * self.grid.pitch_mm);
        let cuts = &cuts[..count];
        for (i, &p) in cuts.iter().enumerate() {
            for &q in &cuts[i..] {
                self.lift_between(p, q, heights);
            }
        }
    }

    /// Where the edges of a triangle cross the plane of a row, each place once: x and z.
    fn cuts(&self, corners: [DVec3; 3], y: f64) -> ([[f64; 2]; 6], usize) {
        let (mut cuts, mut count) = ([[0.0; 2]; 6], 0);
        let mut add = |cut: [f64; 2]| {
            if !cuts[..count].contains(&cut) {
                cuts[count] = cut;
                count += 1;
            }
        };
        for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|edge| edge.map(|corner| corners[corner])) {
            let (is_a, is_b) = ((a.y - y).abs() <= self.slack, (b.y - y).abs() <= self.slack);
            if is_a {
                add([a.x, a.z]);
            }
            if is_b {
                add([b.x, b.z]);
            }
            if !is_a && !is_b && (a.y < y) != (b.y < y) {
                // From the lower end, so that both triangles beside an edge find the same place.
                let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
                let t = (y - low.y) / (high.y - low.y);
                add([between(low.x, high.x, t), between(low.z, high.z, t)]);
            }
        }
        (cuts, count)
    }

    /// Lifts the nodes of a row that lie between two places.
    fn lift_between(&self, p: [f64; 2], q: [f64; 2], heights: &mut [f32]) {
        let (p, q) = if p[0] <= q[0] { (p, q) } else { (q, p) };
        let [first, last] = self.nodes(p[0], q[0], heights.len());
        for (column, height) in (first..).zip(&mut heights[first..last + 1]) {
            let x = column as f64 * self.grid.pitch_mm;
            let (is_p, is_q) = ((x - p[0]).abs() <= self.slack, (x - q[0]).abs() <= self.slack);
            let z = match (is_p, is_q) {
                (true, true) => p[1].max(q[1]),
                (true, false) => p[1],
                (false, true) => q[1],
                (false, false) => between(p[1], q[1], (x - p[0]) / (q[0] - p[0])),
            };
            *height = height.max(z as f32);
        }
    }
}

/// The length at share `t` of the way from `a` to `b`: exact at both ends and never beyond them.
fn between(a: f64, b: f64, t: f64) -> f64 {
    let at = if t <= 0.5 { a + t * (b - a) } else { b - (1.0 - t) * (b - a) };
    at.clamp(a.min(b), a.max(b))
}

#[cfg(test)]
mod tests;

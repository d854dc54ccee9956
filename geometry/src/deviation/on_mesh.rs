//! The top of a mesh: a tree of boxes over the triangles that do not face down.
//!
//! The tree halves the triangles by the median of their middles along the longest way, down to a few. Which
//! side of a triangle is out is told by its corners' order, for a mesh that is turned inside out by the
//! opposite: the volume under its triangles is negative then.

use super::closest::{distance2, to_box2};
use super::{DeviationError, Ground};
use crate::{Bounds, FieldGrid, HeightField, Mesh, Tick, mesh_to_field};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Triangles in a leaf.
const LEAF: usize = 4;

/// A triangle that leans over by less counts as upright, as a share of its area: what rounding to `f32` in a
/// file may do.
const UPRIGHT: f64 = 1e-6;

/// A box over the triangles of a range; its children follow, or none if there are few.
struct Branch {
    low: DVec3,
    high: DVec3,
    triangles: [u32; 2],
    /// The second child; the first is the next branch. 0 of a leaf.
    second: u32,
}

/// A mesh to search.
pub(super) struct OnMesh {
    triangles: Vec<[DVec3; 3]>,
    branches: Vec<Branch>,
    extent: [DVec2; 2],
    /// Heights of the top at the nodes of the machined surface; NaN where there is nothing.
    tops: Vec<f64>,
    columns: usize,
}

impl OnMesh {
    pub(super) fn new(
        mesh: &Mesh,
        machined: &HeightField,
        corner: DVec2,
        tick: Tick,
    ) -> Result<Self, DeviationError> {
        let sound = |t: &[u32; 3]| {
            t.iter().all(|v| mesh.vertices.get(*v as usize).is_some_and(|v| v.is_finite()))
        };
        if let Some(triangle) = mesh.triangles.par_iter().position_first(|t| !sound(t)) {
            return Err(DeviationError::BadTriangle { triangle });
        }
        let bounds = mesh.bounds().ok_or(DeviationError::NoTop)?;
        let tops = tops(mesh, machined, corner, tick).ok_or(DeviationError::Stopped)?;
        // Where some triangles are turned over the side that they face says little; they may lie on top.
        let mixed = faces_both_ways(mesh);
        let on_top = |corners: [DVec3; 3]| {
            if !mixed {
                return false;
            }
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let node = ((middle.truncate() - corner) / machined.pitch_mm()).round();
            let within = node.cmpge(DVec2::ZERO).all()
                && node.x < machined.columns() as f64
                && node.y < machined.rows() as f64;
            let highest = corners.iter().map(|corner| corner.z).fold(f64::NEG_INFINITY, f64::max);
            let above = highest + machined.pitch_mm();
            let node = || node.y as usize * machined.columns() + node.x as usize;
            let covered = within && tops[node()] > above;
            !covered
        };
        let up = facing_up(mesh, bounds, on_top);
        let mut triangles: Vec<[DVec3; 3]> = up.iter().map(|t| mesh.corners(*t as usize)).collect();
        let bottom_mm = bounds.min.z.min(machined.bounds().min.z);
        triangles.extend(curtains(mesh, &up, bottom_mm));
        if up.is_empty() || u32::try_from(triangles.len()).is_err() {
            return Err(DeviationError::NoTop);
        }
        let mut branches = Vec::with_capacity(triangles.len());
        let count = triangles.len();
        plant(&mut triangles, 0, &mut branches, tick).ok_or(DeviationError::Stopped)?;
        debug_assert_eq!(branches[0].triangles, [0, count as u32]);
        let extent = [bounds.min.truncate(), bounds.max.truncate()];
        Ok(Self { triangles, branches, extent, tops, columns: machined.columns() })
    }

    fn look(&self, t: u32, point: DVec3, best: &mut (f64, u32)) {
        let found = distance2(point, self.triangles[t as usize]);
        if found < best.0 {
            *best = (found, t);
        }
    }

    fn descend(&self, at: usize, point: DVec3, best: &mut (f64, u32)) {
        let branch = &self.branches[at];
        if branch.second == 0 {
            let [from, to] = branch.triangles;
            (from..to).for_each(|t| self.look(t, point, best));
            return;
        }
        let children = [at + 1, branch.second as usize].map(|child| {
            let branch = &self.branches[child];
            (to_box2(point, branch.low, branch.high), child)
        });
        let [a, b] = children;
        for (near2, child) in if b.0 < a.0 { [b, a] } else { [a, b] } {
            if near2 < best.0 {
                self.descend(child, point, best);
            }
        }
    }
}

/// Upright triangles under the edges at which the top ends: rims of open meshes, and lips and folds that hang
/// over. A cutter that grazes one is as deep in the part as it is behind its edge, however far the top
/// lies above.
fn curtains(mesh: &Mesh, up: &[u32], bottom_mm: f64) -> Vec<[DVec3; 3]> {
    let same = first_of_equals(&mesh.vertices);
    let plan = |v: u32| mesh.vertices[v as usize].truncate();
    // The edge, and on which sides of it there is something; an upright triangle goes down by itself.
    let edge = |a: u32, b: u32, c: u32| {
        let (a, b) = (a.min(b), a.max(b));
        let side = (plan(b) - plan(a)).perp_dot(plan(c) - plan(a));
        let sides = u8::from(side >= 0.0) | u8::from(side <= 0.0) << 1;
        (u64::from(a) << 32 | u64::from(b), sides)
    };
    let edges_of = |t: &u32| {
        let [a, b, c] = mesh.triangles[*t as usize].map(|v| same[v as usize]);
        [edge(a, b, c), edge(b, c, a), edge(c, a, b)]
    };
    let mut edges: Vec<(u64, u8)> = up.par_iter().flat_map_iter(edges_of).collect();
    edges.par_sort_unstable();
    let ends = edges.chunk_by(|(a, _), (b, _)| a == b);
    let ends = ends.filter(|of| of.iter().fold(0, |sides, one| sides | one.1) != 3);
    let curtain = |of: &[(u64, u8)]| {
        let [a, b] =
            [of[0].0 >> 32, of[0].0 & u64::from(u32::MAX)].map(|v| mesh.vertices[v as usize]);
        let [under_a, under_b] = [a, b].map(|corner| corner.with_z(bottom_mm));
        [[a, b, under_b], [a, under_b, under_a]]
    };
    ends.flat_map(curtain).collect()
}

/// For each vertex one that stands at the same place: corners of triangles that touch need not be shared.
fn first_of_equals(vertices: &[DVec3]) -> Vec<u32> {
    let place = |v: &u32| vertices[*v as usize].to_array().map(|c| (c + 0.0).to_bits());
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.par_sort_unstable_by_key(place);
    let mut same = vec![0; vertices.len()];
    for equal in order.chunk_by(|a, b| place(a) == place(b)) {
        equal.iter().for_each(|v| same[*v as usize] = equal[0]);
    }
    same
}

/// Whether neighbours face opposite ways: both go along their edge in one direction.
fn faces_both_ways(mesh: &Mesh) -> bool {
    let same = first_of_equals(&mesh.vertices);
    let edges_of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| u64::from(same[v as usize]));
        [a << 32 | b, b << 32 | c, c << 32 | a]
    };
    let mut edges: Vec<u64> = mesh.triangles.par_iter().flat_map_iter(edges_of).collect();
    edges.par_sort_unstable();
    edges.windows(2).any(|pair| pair[0] == pair[1])
}

/// The triangles that do not face down, and those that do and are `on_top`.
fn facing_up(mesh: &Mesh, bounds: Bounds, on_top: impl Fn([DVec3; 3]) -> bool) -> Vec<u32> {
    let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let corners = || (0..mesh.triangles.len()).map(|t| mesh.corners(t));
    // Twice the volume between the triangles and the lowest of all places, and the area seen from above.
    let (mut volume, mut area) = (0.0, 0.0);
    for [a, b, c] in corners() {
        let up = normal([a, b, c]).z;
        volume += up * ((a.z + b.z + c.z) / 3.0 - bounds.min.z);
        area += up;
    }
    let turned = if volume == 0.0 { area < 0.0 } else { volume < 0.0 };
    let sign = if turned { -1.0 } else { 1.0 };
    let faces_up = |corners: [DVec3; 3]| {
        let normal = normal(corners);
        sign * normal.z >= -UPRIGHT * normal.length()
    };
    let all = u32::try_from(mesh.triangles.len()).unwrap_or(u32::MAX);
    let counts = |corners| faces_up(corners) || on_top(corners);
    (0..all).filter(|t| counts(mesh.corners(*t as usize))).collect()
}

/// Puts triangles in the order of the tree and adds its branches; `first` is the number of the first.
fn plant(
    triangles: &mut [[DVec3; 3]],
    first: usize,
    branches: &mut Vec<Branch>,
    tick: Tick,
) -> Option<()> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in triangles.iter().flatten() {
        (low, high) = (low.min(*corner), high.max(*corner));
    }
    let at = branches.len();
    let range = [first, first + triangles.len()].map(|t| t as u32);
    branches.push(Branch { low, high, triangles: range, second: 0 });
    if triangles.len() <= LEAF {
        return Some(());
    }
    tick(0).then_some(())?;
    let size = high - low;
    let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    let middle = |t: &[DVec3; 3]| t[0][axis] + t[1][axis] + t[2][axis];
    let half = triangles.len() / 2;
    triangles.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
    let (before, after) = triangles.split_at_mut(half);
    plant(before, first, branches, tick)?;
    branches[at].second = branches.len() as u32;
    plant(after, first + half, branches, tick)
}

/// Heights of the top of a mesh at the nodes of a surface.
fn tops(mesh: &Mesh, machined: &HeightField, corner: DVec2, tick: Tick) -> Option<Vec<f64>> {
    let (columns, rows, pitch_mm) = (machined.columns(), machined.rows(), machined.pitch_mm());
    let size = machined.bounds().max;
    let bounds = Bounds { min: corner.extend(0.0), max: corner.extend(0.0) + size };
    let grid = FieldGrid { columns, rows, pitch_mm };
    let heights = mesh_to_field(mesh, bounds, grid, f32::NAN, &|_| tick(0))?;
    Some(heights.into_iter().map(f64::from).collect())
}

impl Ground for OnMesh {
    type Hint = u32;

    fn extent(&self) -> [DVec2; 2] {
        self.extent
    }

    fn under(&self, [i, j]: [usize; 2], _: DVec2) -> Option<(f64, Option<f64>)> {
        let top = self.tops[j * self.columns + i];
        (!top.is_nan()).then_some((top, None))
    }

    fn nearest2(&self, point: DVec3, within2: f64, hint: &mut u32) -> f64 {
        let mut best = (within2, *hint);
        self.look(*hint, point, &mut best);
        self.descend(0, point, &mut best);
        *hint = best.1;
        best.0
    }
}

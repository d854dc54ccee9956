//! How far a machined surface lies from the one that was meant: gouge below it, excess above.
//!
//! At each node of the machined surface the distance to the nearest point of the target is told, with the sign
//! of the side on which the node lies. Beside a wall the difference in height may be the wall's, and the
//! distance nothing.
//!
//! # Method
//! Above or below is told by the target's height at the node, dz away. The distance is no more than |dz|;
//! where that is less than [`FIRST_ORDER_MM`] over a field, |dz|·cos θ is taken for it, θ the slope at the
//! node, which is off by less than |dz|. Elsewhere the nearest triangle is searched for in a tree of boxes
//! ([`on_field`], [`on_mesh`]), from the triangle that was nearest to the node before. So the
//! search is bounded by what it looks for, and most nodes look at a few triangles.
//!
//! # Limits
//! * Of a mesh the triangles that face up or stand upright count, whether a cutter can see them or not; those
//!   that face down do not. Which way is up is told by most of the mesh, see [`on_mesh`]. Where neighbours face
//!   opposite ways those that face down count too, unless something lies above them.
//! * Where the top of a mesh ends, the part goes straight down from there: so a cutter that grazes the rim
//!   of a sheet is not as deep in it as the sheet is high. Cracks in a mesh are such ends too, and a gouge
//!   beside one is no deeper than it is far from it.
//! * Nodes over nothing (beyond the target, over holes) do not count.

mod closest;
mod on_field;
mod on_mesh;

#[cfg(test)]
mod tests;

use crate::{FieldGrid, HeightField, Mesh, Tick};
use glam::{DVec2, DVec3};
use on_field::OnField;
use on_mesh::OnMesh;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Where the target is nearer than this straight up or down, its distance is that to its plane there: a
/// thousandth of a millimetre is less than any machine holds.
pub const FIRST_ORDER_MM: f64 = 1e-3;

/// What was meant.
#[derive(Clone, Copy, Debug)]
pub enum Target<'a> {
    /// A field's triangles, and where its first node stands, in mm.
    Field(&'a HeightField, DVec2),
    /// A mesh's top.
    Mesh(&'a Mesh),
}

/// How far a surface lies from another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// Where the first node stands, in mm.
    pub corner: DVec2,
    /// The nodes.
    pub grid: FieldGrid,
    /// The distance of each node from the target in mm, row by row from y = 0: above it positive, below
    /// it negative, NaN where it does not count.
    pub distances_mm: Vec<f32>,
    /// All in all.
    pub extent: Extent,
}

/// The extent of a deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Extent {
    /// Nodes that count; if none do all else is 0.
    pub nodes: usize,
    /// The farthest below the target, in mm, not negative.
    pub max_gouge_mm: f64,
    /// The node there.
    pub gouge_at: DVec3,
    /// The farthest above the target, in mm, not negative.
    pub max_excess_mm: f64,
    /// The node there.
    pub excess_at: DVec3,
    /// 99 % of the nodes lie no farther above, in mm.
    pub p99_excess_mm: f64,
    /// 99 % of the nodes lie no farther below, in mm.
    pub p99_gouge_mm: f64,
    /// Mean distance, with its sign, in mm.
    pub mean_mm: f64,
}

impl Deviation {
    /// That of a surface which is compared with nothing: no node counts.
    #[must_use]
    pub fn nowhere() -> Self {
        let grid = FieldGrid { columns: 0, rows: 0, pitch_mm: 0.0 };
        Self { corner: DVec2::ZERO, grid, distances_mm: Vec::new(), extent: Extent::default() }
    }
}

/// Why there is no deviation.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum DeviationError {
    /// A mesh that is none.
    #[error("triangle {triangle} of the target has a corner that is missing or not finite")]
    BadTriangle {
        /// The triangle, counted from 0.
        triangle: usize,
    },
    /// A mesh without triangles that face up.
    #[error("the target has no triangle that faces up")]
    NoTop,
    /// The tick answered no.
    #[error("stopped")]
    Stopped,
}

/// How far `machined`, whose first node stands at `corner`, lies from a target. Nodes within `border_mm` of
/// the border of the target's rectangle do not count.
///
/// `tick` is told of nodes.
///
/// # Errors
/// If the target is no surface or `tick` stopped the work.
pub fn deviation(
    machined: &HeightField,
    corner: DVec2,
    target: Target,
    border_mm: f64,
    tick: Tick,
) -> Result<Deviation, DeviationError> {
    match target {
        Target::Field(field, origin) => {
            let ground = OnField::new(field, origin);
            compare(machined, corner, &ground, border_mm, tick)
        }
        Target::Mesh(mesh) => {
            let ground = OnMesh::new(mesh, machined, corner, tick)?;
            compare(machined, corner, &ground, border_mm, tick)
        }
    }
}

/// A target that can be searched.
trait Ground: Sync {
    /// The number of a triangle, to begin with at the next node.
    type Hint: Copy + Default;

    /// Opposite corners of its rectangle, in mm.
    fn extent(&self) -> [DVec2; 2];

    /// Height under node (i, j), which stands at a place, in mm, and the cosine of the slope if it is
    /// known.
    fn under(&self, node: [usize; 2], place: DVec2) -> Option<(f64, Option<f64>)>;

    /// The squared distance of the nearest triangle if it is less than `within2`, in mm².
    fn nearest2(&self, point: DVec3, within2: f64, hint: &mut Self::Hint) -> f64;
}

fn compare(
    machined: &HeightField,
    corner: DVec2,
    ground: &impl Ground,
    border_mm: f64,
    tick: Tick,
) -> Result<Deviation, DeviationError> {
    let (columns, rows, pitch_mm) = (machined.columns(), machined.rows(), machined.pitch_mm());
    let [low, high] = ground.extent();
    // A node on the border counts if no band is left out, whatever rounding says.
    let band = DVec2::splat(border_mm - 1e-9 * (high - low).max_element());
    let (low, high) = (low + band, high - band);
    let mut distances_mm = vec![f32::NAN; columns * rows];
    let of_row = |(j, row): (usize, &mut [f32])| {
        let mut hint = Default::default();
        for (i, out) in row.iter_mut().enumerate() {
            let point = machined.point(i, j) + corner.extend(0.0);
            let place = point.truncate();
            if place.cmpge(low).all() && place.cmple(high).all() {
                *out = at_node(ground, [i, j], point, &mut hint) as f32;
            }
        }
        tick(columns).then_some(())
    };
    let done = distances_mm.par_chunks_exact_mut(columns).enumerate().try_for_each(of_row);
    done.ok_or(DeviationError::Stopped)?;
    let extent = extent_of(&distances_mm, machined, corner);
    let grid = FieldGrid { columns, rows, pitch_mm };
    Ok(Deviation { corner, grid, distances_mm, extent })
}

/// The signed distance of a node; NaN over nothing.
fn at_node<G: Ground>(ground: &G, node: [usize; 2], point: DVec3, hint: &mut G::Hint) -> f64 {
    let Some((height, cos)) = ground.under(node, point.truncate()) else { return f64::NAN };
    let above = point.z - height;
    if above.abs() <= FIRST_ORDER_MM
        && let Some(cos) = cos
    {
        return above * cos;
    }
    ground.nearest2(point, above * above, hint).sqrt().copysign(above)
}

fn extent_of(distances: &[f32], machined: &HeightField, corner: DVec2) -> Extent {
    let counted = |(_, v): &(usize, &f32)| !v.is_nan();
    let all = || distances.par_iter().enumerate().filter(counted);
    let place = |k: usize| {
        let columns = machined.columns();
        machined.point(k % columns, k / columns) + corner.extend(0.0)
    };
    // Of equal ones the first.
    let highest = all().reduce_with(|a, b| if b.1 > a.1 { b } else { a });
    let lowest = all().reduce_with(|a, b| if b.1 < a.1 { b } else { a });
    let (Some(highest), Some(lowest)) = (highest, lowest) else {
        return Extent::default();
    };
    let mut sorted: Vec<f32> = distances.iter().copied().filter(|v| !v.is_nan()).collect();
    let nodes = sorted.len();
    let mean_mm = sorted.iter().map(|v| f64::from(*v)).sum::<f64>() / nodes as f64;
    let mut rank = |k: usize| f64::from(*sorted.select_nth_unstable_by(k, f32::total_cmp).1);
    let of_99 = (nodes * 99).div_ceil(100).max(1) - 1;
    Extent {
        nodes,
        max_gouge_mm: f64::from(-*lowest.1).max(0.0),
        gouge_at: place(lowest.0),
        max_excess_mm: f64::from(*highest.1).max(0.0),
        excess_at: place(highest.0),
        p99_excess_mm: rank(of_99).max(0.0),
        p99_gouge_mm: (-rank(nodes - 1 - of_99)).max(0.0),
        mean_mm,
    }
}

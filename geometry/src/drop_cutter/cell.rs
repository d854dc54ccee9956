//! Triangles and edges of a field's mesh, seen from the axis of a cutter.
//!
//! Each cell is split along the diagonal from (i, j) to (i + 1, j + 1). Around a node lie six
//! edges, counter-clockwise from +x, and six triangles: triangle k between edges k and k + 1.
//!
//! ```text
//!        2   1
//!        | T1/ T0
//!     T2 |  /
//!   3 ---node--- 0
//!      / | T5
//! T3  /  |
//!    4   5
//!      T4
//! ```

use super::best::Place;
use super::edge::Edge;
use super::search::Ground;
use super::shape::Facet;
use glam::{DVec2, DVec3};

/// Edges around a node: columns and rows to the other end.
pub(super) const AROUND: [(isize, isize); 6] = [(1, 0), (1, 1), (0, 1), (-1, 0), (-1, -1), (0, -1)];

/// Bits of all edges around a node.
pub(super) const ALL_EDGES: u32 = 0b11_1111;

/// The cell of each triangle around a node, relative to it, and whether it is the one above the
/// cell's diagonal.
const TRIANGLES: [(isize, isize, bool); 6] =
    [(0, 0, false), (0, 0, true), (-1, 0, false), (-1, -1, true), (-1, -1, false), (0, -1, true)];

/// Heights at the other ends of the edges around a node; NaN beyond the border.
#[inline]
pub(super) fn heights_around(ground: &Ground, i: usize, j: usize) -> [f64; 6] {
    let (columns, at) = (ground.columns, j * ground.columns + i);
    if i > 0 && j > 0 && i + 1 < columns && j + 1 < ground.rows {
        let h = |k: usize| f64::from(ground.heights[k]);
        let up = at + columns;
        let down = at - columns;
        return [h(at + 1), h(up + 1), h(up), h(at - 1), h(down - 1), h(down)];
    }
    AROUND.map(|(di, dj)| {
        let (i, j) = (i.wrapping_add_signed(di), j.wrapping_add_signed(dj));
        if i < columns && j < ground.rows { ground.height(i, j) } else { f64::NAN }
    })
}

/// Bits of the edges along which the clearance's tangent falls below 0. `climb` is the rise of h
/// over a pitch along x and y.
#[inline]
pub(super) fn falling_edges(z: f64, around: &[f64; 6], climb: DVec2, clearance: f64) -> u32 {
    let base = clearance + z;
    let (x, y, xy) = (climb.x, climb.y, climb.x + climb.y);
    // NaN, beyond the border, does not fall.
    u32::from(base + x < around[0])
        | u32::from(base + xy < around[1]) << 1
        | u32::from(base + y < around[2]) << 2
        | u32::from(base - x < around[3]) << 3
        | u32::from(base - xy < around[4]) << 4
        | u32::from(base - y < around[5]) << 5
}

/// A triangle: the plane z = z0 + a·x + b·y about its first node, and which half of a cell.
pub(super) struct Triangle {
    /// Its first node, (i, j).
    node: Place,
    /// From the axis to the first node, in mm.
    to_first: DVec2,
    /// Height of the first node, in mm.
    z0: f64,
    /// Slope of the plane.
    slope: DVec2,
    /// Above the diagonal.
    upper: bool,
    pitch: f64,
}

impl Triangle {
    /// Triangle `k` around node (i, j); `None` beyond the border.
    #[inline]
    pub(super) fn around(ground: &Ground, at: DVec2, i: usize, j: usize, k: usize) -> Option<Self> {
        let (di, dj, upper) = TRIANGLES[k];
        let (i, j) = (i.checked_add_signed(di)?, j.checked_add_signed(dj)?);
        if i + 1 >= ground.columns || j + 1 >= ground.rows {
            return None;
        }
        let (z00, z11) = (ground.height(i, j), ground.height(i + 1, j + 1));
        let rise = if upper {
            let z01 = ground.height(i, j + 1);
            DVec2::new(z11 - z01, z01 - z00)
        } else {
            let z10 = ground.height(i + 1, j);
            DVec2::new(z10 - z00, z11 - z10)
        };
        let first = DVec2::new(i as f64, j as f64) * ground.pitch;
        Some(Self {
            node: (i, j),
            to_first: first - at,
            z0: z00,
            slope: rise / ground.pitch,
            upper,
            pitch: ground.pitch,
        })
    }
}

impl Facet for Triangle {
    #[inline]
    fn place(&self) -> Place {
        self.node
    }

    #[inline]
    fn slope(&self) -> DVec2 {
        self.slope
    }

    #[inline]
    fn height_at_axis(&self) -> f64 {
        self.z0 - self.slope.dot(self.to_first)
    }

    #[inline]
    fn holds(&self, place: DVec2) -> bool {
        let DVec2 { x, y } = place - self.to_first;
        if self.upper {
            x >= 0.0 && x <= y && y <= self.pitch
        } else {
            y >= 0.0 && y <= x && x <= self.pitch
        }
    }

    #[inline]
    fn point(&self, at: DVec2, place: DVec2) -> DVec3 {
        (at + place).extend(self.z0 + self.slope.dot(place - self.to_first))
    }

    #[inline]
    fn tip(&self, on_plane: f64, _: DVec2, _: f64) -> f64 {
        on_plane
    }
}

/// The edge from node (i, j) the way `k` of [`AROUND`] (0, 1 or 2); its other end must exist.
#[inline]
pub(super) fn edge_from(ground: &Ground, at: DVec2, i: usize, j: usize, k: usize) -> Edge {
    let (di, dj) = AROUND[k];
    let (di, dj) = (di as usize, dj as usize);
    let z0 = ground.height(i, j);
    let rise = ground.height(i + di, j + dj) - z0;
    let (length, direction) = if k == 1 {
        (ground.pitch * std::f64::consts::SQRT_2, DVec2::splat(std::f64::consts::FRAC_1_SQRT_2))
    } else {
        (ground.pitch, DVec2::new(di as f64, dj as f64))
    };
    Edge::new(DVec2::new(i as f64, j as f64) * ground.pitch - at, z0, direction, length, rise)
}

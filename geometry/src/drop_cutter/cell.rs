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

use super::search::Ground;
use glam::DVec2;
use wide::f64x2;

/// Edges around a node: columns and rows to the other end.
pub(super) const AROUND: [(isize, isize); 6] = [(1, 0), (1, 1), (0, 1), (-1, 0), (-1, -1), (0, -1)];

/// Bits of all edges around a node.
pub(super) const ALL_EDGES: u32 = 0b11_1111;

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

/// Bits of the edges whose other ends lie above a plane: that is `base` high at the node and climbs by
/// `climb` over a pitch along x and y.
#[inline]
pub(super) fn ends_above(around: &[f64; 6], base: f64, climb: DVec2) -> u32 {
    let above = |k: usize, first: f64, second: f64| {
        let plane = f64x2::splat(base) + f64x2::from([first, second]);
        // NaN, beyond the border, is not.
        plane.simd_lt(f64x2::from([around[k], around[k + 1]])).to_bitmask() << k
    };
    let xy = climb.x + climb.y;
    above(0, climb.x, xy) | above(2, climb.y, -climb.x) | above(4, -xy, -climb.y)
}

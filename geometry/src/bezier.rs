//! Bézier patches as closed parts.
//!
//! A patch of degree (m, n) over a net of control points P_ij, i = 0..m along u, j = 0..n along v:
//! S(u, v) = Σ Σ B_i,m(u) · B_j,n(v) · P_ij, evaluated by de Casteljau's scheme along v, then along u: only
//! means of points, so that it is stable for any degree and gives the net's corners bit by bit.
//!
//! The two test parts are those of Sood, *Novel algorithms for CAD-free machining* (thesis, 2015), tables
//! 5.1 and 5.4, and so is their tessellation: even steps in u and v, each cell two triangles, below it four
//! walls, each a fan of triangles from a corner of the base, and a base of two. With n steps that is
//! 2n² + 4(n + 1) + 2 triangles: 886 for n = 20, 3,366 for n = 40, as in the source. Each cell is split along
//! the diagonal from (i, j) to (i + 1, j + 1); the source does not say which.
//!
//! Limits: a net whose patch folds over itself in plan gives a part that does, too. It is closed, and a
//! cutter dropped on it touches what is highest.

use crate::{Mesh, Tick};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// A net of more rows or columns is refused: each point takes their product squared of steps, and surfaces
/// of such degree follow their net hardly at all.
const MAX_SIDE: usize = 32;

/// More steps are refused: 8 million triangles, some 300 MB.
const MAX_DIVISIONS: usize = 2000;

/// Why there is no patch or part.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum BezierError {
    /// Too few or too many rows or columns.
    #[error("a net has 2 to {MAX_SIDE} rows and columns; this one has {rows} × {columns}")]
    BadSize {
        /// Rows, along u.
        rows: usize,
        /// Columns, along v.
        columns: usize,
    },
    /// Rows of different length.
    #[error("row {row} of the net has {given} points, the first has {columns}")]
    Ragged {
        /// The row, counted from 1.
        row: usize,
        /// Its points.
        given: usize,
        /// Points of the first row.
        columns: usize,
    },
    /// A coordinate that is NaN, infinite or beyond all measure.
    #[error("point {column} in row {row} of the net is at {at}: too far away, or no number")]
    NotFinite {
        /// The row, counted from 1.
        row: usize,
        /// The column, counted from 1.
        column: usize,
        /// Where it lies, in mm.
        at: DVec3,
    },
    /// No steps, or too many.
    #[error("a side is divided into 1 to {MAX_DIVISIONS} steps, not {0}")]
    BadDivisions(usize),
    /// The part would have no body.
    #[error(
        "the base at {base_z_mm} mm must lie below the surface, which comes down to {low_mm} mm"
    )]
    BaseTooHigh {
        /// Height of the base, in mm.
        base_z_mm: f64,
        /// Lowest point of the surface, in mm.
        low_mm: f64,
    },
    /// The tick answered no.
    #[error("stopped")]
    Stopped,
}

/// Coordinates beyond this lose the digits that meshes need, in mm.
const MAX_REACH_MM: f64 = 1e7;

/// A patch over a net of control points.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierPatch {
    /// Row by row; a row runs along v.
    net: Vec<DVec3>,
    columns: usize,
}

impl BezierPatch {
    /// A patch over rows of control points in mm. Along a row v grows, from row to row u.
    ///
    /// # Errors
    /// If there are fewer than two or too many rows or columns, rows differ in length, or a point is not
    /// finite.
    pub fn new(rows: &[Vec<DVec3>]) -> Result<Self, BezierError> {
        let columns = rows.first().map_or(0, Vec::len);
        let sound = |side: usize| (2..=MAX_SIDE).contains(&side);
        if !sound(rows.len()) || !sound(columns) {
            return Err(BezierError::BadSize { rows: rows.len(), columns });
        }
        for (r, row) in rows.iter().enumerate() {
            if row.len() != columns {
                return Err(BezierError::Ragged { row: r + 1, given: row.len(), columns });
            }
            let near = |at: &DVec3| at.is_finite() && at.abs().max_element() <= MAX_REACH_MM;
            if let Some(c) = row.iter().position(|at| !near(at)) {
                return Err(BezierError::NotFinite { row: r + 1, column: c + 1, at: row[c] });
            }
        }
        Ok(Self { net: rows.concat(), columns })
    }

    /// The test part of table 5.1: 50 × 100 × 25 mm, rising from a corner.
    #[must_use]
    pub fn rising() -> Self {
        Self::biquadratic(
            [[0.0, 50.0, 100.0], [0.0, 48.0, 100.0], [0.0, 50.0, 100.0]],
            [[19.0, 24.0, 25.0], [24.0, 24.5, 25.0], [25.0, 25.0, 25.0]],
        )
    }

    /// The test part of table 5.4: 50 × 50 × 25 mm, convex.
    #[must_use]
    pub fn convex() -> Self {
        Self::biquadratic(
            [[0.0, 25.0, 50.0]; 3],
            [[15.0, 21.0, 15.0], [21.0, 25.0, 21.0], [15.0, 21.0, 15.0]],
        )
    }

    /// Three by three points at x = 0, 25, 50 mm.
    fn biquadratic(y: [[f64; 3]; 3], z: [[f64; 3]; 3]) -> Self {
        let point = |k: usize| DVec3::new(25.0 * (k / 3) as f64, y[k / 3][k % 3], z[k / 3][k % 3]);
        Self { net: (0..9).map(point).collect(), columns: 3 }
    }

    /// The point at u, v, in mm.
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> DVec3 {
        let mut curve: Vec<DVec3> =
            self.net.chunks(self.columns).map(|row| de_casteljau(&mut row.to_vec(), v)).collect();
        de_casteljau(&mut curve, u)
    }

    /// The part below the patch: its surface in `divisions` steps each way, walls, and a base at a height.
    /// Its triangles are counter-clockwise seen from outside. `tick` counts rows.
    ///
    /// # Errors
    /// If there are no steps or too many, the base is not below the surface, or `tick` stopped the work.
    pub fn part(&self, divisions: usize, base_z_mm: f64, tick: Tick) -> Result<Mesh, BezierError> {
        if !(1..=MAX_DIVISIONS).contains(&divisions) {
            return Err(BezierError::BadDivisions(divisions));
        }
        let share = |k: usize| k as f64 / divisions as f64;
        let row = |i: usize| {
            let points = (0..=divisions).map(|j| self.point(share(i), share(j)));
            let points: Vec<DVec3> = points.collect();
            if tick(1) { Ok(points) } else { Err(BezierError::Stopped) }
        };
        let rows: Result<Vec<_>, _> = (0..=divisions).into_par_iter().map(row).collect();
        let vertices = rows?.concat();
        let low_mm = vertices.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
        // NaN lies below nothing.
        let is_below = base_z_mm < low_mm;
        if !is_below {
            return Err(BezierError::BaseTooHigh { base_z_mm, low_mm });
        }
        Ok(closed(vertices, divisions, base_z_mm))
    }
}

/// The point of a curve over control points, which are used up.
fn de_casteljau(points: &mut [DVec3], t: f64) -> DVec3 {
    for count in (1..points.len()).rev() {
        for k in 0..count {
            points[k] = points[k] * (1.0 - t) + points[k + 1] * t;
        }
    }
    points[0]
}

/// The grid of a surface as a closed part.
fn closed(mut vertices: Vec<DVec3>, divisions: usize, base_z_mm: f64) -> Mesh {
    let side = divisions + 1;
    let at = |i: usize, j: usize| (i * side + j) as u32;
    let mut triangles = Vec::with_capacity(2 * divisions * divisions + 4 * (divisions + 2) + 2);
    for (i, j) in (0..divisions).flat_map(|i| (0..divisions).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    // Around the border, u first: each side from its corner to the next.
    let along = |k: usize| {
        let s = move |m: usize| match k {
            0 => at(m, 0),
            1 => at(divisions, m),
            2 => at(divisions - m, divisions),
            _ => at(0, divisions - m),
        };
        (0..side).map(s).collect::<Vec<u32>>()
    };
    let base = vertices.len() as u32;
    for k in 0..4 {
        let rim = along(k);
        vertices.push(vertices[rim[0] as usize].with_z(base_z_mm));
        let (corner, next) = (base + k as u32, base + (k as u32 + 1) % 4);
        triangles.push([corner, next, rim[divisions]]);
        triangles.extend(rim.windows(2).map(|pair| [corner, pair[1], pair[0]]));
    }
    triangles.extend([[base, base + 2, base + 1], [base, base + 3, base + 2]]);
    let corners = [0, 1, 2, 3].map(|k| vertices[(base + k) as usize].truncate());
    if (corners[2] - corners[0]).perp_dot(corners[3] - corners[1]) < 0.0 {
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    Mesh { vertices: Arc::new(vertices), triangles }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::find_defects;

    fn net(rows: usize, columns: usize, at: impl Fn(f64, f64) -> DVec3) -> Vec<Vec<DVec3>> {
        let row = |i: usize| (0..columns).map(|j| at(i as f64, j as f64)).collect();
        (0..rows).map(row).collect()
    }

    #[test]
    fn a_biquadratic_patch_is_its_closed_form() {
        let patch = BezierPatch::rising();
        let weights = |t: f64| [(1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t];
        for (u, v) in (0..=20).flat_map(|i| (0..=20).map(move |j| (i, j))) {
            let (u, v) = (f64::from(u) / 20.0, f64::from(v) / 20.0);
            let mut sum = DVec3::ZERO;
            for (k, p) in patch.net.iter().enumerate() {
                sum += *p * weights(u)[k / 3] * weights(v)[k % 3];
            }
            assert!(patch.point(u, v).distance(sum) < 1e-12);
        }
        // The middle of table 5.1 by hand: z = (19 + 25 + 25 + 25 + 2·(24 + 24 + 25 + 25) + 4·24.5) / 16.
        assert_eq!(patch.point(0.5, 0.5), DVec3::new(25.0, 49.5, 24.25));
    }

    #[test]
    fn corners_are_those_of_the_net_bit_by_bit() {
        let mut random = fastrand::Rng::with_seed(5);
        for (rows, columns) in [(2, 2), (3, 7), (8, 4), (32, 32)] {
            let mut random = || random.f64() * 100.0 - 50.0;
            let points: Vec<Vec<DVec3>> = (0..rows)
                .map(|_| (0..columns).map(|_| DVec3::new(random(), random(), random())).collect())
                .collect();
            let patch = BezierPatch::new(&points).unwrap();
            let (m, n) = (rows - 1, columns - 1);
            for (u, v, corner) in [
                (0.0, 0.0, points[0][0]),
                (1.0, 0.0, points[m][0]),
                (0.0, 1.0, points[0][n]),
                (1.0, 1.0, points[m][n]),
            ] {
                assert_eq!(patch.point(u, v), corner);
            }
        }
    }

    #[test]
    fn weights_add_up_to_1_and_even_nets_give_even_patches() {
        let one = BezierPatch::new(&net(5, 9, |_, _| DVec3::splat(7.0))).unwrap();
        let even = net(5, 9, |i, j| DVec3::new(i / 4.0, j / 8.0, 2.0 * i / 4.0 + j / 8.0));
        let even = BezierPatch::new(&even).unwrap();
        for (u, v) in [(0.0, 0.3), (0.123, 0.9), (0.5, 0.5), (1.0, 0.77)] {
            assert!(one.point(u, v).distance(DVec3::splat(7.0)) < 1e-13);
            assert!(even.point(u, v).distance(DVec3::new(u, v, 2.0 * u + v)) < 1e-13);
        }
    }

    #[test]
    fn the_parts_of_the_source_are_closed_and_have_its_triangles() {
        for patch in [BezierPatch::rising(), BezierPatch::convex()] {
            for (divisions, count) in [(1, 12), (20, 886), (40, 3366)] {
                let part = patch.part(divisions, 0.0, &|_| true).unwrap();
                assert_eq!(part.triangles.len(), count);
                assert!(find_defects(&part, &|_| true).unwrap().is_none());
            }
        }
        let size = BezierPatch::rising().part(20, 0.0, &|_| true).unwrap().bounds().unwrap().size();
        assert_eq!(size, DVec3::new(50.0, 100.0, 25.0));
    }

    /// Six times the volume, by the tetrahedra over the origin.
    fn volume6(mesh: &Mesh) -> f64 {
        let of = |t: usize| {
            let [a, b, c] = mesh.corners(t);
            a.dot(b.cross(c))
        };
        (0..mesh.triangles.len()).map(of).sum()
    }

    #[test]
    fn outside_is_outside_whichever_way_the_net_is_written() {
        let rows = net(3, 4, |i, j| DVec3::new(i, j, 3.0 + i * j / 4.0));
        let turned: Vec<Vec<DVec3>> = rows.iter().rev().cloned().collect();
        let volumes = [rows, turned].map(|rows| {
            volume6(&BezierPatch::new(&rows).unwrap().part(9, 1.0, &|_| true).unwrap()) / 6.0
        });
        // 2 · 3 mm of plan, 2 mm up to 3, and the mean of u·v above: 1/4 · 6/4.
        let expected = 6.0 * (2.0 + 1.5 / 4.0);
        for volume in volumes {
            assert!((volume - expected).abs() < 0.02, "{volume} {expected}");
        }
    }

    #[test]
    fn bad_nets_are_refused() {
        let flat = |rows, columns| net(rows, columns, |i, j| DVec3::new(i, j, 1.0));
        let fault = |rows: &[Vec<DVec3>]| BezierPatch::new(rows).unwrap_err().to_string();
        assert!(fault(&[]).contains("this one has 0 × 0"));
        assert!(fault(&flat(3, 1)).contains("2 to 32 rows and columns; this one has 3 × 1"));
        assert!(fault(&flat(33, 2)).contains("33 × 2"));
        let mut ragged = flat(3, 3);
        ragged[2].pop();
        assert_eq!(fault(&ragged), "row 3 of the net has 2 points, the first has 3");
        let mut far = flat(3, 3);
        far[1][2].y = f64::NAN;
        assert!(fault(&far).starts_with("point 3 in row 2 of the net is at [1, NaN, 1]"));
        let part = |divisions, base| {
            let patch = BezierPatch::new(&flat(2, 2)).unwrap();
            patch.part(divisions, base, &|_| true).unwrap_err()
        };
        assert_eq!(part(0, 0.0), BezierError::BadDivisions(0));
        assert_eq!(part(2001, 0.0), BezierError::BadDivisions(2001));
        assert_eq!(part(4, 1.0), BezierError::BaseTooHigh { base_z_mm: 1.0, low_mm: 1.0 });
        assert!(matches!(part(4, f64::NAN), BezierError::BaseTooHigh { .. }));
    }

    #[test]
    fn it_stops_when_told() {
        let stopped = BezierPatch::convex().part(20, 0.0, &|_| false);
        assert_eq!(stopped, Err(BezierError::Stopped));
    }
}

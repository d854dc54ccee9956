//! Turns ordered points into triangles, and an open surface into a solid.
//!
//! Each cell of the grid becomes two triangles, split along the diagonal from (i, j) to
//! (i + 1, j + 1), counter-clockwise seen from above: (columns − 1)(rows − 1) · 2 in all (Sood,
//! thesis 2015, section 3.4).

use crate::{HeightField, Mesh, PointCloud, Tick};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Why points can't be stitched.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum StitchError {
    /// The cloud has no grid.
    #[error("the points are in no order: only the points of a grid can be stitched")]
    NotOrdered,
    /// The grid does not hold as many points as there are.
    #[error("a grid of {columns} × {rows} does not hold {points} points")]
    WrongGrid {
        /// Points along x.
        columns: usize,
        /// Points along y.
        rows: usize,
        /// Points there are.
        points: usize,
    },
    /// A surface needs two points each way.
    #[error("a surface needs at least 2 × 2 points; this grid has {columns} × {rows}")]
    TooSmall {
        /// Points along x.
        columns: usize,
        /// Points along y.
        rows: usize,
    },
    /// More vertices than indices can tell apart.
    #[error("a mesh holds at most 4294967295 vertices; this one would have {0}")]
    TooManyVertices(usize),
    /// `tick` said stop.
    #[error("interrupted")]
    Stopped,
}

/// The nodes of a field as an ordered cloud, one point a node. `tick` counts rows; `None` if it
/// stopped the work.
#[must_use]
pub fn point_cloud(field: &HeightField, tick: Tick) -> Option<PointCloud> {
    let columns = field.columns();
    let mut points = vec![DVec3::ZERO; columns * field.rows()];
    points.par_chunks_mut(columns).enumerate().try_for_each(|(j, row)| {
        for (i, point) in row.iter_mut().enumerate() {
            *point = field.point(i, j);
        }
        tick(1).then_some(())
    })?;
    Some(PointCloud { points: Arc::new(points), grid: Some((columns, field.rows())) })
}

/// Makes two triangles of each cell of an ordered cloud. The mesh shares the cloud's points. `tick`
/// counts rows of cells.
///
/// # Errors
/// If the cloud has no grid, or the grid does not fit it, is less than 2 × 2, or holds too many
/// points for 32-bit indices; or if `tick` stopped the work.
pub fn stitch(cloud: &PointCloud, tick: Tick) -> Result<Mesh, StitchError> {
    let grid = cloud.grid.ok_or(StitchError::NotOrdered)?;
    check_grid(grid, cloud.points.len(), 0)?;
    let (columns, rows) = grid;
    let per_row = 2 * (columns - 1);
    let mut triangles = vec![[0; 3]; per_row * (rows - 1)];
    let stitch_row = |(j, row): (usize, &mut [[u32; 3]])| {
        for (i, pair) in row.chunks_exact_mut(2).enumerate() {
            let near = (j * columns + i) as u32;
            let far = near + columns as u32;
            pair[0] = [near, near + 1, far + 1];
            pair[1] = [near, far + 1, far];
        }
        tick(1).then_some(())
    };
    let done = triangles.par_chunks_mut(per_row).enumerate().try_for_each(stitch_row);
    done.ok_or(StitchError::Stopped)?;
    Ok(Mesh { vertices: Arc::clone(&cloud.points), triangles })
}

/// Closes a stitched surface with walls down to `base_z_mm` and a base: a watertight solid, every
/// edge shared by two triangles that run along it in opposite directions, normals outward.
///
/// The base is a fan about its middle. It should lie below the surface: where it does not, the
/// solid is inside out.
///
/// # Errors
/// If `grid` (columns, rows) does not fit the mesh or is less than 2 × 2, or the added vertices are
/// too many for 32-bit indices.
pub fn close_solid(mesh: &Mesh, grid: (usize, usize), base_z_mm: f64) -> Result<Mesh, StitchError> {
    let count = mesh.vertices.len();
    let rim_len = 2 * (grid.0.saturating_add(grid.1)).saturating_sub(2);
    check_grid(grid, count, rim_len + 1)?;
    let rim = rim(grid);
    let mut vertices = Vec::with_capacity(count + rim.len() + 1);
    vertices.extend_from_slice(&mesh.vertices);
    vertices.extend(rim.iter().map(|&v| mesh.vertices[v as usize].with_z(base_z_mm)));
    let corner = mesh.vertices[count - 1];
    let middle = (mesh.vertices[0] + corner) / 2.0;
    vertices.push(middle.with_z(base_z_mm));

    let (first_foot, hub) = (count as u32, (count + rim.len()) as u32);
    let mut triangles = Vec::with_capacity(mesh.triangles.len() + 3 * rim.len());
    triangles.extend_from_slice(&mesh.triangles);
    for k in 0..rim.len() {
        let next = (k + 1) % rim.len();
        let (a, b) = (rim[k], rim[next]);
        let (foot_a, foot_b) = (first_foot + k as u32, first_foot + next as u32);
        triangles.push([a, foot_a, foot_b]);
        triangles.push([a, foot_b, b]);
        triangles.push([foot_b, foot_a, hub]);
    }
    Ok(Mesh { vertices: Arc::new(vertices), triangles })
}

/// The border of a grid, counter-clockwise seen from above.
fn rim((columns, rows): (usize, usize)) -> Vec<u32> {
    let at = |i: usize, j: usize| (j * columns + i) as u32;
    let near = (0..columns - 1).map(|i| at(i, 0));
    let right = (0..rows - 1).map(|j| at(columns - 1, j));
    let far = (1..columns).rev().map(|i| at(i, rows - 1));
    let left = (1..rows).rev().map(|j| at(0, j));
    near.chain(right).chain(far).chain(left).collect()
}

fn check_grid(grid: (usize, usize), points: usize, added: usize) -> Result<(), StitchError> {
    let (columns, rows) = grid;
    if columns.checked_mul(rows) != Some(points) {
        return Err(StitchError::WrongGrid { columns, rows, points });
    }
    if columns < 2 || rows < 2 {
        return Err(StitchError::TooSmall { columns, rows });
    }
    let vertices = points.saturating_add(added);
    if u32::try_from(vertices).is_ok() {
        Ok(())
    } else {
        Err(StitchError::TooManyVertices(vertices))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stitched(field: &HeightField) -> Result<Mesh, StitchError> {
        stitch(&point_cloud(field, &|_| true).unwrap(), &|_| true)
    }
    use std::collections::HashMap;

    fn bumpy(columns: usize, rows: usize) -> HeightField {
        let heights = (0..columns * rows).map(|k| (k * 7 % 5) as f32).collect();
        HeightField::new(columns, rows, 0.5, heights).unwrap()
    }

    fn volume(mesh: &Mesh) -> f64 {
        let of = |t| {
            let [a, b, c] = mesh.corners(t);
            a.dot(b.cross(c)) / 6.0
        };
        (0..mesh.triangles.len()).map(of).sum()
    }

    #[test]
    fn every_cell_has_two_triangles_that_face_up() {
        let mesh = stitched(&bumpy(5, 4)).unwrap();
        assert_eq!(mesh.triangles.len(), 4 * 3 * 2);
        for t in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(t);
            assert!((b - a).cross(c - a).z > 0.0);
        }
        assert_eq!(mesh.triangles[..2], [[0, 1, 6], [0, 6, 5]]);
    }

    #[test]
    fn numbers_of_the_source_are_reproduced() {
        for (columns, rows, triangles) in
            [(480, 480, 458_882), (119, 119, 27_848), (618, 328, 403_518)]
        {
            let mesh = stitched(&bumpy(columns, rows)).unwrap();
            assert_eq!(mesh.triangles.len(), triangles);
        }
    }

    #[test]
    fn the_mesh_shares_the_points() {
        let cloud = point_cloud(&bumpy(5, 4), &|_| true).unwrap();
        assert!(Arc::ptr_eq(&cloud.points, &stitch(&cloud, &|_| true).unwrap().vertices));
    }

    #[test]
    fn a_solid_is_watertight() {
        for (columns, rows) in [(2, 2), (2, 5), (6, 3)] {
            let mesh = stitched(&bumpy(columns, rows)).unwrap();
            let solid = close_solid(&mesh, (columns, rows), -1.0).unwrap();
            let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
            for [a, b, c] in &solid.triangles {
                for edge in [(*a, *b), (*b, *c), (*c, *a)] {
                    *edges.entry(edge).or_default() += 1;
                }
            }
            for (&(a, b), &count) in &edges {
                assert_eq!((count, edges.get(&(b, a))), (1, Some(&1)), "edge {a} {b}");
            }
            assert!(edges.keys().all(|e| (e.0 as usize) < solid.vertices.len()));
        }
    }

    #[test]
    fn the_volume_is_that_of_the_prisms() {
        let field = bumpy(6, 4);
        let mesh = stitched(&field).unwrap();
        let solid = close_solid(&mesh, (6, 4), -1.0).unwrap();
        let prism = |t| {
            let [a, b, c] = mesh.corners(t);
            0.125 * ((a.z + b.z + c.z) / 3.0 + 1.0)
        };
        let expected: f64 = (0..mesh.triangles.len()).map(prism).sum();
        assert!((volume(&solid) - expected).abs() < 1e-9);
    }

    #[test]
    fn a_box_has_the_volume_of_a_box() {
        let field = HeightField::new(4, 3, 2.0, vec![5.0; 12]).unwrap();
        let mesh = stitched(&field).unwrap();
        let solid = close_solid(&mesh, (4, 3), 1.0).unwrap();
        assert!((volume(&solid) - 6.0 * 4.0 * 4.0).abs() < 1e-9);
    }

    #[test]
    fn unfit_clouds_are_refused() {
        let loose = PointCloud { points: Arc::new(vec![DVec3::ZERO; 4]), grid: None };
        assert_eq!(stitch(&loose, &|_| true), Err(StitchError::NotOrdered));
        let wrong = PointCloud { grid: Some((2, 3)), ..loose.clone() };
        assert!(matches!(stitch(&wrong, &|_| true), Err(StitchError::WrongGrid { .. })));
        let thin = PointCloud { grid: Some((4, 1)), ..loose };
        assert!(matches!(stitch(&thin, &|_| true), Err(StitchError::TooSmall { .. })));
        assert_eq!(
            check_grid((1 << 16, 1 << 16), 1 << 32, 0),
            Err(StitchError::TooManyVertices(1 << 32))
        );
    }

    #[test]
    fn both_stop_when_told() {
        let field = bumpy(5, 4);
        assert_eq!(point_cloud(&field, &|_| false), None);
        let cloud = point_cloud(&field, &|_| true).unwrap();
        assert_eq!(stitch(&cloud, &|_| false), Err(StitchError::Stopped));
    }
}

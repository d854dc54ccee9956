use super::*;
use crate::{HeightField, point_cloud, stitch};
use std::sync::Arc;

fn mesh(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Mesh {
    let vertices = vertices.iter().map(|v| DVec3::from_array(*v)).collect();
    Mesh { vertices: Arc::new(vertices), triangles: triangles.to_vec() }
}

fn field(mesh: &Mesh, pitch_mm: f64, floor: f32) -> HeightField {
    let bounds = mesh.bounds().unwrap();
    let grid = FieldGrid::over(bounds, pitch_mm);
    let heights = mesh_to_field(mesh, bounds, grid, floor, &|_| true).unwrap();
    HeightField::new(grid.columns, grid.rows, pitch_mm, heights).unwrap()
}

/// The highest z of a mesh above a place, over all triangles, by barycentric coordinates.
fn by_brute_force(mesh: &Mesh, x: f64, y: f64, reach: f64) -> Option<f64> {
    let above = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        let p = DVec3::new(x, y, 0.0);
        let share = |u: DVec3, v: DVec3| (u - p).truncate().perp_dot((v - p).truncate()) / area;
        let (u, v, w) = (share(b, c), share(c, a), share(a, b));
        (area != 0.0 && u.min(v).min(w) >= -reach).then_some(u * a.z + v * b.z + w * c.z)
    };
    (0..mesh.triangles.len()).filter_map(above).max_by(f64::total_cmp)
}

#[test]
fn a_stitched_field_comes_back_bit_for_bit() {
    for (pitch, scale) in [(0.3, 4.0), (0.1, 1e-3), (1.0 / 3.0, 1000.0)] {
        let heights = (0..61 * 47).map(|i| (scale * f64::sin(f64::from(i))) as f32).collect();
        let before = HeightField::new(61, 47, pitch, heights).unwrap();
        let mesh = stitch(&point_cloud(&before, &|_| true).unwrap(), &|_| true).unwrap();
        assert_eq!(field(&mesh, pitch, -9.0), before);
    }
}

#[test]
fn a_moved_field_comes_back_too() {
    let heights: Vec<f32> = (0..31 * 17).map(|i| f64::sin(f64::from(i)) as f32).collect();
    let before = HeightField::new(31, 17, 0.1, heights).unwrap();
    let mut mesh = stitch(&point_cloud(&before, &|_| true).unwrap(), &|_| true).unwrap();
    let far = DVec3::new(432_100.7, -5_123_456.3, 0.0);
    mesh.vertices = Arc::new(mesh.vertices.iter().map(|v| *v + far).collect());
    assert_eq!(field(&mesh, 0.1, -9.0).heights(), before.heights());
}

#[test]
fn a_ramp_is_exact_and_what_it_leaves_open_is_floor() {
    let ramp = mesh(&[[0., 0., 0.], [4., 0., 4.], [0., 4., 8.]], &[[0, 1, 2]]);
    let field = field(&ramp, 0.5, -1.5);
    assert_eq!((field.columns(), field.rows()), (9, 9));
    for (i, j) in (0..81).map(|n| (n % 9, n / 9)) {
        let expected = if i + j <= 8 { (i + 2 * j) as f64 / 2.0 } else { -1.5 };
        assert_eq!(field.height(i, j), expected, "{i}, {j}");
    }
}

#[test]
fn walls_edges_and_spikes_are_seen_from_above() {
    // A wall in the plane y = 1, one in x = 1, and a collapsed triangle up to (2, 2, 9).
    let walls = mesh(
        &[
            [0., 1., 0.],
            [2., 1., 0.],
            [1., 1., 4.],
            [1., 0., 0.],
            [1., 2., 2.],
            [2., 2., 9.],
            [0., 0., 0.],
        ],
        &[[0, 1, 2], [3, 4, 3], [5, 5, 5], [6, 6, 6]],
    );
    let field = field(&walls, 0.5, -1.0);
    assert_eq!(field.row(2), [0.0, 2.0, 4.0, 2.0, 0.0]);
    let along: Vec<f64> = (0..5).map(|j| field.height(2, j)).collect();
    assert_eq!(along, [0.0, 0.5, 4.0, 1.5, 2.0]);
    assert_eq!((field.height(4, 4), field.height(3, 4)), (9.0, -1.0));
}

#[test]
fn the_top_of_an_overhang_wins_whatever_the_order() {
    let low = [[0., 0., 1.], [3., 0., 1.], [0., 3., 1.]];
    let high = [[1., 1., 5.], [2., 1., 5.], [1., 2., 5.]];
    let vertices = [low, high].concat();
    for triangles in [[[0, 1, 2], [3, 4, 5]], [[5, 4, 3], [2, 1, 0]]] {
        let field = field(&mesh(&vertices, &triangles), 1.0, 0.0);
        assert_eq!((field.height(1, 1), field.height(2, 1), field.height(0, 0)), (5.0, 5.0, 1.0));
    }
}

#[test]
fn random_triangles_agree_with_brute_force() {
    let mut random = fastrand::Rng::with_seed(7);
    for _ in 0..20 {
        let mut point = || [random.f64() * 10.0, random.f64() * 10.0, random.f64()];
        let vertices: Vec<[f64; 3]> = (0..90).map(|_| point()).collect();
        let triangles: Vec<[u32; 3]> = (0..30).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let mesh = mesh(&vertices, &triangles);
        let corner = mesh.bounds().unwrap().min;
        let field = field(&mesh, 0.37, -1.0);
        for (i, j) in
            (0..field.columns() * field.rows()).map(|n| (n % field.columns(), n / field.columns()))
        {
            let (x, y) = (corner.x + i as f64 * 0.37, corner.y + j as f64 * 0.37);
            let height = field.height(i, j);
            let [most, least] =
                [1e-9, -1e-9].map(|reach| by_brute_force(&mesh, x, y, reach).unwrap_or(-1.0));
            assert!(
                height >= least - 1e-6 && height <= most + 1e-6,
                "{height}, not {least} to {most}"
            );
        }
    }
}

#[test]
fn it_stops_when_told_to() {
    let ramp = mesh(&[[0., 0., 0.], [4., 0., 4.], [0., 4., 8.]], &[[0, 1, 2]]);
    let bounds = ramp.bounds().unwrap();
    assert_eq!(mesh_to_field(&ramp, bounds, FieldGrid::over(bounds, 1.0), 0.0, &|_| false), None);
}

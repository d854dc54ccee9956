//! What is cut away, what stays, and that nothing tears.

use super::*;
use crate::{find_defects, offset};

const ALL: Bounds = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };

fn boxed(min: [f64; 3], max: [f64; 3]) -> Crop {
    let bounds = Bounds { min: DVec3::from_array(min), max: DVec3::from_array(max) };
    Crop::new(bounds, None).unwrap()
}

/// A wavy sheet of 10 × 10 mm over a square grid, its vertices shared.
fn sheet(cells: u32) -> Mesh {
    let at = |k: u32| f64::from(k) * 10.0 / f64::from(cells);
    let nodes = (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j)));
    let vertices =
        nodes.map(|(i, j)| DVec3::new(at(i), at(j), 5.0 + (at(i) * 1.3).sin() + at(j).cos()));
    let number = |i: u32, j: u32| j * (cells + 1) + i;
    let cell = |(i, j): (u32, u32)| {
        let [a, b] = [number(i, j), number(i + 1, j)];
        let [c, d] = [number(i, j + 1), number(i + 1, j + 1)];
        [[a, b, d], [a, d, c]]
    };
    let cells = (0..cells).flat_map(|j| (0..cells).map(move |i| (i, j)));
    let vertices = Arc::new(vertices.collect());
    Mesh { vertices, triangles: cells.flat_map(cell).collect() }
}

/// The same without shared vertices, as STL has them.
fn loose(mesh: &Mesh) -> Mesh {
    let corners = (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t));
    let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    Mesh { vertices: Arc::new(corners.collect()), triangles: triangles.collect() }
}

/// Area seen from above.
fn area(mesh: &Mesh) -> f64 {
    let twice = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(DVec3::truncate);
        (b - a).perp_dot(c - a)
    };
    (0..mesh.triangles.len()).map(twice).sum::<f64>() / 2.0
}

#[test]
fn a_mesh_is_cut_at_the_planes_exactly_and_does_not_tear() {
    let crop = boxed([1.234, 2.5, 4.1], [7.777, 9.99, 6.2]);
    for mesh in [sheet(23), loose(&sheet(23))] {
        let upright = boxed([1.234, 2.5, -99.0], [7.777, 9.99, 99.0]).mesh(&mesh);
        assert!((area(&upright) - (7.777 - 1.234) * (9.99 - 2.5)).abs() < 1e-9);
        let bounds = upright.bounds().unwrap();
        assert_eq!(bounds.min.truncate(), DVec2::new(1.234, 2.5));
        assert_eq!(bounds.max.truncate(), DVec2::new(7.777, 9.99));
        // The open edges are those of the rim: as long as the cut, and nothing inside.
        let cut = crop.mesh(&mesh);
        let defects = find_defects(&cut, &|_| true).unwrap();
        assert_eq!((defects.non_manifold_edges, defects.flipped_edges), (0, 0));
        let corners = cut.triangles.iter().map(|t| t.map(|v| cut.vertices[v as usize]));
        let inside = |p: DVec3| {
            p.cmpgt(DVec3::new(1.234, 2.5, 4.1)).all()
                && p.cmplt(DVec3::new(7.777, 9.99, 6.2)).all()
        };
        let mut sides: HashMap<[[u64; 3]; 2], i32> = HashMap::new();
        for [a, b, c] in corners {
            for (p, q) in [(a, b), (b, c), (c, a)] {
                let bits = |p: DVec3| p.to_array().map(f64::to_bits);
                *sides.entry([bits(p), bits(q)]).or_default() += 1;
                *sides.entry([bits(q), bits(p)]).or_default() -= 1;
            }
        }
        for ([p, q], _) in sides.iter().filter(|(_, count)| **count != 0) {
            let middle = [p, q].map(|p| DVec3::from_array(p.map(f64::from_bits)));
            assert!(!inside((middle[0] + middle[1]) / 2.0), "a crack inside at {middle:?}");
        }
    }
}

#[test]
fn a_box_around_a_mesh_changes_nothing_and_one_beside_it_leaves_nothing() {
    let mesh = sheet(5);
    assert_eq!(Crop::new(ALL, None).unwrap().mesh(&mesh), mesh);
    assert_eq!(boxed([0.0; 3], [10.0; 3]).mesh(&mesh), mesh);
    assert!(boxed([20.0; 3], [30.0; 3]).mesh(&mesh).triangles.is_empty());
    let bad = Bounds { min: DVec3::ONE, max: DVec3::ZERO };
    assert!(Crop::new(bad, None).is_none());
    assert!(Crop::new(Bounds { min: DVec3::NAN, max: DVec3::ONE }, None).is_none());
}

#[test]
fn triangles_that_meet_an_outline_are_kept_whole() {
    let mesh = sheet(20);
    let outline = Polygon::rectangle(DVec2::splat(3.2), DVec2::splat(6.7)).unwrap();
    let kept = Crop::new(ALL, Some(&outline)).unwrap().mesh(&mesh);
    let wide = offset(&outline, 0.75, 1e-3).unwrap();
    for t in 0..kept.triangles.len() {
        let within = Crop::new(ALL, Some(&wide)).unwrap();
        assert!(kept.corners(t).iter().all(|corner| within.has(*corner)));
    }
    // Nothing inside is lost.
    let inner = Bounds { min: DVec3::new(3.2, 3.2, 0.0), max: DVec3::new(6.7, 6.7, 9.0) };
    let inner = Crop::new(inner, None).unwrap();
    assert!((area(&inner.mesh(&kept)) - 3.5 * 3.5).abs() < 1e-9);
    // A triangle larger than the outline, which has neither corner nor side in it.
    let large = Mesh {
        vertices: Arc::new(
            [[-50., -50., 0.], [50., -50., 0.], [5., 80., 0.]].map(DVec3::from_array).to_vec(),
        ),
        triangles: vec![[0, 1, 2]],
    };
    assert_eq!(Crop::new(ALL, Some(&outline)).unwrap().mesh(&large).triangles.len(), 1);
}

#[test]
fn points_are_kept_inside_and_on_the_border() {
    let points = [[0., 0., 0.], [1., 1., 1.], [2., 2., 2.], [3., 3., 3.]].map(DVec3::from_array);
    let cloud = PointCloud { points: Arc::new(points.to_vec()), grid: Some((2, 2)) };
    let kept = boxed([1.0; 3], [2.0; 3]).points(&cloud);
    assert_eq!((kept.points.as_slice(), kept.grid), (&points[1..3], None));
    assert_eq!(Crop::new(ALL, None).unwrap().points(&cloud), cloud);
    let hole = vec![vec![DVec2::ZERO, DVec2::X * 9.0, DVec2::splat(9.0), DVec2::Y * 9.0]];
    let ring = Polygon::new(
        [hole, Polygon::rectangle(DVec2::splat(1.5), DVec2::splat(2.5)).unwrap().loops().to_vec()]
            .concat(),
    );
    let kept = Crop::new(ALL, Some(&ring.unwrap())).unwrap().points(&cloud);
    assert_eq!(kept.points.len(), 3);
}

#[test]
fn a_field_keeps_its_nodes() {
    let heights = (0..11 * 7).map(|k| (k % 11) as f32 + 100.0 * (k / 11) as f32).collect();
    let field = HeightField::new(11, 7, 0.3, heights).unwrap();
    let crop = boxed([0.3, 0.6 - 1e-12, 0.0], [2.4, 0.95, 0.0]);
    let (part, first) = crop.field(&field, None).unwrap();
    assert_eq!((part.columns(), part.rows(), first), (8, 2, [1, 2]));
    assert_eq!((part.height(0, 0), part.height(7, 1)), (201.0, 308.0));
    let (all, first) = Crop::new(ALL, None).unwrap().field(&field, None).unwrap();
    assert_eq!((all, first), (field.clone(), [0, 0]));
    for gone in [boxed([9.0; 3], [10.0; 3]), boxed([-2.0; 3], [-1.0; 3]), boxed([0.1; 3], [0.2; 3])]
    {
        let fault = gone.field(&field, None).unwrap_err();
        assert!(matches!(fault, HeightFieldError::TooSmall { .. }), "{fault}");
    }
}

#[test]
fn a_field_is_lowered_beside_an_outline() {
    let field = HeightField::new(10, 10, 1.0, (0..100).map(|k| k as f32).collect()).unwrap();
    let corners = [(1.0, 1.0), (5.0, 1.0), (1.0, 5.0)].map(|(x, y)| DVec2::new(x, y));
    let crop = Crop::new(ALL, Some(&Polygon::new(vec![corners.to_vec()]).unwrap())).unwrap();
    let (part, first) = crop.field(&field, None).unwrap();
    assert_eq!((part.columns(), part.rows(), first), (5, 5, [1, 1]));
    assert_eq!((part.height(0, 0), part.height(2, 2), part.height(4, 4)), (11.0, 33.0, 11.0));
    assert_eq!(crop.field(&field, Some(-1.0)).unwrap().0.height(4, 4), -1.0);
}

use super::closest::distance2;
use super::*;
use fastrand::Rng;
use std::sync::Arc;

const GO: Tick = &|_| true;

fn rough(random: &mut Rng, columns: usize, rows: usize, pitch: f64, steep: f64) -> HeightField {
    let heights = (0..columns * rows).map(|_| (random.f64() * steep) as f32).collect();
    HeightField::new(columns, rows, pitch, heights).unwrap()
}

fn triangles(field: &HeightField, corner: DVec2) -> Vec<[DVec3; 3]> {
    let point = |i, j| field.point(i, j) + corner.extend(0.0);
    let cells = (0..field.rows() - 1).flat_map(|j| (0..field.columns() - 1).map(move |i| (i, j)));
    cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            [[a, b, c], [a, c, d]].map(|corners| corners.map(|(i, j)| point(i, j)))
        })
        .collect()
}

fn mesh(triangles: &[[DVec3; 3]]) -> Mesh {
    Mesh {
        vertices: Arc::new(triangles.iter().flatten().copied().collect()),
        triangles: (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    }
}

/// The closest of many points of a triangle.
#[test]
fn the_closest_point_of_a_triangle_is_the_closest_of_many() {
    let mut random = Rng::with_seed(4);
    let mut any = || DVec3::new(random.f64(), random.f64(), random.f64());
    for round in 0..400 {
        let (p, [a, mut b, mut c]) = (any() * 2.0 - 0.5, [any(), any(), any()]);
        if round % 10 == 0 {
            c = a.lerp(b, 0.7);
        }
        if round % 40 == 0 {
            (b, c) = (a, a);
        }
        let found = distance2(p, [a, b, c]).sqrt();
        let mut least = f64::INFINITY;
        for k in 0..=150 {
            for l in 0..=150 - k {
                let (u, v) = (f64::from(k) / 150.0, f64::from(l) / 150.0);
                least = least.min(p.distance(a + (b - a) * u + (c - a) * v));
            }
        }
        assert!(found <= least + 1e-12 && found > least - 0.02, "{found} {least} {a} {b} {c} {p}");
    }
}

#[test]
fn distances_from_a_field_are_those_of_trying_every_triangle() {
    let mut random = Rng::with_seed(5);
    for round in 0..30 {
        let steep = [0.1, 1.0, 8.0][round % 3];
        let target = rough(&mut random, 11, 8, 0.7, steep);
        let origin = DVec2::new(random.f64() * 3.0, -2.0);
        let machined = rough(&mut random, 30, 25, 0.23, steep * 1.5);
        let corner = origin + DVec2::new(0.05, 0.02);
        let found = deviation(&machined, corner, Target::Field(&target, origin), 0.0, GO).unwrap();
        check(&found, &machined, &triangles(&target, origin), 1.0);
        assert_eq!(found.extent.nodes, 30 * 22);
    }
}

#[test]
fn distances_from_a_mesh_are_those_of_trying_every_triangle_that_faces_up() {
    let mut random = Rng::with_seed(6);
    for round in 0..20 {
        let steep = [0.1, 1.0, 8.0][round % 3];
        let target = rough(&mut random, 11, 8, 0.7, steep);
        let top = triangles(&target, DVec2::ZERO);
        // A thin plate: its underside is often nearer than its top.
        let under = top.iter().map(|[a, b, c]| [*a, *c, *b].map(|v| v - DVec3::Z * 0.3));
        let mut all: Vec<[DVec3; 3]> = top.iter().copied().chain(under).collect();
        if round % 2 == 1 {
            all.iter_mut().for_each(|corners| corners.swap(0, 1));
        }
        let machined = rough(&mut random, 30, 21, 0.23, steep * 1.5);
        let found = deviation(&machined, DVec2::ZERO, Target::Mesh(&mesh(&all)), 0.0, GO).unwrap();
        let bottom = target.bounds().min.z - 0.3;
        let walls: Vec<[DVec3; 3]> = top.iter().copied().chain(rim(&target, bottom)).collect();
        check(&found, &machined, &walls, 0.0);
    }
}

/// The four walls around a field, down to a height.
fn rim(field: &HeightField, bottom: f64) -> Vec<[DVec3; 3]> {
    let (right, far) = (field.columns() - 1, field.rows() - 1);
    let along_x = (0..right).flat_map(|i| [[(i, 0), (i + 1, 0)], [(i, far), (i + 1, far)]]);
    let along_y = (0..far).flat_map(|j| [[(0, j), (0, j + 1)], [(right, j), (right, j + 1)]]);
    let wall = |ends: [(usize, usize); 2]| {
        let [a, b] = ends.map(|(i, j)| field.point(i, j));
        [[a, b, b.with_z(bottom)], [a, b.with_z(bottom), a.with_z(bottom)]]
    };
    along_x.chain(along_y).flat_map(wall).collect()
}

/// A cutter that grazes the rim of an open sheet is as deep in it as it is behind the rim.
#[test]
fn a_sheet_goes_straight_down_where_it_ends() {
    let sheet = HeightField::new(11, 11, 1.0, vec![20.0; 121]).unwrap();
    let target = mesh(&triangles(&sheet, DVec2::splat(0.01)));
    let heights = (0..121).map(|k| if k % 11 == 10 { 0.0 } else { 20.0 }).collect();
    let machined = HeightField::new(11, 11, 1.0, heights).unwrap();
    let found = deviation(&machined, DVec2::ZERO, Target::Mesh(&target), 0.0, GO).unwrap();
    assert!((found.extent.max_gouge_mm - 0.01).abs() < 1e-6, "{:?}", found.extent);
}

/// Holds distances against every triangle; those less than `first_order` × [`FIRST_ORDER_MM`] straight up may
/// be off by as much.
fn check(found: &Deviation, machined: &HeightField, top: &[[DVec3; 3]], first_order: f64) {
    for (k, &is) in found.distances_mm.iter().enumerate().filter(|(_, v)| !v.is_nan()) {
        let node = machined.point(k % machined.columns(), k / machined.columns());
        let node = node + found.corner.extend(0.0);
        let least = top.iter().map(|t| distance2(node, *t)).fold(f64::INFINITY, f64::min).sqrt();
        let slack = 1e-5 + first_order * FIRST_ORDER_MM;
        assert!((f64::from(is.abs()) - least).abs() < slack, "{node}: {is}, not {least}");
    }
}

#[test]
fn beside_a_wall_the_distance_counts_not_the_height() {
    // Steps up by 20 mm within 0.01 mm.
    let corners = |x0: f64, z0: f64, x1: f64, z1: f64| {
        let [a, b] = [DVec3::new(x0, 0.0, z0), DVec3::new(x1, 0.0, z1)];
        let [c, d] = [b.with_y(10.0), a.with_y(10.0)];
        [[a, b, c], [a, c, d]]
    };
    let wall = [
        corners(0.0, 0.0, 5.0, 0.0),
        corners(5.0, 0.0, 5.01, 20.0),
        corners(5.01, 20.0, 10.0, 20.0),
    ];
    let target = mesh(&wall.concat());
    // The machined wall stands a node farther in, and all else is as it should be.
    let heights = (0..501 * 11).map(|k| if k % 501 > 251 { 20.0 } else { 0.0 }).collect();
    let machined = HeightField::new(501, 11, 0.02, heights).unwrap();
    let found = deviation(&machined, DVec2::ZERO, Target::Mesh(&target), 0.0, GO).unwrap();
    assert!((found.extent.max_gouge_mm - 0.02).abs() < 1e-4, "{:?}", found.extent);
    assert!((found.extent.gouge_at.x - 5.02).abs() < 1e-9, "{:?}", found.extent);
    assert!(found.extent.max_excess_mm < 1e-4);
}

#[test]
fn what_lies_beyond_the_target_or_in_its_border_does_not_count() {
    let target = HeightField::new(5, 5, 1.0, vec![1.0; 25]).unwrap();
    let machined = HeightField::new(9, 9, 1.0, vec![1.5; 81]).unwrap();
    let at = |border: f64| {
        let target = Target::Field(&target, DVec2::splat(2.0));
        deviation(&machined, DVec2::ZERO, target, border, GO).unwrap()
    };
    assert_eq!(at(0.0).extent.nodes, 25);
    assert_eq!(at(1.0).extent.nodes, 9);
    let none = at(2.5).extent;
    assert_eq!((none.nodes, none.max_excess_mm), (0, 0.0));
    // A mesh with a hole.
    let corners = triangles(&target, DVec2::splat(2.0));
    let holed = mesh(&corners[..16]);
    let found = deviation(&machined, DVec2::ZERO, Target::Mesh(&holed), 0.0, GO).unwrap();
    assert_eq!(found.extent.nodes, 15);
}

#[test]
fn the_extent_is_that_of_all_distances() {
    let target = HeightField::new(11, 11, 1.0, vec![0.0; 121]).unwrap();
    let heights: Vec<f32> = (0..121).map(|k| (k as f32 - 10.0) * 0.01).collect();
    let machined = HeightField::new(11, 11, 1.0, heights).unwrap();
    let target = Target::Field(&target, DVec2::ZERO);
    let extent = deviation(&machined, DVec2::ZERO, target, 0.0, GO).unwrap().extent;
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    assert!(near(extent.max_gouge_mm, 0.1) && near(extent.max_excess_mm, 1.1), "{extent:?}");
    assert_eq!(extent.gouge_at.truncate(), DVec2::ZERO);
    assert_eq!(extent.excess_at.truncate(), DVec2::splat(10.0));
    // 120 of 121 are 99 %.
    assert!(near(extent.p99_excess_mm, 1.09) && near(extent.mean_mm, 0.5), "{extent:?}");
}

#[test]
fn bad_targets_are_refused_and_it_stops_when_told() {
    let machined = HeightField::new(5, 5, 1.0, vec![1.0; 25]).unwrap();
    let try_mesh = |mesh: &Mesh| deviation(&machined, DVec2::ZERO, Target::Mesh(mesh), 0.0, GO);
    assert_eq!(try_mesh(&mesh(&[])), Err(DeviationError::NoTop));
    let missing = Mesh { vertices: Arc::new(vec![DVec3::ZERO; 3]), triangles: vec![[0, 1, 3]] };
    assert_eq!(try_mesh(&missing), Err(DeviationError::BadTriangle { triangle: 0 }));
    let target = Target::Field(&machined, DVec2::ZERO);
    let stopped = deviation(&machined, DVec2::ZERO, target, 0.0, &|_| false);
    assert_eq!(stopped, Err(DeviationError::Stopped));
}

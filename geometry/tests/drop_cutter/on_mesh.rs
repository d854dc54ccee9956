//! Meshes and points against the slow truth and closed forms.

use super::fields::{cutters, field};
use super::meshes::{SOUPS, binary_stl, igea, mesh, places, sheet, soup};
use super::oracle;
use super::{FLOOR, GO, one_pass};
use carvegraph_geometry::{
    Against, Bounds, ContactKind, DVec2, DVec3, DropCutter, DropError, Mesh, PointCloud, Profile,
    Raster, RasterStyle, Surface, Toolpath, drop_on_mesh, drop_on_points,
};
use fastrand::Rng;
use std::sync::Arc;

fn drop_at(mesh: &Mesh, profile: &Profile, places: &[DVec2]) -> Toolpath {
    drop_on_mesh(mesh, profile, &one_pass(places.to_vec()), FLOOR, GO).unwrap()
}

fn tolerance(cutter: &str) -> f64 {
    if matches!(cutter, "ball" | "flat") { 1e-9 } else { 1e-6 }
}

fn or_floor(tip: f64) -> f64 {
    if tip == f64::NEG_INFINITY { FLOOR } else { tip }
}

/// Whether a height is that of the truth, or at least between those around the place: on walls that
/// lean by less than a rounding error, and at the rim of a flat cutter, no more can be asked.
fn is_exact_around(mesh: &Mesh, profile: &Profile, at: DVec2, tip: f64, tolerance: f64) -> bool {
    let near = 1e-11 * (1.0 + profile.radius_mm()) + 4e-16 * at.length();
    let ways = (0..8).map(|k| DVec2::from_angle(f64::from(k) * std::f64::consts::FRAC_PI_4));
    let around = ways.map(|way| or_floor(oracle::drop_on_mesh(mesh, profile, at + way * near)));
    let (low, high) = around.fold((f64::MAX, f64::MIN), |(l, h), z| (l.min(z), h.max(z)));
    tip >= low - tolerance && tip <= high + tolerance
}

/// The contact lies on the cutter, and on a triangle (within what its slope makes of rounding).
fn check_contact(mesh: &Mesh, profile: &Profile, tip: DVec3, point: DVec3, kind: ContactKind) {
    if kind == ContactKind::None {
        assert_eq!(tip.z, FLOOR);
        return;
    }
    assert!(point.is_finite());
    let r = point.truncate().distance(tip.truncate());
    let reach = profile.radius_mm();
    assert!(r <= reach * (1.0 + 1e-9), "{r} is beyond {reach}");
    // At the rim the profile is upright: half the digits are lost from r to h.
    let slack = 1e-6 * (1.0 + reach);
    let h = |r: f64| profile.height(r.clamp(0.0, reach));
    let above = point.z - tip.z;
    assert!(above > h(r - slack) - slack && above < h(r + slack) + slack, "{above} at {r}");
    if kind == ContactKind::Vertex {
        assert!(mesh.vertices.contains(&point));
    }
}

fn compare(mesh: &Mesh, name: &str, (cutter, profile): (&str, &Profile), places: &[DVec2]) {
    let path = drop_at(mesh, profile, places);
    for (k, (tip, &at)) in path.tips.iter().zip(places).enumerate() {
        let expected = or_floor(oracle::drop_on_mesh(mesh, profile, at));
        let tolerance = tolerance(cutter) + 4e-16 * expected.abs();
        let (exact, off) = ((tip.z - expected).abs() <= tolerance, tip.z - expected);
        assert!(
            exact || is_exact_around(mesh, profile, at, tip.z, tolerance),
            "{name}, {cutter} R {}, {at}: {}, not {expected} ({off:e}), {:?}",
            profile.radius_mm(),
            tip.z,
            path.contacts[k]
        );
        check_contact(mesh, profile, *tip, path.contacts[k].point, path.contacts[k].kind);
    }
}

#[test]
fn every_cutter_equals_the_oracle_on_soups() {
    let mut random = Rng::with_seed(11);
    for kind in SOUPS {
        for count in [1, 2, 5, 17, 90] {
            for radius in [0.3, 3.0] {
                let soup = soup(&mut random, kind, count, DVec3::ZERO);
                let places = places(&mut random, &soup, 25);
                for (cutter, profile) in cutters(radius) {
                    compare(&soup, kind, (cutter, &profile), &places);
                }
            }
        }
    }
}

#[test]
fn balls_and_flats_equal_the_oracle_on_many_soups() {
    let mut random = Rng::with_seed(12);
    for round in 0..240 {
        let kind = SOUPS[round % SOUPS.len()];
        let middle = [DVec3::ZERO, DVec3::new(3e5, -7e5, 1e4)][random.usize(..2)];
        let count = [3, 30, 400, 1500][random.usize(..4)];
        let soup = soup(&mut random, kind, count, middle);
        let radius = [0.05, 0.5, 3.0, 30.0][random.usize(..4)];
        let places = places(&mut random, &soup, 20);
        for (cutter, profile) in cutters(radius).into_iter().take(2) {
            compare(&soup, kind, (cutter, &profile), &places);
        }
    }
}

#[test]
fn huge_triangles_among_tiny_ones_are_found() {
    let mut random = Rng::with_seed(13);
    let tiny = soup(&mut random, "small", 500, DVec3::ZERO);
    let corners = (0..500).map(|t| tiny.corners(t));
    let big = DVec3::new(-4e3, -3e3, 1.0);
    let huge = [big, DVec3::new(5e3, -2e3, 3.0), DVec3::new(1e3, 6e3, 2.0)];
    let mesh = mesh(corners.chain([huge]));
    let mut places = places(&mut random, &tiny, 40);
    places.extend([DVec2::new(800.0, 500.0), DVec2::new(-4e3, -3e3), DVec2::new(1e9, 0.0)]);
    for (cutter, profile) in cutters(2.0) {
        compare(&mesh, "huge and tiny", (cutter, &profile), &places);
    }
}

#[test]
fn real_meshes_equal_the_oracle() {
    let folder = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data"));
    let folder = std::env::var_os("CARVE_DATA").map_or(folder.to_owned(), Into::into);
    let mut random = Rng::with_seed(14);
    for name in ["mount_rush.stl", "spider.stl", "igea.ply"] {
        let Ok(bytes) = std::fs::read(folder.join(name)) else {
            eprintln!("SKIPPED: {name} is not in {}", folder.display());
            continue;
        };
        let mesh = if name == "igea.ply" { igea(&bytes) } else { binary_stl(&bytes) };
        let places = places(&mut random, &mesh, 60);
        for (cutter, profile) in cutters(3.0).into_iter().chain(cutters(0.4)) {
            compare(&mesh, name, (cutter, &profile), &places);
        }
    }
}

#[test]
fn a_field_has_the_heights_of_its_mesh() {
    // Two indexes and two ways to leave out what cannot be touched: what one loses, the other shows.
    let mut random = Rng::with_seed(17);
    for (pitch, height) in [(0.3, 0.4), (0.3, 3.0), (1.1, 2.0)] {
        let side = 70;
        let noise: Vec<f64> = (0..side * side).map(|_| random.f64()).collect();
        let rough = field(side, side, pitch, |i, j| {
            let (x, y) = (i as f64 * 0.2, j as f64 * 0.17);
            height * (x.sin() * y.cos() + 0.2 * noise[j * side + i] + f64::from(u8::from(x > 6.0)))
        });
        let mesh = sheet(side as u32, side as u32, pitch, |x, y| {
            rough.height((x / pitch).round() as usize, (y / pitch).round() as usize)
        });
        let raster = Raster {
            stepover_mm: rough.bounds().size().x / 60.0,
            feed_step_mm: 0.07,
            direction_rad: 0.1,
            style: RasterStyle::Zigzag,
        };
        let pattern = raster.pattern(&rough.bounds());
        for (cutter, profile) in cutters(2.0) {
            let path = |surface| {
                DropCutter::new(surface, &profile, 0.0, GO).unwrap().path(&pattern, FLOOR, GO)
            };
            let on_field = path(Surface::Field(&rough, Against::Mesh)).unwrap();
            let on_mesh = path(Surface::Mesh(&mesh)).unwrap();
            for (a, b) in on_field.tips.iter().zip(&on_mesh.tips) {
                assert!(
                    (a.z - b.z).abs() < 1e-10,
                    "{cutter} pitch {pitch} height {height}: {a} {b}"
                );
            }
        }
    }
}

#[test]
fn points_equal_the_oracle() {
    let mut random = Rng::with_seed(15);
    for count in [1, 2, 3, 4, 5, 16, 17, 64, 65, 3000] {
        let cloud = soup(&mut random, "mixed sizes", count, DVec3::new(5.0, -1e4, 3.0));
        let points = PointCloud { points: Arc::clone(&cloud.vertices), grid: None };
        let places = places(&mut random, &cloud, 40);
        for (cutter, profile) in cutters([0.1, 3.0, 40.0][count % 3]) {
            let pattern = one_pass(places.clone());
            let path = drop_on_points(&points, &profile, &pattern, FLOOR, GO).unwrap();
            for ((tip, contact), &at) in path.tips.iter().zip(&path.contacts).zip(&places) {
                let all = points.points.iter().copied();
                let expected = or_floor(oracle::drop_on_points(all, &profile, at));
                assert!((tip.z - expected).abs() <= tolerance(cutter), "{count} {cutter}");
                check_contact(&cloud, &profile, *tip, contact.point, contact.kind);
            }
        }
    }
}

#[test]
fn a_ball_on_a_ramp_stands_off_along_the_normal() {
    let (a, b, radius) = (0.5, -0.25, 3.0);
    let ramp = sheet(60, 60, 0.5, |x, y| a * x + b * y);
    let at = DVec2::new(14.3, 15.1);
    let path = drop_at(&ramp, &Profile::ball(radius).unwrap(), &[at]);
    let lift = radius * ((1.0 + a * a + b * b).sqrt() - 1.0);
    assert!((path.tips[0].z - (a * at.x + b * at.y + lift)).abs() < 1e-12);
    let normal = DVec3::new(-a, -b, 1.0).normalize();
    let center = path.tips[0] + DVec3::Z * radius;
    assert!((center - normal * radius).distance(path.contacts[0].point) < 1e-12);
    assert_eq!(path.contacts[0].kind, ContactKind::Facet);
}

#[test]
fn every_cutter_rests_on_a_level_plane_whichever_way_it_faces() {
    let up = sheet(3, 3, 9.0, |_, _| 2.5);
    let flipped = up.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let down = Mesh { triangles: flipped, ..up.clone() };
    for (name, profile) in cutters(3.0) {
        for mesh in [&up, &down] {
            let path = drop_at(mesh, &profile, &[DVec2::new(9.9, 11.1)]);
            assert_eq!(path.tips[0].z, 2.5, "{name}");
        }
    }
}

#[test]
fn a_spike_shows_the_cutter_upside_down() {
    let foot = |k: u32| DVec2::from_angle(f64::from(k)).extend(0.0) * 0.01;
    let spike = mesh((0..6).map(|k| [foot(k), foot(k + 1), DVec3::Z * 50.0]));
    for (name, profile) in cutters(3.0) {
        for k in 0..29 {
            // Not at a shoulder, where rounding decides.
            let r = f64::from(k) * 0.1 + 0.017;
            let path = drop_at(&spike, &profile, &[DVec2::new(0.0, r)]);
            assert!((path.tips[0].z - (50.0 - profile.height(r))).abs() < 1e-9, "{name}");
            assert_eq!(path.contacts[0].kind, ContactKind::Vertex);
        }
    }
}

#[test]
fn a_ball_bridges_a_saw_tooth() {
    let saw = sheet(81, 41, 0.5, |x, _| if x % 2.0 == 0.0 { 3.0 } else { 0.0 });
    let at = DVec2::new(17.0, 10.3);
    let ball = drop_at(&saw, &Profile::ball(3.0).unwrap(), &[at]);
    assert!((ball.tips[0].z - 8.0_f64.sqrt()).abs() < 1e-12);
    assert!(matches!(ball.contacts[0].kind, ContactKind::Edge | ContactKind::Vertex));
    let flat = drop_at(&saw, &Profile::flat(3.0).unwrap(), &[at]);
    assert_eq!(flat.tips[0].z, 3.0);
}

#[test]
fn a_ball_on_a_ball_stands_off_by_the_sum_of_radii() {
    // A whole sphere: its lower half is an overhang from above and must not count.
    let (big, radius, turns) = (20.0_f64, 3.0, 600_u32);
    let point = |i: u32, j: u32| {
        let lift = std::f64::consts::PI * (f64::from(j) / f64::from(turns) - 0.5);
        let turn = std::f64::consts::TAU * f64::from(i % turns) / f64::from(turns);
        (DVec2::from_angle(turn) * lift.cos()).extend(lift.sin()) * big
    };
    let sphere =
        mesh((0..turns).flat_map(|j| (0..turns).map(move |i| (i, j))).flat_map(|(i, j)| {
            let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| point(i + x, j + y));
            [[a, b, c], [a, c, d]]
        }));
    let ball = Profile::ball(radius).unwrap();
    for at in [DVec2::ZERO, DVec2::new(2.3, -8.1), DVec2::new(17.0, 10.0), DVec2::new(0.0, 22.5)] {
        let center = ((big + radius).powi(2) - at.length_squared()).sqrt();
        let path = drop_at(&sphere, &ball, &[at]);
        // Its facets lie inside by up to 2·(R·π/turns)²/2R; on the flank that shows many times over.
        let inside = big * (std::f64::consts::PI / f64::from(turns)).powi(2);
        let shows = (big + radius) / center;
        let tip = path.tips[0].z + radius;
        assert!(tip <= center + 1e-9 && tip >= center - inside * shows, "{at} {tip} {center}");
        assert!(path.contacts[0].point.z >= 0.0);
    }
}

#[test]
fn a_wall_stops_a_cutter_beside_it() {
    // Upright, without a facet in plan, from z = 0 to 10.
    let (a, b, up) = (DVec3::ZERO, DVec3::new(0.0, 10.0, 0.0), DVec3::Z * 10.0);
    let wall = mesh([[a, b, b + up], [a, b + up, a + up]]);
    for (name, profile) in cutters(3.0) {
        for away in [0.0, 0.7, 2.9] {
            let path = drop_at(&wall, &profile, &[DVec2::new(away, 5.0)]);
            assert!((path.tips[0].z - (10.0 - profile.height(away))).abs() < 1e-9, "{name}");
        }
        let path = drop_at(&wall, &profile, &[DVec2::new(3.1, 5.0)]);
        assert_eq!((path.tips[0].z, path.contacts[0].kind), (FLOOR, ContactKind::None));
    }
}

#[test]
fn of_overhangs_the_highest_is_touched() {
    let floors = [1.0, 7.0, 4.0];
    let floors = mesh(floors.iter().flat_map(|&z| {
        let sheet = sheet(4, 4, 5.0, |_, _| z);
        (0..sheet.triangles.len()).map(|t| sheet.corners(t)).collect::<Vec<_>>()
    }));
    for (_, profile) in cutters(2.0) {
        assert_eq!(drop_at(&floors, &profile, &[DVec2::splat(7.7)]).tips[0].z, 7.0);
    }
}

#[test]
fn nothing_under_the_cutter_gives_the_floor() {
    let plate = sheet(5, 5, 1.0, |_, _| 1.0);
    let nothing = Mesh { vertices: Arc::new(vec![]), triangles: vec![] };
    let places = [DVec2::new(-3.1, 2.0), DVec2::splat(8.0), DVec2::new(1e300, -1e300)];
    for (_, profile) in cutters(3.0) {
        for path in [drop_at(&plate, &profile, &places), drop_at(&nothing, &profile, &places)] {
            assert!(path.tips.iter().all(|tip| tip.z == FLOOR));
            assert!(path.contacts.iter().all(|contact| contact.kind == ContactKind::None));
        }
    }
}

#[test]
fn bad_meshes_are_refused() {
    let ball = Profile::ball(1.0).unwrap();
    let drop = |mesh: &Mesh| drop_on_mesh(mesh, &ball, &one_pass(vec![]), FLOOR, GO);
    let mut plate = sheet(3, 3, 1.0, |_, _| 1.0);
    plate.triangles[2][1] = 9;
    let error = drop(&plate).unwrap_err();
    assert_eq!(error, DropError::NoSuchVertex { triangle: 2, vertex: 9, vertices: 9 });
    assert_eq!(error.to_string(), "triangle 2 has vertex 9, but there are only 9");
    let pit = sheet(3, 3, 1.0, |x, _| if x > 1.0 { f64::INFINITY } else { 0.0 });
    let error = drop(&pit).unwrap_err();
    assert_eq!(error.to_string(), "point 2 is at [2, 0, inf]: every coordinate must be finite");
}

#[test]
fn threads_do_not_change_the_path() {
    let mut random = Rng::with_seed(16);
    let soup = soup(&mut random, "mixed sizes", 9000, DVec3::ZERO);
    let bounds = Bounds { min: DVec3::ZERO, max: DVec3::splat(10.0) };
    let raster = Raster {
        stepover_mm: 0.2,
        feed_step_mm: 0.2,
        direction_rad: 0.4,
        style: RasterStyle::Zigzag,
    };
    let pattern = raster.pattern(&bounds);
    for (_, profile) in cutters(2.0) {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| drop_on_mesh(&soup, &profile, &pattern, FLOOR, GO).unwrap())
        };
        assert_eq!(with(1), with(3));
    }
}

#[test]
fn the_tick_stops_the_index_and_the_work() {
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
    let plate = sheet(120, 120, 0.1, |x, y| (x * y).sin());
    let pattern = one_pass((0..5000).map(|k| DVec2::new(f64::from(k % 70) * 0.1, 3.0)).collect());
    let ball = Profile::ball(3.0).unwrap();
    let drop = |tick: &(dyn Fn(usize) -> bool + Sync)| {
        drop_on_mesh(&plate, &ball, &pattern, FLOOR, tick).map(|_| ())
    };
    let done = AtomicUsize::new(0);
    let count = |n| {
        done.fetch_add(n, Relaxed);
        true
    };
    assert_eq!((drop(&count), done.into_inner()), (Ok(()), 5000));
    assert_eq!(drop(&|_| false), Err(DropError::Stopped));
    let calls = AtomicUsize::new(0);
    let stop = |n| n == 0 || calls.fetch_add(1, Relaxed) < 3;
    assert_eq!(drop(&stop), Err(DropError::Stopped));
    assert!(calls.into_inner() < 10);
}

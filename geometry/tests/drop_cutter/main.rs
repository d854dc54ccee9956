//! The drop cutter against the slow truth, closed forms and its own promises.

#![allow(unreachable_pub, clippy::unwrap_used)]

mod between;
mod fields;
mod meshes;
mod on_mesh;
#[path = "../../src/oracle.rs"]
mod oracle;

use carvegraph_geometry::{
    Against, Bounds, ContactKind, DVec2, DVec3, HeightField, Mesh, Pattern, PatternSpan, Profile,
    Raster, RasterStyle, SpanKind, Tick, Toolpath, drop_on_height_field,
};
use fastrand::Rng;
use fields::{any_field, cutters, field};

const GO: Tick = &|_| true;
const FLOOR: f64 = -77.0;

fn one_pass(points: Vec<DVec2>) -> Pattern {
    let spans = vec![PatternSpan { points: 0..points.len(), link: false, joined: false }];
    Pattern { points, spans }
}

fn drop_at(field: &HeightField, against: Against, profile: &Profile, places: &[DVec2]) -> Toolpath {
    let pattern = one_pass(places.to_vec());
    drop_on_height_field(field, against, profile, &pattern, FLOOR, GO).unwrap()
}

/// Rounding grows with the heights a steep plane reaches over the cutter's radius.
fn tolerance(name: &str, field: &HeightField, radius: f64) -> f64 {
    let exact = if matches!(name, "ball" | "flat") { 1e-9 } else { 1e-6 };
    let range = field.bounds().size().z;
    exact + 1e-14 * range * (1.0 + radius / field.pitch_mm())
}

/// Places in, at the border of and around a field, some on nodes and along lines.
fn places(random: &mut Rng, field: &HeightField, radius: f64) -> Vec<DVec2> {
    let size = field.bounds().size().truncate();
    let mut places: Vec<DVec2> = (0..12)
        .map(|_| {
            let share = DVec2::new(random.f64(), random.f64()) * 1.2 - 0.1;
            share * size + radius * (DVec2::new(random.f64(), random.f64()) - 0.5)
        })
        .collect();
    let (i, j) = (random.usize(..field.columns()), random.usize(..field.rows()));
    let node = field.point(i, j).truncate();
    places.push(node);
    places.push(node + DVec2::new(radius * 0.99, 0.0));
    places.extend((0..12).map(|k| node + DVec2::new(0.1137, 0.0293) * f64::from(k)));
    places
}

/// The contact is a point of the surface, and the cutter at the tip passes through it.
fn check_contact(
    field: &HeightField,
    against: Against,
    profile: &Profile,
    path: &Toolpath,
    k: usize,
    tolerance: f64,
) {
    let (tip, contact) = (path.tips[k], path.contacts[k]);
    if contact.kind == ContactKind::None {
        assert_eq!(tip.z, FLOOR);
        return;
    }
    let point = contact.point;
    let r = point.truncate().distance(tip.truncate());
    // At the rim the profile is upright: half the digits are lost from r to h.
    let r = r.min(profile.radius_mm());
    let slack = 1e-7 + 100.0 * tolerance;
    let nearby =
        [r - slack, r, r + slack].map(|r| profile.height(r.clamp(0.0, profile.radius_mm())));
    let h = point.z - tip.z;
    assert!(h > nearby[0] - slack && h < nearby[2] + slack, "h {h} at r {r}: {nearby:?}");
    let place = point.truncate() / field.pitch_mm();
    let cell = place
        .floor()
        .clamp(DVec2::ZERO, DVec2::new(field.columns() as f64, field.rows() as f64) - 2.0);
    let (i, j, t) = (cell.x as usize, cell.y as usize, place - cell);
    assert!(t.min_element() > -1e-9 && t.max_element() < 1.0 + 1e-9, "beyond the border: {place}");
    let z = |di, dj| field.height(i + di, j + dj);
    let surface = if t.x >= t.y {
        z(0, 0) + t.x * (z(1, 0) - z(0, 0)) + t.y * (z(1, 1) - z(1, 0))
    } else {
        z(0, 0) + t.y * (z(0, 1) - z(0, 0)) + t.x * (z(1, 1) - z(0, 1))
    };
    let steep = field.bounds().size().z / field.pitch_mm();
    assert!((surface - point.z).abs() < 1e-9 * (1.0 + steep), "{surface} {point}");
    if against == Against::Points {
        assert_eq!(contact.kind, ContactKind::Vertex);
    }
    if contact.kind == ContactKind::Vertex {
        assert!((place - place.round()).length() < 1e-9);
    }
}

fn compare(seed: u64, cases: usize) {
    let mut random = Rng::with_seed(seed);
    for _ in 0..cases {
        let (name, field) = any_field(&mut random);
        let radius =
            [0.5, 3.0, 10.0][random.usize(..3)] * [1.0, field.pitch_mm()][random.usize(..2)];
        let places = places(&mut random, &field, radius);
        for (cutter, profile) in cutters(radius) {
            let tolerance = tolerance(cutter, &field, radius);
            for against in [Against::Points, Against::Mesh] {
                let path = drop_at(&field, against, &profile, &places);
                for (k, &at) in places.iter().enumerate() {
                    let expected = oracle::drop(&field, against, &profile, at);
                    let expected = if expected == f64::NEG_INFINITY { FLOOR } else { expected };
                    let found = path.tips[k].z;
                    assert!(
                        (found - expected).abs() <= tolerance,
                        "{name}, {cutter} R {radius}, {against:?}, {at}: {found}, not {expected} \
                         ({:e})",
                        found - expected
                    );
                    assert_eq!(path.tips[k].truncate(), at);
                    check_contact(&field, against, &profile, &path, k, tolerance);
                }
            }
        }
    }
}

#[test]
fn every_cutter_equals_the_oracle_1() {
    compare(1, 20);
}

#[test]
fn every_cutter_equals_the_oracle_2() {
    compare(2, 20);
}

#[test]
fn the_ball_equals_the_oracle_on_many_fields() {
    let mut random = Rng::with_seed(3);
    for _ in 0..600 {
        let (name, field) = any_field(&mut random);
        let radius = field.pitch_mm() * [0.3, 1.0, 2.9, 4.0, 7.1, 15.0, 40.0][random.usize(..7)];
        let ball = Profile::ball(radius).unwrap();
        let places = places(&mut random, &field, radius);
        let tolerance = tolerance("ball", &field, radius);
        for against in [Against::Points, Against::Mesh] {
            let path = drop_at(&field, against, &ball, &places);
            for (k, &at) in places.iter().enumerate() {
                let expected = oracle::drop(&field, against, &ball, at);
                let expected = if expected == f64::NEG_INFINITY { FLOOR } else { expected };
                let found = path.tips[k].z;
                assert!(
                    (found - expected).abs() <= tolerance,
                    "{name} R {radius} {at}: {found} {expected}"
                );
                check_contact(&field, against, &ball, &path, k, tolerance);
            }
        }
    }
}

#[test]
fn the_ball_equals_the_oracle_on_a_large_relief() {
    let mut random = Rng::with_seed(4);
    let bumps: Vec<_> = (0..60).map(|_| (random.f64(), random.f64(), random.f64())).collect();
    let relief = field(150, 130, 0.4, |i, j| {
        let (x, y) = (i as f64 / 150.0, j as f64 / 130.0);
        bumps
            .iter()
            .map(|b| b.2 * (-900.0 * ((x - b.0).powi(2) + (y - b.1).powi(2))).exp())
            .sum::<f64>()
            * 2.0
    });
    let ball = Profile::ball(3.0).unwrap();
    let places: Vec<_> =
        (0..150).map(|k| DVec2::new(0.3 * f64::from(k), 17.0 + 0.1 * f64::from(k))).collect();
    for against in [Against::Points, Against::Mesh] {
        let path = drop_at(&relief, against, &ball, &places);
        for (tip, &at) in path.tips.iter().zip(&places) {
            assert!((tip.z - oracle::drop(&relief, against, &ball, at)).abs() < 1e-9);
        }
    }
}

#[test]
fn a_ball_on_a_ramp_stands_off_along_the_normal() {
    let (a, b, radius, pitch) = (0.5, -0.25, 3.0, 0.5);
    let ramp = field(60, 60, pitch, |i, j| pitch * (a * i as f64 + b * j as f64));
    let at = DVec2::new(14.3, 15.1);
    let path = drop_at(&ramp, Against::Mesh, &Profile::ball(radius).unwrap(), &[at]);
    let lift = radius * ((1.0 + a * a + b * b).sqrt() - 1.0);
    assert!((path.tips[0].z - (a * at.x + b * at.y + lift)).abs() < 1e-12);
    let normal = DVec3::new(-a, -b, 1.0).normalize();
    let center = path.tips[0] + DVec3::Z * radius;
    assert!((center - normal * radius).distance(path.contacts[0].point) < 1e-12);
}

#[test]
fn every_cutter_rests_on_a_level_plane() {
    let plane = field(40, 30, 0.7, |_, _| 2.5);
    for (name, profile) in cutters(3.0) {
        let path = drop_at(&plane, Against::Mesh, &profile, &[DVec2::new(9.9, 11.1)]);
        assert_eq!(path.tips[0].z, 2.5, "{name}");
    }
}

#[test]
fn a_spike_shows_the_cutter_upside_down() {
    let spike = field(81, 81, 0.25, |i, j| if (i, j) == (40, 40) { 50.0 } else { 0.0 });
    for (name, profile) in cutters(3.0) {
        for k in 0..30 {
            // Not at a shoulder, where rounding decides.
            let r = f64::from(k) * 0.1 + 0.017;
            let at = DVec2::new(10.0 + r, 10.0);
            let path = drop_at(&spike, Against::Points, &profile, &[at]);
            assert!((path.tips[0].z - (50.0 - profile.height(r))).abs() < 1e-9, "{name}");
            assert_eq!(path.contacts[0].point, DVec3::new(10.0, 10.0, 50.0));
        }
    }
}

#[test]
fn a_ball_bridges_a_saw_tooth() {
    // A tooth every four nodes: ridges a flat cutter rests on, and the ball's tip sinks between
    // ridges 2 mm apart by the sagitta of the chord.
    let saw = field(81, 41, 0.5, |i, _| if i % 4 == 0 { 3.0 } else { 0.0 });
    let at = DVec2::new(17.0, 10.3);
    let ball = drop_at(&saw, Against::Mesh, &Profile::ball(3.0).unwrap(), &[at]);
    assert!((ball.tips[0].z - (3.0 - (3.0 - 8.0_f64.sqrt()))).abs() < 1e-12);
    let flat = drop_at(&saw, Against::Mesh, &Profile::flat(3.0).unwrap(), &[at]);
    assert_eq!(flat.tips[0].z, 3.0);
}

#[test]
fn a_ball_on_a_sphere_stands_off_by_the_sum_of_radii() {
    let (dome, radius, pitch, middle) = (20.0_f64, 3.0, 0.05, DVec2::splat(10.0));
    let z = |x: f64, y: f64| (dome * dome - (x - 10.0).powi(2) - (y - 10.0).powi(2)).sqrt();
    let cap = field(401, 401, pitch, |i, j| z(i as f64 * pitch, j as f64 * pitch));
    let at = DVec2::new(12.3, 8.1);
    let path = drop_at(&cap, Against::Mesh, &Profile::ball(radius).unwrap(), &[at]);
    let center = ((dome + radius).powi(2) - at.distance_squared(middle)).sqrt();
    // Chords of the sphere lie inside it by p²/4R at most.
    let sagitta = pitch * pitch / (4.0 * dome);
    let tip = path.tips[0].z;
    assert!(
        tip <= center - radius + 1e-5 && tip >= center - radius - sagitta * 1.2,
        "{tip} {center}"
    );
}

#[test]
fn nothing_under_the_cutter_gives_the_floor() {
    let field = field(5, 5, 1.0, |_, _| 1.0);
    for (_, profile) in cutters(3.0) {
        for at in [
            DVec2::new(-3.1, 2.0),
            DVec2::new(8.0, 8.0),
            DVec2::new(1e12, 0.0),
            DVec2::new(2.0, -1e300),
        ] {
            let path = drop_at(&field, Against::Mesh, &profile, &[at]);
            assert_eq!((path.tips[0].z, path.contacts[0].kind), (FLOOR, ContactKind::None));
        }
    }
}

#[test]
fn a_contact_below_the_floor_is_a_contact() {
    let field = field(5, 5, 1.0, |_, _| -100.0);
    let path = drop_at(&field, Against::Mesh, &Profile::ball(1.0).unwrap(), &[DVec2::splat(2.0)]);
    assert_eq!(path.tips[0].z, -100.0);
}

#[test]
fn spans_are_those_of_the_pattern() {
    let field = field(20, 20, 0.5, |i, j| (i * j % 7) as f64 * 0.1);
    let raster = Raster {
        stepover_mm: 0.9,
        feed_step_mm: 0.4,
        direction_rad: 0.0,
        style: RasterStyle::Zigzag,
    };
    let bounds: Bounds = field.bounds();
    let pattern = raster.pattern(&bounds);
    let ball = Profile::ball(1.0).unwrap();
    let path = drop_on_height_field(&field, Against::Mesh, &ball, &pattern, FLOOR, GO).unwrap();
    assert_eq!(path.spans.len(), pattern.spans.len());
    for (span, expected) in path.spans.iter().zip(&pattern.spans) {
        assert_eq!((&span.points, span.joined), (&expected.points, expected.joined));
        assert_eq!(span.kind == SpanKind::Link, expected.link);
    }
    assert_eq!(path.cl_points() as f64, raster.count(&bounds));
    assert_eq!((path.contacts.len(), path.feeds), (path.tips.len(), None));
}

#[test]
fn threads_do_not_change_the_path() {
    let relief = field(120, 120, 0.3, |i, j| (i as f64 * 0.1).sin() + (j as f64 * 0.17).cos());
    let noisy = field(120, 120, 0.3, |i, j| ((i * 31 + j * 17) % 13) as f64 * 0.1);
    let raster = Raster {
        stepover_mm: 0.3,
        feed_step_mm: 0.3,
        direction_rad: 0.4,
        style: RasterStyle::Zigzag,
    };
    for field in [relief, noisy] {
        let pattern = raster.pattern(&field.bounds());
        for (_, profile) in cutters(2.0) {
            let with = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    drop_on_height_field(&field, Against::Mesh, &profile, &pattern, FLOOR, GO)
                })
            };
            assert_eq!(with(1), with(3));
        }
    }
}

#[test]
fn the_tick_counts_all_points_and_stops_the_work() {
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
    let field = field(50, 50, 0.5, |i, j| (i * j % 5) as f64);
    let pattern = one_pass((0..5000).map(|k| DVec2::new(f64::from(k % 70) * 0.3, 3.0)).collect());
    let ball = Profile::ball(3.0).unwrap();
    let (done, calls) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let count = |n| {
        done.fetch_add(n, Relaxed);
        true
    };
    drop_on_height_field(&field, Against::Mesh, &ball, &pattern, FLOOR, &count).unwrap();
    assert_eq!(done.into_inner(), 5000);
    let stop = |n| n == 0 || calls.fetch_add(1, Relaxed) < 3;
    assert!(drop_on_height_field(&field, Against::Mesh, &ball, &pattern, FLOOR, &stop).is_none());
    assert!(calls.into_inner() < 10);
}

#[test]
fn heights_far_from_zero_lose_nothing() {
    for lift in [1e6_f64, -3e5] {
        let raised = field(30, 30, 0.5, |i, j| lift + f64::from((i * 7 + j * 3) as u8 % 4));
        let ball = Profile::ball(3.0).unwrap();
        let places: Vec<_> = (0..40).map(|k| DVec2::new(f64::from(k) * 0.37, 6.2)).collect();
        let path = drop_at(&raised, Against::Mesh, &ball, &places);
        for (tip, &at) in path.tips.iter().zip(&places) {
            assert!((tip.z - oracle::drop(&raised, Against::Mesh, &ball, at)).abs() < 2e-9);
        }
    }
}

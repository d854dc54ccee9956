//! What a cutter cuts between its locations, and the locations put in against it.

use super::fields::cutters;
use super::meshes::{SOUPS, mesh, sheet, soup};
use super::{FLOOR, GO, one_pass, oracle};
use carvegraph_geometry::{
    DVec2, DVec3, DropCutter, DropError, Mesh, Pattern, PatternSpan, Profile, Span, SpanKind,
    Surface, Toolpath,
};
use fastrand::Rng;

const MANY: usize = 1_000_000;

/// Points a step apart along x, as a raster lays them.
fn along_x(y: f64, [from, to]: [f64; 2], step: f64) -> Vec<DVec2> {
    let count = ((to - from) / step).floor() as u32;
    (0..=count).map(|k| DVec2::new(from + f64::from(k) * step, y)).collect()
}

fn bent(mesh: &Mesh, profile: &Profile, pattern: &Pattern, tolerance: f64) -> Toolpath {
    let cutter = DropCutter::new(Surface::Mesh(mesh), profile, 0.0, GO).unwrap();
    let mut path = cutter.path(pattern, FLOOR, GO).unwrap();
    path.raise(FLOOR);
    cutter.bend(&path, FLOOR, tolerance, MANY, GO).unwrap()
}

/// By how much the cutter at `tip` would have to be moved to be free, as far as a search in the plane
/// of the move finds: no more than `reach`, or infinity.
fn depth(mesh: &Mesh, profile: &Profile, tip: DVec3, along: DVec2, reach: f64) -> f64 {
    let lift = |away: f64| {
        let there = oracle::drop_on_mesh(mesh, profile, tip.truncate() + away * along).max(FLOOR);
        away.abs().hypot((there - tip.z).max(0.0))
    };
    (-24..=24).map(|k| lift(f64::from(k) / 24.0 * reach)).fold(f64::INFINITY, f64::min)
}

/// The deepest cut at places between the points of a path.
fn deepest(mesh: &Mesh, profile: &Profile, path: &Toolpath, reach: f64) -> f64 {
    let mut deepest = 0.0_f64;
    for ends in path.tips.windows(2) {
        let along = (ends[1] - ends[0]).truncate().normalize_or(DVec2::X);
        for k in 1..8 {
            let tip = ends[0].lerp(ends[1], f64::from(k) / 8.0);
            if oracle::drop_on_mesh(mesh, profile, tip.truncate()) > tip.z + deepest {
                deepest = deepest.max(depth(mesh, profile, tip, along, reach));
            }
        }
    }
    deepest
}

/// A floor, a wall 8 mm high and a plateau.
fn wall() -> Mesh {
    let level = |x: [f64; 2], z: f64| {
        let corner = |x: f64, y: f64| DVec3::new(x, y, z);
        let [a, b] = x;
        [
            [corner(a, 0.0), corner(b, 0.0), corner(b, 20.0)],
            [corner(a, 0.0), corner(b, 20.0), corner(a, 20.0)],
        ]
    };
    let [foot, head] = [DVec3::new(10.1, 0.0, 0.0), DVec3::new(10.1, 0.0, 8.0)];
    let far = DVec3::new(0.0, 20.0, 0.0);
    let upright = [[foot, foot + far, head + far], [foot, head + far, head]];
    mesh(level([0.0, 10.1], 0.0).into_iter().chain(level([10.1, 20.0], 8.0)).chain(upright))
}

#[test]
fn no_cutter_cuts_the_edge_of_a_wall() {
    let wall = wall();
    let tolerance = 0.01;
    let pattern = one_pass(along_x(10.0, [1.0, 19.0], 0.3));
    for (name, profile) in cutters(3.0) {
        let straight = {
            let cutter = DropCutter::new(Surface::Mesh(&wall), &profile, 0.0, GO).unwrap();
            cutter.path(&pattern, FLOOR, GO).unwrap()
        };
        let path = bent(&wall, &profile, &pattern, tolerance);
        let (before, after) =
            (deepest(&wall, &profile, &straight, 0.3), deepest(&wall, &profile, &path, tolerance));
        assert!(before > 2.0 * tolerance, "{name}: {before}");
        assert!(after <= 1.05 * tolerance, "{name}: {after}");
        assert!(path.tips.len() < 4 * straight.tips.len(), "{name}: {}", path.tips.len());
    }
}

#[test]
fn no_cutter_cuts_deeper_than_the_tolerance_anywhere() {
    let mut random = Rng::with_seed(29);
    let waves = sheet(32, 24, 0.2, |x, y| (1.9 * x).sin() * (1.3 * y + x).cos() + 0.4 * x);
    let mut meshes = vec![("waves", waves)];
    meshes.extend(SOUPS.map(|kind| (kind, soup(&mut random, kind, 40, DVec3::ZERO))));
    for (kind, mesh) in &meshes {
        let bounds = mesh.bounds().unwrap();
        let middle = bounds.min.midpoint(bounds.max);
        let ends = [bounds.min.x.max(middle.x - 2.5), bounds.max.x.min(middle.x + 2.5)];
        let pattern = one_pass(along_x(middle.y, ends, 0.31));
        for tolerance in [0.05, 0.005] {
            for (name, profile) in cutters(1.5) {
                let path = bent(mesh, &profile, &pattern, tolerance);
                let deepest = deepest(mesh, &profile, &path, 2.0 * tolerance);
                assert!(deepest <= 1.5 * tolerance, "{kind}, {name}, {tolerance}: {deepest}");
            }
        }
    }
}

#[test]
fn on_a_plane_nothing_is_put_in_and_what_was_there_stays() {
    let slope = sheet(20, 20, 1.0, |x, y| 0.3 * x - 0.7 * y);
    let wall = wall();
    for profile in [Profile::ball(2.0).unwrap(), Profile::flat(2.0).unwrap()] {
        let pattern = one_pass(along_x(9.0, [4.0, 14.0], 0.37));
        assert_eq!(bent(&slope, &profile, &pattern, 1e-6).tips.len(), pattern.points.len());
        let path = bent(&wall, &profile, &pattern, 0.01);
        assert!(path.tips.len() > pattern.points.len());
        let mut tips = path.tips.iter().map(|tip| tip.truncate());
        assert!(pattern.points.iter().all(|point| tips.any(|tip| tip == *point)));
        assert!(path.tips.windows(2).all(|tips| tips[0].x < tips[1].x));
    }
}

#[test]
fn spans_keep_their_points_and_gaps_get_none() {
    let wall = wall();
    // There, linked along the wall's foot, back, and once more elsewhere.
    let mut points = along_x(5.0, [6.0, 13.0], 0.5);
    let first = points.len();
    points.extend(along_x(6.0, [6.0, 13.0], 0.5).into_iter().rev());
    let second = points.len();
    points.extend(along_x(9.0, [6.0, 13.0], 0.5));
    let span = |points, link, joined| PatternSpan { points, link, joined };
    let spans = vec![
        span(0..first, false, false),
        span(first..first + 1, true, true),
        span(first + 1..second, false, true),
        span(second..points.len(), false, false),
    ];
    let pattern = Pattern { points, spans };
    let profile = Profile::ball(2.0).unwrap();
    let path = bent(&wall, &profile, &pattern, 0.01);
    let kinds: Vec<_> = path.spans.iter().map(|span| (span.kind, span.joined)).collect();
    assert_eq!(
        kinds,
        [
            (SpanKind::Pass, false),
            (SpanKind::Link, true),
            (SpanKind::Pass, true),
            (SpanKind::Pass, false)
        ]
    );
    let y = |span: &Span| path.tips[span.points.clone()].iter().map(|tip| tip.y);
    assert!(y(&path.spans[0]).all(|y| y == 5.0));
    assert!(y(&path.spans[3]).all(|y| y == 9.0));
    assert_eq!(path.spans.last().unwrap().points.end, path.tips.len());
    assert!(path.spans.windows(2).all(|two| two[0].points.end == two[1].points.start));
    assert_eq!(path.contacts.len(), path.tips.len());
}

#[test]
fn it_can_be_stopped_and_has_a_limit() {
    let wall = wall();
    let cutter = DropCutter::new(Surface::Mesh(&wall), &Profile::ball(1.0).unwrap(), 0.0, GO);
    let cutter = cutter.unwrap();
    let path = cutter.path(&one_pass(along_x(5.0, [1.0, 19.0], 0.3)), FLOOR, GO).unwrap();
    let stopped = cutter.bend(&path, FLOOR, 0.01, MANY, &|_| false).unwrap_err();
    assert_eq!(stopped, DropError::Stopped);
    let most = path.tips.len() + 2;
    let full = cutter.bend(&path, FLOOR, 0.001, most, GO).unwrap_err();
    assert_eq!(full, DropError::TooManyBends(most));
}

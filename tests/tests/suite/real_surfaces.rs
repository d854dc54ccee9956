//! Every standard cutter on every mesh and scan of the data folder, through the recipes that users run:
//! heights against the slow truth, and the whole path against gouges.
//!
//! # Between the locations
//! The heights are exact at the locations; between them a path runs straight. A ball of radius R whose
//! axis is ρ from what it touches at a place between two locations was no deeper at them than what lets
//! it touch the same point there. So the straight path runs below the surface's by no more than the
//! profile sags below its chord over the distance e of the locations:
//!
//! gouge ≤ e² / 8R · (1 − ((ρ + e) / R)²)^(−3/2),  ρ + e < R.
//!
//! On level ground with the recipe's e = 0.3 mm and R = 3 mm that is 0.004 mm, at 45° 0.018 mm. At a
//! wall, where ρ comes near R, nothing bounds it but a finer `feed_step`: there a path that falls off
//! the edge falls along a slanting line, where the cutter would fall along its own flank.
//!
//! The files lie outside of the repository (`../shared/data`, or where `CARVE_DATA` says). Where one is
//! missing, its tests say so and pass.

use crate::bench::{Bench, skipped, workspace};
use crate::drop_heights::{Seen, sample, values_of};
use carvegraph_geometry::{
    Bounds, ContactKind, Cutter, DVec2, DVec3, DropCutter, Mesh, Pattern, PatternSpan, PointCloud,
    SpanKind, Surface, Toolpath, oracle,
};
use std::path::PathBuf;
use std::sync::Arc;

/// Where nothing is under the cutter, in mm.
const FLOOR_MM: f64 = -777.0;

/// What is set of a cutter, by name.
type Settings = &'static [(&'static str, &'static str)];

/// The standard shapes, each of a size that matters on parts of some 100 mm, and how exact each is.
const CUTTERS: [(&str, Settings, f64); 7] = [
    ("ball", &[("diameter", "6")], 1e-9),
    ("flat", &[("diameter", "6")], 1e-9),
    ("bull_nose", &[("diameter", "6"), ("tool.corner_radius", "1")], 1e-6),
    ("v_bit", &[("diameter", "6"), ("tool.tip_diameter", "0.2")], 1e-6),
    ("v_bit", &[("diameter", "6"), ("tool.tip_radius", "0.5")], 1e-6),
    ("tapered_ball", &[("diameter", "6"), ("tool.tip_radius", "0.5")], 1e-6),
    ("form", &[("tool.drawing", "ogee.svg")], 1e-6),
];

/// A file of the data folder, if it is there.
fn data(name: &str) -> Option<String> {
    let folder = std::env::var_os("CARVE_DATA").map(PathBuf::from);
    let path = folder.unwrap_or_else(|| workspace().join("../shared/data")).join(name);
    if !path.is_file() {
        skipped(&format!("no {}, it was not carved (CARVE_DATA names its folder)", path.display()));
        return None;
    }
    Some(path.display().to_string())
}

/// The cutter that a recipe makes of settings.
fn cutter(bench: &Bench, shape: &str, settings: &[(&str, &str)]) -> Arc<Cutter> {
    let drawing = workspace().join("plugins/cutters/tests/drawings/ogee.svg");
    bench.write("ogee.svg", std::fs::read(drawing).unwrap());
    let settings = [&[("cutter", shape)], settings].concat();
    values_of(bench, "mesh_finish", &settings, "tool").of("cutter")
}

/// Places over a box and a little around it, with no pattern to them.
fn places(bounds: &Bounds, count: usize) -> Vec<DVec2> {
    let (low, size) = (bounds.min.truncate(), bounds.size().truncate());
    // The additive recurrence of the plastic number (Roberts 2018): even, never in line.
    let share = |k: usize| DVec2::new(k as f64 * 0.754_877_666, k as f64 * 0.569_840_296).fract();
    (1..=count).map(|k| low + (share(k) * 1.04 - 0.02) * size).collect()
}

fn one_pass(points: Vec<DVec2>) -> Pattern {
    let spans = vec![PatternSpan { points: 0..points.len(), link: false, joined: false }];
    Pattern { points, spans }
}

/// Compares each cutter's heights with the truth at `count` places.
fn assert_exact(surface: Surface, count: usize, truth: impl Fn(&Cutter, DVec2) -> f64) {
    let bench = Bench::new();
    let places = places(&surface.bounds().unwrap(), count);
    for (shape, settings, exact_mm) in CUTTERS {
        let cutter = cutter(&bench, shape, settings);
        let ready = DropCutter::new(surface, &cutter.profile, 0.0, &|_| true).unwrap();
        let path = ready.path(&one_pass(places.clone()), FLOOR_MM, &|_| true).unwrap();
        for (tip, contact) in path.tips.iter().zip(&path.contacts) {
            let wanted = truth(&cutter, tip.truncate()).max(FLOOR_MM);
            let off = tip.z - wanted;
            assert!(off.abs() <= exact_mm, "{shape} {settings:?} at {tip}: off by {off:e} mm");
            assert_eq!(contact.kind == ContactKind::None, tip.z == FLOOR_MM);
        }
    }
}

fn mesh_of(bench: &Bench, name: &str, settings: &[(&str, &str)], only: &str) -> Option<Seen> {
    let path = data(name)?;
    Some(values_of(bench, "mesh_finish", &[&[("mesh", &path[..])], settings].concat(), only))
}

fn assert_mesh(name: &str, settings: &[(&str, &str)], count: usize) {
    let bench = Bench::new();
    let Some(seen) = mesh_of(&bench, name, settings, "placed") else { return };
    let mesh: Arc<Mesh> = seen.of("transform_mesh");
    let truth = |cutter: &Cutter, at| oracle::drop_on_mesh(&mesh, &cutter.profile, at);
    assert_exact(Surface::Mesh(&mesh), count, truth);
}

#[test]
fn every_cutter_is_exact_on_mount_rushmore() {
    assert_mesh("mount_rush.stl", &[], 60);
}

#[test]
fn every_cutter_is_exact_on_the_spider() {
    assert_mesh("spider.stl", &[], 60);
}

#[test]
fn every_cutter_is_exact_on_the_bust() {
    assert_mesh("igea.ply", &[("width", "100")], 12);
}

fn assert_points(name: &str, settings: &[(&str, &str)], count: usize) {
    let bench = Bench::new();
    let Some(path) = data(name) else { return };
    let settings = [&[("points", &path[..])], settings].concat();
    let seen = values_of(&bench, "points_finish", &settings, "placed");
    let cloud: Arc<PointCloud> = seen.of("transform_points");
    let truth = |cutter: &Cutter, at| {
        oracle::drop_on_points(cloud.points.iter().copied(), &cutter.profile, at)
    };
    assert_exact(Surface::Points(&cloud), count, truth);
}

#[test]
fn every_cutter_is_exact_on_the_scan_of_a_face() {
    assert_points("face-scan.xyz", &[("width", "150")], 100);
}

#[test]
fn every_cutter_is_exact_on_the_scan_of_a_terrain() {
    assert_points("terrain-scan.pcd", &[("width", "200")], 100);
}

/// The tips of a ball over a scan as it lies, and over the same moved to 0 before.
#[test]
fn a_scan_far_away_has_the_heights_of_one_at_0() {
    let bench = Bench::new();
    let Some(path) = data("terrain-scan.pcd") else { return };
    let loaded = |origin: &str| -> Arc<PointCloud> {
        let settings = [("points", &path[..]), ("unit", "m"), ("scan.origin", origin)];
        values_of(&bench, "points_finish", &settings, "scan").of("load_points")
    };
    let (far, near) = (loaded("keep"), loaded("corner"));
    let offset = far.bounds().unwrap().min;
    assert!(offset.truncate().length() > 1e5, "the scan lies at {offset}");
    let size = far.bounds().unwrap().size().truncate().max_element();
    let cutter = cutter(&bench, "ball", &[]);
    let ball = carvegraph_geometry::Profile::ball(size / 20.0).unwrap();
    assert!(cutter.profile.radius_mm() > 0.0);
    let places = places(&far.bounds().unwrap(), 400);
    let drop = |cloud: &PointCloud, places: Vec<DVec2>| {
        let ready = DropCutter::new(Surface::Points(cloud), &ball, 0.0, &|_| true).unwrap();
        ready.path(&one_pass(places), FLOOR_MM, &|_| true).unwrap()
    };
    let moved = places.iter().map(|at| at - offset.truncate()).collect();
    let (far, near) = (drop(&far, places), drop(&near, moved));
    for (a, b) in far.tips.iter().zip(&near.tips) {
        let off = a.z - offset.z - b.z;
        // Places and points this far out are themselves rounded to 1e-16 of where they lie.
        let rounded = 1e-9 + 4e-15 * offset.length();
        assert!(a.z == b.z || off.abs() <= rounded, "{a} {b}: off by {off:e} mm");
    }
}

/// Moved by a number of steps of 2⁻²⁰ mm, which no addition rounds.
#[test]
fn a_mesh_at_5_km_has_the_heights_of_one_at_0() {
    let exact = |v: f64| (v * 1_048_576.0).round() / 1_048_576.0;
    let node = |k: u32| {
        let (x, y) = (f64::from(k % 90) * 0.4375, f64::from(k / 90) * 0.4375);
        DVec3::new(x, y, exact(2.0 * (0.4 * x).sin() * (0.3 * y).cos() + 0.3 * (3.1 * x * y).sin()))
    };
    let mesh = |offset: DVec3| Mesh {
        vertices: Arc::new((0..90 * 90).map(|k| node(k) + offset).collect()),
        triangles: (0..89 * 89)
            .map(|c| c / 89 * 90 + c % 89)
            .flat_map(|k| [[k, k + 1, k + 91], [k, k + 91, k + 90]])
            .collect(),
    };
    let offset = DVec3::new(5e6, -5e6, 1e4);
    let (near, far) = (mesh(DVec3::ZERO), mesh(offset));
    let round = |at: DVec2| DVec2::new(exact(at.x), exact(at.y));
    let at: Vec<_> = places(&near.bounds().unwrap(), 500).into_iter().map(round).collect();
    let there: Vec<_> = at.iter().map(|at| at + offset.truncate()).collect();
    let bench = Bench::new();
    for (shape, settings, _) in CUTTERS {
        let profile = &cutter(&bench, shape, settings).profile;
        let drop = |mesh: &Mesh, places: &[DVec2]| {
            let ready = DropCutter::new(Surface::Mesh(mesh), profile, 0.0, &|_| true).unwrap();
            ready.path(&one_pass(places.to_vec()), FLOOR_MM, &|_| true).unwrap()
        };
        for (a, b) in drop(&near, &at).tips.iter().zip(&drop(&far, &there).tips) {
            let off = b.z - offset.z - a.z;
            assert!(a.z == b.z || off.abs() <= 1e-9, "{shape} at {}: off by {off:e} mm", a);
        }
    }
}

/// How far a straight path may lie below the surface's of a ball, see the module.
fn chord_mm(radius_mm: f64, step_mm: f64, away_mm: f64) -> Option<f64> {
    let share = (away_mm + step_mm) / radius_mm;
    (share < 1.0).then(|| step_mm * step_mm / (8.0 * radius_mm) * (1.0 - share * share).powf(-1.5))
}

/// The ball of the recipe `mesh_finish` along its path, as it is dropped and as it is reduced.
fn assert_no_gouges(name: &str, settings: &[(&str, &str)]) {
    const STEP_MM: f64 = 0.3;
    const RADIUS_MM: f64 = 3.0;
    // The recipe's tolerance, 0.01 mm, which z_band may double.
    const REDUCED_MM: f64 = 0.02;
    let bench = Bench::new();
    let Some(seen) = mesh_of(&bench, name, settings, "reduce") else { return };
    let (mesh, cutter): (Arc<Mesh>, Arc<Cutter>) = (seen.of("transform_mesh"), seen.of("cutter"));
    assert_eq!(cutter.profile, carvegraph_geometry::Profile::ball(RADIUS_MM).unwrap());
    let (dropped, reduced): (Arc<Toolpath>, Arc<Toolpath>) =
        (seen.of("drop_on_mesh"), seen.of("reduce_cl"));
    // None at the locations, by the truth.
    for tip in sample(&dropped, 30) {
        let truth = oracle::drop_on_mesh(&mesh, &cutter.profile, tip.truncate());
        assert!((tip.z - truth.max(0.0)).abs() <= 1e-9, "{name} at {tip}: {truth}");
    }
    let ready = DropCutter::new(Surface::Mesh(&mesh), &cutter.profile, 0.0, &|_| true).unwrap();
    for (path, allowance_mm) in [(&dropped, 1e-9), (&reduced, REDUCED_MM)] {
        let moves = places_on_moves(path, STEP_MM);
        let there = one_pass(moves.iter().map(|at| at.truncate()).collect());
        let there = ready.path(&there, 0.0, &|_| true).unwrap();
        let (mut largest, mut by_wall) = (0.0_f64, 0.0_f64);
        for (at, (tip, contact)) in moves.iter().zip(there.tips.iter().zip(&there.contacts)) {
            let gouge = tip.z - at.z;
            let away = contact.point.truncate().distance(tip.truncate());
            let touched = contact.kind != ContactKind::None;
            match chord_mm(RADIUS_MM, STEP_MM, away).filter(|_| touched) {
                Some(chord) => {
                    largest = largest.max(if away < RADIUS_MM / 2.0 { gouge } else { 0.0 });
                    assert!(gouge <= chord + allowance_mm, "{name} {at}: {gouge}, not {chord}");
                }
                None => by_wall = by_wall.max(if touched { gouge } else { 0.0 }),
            }
        }
        // On ground that slopes by 30° or less.
        let bound = chord_mm(RADIUS_MM, STEP_MM, RADIUS_MM / 2.0).unwrap() + allowance_mm;
        eprintln!(
            "{name}: {} places, {largest:.5} mm up to 30 deg, {by_wall:.3} mm at walls",
            moves.len()
        );
        assert!(largest <= bound, "{name}: {largest} mm");
    }
}

/// Places between the ends of the moves of the passes, no two along a move nearer than a step apart
/// but for the middles of steps: where a chord lies lowest.
fn places_on_moves(path: &Toolpath, step_mm: f64) -> Vec<DVec3> {
    let passes = path.spans.iter().filter(|span| span.kind == SpanKind::Pass);
    let moves = passes.flat_map(|span| path.tips[span.points.clone()].windows(2));
    let along = |ends: &[DVec3]| {
        let (from, to) = (ends[0], ends[1]);
        let steps = (from.truncate().distance(to.truncate()) / step_mm).round().max(1.0) as u32;
        (0..steps).map(move |k| from.lerp(to, (f64::from(k) + 0.5) / f64::from(steps)))
    };
    moves.flat_map(along).step_by(7).collect()
}

#[test]
fn the_path_over_mount_rushmore_does_not_gouge() {
    assert_no_gouges("mount_rush.stl", &[]);
}

#[test]
fn the_path_over_the_spider_does_not_gouge() {
    assert_no_gouges("spider.stl", &[]);
}

#[test]
fn the_path_over_the_bust_does_not_gouge() {
    assert_no_gouges("igea.ply", &[("width", "60")]);
}

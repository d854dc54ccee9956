//! Every standard cutter on every mesh and scan of the data folder, through the recipes that users run:
//! heights against the slow truth, and the whole path against gouges.
//!
//! # Between the locations
//! The heights are exact at the locations. Between two of them the path runs straight, but where it bends
//! locations are put in. A cutter anywhere on the path is then within one and a half tolerances of one that
//! only touches, so that is how deep it cuts: the distance in space, for at a wall a hair's breadth decides over
//! any height.
//!
//! The files lie outside of the repository (`../shared/data`, or where `CARVE_DATA` says). Where one is
//! missing, its tests say so and pass.

use crate::bench::{Bench, data, workspace};
use crate::drop_heights::{Seen, sample, values_of};
use carvegraph_geometry::{
    Bounds, ContactKind, Cutter, DVec2, DVec3, DropCutter, Mesh, Pattern, PatternSpan, PointCloud,
    SpanKind, Surface, Toolpath, oracle,
};
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

/// A cutter over a surface, anywhere.
struct Free<'a> {
    cutter: DropCutter<'a>,
    floor_mm: f64,
}

impl Free<'_> {
    /// The lowest tips that do not cut.
    fn tips(&self, places: Vec<DVec2>) -> Vec<f64> {
        let mut path = self.cutter.path(&one_pass(places), self.floor_mm, &|_| true).unwrap();
        path.raise(self.floor_mm);
        path.tips.iter().map(|tip| tip.z).collect()
    }

    /// How far the cutter at each tip must be moved to be free, if that is `most_mm` at most along its
    /// move or upwards; infinity if not.
    fn depths(&self, tips: &[(DVec3, DVec2)], most_mm: f64) -> Vec<f64> {
        const SHIFTS: i32 = 40;
        let aside = |k: i32| f64::from(k) / f64::from(SHIFTS) * most_mm;
        let shifts = |&(tip, along): &(DVec3, DVec2)| {
            (-SHIFTS..=SHIFTS).map(move |k| tip.truncate() + aside(k) * along)
        };
        let free = self.tips(tips.iter().flat_map(shifts).collect());
        let nearest = |((tip, _), free): (&(DVec3, DVec2), &[f64])| {
            let moved = |(k, z): (i32, &f64)| aside(k).hypot((z - tip.z).max(0.0));
            (-SHIFTS..).zip(free).map(moved).fold(f64::INFINITY, f64::min)
        };
        tips.iter().zip(free.chunks(2 * SHIFTS as usize + 1)).map(nearest).collect()
    }
}

/// The ball of a recipe along its path, as it is dropped and as it is reduced.
fn assert_no_gouges(name: &str, settings: &[(&str, &str)]) {
    const RADIUS_MM: f64 = 3.0;
    // One and a half times the recipe's tolerance.
    const CHORD_MM: f64 = 0.015;
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
    let cutter = DropCutter::new(Surface::Mesh(&mesh), &cutter.profile, 0.0, &|_| true).unwrap();
    let free = Free { cutter, floor_mm: 0.0 };
    for (path, allowed_mm) in [(&dropped, CHORD_MM), (&reduced, CHORD_MM + REDUCED_MM)] {
        let moves = places_on_moves(path);
        let needed = free.tips(moves.iter().map(|(at, _)| at.truncate()).collect());
        // Raising the cutter frees it as well.
        let deep = moves.iter().zip(needed).filter(|((at, _), z)| z - at.z > allowed_mm);
        let deep: Vec<_> = deep.map(|(&place, _)| place).collect();
        let depths = free.depths(&deep, 2.0 * allowed_mm);
        let worst = depths.iter().copied().fold(0.0, f64::max);
        let deeper = depths.iter().filter(|depth| **depth > allowed_mm).count();
        eprintln!("{name}: {} places, {deeper} of {} deeper", moves.len(), deep.len());
        assert!(worst <= allowed_mm, "{name}: {worst} mm");
    }
}

/// Places on all moves of the passes, and the ways they run in plan.
fn places_on_moves(path: &Toolpath) -> Vec<(DVec3, DVec2)> {
    let passes = path.spans.iter().filter(|span| span.kind == SpanKind::Pass);
    let moves = passes.flat_map(|span| path.tips[span.points.clone()].windows(2));
    let along = |ends: &[DVec3]| {
        let (from, to) = (ends[0], ends[1]);
        let way = (to - from).truncate().normalize_or(DVec2::X);
        (1..8).map(move |k| (from.lerp(to, f64::from(k) / 8.0), way))
    };
    moves.flat_map(along).collect()
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

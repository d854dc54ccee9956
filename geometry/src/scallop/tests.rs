//! Both planners, held against what a swept ball leaves.
//!
//! The oracle knows nothing of the planners' probes: it spreads points over the facets that point up, and
//! asks for each how far along the facet's normal the nearest place is that lies within R of the centres of
//! some move, by halving.

use super::*;
use crate::{
    Against, BezierPatch, DropCutter, HeightField, Mesh, Pattern, PatternSpan, PointCloud, SpanKind,
};
use glam::DVec2;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_8;
use std::sync::Arc;

/// Moves by the squares of the plan that they may touch.
struct Swept {
    radius: f64,
    min: DVec2,
    columns: usize,
    moves: Vec<Vec<(DVec3, DVec3)>>,
}

/// The square millimetre of a place.
fn cell_of(place: DVec2) -> [usize; 2] {
    // What is below 0 becomes 0.
    [place.x as usize, place.y as usize]
}

impl Swept {
    fn new(path: &Toolpath, radius: f64, bounds: &Bounds) -> Self {
        let min = bounds.min.truncate() - radius;
        let [columns, rows] = cell_of(bounds.size().truncate() + 2.0 * radius).map(|n| n + 1);
        let mut moves = vec![Vec::new(); columns * rows];
        for span in &path.spans {
            let first = span.points.start + usize::from(!span.joined);
            for to in first.max(1)..span.points.end {
                let [a, b] = [path.tips[to - 1], path.tips[to]].map(|tip| tip + DVec3::Z * radius);
                let low = cell_of(a.min(b).truncate() - radius - min);
                let high = cell_of(a.max(b).truncate() + radius - min);
                for y in low[1]..=high[1].min(rows - 1) {
                    for x in low[0]..=high[0].min(columns - 1) {
                        moves[y * columns + x].push((a, b));
                    }
                }
            }
        }
        Self { radius, min, columns, moves }
    }

    /// Distance of a place from the nearest centre of the cutter, less R: negative inside of what is cut.
    fn off(&self, place: DVec3) -> f64 {
        let [x, y] = cell_of(place.truncate() - self.min);
        let away = |(a, b): &(DVec3, DVec3)| {
            let way = *b - *a;
            let share = (place - *a).dot(way) / way.length_squared().max(1e-300);
            place.distance(*a + way * share.clamp(0.0, 1.0))
        };
        let moves = &self.moves[y * self.columns + x];
        moves.iter().map(away).fold(f64::INFINITY, f64::min) - self.radius
    }

    /// How far along a normal what is cut begins, in mm; negative how deep it is cut.
    fn left(&self, point: DVec3, normal: DVec3, most: f64) -> f64 {
        let off = self.off(point);
        if off <= 0.0 {
            return off;
        }
        let (mut low, mut high) = (0.0, most);
        if self.off(point + normal * high) > 0.0 {
            return most;
        }
        for _ in 0..24 {
            let middle = (low + high) / 2.0;
            let inside = self.off(point + normal * middle) <= 0.0;
            (low, high) = if inside { (low, middle) } else { (middle, high) };
        }
        high
    }
}

/// The highest that stands and the deepest that is cut, in mm, on facets that point up, `border` away from the
/// border.
fn left_on(mesh: &Mesh, path: &Toolpath, radius: f64, border: f64, per_mm: f64) -> (f64, f64) {
    let bounds = mesh.bounds().unwrap();
    let swept = Swept::new(path, radius, &bounds);
    let (min, max) = (bounds.min.truncate() + border, bounds.max.truncate() - border);
    let worst = (0..mesh.triangles.len()).into_par_iter().map(|t| {
        let [a, b, c] = mesh.corners(t);
        let normal = (b - a).cross(c - a).normalize();
        let steps = (a.distance(b).max(a.distance(c)) * per_mm).ceil().max(1.0);
        let count = if normal.z > 0.1 { steps as usize } else { 0 };
        let mut worst = (0.0_f64, 0.0_f64);
        for (i, j) in (0..=count).flat_map(|i| (0..=count - i).map(move |j| (i, j))) {
            if count == 0 {
                break;
            }
            let point = a + (b - a) * (i as f64 / steps) + (c - a) * (j as f64 / steps);
            let place = point.truncate();
            if place.cmpge(min).all() && place.cmple(max).all() {
                let left = swept.left(point, normal, 1.0);
                worst = (worst.0.max(left), worst.1.min(left));
            }
        }
        worst
    });
    worst.reduce(|| (0.0, 0.0), |a, b| (a.0.max(b.0), a.1.min(b.1)))
}

fn part(patch: &BezierPatch) -> Mesh {
    patch.part(20, 0.0, &|_| true).unwrap()
}

fn ball() -> Profile {
    Profile::ball(3.0).unwrap()
}

fn finish<'a>(mesh: &'a Mesh, profile: &'a Profile, scallop_mm: f64) -> Finish<'a> {
    Finish {
        surface: Surface::Mesh(mesh),
        profile,
        area: mesh.bounds().unwrap_or(Bounds { min: DVec3::ZERO, max: DVec3::ONE }),
        along_y: true,
        style: RasterStyle::Zigzag,
        scallop_mm,
        least_step_mm: 0.02,
        steepest_rad: 1.3,
        floor_mm: 0.0,
        allowance_mm: 0.0,
        chord_tolerance_mm: 0.01,
        most_points: 10_000_000,
    }
}

fn raster(finish: Finish<'_>) -> Result<Finished, ScallopError> {
    ScallopRaster { finish, borders: Borders::Inset }.plan(&|_| true)
}

/// The scallop, CL points, passes.
type Row = (f64, usize, usize);

/// Tables 5.2 and 5.5: of the rising and the convex part.
const SOURCE: [(bool, [Row; 4]); 2] = [
    (false, [(0.06, 6795, 45), (0.08, 3237, 39), (0.1, 2485, 35), (0.125, 1953, 31)]),
    (true, [(0.08, 7921, 89), (0.1, 3025, 55), (0.125, 1849, 43), (0.15, 1295, 37)]),
];

#[test]
fn no_more_points_and_passes_than_the_source_and_no_more_left_than_the_scallop() {
    for (convex, rows) in SOURCE {
        let mesh = part(&if convex { BezierPatch::convex() } else { BezierPatch::rising() });
        for (scallop, points, passes) in rows {
            let found = raster(finish(&mesh, &ball(), scallop)).unwrap();
            let (cl, lines) = (found.path.cl_points(), found.path.passes());
            assert!(cl <= points && lines <= passes, "{scallop}: {cl} in {lines}");
            let (above, below) = left_on(&mesh, &found.path, 3.0, 3.0, 12.0);
            assert!(above <= scallop && above > 0.9 * scallop, "{scallop}: {above}");
            assert!(below >= -0.01, "{scallop}: {below}");
            assert!(found.held.above == 0 && found.held.worst_mm <= scallop);
        }
    }
}

/// The widest concave crease between facets that point up, as what a ball cannot reach of it, in mm:
/// R·(1/cos(δ/2) - 1), δ the angle between the normals.
fn crease_mm(mesh: &Mesh, radius: f64) -> f64 {
    let mut beside = std::collections::HashMap::new();
    let mut most = 0.0_f64;
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners(t);
        let normal = (b - a).cross(c - a).normalize();
        if normal.z < 0.1 {
            continue;
        }
        for k in 0..3 {
            let (from, to, across) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            beside.insert((from, to), (normal, mesh.vertices[across as usize]));
            if let Some((other, _)) = beside.get(&(to, from)) {
                let concave =
                    other.dot(mesh.vertices[across as usize] - mesh.vertices[from as usize]) > 0.0;
                let half = normal.dot(*other).min(1.0).acos() / 2.0;
                most = most.max(if concave { radius * (1.0 / half.cos() - 1.0) } else { 0.0 });
            }
        }
    }
    most
}

fn constant(finish: Finish<'_>) -> Result<Finished, ScallopError> {
    ConstantScallop { finish }.plan(&|_| true)
}

#[test]
fn passes_that_bend_leave_no_more_than_the_scallop_and_are_no_longer() {
    for (patch, scallop, per_mm) in
        [(BezierPatch::rising(), 0.06, 8.0), (BezierPatch::convex(), 0.1, 8.0)]
    {
        let mesh = part(&patch);
        let profile = ball();
        let [straight, bent] =
            [raster, constant].map(|plan| plan(finish(&mesh, &profile, scallop)).unwrap());
        let (above, below) = left_on(&mesh, &bent.path, 3.0, 3.0, per_mm);
        assert!(above <= scallop && above > 0.9 * scallop, "{scallop}: {above}");
        assert!(below >= -0.01, "{scallop}: {below}");
        let length = |path: &Toolpath| path.length_mm(|kind| kind != SpanKind::Rapid);
        assert!(length(&bent.path) < length(&straight.path));
    }
}

/// A tenth of the source's least. What a ball does not reach in creases between facets is no scallop.
#[test]
fn five_thousandths_are_held_over_a_corner_of_either_part() {
    for patch in [BezierPatch::rising(), BezierPatch::convex()] {
        let mesh = part(&patch);
        let corner = DVec3::new(16.0, 16.0, 25.0);
        let profile = ball();
        let area = Bounds { max: corner, ..mesh.bounds().unwrap() };
        let found = raster(Finish { area, ..finish(&mesh, &profile, 0.005) }).unwrap();
        let triangles = (0..mesh.triangles.len())
            .filter(|t| mesh.corners(*t).iter().all(|p| p.x <= corner.x && p.y <= corner.y));
        let triangles = triangles.map(|t| mesh.triangles[t]).collect();
        let near = Mesh { vertices: Arc::clone(&mesh.vertices), triangles };
        let (above, below) = left_on(&near, &found.path, 3.0, 3.0, 16.0);
        let most = 0.005 + crease_mm(&mesh, 3.0);
        assert!(above <= most && above > 0.0045, "{above} of {most}");
        assert!(below >= -0.0005, "{below}");
    }
}

#[test]
fn a_plane_gets_the_flat_step_and_a_tilted_one_its_share() {
    let bull = Profile::bull_nose(3.0, 1.0).unwrap();
    for (profile, slope) in [(ball(), 0.0), (ball(), 0.4), (ball(), 1.0), (bull, 0.0_f64)] {
        let heights = (0..81 * 41).map(|k| (f64::from(k / 81) * 0.5 * slope) as f32).collect();
        let field = HeightField::new(81, 41, 0.5, heights).unwrap();
        let mesh = part(&BezierPatch::convex());
        let plan = Finish {
            surface: Surface::Field(&field, Against::Mesh),
            area: field.bounds(),
            along_y: false,
            ..finish(&mesh, &profile, 0.05)
        };
        let path = raster(plan).unwrap().path;
        let passes = path.spans.iter().filter(|span| span.kind == SpanKind::Pass);
        let places: Vec<f64> = passes.map(|span| path.tips[span.points.start].y).collect();
        let flat = plan.flat_step_mm() / slope.hypot(1.0);
        // On a slope the rim of the field is touched by its edge: nearer to it there is nothing to hold.
        for pair in places.windows(2).filter(|pair| pair[0] > 3.0 && pair[1] < 17.0) {
            let step = (pair[1] - pair[0]) / flat;
            assert!((0.8..=1.0).contains(&step), "{slope}: {step}");
        }
        let beside = [places[0], 20.0 - places[places.len() - 1]];
        let at_most = if slope == 0.0 { 0.5 } else { 2.0 };
        assert!(
            beside.iter().all(|beside| *beside <= at_most * flat),
            "{slope}: {beside:?} {flat}"
        );
    }
}

/// Triangles without any order, among them upright ones.
fn noise(count: usize, seed: u64) -> Mesh {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut point = || DVec3::new(random.f64() * 12.0, random.f64() * 9.0, random.f64() * 6.0);
    let vertices = (0..3 * count).map(|_| point()).collect();
    let triangles = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh { vertices: Arc::new(vertices), triangles }
}

/// A block with a pillar on it: all walls are upright.
fn walls() -> Mesh {
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for (low, high, z) in [(0.0, 12.0, 1.0), (4.0, 8.0, 5.0)] {
        let base = vertices.len() as u32;
        vertices.extend([
            corner(low, low, z),
            corner(high, low, z),
            corner(high, high, z),
            corner(low, high, z),
        ]);
        triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
        vertices.extend([
            corner(low, low, 0.0),
            corner(high, low, 0.0),
            corner(high, high, 0.0),
            corner(low, high, 0.0),
        ]);
        for k in 0..4 {
            let next = (k + 1) % 4;
            let [a, b, c, d] = [base + 4 + k, base + 4 + next, base + next, base + k];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh { vertices: Arc::new(vertices), triangles }
}

#[test]
fn noise_walls_and_a_single_triangle_end_and_are_not_cut_into() {
    let single = Mesh { triangles: vec![[0, 1, 2]], ..noise(1, 3) };
    let profile = Profile::ball(1.5).unwrap();
    for mesh in [noise(60, 1), noise(400, 2), walls(), single] {
        for plan in [raster, constant] {
            let given = Finish { least_step_mm: 0.1, ..finish(&mesh, &profile, 0.05) };
            let found = plan(given).unwrap();
            assert!(found.path.passes() > 1 && found.path.passes() < 400);
            assert!(found.held.above > 0 || found.held.worst_mm <= 0.05);
            // Along each move a dropped cutter is nowhere higher than within the tolerance.
            let cutter = DropCutter::new(Surface::Mesh(&mesh), &profile, 0.0, &|_| true).unwrap();
            let below = below_mm(&cutter, &found.path);
            // Of triangles without order some hide between the places at which a move is tried.
            assert!(below <= 0.03, "{below}");
        }
    }
}

/// How far below the cutter's own path the moves of a path are in height, at the most, in mm, where no place
/// within one and a half tolerances is free: at a wall the height beside says nothing.
fn below_mm(cutter: &DropCutter<'_>, path: &Toolpath) -> f64 {
    let heights = |points: Vec<DVec2>| {
        let spans = vec![PatternSpan { points: 0..points.len(), link: false, joined: false }];
        cutter.path(&Pattern { points, spans }, 0.0, &|_| true).unwrap().tips
    };
    let mut places = Vec::new();
    for span in &path.spans {
        for to in span.points.clone().skip(usize::from(!span.joined)) {
            let [from, end] = [path.tips[to - 1], path.tips[to]];
            let way = (end - from).truncate().normalize_or_zero();
            places.extend((0..5).map(|k| (from.lerp(end, f64::from(k) / 5.0), way)));
        }
    }
    let dropped = heights(places.iter().map(|(at, _)| at.truncate()).collect());
    let deep = places.iter().zip(&dropped).filter(|((at, _), tip)| tip.z - at.z > 0.01);
    let free = deep.map(|((at, way), _)| {
        // Closely along the move, for it may lead through a narrow pit, and around.
        let along = (-60..=60).map(|k| *way * (f64::from(k) * 0.000_25));
        let around = (0..96).map(|k| {
            DVec2::from_angle(f64::from(k % 16) * FRAC_PI_8) * f64::from(k / 16 + 1) * 0.0025
        });
        let tips = heights(along.chain(around).map(|off| at.truncate() + off).collect());
        tips.iter().map(|tip| tip.z - at.z).fold(f64::INFINITY, f64::min)
    });
    free.fold(0.0, f64::max)
}

#[test]
fn other_round_cutters_hold_the_scallop_too() {
    let mesh = part(&BezierPatch::rising());
    let r = 0.5_f64.sqrt();
    let tapered = Profile::new(vec![
        Segment::Arc { to: [r, 1.0 - r], center: [0.0, 1.0] },
        Segment::Line { to: [3.0, 4.0 - 2.0 * r] },
    ]);
    let balls = raster(finish(&mesh, &ball(), 0.05)).unwrap().path.passes();
    for (profile, tip_mm) in [
        (Profile::bull_nose(3.0, 1.5).unwrap(), 1.5),
        (tapered.unwrap(), 1.0),
        (Profile::bull_nose(3.0, 2.9).unwrap(), 2.9),
    ] {
        let found = raster(finish(&mesh, &profile, 0.05)).unwrap();
        assert!(found.held.above == 0, "{:?}", found.held);
        // The part slopes all over: steps are those of the rounding, nearly, which go with the root of it.
        let ratio = found.path.passes() as f64 / balls as f64 * (tip_mm / 3.0_f64).sqrt();
        assert!(ratio > 0.7 && ratio < 1.05, "{tip_mm}: {ratio}");
        let cutter = DropCutter::new(Surface::Mesh(&mesh), &profile, 0.0, &|_| true).unwrap();
        assert!(below_mm(&cutter, &found.path) <= 0.015);
    }
}

#[test]
fn an_allowance_and_points_are_planned_like_a_mesh() {
    let mesh = part(&BezierPatch::convex());
    let profile = ball();
    let plain = raster(finish(&mesh, &profile, 0.1)).unwrap();
    let given = Finish { allowance_mm: 0.5, ..finish(&mesh, &profile, 0.1) };
    let raised = raster(given).unwrap();
    assert!(plain.path.passes().abs_diff(raised.path.passes()) <= 1);
    let dense = BezierPatch::convex().part(160, 14.0, &|_| true).unwrap();
    let points = PointCloud { points: Arc::clone(&dense.vertices), grid: None };
    let given = Finish { surface: Surface::Points(&points), ..finish(&mesh, &profile, 0.1) };
    let over_points = raster(given).unwrap();
    assert!(plain.path.passes().abs_diff(over_points.path.passes()) <= 2);
}

#[test]
fn what_cannot_be_planned_is_refused() {
    let mesh = part(&BezierPatch::convex());
    let profile = ball();
    let fault = |given: Finish<'_>| raster(given).unwrap_err();
    let plan = |scallop| finish(&mesh, &profile, scallop);
    let with = |profile: Profile| raster(finish(&mesh, &profile, 0.05)).unwrap_err();
    assert_eq!(with(Profile::flat(3.0).unwrap()), ScallopError::NotRound);
    let vee = Profile::new(vec![Segment::Line { to: [3.0, 3.0] }]).unwrap();
    assert_eq!(with(vee), ScallopError::NotRound);
    let hollow = Profile::new(vec![
        Segment::Arc { to: [1.0, 1.0], center: [0.0, 1.0] },
        Segment::Line { to: [3.0, 1.5] },
    ]);
    assert_eq!(with(hollow.unwrap()), ScallopError::NotConvex);
    for scallop in [0.0, -1.0, 3.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(fault(plan(scallop)), ScallopError::BadScallop { .. }));
    }
    for least in [0.0, f64::NAN] {
        let bad = fault(Finish { least_step_mm: least, ..plan(0.1) });
        assert!(bad.to_string().starts_with("the least step must be a positive length in mm"));
    }
    let nowhere = Bounds { min: DVec3::splat(f64::NAN), max: DVec3::ONE };
    assert_eq!(fault(Finish { area: nowhere, ..plan(0.1) }), ScallopError::NoArea);
    assert_eq!(fault(Finish { most_points: 900, ..plan(0.1) }), ScallopError::TooManyPoints(900));
    assert_eq!(fault(plan(1e-9)), ScallopError::TooManyPoints(10_000_000));
}

#[test]
fn an_area_without_width_is_a_pass_and_without_surface_all_floor() {
    let mesh = part(&BezierPatch::convex());
    let profile = ball();
    let at = |min, max| Finish { area: Bounds { min, max }, ..finish(&mesh, &profile, 0.1) };
    let line = at(DVec3::new(20.0, 5.0, 0.0), DVec3::new(20.0, 40.0, 9.0));
    let beside = at(DVec3::new(200.0, 5.0, 0.0), DVec3::new(210.0, 15.0, 9.0));
    for plan in [raster, constant] {
        assert_eq!(plan(line).unwrap().path.passes(), 1);
        let path = plan(beside).unwrap().path;
        assert!(path.tips.iter().all(|tip| tip.z == 0.0) && path.passes() > 1);
    }
}

#[test]
fn styles_follow_the_raster() {
    let mesh = part(&BezierPatch::convex());
    let profile = ball();
    for along_y in [false, true] {
        for (style, right) in [(RasterStyle::Climb, true), (RasterStyle::Conventional, false)] {
            let found = raster(Finish { style, along_y, ..finish(&mesh, &profile, 0.15) }).unwrap();
            let path = found.path;
            assert!(path.spans.iter().all(|span| !span.joined && span.kind == SpanKind::Pass));
            let ends = |k: usize| {
                let span = &path.spans[k].points;
                [path.tips[span.start].truncate(), path.tips[span.end - 1].truncate()]
            };
            let ([from, to], [next, _]) = (ends(3), ends(4));
            assert_eq!((to - from).perp_dot(next - from) < 0.0, right, "{style:?} {along_y}");
        }
    }
}

#[test]
fn they_stop_when_told() {
    let mesh = part(&BezierPatch::convex());
    let profile = ball();
    for plan in [
        (|given, tick: crate::Tick<'_>| {
            ScallopRaster { finish: given, borders: Borders::On }.plan(tick)
        }) as fn(Finish<'_>, crate::Tick<'_>) -> Result<Finished, ScallopError>,
        |given, tick| ConstantScallop { finish: given }.plan(tick),
    ] {
        for after in [0, 5, 400] {
            let told = std::sync::atomic::AtomicUsize::new(0);
            let stopped = plan(finish(&mesh, &profile, 0.1), &|_| {
                told.fetch_add(1, std::sync::atomic::Ordering::Relaxed) < after
            });
            assert_eq!(stopped, Err(crate::DropError::Stopped.into()));
        }
    }
}

#[test]
fn threads_do_not_matter() {
    let mesh = noise(200, 9);
    let profile = Profile::ball(1.5).unwrap();
    let given = Finish { least_step_mm: 0.2, ..finish(&mesh, &profile, 0.05) };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| [raster(given).unwrap(), constant(given).unwrap()])
    };
    assert_eq!(on(1), on(3));
}

//! The heights of a real job against the slow truth: every vertex, every edge, every facet of the
//! surface, each by itself, by formulas other than the kernels'.
//!
//! A ball of radius R whose axis stands at a place touches the point q of the surface, at a distance
//! d ≤ R from the axis, with its tip at q.z - R + √(R² - d²); a flat cutter with its tip at q.z. The
//! tip rests at the greatest such height over the surface: over its vertices only, where points are
//! what it is dropped on. On a segment and on a triangle the height is a concave function of q, so
//! that a search by thirds finds its greatest value however it is written.

use crate::bench::{Bench, standard_offers};
use carvegraph_core::{
    Cache, CancelToken, Entry, Graph, Key, Origin, Parts, Plan, PortType, RunOptions, RunStatus,
    Session, Setting, Value, run,
};
use carvegraph_geometry::{DVec2, DVec3, HeightField, Toolpath};
use carvegraph_nodes::{LIBRARY, registry};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Heights may differ from the truth by no more, in mm.
const EXACT_MM: f64 = 1e-9;

/// Radius of the recipe's cutter, in mm.
const RADIUS_MM: f64 = 3.0;

/// A cache that finds nothing and keeps what passes by: a look at the values of a run.
#[derive(Default)]
pub(crate) struct Seen(Mutex<BTreeMap<String, Vec<Value>>>);

impl Seen {
    /// A value that the nodes of a kind made.
    pub(crate) fn of<T: Send + Sync + 'static>(&self, kind: &str) -> Arc<T> {
        let seen = self.0.lock().unwrap();
        seen[kind].iter().find_map(|value| Arc::clone(value).downcast().ok()).unwrap()
    }
}

impl Cache for Seen {
    fn look(&self, _: &Key) -> Option<Entry> {
        None
    }

    fn load(&self, _: &Key, _: &[&PortType]) -> Option<Vec<Value>> {
        None
    }

    fn store(&self, _: &Key, entry: Entry, values: &[(&PortType, Value)]) {
        let kind = entry.parts["node kind"].split(' ').next().unwrap().to_owned();
        let values = values.iter().map(|(_, value)| Value::clone(value));
        self.0.lock().unwrap().insert(kind, values.collect());
    }

    fn last_run(&self, _: &str) -> Option<BTreeMap<String, Parts>> {
        None
    }

    fn remember_run(&self, _: &str, _: &BTreeMap<String, Parts>) {}
}

/// Runs a recipe up to a node as the command does and looks at what passes between its nodes.
pub(crate) fn values_of(
    bench: &Bench,
    recipe: &str,
    settings: &[(&str, &str)],
    only: &str,
) -> Seen {
    let registry = registry(standard_offers()).unwrap();
    let origin = Origin::Folder(bench.path(""));
    let recipe = LIBRARY.open(recipe, &origin).unwrap();
    let setting = |(name, value): &(&str, &str)| Setting {
        name: (*name).to_owned(),
        value: (*value).to_owned(),
        origin: origin.clone(),
    };
    let settings: Vec<Setting> = settings.iter().map(setting).collect();
    let graph = Graph::build(&recipe, &settings, &registry, &LIBRARY).unwrap();
    let seen = Seen::default();
    let out = bench.path("out");
    let only = [only.to_owned()];
    let plan = Plan::new(&graph, &only, &out, Some(&seen), &CancelToken::default()).unwrap();
    let session = Session::new(&out);
    let report = run(&plan, &session, RunOptions { threads: 2, cache: Some(&seen), observer: &() });
    assert_eq!(report.status, RunStatus::Done);
    seen
}

/// Picks `count` of the tips of a path, the same ones each time, with no pattern to them.
pub(crate) fn sample(path: &Toolpath, count: usize) -> impl Iterator<Item = DVec3> + '_ {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    (0..count).map(move |_| {
        // Xorshift64 (Marsaglia, *Xorshift RNGs*, 2003).
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        path.tips[(state % path.tips.len() as u64) as usize]
    })
}

/// Height of the tip when a cutter whose axis stands at `at` touches `q`; -∞ beyond its radius.
type Touch = fn(q: DVec3, at: DVec2) -> f64;

fn ball(q: DVec3, at: DVec2) -> f64 {
    let square = RADIUS_MM * RADIUS_MM - q.truncate().distance_squared(at);
    if square < 0.0 { f64::NEG_INFINITY } else { q.z - RADIUS_MM + square.sqrt() }
}

fn flat(q: DVec3, at: DVec2) -> f64 {
    if q.truncate().distance(at) > RADIUS_MM { f64::NEG_INFINITY } else { q.z }
}

/// The tip's height over all vertices.
fn on_points(field: &HeightField, touch: Touch, at: DVec2) -> f64 {
    let mut best = f64::NEG_INFINITY;
    for j in 0..field.rows() {
        for i in 0..field.columns() {
            best = best.max(touch(field.point(i, j), at));
        }
    }
    best
}

/// The tip's height over all triangles.
fn on_mesh(field: &HeightField, touch: Touch, at: DVec2) -> f64 {
    let mut best = on_points(field, touch, at);
    for j in 0..field.rows() - 1 {
        for i in 0..field.columns() - 1 {
            let [a, b, c, d] =
                [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| field.point(i, j));
            // No point of the cell can hold the tip higher than its highest corner's height would
            // at the place of the cell that is nearest to the axis.
            let nearest = at.clamp(a.truncate(), c.truncate());
            let top = a.z.max(b.z).max(c.z).max(d.z);
            if touch(nearest.extend(top), at) > best {
                best = best.max(on_triangle([a, b, c], touch, at));
                best = best.max(on_triangle([a, c, d], touch, at));
            }
        }
    }
    best
}

/// The greatest height of the tip over one triangle.
fn on_triangle([a, b, c]: [DVec3; 3], touch: Touch, at: DVec2) -> f64 {
    // Lines from the corner `a` to points of the edge from `b` to `c`.
    let line = |t: f64| on_segment(a, b.lerp(c, t), touch, at);
    let (mut low, mut high) = (0.0, 1.0);
    let mut best = line(0.0).max(line(1.0));
    for _ in 0..100 {
        let third = (high - low) / 3.0;
        let (left, right) = (line(low + third), line(high - third));
        best = best.max(left).max(right);
        if left == f64::NEG_INFINITY && right == f64::NEG_INFINITY {
            // The reach of the cutter lies aside of both lines: on the side of the nearer one.
            let nearer = |t: f64| reach(a, b.lerp(c, t), at);
            if nearer(low + third) < nearer(high - third) { high -= third } else { low += third }
        } else if left < right {
            low += third;
        } else {
            high -= third;
        }
    }
    best
}

/// The greatest height of the tip over one segment.
fn on_segment(a: DVec3, b: DVec3, touch: Touch, at: DVec2) -> f64 {
    let Some((mut low, mut high)) = within_reach(a, b, at) else { return f64::NEG_INFINITY };
    let height = |t: f64| touch(a.lerp(b, t), at);
    let mut best = height(low).max(height(high));
    for _ in 0..60 {
        let third = (high - low) / 3.0;
        let (left, right) = (height(low + third), height(high - third));
        best = best.max(left).max(right);
        if left < right { low += third } else { high -= third }
    }
    best
}

/// Distance of a segment from the axis, seen from above.
fn reach(a: DVec3, b: DVec3, at: DVec2) -> f64 {
    let (a, b) = (a.truncate(), b.truncate());
    let t = (at - a).dot(b - a) / a.distance_squared(b).max(f64::MIN_POSITIVE);
    a.lerp(b, t.clamp(0.0, 1.0)).distance(at)
}

/// The part of a segment that lies in the cutter's circle.
fn within_reach(a: DVec3, b: DVec3, at: DVec2) -> Option<(f64, f64)> {
    let (from, along) = (a.truncate() - at, (b - a).truncate());
    let (p, q) = (from.dot(along), along.length_squared());
    let square = p * p - q * (from.length_squared() - RADIUS_MM * RADIUS_MM);
    if square < 0.0 {
        return None;
    }
    // A hair inside the circle, or rounding would put the ends outside of it.
    let (low, high) = ((-p - square.sqrt()) / q, (-p + square.sqrt()) / q);
    let hair = 1e-13 * (high - low);
    let (low, high) = ((low + hair).max(0.0), (high - hair).min(1.0));
    (low <= high).then_some((low, high))
}

/// Compares a random sample of the job's heights with the truth.
fn assert_exact(
    settings: &[(&str, &str)],
    size: (u32, u32),
    count: usize,
    truth: impl Fn(&HeightField, DVec2) -> f64,
) {
    let bench = Bench::new();
    bench.hills("hills.png", size);
    let seen = values_of(&bench, "relief", &[&[("image", "hills.png")], settings].concat(), "drop");
    let field: Arc<HeightField> = seen.of("z_map");
    let path: Arc<Toolpath> = seen.of("drop_cutter");
    for tip in sample(&path, count) {
        let wanted = truth(&field, tip.truncate());
        let off = tip.z - wanted;
        assert!(off.abs() <= EXACT_MM, "at {tip}: {wanted}, off by {off:e}");
    }
}

#[test]
fn the_ball_on_points_of_the_real_job_is_exact() {
    assert_exact(&[("surface", "points")], (480, 480), 300, |f, at| on_points(f, ball, at));
}

#[test]
fn the_ball_on_the_mesh_of_the_real_job_is_exact() {
    assert_exact(&[("surface", "mesh")], (480, 480), 60, |f, at| on_mesh(f, ball, at));
}

#[test]
fn the_ball_on_a_coarse_mesh_is_exact() {
    assert_exact(&[], (119, 119), 300, |f, at| on_mesh(f, ball, at));
}

#[test]
fn the_flat_cutter_on_points_of_the_real_job_is_exact() {
    let settings = [("surface", "points"), ("cutter", "flat")];
    assert_exact(&settings, (480, 480), 300, |f, at| on_points(f, flat, at));
}

#[test]
fn the_flat_cutter_on_a_coarse_mesh_is_exact() {
    let settings = [("surface", "mesh"), ("cutter", "flat")];
    assert_exact(&settings, (119, 119), 100, |f, at| on_mesh(f, flat, at));
}

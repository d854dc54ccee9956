use super::*;
use crate::profile::Segment;
use crate::{Direction, Move, MoveKind, PathArc, Plane};
use fastrand::Rng;

const GO: Tick = &|_| true;

fn line(to: DVec3) -> Move {
    Move { to, mm_per_min: 600.0, kind: MoveKind::Line }
}

fn rapid(to: DVec3) -> Move {
    Move { to, mm_per_min: f64::INFINITY, kind: MoveKind::Rapid }
}

fn motion(start: DVec3, moves: Vec<Move>) -> Motion {
    Motion { start, moves, arcs: Vec::new() }
}

fn stock(columns: usize, rows: usize, pitch_mm: f64, top_mm: f64) -> Stock {
    Stock { corner: DVec2::ZERO, grid: FieldGrid { columns, rows, pitch_mm }, top_mm }
}

fn cutters(radius: f64) -> Vec<(&'static str, Profile)> {
    let line = |r: f64, h: f64| Segment::Line { to: [r * radius, h * radius] };
    let (sin, cos) = 0.3_f64.sin_cos();
    let nose = Segment::Arc {
        to: [0.4 * radius * cos, 0.4 * radius * (1.0 - sin)],
        center: [0.0, 0.4 * radius],
    };
    let flank = line(1.0, 0.4 * (1.0 - sin) + (1.0 - 0.4 * cos) * cos / sin);
    let rim = Segment::Arc { to: [radius, 1.3 * radius], center: [0.7 * radius, 1.3 * radius] };
    let made = [
        ("ball", Profile::ball(radius)),
        ("flat", Profile::flat(radius)),
        ("bull nose", Profile::bull_nose(radius, 0.3 * radius)),
        ("cone", Profile::new(vec![line(1.0, 1.5)])),
        ("cone, flat tip", Profile::new(vec![line(0.1, 0.0), line(1.0, 0.8)])),
        ("tapered ball", Profile::new(vec![nose, flank])),
        (
            "form",
            Profile::new(vec![line(0.3, 0.1), line(0.5, 0.6), line(0.5, 1.0), line(0.7, 1.0), rim]),
        ),
    ];
    made.into_iter().map(|(name, made)| (name, made.unwrap())).collect()
}

/// What a straight move leaves over a place, by trying: many tips, and the best refined.
fn by_trial(profile: &Profile, from: DVec3, to: DVec3, place: DVec2) -> f64 {
    let left = |share: f64| {
        let tip = from.lerp(to, share);
        tip.z + profile.height(tip.truncate().distance(place))
    };
    let (mut low, mut high, mut best) = (0.0, 1.0, f64::INFINITY);
    for _ in 0..7 {
        const STEPS: usize = 60;
        let share = |k: usize| low + (high - low) * (k as f64 / STEPS as f64);
        let least = (0..=STEPS).min_by(|a, b| left(share(*a)).total_cmp(&left(share(*b)))).unwrap();
        best = best.min(left(share(least)));
        (low, high) = (share(least.saturating_sub(2)), share((least + 2).min(STEPS)));
    }
    best
}

/// What a move leaves over places within `around_mm` of one: the least and the greatest.
fn nearby(of: impl Fn(DVec2) -> f64, place: DVec2, around_mm: f64) -> (f64, f64) {
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..9 {
        let way = DVec2::from_angle(f64::from(k) * std::f64::consts::FRAC_PI_4);
        let left = of(place + if k == 8 { DVec2::ZERO } else { way * around_mm });
        range = (range.0.min(left), range.1.max(left));
    }
    range
}

/// How far a node's place may be off, in mm, beside which its height is exact to this.
const OFF_MM: f64 = 2e-6;
const EXACT_MM: f64 = 3e-6;

#[test]
fn a_move_leaves_what_many_tips_along_it_leave() {
    let mut random = Rng::with_seed(1);
    for round in 0..40 {
        let radius = 0.5 + random.f64() * 2.0;
        let mut any =
            |high: f64| DVec3::new(random.f64(), random.f64(), random.f64() * high) * 10.0;
        let (from, mut to) = (any(1.0), any(1.0));
        match round % 5 {
            0 => to.z = from.z,
            1 => (to.x, to.y) = (from.x, from.y),
            2 => to = from,
            3 => to = from + (to - from) * 0.01,
            _ => (),
        }
        for (name, profile) in cutters(radius) {
            let stock = stock(47, 51, 0.21, 8.0);
            let path = motion(from, vec![line(to)]);
            let cut = Cut { motion: &path, profile: &profile };
            let found = simulate(&stock, &[cut], GO).unwrap().surface;
            for k in 0..60 {
                let (i, j) = (random.usize(..47), k % 51);
                let node = found.point(i, j);
                let of = |place| by_trial(&profile, from, to, place).min(8.0);
                let (low, high) = nearby(of, node.truncate(), OFF_MM);
                assert!(
                    node.z >= low - EXACT_MM && node.z <= high + EXACT_MM,
                    "{name} R {radius} {from} {to}: {node}, not {low} to {high}"
                );
            }
        }
    }
}

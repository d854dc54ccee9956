use super::*;
use crate::drop_cutter::Swept;
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

/// What the drop cutter's kernels say of a stroke over a place.
fn by_drop(swept: &Swept, from: DVec3, to: DVec3, place: DVec2) -> f64 {
    let way = (to - from).truncate();
    let unit = if way.length() > 0.0 { way.normalize() } else { DVec2::X };
    let seen = |tip: DVec3| ((tip.truncate() - place).dot(unit), tip.z);
    swept.height(unit.perp_dot(from.truncate() - place), [seen(from), seen(to)])
}

#[test]
fn long_steep_and_grid_aligned_moves_are_what_the_drop_cutter_says() {
    let mut random = Rng::with_seed(2);
    for round in 0..20 {
        let radius = 0.7 + random.f64() * 2.0;
        let mut any = || DVec3::new(random.f64(), random.f64(), random.f64()) * 50.0;
        let (mut from, mut to) = (any(), any());
        match round % 4 {
            // Along a row of nodes, up or down.
            0 => (from.y, to.y) = (12.5, 12.5),
            // A wall.
            1 => to = from + DVec3::new(0.01, 0.02, -30.0 * random.f64()),
            2 => to = from + (to - from) * 0.1,
            _ => (),
        }
        for (name, profile) in cutters(radius) {
            let swept = Swept::new(&profile);
            let path = motion(from, vec![line(to)]);
            let cut = Cut { motion: &path, profile: &profile };
            let found = simulate(&stock(101, 101, 0.5, 60.0), &[cut], GO).unwrap().surface;
            for (i, j) in (0..101 * 101).map(|k| (k % 101, k / 101)) {
                let node = found.point(i, j);
                let of = |place| by_drop(&swept, from, to, place).min(60.0);
                let exact = of(node.truncate());
                if (node.z - exact).abs() > 2.0 * EXACT_MM {
                    let (low, high) = nearby(of, node.truncate(), 2.0 * OFF_MM);
                    assert!(
                        node.z >= low - 2.0 * EXACT_MM && node.z <= high + 2.0 * EXACT_MM,
                        "{name} R {radius} {from} {to}: {node}, not {exact}"
                    );
                }
            }
        }
    }
}

#[test]
fn many_moves_leave_the_lowest_of_all() {
    let mut random = Rng::with_seed(3);
    for (name, profile) in cutters(1.7) {
        let swept = Swept::new(&profile);
        let mut any = || DVec3::new(random.f64() * 30.0, random.f64() * 30.0, 2.0 + random.f64());
        let tips: Vec<DVec3> = (0..80).map(|_| any()).collect();
        let path = motion(tips[0], tips[1..].iter().copied().map(line).collect());
        let cut = Cut { motion: &path, profile: &profile };
        let found = simulate(&stock(151, 151, 0.2, 3.5), &[cut], GO).unwrap().surface;
        for k in (0..151 * 151).step_by(31) {
            let node = found.point(k % 151, k / 151);
            let of = |place| {
                let legs = tips.windows(2).map(|ends| by_drop(&swept, ends[0], ends[1], place));
                legs.fold(3.5, f64::min)
            };
            let (low, high) = nearby(of, node.truncate(), OFF_MM);
            assert!(
                node.z >= low - EXACT_MM && node.z <= high + EXACT_MM,
                "{name}: {node}, not {low} to {high}"
            );
        }
    }
}

#[test]
fn arcs_in_all_planes_are_swept_within_their_tolerance() {
    let mut random = Rng::with_seed(4);
    for plane in [Plane::Xy, Plane::Zx, Plane::Yz] {
        for direction in [Direction::Clockwise, Direction::CounterClockwise] {
            let [first, second, normal] = plane.axes();
            let center = DVec3::new(8.0, 8.0, 9.0);
            let (mut from, mut to) = (center, center);
            let angles = [random.f64() * 6.0, random.f64() * 6.0];
            for (tip, angle) in [&mut from, &mut to].into_iter().zip(angles) {
                tip[first] += 4.0 * angle.cos();
                tip[second] += 4.0 * angle.sin();
            }
            to[normal] += 1.5;
            let arc = PathArc { plane, direction, center };
            let moved = Move { to, mm_per_min: 100.0, kind: MoveKind::Arc { arc: 0 } };
            let path = Motion { start: from, moves: vec![moved], arcs: vec![arc] };
            for (name, profile) in cutters(1.5) {
                let cut = Cut { motion: &path, profile: &profile };
                let found = simulate(&stock(41, 41, 0.4, 12.0), &[cut], GO).unwrap().surface;
                for k in 0..41 {
                    let node = found.point(k, 17 * k % 41);
                    let of = |place: DVec2| along_arc(&profile, &arc, from, to, place).min(12.0);
                    // Chords are 0.1 µm off, and the tips that are tried 0.2 µm apart.
                    let (low, high) = nearby(of, node.truncate(), 2.0 * ARC_TOLERANCE_MM);
                    assert!(
                        node.z >= low - 3.0 * ARC_TOLERANCE_MM
                            && node.z <= high + 3.0 * ARC_TOLERANCE_MM,
                        "{name} {plane:?} {direction:?}: {node}, not {low} to {high}"
                    );
                }
            }
        }
    }
}

/// What an arc leaves over a place, by trying tips all along it and more around the best.
fn along_arc(profile: &Profile, arc: &PathArc, from: DVec3, to: DVec3, place: DVec2) -> f64 {
    const TIPS: usize = 3000;
    let left = |share: f64| {
        let tip = arc.point(from, to, share.clamp(0.0, 1.0));
        tip.z + profile.height(tip.truncate().distance(place))
    };
    let share = |k: usize| k as f64 / TIPS as f64;
    let best = (0..=TIPS).min_by(|a, b| left(share(*a)).total_cmp(&left(share(*b)))).unwrap();
    let finer = (-40..=40).map(|k| left(share(best) + f64::from(k) / 40.0 / TIPS as f64));
    finer.fold(f64::INFINITY, f64::min)
}

fn cut_with(profile: &Profile, path: &Motion, stock: &Stock) -> Simulation {
    simulate(stock, &[Cut { motion: path, profile }], GO).unwrap()
}

#[test]
fn a_pass_of_a_ball_leaves_a_cylinder_and_two_leave_a_scallop() {
    let (radius, step) = (3.0, 1.2);
    let ball = Profile::ball(radius).unwrap();
    let at = |x: f64, y: f64| DVec3::new(x, y, 1.0);
    let path = motion(at(-9.0, 10.0), vec![line(at(30.0, 10.0))]);
    let left = cut_with(&ball, &path, &stock(101, 201, 0.1, 9.0)).surface;
    for j in 0..201 {
        let away = left.point(50, j).y - 10.0;
        let round = 1.0 + radius - (radius * radius - away * away).max(0.0).sqrt();
        let height = if away.abs() <= radius { round } else { 9.0 };
        assert!((left.height(50, j) - height).abs() < 1e-5 || away.abs() > 2.999, "{away}");
    }
    let moves =
        vec![line(at(30.0, 10.0)), line(at(30.0, 10.0 + step)), line(at(-9.0, 10.0 + step))];
    let left = cut_with(&ball, &motion(at(-9.0, 10.0), moves), &stock(101, 201, 0.1, 9.0)).surface;
    let scallop = radius - (radius * radius - step * step / 4.0).sqrt();
    assert!((left.height(50, 106) - 1.0 - scallop).abs() < 1e-6);
}

#[test]
fn a_rapid_through_stock_is_found_and_one_above_is_not() {
    let flat = Profile::flat(1.0).unwrap();
    let at = |x: f64, z: f64| DVec3::new(x, 5.0, z);
    let block = stock(101, 101, 0.1, 4.0);
    let run = |moves: Vec<Move>| cut_with(&flat, &motion(at(-3.0, 20.0), moves), &block).rapids;
    assert_eq!(run(vec![rapid(at(-3.0, 4.0)), rapid(at(12.0, 4.0))]), []);
    let found = run(vec![rapid(at(-3.0, 3.25)), rapid(at(12.0, 3.25))]);
    assert_eq!((found.len(), found[0].cut, found[0].index), (1, 0, 1));
    assert_eq!((found[0].depth_mm, found[0].at.z), (0.75, 3.25));
    // After a feed has cleared the way it is none.
    let slot = vec![rapid(at(-3.0, 3.0)), line(at(12.0, 3.0)), rapid(at(-3.0, 3.0))];
    assert_eq!(run(slot), []);
    // Straight down into it.
    let found = run(vec![rapid(at(5.0, 20.0)), rapid(at(5.0, 1.5)), rapid(at(5.0, 20.0))]);
    assert_eq!((found.len(), found[0].index, found[0].depth_mm), (1, 1, 2.5));
    // What rounding leaves is no stock.
    let slot = vec![rapid(at(-3.0, 3.0)), line(at(12.0, 3.0)), rapid(at(-3.0, 2.9995))];
    assert_eq!(run(slot), []);
}

#[test]
fn cuts_follow_each_other_in_time() {
    let flat = Profile::flat(1.0).unwrap();
    let at = |x: f64, z: f64| DVec3::new(x, 5.0, z);
    let feed = motion(at(-3.0, 3.0), vec![line(at(12.0, 3.0))]);
    let fast = motion(at(-3.0, 3.0), vec![rapid(at(12.0, 3.0))]);
    let cut = |motion| Cut { motion, profile: &flat };
    let run = |cuts: &[Cut<'_>]| simulate(&stock(101, 101, 0.1, 4.0), cuts, GO).unwrap();
    let (good, bad) = (run(&[cut(&feed), cut(&fast)]), run(&[cut(&fast), cut(&feed)]));
    assert_eq!(good.surface, bad.surface);
    assert_eq!((good.rapids.len(), bad.rapids.len()), (0, 1));
    assert_eq!((bad.rapids[0].cut, bad.rapids[0].index), (0, 0));
    assert_eq!(good.loads[0].step_down.unwrap().depth_mm, 1.0);
    assert_eq!((bad.loads[1].step_down, bad.loads[1].removal), (None, None));
}

#[test]
fn a_slot_of_short_moves_has_the_step_down_and_the_removal_of_a_long_one() {
    // Between two rows of nodes, so that as many lie in the slot as it is wide.
    let at = |x: f64| DVec3::new(x, 10.05, 2.0);
    for (radius, profile) in [(3.0, Profile::flat(3.0)), (2.0, Profile::flat(2.0))] {
        let moves = (0..400).map(|k| line(at(-10.0 + f64::from(k + 1) * 0.1))).collect();
        let made =
            cut_with(&profile.unwrap(), &motion(at(-10.0), moves), &stock(201, 201, 0.1, 7.0));
        let load = made.loads[0];
        assert_eq!(load.step_down.unwrap().depth_mm, 5.0);
        let removal = load.removal.unwrap();
        let section = 2.0 * radius * 5.0;
        assert!((removal.section_mm2 / section - 1.0).abs() < 0.06, "{removal:?} {section}");
        assert!((removal.mm3_per_min / (600.0 * section) - 1.0).abs() < 0.06, "{removal:?}");
        assert!((load.removed_mm3 / (20.0 * section) - 1.0).abs() < 0.03, "{load:?}");
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mut random = Rng::with_seed(5);
    let mut any = || DVec3::new(random.f64() * 60.0, random.f64() * 40.0, random.f64() * 6.0);
    let moves = (0..3000).map(|k| if k % 50 == 0 { rapid(any()) } else { line(any()) }).collect();
    let path = motion(DVec3::ZERO, moves);
    for (_, profile) in cutters(2.0).into_iter().take(3) {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| cut_with(&profile, &path, &stock(301, 201, 0.2, 5.0)))
        };
        assert_eq!(run(1), run(3));
    }
}

#[test]
fn bad_input_is_refused_and_it_stops_when_told() {
    let ball = Profile::ball(1.0).unwrap();
    let block = stock(20, 20, 1.0, 4.0);
    let path = motion(DVec3::ZERO, vec![line(DVec3::X); 3]);
    let run = |stock: &Stock, path: &Motion, tick: Tick| {
        simulate(stock, &[Cut { motion: path, profile: &ball }], tick)
    };
    assert_eq!(run(&block, &path, &|_| false), Err(SimulateError::Stopped));
    let none = motion(DVec3::ZERO, vec![line(DVec3::X), line(DVec3::new(0.0, f64::NAN, 0.0))]);
    assert!(matches!(run(&block, &none, GO), Err(SimulateError::TooFar { index: 1, .. })));
    let arc = Move { kind: MoveKind::Arc { arc: 2 }, ..line(DVec3::X) };
    let missing = run(&block, &motion(DVec3::ZERO, vec![arc]), GO);
    assert_eq!(missing, Err(SimulateError::NoSuchArc { cut: 0, index: 0, arc: 2, arcs: 0 }));
    for bad in [stock(1, 20, 1.0, 4.0), stock(20, 20, 0.0, 4.0), stock(20, 20, 1.0, f64::NAN)] {
        assert!(matches!(run(&bad, &path, GO), Err(SimulateError::BadStock(_))));
    }
    let done = std::sync::atomic::AtomicUsize::new(0);
    let count = |moves| {
        done.fetch_add(moves, std::sync::atomic::Ordering::Relaxed);
        true
    };
    run(&block, &path, &count).unwrap();
    assert_eq!(done.into_inner(), 3);
}

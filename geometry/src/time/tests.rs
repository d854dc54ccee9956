//! The planner held against closed forms and against a machine that is run in small steps of time.

use super::*;
use crate::{Direction, PathArc, Plane};
use std::f64::consts::{PI, TAU};

const PLAIN: Kinematics = Kinematics {
    feed_mm_per_min: [6000.0; 3],
    rapid_mm_per_min: [6000.0; 3],
    acceleration_mm_per_s2: [200.0; 3],
    junction_deviation_mm: 0.01,
    look_ahead: 15,
    lines_per_s: f64::INFINITY,
};

fn fed(points: &[DVec3], mm_per_min: f64) -> Motion {
    let moves = points[1..].iter().map(|to| Move { to: *to, mm_per_min, kind: MoveKind::Line });
    Motion { start: points[0], moves: moves.collect(), arcs: vec![] }
}

fn time(motion: &Motion, kinematics: &Kinematics) -> Times {
    machining_time(motion, kinematics, &|_| true).unwrap()
}

#[track_caller]
fn assert_close(found: f64, expected: f64, share: f64) {
    assert!((found - expected).abs() <= share * expected.abs(), "{found} and not {expected}");
}

#[test]
fn one_straight_move_is_a_trapezoid_or_a_triangle() {
    // 50 mm/s are reached after 6.25 mm.
    for length in [0.01, 1.0, 12.0, 12.5, 13.0, 400.0] {
        let to = DVec3::new(0.6, 0.8, 0.0) * length;
        // X comes to its limit first: 200 / 0.8 along the way.
        let (speed, acceleration) = (50.0, 250.0);
        let ramp = speed * speed / acceleration;
        let expected = match length < ramp {
            true => 2.0 * f64::sqrt(length / acceleration),
            false => 2.0 * speed / acceleration + (length - ramp) / speed,
        };
        let times = time(&fed(&[DVec3::ZERO, to], 3000.0), &PLAIN);
        assert_close(times.total_s(), expected, 1e-12);
        assert_close(times.asked_s, length / speed, 1e-12);
        assert_close(times.asked_s + times.accelerating_s, expected, 1e-12);
        assert_eq!((times.slow_axes_s, times.waiting_s, times.rapid_s), (0.0, 0.0, 0.0));
        assert_close(times.mean_feed_mm_per_min(), length / expected * 60.0, 1e-12);
    }
}

#[test]
fn each_axis_keeps_to_its_own_speed() {
    let feed_mm_per_min = [6000.0, 3000.0, 300.0];
    let acceleration_mm_per_s2 = [f64::INFINITY; 3];
    let slow = Kinematics { feed_mm_per_min, acceleration_mm_per_s2, ..PLAIN };
    let along = |to| time(&fed(&[DVec3::ZERO, to], 4500.0), &slow);
    assert_close(along(DVec3::new(75.0, 0.0, 0.0)).total_s(), 1.0, 1e-12);
    let (asked, slower) = (5.0 / 75.0, 4.0 / 50.0);
    let times = along(DVec3::new(3.0, 4.0, 0.0));
    assert_close(times.asked_s, asked, 1e-12);
    assert_close(times.slow_axes_s, slower - asked, 1e-12);
    assert_close(along(DVec3::new(3.0, 0.0, -4.0)).total_s(), 4.0 / 5.0, 1e-12);
    let plunge = along(DVec3::new(0.0, 0.0, -5.0));
    assert_close(plunge.plunge_s, 1.0, 1e-12);
    assert_eq!(plunge.plunge_s, plunge.cutting_s);
    // A rapid asks for what the machine can do, whatever the path thought of it.
    let mut rapid = fed(&[DVec3::ZERO, DVec3::new(100.0, 100.0, 0.0)], f64::NAN);
    rapid.moves[0].kind = MoveKind::Rapid;
    let times = time(&rapid, &slow);
    assert_close(times.rapid_s, 1.0, 1e-12);
    assert_eq!((times.slow_axes_s, times.feed_length_mm), (0.0, 0.0));
}

#[test]
fn infinite_acceleration_gives_length_by_speed() {
    let acceleration_mm_per_s2 = [f64::INFINITY; 3];
    for look_ahead in [1, 2, 15, 1000] {
        let kinematics = Kinematics { acceleration_mm_per_s2, look_ahead, ..PLAIN };
        for path in paths() {
            let times = time(&path, &kinematics);
            assert_close(times.total_s(), times.asked_s, 1e-12);
            let length: f64 = path.legs().map(|(from, m)| path.leg_length_mm(from, m)).sum();
            // Chords of 2 µm are a little shorter than their arc.
            assert_close(times.total_s(), length / 50.0, 1e-4);
        }
    }
}

#[test]
fn a_corner_is_taken_at_the_speed_of_the_junction_deviation() {
    // Long sides at a right angle: sin(θ/2) is √½.
    let (far, acceleration, deviation) = (100.0, 200.0, 0.05);
    let points = [DVec3::ZERO, DVec3::X * far, DVec3::new(far, far, 0.0)];
    let kinematics = Kinematics { junction_deviation_mm: deviation, ..PLAIN };
    let half = 0.5_f64.sqrt();
    // Both axes share the change of direction, so together they can do √2 of either.
    let corner = (acceleration / half * deviation * half / (1.0 - half)).sqrt();
    let side = |speed: f64, corner: f64| {
        let ramps = (2.0 * speed * speed - corner * corner) / (2.0 * acceleration);
        (2.0 * speed - corner) / acceleration + (far - ramps) / speed
    };
    let found = time(&fed(&points, 3000.0), &kinematics).total_s();
    assert_close(found, 2.0 * side(50.0, corner), 1e-12);
    // Turning back is a stop.
    let back = [DVec3::ZERO, DVec3::X * far, DVec3::ZERO];
    assert_close(time(&fed(&back, 3000.0), &kinematics).total_s(), 2.0 * side(50.0, 0.0), 1e-12);
    // Straight on is no corner at all.
    let on = [DVec3::ZERO, DVec3::X * far, DVec3::X * 2.0 * far];
    let once = [DVec3::ZERO, DVec3::X * 2.0 * far];
    let [pieces, whole] =
        [&on[..], &once[..]].map(|p| time(&fed(p, 3000.0), &kinematics).total_s());
    assert_close(pieces, whole, 1e-12);
}

#[test]
fn short_blocks_go_no_faster_than_the_buffer_is_long() {
    // A straight line in pieces of 0.1 mm: in the middle the machine never has more than 15 of them ahead.
    let pieces = 20_000;
    let points: Vec<DVec3> = (0..=pieces).map(|k| DVec3::X * (0.1 * f64::from(k))).collect();
    let speeds = [2, 15, 60].map(|look_ahead| {
        let times = time(&fed(&points, 6000.0), &Kinematics { look_ahead, ..PLAIN });
        times.mean_feed_mm_per_min() / 60.0
    });
    for (look_ahead, speed) in [2.0, 15.0, 60.0].into_iter().zip(speeds) {
        // It enters a block at most at the speed that it can lose over all that it sees of the others then,
        // and gathers something on it.
        let slowest = f64::sqrt(2.0 * 200.0 * 0.1 * (look_ahead - 1.0));
        let fastest = f64::sqrt(2.0 * 200.0 * 0.1 * look_ahead);
        assert!(speed > 0.99 * slowest && speed < fastest, "{look_ahead}: {speed}");
    }
}

/// Dense paths, fed at 50 mm/s: waves, circles, zigzags, random ways, and one with arcs.
fn paths() -> Vec<Motion> {
    let fed = |points: Vec<DVec3>| fed(&points, 3000.0);
    let wave = |step: f64, amplitude: f64, length: f64| {
        let point = |k: usize| {
            let x = step * k as f64;
            DVec3::new(x, 0.0, amplitude * (TAU * x / length).sin())
        };
        (0..900).map(point).collect::<Vec<_>>()
    };
    let turn = |radius: f64, count: usize| {
        let angle = |k: usize| TAU * k as f64 / count as f64;
        let point = |k: usize| DVec3::new(radius * angle(k).cos(), radius * angle(k).sin(), -1.0);
        (0..3 * count).map(point).collect::<Vec<_>>()
    };
    let zigzag = (0..60).flat_map(|row| {
        let across = move |k: i32| if row % 2 == 0 { k } else { 12 - k };
        (0..=12).map(move |k| DVec3::new(0.25 * f64::from(across(k)), 0.3 * f64::from(row), 0.0))
    });
    let mut rng = fastrand::Rng::with_seed(7);
    let mut walk = |most: f64| {
        let mut at = DVec3::ZERO;
        let mut angle: f64 = 0.0;
        let mut step = || {
            angle += (rng.f64() - 0.5) * 2.0;
            let length = 0.02 + rng.f64() * most;
            at += DVec3::new(angle.cos(), angle.sin(), 0.4 * (rng.f64() - 0.5)) * length;
            at
        };
        (0..700).map(|_| step()).collect::<Vec<_>>()
    };
    let (fine, coarse) = (walk(0.2), walk(3.0));
    let all = [wave(0.1, 0.5, 3.0), wave(0.3, 2.0, 20.0), turn(2.0, 60), turn(30.0, 700)];
    let all = all.into_iter().chain([zigzag.collect(), fine, coarse]);
    all.map(fed).chain([with_arcs()]).collect()
}

/// A line, a half turn, a line back.
fn with_arcs() -> Motion {
    let center = DVec3::new(10.0, 3.0, 0.0);
    let turn = PathArc { plane: Plane::Xy, direction: Direction::CounterClockwise, center };
    let moved = |x, y, kind| Move { to: DVec3::new(x, y, 0.0), mm_per_min: 3000.0, kind };
    let moves = vec![
        moved(10.0, 0.0, MoveKind::Line),
        moved(10.0, 6.0, MoveKind::Arc { arc: 0 }),
        moved(0.0, 6.0, MoveKind::Line),
    ];
    Motion { start: DVec3::ZERO, moves, arcs: vec![turn] }
}

/// A block as the machine below sees it.
struct Piece {
    length: f64,
    nominal: f64,
    acceleration: f64,
    most_entry2: f64,
    entry2: f64,
}

/// The pieces of a motion, by the rules as they are written down; arcs as chords within 2 µm.
fn cut_up(motion: &Motion, k: &Kinematics) -> Vec<Piece> {
    let mut points = vec![(motion.start, 0.0)];
    for (from, moved) in motion.legs() {
        match motion.arc(moved) {
            Some(arc) => {
                points.extend(arc.chords(from, moved.to, 0.002).map(|to| (to, moved.mm_per_min)))
            }
            None => points.push((moved.to, moved.mm_per_min)),
        }
    }
    let along = |unit: DVec3, limits: [f64; 3]| {
        (0..3).map(|i| limits[i] / unit[i].abs().max(1e-30)).fold(1e30, f64::min)
    };
    let mut pieces: Vec<Piece> = vec![];
    let mut before: Option<(DVec3, f64)> = None;
    for pair in points.windows(2) {
        let ((from, _), (to, feed)) = (pair[0], pair[1]);
        let unit = (to - from).normalize();
        let nominal = (feed / 60.0).min(along(unit, k.feed_mm_per_min) / 60.0);
        let most_entry2 = before.map_or(0.0, |(other, speed)| {
            let theta = PI - other.angle_between(unit);
            let change = unit - other;
            let pull = match change.length() > 1e-9 {
                true => along(change.normalize(), k.acceleration_mm_per_s2),
                false => 1e30,
            };
            let sin = (theta / 2.0).sin();
            let corner = match theta < PI - 1.5e-3 {
                true => pull * k.junction_deviation_mm * sin / (1.0 - sin),
                false => 1e30,
            };
            corner.min(speed.min(nominal).powi(2))
        });
        let acceleration = along(unit, k.acceleration_mm_per_s2);
        let length = from.distance(to);
        pieces.push(Piece { length, nominal, acceleration, most_entry2, entry2: 0.0 });
        before = Some((unit, nominal));
    }
    pieces
}

/// Runs a machine in steps of 20 µs: a ring of blocks, planned anew backward and forward each time a block
/// comes in, the speed always the greatest from which the planned exit can still be reached.
fn simulated_s(motion: &Motion, k: &Kinematics) -> f64 {
    const STEP_S: f64 = 2e-5;
    let mut coming = cut_up(motion, k).into_iter();
    let mut ring: VecDeque<Piece> = VecDeque::new();
    let (mut clock, mut speed, mut gone) = (0.0, 0.0_f64, 0.0);
    loop {
        while ring.len() < k.look_ahead
            && let Some(piece) = coming.next()
        {
            ring.push_back(piece);
            plan(&mut ring, speed);
        }
        let Some(now) = ring.front() else { return clock };
        let exit2 = ring.get(1).map_or(0.0, |next| next.entry2);
        let left = (now.length - gone).max(0.0);
        let brake = (exit2 + 2.0 * now.acceleration * left).sqrt();
        let next = (speed + now.acceleration * STEP_S).min(now.nominal).min(brake);
        let mean = ((speed + next) / 2.0).max(1e-4);
        if mean * STEP_S >= left {
            clock += left / mean;
            (gone, speed) = (0.0, next.min(exit2.sqrt()));
            ring.pop_front();
        } else {
            gone += mean * STEP_S;
            speed = next;
            clock += STEP_S;
        }
    }
}

fn plan(ring: &mut VecDeque<Piece>, speed: f64) {
    let mut exit2 = 0.0;
    for piece in ring.iter_mut().skip(1).rev() {
        piece.entry2 = piece.most_entry2.min(exit2 + 2.0 * piece.acceleration * piece.length);
        exit2 = piece.entry2;
    }
    let mut entry2 = speed * speed;
    for index in 1..ring.len() {
        let before = &ring[index - 1];
        let most = entry2 + 2.0 * before.acceleration * before.length;
        ring[index].entry2 = ring[index].entry2.min(most);
        entry2 = ring[index].entry2;
    }
}

#[test]
fn a_machine_run_in_small_steps_takes_as_long() {
    let uneven = Kinematics {
        feed_mm_per_min: [2800.0, 1500.0, 400.0],
        acceleration_mm_per_s2: [500.0, 300.0, 40.0],
        junction_deviation_mm: 0.02,
        ..PLAIN
    };
    let near = Kinematics { look_ahead: 3, acceleration_mm_per_s2: [1200.0; 3], ..PLAIN };
    let far = Kinematics { look_ahead: 100, junction_deviation_mm: 0.1, ..PLAIN };
    for (machine, kinematics) in [PLAIN, uneven, near, far].iter().enumerate() {
        for (path, motion) in paths().iter().enumerate() {
            let (found, run) =
                (time(motion, kinematics).total_s(), simulated_s(motion, kinematics));
            let off = (found / run - 1.0).abs();
            assert!(off < 0.002, "machine {machine}, path {path}: {found} s and {run} s");
        }
    }
}

#[test]
fn more_acceleration_or_look_ahead_is_never_slower() {
    for path in paths() {
        let mut last = f64::INFINITY;
        for acceleration in [20.0, 21.0, 60.0, 200.0, 700.0, 9000.0, f64::INFINITY] {
            let acceleration_mm_per_s2 = [acceleration, 0.7 * acceleration, 0.3 * acceleration];
            let found = time(&path, &Kinematics { acceleration_mm_per_s2, ..PLAIN }).total_s();
            assert!(found <= last * (1.0 + 1e-12), "{acceleration}: {found} s, before {last} s");
            last = found;
        }
        let mut last = f64::INFINITY;
        for look_ahead in [1, 2, 3, 8, 15, 16, 100, 5000] {
            let found = time(&path, &Kinematics { look_ahead, ..PLAIN }).total_s();
            assert!(found <= last * (1.0 + 1e-12), "{look_ahead}: {found} s, before {last} s");
            last = found;
        }
    }
}

#[test]
fn the_parts_add_up() {
    let slow = Kinematics { lines_per_s: 90.0, feed_mm_per_min: [2000.0, 900.0, 300.0], ..PLAIN };
    for path in paths() {
        let times = time(&path, &slow);
        let why = times.asked_s + times.slow_axes_s + times.accelerating_s + times.waiting_s;
        assert_close(times.total_s(), why, 1e-12);
    }
}

#[test]
fn lines_that_come_slowly_are_waited_for() {
    let points: Vec<DVec3> = (0..=1000).map(|k| DVec3::X * (0.1 * f64::from(k))).collect();
    let path = fed(&points, 3000.0);
    let swift = Kinematics { acceleration_mm_per_s2: [f64::INFINITY; 3], ..PLAIN };
    let at = |lines_per_s| time(&path, &Kinematics { lines_per_s, ..swift });
    // 50 mm/s are 500 lines a second.
    assert_close(at(f64::INFINITY).total_s(), 2.0, 1e-9);
    assert_close(at(f64::INFINITY).most_lines_per_s, 500.0, 1e-9);
    assert_close(at(100.0).total_s(), 10.0, 0.001);
    assert_close(at(100.0).most_lines_per_s, 100.0, 1e-6);
    assert!(at(1000.0).waiting_s < 0.002, "the first line only");
    // A long move lets the buffer fill up, so that some short ones behind it come at once.
    let mut ends = vec![DVec3::ZERO, DVec3::X * 100.0];
    ends.extend((1..15).map(|k| DVec3::X * (100.0 + 0.1 * f64::from(k))));
    let burst = time(&fed(&ends, 3000.0), &Kinematics { lines_per_s: 10.0, ..swift });
    assert_close(burst.waiting_s, 0.1, 1e-9);
    // An arc is one line, however many chords it has.
    let arcs = time(&with_arcs(), &Kinematics { lines_per_s: 10.0, ..swift });
    assert!(arcs.blocks > 40 && arcs.waiting_s < 0.101, "{arcs:?}");
}

#[test]
fn nothing_takes_no_time() {
    let nowhere = DVec3::new(1.0, 2.0, 3.0);
    for points in [&[nowhere][..], &[nowhere; 4][..]] {
        assert_eq!(time(&fed(points, 600.0), &PLAIN), Times::default());
    }
    let [a, b] = [DVec3::ZERO, DVec3::X];
    let [with, without] = [&[a, a, b, b, b][..], &[a, b][..]].map(|p| time(&fed(p, 600.0), &PLAIN));
    assert_eq!(with, without);
}

#[test]
fn what_no_machine_can_do_is_told() {
    let fault = |path: &Motion| machining_time(path, &PLAIN, &|_| true).unwrap_err().to_string();
    let mut path = fed(&[DVec3::ZERO, DVec3::X, DVec3::Y], 600.0);
    path.moves[1].to.z = f64::NAN;
    let told = "move 1 leads to (0, 1, NaN) mm at 600 mm/min, which no machine can do";
    assert_eq!(fault(&path), told);
    for speed in [0.0, -3.0, f64::NAN] {
        assert!(fault(&fed(&[DVec3::ZERO, DVec3::X], speed)).contains("move 0 leads to"));
    }
    assert!(fault(&fed(&[DVec3::ZERO, DVec3::splat(1e200)], 600.0)).contains("move 0"));
    let mut arc = with_arcs();
    arc.arcs[0].center.x = f64::INFINITY;
    assert!(fault(&arc).contains("move 1"));
    let limits = [
        Kinematics { acceleration_mm_per_s2: [1.0, 0.0, 1.0], ..PLAIN },
        Kinematics { junction_deviation_mm: f64::NAN, ..PLAIN },
        Kinematics { look_ahead: 0, ..PLAIN },
        Kinematics { lines_per_s: -1.0, ..PLAIN },
    ];
    let told = limits.map(|k| machining_time(&path, &k, &|_| true).unwrap_err().to_string());
    assert_eq!(told[0], "an acceleration is 0; it must be above 0");
    assert_eq!(told[1], "the junction deviation is NaN; it must be above 0");
    assert_eq!(told[2], "the number of blocks seen ahead is 0; it must be above 0");
    assert_eq!(told[3], "the number of lines a second is -1; it must be above 0");
}

#[test]
fn it_stops_when_told_to() {
    let points: Vec<DVec3> = (0..20_000).map(|k| DVec3::X * f64::from(k)).collect();
    let stopped = machining_time(&fed(&points, 600.0), &PLAIN, &|_| false);
    assert_eq!(stopped, Err(TimeError::Stopped));
    let told = std::sync::atomic::AtomicUsize::new(0);
    let count = |moves| {
        told.fetch_add(moves, std::sync::atomic::Ordering::Relaxed);
        true
    };
    machining_time(&fed(&points, 600.0), &PLAIN, &count).unwrap();
    assert_eq!(told.into_inner(), 19_999);
}

//! Programs with arcs, as LinuxCNC's interpreter understands them: every move ends where it is meant
//! to, and what the machine does stays within the tolerance of the path that was reduced.
//!
//! Without `rs274` (Debian's package `linuxcnc-uspace`) or the pictures the tests say so and pass.

use crate::bench::{Bench, QUICK, data};
use crate::gcode::read;
use crate::real_pictures::interpret;
use carvegraph_geometry::{
    Contact, DVec3, Direction, Feeds, Motion, Move, MoveKind, PathArc, Plane, Span, SpanKind,
    Toolpath, fit_arcs, link_passes,
};
use carvegraph_sdk::conformance::dialect::Job;
use carvegraph_sdk::{Arc, Units};
use std::collections::{BTreeMap, BTreeSet};

/// Dialects whose words the interpreter knows all.
const READABLE: [&str; 5] = ["fluidnc", "grbl", "iso6983", "linuxcnc", "mach3"];

/// A step of a program in mm; points are rounded to it, the interpreter prints tenths of it.
const STEP_MM: f64 = 0.001;

/// By how many steps rounding takes an arc out of place, half a step of a point included.
const ARC_STEPS: f64 = 3.3;

const TOOLS: &str = "T1 P1 Z0\n";

/// The moves that the interpreter prints, from where X, Y and Z are 0.
fn canonical(text: &str) -> Motion {
    let mut motion = Motion { start: DVec3::ZERO, moves: Vec::new(), arcs: Vec::new() };
    let (mut plane, mut unit_mm) = (Plane::Xy, 1.0);
    for line in text.lines() {
        let call = line.split_once("..... ").map_or("", |c| c.1);
        let (name, rest) = call.split_once('(').unwrap_or((call, ""));
        let texts: Vec<&str> = rest.trim_end_matches(')').split(", ").collect();
        let value = |k: usize| texts[k].parse::<f64>().unwrap() * unit_mm;
        let (to, kind) = match (name, texts[0]) {
            ("USE_LENGTH_UNITS", "CANON_UNITS_MM") => {
                unit_mm = 1.0;
                continue;
            }
            ("USE_LENGTH_UNITS", _) => {
                unit_mm = 25.4;
                continue;
            }
            ("SELECT_PLANE", named) => {
                plane = match named {
                    "CANON_PLANE_XY" => Plane::Xy,
                    "CANON_PLANE_XZ" => Plane::Zx,
                    "CANON_PLANE_YZ" => Plane::Yz,
                    _ => panic!("{line}"),
                };
                continue;
            }
            ("STRAIGHT_TRAVERSE", _) => (DVec3::new(value(0), value(1), value(2)), MoveKind::Rapid),
            ("STRAIGHT_FEED", _) => (DVec3::new(value(0), value(1), value(2)), MoveKind::Line),
            ("ARC_FEED", _) => {
                let direction = match texts[4] {
                    "1" => Direction::CounterClockwise,
                    "-1" => Direction::Clockwise,
                    _ => panic!("{line}"),
                };
                let [first, second, normal] = plane.axes();
                let (mut to, mut center) = (DVec3::ZERO, DVec3::ZERO);
                (to[first], to[second], to[normal]) = (value(0), value(1), value(5));
                (center[first], center[second]) = (value(2), value(3));
                motion.arcs.push(PathArc { plane, direction, center });
                (to, MoveKind::Arc { arc: motion.arcs.len() as u32 - 1 })
            }
            _ => continue,
        };
        motion.moves.push(Move { to, mm_per_min: 0.0, kind });
    }
    motion
}

/// A path of a pass for each list of points, not joined.
fn path_of(spans: &[Vec<DVec3>]) -> Toolpath {
    let mut path = Toolpath::default();
    for tips in spans {
        let start = path.tips.len();
        path.tips.extend(tips);
        let points = start..path.tips.len();
        path.spans.push(Span { points, kind: SpanKind::Pass, joined: false });
    }
    path.contacts = vec![Contact::NONE; path.tips.len()];
    path
}

/// Passes along X and Y over hills, fine and coarse, and level rings, this way and that.
fn passes() -> Vec<Vec<DVec3>> {
    (0..36_u32)
        .map(|k| {
            let (turn, size) = (f64::from(k), 1.0 + f64::from(k % 7));
            let step = [0.05, 0.3, 1.0][k as usize % 3];
            let mut tips: Vec<DVec3> = (0..80)
                .map(|i| f64::from(i) * step)
                .map(|way| {
                    let hills = (way / size + turn).sin() * size * 0.7 + 0.003 * (way * 90.0).sin();
                    let ring = way / step * 0.075;
                    match k % 4 {
                        0 => DVec3::new(way, turn, hills),
                        1 => DVec3::new(turn, way - 3.0, hills),
                        2 => DVec3::new(-way, 0.3 * turn, -hills),
                        _ => DVec3::new(4.0 * size * ring.cos(), 3.0 * size * ring.sin(), -turn),
                    }
                })
                .collect();
            if k % 8 > 3 {
                tips.reverse();
            }
            tips
        })
        .collect()
}

/// A path as a job for a dialect.
fn job_of(path: &Toolpath, units: Units) -> Job {
    let mut job = Job { units, ..Job::at(0.0, 0.0) };
    for span in &path.spans {
        for index in span.points.clone() {
            let (to, mm_per_min) = (path.tips[index].to_array(), 500.0);
            let arc = path.arcs.binary_search_by_key(&index, |(end, _)| *end);
            match (span.kind, arc.map(|at| path.arcs[at].1)) {
                (SpanKind::Rapid, _) => job.rapid(to),
                (_, Ok(PathArc { plane, direction, center })) => {
                    job.arc(Arc { plane, direction, center: center.to_array(), to, mm_per_min });
                }
                (_, Err(_)) => job.feed(to, mm_per_min),
            }
        }
    }
    job
}

#[test]
fn the_interpreter_follows_fitted_paths_of_every_plane() {
    let feeds = Feeds { cut_mm_per_min: 500.0, plunge_mm_per_min: 500.0, rapid_mm_per_min: 500.0 };
    let full = path_of(&passes());
    let dialects = carvegraph_dialects::standard();
    for (name, units) in
        READABLE.map(|name| (name, Units::Mm)).into_iter().chain([("linuxcnc", Units::Inch)])
    {
        let (reduced, _) = fit_arcs(&full, 0.01, 0.005, &|_| true).unwrap();
        let path = link_passes(&reduced, 30.0, feeds).unwrap();
        assert!(path.arcs.len() > 200, "{}", path.arcs.len());
        let dialect = dialects.iter().find(|dialect| dialect.name() == name).unwrap();
        let program = job_of(&path, units).post(&**dialect).unwrap();
        let bench = Bench::new();
        bench.write("program.ngc", program);
        let Some(read) = interpret(&bench, "program.ngc", TOOLS) else { return };
        let step_mm = if units == Units::Inch { 2.54 * STEP_MM } else { STEP_MM };
        let motion = canonical(&read);
        let cuts = |kind: SpanKind| kind != SpanKind::Rapid;
        let meant: Vec<usize> = path
            .spans
            .iter()
            .filter(|span| cuts(span.kind))
            .flat_map(|span| span.points.clone())
            // A pass begins where its plunge has ended.
            .filter(|&k| path.tips[k] != path.tips[k - 1])
            .collect();
        let made: Vec<(DVec3, &Move)> =
            motion.legs().filter(|(_, made)| made.kind != MoveKind::Rapid).collect();
        assert_eq!(made.len(), meant.len(), "{name}");
        let mut arcs = 0;
        for (&end, (from, made)) in meant.iter().zip(made) {
            let off = made.to.distance(path.tips[end]);
            assert!(off < 0.9 * step_mm, "{name}: {off} at {:?}", path.tips[end]);
            let Some(arc) = motion.arc(made) else { continue };
            arcs += 1;
            let at = path.arcs.binary_search_by_key(&end, |(end, _)| *end).unwrap();
            let start = path.tips[end - 1];
            for share in [0.25, 0.5, 0.75] {
                let meant = path.arcs[at].1.point(start, path.tips[end], share);
                let off = arc.point(from, made.to, share).distance(meant);
                assert!(off < ARC_STEPS * step_mm, "{name}: {off} at {meant}");
            }
        }
        // In inches the flattest are lines: they bulge by less than two steps.
        let least = if units == Units::Inch { path.arcs.len() / 2 } else { path.arcs.len() };
        assert!(arcs >= least, "{name}: {arcs} of {}", path.arcs.len());
    }
}

/// The points of passes along X, by what was written for Y, each towards greater X.
type Rows = BTreeMap<i64, Vec<DVec3>>;

fn row_of(tip: DVec3) -> i64 {
    (tip.y / STEP_MM).round() as i64
}

/// Without the points between two passes, which have rows of their own.
fn towards_x(mut rows: Rows) -> Rows {
    for row in rows.values_mut() {
        row.sort_by(|a, b| a.x.total_cmp(&b.x));
        row.dedup_by(|a, b| a.x == b.x);
    }
    rows.retain(|_, row| row.len() > 1);
    rows
}

/// How far a place is from a row, and whether it lies below it.
fn off(row: &[DVec3], place: DVec3) -> (f64, bool) {
    let first = row.partition_point(|tip| tip.x < place.x - 0.05).saturating_sub(1);
    let end = (row.partition_point(|tip| tip.x < place.x + 0.05) + 1).min(row.len());
    let legs = row[first..end].windows(2).map(|leg| (leg[0], leg[1]));
    let distance = |(a, b): (DVec3, DVec3)| {
        let t = ((place - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        place.distance(a.lerp(b, t))
    };
    let over = legs.clone().find(|(a, b)| a.x <= place.x && place.x <= b.x);
    let below =
        over.is_some_and(|(a, b)| place.z < a.z + (b.z - a.z) * (place.x - a.x) / (b.x - a.x));
    (legs.map(distance).fold(f64::INFINITY, f64::min), below)
}

/// Carves a picture with arcs, reads the program, and holds what the machine does against the full path.
#[track_caller]
fn assert_followed(settings: &[&str]) {
    let carve = |reduce: &str| {
        let bench = Bench::new();
        bench.hills("hills.png", (50, 40));
        let reduce = format!("reduce={reduce}");
        let quick = ["--set", "save_mesh=none", "--set", &reduce];
        let report = bench.run(&[&["relief"], settings, &quick[..]].concat());
        let files = bench.files("out").into_keys();
        let name = files.into_iter().find(|name| name.ends_with(".nc")).unwrap();
        (bench, report, format!("out/{name}"))
    };
    let lines = ["none", "z_band", "chord"].map(|reduce| {
        let (bench, _, name) = carve(reduce);
        bench.text(&name).lines().count()
    });
    let (bench, report, name) = carve("arcs");
    let text = bench.text(&name);
    let with_arcs = text.lines().count();
    let fewer = lines[0] > lines[1] && lines[1] > lines[2] && 10 * lines[2] > 15 * with_arcs;
    assert!(fewer, "{settings:?}: {lines:?} lines, {with_arcs} with arcs");
    assert!(report.number("reduce", "reduction", "max_below_mm") <= 1e-9);

    let Some(read_back) = interpret(&bench, &name, TOOLS) else { return };
    let motion = canonical(&read_back);
    assert!(
        motion.arcs.len() > with_arcs / 4 && motion.arcs.iter().all(|arc| arc.plane == Plane::Zx)
    );
    let (full, _, full_name) = carve("none");
    let mut meant = Rows::new();
    for made in read(&full.text(&full_name)).moves.iter().filter(|made| made.to[2].is_some()) {
        if made.motion == crate::gcode::Motion::Feed {
            let tip = DVec3::from_array(made.point());
            meant.entry(row_of(tip)).or_default().push(tip);
        }
    }
    let meant = towards_x(meant);
    let mut made = Rows::new();
    for (from, moved) in motion.legs().filter(|(_, moved)| moved.kind != MoveKind::Rapid) {
        let row = made.entry(row_of(moved.to)).or_default();
        match motion.arc(moved) {
            Some(arc) => row.extend(arc.chords(from, moved.to, 0.1 * STEP_MM)),
            None => row.push(moved.to),
        }
    }
    let made = towards_x(made);
    assert!(made.keys().eq(meant.keys()));
    let (tolerance, rounding) = (0.01, ARC_STEPS * STEP_MM);
    for (made, meant) in made.values().zip(meant.values()) {
        for tip in made {
            let (distance, below) = off(meant, *tip);
            let most = if below { rounding } else { tolerance + rounding };
            assert!(distance < most, "{distance} at {tip}, below: {below}");
        }
        for tip in meant {
            assert!(off(made, *tip).0 < tolerance + rounding, "{tip}");
        }
    }
}

#[test]
fn small_hills_are_followed() {
    assert_followed(&[&["--set", "image=hills.png", "--set", "stepover=0.7"], &QUICK[..]].concat());
}

#[test]
fn arcs_become_lines_where_a_machine_takes_none() {
    let bench = Bench::new();
    bench.hills("hills.png", (50, 40));
    let carve = |setting: &str| {
        let settings =
            ["relief", "--set", "image=hills.png", "--set", "reduce=arcs", "--set", setting];
        bench.run(&[&settings, &QUICK[..]].concat());
        bench.text("out/hills.nc")
    };
    let arcs =
        |text: &str| text.lines().filter(|l| l.starts_with("G2 ") || l.starts_with("G3 ")).count();
    let (with, without) = (carve("post.arcs=true"), carve("post.arcs=false"));
    assert!(arcs(&with) > 100 && arcs(&without) == 0);
    assert!(read(&without).moves.len() > with.lines().count());
}

#[test]
fn each_program_of_a_job_has_its_own_arcs() {
    let carve = |reduce: &str| {
        let bench = Bench::new();
        bench.hills("hills.png", (50, 40));
        let settings = ["rest_finish", "--set", "image=hills.png", "--set", reduce];
        bench.run(&[&settings[..], &["--set", "canvas_width=30"]].concat());
        bench
    };
    let (full, reduced) = (carve("reduce=none"), carve("reduce=arcs"));
    let programs = reduced.files("out").into_keys().filter(|name| name.ends_with(".nc"));
    let programs: Vec<String> = programs.map(|name| format!("out/{name}")).collect();
    assert!(programs.len() > 1, "{programs:?}");
    let mut with_arcs = 0;
    for name in programs {
        let grid = |tip: DVec3| (tip / STEP_MM).round().to_array().map(|c| c as i64);
        let meant = read(&full.text(&name)).moves.into_iter();
        let meant = meant.filter(|made| made.motion == crate::gcode::Motion::Feed);
        let meant: BTreeSet<_> = meant.map(|m| grid(DVec3::from_array(m.point()))).collect();
        let Some(read_back) = interpret(&reduced, &name, TOOLS) else { return };
        let motion = canonical(&read_back);
        with_arcs += usize::from(!motion.arcs.is_empty());
        for made in motion.moves.iter().filter(|made| made.kind != MoveKind::Rapid) {
            assert!(meant.contains(&grid(made.to)), "{name}: {}", made.to);
        }
    }
    assert!(with_arcs > 1);
}

#[track_caller]
fn assert_picture_followed(name: &str) {
    let Some(path) = data(name) else { return };
    assert_followed(&["--set", &format!("image={path}")]);
}

#[test]
fn the_astronaut_is_followed() {
    assert_picture_followed("astronaut.png");
}

#[test]
fn the_flower_is_followed() {
    assert_picture_followed("flower.jpg");
}

#[test]
fn the_coffee_is_followed() {
    assert_picture_followed("coffee.png");
}

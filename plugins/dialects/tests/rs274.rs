//! LinuxCNC's own interpreter reads the programs: `rs274 -g` prints the canonical
//! motions it would make, and exits with 0 only if it has no complaint. It is in Debian's package
//! `linuxcnc-uspace`; without it the test says so and passes.
//!
//! It reads those of GRBL, FluidNC, Mach3 and ISO 6983 too: all their words are LinuxCNC's.

#![allow(clippy::unwrap_used, reason = "a failing helper fails its test")]

mod jobs;

use carvegraph_sdk::conformance::dialect::{Job, Move, compare, long, small};
use carvegraph_sdk::{Arc, Command, Direction, Plane, Units};
use jobs::{by_each_way, posted, reading};
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::{self, Stdio};
use std::sync::Once;

/// Dialects whose words it knows all.
const READABLE: [&str; 5] = ["fluidnc", "grbl", "iso6983", "linuxcnc", "mach3"];

/// A table for the tests' tools: without one it takes some from its examples.
const TOOLS: &str = "T1 P1 Z0\nT2 P2 Z0\n";

/// Runs the interpreter on a program; `None` where it is not installed.
///
/// It keeps its tools in `$HOME/.tool.mmap`: two that run at once with one `HOME` die of a bus
/// error. An empty parameter file means no work offset; a missing one is a complaint.
fn interpret(name: &str, program: &str) -> Option<String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("rs274-{name}"));
    std::fs::create_dir_all(&folder).unwrap();
    for (file, text) in [("program.ngc", program), ("tool.tbl", TOOLS), ("program.var", "")] {
        std::fs::write(folder.join(file), text).unwrap();
    }
    let run = process::Command::new("rs274")
        .args(["-t", "tool.tbl", "-v", "program.var", "-g", "program.ngc"])
        .env("HOME", &folder)
        .current_dir(&folder)
        .stdin(Stdio::null())
        .output();
    let output = match run {
        Ok(output) => output,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            skipped();
            return None;
        }
        Err(error) => panic!("rs274: {error}"),
    };
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {complaint}");
    assert_eq!(complaint.trim(), "executing", "{name}");
    Some(String::from_utf8(output.stdout).unwrap())
}

/// Says so once, past the harness, which hides what a passing test prints.
fn skipped() {
    static ONCE: Once = Once::new();
    let words =
        b"SKIPPED: no rs274 on PATH, no program was read (apt-get install linuxcnc-uspace)\n";
    ONCE.call_once(|| io::stderr().write_all(words).unwrap());
}

/// The motions in what the interpreter prints, in mm. X and Y before their first word are unknown
/// to us; it takes them to be 0.
fn motions(canonical: &str) -> Vec<Move> {
    let mut unit_mm = 1.0;
    let mut plane = Plane::Xy;
    let mut mm_per_min = 0.0;
    let mut moves = Vec::new();
    for line in canonical.lines() {
        let call = line.split_once("..... ").map_or("", |c| c.1);
        let (name, rest) = call.split_once('(').unwrap_or((call, ""));
        let texts: Vec<&str> = rest.trim_end_matches(')').split(", ").collect();
        let value = |k: usize| texts[k].parse::<f64>().unwrap();
        let point = |k: [usize; 3]| k.map(|k| value(k) * unit_mm);
        match (name, texts[0]) {
            ("USE_LENGTH_UNITS", "CANON_UNITS_MM") => unit_mm = 1.0,
            ("USE_LENGTH_UNITS", "CANON_UNITS_INCHES") => unit_mm = 25.4,
            ("SELECT_PLANE", "CANON_PLANE_XY") => plane = Plane::Xy,
            ("SELECT_PLANE", "CANON_PLANE_XZ") => plane = Plane::Zx,
            ("SELECT_PLANE", "CANON_PLANE_YZ") => plane = Plane::Yz,
            ("SET_FEED_RATE", _) => mm_per_min = value(0) * unit_mm,
            ("STRAIGHT_TRAVERSE", _) => moves.push(Move::Rapid { to: point([0, 1, 2]) }),
            ("STRAIGHT_FEED", _) => moves.push(Move::Feed { to: point([0, 1, 2]), mm_per_min }),
            ("ARC_FEED", _) => {
                let turn: i32 = texts[4].parse().unwrap();
                assert_eq!(turn.abs(), 1, "{line}");
                let direction =
                    if turn < 0 { Direction::Clockwise } else { Direction::CounterClockwise };
                let [first, second, normal] = plane.axes();
                let (mut to, mut center) = ([0.0; 3], [0.0; 3]);
                [to[first], to[second], to[normal]] = point([0, 1, 5]);
                [center[first], center[second]] = [value(2) * unit_mm, value(3) * unit_mm];
                moves.push(Move::Arc(Arc { plane, direction, center, to, mm_per_min }));
            }
            _ => {}
        }
    }
    moves
}

#[test]
fn the_interpreter_makes_the_meant_motions() {
    for name in READABLE {
        let small = by_each_way(name, small);
        for units in [Units::Mm, Units::Inch] {
            let lines_only = Job { lines_only: true, ..long(units) };
            let jobs = [("small", small.clone()), ("long", long(units)), ("lines", lines_only)];
            for (size, mut job) in jobs {
                job.units = units;
                let program = posted(&job, name).unwrap();
                if let Some(canonical) = interpret(&format!("{name}-{units:?}-{size}"), &program) {
                    compare(&job, &motions(&canonical), &reading(name)).unwrap();
                    assert_eq!(canonical.contains(" ARC_FEED("), !job.lines_only);
                }
            }
        }
    }
}

#[test]
fn the_interpreter_changes_tools() {
    let mut job = Job::default();
    for number in [1, 2] {
        job.commands.push(Command::ToolChange { number });
        job.commands.extend(Job::at(1.0, 2.0).commands);
        job.feed([1.0, 2.0, -1.0], 100.0);
        job.rapid([1.0, 2.0, 5.0]);
    }
    for name in READABLE {
        if !by_each_way(name, |dialect| dialect.capabilities().tool_change) {
            continue;
        }
        let program = posted(&job, name).unwrap();
        if let Some(canonical) = interpret(&format!("{name}-tools"), &program) {
            for call in ["CHANGE_TOOL(", "PROGRAM_END"] {
                assert!(canonical.contains(call), "{call} in {canonical}");
            }
            let blending = "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.01";
            assert!(name != "linuxcnc" || canonical.contains(blending), "{canonical}");
        }
    }
}

#[test]
fn the_interpreter_obeys_no_comment() {
    let mut job = Job::at(0.0, 0.0);
    job.title = "py,import os".to_owned();
    let orders = ["LOGOPEN,x", "MSG,x", "abort,x", "pyreload", "print,x", "debug,#1", "a)(MSG,b"];
    job.remarks = orders.map(str::to_owned).to_vec();
    for name in READABLE {
        let program = posted(&job, name).unwrap();
        if let Some(canonical) = interpret(&format!("{name}-comments"), &program) {
            assert!(
                !canonical.contains(" MESSAGE(") && !canonical.contains(" LOGOPEN("),
                "{canonical}"
            );
            let remarks = orders.iter().filter(|o| canonical.contains(&format!("\"- {}", &o[..1])));
            assert_eq!(remarks.count(), orders.len(), "{canonical}");
            compare(&job, &motions(&canonical), &reading(name)).unwrap();
        }
    }
}

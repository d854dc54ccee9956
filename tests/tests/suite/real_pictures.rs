//! Photographs as people have them, carved by the recipe as it is, and read by the interpreter of a
//! real controller.
//!
//! The pictures lie outside of the repository (`../shared/data`, or where `CARVE_DATA` says);
//! LinuxCNC's interpreter `rs274` comes with Debian's package `linuxcnc-uspace`. Where either is
//! missing, the tests say so and pass.

use crate::bench::{Bench, data, skipped};
use crate::gcode::{Motion, read};
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

/// Lets LinuxCNC's interpreter read a program; `None` where there is no interpreter.
///
/// It keeps its tools in `$HOME`, takes a missing parameter file for a fault, and prints every
/// motion that it would make. `tools` is its tool table.
pub(crate) fn interpret(bench: &Bench, program: &str, tools: &str) -> Option<String> {
    bench.write("tool.tbl", tools);
    bench.write("program.var", "");
    let run = Command::new("rs274")
        .args(["-t", "tool.tbl", "-v", "program.var", "-g", program])
        .env("HOME", bench.path(""))
        .current_dir(bench.path(""))
        .stdin(Stdio::null())
        .output();
    let output = match run {
        Ok(output) => output,
        Err(fault) if fault.kind() == io::ErrorKind::NotFound => {
            skipped("no rs274 on PATH, no program was read (apt-get install linuxcnc-uspace)");
            return None;
        }
        Err(fault) => panic!("rs274: {fault}"),
    };
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{program}: {complaint}");
    assert_eq!(complaint.trim(), "executing", "{program}");
    Some(String::from_utf8(output.stdout).unwrap())
}

/// Carves a photograph with nothing set but the dialect.
#[track_caller]
fn assert_carved(name: &str) {
    let Some(path) = data(name) else { return };
    let bench = Bench::new();
    let image = format!("image={path}");
    let report = bench.run(&["relief", "--set", &image, "--set", "dialect=linuxcnc"]);
    let stem = Path::new(&path).file_stem().unwrap().to_str().unwrap();
    let mut wanted: Vec<String> =
        ["-carved.png", "-deviation.png", "-path.png", ".ngc", ".png", ".stl", ".txt"]
            .iter()
            .map(|ending| format!("{stem}{ending}"))
            .collect();
    wanted.sort();
    assert_eq!(bench.files("out").into_keys().collect::<Vec<_>>(), wanted);

    let program = read(&bench.text(&format!("out/{stem}.ngc")));
    let feeds = program.moves.iter().filter(|one| one.motion == Motion::Feed).count();
    let points = report.count("link", "toolpath", "cl_points") as usize;
    // The moves from pass to pass are feeds that are no cutter locations.
    assert!(feeds >= points && feeds <= points + points / 20, "{feeds} moves, {points} points");

    let Some(canonical) = interpret(&bench, &format!("out/{stem}.ngc"), "T1 P1 Z0\n") else {
        return;
    };
    let calls = |call: &str| canonical.lines().filter(|line| line.contains(call)).count();
    assert_eq!(calls(" STRAIGHT_FEED("), feeds, "{name}");
    assert_eq!(calls(" STRAIGHT_TRAVERSE("), program.moves.len() - feeds, "{name}");
    assert_eq!(calls(" PROGRAM_END("), 1, "{name}");
}

#[test]
fn the_astronaut_is_carved() {
    assert_carved("astronaut.png");
}

#[test]
fn the_flower_is_carved() {
    assert_carved("flower.jpg");
}

#[test]
fn the_coffee_is_carved() {
    assert_carved("coffee.png");
}

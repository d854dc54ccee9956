//! Programs damaged by hand are caught, and good ones pass: by the path that they were made of, and by
//! the part alone where nothing else is known.

use crate::bench::{Answer, Bench};

/// A relief with a smooth surface, dropped on the mesh, with points where the path bends.
const JOB: [&str; 13] = [
    "relief",
    "--set",
    "image=hills.png",
    "--set",
    "canvas_width=30",
    "--set",
    "surface=mesh",
    "--set",
    "chord_tolerance=0.005",
    "--set",
    "reduce=arcs",
    "--set",
    "xy_zero=center",
];

/// A bench with the program, and the model that it was made of.
fn bench() -> (Bench, String) {
    let bench = Bench::new();
    bench.hills("hills.png", (100, 80));
    bench.run(&JOB);
    let program = bench.text("out/hills.nc");
    (bench, program)
}

/// What comes of looking at a program with nothing but the model.
fn verify(bench: &Bench, program: &str) -> Answer {
    bench.write("job.nc", program);
    bench.carve(&[
        "run",
        "verify",
        "--set",
        "program=job.nc",
        "--set",
        "mesh=out/hills.stl",
        "--set",
        "xy_zero=center",
        "--set",
        "gouge=0.025",
        "--out",
        "verified",
    ])
}

#[track_caller]
fn refused(bench: &Bench, program: &str, why: &str) {
    let answer = verify(bench, program);
    assert_eq!(answer.status, 1, "{answer:?}");
    assert!(answer.err.contains(why), "{answer:?}");
}

/// The program with one line, the first from `from` on that `fits`, put another way.
fn changed(
    program: &str,
    from: usize,
    fits: impl Fn(&str) -> bool,
    change: impl Fn(&str) -> String,
) -> String {
    let mut lines: Vec<String> = program.lines().map(str::to_owned).collect();
    let at = (from..lines.len()).find(|at| fits(&lines[*at])).unwrap();
    lines[at] = change(&lines[at]);
    lines.join("\n") + "\n"
}

/// A word of a line, and the line without it.
fn word(line: &str, letter: char) -> Option<f64> {
    line.split_whitespace().find_map(|word| word.strip_prefix(letter)?.parse().ok())
}

#[test]
fn a_good_program_passes_and_is_told_of() {
    let (bench, program) = bench();
    let answer = verify(&bench, &program);
    assert_eq!(answer.status, 0, "{answer:?}");
}

#[test]
fn one_z_lowered_by_a_twentieth_of_a_millimetre_is_a_gouge() {
    let (bench, program) = bench();
    let lines = program.lines().count();
    let damaged = changed(
        &program,
        lines / 2,
        |line| line.starts_with('X') && word(line, 'Z').is_some() && word(line, 'K').is_none(),
        |line| {
            let z = word(line, 'Z').unwrap();
            line.split('Z').next().unwrap().to_owned() + &format!("Z{:.3}", z - 0.05)
        },
    );
    refused(&bench, &damaged, "it gouges the part");
}

#[test]
fn a_missing_retract_is_a_rapid_through_stock() {
    let (bench, program) = bench();
    // The last way up, and a way home across the part.
    let damaged = program.replace("G0 Z5.0\nM5", "G0 X0.0 Y0.0\nM5");
    assert_ne!(damaged, program);
    refused(&bench, &damaged, "a rapid goes");
}

#[test]
fn an_arc_the_wrong_way_round_is_a_gouge() {
    let (bench, program) = bench();
    for (right, wrong) in [("G2 ", "G3 "), ("G3 ", "G2 ")] {
        let lines = program.lines().count();
        let fits = |line: &str| line.starts_with(right);
        let damaged = changed(&program, lines / 2, fits, |line| line.replace(right, wrong));
        refused(&bench, &damaged, "it gouges the part");
    }
}

#[test]
fn inches_in_the_midst_are_found() {
    let (bench, program) = bench();
    let lines = program.lines().count();
    let damaged =
        changed(&program, lines / 2, |line| line.starts_with('X'), |line| format!("G20\n{line}"));
    refused(&bench, &damaged, "changes between millimetres and inches");
}

#[test]
fn a_lost_minus_sign_is_found() {
    let (bench, program) = bench();
    // Left of the middle X is below 0: without its sign the cutter crosses the part at its depth.
    let damaged = changed(
        &program,
        program.lines().count() / 2,
        |line| line.starts_with("X-1") && word(line, 'K').is_none(),
        |line| line.replacen("X-", "X", 1),
    );
    refused(&bench, &damaged, "it gouges the part");
}

#[test]
fn a_program_that_is_cut_off_is_found() {
    let (bench, program) = bench();
    refused(&bench, &program[..program.len() / 2], "without an end of the program");
}

//! Jobs of several tools: what becomes one program and what several, what happens between them, and
//! where a finer cutter goes.

use crate::bench::{Bench, Report};
use crate::gcode::{Motion, Program, read};
use crate::real_pictures::interpret;

/// Runs a recipe of two tools on hills of 50 × 40 pixels.
fn carve(bench: &Bench, recipe: &str, settings: &[&str]) -> Report {
    bench.hills("hills.png", (50, 40));
    let mut call = vec![recipe];
    let small = ["image=hills.png", "canvas_width=30", "stepover=0.7", "preview.size=64"];
    call.extend(small.iter().chain(settings).flat_map(|setting| ["--set", setting]));
    bench.run(&call)
}

fn names(bench: &Bench, ending: &str) -> Vec<String> {
    bench.files("out").into_keys().filter(|name| name.ends_with(ending)).collect()
}

/// What holds of a program whatever its operations are; roughing also goes down fast where all is cut.
#[track_caller]
fn assert_whole(program: &Program) {
    const SAFE_MM: f64 = 5.0 - 1e-9;
    let (first, last) = (&program.moves[0], program.moves.last().unwrap());
    assert!(first.motion == Motion::Rapid && !first.travels() && first.z() >= SAFE_MM, "{first}");
    assert!(last.motion == Motion::Rapid && last.z() >= SAFE_MM, "{last}");
    for one in &program.moves {
        match one.motion {
            Motion::Rapid if one.travels() => {
                assert!(one.from[2].unwrap().min(one.z()) >= SAFE_MM, "low: {one}");
            }
            Motion::Rapid => {}
            Motion::Feed => assert!(one.spindle_on && one.mm_per_min.is_some(), "{one}"),
        }
    }
    assert!(!program.spindle_left_on, "the spindle turns on");
}

#[test]
fn a_controller_without_a_tool_change_gets_a_program_for_each_tool() {
    let bench = Bench::new();
    let report = carve(&bench, "two_tool_relief", &[]);
    assert_eq!(names(&bench, ".nc"), ["hills-1-rough.nc", "hills-2-finish.nc"]);
    assert_eq!(report.count("post", "program", "programs"), 2);
    let texts = names(&bench, ".nc").into_iter().map(|name| bench.text(&format!("out/{name}")));
    let texts: Vec<String> = texts.collect();
    let sizes = |of: fn(&String) -> usize| texts.iter().map(of).sum::<usize>() as u64;
    assert_eq!(report.count("post", "program", "bytes"), sizes(String::len));
    assert_eq!(report.count("post", "program", "lines"), sizes(|text| text.lines().count()));
    for (text, shape) in texts.iter().zip(["flat", "ball"]) {
        let program = read(text);
        assert_whole(&program);
        assert_eq!(program.end, "M30");
        assert!(
            text.contains(&format!("(- Cutter: {shape}, diameter 6 mm)\n")),
            "{}",
            &text[..300]
        );
        assert!(!text.lines().any(|line| line.starts_with('T')), "GRBL has no tools");
    }
    assert!(texts[1].contains("(- Set Z anew with this cutter, where it was set for program 1)\n"));
    let summary = bench.text("out/hills.txt");
    for line in [
        "\nbefore     rough: flat, diameter 6 mm; ",
        "\nprogram    1-rough: flat, diameter 6 mm, for rough; ",
        "\nprogram    2-finish: ball, diameter 6 mm, for finish; ",
        "\nbetween    put in the next cutter and set Z anew with it, ",
    ] {
        assert!(summary.contains(line), "{line:?} in {summary}");
    }
    assert!(!summary.contains("rough it out first"), "{summary}");
}

/// A tool table whose lengths are not the same: each must be taken up. The interpreter reads inches.
const TOOLS: &str = "T1 P1 Z10\nT2 P2 Z25.5\nT7 P7 Z3\n";

/// What happens around the changes of tools in what LinuxCNC's interpreter prints: heights of the last
/// move before and of the first after, and that the spindle stands in between.
fn assert_changes(canonical: &str, lengths_mm: &[&str]) {
    let calls: Vec<&str> =
        canonical.lines().filter_map(|line| line.split_once("..... ").map(|call| call.1)).collect();
    let changes: Vec<usize> =
        (0..calls.len()).filter(|at| calls[*at].starts_with("CHANGE_TOOL(")).collect();
    assert_eq!(changes.len(), lengths_mm.len());
    let is_move = |call: &&&str| call.starts_with("STRAIGHT_");
    let height = |call: &str| -> f64 {
        let values: Vec<&str> = call.split_once('(').unwrap().1.split(", ").collect();
        values[2].parse().unwrap()
    };
    for (&at, length) in changes.iter().zip(lengths_mm) {
        if let Some(before) = calls[..at].iter().rev().find(is_move) {
            assert!(before.starts_with("STRAIGHT_TRAVERSE("), "{before}");
            assert_eq!(height(before), 5.0, "{before}");
        }
        let spindle = calls[..at].iter().rev().find(|call| call.contains("SPINDLE_")).unwrap();
        assert!(spindle.starts_with("STOP_SPINDLE_TURNING"), "{spindle}");
        let next = at + calls[at..].iter().position(|call| is_move(&call)).unwrap();
        assert!(calls[next].starts_with("STRAIGHT_TRAVERSE("), "{}", calls[next]);
        assert_eq!(height(calls[next]), 5.0, "{}", calls[next]);
        let between = &calls[at..next];
        assert!(
            between.iter().any(|call| call.starts_with("START_SPINDLE_CLOCKWISE")),
            "{between:?}"
        );
        let taken = format!("USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 {length},");
        assert!(between.iter().any(|call| call.starts_with(&taken)), "{between:?}");
    }
    assert_eq!(calls.iter().filter(|call| call.starts_with("PROGRAM_END(")).count(), 1);
}

#[test]
fn linuxcnc_changes_tools_above_the_part_with_the_spindle_standing() {
    let bench = Bench::new();
    let report = carve(&bench, "two_tool_relief", &["dialect=linuxcnc"]);
    assert_eq!(names(&bench, ".ngc"), ["hills.ngc"]);
    assert_eq!(report.count("post", "program", "programs"), 1);
    let text = bench.text("out/hills.ngc");
    for line in [
        "(- Tool 1: flat, diameter 6 mm, for rough)\n(- Tool 2: ball, diameter 6 mm, for finish)\n",
        "(- rough)\nM5\nT1 M6\nG43\nM3 S12000\nG0 Z5.0\n",
        "G0 Z5.0\n(- finish)\nM5\nT2 M6\nG43\nM3 S12000\nG0 Z5.0\n",
    ] {
        assert!(text.contains(line), "{line:?}");
    }
    if let Some(canonical) = interpret(&bench, "out/hills.ngc", TOOLS) {
        assert_changes(&canonical, &["254.0000", "647.7000"]);
    }
}

#[test]
fn numbers_and_speeds_are_those_that_are_set() {
    let bench = Bench::new();
    let set = ["dialect=linuxcnc", "rough_number=7", "rough_spindle=9000", "spindle=15000"];
    carve(&bench, "two_tool_relief", &set);
    let text = bench.text("out/hills.ngc");
    assert!(text.contains("T7 M6\nG43\nM3 S9000\n") && text.contains("T1 M6\nG43\nM3 S15000\n"));
    if let Some(canonical) = interpret(&bench, "out/hills.ngc", TOOLS) {
        assert_changes(&canonical, &["76.2000", "254.0000"]);
    }
}

#[test]
fn programs_are_divided_as_the_user_wants_where_that_can_be() {
    let bench = Bench::new();
    carve(&bench, "two_tool_relief", &["dialect=linuxcnc", "split=by_tool"]);
    assert_eq!(names(&bench, ".ngc"), ["hills-1-rough.ngc", "hills-2-finish.ngc"]);
    for name in names(&bench, ".ngc") {
        assert_whole(&read(&bench.text(&format!("out/{name}"))));
    }
    let bench = Bench::new();
    carve(&bench, "two_tool_relief", &["machine=sherline_5400", "canvas_width=25"]);
    assert_eq!(names(&bench, ".ngc"), ["hills.ngc"]);
    let refused = |settings: &[&str]| {
        let bench = Bench::new();
        bench.hills("hills.png", (50, 40));
        let mut call = vec!["run", "two_tool_relief", "--set", "image=hills.png"];
        call.extend(["--set", "canvas_width=30", "--set", "stepover=2"]);
        call.extend(settings.iter().flat_map(|setting| ["--set", setting]));
        let answer = bench.carve(&call);
        assert_eq!((answer.status, bench.files("out").len()), (2, 0), "{}", answer.err);
        answer.err
    };
    let told = refused(&["split=one"]);
    let words = "2 tools cannot be in one program: grbl has no tool change (set split to by_tool for a \
                 program each)";
    assert!(told.contains(words) && told.contains("--> --set:1:7"), "{told}");
    let told = refused(&["split=one", "dialect=linuxcnc", "machine=x_carve_1000"]);
    assert!(told.contains("machine \"x_carve_1000\" changes no tools"), "{told}");
    let told = refused(&["dialect=linuxcnc", "rough_number=3", "number=3"]);
    assert!(told.contains("operations \"rough\" and \"finish\" both call for tool 3"), "{told}");
}

#[test]
fn one_cutter_for_both_needs_no_change() {
    let bench = Bench::new();
    let report = carve(&bench, "two_tool_relief", &["rough_cutter=ball"]);
    assert_eq!(names(&bench, ".nc"), ["hills.nc"]);
    assert_eq!(report.count("post", "program", "programs"), 1);
    let text = bench.text("out/hills.nc");
    assert_whole(&read(&text));
    assert_eq!(text.matches("\nM3 ").count(), 1, "the spindle goes on turning");
}

#[test]
fn a_job_is_kept_by_the_cache() {
    let bench = Bench::new();
    bench.hills("hills.png", (50, 40));
    let run = || {
        let set = ["image=hills.png", "canvas_width=30", "stepover=2", "preview.size=64"];
        let set = set.iter().flat_map(|setting| ["--set", setting]);
        let call: Vec<&str> =
            ["two_tool_relief", "--cache", "kept"].into_iter().chain(set).collect();
        (bench.run(&call), bench.files("out"))
    };
    let (_, first) = run();
    let (report, second) = run();
    assert_eq!([report.status("rough"), report.status("post")], ["cached", "cached"]);
    assert!(first == second);
}

#[test]
fn the_small_cutter_goes_where_the_large_one_leaves_material() {
    let bench = Bench::new();
    let report = carve(&bench, "rest_finish", &["z_max=8", "diameter=8"]);
    assert_eq!(names(&bench, ".nc"), ["hills-1-finish.nc", "hills-2-rest.nc"]);
    let [all, rest] = ["hills-1-finish.nc", "hills-2-rest.nc"].map(|name| {
        let program = read(&bench.text(&format!("out/{name}")));
        assert_whole(&program);
        program.moves.into_iter().filter(|one| one.motion == Motion::Feed).count()
    });
    assert!(all > 100 && rest > 100, "{all} {rest}");
    let share =
        |what: &str| report.number("rest", "left", what) - report.number("relief", "surface", what);
    // What is left lies nowhere below the surface, and in its valleys above.
    assert!(
        share("z_min") > 0.0 && share("z_max").abs() < 1e-5,
        "{} {}",
        share("z_min"),
        share("z_max")
    );
    assert!(report.count("rest", "polygon", "loops") > 0);
    let fine = report.count("fine_passes", "pattern", "points");
    let whole = (29.4 / 0.25) * (23.4 / 0.25);
    assert!((fine as f64) < 0.9 * whole, "{fine} of {whole}");
}

#[test]
fn a_part_that_needs_no_rest_pass_is_told_so() {
    let bench = Bench::new();
    bench.picture("even.png", (30, 30), |_, _| 77);
    let answer = bench.carve(&["run", "rest_finish", "--set", "image=even.png"]);
    assert_eq!((answer.status, bench.files("out").len()), (2, 0), "{}", answer.err);
    let words = "the ball, diameter 6 mm, leaves nothing above 0.1 mm, 0.0000 mm at most: no rest pass is \
                 needed (lower threshold, or carve with this cutter alone)";
    assert!(answer.err.contains(words), "{}", answer.err);
}

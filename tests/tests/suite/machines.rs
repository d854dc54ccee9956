//! Machines and tools chosen by name: what they decide, what they refuse, what they leave alone.

use crate::bench::{Bench, QUICK, Report};

/// Runs the relief of a small picture with these settings and returns report and program.
fn carve(bench: &Bench, settings: &[&str]) -> (Report, String) {
    bench.hills("hills.png", (30, 20));
    let set = settings.iter().flat_map(|setting| ["--set", setting]);
    let call = ["relief", "--set", "image=hills.png"].into_iter().chain(QUICK).chain(set);
    let report = bench.run(&call.collect::<Vec<_>>());
    let program = report.0["files"][0].as_str().unwrap().to_owned();
    (report, bench.text(&program))
}

/// What `carve run relief` says when it refuses these settings; nothing may be written.
fn refusal(settings: &[&str]) -> String {
    let bench = Bench::new();
    bench.hills("hills.png", (60, 60));
    let set = settings.iter().flat_map(|setting| ["--set", setting]);
    let call = ["run", "relief", "--quiet", "--out", "new/out", "--set", "image=hills.png"];
    let answer = bench.carve(&call.into_iter().chain(set).collect::<Vec<_>>());
    assert_eq!(answer.status, 2, "{}", answer.err);
    assert_eq!(bench.names(), ["hills.png"], "{settings:?} left something");
    answer.err
}

#[test]
fn machine_tool_and_material_decide_what_is_not_set() {
    let bench = Bench::new();
    let chosen = ["machine=shapeoko_3", "tool=ball_3", "material=walnut"];
    let (report, program) = carve(&bench, &chosen);
    assert_eq!(report.number("tool", "cutter", "diameter_mm"), 3.175);
    assert_eq!(report.fact("setup", "setup", "machine"), "shapeoko_3");
    for words in
        ["S18000", "F900", "F300", "Machine: shapeoko_3", "Tool: ball_3", "Material: walnut"]
    {
        assert!(program.contains(words), "{words:?} in {program:.900}");
    }
    assert!(program.contains("Set the spindle to 18000 rpm by hand"), "{program:.900}");
    assert!(!program.contains("M6"), "it changes no tools");
    let summary = bench.text("out/hills.txt");
    for words in ["tool       ball_3, number 2", "material   walnut", "machine    shapeoko_3: "] {
        assert!(summary.contains(words), "{words:?} in {summary}");
    }
}

#[test]
fn the_machine_decides_the_dialect_and_whether_tools_are_changed() {
    let bench = Bench::new();
    let (report, program) = carve(&bench, &["machine=haas_mini_mill", "tool=ball_6"]);
    assert_eq!(report.fact("post", "program", "dialect"), "haas");
    assert!(program.contains("T1 M6") || program.contains("T01 M6"), "{program:.600}");
    // The default, 12,000 rpm, yields to what it can do.
    assert!(program.contains("S6000"), "{program:.600}");
    // 25 mm above the top.
    assert!(program.contains("Z25."), "{program:.600}");
}

#[test]
fn what_is_set_wins() {
    let bench = Bench::new();
    let chosen = ["machine=shapeoko_3", "tool=ball_3", "material=walnut"];
    let set = ["feed=1234", "plunge=432", "spindle=16000", "safe_z=7", "diameter=4"];
    let (report, program) = carve(&bench, &[&chosen[..], &set].concat());
    assert_eq!(report.number("tool", "cutter", "diameter_mm"), 4.0);
    for words in ["S16000", "F1234", "F432", "Z7"] {
        assert!(program.contains(words), "{words:?} in {program:.900}");
    }
    let (report, _) = carve(&bench, &["machine=shapeoko_3", "dialect=linuxcnc"]);
    assert_eq!(report.fact("post", "program", "dialect"), "linuxcnc");
    let warning = "machine \"shapeoko_3\" understands grbl, but linuxcnc is set";
    assert_eq!(report.node("post")["notes"][0]["text"], warning);
    assert_eq!(report.node("post")["notes"][0]["weight"], "warning");
}

#[test]
fn nothing_chosen_changes_nothing() {
    let bench = Bench::new();
    let (_, left) = carve(&bench, &[]);
    let defaults = ["feed=1500", "plunge=500", "spindle=12000", "safe_z=5", "dialect=grbl"];
    let none = ["machine=none", "tool=none", "material=none", "cutter=ball", "diameter=6"];
    let (_, set) = carve(&bench, &[&defaults[..], &none].concat());
    assert!(left == set);
}

#[test]
fn what_the_machine_cannot_do_is_refused_all_at_once() {
    let refused = refusal(&["machine=cnc_3018", "spindle=24000", "z_max=60", "stepover=2"]);
    for words in [
        "error: node \"post\" (post): machine \"cnc_3018\": Y needs 198 mm and the machine \
         travels 180 mm: 18 mm too much (make the part shorter: canvas_height); Z needs 6",
        " mm and the machine travels 45 mm: ",
        " mm too much (make the part flatter or lower safe_z); the spindle is to turn at 24000 rpm and \
         turns at most 10000 rpm: 14000 rpm too fast",
        "--> --set:1:9",
        "nothing was written",
    ] {
        assert!(refused.contains(words), "{words:?} in {refused}");
    }
    assert!(!refused.contains("X needs"), "{refused}");
}

#[test]
fn a_tool_number_that_nobody_can_change_to_is_refused() {
    let refused = refusal(&["machine=x_carve_1000", "post.tool=3", "stepover=2"]);
    let words = "the program changes to tool 3 and the machine changes none";
    assert!(refused.contains(words), "{refused}");
}

#[test]
fn materials_and_tools_that_are_not_there_are_told_with_those_that_are() {
    let refused = refusal(&["tool=ball_6", "material=walnutt"]);
    let words = "tool \"ball_6\" knows no material \"walnutt\"; did you mean \"walnut\"? it has pine, \
                 walnut, mdf, aluminium";
    assert!(refused.contains(words) && refused.contains("--> --set:1:10"), "{refused}");
    let refused = refusal(&["material=walnut"]);
    assert!(refused.contains("material \"walnut\" says nothing without a tool"), "{refused}");
    let refused = refusal(&["tool=bal_6", "machine=shapeoko3"]);
    assert!(refused.contains("did you mean \"ball_6\"?"), "{refused}");
    assert!(refused.contains("did you mean \"shapeoko_3\"?"), "{refused}");
}

#[test]
fn feeds_that_the_machine_slows_down_are_warned_of() {
    let bench = Bench::new();
    let (report, _) = carve(&bench, &["machine=x_carve_1000", "plunge=900"]);
    let warning = "machine \"x_carve_1000\": Z feeds at most 500 mm/min, so that 900 mm/min become 500 \
                   mm/min in places";
    assert_eq!(report.node("post")["notes"][0]["text"], warning);
}

/// Another material is another feed, not another drop: that takes the time.
#[test]
fn another_material_or_machine_leaves_the_drop_cutter_alone() {
    let bench = Bench::new();
    bench.hills("hills.png", (30, 20));
    let run = |settings: &[&str]| {
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let call =
            ["relief", "--set", "image=hills.png", "--set", "tool=ball_6", "--cache", "kept"];
        bench.run(&call.into_iter().chain(QUICK).chain(set).collect::<Vec<_>>())
    };
    run(&["material=walnut"]);
    for other in [&["material=pine"][..], &["material=pine", "machine=shapeoko_3"]] {
        let report = run(other);
        assert_eq!(report.status("drop"), "cached", "{other:?}");
        assert_eq!([report.status("setup"), report.status("post")], ["ran", "ran"], "{other:?}");
    }
}

#[test]
fn every_profile_and_every_tool_can_be_used() {
    let bench = Bench::new();
    let answer = bench.carve(&["run", "relief", "--set", "machine=?"]);
    let listed = answer.err.split("it is one of ").nth(1).unwrap().lines().next().unwrap();
    assert!(listed.split(", ").count() > 8, "{listed}");
    for machine in listed.split(", ") {
        carve(&bench, &[&format!("machine={machine}"), "stepover=3"]);
    }
    let answer = bench.carve(&["run", "relief", "--set", "tool=?"]);
    let listed = answer.err.split("it is one of ").nth(1).unwrap().lines().next().unwrap();
    for tool in listed.split(", ") {
        carve(&bench, &[&format!("tool={tool}"), "stepover=3"]);
    }
}

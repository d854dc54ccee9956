//! The commands that tell what `carve` knows, and what it says to a wrong call.

use crate::bench::{Answer, Bench};
use serde_json::Value;

fn call(arguments: &[&str]) -> Answer {
    Bench::new().carve(arguments)
}

#[track_caller]
fn told(arguments: &[&str]) -> String {
    let answer = call(arguments);
    assert_eq!((answer.status, answer.err.as_str()), (0, ""), "{arguments:?}");
    answer.out
}

#[track_caller]
fn assert_wrong(arguments: &[&str], words: &[&str]) {
    let answer = call(arguments);
    assert_eq!(answer.status, 2, "{arguments:?}: {}", answer.err);
    assert_eq!(answer.out, "", "{arguments:?}");
    for word in words {
        assert!(answer.err.contains(word), "{arguments:?} does not say {word:?}: {}", answer.err);
    }
}

#[test]
fn check_finds_the_standard_recipe_in_order() {
    assert_eq!(told(&["check", "relief"]), "relief: 30 nodes, nothing wrong\n");
}

#[test]
fn check_takes_settings() {
    assert_wrong(&["check", "relief", "--set", "blur=4"], &["kernel must be odd", "take 3 or 5"]);
}

#[test]
fn a_plan_lists_nodes_in_order() {
    let plan = told(&["plan", "relief"]);
    let ids: Vec<&str> = plan.lines().skip(1).filter_map(|l| l.split(' ').next()).collect();
    assert_eq!(ids.len(), 26, "{plan}");
    let at = |id: &str| ids.iter().position(|known| *known == id).unwrap();
    for pair in
        ["photo", "gray", "smooth", "relief", "drop", "reduce", "link", "post", "save_gcode"]
            .windows(2)
    {
        assert!(at(pair[0]) < at(pair[1]), "{plan}");
    }
    let only = told(&["plan", "relief", "--only", "gray"]);
    assert_eq!(only.lines().count(), 3, "{only}");
    assert!(told(&["plan", "relief", "--explain", "drop"]).contains("drop runs"));
}

#[test]
fn a_plan_writes_nothing() {
    let bench = Bench::new();
    assert_eq!(bench.carve(&["plan", "relief"]).status, 0);
    assert_eq!(bench.carve(&["check", "relief"]).status, 0);
    assert!(bench.names().is_empty());
}

#[test]
fn nodes_are_listed_and_described() {
    let json: Value = serde_json::from_str(&told(&["nodes", "--json"])).unwrap();
    let kinds = json.as_array().unwrap();
    let list = told(&["nodes"]);
    for kind in kinds {
        let name = kind["kind"].as_str().unwrap();
        assert!(list.contains(&format!("\n  {name} ")), "{name} is not in {list}");
        let text = told(&["nodes", name]);
        assert!(text.starts_with(&format!("{name} (")), "{text}");
        assert!(text.contains(kind["about"].as_str().unwrap()), "{text}");
        for list in ["inputs", "outputs", "params"] {
            for entry in kind[list].as_array().unwrap() {
                assert!(
                    text.contains(&format!("\n  {}", entry["name"].as_str().unwrap())),
                    "{text}"
                );
                assert!(text.contains(entry["about"].as_str().unwrap()), "{text}");
            }
        }
        let one: Value = serde_json::from_str(&told(&["nodes", name, "--json"])).unwrap();
        assert_eq!(one, *kind);
    }
    assert_wrong(&["nodes", "gausian_blur"], &["did you mean \"gaussian_blur\"?"]);
}

#[test]
fn json_tells_all_of_a_parameter() {
    let json: Value = serde_json::from_str(&told(&["nodes", "gaussian_blur", "--json"])).unwrap();
    let kernel = &json["params"][0];
    assert_eq!(kernel["name"], "kernel");
    assert_eq!(kernel["type"], "integer");
    assert_eq!(kernel["unit"], "px");
    assert_eq!((&kernel["min"], &kernel["max"]), (&1.into(), &255.into()));
    assert_eq!((&kernel["odd"], &kernel["default"]), (&true.into(), &5.into()));
    assert_eq!(json["inputs"][0]["type"], "gray_image");
}

#[test]
fn cutters_and_dialects_are_listed() {
    let cutters = told(&["cutters"]);
    for shape in ["ball", "flat"] {
        let start = cutters.find(&format!("{shape}\n  ")).unwrap_or_else(|| panic!("{cutters}"));
        let text = cutters[start..].split("\n\n").next().unwrap();
        let diameter =
            "\n  diameter: number, 0.01 to 200 mm, default 6\n      Diameter of the cutting part.";
        assert!(text.ends_with(diameter), "{text}");
    }
    let node = told(&["nodes", "cutter"]);
    let more = "The fields of the cutter chosen come in addition: carve cutters lists them.";
    assert!(node.contains(more), "{node}");
    let json: Value = serde_json::from_str(&told(&["nodes", "cutter", "--json"])).unwrap();
    let ball = &json["params"][0]["entry_params"]["ball"][0];
    assert_eq!((&ball["name"], &ball["default"]), (&"diameter".into(), &6.0.into()));
    assert_eq!(json["origin"], Value::Null);
    let dialects = told(&["dialects"]);
    for (name, extension) in [("grbl", ".nc"), ("linuxcnc", ".ngc")] {
        let line = dialects.lines().find(|line| line.starts_with(name)).unwrap();
        assert_eq!(line.split_whitespace().nth(1), Some(extension), "{dialects}");
    }
}

#[test]
fn recipes_are_listed_and_described() {
    assert!(told(&["graphs"]).contains("\nrelief           Relief from a picture\n"));
    let relief = told(&["graphs", "relief"]);
    for line in [
        "image = samples/medallion.png ",
        "diameter = 6 ",
        "stepover = 0.3 ",
        "surface = auto ",
        "dialect = grbl ",
        "save_points = none ",
    ] {
        assert!(relief.contains(&format!("\n  {line}")), "{line:?} in {relief}");
    }
    assert_eq!(relief.lines().filter(|line| line.contains(" = ")).count(), 28, "{relief}");
    assert_wrong(&["graphs", "releif"], &["did you mean \"relief\"?"]);
    assert_wrong(&["graphs", "--text"], &["NAME"]);
}

#[test]
fn the_standard_recipe_has_the_promised_knobs_and_defaults() {
    let relief = told(&["graphs", "relief"]);
    let knob = |name: &str| {
        let start = format!("  {name} = ");
        let line = relief.lines().find(|line| line.starts_with(&start));
        let line = line.unwrap_or_else(|| panic!("no {name} in {relief}"));
        line[start.len()..].split("  ").next().unwrap().to_owned()
    };
    for (name, default) in [
        ("canvas_width", "203"),
        ("canvas_height", "203"),
        ("z_min", "0"),
        ("z_max", "5"),
        ("blur", "5"),
        ("surface", "auto"),
        ("cutter", "ball"),
        ("diameter", "6"),
        ("stepover", "0.3"),
        ("feed_step", "0.3"),
        ("reduce", "z_band"),
        ("tolerance", "0.01"),
        ("dialect", "grbl"),
        ("z_zero", "top"),
        ("xy_zero", "corner"),
        ("save_mesh", "binary"),
        ("save_points", "none"),
    ] {
        assert_eq!(knob(name), default, "{name}");
    }
    for name in ["image", "feed", "plunge", "spindle", "safe_z"] {
        assert!(!knob(name).is_empty(), "{name}");
    }
}

#[test]
fn shells_get_completions() {
    for (shell, words) in
        [("bash", "complete -F _carve"), ("zsh", "#compdef carve"), ("fish", "complete -c carve")]
    {
        let script = told(&["completions", shell]);
        assert!(script.contains(words), "{shell}: {}", &script[..script.len().min(300)]);
        for command in ["run", "check", "plan", "nodes", "cutters", "dialects", "graphs"] {
            assert!(script.contains(command), "{shell}: {command}");
        }
    }
    assert_wrong(&["completions", "cmd"], &["cmd"]);
}

#[test]
fn wrong_calls_are_refused() {
    assert_wrong(&["rn", "relief"], &["rn"]);
    assert_wrong(&[], &["Usage"]);
    assert_wrong(&["run"], &["RECIPE"]);
    assert_wrong(&["run", "relief", "--thread", "2"], &["--threads"]);
    assert_wrong(&["run", "relief", "--threads", "0"], &["--threads"]);
    assert_wrong(&["run", "relief", "--set", "diameter"], &["write NAME=VALUE"]);
    assert_wrong(&["run", "relief", "--set", "=6"], &["write NAME=VALUE"]);
    assert_wrong(&["run", "relief", "--only", "savegcode"], &["did you mean \"save_gcode\"?"]);
    assert_wrong(&["run", "releif"], &["did you mean \"relief\"?", "Built in are bas_relief, "]);
}

#[test]
fn help_and_version_are_told() {
    let help = told(&["--help"]);
    for command in ["run", "check", "plan", "nodes", "cutters", "dialects", "graphs", "completions"]
    {
        assert!(help.contains(&format!("  {command} ")), "{help}");
    }
    let run = told(&["run", "--help"]);
    for option in
        ["--set", "--out", "--only", "--threads", "--cache", "--report", "--no-html", "--quiet"]
    {
        assert!(run.contains(option), "{run}");
    }
    assert_eq!(told(&["--version"]), concat!("carve ", env!("CARGO_PKG_VERSION"), "\n"));
}

/// `carve nodes | head -1` closes the pipe early; that is no fault.
#[cfg(unix)]
#[test]
fn a_reader_that_has_had_enough_is_no_fault() {
    let bench = Bench::new();
    let command = format!("{} nodes --json | head -c 10", crate::bench::CARVE);
    let shell = std::process::Command::new("sh")
        .args(["-c", &command])
        .current_dir(bench.path(""))
        .output()
        .unwrap();
    assert_eq!(String::from_utf8_lossy(&shell.stderr), "");
    assert_eq!(shell.stdout.len(), 10);
}

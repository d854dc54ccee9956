//! Plugins are found, listed, installed and used; a bad one does no harm to anybody else.

use crate::bench::{Answer, Bench, QUICK, workspace};
use carvegraph_sdk::conformance::built_library;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Compiles the plugin in C with one thing wrong, or nothing.
fn in_c(bench: &Bench, wrong: &str) -> PathBuf {
    let library = bench.path(&format!("{DLL_PREFIX}in_c{DLL_SUFFIX}"));
    let output = Command::new("cc")
        .args(["-std=c11", "-Wall", "-Wextra", "-shared", "-fPIC", "-o"])
        .arg(&library)
        .args([format!("-DNOTHING_WRONG_{wrong}"), format!("-D{wrong}")])
        .arg("-I")
        .arg(workspace().join("plugins/abi"))
        .arg(workspace().join("tests/tests/c/plugin.c"))
        .output()
        .expect("cc is what Rust links with");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    library
}

/// Puts a library into a plugin folder as somebody would who does not use `carve plugins install`.
fn lay_down(bench: &Bench, library: &Path, offers: &str) {
    let folder = bench.path("plugins/bad");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::copy(library, folder.join(format!("{DLL_PREFIX}bad{DLL_SUFFIX}"))).unwrap();
    let manifest =
        format!("Plugin(format: 1, id: \"bad\", version: \"1\", library: \"bad\", {offers})");
    std::fs::write(folder.join("plugin.ron"), manifest).unwrap();
}

const OFFERS: &str = "cutters: [\"square\"], dialects: [\"plain\"]";

fn path(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Runs `relief` with the plugin folder and more settings.
fn relief(bench: &Bench, settings: &[&str]) -> Answer {
    let settings: Vec<&str> = settings.iter().flat_map(|set| ["--set", *set]).collect();
    bench.carve(&[&["run", "relief", "--plugins", "plugins"], &QUICK[..], &settings].concat())
}

/// A bad plugin: `carve` says `why`, in `doctor` and when a recipe needs it, and runs one that does not.
#[track_caller]
fn assert_harmless(bench: &Bench, why: &str) {
    let doctor = bench.carve(&["plugins", "doctor", "--plugins", "plugins"]);
    assert_eq!(doctor.status, 1, "{doctor:?}");
    assert!(doctor.out.contains(why), "{}", doctor.out);
    assert!(doctor.out.contains("plugins/bad"), "{}", doctor.out);
    let without = relief(bench, &[]);
    assert_eq!(without.status, 0, "{}", without.err);
    assert!(without.err.contains(why) && without.err.contains("is left out"), "{}", without.err);
    assert!(without.out.contains("medallion.nc"), "{}", without.out);
    let quiet = [&["run", "relief", "--quiet", "--plugins", "plugins"], &QUICK[..]].concat();
    let quiet = bench.carve(&quiet);
    assert_eq!((quiet.status, quiet.err.as_str()), (0, ""));
    let with = relief(bench, &["dialect=plain"]);
    assert_eq!(with.status, 2, "{}", with.err);
    let told = "dialect cannot be \"plain\": plugin \"bad\" offers it but cannot be used: ";
    assert!(with.err.contains(told) && with.err.contains(why), "{}", with.err);
}

#[cfg(target_os = "linux")]
#[test]
fn a_library_that_breaks_the_rules_is_left_out_with_the_reason() {
    for (wrong, why) in [
        ("WRONG_MAGIC", "its magic number is 0x000000000000002a, not 0x4341525645475246"),
        ("NEW_MAJOR", "it was built for ABI 2.0, this carve speaks 1.0: update carve"),
        ("NO_SYMBOL", "it exports no carvegraph_plugin"),
        ("NO_INIT", "its carvegraph_plugin is incomplete"),
        ("REFUSE_INIT", "it refuses to begin: no licence"),
        ("NAN_PROFILE", "segment 1 of the profile holds a number that is not finite"),
        ("NEGATIVE_RADIUS", "segment 1 of the profile goes back"),
        ("ENDLESS_PROFILE", "1048576 at most are read"),
        ("HUGE_LENGTH", "segments; 1048576 at most are read"),
        ("HUGE_COUNT", "it claims to offer 4294967295 cutters; 1000 at most are taken"),
        ("HUGE_TEXT", "its cutter's description has 18446744073709551615 bytes"),
        ("BAD_UTF8", "its cutter's description is no UTF-8"),
        ("BAD_NAME", "its cutter's name is \"../Square\""),
        ("ABORT_AT_LOAD", "it ended the process by abort when it was tried"),
    ] {
        let bench = Bench::new();
        lay_down(&bench, &in_c(&bench, wrong), OFFERS);
        assert_harmless(&bench, why);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_that_is_no_library_is_left_out_with_the_reason() {
    let bench = Bench::new();
    let whole = std::fs::read(in_c(&bench, "RIGHT")).unwrap();
    for (bytes, why) in [
        (&b"This is a letter to my mother.\n"[..], "the system cannot load it: "),
        (&[], "the system cannot load it: "),
        (&whole[..100], "the system cannot load it: "),
        (&whole[..whole.len() / 2], "it"),
    ] {
        bench.write("cut", bytes);
        lay_down(&bench, &bench.path("cut"), OFFERS);
        assert_harmless(&bench, why);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_library_that_hangs_is_not_waited_for() {
    let bench = Bench::new();
    lay_down(&bench, &in_c(&bench, "HANG_AT_LOAD"), OFFERS);
    let limit = Duration::from_secs(60);
    let arguments = [&["run", "relief", "--plugins", "plugins"], &QUICK[..]].concat();
    let answer = bench.carve_within(limit, &arguments);
    assert_eq!(answer.status, 0, "{}", answer.err);
    assert!(answer.err.contains("did not come back within 5 s"), "{}", answer.err);
}

#[cfg(unix)]
#[test]
fn a_plugin_in_c_is_installed_listed_and_used() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("plugins")).unwrap();
    let library = in_c(&bench, "RIGHT");
    let installed = bench.carve(&["plugins", "install", path(&library), "--plugins", "plugins"]);
    assert_eq!((installed.status, installed.err.as_str()), (0, ""));
    assert!(
        installed.out.starts_with("in-c 0.1: cutter square; dialect plain\n"),
        "{}",
        installed.out
    );
    // Not loaded, so the child's process is not needed.
    let listed = bench.carve(&["plugins", "--plugins", "plugins"]).out;
    assert!(
        listed.starts_with("in-c  0.1  cutter square; dialect plain  plugins/in-c\n"),
        "{listed}"
    );
    let doctor = bench.carve(&["plugins", "doctor", "--plugins", "plugins"]);
    assert_eq!(doctor.status, 0);
    assert!(doctor.out.contains("1 fine, 0 at fault"), "{}", doctor.out);
    assert!(bench.carve(&["cutters", "--plugins", "plugins"]).out.contains("\nsquare\n"));
    let answer = relief(&bench, &["dialect=plain", "cutter=square", "diameter=3"]);
    assert_eq!(answer.status, 0, "{}", answer.err);
    assert!(bench.text("out/medallion.gc").starts_with("*\n*\n"));
    let outside = relief(&bench, &["cutter=square", "diameter=60"]);
    assert_eq!(outside.status, 2);
    assert!(
        outside.err.contains("diameter must be between 0.1 and 50 mm, not 60"),
        "{}",
        outside.err
    );
}

#[cfg(unix)]
#[test]
fn a_dialect_in_c_that_fails_or_does_not_stop_fails_its_node_alone() {
    for (wrong, why) in [
        ("REFUSE", "dialect \"plain\": the paper tape is torn"),
        ("ENDLESS_OUTPUT", "dialect \"plain\": it goes on though it was told to stop"),
    ] {
        let bench = Bench::new();
        lay_down(&bench, &in_c(&bench, wrong), OFFERS);
        let answer = relief(&bench, &["dialect=plain", "canvas_width=5"]);
        assert_eq!(answer.status, 1, "{}", answer.err);
        assert!(answer.err.contains(why), "{}", answer.err);
        // What does not need it is there.
        assert!(answer.out.contains("medallion.png"), "{}", answer.out);
        assert!(!answer.out.contains("medallion.gc"), "{}", answer.out);
    }
}

#[test]
fn panics_of_a_plugin_are_messages() {
    let bench = Bench::new();
    let offers =
        "cutters: [\"panicking\"], dialects: [\"deaf\", \"panicking\"], nodes: [\"panicking\"]";
    lay_down(&bench, &built_library("carvegraph_misbehaving_plugin"), offers);
    let fails = |settings: &[&str], why: &str| {
        let answer = relief(&bench, settings);
        assert_eq!(answer.status, 1, "{}", answer.err);
        assert!(answer.err.contains(why), "{}", answer.err);
        assert!(!answer.err.contains("thread '"), "{}", answer.err);
    };
    assert_eq!(relief(&bench, &[]).err.matches("left out").count(), 0);
    fails(&["cutter=panicking", "diameter=3"], "it panicked: no profile of 3 (");
    fails(&["dialect=panicking"], "dialect \"panicking\": it panicked: too many commands (");
    fails(&["dialect=deaf", "canvas_width=5"], "dialect \"deaf\": it wrote more than");
    bench.write(
        "node.ron",
        r#"Recipe(format: 1, nodes: {"a": (kind: "panicking")}, outputs: ["a"])"#,
    );
    let answer = bench.carve(&["run", "node.ron", "--plugins", "plugins"]);
    assert_eq!(answer.status, 1, "{}", answer.err);
    assert!(answer.err.contains("it panicked: part 57"), "{}", answer.err);
}

#[test]
fn a_plugin_that_panics_at_once_is_left_out() {
    let bench = Bench::new();
    let offers =
        "cutters: [\"panicking\"], dialects: [\"deaf\", \"panicking\"], nodes: [\"panicking\"]";
    lay_down(&bench, &built_library("carvegraph_misbehaving_plugin"), offers);
    let arguments = ["run", "relief", "--plugins", "plugins", "--only", "preview"];
    let mut command = bench.command(&[&arguments, &QUICK[..]].concat());
    let output = command.env("CARVE_TEST_PANIC", "describe").output().unwrap();
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{err}");
    assert!(err.contains("cutter 1: it cannot be described: it panicked"), "{err}");
}

#[test]
fn the_standard_plugins_load_as_libraries_too() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("plugins")).unwrap();
    for (name, offers) in [
        ("carvegraph_cutters_plugin", "cutter ball"),
        ("carvegraph_dialects_plugin", "dialect fanuc"),
    ] {
        let library = built_library(name);
        let installed =
            bench.carve(&["plugins", "install", path(&library), "--plugins", "plugins"]);
        assert_eq!((installed.status, installed.err.as_str()), (0, ""));
        assert!(installed.out.contains(offers), "{}", installed.out);
    }
    // Their names are taken by those that are linked: nothing is replaced behind a user's back.
    let doctor = bench.carve(&["plugins", "doctor", "--plugins", "plugins"]);
    let taken = "it offers the dialect \"fanuc\", which carve 0.1.0 has already";
    assert!(doctor.out.contains(taken), "{}", doctor.out);
}

#[test]
fn nothing_is_loaded_from_the_current_folder_or_a_recipes() {
    let bench = Bench::new();
    let dialect = "Dialect(format: 1, parent: \"grbl\")";
    bench.write("mine.ron", dialect);
    std::fs::create_dir(bench.path("recipes")).unwrap();
    bench.write("recipes/mine.ron", dialect);
    bench.write(
        "recipes/job.ron",
        r#"Recipe(format: 1, nodes: {"a": (kind: "recipe",
        set: {"recipe": "relief", "dialect": "mine"})}, outputs: ["a"])"#,
    );
    for recipe in ["relief", "recipes/job.ron"] {
        let answer = bench.carve(&["check", recipe, "--set", "dialect=mine"]);
        assert_eq!(answer.status, 2, "{}", answer.err);
    }
    let answer = bench.carve(&["check", "relief", "--set", "dialect=mine", "--plugins", "."]);
    assert_eq!(answer.status, 0, "{}", answer.err);
}

#[test]
fn a_folder_that_is_not_there_is_refused() {
    let bench = Bench::new();
    let answer = bench.carve(&["run", "relief", "--plugins", "nowhere"]);
    assert_eq!(answer.status, 2);
    assert_eq!(answer.err, "error: --plugins: there is no folder nowhere\n");
}

#[test]
fn a_dialect_is_begun_changed_and_used() {
    let bench = Bench::new();
    let plugins = ["--plugins", "plugins"];
    let begun =
        bench.carve(&[&["dialects", "new", "mine", "--from", "grbl"][..], &plugins].concat());
    assert_eq!((begun.status, begun.out.as_str()), (0, "plugins/mine.ron\n"), "{}", begun.err);
    let again =
        bench.carve(&[&["dialects", "new", "mine", "--from", "haas"][..], &plugins].concat());
    assert_eq!(again.status, 2, "{}", again.err);
    assert!(again.err.contains("cannot write plugins/mine.ron"), "{}", again.err);
    let like = relief(&bench, &["dialect=mine"]);
    assert_eq!(like.status, 0, "{}", like.err);
    let mine = bench.text("out/medallion.nc");
    assert_eq!(relief(&bench, &["dialect=grbl"]).status, 0);
    assert_eq!(mine, bench.text("out/medallion.nc"));
    assert!(bench.carve(&[&["dialects"][..], &plugins].concat()).out.contains("\nmine "));
    bench.write("plugins/mine.ron", "Dialect(format: 1, parent: \"grbl\",\n  extention: \"tap\")");
    let wrong = relief(&bench, &["dialect=mine"]);
    assert_eq!(wrong.status, 2);
    assert!(wrong.err.contains("did you mean \"extension\"?"), "{}", wrong.err);
    let doctor = bench.carve(&[&["plugins", "doctor"][..], &plugins].concat()).out;
    assert!(doctor.contains("plugins/mine.ron:2:3"), "{doctor}");
}

#[test]
fn machines_and_tools_of_a_plugin_folder_are_used_by_name() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("plugins")).unwrap();
    bench.write("mine.ron", "Dialect(format: 1, parent: \"grbl\", extension: \"cnc\")");
    bench.write(
        "garage.ron",
        "Machine(format: 1, dialect: \"mine\", travel: (x: 90, y: 90, z: 40), spindle: (min: 5000, max: 9000))",
    );
    bench.write(
        "drawer.ron",
        "Tools(format: 1, tools: {\"stub\": (shape: \"ball\", dimensions: {\"diameter\": 2}, \
         materials: {\"lime\": (feed: 777, plunge: 333, spindle: 8000)})})",
    );
    for (file, sort) in [("mine", "dialect"), ("garage", "machine"), ("drawer", "tools")] {
        let file = format!("{file}.ron");
        let installed = bench.carve(&["plugins", "install", &file, "--plugins", "plugins"]);
        assert_eq!(installed.out, format!("{sort} plugins/{file}\n"), "{}", installed.err);
    }
    let listed = |list: &str| bench.carve(&[list, "--plugins", "plugins"]).out;
    assert!(listed("machines").contains("garage"), "{}", listed("machines"));
    assert!(listed("tools").contains("stub"), "{}", listed("tools"));
    let chosen = ["machine=garage", "tool=stub", "material=lime"];
    let answer = relief(&bench, &chosen);
    assert_eq!(answer.status, 0, "{}", answer.err);
    let program = bench.text("out/medallion.cnc");
    assert!(program.contains("S8000") && program.contains("F777.0"), "{}", &program[..400]);
    let too_large =
        relief(&bench, &[&chosen[..], &["canvas_width=95", "canvas_height=95"]].concat());
    assert_eq!(too_large.status, 2, "{}", too_large.err);
    for axis in ["X needs", "Y needs"] {
        assert!(too_large.err.contains(axis), "{}", too_large.err);
    }
    assert!(too_large.err.contains("the machine travels 90 mm: "), "{}", too_large.err);
    let too_fast = relief(&bench, &[&chosen[..], &["spindle=12000"]].concat());
    assert_eq!(too_fast.status, 2, "{}", too_fast.err);
    assert!(too_fast.err.contains("3000 rpm too fast"), "{}", too_fast.err);
}

#[test]
fn files_that_name_what_there_is_not_are_not_installed() {
    let bench = Bench::new();
    for (text, why) in [
        (
            "Machine(format: 1, dialect: \"gbrl\", travel: (x: 1, y: 1, z: 1))",
            "did you mean \"grbl\"?",
        ),
        ("Tools(format: 1, tools: {\"a\": (shape: \"bal\")})", "did you mean \"ball\"?"),
        ("Tools(format: 1, tools: {\"ball_6\": (shape: \"ball\")})", "which carve has already"),
        (
            "Dialect(format: 1, parent: \"grbl\", name: \"haas\")",
            "\"haas\" is one of the standard dialects",
        ),
        ("Recipe(format: 1)", "it begins with none of Dialect(, Machine( and Tools("),
    ] {
        bench.write("mine.ron", text);
        let answer = bench.carve(&["plugins", "install", "mine.ron", "--plugins", "plugins"]);
        assert_eq!(answer.status, 2, "{text}");
        assert!(answer.err.contains(why), "{text}: {}", answer.err);
        assert!(!bench.path("plugins").exists(), "{text}");
    }
}

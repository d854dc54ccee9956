//! What was made is not made again, and what is damaged is.

use crate::bench::{Bench, QUICK, Report};
use std::fs;

/// A small job, with its cache in `kept`.
const JOB: [&str; 15] = {
    let [a, b, c, d, e, f, g, h, i, j] = QUICK;
    ["relief", a, b, c, d, e, f, g, h, i, j, "--set", "image=hills.png", "--cache", "kept"]
};

fn bench() -> Bench {
    let bench = Bench::new();
    bench.hills("hills.png", (40, 40));
    bench
}

fn again(bench: &Bench, arguments: &[&str]) -> Report {
    bench.run(&[&JOB[..], arguments].concat())
}

/// The files of the job with these settings, made without any cache.
fn fresh(bench: &Bench, settings: &[&str]) -> std::collections::BTreeMap<String, Vec<u8>> {
    bench.run(&[&JOB[..13], settings, &["--out", "fresh"]].concat());
    bench.files("fresh")
}

fn entries(bench: &Bench) -> Vec<String> {
    let files = bench.files("kept").into_keys();
    files.filter(|name| name.ends_with(".entry")).map(|name| format!("kept/{name}")).collect()
}

#[test]
fn a_second_run_runs_nothing() {
    let bench = bench();
    let first = again(&bench, &[]);
    let files = bench.files("out");
    let second = again(&bench, &[]);
    assert_eq!(second.nodes_that("ran"), [""; 0]);
    assert_eq!(second.nodes_that("cached").len(), 25);
    let unused = ["inspection/ball", "inspection/file", "inspection/placed", "inspection/shell"];
    assert_eq!(second.nodes_that("skipped"), [&unused[..], &["save_points"]].concat());
    assert_eq!(bench.files("out"), files);
    assert_eq!(files, fresh(&bench, &[]));
    // The report of what is cached says what it said when it was made.
    assert_eq!(second.0["files"], first.0["files"]);
    for (id, node) in first.0["nodes"].as_object().unwrap() {
        assert_eq!(node["outputs"], second.node(id)["outputs"], "{id}");
        assert_eq!(node["notes"], second.node(id)["notes"], "{id}");
    }
}

#[test]
fn a_lost_file_is_written_anew_and_nothing_else() {
    let bench = bench();
    again(&bench, &[]);
    let files = bench.files("out");
    for (file, saver) in
        [("hills.nc", "save_gcode"), ("hills.stl", "save_mesh"), ("hills.txt", "summary")]
    {
        fs::remove_file(bench.path("out").join(file)).unwrap();
        let report = again(&bench, &[]);
        assert_eq!(report.nodes_that("ran"), [saver]);
        assert_eq!(bench.files("out"), files);
    }
    // So is a file that somebody changed.
    bench.write("out/hills.nc", "G0 Z-100\n");
    assert_eq!(again(&bench, &[]).nodes_that("ran"), ["save_gcode"]);
    assert_eq!(bench.files("out"), files);
    // And all of them, in another folder.
    let report = again(&bench, &["--out", "elsewhere"]);
    assert_eq!(
        report.nodes_that("ran"),
        [
            "inspection/carved",
            "inspection/map",
            "preview",
            "preview_path",
            "save_gcode",
            "save_mesh",
            "summary"
        ]
    );
    assert_eq!(bench.files("elsewhere"), files);
}

#[test]
fn a_new_tolerance_reduces_again_and_what_follows() {
    let bench = bench();
    again(&bench, &[]);
    let report = again(&bench, &["--set", "tolerance=0.02"]);
    assert_eq!(
        report.nodes_that("ran"),
        [
            "inspection/carved",
            "inspection/deviation",
            "inspection/map",
            "inspection/read",
            "inspection/simulate",
            "inspection/time",
            "inspection/verify",
            "link",
            "post",
            "preview_path",
            "reduce",
            "save_gcode",
            "summary"
        ]
    );
    assert_eq!(bench.files("out"), fresh(&bench, &["--set", "tolerance=0.02"]));
    // Both are kept now.
    assert!(again(&bench, &["--set", "tolerance=0.02"]).nodes_that("ran").is_empty());
    let report = again(&bench, &[]);
    assert_eq!(
        report.nodes_that("ran"),
        ["inspection/carved", "inspection/map", "preview_path", "save_gcode", "summary"]
    );
}

#[test]
fn the_same_value_written_otherwise_is_the_same() {
    let bench = bench();
    again(&bench, &["--set", "tolerance=0.0254"]);
    let report = again(&bench, &["--set", "tolerance=0.001in"]);
    assert!(report.nodes_that("ran").is_empty(), "{:?}", report.nodes_that("ran"));
}

#[test]
fn a_changed_picture_of_the_same_name_runs_again() {
    let bench = bench();
    again(&bench, &[]);
    let before = bench.read("out/hills.nc");
    bench.picture("hills.png", (40, 40), |x, y| (x * y % 251) as u8);
    let report = again(&bench, &[]);
    let same = ["save_points", "tool"];
    let ran = report.nodes_that("ran");
    assert!(same.iter().all(|id| !ran.contains(id)), "{ran:?}");
    for id in ["photo", "gray", "smooth", "relief", "drop", "post", "save_gcode", "summary"] {
        assert!(ran.contains(&id), "{id} is not among {ran:?}");
    }
    assert_ne!(bench.read("out/hills.nc"), before);
    assert_eq!(bench.files("out"), fresh(&bench, &[]));
}

#[test]
fn the_same_picture_of_another_name_only_writes_anew() {
    let bench = bench();
    again(&bench, &[]);
    fs::rename(bench.path("hills.png"), bench.path("mounds.png")).unwrap();
    let report = again(&bench, &["--set", "image=mounds.png"]);
    let ran = report.nodes_that("ran");
    for id in ["photo", "gray", "smooth", "relief", "drop", "reduce", "link"] {
        assert!(!ran.contains(&id), "{id} is among {ran:?}");
    }
    assert!(bench.path("out/mounds.nc").is_file());
    // The title in a program is the picture's.
    assert!(bench.text("out/mounds.nc").starts_with("(Carvegraph: mounds)\n"));
}

#[test]
fn damaged_entries_are_made_anew() {
    let bench = bench();
    again(&bench, &[]);
    let right = fresh(&bench, &["--set", "tolerance=0.02"]);
    let harms: [fn(&mut Vec<u8>); 6] = [
        |bytes| {
            let at = bytes.len() / 2;
            bytes[at] ^= 1;
        },
        |bytes| *bytes.last_mut().unwrap() ^= 0x80,
        |bytes| bytes[20] ^= 4,
        |bytes| bytes[8..16].fill(0xff),
        |bytes| bytes.truncate(bytes.len() / 2),
        Vec::clear,
    ];
    for (at, harm) in harms.into_iter().enumerate() {
        for entry in entries(&bench) {
            let mut bytes = bench.read(&entry);
            harm(&mut bytes);
            bench.write(&entry, bytes);
        }
        // Files that are as they were written are not looked into the cache for.
        let _ = fs::remove_dir_all(bench.path("out"));
        let report = again(&bench, &["--set", "tolerance=0.02"]);
        assert!(report.nodes_that("ran").contains(&"drop"), "harm {at} was not seen");
        assert!(report.nodes_that("failed").is_empty());
        assert!(bench.files("out") == right, "harm {at} shows");
        // And kept again, whole.
        fs::remove_dir_all(bench.path("out")).unwrap();
        let report = again(&bench, &["--set", "tolerance=0.02"]);
        assert!(!report.nodes_that("ran").contains(&"drop"), "harm {at} stays");
        assert!(bench.files("out") == right, "harm {at} shows later");
    }
}

#[test]
fn strange_files_in_the_cache_are_let_be() {
    let bench = bench();
    again(&bench, &[]);
    bench.write("kept/notes.txt", "mine");
    fs::create_dir(bench.path("kept/folder")).unwrap();
    assert!(again(&bench, &[]).nodes_that("ran").is_empty());
    assert_eq!(bench.text("kept/notes.txt"), "mine");
    // Nothing unfinished stays behind.
    assert!(bench.files("kept").keys().all(|name| !name.ends_with(".part")));
}

#[test]
fn a_plan_tells_why_a_node_runs() {
    let bench = bench();
    let plan = |settings: &[&str], explain: &str| {
        let arguments = [&["plan"], &JOB[..], settings, &["--explain", explain]].concat();
        let answer = bench.carve(&arguments);
        assert_eq!(answer.status, 0, "{}", answer.err);
        answer.out
    };
    let first = plan(&[], "reduce");
    assert!(first.contains("reduce runs\n"), "{first}");
    assert!(first.contains("no earlier run with this cache is known"), "{first}");

    again(&bench, &[]);
    assert!(plan(&[], "reduce").starts_with("reduce is cached"), "{}", plan(&[], "reduce"));

    let changed = ["--set", "tolerance=0.02"];
    let why = plan(&changed, "reduce");
    assert!(why.contains("reduce: parameter tolerance was 0.01, is 0.02"), "{why}");
    let later = plan(&changed, "save_gcode");
    for line in [
        "save_gcode: input program changed, since inspection/verify did",
        "inspection/verify: input program changed, since post did",
        "post: input toolpath changed, since link did",
        "link: input toolpath changed, since reduce did",
        "reduce: parameter tolerance was 0.01, is 0.02",
    ] {
        assert!(later.contains(line), "{line:?} in {later}");
    }
    assert!(plan(&changed, "drop").starts_with("drop is read from the cache"));

    bench.picture("hills.png", (40, 40), |x, _| x as u8);
    let why = plan(&[], "photo");
    assert!(why.contains("photo: contents of path was "), "{why}");
    let wrong = bench.carve(&["plan", "relief", "--explain", "reduc"]);
    assert_eq!(wrong.status, 2);
    assert!(wrong.err.contains("did you mean \"reduce\"?"), "{}", wrong.err);
}

/// A run that did not get there must not be taken for the last one when it is asked why.
#[test]
fn a_plan_still_tells_why_after_a_run_that_failed() {
    let bench = bench();
    again(&bench, &[]);
    // The tool change makes the post-processor fail, so that no program was written with it.
    let arguments = [&["run"], &JOB[..], &["--set", "post.tool=3"]].concat();
    assert_eq!(bench.carve(&arguments).status, 1);
    let arguments = [&["plan"], &JOB[..], &["--set", "post.tool=3", "--explain", "post"]].concat();
    let why = bench.carve(&arguments).out;
    assert!(why.contains("post: parameter tool was 0, is 3"), "{why}");
}

#[test]
fn a_plan_shows_what_is_cached() {
    let bench = bench();
    again(&bench, &[]);
    let arguments = [&["plan"], &JOB[..], &["--set", "tolerance=0.02"]].concat();
    let plan = bench.carve(&arguments).out;
    let line = |id: &str| {
        let mut lines = plan.lines().filter(|line| line.split_whitespace().next() == Some(id));
        lines.next().unwrap_or_else(|| panic!("{id} is not in {plan}")).to_owned()
    };
    assert!(line("reduce").contains(" runs "), "{plan}");
    assert!(line("drop").contains(" is read from the cache "), "{plan}");
    assert!(line("preview").contains(" is cached "), "{plan}");
    assert!(line("save_points").contains(" rests: no points are to be saved"), "{plan}");
}

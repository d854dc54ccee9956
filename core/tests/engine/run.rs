//! Doing it: on many threads, with failures, panics and interruptions.

use crate::toy::{Shop, files, recipe, told, value};
use carvegraph_core::{
    NodeReport, NodeStatus, Note, Observer, Plan, RunOptions, RunStatus, Session, Weight,
};
use std::sync::Mutex;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

#[test]
fn kernels_share_the_threads_without_deadlock() {
    // More nodes than threads, each of which waits for its own loop inside a loop, and takes up
    // others while it waits.
    let mut nodes = String::new();
    for at in 0..400 {
        let from = if at % 5 == 0 {
            String::new()
        } else {
            format!("from: {{\"number\": \"n{}\"}}", at - 1)
        };
        nodes += &format!("\"n{at}\": (kind: \"busy\", {from}),\n");
    }
    let outputs: Vec<String> = (0..400).map(|at| format!("\"n{at}\"")).collect();
    for threads in [1, 2, 8] {
        let mut shop = Shop::new();
        shop.threads = threads;
        let report = shop.run(&recipe(&nodes, &outputs.join(",")));
        assert_eq!((report.status, report.threads), (RunStatus::Done, threads));
        assert_eq!(value(&report, "n399"), 2000.0);
    }
}

#[test]
fn each_node_runs_once() {
    // Many that can begin at once, so that some end while others are still being begun, and after
    // them, wherever they are sorted to, some that those make ready.
    let nodes: String = (0..6000)
        .map(|at| match at % 600 {
            0..500 => format!("\"n{at}\": (kind: \"number\"),\n"),
            _ => format!("\"n{at}\": (kind: \"add\", from: {{\"a\": \"n{}\"}}),\n", at / 600 * 600),
        })
        .collect();
    let all: Vec<String> = (0..6000).map(|at| format!("\"n{at}\"")).collect();
    let mut shop = Shop::new();
    shop.threads = 8;
    let graph = shop.graph(&recipe(&nodes, &all.join(",")));
    for _ in 0..10 {
        let plan = Plan::new(&graph, &[], &shop.out(), None, &Default::default()).unwrap();
        let log = Log::default();
        let options = RunOptions { threads: 8, cache: None, observer: &log };
        let report = carvegraph_core::run(&plan, &Session::new(&shop.out()), options);
        assert_eq!(report.status, RunStatus::Done);
        let lines = log.0.into_inner().unwrap();
        assert_eq!(lines.iter().filter(|line| line.ends_with("started")).count(), 6000);
    }
}

#[test]
fn nodes_run_beside_each_other() {
    let nodes: String =
        (0..8).map(|at| format!("\"n{at}\": (kind: \"slow\", set: {{\"time\": 100}}),")).collect();
    let mut shop = Shop::new();
    shop.threads = 8;
    let all = (0..8).map(|at| format!("\"n{at}\"")).collect::<Vec<_>>().join(",");
    let report = shop.run(&recipe(&nodes, &all));
    let alone: f64 = report.nodes.values().map(|node| node.wall_s).sum();
    assert!(report.wall_s < alone / 2.0, "{} of {alone}", report.wall_s);
}

#[test]
fn a_value_is_dropped_at_its_last_reader() {
    // A chain: while a node runs, what it reads and what it makes are alive, and nothing else.
    let mut nodes = r#""t0": (kind: "mint"),"#.to_owned();
    for at in 1..20 {
        nodes += &format!("\"t{at}\": (kind: \"melt\", from: {{\"a\": \"t{}\"}}),", at - 1);
    }
    let shop = Shop::new();
    assert_eq!(shop.run(&recipe(&nodes, r#""t19""#)).status, RunStatus::Done);
    let count = |counter: &std::sync::atomic::AtomicUsize| counter.load(Ordering::SeqCst);
    assert_eq!((count(&shop.lab.most), count(&shop.lab.alive)), (2, 0));

    // The first one is read at the end again, so it stays alive all along.
    let shop = Shop::new();
    let last = r#""last": (kind: "melt", from: {"a": "t19", "b": "t0"})"#;
    assert_eq!(shop.run(&recipe(&(nodes + last), r#""last""#)).status, RunStatus::Done);
    assert_eq!((count(&shop.lab.most), count(&shop.lab.alive)), (3, 0));
}

#[test]
fn a_value_that_nobody_reads_is_dropped_at_once() {
    let mut shop = Shop::new();
    shop.threads = 1;
    let nodes: String = (0..9).map(|at| format!("\"t{at}\": (kind: \"mint\"),")).collect();
    let all = (0..9).map(|at| format!("\"t{at}\"")).collect::<Vec<_>>().join(",");
    assert_eq!(shop.run(&recipe(&nodes, &all)).status, RunStatus::Done);
    assert_eq!(shop.lab.most.load(Ordering::SeqCst), 1);
}

#[test]
fn one_node_may_be_read_at_two_ports() {
    let nodes = r#""n": (kind: "number", set: {"value": 4}), "z": (kind: "add", from: {"a": "n", "b": "n"})"#;
    assert_eq!(value(&Shop::new().run(&recipe(nodes, r#""z""#)), "z"), 8.0);
}

const MIXED: &str = r#""f": (kind: "fail", set: {"how": "HOW"}),
"g": (kind: "add", from: {"a": "f"}),
"h": (kind: "save", from: {"number": "g"}, set: {"name": "never"}),
"n": (kind: "number"),
"s": (kind: "save", from: {"number": "n"}, set: {"name": "kept"})"#;

#[test]
fn a_failing_or_panicking_node_fails_alone() {
    for (how, reason) in [
        ("failed", "as it should"),
        (
            "panic",
            "this node has a fault of its own and broke off (out of cheese); please report it",
        ),
    ] {
        for threads in [1, 4] {
            let mut shop = Shop::new();
            shop.threads = threads;
            let report = shop.run(&recipe(&MIXED.replace("HOW", how), r#""h", "s""#));
            assert_eq!(report.status, RunStatus::Failed);
            assert_eq!(
                told(&report),
                format!(
                    "f failed: {reason}, g skipped: nothing came from \"f\", which it reads, \
                     h skipped: nothing came from \"g\", which it reads, n ran, s ran"
                )
            );
            assert_eq!(files(&report), ["kept.txt"]);
            assert_eq!(shop.outputs().unwrap(), ["kept.txt"]);
        }
    }
}

#[test]
fn a_refusal_calls_everything_off() {
    let shop = Shop::new();
    let nodes = format!(
        r#"{}, "slow": (kind: "slow", from: {{"number": "n"}}, set: {{"time": 30000}})"#,
        MIXED.replace("HOW", "refused")
    );
    let start = Instant::now();
    let report = shop.run(&recipe(&nodes, r#""s", "h", "slow""#));
    assert!(start.elapsed() < Duration::from_secs(10));
    assert_eq!(report.status, RunStatus::Refused);
    let node = |id: &str| {
        let node = &report.nodes[id];
        (node.status, node.reason.as_deref().unwrap_or_default())
    };
    assert_eq!(node("f"), (NodeStatus::Failed, "this is absurd"));
    assert_eq!(node("slow"), (NodeStatus::Skipped, "interrupted"));
    assert_eq!(report.files, Vec::<String>::new());
    assert_eq!(shop.outputs(), None);
}

/// Calls a run off while a kernel is at work; how long it went on.
fn call_off() -> Duration {
    let mut shop = Shop::new();
    shop.threads = 4;
    let nodes = r#""n": (kind: "number"), "s": (kind: "save", from: {"number": "n"}),
"slow": (kind: "slow", from: {"number": "n"}, set: {"time": 30000}), "z": (kind: "add", from: {"a": "slow"})"#;
    let graph = shop.graph(&recipe(nodes, r#""s", "z""#));
    let plan = Plan::new(&graph, &[], &shop.out(), None, &Default::default()).unwrap();
    let session = Session::new(&shop.out());
    let stopper = session.cancel.clone();
    let lab = std::sync::Arc::clone(&shop.lab);
    let stopping = std::thread::spawn(move || {
        while lab.begun.load(Ordering::SeqCst) == 0 {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(50));
        stopper.cancel();
        Instant::now()
    });
    let options = RunOptions { threads: 4, cache: None, observer: &() };
    let report = carvegraph_core::run(&plan, &session, options);
    let went_on = stopping.join().unwrap().elapsed();
    assert_eq!(report.status, RunStatus::Interrupted);
    assert_eq!(report.nodes["slow"].status, NodeStatus::Skipped);
    assert_eq!(report.nodes["z"].reason.as_deref(), Some("interrupted"));
    assert_eq!(shop.outputs(), None);
    went_on
}

#[test]
fn a_run_that_is_called_off_ends_at_once_and_leaves_nothing() {
    // The fastest of a few, for the machine may be at other work.
    let answer = (0..4).map(|_| call_off()).min().unwrap();
    assert!(answer < Duration::from_millis(100), "{answer:?}");
}

#[test]
fn a_run_called_off_beforehand_begins_nothing() {
    let shop = Shop::new();
    let graph = shop.graph(&recipe(MIXED, r#""s", "h""#));
    let plan = Plan::new(&graph, &[], &shop.out(), None, &Default::default()).unwrap();
    let session = Session::new(&shop.out());
    session.abandon();
    let options = RunOptions { threads: 1, cache: None, observer: &() };
    let report = carvegraph_core::run(&plan, &session, options);
    assert_eq!(report.status, RunStatus::Interrupted);
    assert!(report.nodes.values().all(|node| node.status == NodeStatus::Skipped));
    assert_eq!(shop.outputs(), None);
}

#[test]
fn reports_say_the_same_on_any_number_of_threads() {
    let mut nodes = MIXED.replace("HOW", "failed");
    for at in 0..30 {
        nodes += &format!(
            ",\n\"a{at}\": (kind: \"add\", from: {{\"a\": \"n\"}}), \"s{at}\": (kind: \"save\", from: {{\"number\": \"a{at}\"}}, set: {{\"name\": \"x{}\"}})",
            at % 20
        );
    }
    let outputs: Vec<String> = (0..30).rev().map(|at| format!("\"s{at}\"")).collect();
    let text = recipe(&nodes, &format!("{}, \"h\", \"s\"", outputs.join(",")));
    let run = |threads| {
        let mut shop = Shop::new();
        shop.threads = threads;
        let mut report = shop.run(&text);
        let names = files(&report).join(" ");
        report.files.clear();
        (report.wall_s, report.threads, report.peak_rss_mb) = (0.0, 0, None);
        report.nodes.values_mut().for_each(|node| node.wall_s = 0.0);
        assert_eq!(shop.outputs().unwrap().len(), 21);
        (serde_json::to_string_pretty(&report).unwrap(), names)
    };
    let (first, names) = run(1);
    assert!(first.contains("x5.txt is already written by node \\\"s5\\\""), "{first}");
    assert!(names.starts_with("kept.txt x0.txt x1.txt x2.txt"), "{names}");
    for threads in [2, 8, 8, 8] {
        assert_eq!(run(threads), (first.clone(), names.clone()));
    }
}

#[derive(Default)]
struct Log(Mutex<Vec<String>>);

impl Log {
    fn add(&self, line: String) {
        self.0.lock().unwrap().push(line);
    }
}

impl Observer for Log {
    fn started(&self, node: &str) {
        self.add(format!("{node} started"));
    }

    fn progressed(&self, node: &str, share: f64) {
        self.add(format!("{node} at {share}"));
    }

    fn noted(&self, node: &str, note: &Note) {
        assert_eq!(note.weight, Weight::Note);
        self.add(format!("{node} noted: {}", note.text));
    }

    fn finished(&self, node: &str, report: &NodeReport) {
        self.add(format!("{node} {:?}", report.status));
    }
}

#[test]
fn observers_hear_of_begin_progress_notes_and_end() {
    let shop = Shop::new();
    let nodes = r#""slow": (kind: "slow", set: {"time": 4}), "z": (kind: "add", from: {"a": "slow"}),
"g": (kind: "gate", from: {"number": "slow"}, set: {"open": false})"#;
    let graph = shop.graph(&recipe(nodes, r#""z", "g""#));
    let plan = Plan::new(&graph, &[], &shop.out(), None, &Default::default()).unwrap();
    let log = Log::default();
    let options = RunOptions { threads: 2, cache: None, observer: &log };
    let report = carvegraph_core::run(&plan, &Session::new(&shop.out()), options);
    assert_eq!(
        log.0.into_inner().unwrap(),
        [
            "slow started",
            "slow at 0.25",
            "slow at 0.5",
            "slow at 0.75",
            "slow at 1",
            "slow Ran",
            "z started",
            "z noted: only one number",
            "z Ran"
        ]
    );
    assert_eq!(report.nodes["z"].notes[0].text, "only one number");
}

#[test]
fn too_many_threads_are_no_panic() {
    let mut shop = Shop::new();
    shop.threads = 3;
    assert_eq!(shop.run(&recipe(r#""n": (kind: "number")"#, r#""n""#)).threads, 3);
    shop.threads = 0;
    let cores = std::thread::available_parallelism().unwrap().get();
    assert_eq!(shop.run(&recipe(r#""n": (kind: "number")"#, r#""n""#)).threads, cores);
}

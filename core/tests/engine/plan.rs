//! What has to be done.

use crate::toy::{Shop, lines, recipe, told};
use carvegraph_core::{Plan, Step};

const TWO_ENDS: &str = r#""n": (kind: "number"), "m": (kind: "number"),
"a": (kind: "add", from: {"a": "n"}), "b": (kind: "add", from: {"a": "m", "b": "a"}),
"spare": (kind: "add", from: {"a": "b"})"#;

/// The nodes that run, in the order of the plan.
#[track_caller]
fn check(outputs: &str, only: &[&str], expected: &[&str]) {
    let shop = Shop::new();
    let graph = shop.graph(&recipe(TWO_ENDS, outputs));
    let only: Vec<String> = only.iter().map(|id| (*id).to_owned()).collect();
    let plan = Plan::new(&graph, &only, &shop.out(), None, &Default::default()).unwrap();
    let runs = |at: &usize| matches!(plan.steps[*at], Some(Step::Run));
    let mut ids: Vec<_> =
        plan.in_order().filter(runs).map(|at| graph.nodes[at].id.as_str()).collect();
    let place = |id: &str| ids.iter().position(|other| *other == id);
    for (source, reader) in [("n", "a"), ("m", "b"), ("a", "b"), ("b", "spare")] {
        if let (Some(source), Some(reader)) = (place(source), place(reader)) {
            assert!(source < reader, "{ids:?}");
        }
    }
    ids.sort_unstable();
    assert_eq!(ids, expected);
}

#[test]
fn only_what_the_outputs_need_is_planned() {
    check(r#""a""#, &[], &["a", "n"]);
    check(r#""b""#, &[], &["a", "b", "m", "n"]);
    check(r#""a", "m""#, &[], &["a", "m", "n"]);
    check(r#""spare", "a""#, &[], &["a", "b", "m", "n", "spare"]);
}

#[test]
fn the_call_may_want_other_nodes_than_the_recipe() {
    check(r#""spare""#, &["a"], &["a", "n"]);
    check(r#""n""#, &["b", "a"], &["a", "b", "m", "n"]);
}

#[test]
fn unknown_nodes_are_told_all_at_once() {
    let shop = Shop::new();
    let graph = shop.graph(&recipe(TWO_ENDS, r#""a""#));
    let only = ["spar".to_owned(), "a".to_owned(), "zebra".to_owned()];
    let faults = Plan::new(&graph, &only, &shop.out(), None, &Default::default()).err().unwrap();
    assert_eq!(
        lines(&faults),
        [
            r#" there is no node "spar"; did you mean "spare"?"#,
            r#" there is no node "zebra"; there is a, b, m, n, spare"#
        ]
    );
}

#[test]
fn a_node_that_is_wanted_but_has_nothing_to_do_rests() {
    let nodes = r#""n": (kind: "number"), "s": (kind: "save", from: {"number": "n"}, set: {"style": "none"}),
"t": (kind: "save", from: {"number": "n"}, set: {"style": "none"})"#;
    let shop = Shop::new();
    let report = shop.run(&recipe(nodes, r#""s""#));
    assert_eq!(
        told(&report),
        "n skipped: no output needs it, s skipped: style is none, t skipped: no output needs it"
    );
    assert_eq!(shop.outputs(), None);
}

/// Recursion anywhere would overflow the two megabytes that a test's thread has.
#[test]
fn ten_thousand_nodes_in_a_row_are_checked_planned_run_and_explained() {
    let mut nodes = r#""n0": (kind: "number"),"#.to_owned();
    for at in 1..10_000 {
        nodes += &format!(
            "\"n{at}\": (kind: \"add\", from: {{\"a\": \"n{}\", \"b\": \"n0\"}}),\n",
            at - 1
        );
    }
    let shop = Shop::new();
    let text = recipe(&nodes, r#""n9999""#);
    let report = shop.run(&text);
    assert_eq!(crate::toy::value(&report, "n9999"), 10_000.0);
    let cache = carvegraph_core::MemoryCache::new(1 << 30);
    shop.run_cached(&text, Some(&cache));
    let graph = shop.graph_with(&text, &["n0.value=2"]).unwrap();
    let plan = Plan::new(&graph, &[], &shop.out(), Some(&cache), &Default::default()).unwrap();
    let lines = plan.explain("n9999", Some(&cache)).unwrap();
    assert!(lines.contains(&"n0: parameter value was 1, is 2".to_owned()));
    assert_eq!(lines.len(), 29_999);
}

//! What can be wrong with the form of a recipe.

use crate::toy::{Shop, lines};
use carvegraph_core::recipe::{MAX_NODES, MAX_VALUE_BYTES};

#[track_caller]
fn check(text: &str, expected: &[&str]) {
    let faults = Shop::new().open(text).expect_err(text);
    assert_eq!(lines(&faults), expected, "{text}");
}

#[test]
fn a_recipe_keeps_names_order_and_places() {
    let text = r#"Recipe(format: 1, title: "T", about: "A", layout: {"x": (1, 2)},
params: {"p": (sets: ["b.value", "a.value"], about: "P")},
inputs: {"i": (feeds: ["c.a"])},
nodes: {
  "b": (kind: "number", set: {"value": 2}, note: "first"),
  "a": (kind: "number"),
  "c": (kind: "add", from: {"a": "a", "b": "b.number"}),
}, outputs: ["c", "a"])"#;
    let recipe = Shop::new().open(text).unwrap();
    assert_eq!((recipe.title.as_str(), recipe.about.as_str()), ("T", "A"));
    let ids: Vec<_> = recipe.nodes.iter().map(|node| node.id.text.as_str()).collect();
    assert_eq!(ids, ["b", "a", "c"]);
    assert_eq!(recipe.nodes[2].from[1].1.span.to_string(), "toy.ron:7:44");
    let targets = recipe.params[0].targets.iter().map(|target| target.text.as_str());
    assert_eq!(targets.collect::<Vec<_>>(), ["b.value", "a.value"]);
    assert_eq!(recipe.params[0].about, "P");
    assert_eq!(recipe.inputs[0].targets[0].text, "c.a");
    assert_eq!(recipe.outputs[1].span.to_string(), "toy.ron:8:19");
}

#[test]
fn missing_and_unknown_fields_are_told_all_at_once() {
    check(
        r#"(format: 1, nodez: {},
 nodes: {"a": (kid: "number", set: {}), "b": ()})"#,
        &[
            r#"1:1 the recipe lacks the field "outputs""#,
            r#"1:13 the recipe has no field "nodez"; did you mean "nodes"?"#,
            r#"2:15 node "a" lacks the field "kind""#,
            r#"2:16 node "a" has no field "kid"; did you mean "kind"?"#,
            r#"2:46 node "b" lacks the field "kind""#,
        ],
    );
    check(
        r#"(nodes: {}, outputs: ["a"], banana: 1)"#,
        &[
            r#"1:1 the recipe lacks the field "format""#,
            r#"1:29 the recipe has no field "banana"; there is about, format, inputs, layout, nodes, outputs, params, title"#,
        ],
    );
}

#[test]
fn values_of_the_wrong_type_are_told() {
    check("[]", &["1:1 the recipe must be fields in (...), not a list [...]"]);
    check(
        r#"(format: 1, title: 5, nodes: ["a"], params: {"p": [], "q": (sets: "a.b")}, outputs: "a")"#,
        &[
            r#"1:20 title must be a text in double quotes, not a whole number; write "5""#,
            "1:30 nodes must be a map {...}, not a list [...]",
            r#"1:51 "p" must be fields in (...), not a list [...]"#,
            "1:67 sets must be a list [...], not a text",
            "1:85 outputs must be a list [...], not a text",
        ],
    );
    check(
        r#"(format: 1, nodes: {5: (kind: number), "b": Big(kind: "x", from: {"a": 5}, set: {"v": [1], "w": ()})}, outputs: ["b"])"#,
        &[
            r#"1:21 a key of nodes must be a text in double quotes, not a whole number; write "5""#,
            r#"1:45 before the fields of node "b" stands nothing, not "Big""#,
            r#"1:72 a source in from must be a text in double quotes, not a whole number; write "5""#,
            "1:87 v must be a number, a text, true or false, not a list [...]",
            "1:97 w must be a number, a text, true or false, not an empty ()",
        ],
    );
}

#[test]
fn of_a_newer_format_nothing_else_is_said() {
    check(
        r#"(format: 2, nodes: 5, colour: "red")"#,
        &[
            "1:10 this recipe has format 2; this program reads formats up to 1; update carve to run it",
        ],
    );
    check(
        r#"(format: 0, nodes: 5, outputs: ["a"])"#,
        &[
            "1:10 there is no format 0; the first one is 1",
            "1:20 nodes must be a map {...}, not a whole number",
        ],
    );
    check(
        r#"(format: "1", nodes: {}, outputs: ["a"])"#,
        &["1:10 format must be a whole number, not a text"],
    );
}

#[test]
fn names_are_plain() {
    let long = "x".repeat(65);
    for name in ["", "a.b", "a/b", "a b", "ä", "../a", &long] {
        let help = "letters, digits, _ and - do, 64 at most";
        check(
            &format!(r#"(format: 1, nodes: {{{name:?}: (kind: "add")}}, outputs: ["a"])"#),
            &[&format!("1:21 {name:?} is no name for a node; {help}")],
        );
        check(
            &format!(
                r#"(format: 1, params: {{{name:?}: (sets: [])}}, nodes: {{}}, outputs: ["a"])"#
            ),
            &[&format!("1:22 {name:?} is no name for what a user sets; {help}")],
        );
    }
}

#[test]
fn nothing_is_named_twice() {
    check(
        r#"(format: 1, params: {"p": (sets: ["a.x", "a.y"]), "q": (sets: ["a.x"])},
 inputs: {"i": (feeds: ["a.a", "a.a"])}, nodes: {"a": (kind: "add"), "a": (kind: "add")}, outputs: ["a"])"#,
        &[r#"2:70 duplicate key "a"; the first is on line 2"#],
    );
    check(
        r#"(format: 1, params: {"p": (sets: ["a.x", "a.y"]), "q": (sets: ["a.x"])},
 inputs: {"i": (feeds: ["a.a", "a.a"])}, nodes: {}, outputs: ["a", "b", "a"])"#,
        &[
            r#"1:64 params drives "a.x" twice"#,
            r#"2:32 inputs drives "a.a" twice"#,
            r#"2:73 outputs names "a" twice"#,
        ],
    );
    check(
        "(format: 1, nodes: {}, outputs: [])",
        &["1:33 outputs is empty, so the recipe is run for nothing"],
    );
}

#[test]
fn limits_are_named() {
    let nodes = |count: usize| {
        let nodes = (0..count).map(|at| format!("\"n{at}\": (kind: \"number\"),"));
        format!("(format: 1, nodes: {{{}}}, outputs: [\"n0\"])", nodes.collect::<String>())
    };
    assert_eq!(Shop::new().open(&nodes(MAX_NODES)).unwrap().nodes.len(), MAX_NODES);
    check(&nodes(MAX_NODES + 1), &["1:20 the recipe has 10001 nodes; the limit is 10000"]);
    // The reader does not take long either, nor is its text too long.
    check(&nodes(100_000), &["1:20 the recipe has 100000 nodes; the limit is 10000"]);

    let text = |bytes: usize| {
        let text = "x".repeat(bytes);
        format!(
            r#"(format: 1, nodes: {{"a": (kind: "tool", set: {{"title": "{text}"}})}}, outputs: ["a"])"#
        )
    };
    assert!(Shop::new().open(&text(MAX_VALUE_BYTES)).is_ok());
    check(&text(MAX_VALUE_BYTES + 1), &["1:56 title has 16385 bytes; the limit is 16384"]);
}

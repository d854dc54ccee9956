//! Recipes inside recipes.

use crate::toy::{Shop, lines, recipe, told, value};
use carvegraph_core::Plan;
use std::time::{Duration, Instant};

/// Doubles what it is fed with, which is 5 where it runs alone, and adds `extra`.
const DOUBLE: &str = r#"(format: 1,
inputs: {"number": (feeds: ["twice.a", "twice.b"])},
params: {"extra": (sets: ["extra.value"])},
nodes: {
  "own": (kind: "number", set: {"value": 5}),
  "twice": (kind: "add", from: {"a": "own", "b": "own"}),
  "extra": (kind: "number", set: {"value": 0}),
  "sum": (kind: "add", from: {"a": "twice", "b": "extra"}),
  "parts": (kind: "split", from: {"number": "sum"}),
}, outputs: ["sum", "parts.text"])"#;

fn shop() -> Shop {
    let shop = Shop::new();
    shop.write("double.ron", DOUBLE);
    shop
}

fn inner(fields: &str) -> String {
    format!(r#"(kind: "recipe", {fields})"#)
}

const FED: &str = r#"from: {"number": "n"}, set: {"recipe": "double.ron", "extra": 3}"#;

#[track_caller]
fn check(shop: &Shop, text: &str, set: &[&str], expected: &[&str]) {
    let faults = shop.graph_with(text, set).err().unwrap_or_else(|| panic!("nothing is wrong"));
    let told: Vec<String> = lines(&faults)
        .iter()
        .map(|line| line.replace(&format!("{}/", shop.path("").display()).replace("//", "/"), ""))
        .collect();
    assert_eq!(told, expected, "{text}");
}

#[test]
fn a_recipe_is_a_node_with_params_inputs_and_outputs() {
    let nodes = format!(
        r#""n": (kind: "number", set: {{"value": 10}}), "d": {}, "z": (kind: "add", from: {{"a": "d.sum"}}),
"s": (kind: "save", from: {{"text": "d"}})"#,
        inner(FED)
    );
    let shop = shop();
    let report = shop.run(&recipe(&nodes, r#""z", "s""#));
    assert_eq!(value(&report, "z"), 23.0);
    assert_eq!(shop.read("toy.txt").as_deref(), Some("23"));
    // What fed it while it ran alone is not needed.
    assert_eq!(report.nodes["d/own"].reason.as_deref(), Some("no output needs it"));
    assert_eq!(told(&report).matches(" ran").count(), 7, "{}", told(&report));
}

#[test]
fn an_input_that_is_not_fed_stays_as_it_runs_alone() {
    let nodes = format!(r#""d": {}"#, inner(r#"set: {"recipe": "double.ron"}"#));
    assert_eq!(value(&shop().run(&recipe(&nodes, r#""d""#)), "d/sum"), 10.0);
    assert_eq!(value(&shop().run(DOUBLE), "sum"), 10.0);
}

#[test]
fn outer_settings_go_before_inner_ones() {
    let text = format!(
        r#"(format: 1, params: {{"more": (sets: ["d.extra"])}}, nodes: {{"n": (kind: "number"), "d": {}}}, outputs: ["d"])"#,
        inner(FED)
    );
    let shop = shop();
    let sum = |set: &[&str]| {
        let graph = shop.graph_with(&text, set).unwrap_or_else(|faults| panic!("{faults}"));
        let plan = Plan::new(&graph, &[], &shop.out(), None, &Default::default()).unwrap();
        value(&shop.run_plan(&plan, None), "d/sum")
    };
    assert_eq!(sum(&[]), 5.0);
    assert_eq!(sum(&["more=7"]), 9.0);
    assert_eq!(sum(&["d.extra=8"]), 10.0);
    assert_eq!(sum(&["d/extra.value=9"]), 11.0);
}

#[test]
fn recipes_nest() {
    let shop = shop();
    shop.write(
        "four.ron",
        r#"(format: 1, inputs: {"x": (feeds: ["a.number"])}, params: {"e": (sets: ["a.extra", "b.extra"])},
nodes: {"own": (kind: "number"),
"a": (kind: "recipe", from: {"number": "own"}, set: {"recipe": "double.ron"}),
"b": (kind: "recipe", from: {"number": "a.sum"}, set: {"recipe": "double.ron"})}, outputs: ["b.sum"])"#,
    );
    let nodes = format!(
        r#""n": (kind: "number", set: {{"value": 3}}), "f": {}"#,
        inner(r#"from: {"x": "n"}, set: {"recipe": "four.ron", "e": 1}"#)
    );
    let report = shop.run(&recipe(&nodes, r#""f.b.sum""#));
    assert_eq!(value(&report, "f/b/sum"), 15.0);
}

#[test]
fn what_an_inner_recipe_lacks_is_told() {
    let nodes = format!(
        r#""n": (kind: "number"), "d": {},
"e": {},
"f": (kind: "recipe"),
"z": (kind: "add", from: {{"a": "d.product", "b": "e"}})"#,
        inner(r#"from: {"nmber": "n"}, set: {"recipe": "double.ron", "xtra": 3}"#),
        inner(r#"set: {"recipe": "gone.ron"}"#),
    );
    check(
        &shop(),
        &recipe(&nodes, r#""z", "f""#),
        &["d.extr=1", "d/n.value=2", "d/extra.vale=3"],
        &[
            r#"--set:1:1 recipe "d" has no parameter "extr"; did you mean "extra"?"#,
            r#"--set:1:1 there is no node "d/n"; there is d/extra, d/own, d/parts, d/sum, d/twice, n, z"#,
            r#"--set:1:1 node "d/extra" (number) has no parameter "vale"; did you mean "value"?"#,
            r#"2:53 recipe "d" has no input "nmber"; did you mean "number"?"#,
            r#"2:98 recipe "d" has no parameter "xtra"; did you mean "extra"?"#,
            r#"3:39 there is no recipe "gone.ron", built in or as a file; built in are built_in"#,
            r#"4:1 node "f" does not say which recipe it stands for; add set: { "recipe": "name.ron" }"#,
            r#"5:32 recipe "d" has no output "product"; there is parts.text, sum"#,
        ],
    );
}

#[test]
fn faults_inside_are_told_once_at_their_place() {
    let shop = shop();
    shop.write("bad.ron", recipe(r#""a": (kind: "nmber"), "b": (kind: "add")"#, r#""c""#));
    let nodes = format!(
        r#""x": {0}, "y": {0}, "z": (kind: "add", from: {{"a": "x"}})"#,
        inner(r#"set: {"recipe": "bad.ron"}"#)
    );
    check(
        &shop,
        &recipe(&nodes, r#""z", "y""#),
        &[],
        &[
            r#"bad.ron:2:13 there is no kind of node called "nmber"; did you mean "number"?"#,
            r#"bad.ron:2:23 node "x/b" (add) needs its input "a"; add from: { "a": "NODE" } with a node that gives a number"#,
            r#"bad.ron:3:14 there is no node "c"; there is a, b"#,
        ],
    );
}

#[test]
fn recipes_that_use_themselves_are_refused() {
    let shop = Shop::new();
    let of = |name: &str| {
        recipe(&format!(r#""i": {}"#, inner(&format!(r#"set: {{"recipe": "{name}"}}"#))), r#""i""#)
    };
    shop.write("self.ron", of("self.ron"));
    shop.write("a.ron", of("b.ron"));
    shop.write("b.ron", of("a.ron"));
    // Each time under another path, so that only the depth tells.
    shop.write("d/.keep", "");
    shop.write("detour.ron", of("d/../detour.ron"));
    let message = "these recipes use each other in a loop:";
    let user = |name: &str| format!("// {name}\n{}", of(name));
    check(&shop, &user("self.ron"), &[], &[&format!("self.ron:2:39 {message} self -> self")]);
    check(&shop, &user("a.ron"), &[], &[&format!("b.ron:2:39 {message} a -> b -> a")]);
    check(&shop, &of("self.ron"), &[], &[&format!("2:39 {message} toy -> self")]);
    let deep = format!("{}detour.ron:2:39 recipes are nested deeper than 16", "d/../".repeat(15));
    check(&shop, &of("detour.ron"), &[], &[&deep]);
}

/// `levels` recipes, each of which uses the next one `copies` times; the last one has `nodes` nodes.
fn tower(shop: &Shop, levels: usize, copies: usize, nodes: usize, padding: usize) -> String {
    let last: String = (0..nodes).map(|at| format!(r#""n{at}": (kind: "number"),"#)).collect();
    let comment = format!("// {}", "x".repeat(padding));
    shop.write(&format!("l{levels}.ron"), format!("{}{comment}", recipe(&last, r#""n0""#)));
    for level in (0..levels).rev() {
        let next = inner(&format!(r#"set: {{"recipe": "l{}.ron"}}"#, level + 1));
        let copies: String = (0..copies).map(|copy| format!(r#""c{copy}": {next},"#)).collect();
        shop.write(&format!("l{level}.ron"), recipe(&copies, r#""c0""#));
    }
    std::fs::read_to_string(shop.path("l0.ron")).unwrap()
}

#[test]
fn what_multiplies_is_stopped_early() {
    let quick = |levels, copies, nodes, padding, message: &str| {
        let shop = Shop::new();
        let text = tower(&shop, levels, copies, nodes, padding);
        let start = Instant::now();
        let faults = shop.graph_with(&text, &[]).err().unwrap();
        let took = start.elapsed();
        assert!(took < Duration::from_secs(10), "{took:?}");
        assert_eq!(faults.len(), 1, "{faults}");
        assert!(faults.to_string().contains(message), "{faults}");
    };
    let nodes = "error: with its inner recipes the recipe has more than 10000 nodes";
    quick(16, 2, 1, 0, nodes);
    quick(15, 10, 1, 0, nodes);
    quick(1, 5000, 10, 0, nodes);
    let bytes = "error: with its inner recipes the recipe has more than 16777216 bytes";
    quick(1, 9, 1, 2_000_000, bytes);
    let shop = Shop::new();
    let text = tower(&shop, 2, 50, 2, 0);
    assert_eq!(shop.graph(&text).nodes.len(), 5000);
}

#[test]
fn outputs_may_lead_to_one_node_in_many_ways() {
    let shop = Shop::new();
    // All of these words lead to the one node at the bottom.
    let word = |length: usize| vec!["i"; length].join(".");
    shop.write("l15.ron", recipe(r#""i": (kind: "number")"#, r#""i""#));
    for level in (0..15).rev() {
        let words: Vec<String> =
            (1..=(16 - level).min(9)).map(|length| format!("{:?}", word(length))).collect();
        let next = inner(&format!(r#"set: {{"recipe": "l{}.ron"}}"#, level + 1));
        shop.write(&format!("l{level}.ron"), recipe(&format!(r#""i": {next}"#), &words.join(",")));
    }
    let start = Instant::now();
    let graph = shop.graph(&std::fs::read_to_string(shop.path("l0.ron")).unwrap());
    assert_eq!((graph.nodes.len(), graph.wanted.as_slice()), (1, [0].as_slice()));
    assert!(start.elapsed() < Duration::from_secs(10));
}

#[test]
fn names_that_multiply_through_levels_are_quick() {
    let shop = Shop::new();
    // Each knob, input and output of a level leads to all those of the next one, if that were allowed.
    let names: Vec<String> = (0..20).map(|at| format!("k{at}")).collect();
    let all =
        |form: &dyn Fn(&String) -> String| names.iter().map(form).collect::<Vec<_>>().join(", ");
    for level in 0..8 {
        let sets = all(&|name| format!("\"i.{name}\""));
        let params = all(&|name| format!("{name:?}: (sets: [{sets}])"));
        let next = inner(&format!(r#"set: {{"recipe": "l{}.ron", "k0": 1}}"#, level + 1));
        shop.write(
            &format!("l{level}.ron"),
            format!(r#"(format: 1, params: {{{params}}}, nodes: {{"i": {next}}}, outputs: ["i"])"#),
        );
    }
    let start = Instant::now();
    let faults = shop.graph_with(&std::fs::read_to_string(shop.path("l0.ron")).unwrap(), &[]);
    let faults = faults.err().unwrap().to_string();
    assert!(faults.contains(r#"params drives "i.k0" twice"#), "{faults}");
    assert!(start.elapsed() < Duration::from_secs(10));
}

//! Catalog entries with parameters of their own.

use crate::toy::{Lab, OneText, Shop, Words, catalogs, kinds, lines, recipe, types};
use carvegraph_core::units::Dimension;
use carvegraph_core::{
    Cache, CatalogEntry, Catalogs, Context, DiskCache, EntryParams, Graph, InputFile, MemoryCache,
    Node, NodeError, NodeKind, ParamKind, ParamSpec, ParamValue, Params, Plan, Registry,
    RegistryError, Step,
};
use std::sync::Arc;

/// Draws a form.
#[derive(Params)]
struct Draw {
    /// Which form.
    #[param(catalog = "form", default = "circle")]
    form: String,
    /// The measures of that form.
    #[param(entry_of = "form")]
    measures: EntryParams,
    /// The colour.
    #[param(default = "black")]
    colour: String,
}

impl Node for Draw {
    const KIND: &'static str = "draw";
    type Inputs<'a> = ();
    type Outputs = OneText;

    fn run(&self, (): (), cx: &Context<'_>) -> Result<OneText, NodeError> {
        let mut text = format!("{} {}", self.colour, self.form);
        for (name, value) in self.measures.numbers() {
            text += &format!(" {name} {value}");
        }
        if let Some(file) = self.measures.file("template") {
            text += &format!(" {}", String::from_utf8_lossy(&cx.read(file)?));
        }
        Ok(OneText { text: Words(text) })
    }
}

fn length(name: &'static str, default: f64) -> ParamSpec {
    let kind = ParamKind::Number { dimension: Dimension::Length, min: 0.5, max: 50.0 };
    let default = Some(ParamValue::Number(default));
    ParamSpec { name, about: format!("The {name}.").into(), kind, default, yields: false }
}

fn template() -> ParamSpec {
    let (name, about) = ("template", "What to trace.".into());
    ParamSpec {
        name,
        about,
        kind: ParamKind::InputFile { optional: false },
        default: None,
        yields: false,
    }
}

fn entry(name: &str, params: Vec<ParamSpec>) -> CatalogEntry {
    CatalogEntry { params, ..CatalogEntry::new(name, "1") }
}

fn forms() -> Vec<CatalogEntry> {
    vec![
        entry("traced", vec![template(), length("width", 8.0)]),
        entry("square", vec![length("side", 4.0), length("corner", 1.0)]),
        entry("circle", vec![length("diameter", 6.0)]),
        entry("empty", Vec::new()),
    ]
}

fn registry(forms: Vec<CatalogEntry>) -> Result<Registry, RegistryError> {
    let mut kinds = kinds();
    kinds.push(NodeKind::of::<Draw>("toys"));
    kinds.sort_by_key(|kind| kind.name);
    let catalogs = catalogs(&Arc::new(Lab::default()), "1").with("form", forms, ());
    Registry::new(kinds, types(), catalogs)
}

fn shop() -> Shop {
    let mut shop = Shop::new();
    shop.registry = registry(forms()).unwrap();
    shop
}

fn draw(set: &str) -> String {
    recipe(&format!(r#""z": (kind: "draw", set: {{{set}}})"#), r#""z""#)
}

/// All values of the node: "colour=black diameter=6 form=circle".
fn values(graph: &Graph) -> String {
    let values = graph.nodes[0].values.iter();
    values.map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(" ")
}

#[track_caller]
fn check(set: &str, words: &[&str], expected: &[&str]) {
    match shop().graph_with(&draw(set), words) {
        Ok(_) => panic!("nothing is wrong with {set} {words:?}"),
        Err(faults) => assert_eq!(lines(&faults), expected, "{set} {words:?}"),
    }
}

#[test]
fn the_fields_of_the_chosen_entry_are_fields_of_the_node() {
    let read = |set: &str, words: &[&str]| {
        let graph = shop().graph_with(&draw(set), words);
        values(&graph.unwrap_or_else(|faults| panic!("{faults}")))
    };
    assert_eq!(read("", &[]), "colour=black diameter=6 form=circle");
    assert_eq!(read(r#""diameter": "1cm""#, &[]), "colour=black diameter=10 form=circle");
    assert_eq!(
        read(r#""form": "square", "corner": 2"#, &["z.side=1in"]),
        "colour=black corner=2 form=square side=25.4"
    );
    assert_eq!(
        read(r#""corner": 2"#, &["z.form=square", "z.corner=3"]),
        "colour=black corner=3 form=square side=4"
    );
    assert_eq!(read(r#""form": "empty""#, &[]), "colour=black form=empty");
}

#[test]
fn they_are_checked_like_any_other() {
    check(
        r#""diameter": 60"#,
        &[],
        &[r#"2:39 node "z": diameter must be between 0.5 and 50 mm, not 60"#],
    );
    let lengths = "a length is wanted: mm, cm, m, um, in, thou, ft";
    check(
        r#""form": "square""#,
        &["z.side=3deg", "z.corner=x"],
        &[
            &format!(r#"--set:1:8 node "z": side: "3deg" is an angle; {lengths}"#),
            &format!(r#"--set:1:10 node "z": corner: "x" is not a number; {lengths}"#),
        ],
    );
    check(
        r#""form": "traced""#,
        &[],
        &[r#"2:1 node "z": parameter "template" must be set (What to trace.)"#],
    );
    let faults = shop().graph_with(&draw(r#""form": "traced", "template": "no.svg""#), &[]).err();
    assert!(faults.unwrap().to_string().contains("there is no file"));
}

#[test]
fn a_field_that_the_chosen_entry_lacks_is_told_with_those_it_has() {
    check(r#""corner": 1"#, &[], &[r#"2:37 node "z": a circle has no "corner"; it has diameter"#]);
    check(
        r#""form": "square", "diameter": 1"#,
        &[],
        &[r#"2:57 node "z": a square has no "diameter"; it has side, corner"#],
    );
    check(
        "",
        &["z.side=1", "z.form=empty"],
        &[r#"--set:1:8 node "z": an empty has no "side"; it has nothing to set"#],
    );
    let near =
        vec![entry("circle", vec![length("size", 1.0)]), entry("disc", vec![length("sizes", 1.0)])];
    let mut shop = shop();
    shop.registry = registry(near).unwrap();
    let faults = shop.graph_with(&draw(r#""sizes": 1"#), &[]).err().unwrap();
    assert_eq!(
        lines(&faults),
        [r#"2:36 node "z": a circle has no "sizes"; it has size; did you mean "size"?"#]
    );
}

#[test]
fn a_field_that_no_entry_has_is_told_with_what_was_meant() {
    check(
        r#""diamter": 1, "collour": "red""#,
        &["z.tempalte=x", "z.x=1"],
        &[
            r#"--set:1:1 node "z" (draw) has no parameter "tempalte"; did you mean "template"?"#,
            r#"--set:1:1 node "z" (draw) has no parameter "x"; there is colour, corner, diameter, form, side, template, width"#,
            r#"2:27 node "z" (draw) has no parameter "diamter"; did you mean "diameter"?"#,
            r#"2:41 node "z" (draw) has no parameter "collour"; did you mean "colour"?"#,
        ],
    );
}

#[test]
fn of_an_entry_that_is_none_only_that_is_said() {
    check(
        r#""form": "sqare", "side": 99"#,
        &[],
        &[
            r#"2:35 node "z": form cannot be "sqare"; did you mean "square"? It is one of circle, empty, square, traced"#,
        ],
    );
}

#[test]
fn a_knob_may_drive_a_field_that_the_chosen_entry_lacks_while_nobody_turns_it() {
    let text = r#"(format: 1, params: {"corner": (sets: ["z.corner"]), "form": (sets: ["z.form"])},
nodes: {"z": (kind: "draw")}, outputs: ["z"])"#;
    let shop = shop();
    assert_eq!(values(&shop.graph(text)), "colour=black diameter=6 form=circle");
    let graph = shop.graph_with(text, &["corner=2", "form=square"]).ok().unwrap();
    assert_eq!(values(&graph), "colour=black corner=2 form=square side=4");
    assert_eq!(
        lines(&shop.graph_with(text, &["corner=2"]).err().unwrap()),
        [r#"--set:1:8 node "z": a circle has no "corner"; it has diameter"#]
    );
    let faults = shop.graph_with(&text.replace("z.corner", "z.korner"), &[]).err().unwrap();
    assert_eq!(
        lines(&faults),
        [r#"1:40 node "z" (draw) has no parameter "korner"; did you mean "corner"?"#]
    );
}

#[test]
fn the_node_gets_the_values_of_its_entry_and_their_definitions_are_found() {
    let shop = shop();
    shop.write("a.svg", "<svg/>");
    let graph = shop.graph(&draw(r#""form": "traced", "template": "a.svg", "width": 3"#));
    let node = &graph.nodes[0];
    assert_eq!(node.files().map(InputFile::stem).collect::<Vec<_>>(), ["a"]);
    assert_eq!(graph.param(node, "width").unwrap().about, "The width.");
    assert_eq!(graph.param(node, "colour").unwrap().about, "The colour.");
    assert!(graph.param(node, "side").is_none());
    // The work is not about that file.
    assert_eq!(node.prefix, "toy");
    let text = r#"(format: 1, nodes: {
"z": (kind: "draw", set: {"form": "traced", "template": "a.svg"}),
"s": (kind: "save", from: {"text": "z"}, set: {"name": "x"})}, outputs: ["s"])"#;
    shop.run(text);
    assert_eq!(shop.read("x.txt").as_deref(), Some("black traced width 8 <svg/>"));
}

/// What is done about the only node.
fn step(shop: &Shop, text: &str, cache: &dyn Cache) -> (bool, String) {
    let graph = shop.graph(text);
    let plan = Plan::new(&graph, &[], &shop.out(), Some(cache), &Default::default()).unwrap();
    let told = plan.explain("z", Some(cache)).unwrap().join("\n");
    (matches!(plan.steps[0], Some(Step::Run)), told)
}

#[test]
fn values_and_files_and_versions_of_entries_are_what_a_node_depends_on() {
    let mut shop = shop();
    shop.write("a.svg", "one");
    let text = |set: &str| draw(&format!(r#""form": "traced", "template": "a.svg"{set}"#));
    let cache = DiskCache::open(&shop.path("cache"), 1 << 20).unwrap();
    shop.run_cached(&text(""), Some(&cache));
    assert!(!step(&shop, &text(""), &cache).0);
    let wider = step(&shop, &text(r#", "width": 9"#), &cache);
    assert_eq!(wider, (true, "z runs\nz: parameter width was 8, is 9".to_owned()));
    // At its default, set or not.
    assert!(!step(&shop, &text(r#", "width": 8"#), &cache).0);
    shop.write("a.svg", "two");
    assert!(step(&shop, &text(""), &cache).1.contains("z: contents of template was "));
    shop.write("a.svg", "one");
    let mut newer = forms();
    newer.iter_mut().for_each(|form| form.version = "2".to_owned());
    shop.registry = registry(newer).unwrap();
    let told = step(&shop, &text(""), &cache);
    assert_eq!(told, (true, "z runs\nz: version of form traced was 1, is 2".to_owned()));
}

#[test]
fn another_entry_with_the_same_values_is_another_node() {
    let mut shop = shop();
    let twins =
        vec![entry("circle", vec![length("size", 1.0)]), entry("disc", vec![length("size", 1.0)])];
    shop.registry = registry(twins).unwrap();
    let cache = MemoryCache::new(1 << 20);
    shop.run_cached(&draw(""), Some(&cache));
    assert!(step(&shop, &draw(r#""form": "disc""#), &cache).0);
}

#[test]
fn entries_that_do_not_do_are_refused() {
    let check = |forms: Vec<CatalogEntry>, expected: &str| {
        assert_eq!(registry(forms).err().unwrap().to_string(), expected);
    };
    let circle = || entry("circle", vec![length("diameter", 6.0)]);
    check(vec![circle(), circle()], "two forms are called \"circle\"");
    check(
        vec![circle(), entry("x", vec![length("colour", 6.0)])],
        "the form \"x\" cannot have the parameter \"colour\": the node \"draw\" has a field of that name",
    );
    check(
        vec![circle(), entry("x", vec![length("form", 6.0)])],
        "the form \"x\" cannot have the parameter \"form\": the node \"draw\" has a field of that name",
    );
    check(
        vec![circle(), entry("x", vec![length("a", 6.0), length("a", 6.0)])],
        "the form \"x\" cannot have the parameter \"a\": it has it twice",
    );
    check(
        vec![circle(), entry("x", vec![length("a", 60.0)])],
        "the form \"x\" cannot have the parameter \"a\": a must be between 0.5 and 50 mm, not 60",
    );
    assert!(registry(vec![circle(), entry("disc", vec![length("diameter", 5.0)])]).is_ok());
}

#[test]
fn entries_come_sorted_whatever_order_they_were_given_in() {
    let catalogs = Catalogs::default().with("form", forms(), ());
    let names: Vec<&str> = catalogs.names("form").collect();
    assert_eq!(names, ["circle", "empty", "square", "traced"]);
    assert_eq!(catalogs.entry("form", "square").unwrap().params.len(), 2);
    assert!(catalogs.entry("form", "sphere").is_none() && catalogs.entries("forms").is_empty());
}

#[test]
fn a_kind_says_which_of_its_parameters_bring_more() {
    let registry = registry(forms()).unwrap();
    let choosers = |kind: &str| registry.kind(kind).unwrap().choosers().collect::<Vec<_>>();
    assert_eq!(choosers("draw"), [("form", "form")]);
    assert_eq!(choosers("tool"), []);
    let params = registry.kind("draw").unwrap().params.iter().map(|param| param.name);
    assert_eq!(params.collect::<Vec<_>>(), ["form", "colour"]);
}

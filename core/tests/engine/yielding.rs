//! Parameters whose default yields.

use crate::toy::{Lab, OneText, Shop, Style, Words, catalogs, kinds, recipe, types};
use carvegraph_core::{
    Context, MemoryCache, Node, NodeError, NodeKind, Params, Plan, Registry, Step, Yielding,
};
use std::sync::Arc;

/// Goes on, as fast as the road allows unless told.
#[derive(Params)]
struct Go {
    /// How fast.
    #[param(unit = "mm/min", default = 1500.0, range = 1.0..=10_000.0)]
    feed: Yielding<f64>,
    /// How far.
    #[param(default = 3, range = 1..=9)]
    steps: Yielding<u32>,
    /// Whether there and back.
    #[param(default = false)]
    back: Yielding<bool>,
    /// The way.
    #[param(default = Style::OneWay)]
    style: Yielding<Style>,
    /// What is spoken there.
    #[param(default = "grbl", catalog = "dialect")]
    dialect: Yielding<String>,
}

impl Node for Go {
    const KIND: &'static str = "go";
    type Inputs<'a> = ();
    type Outputs = OneText;

    fn run(&self, (): (), _: &Context<'_>) -> Result<OneText, NodeError> {
        let text = format!(
            "{} {} {} {:?} {}",
            self.feed.or(Some(800.0)),
            self.steps.or(None),
            self.back.or(Some(true)),
            self.style.or(Some(Style::ToAndFro)),
            self.dialect.or(Some("fanuc".to_owned())),
        );
        Ok(OneText { text: Words(text) })
    }
}

fn shop() -> Shop {
    let mut shop = Shop::new();
    let mut kinds = kinds();
    kinds.push(NodeKind::of::<Go>("toys"));
    kinds.sort_by_key(|kind| kind.name);
    shop.registry =
        Registry::new(kinds, types(), catalogs(&Arc::new(Lab::default()), "1")).unwrap();
    shop
}

fn go(set: &str) -> String {
    let nodes = format!(
        r#""z": (kind: "go", set: {{{set}}}), "s": (kind: "save", from: {{"text": "z"}}, set: {{"name": "x"}})"#
    );
    recipe(&nodes, r#""s""#)
}

#[test]
fn what_was_set_wins_then_what_is_offered_then_the_default() {
    let run = |set: &str| {
        let shop = shop();
        shop.run(&go(set));
        shop.read("x.txt").unwrap()
    };
    assert_eq!(run(""), "800 3 true ToAndFro fanuc");
    let all = r#""feed": "2m/min", "steps": 5, "back": false, "style": "none", "dialect": "grbl""#;
    assert_eq!(run(all), "2000 5 false None grbl");
    // Set to what is the default anyway.
    assert_eq!(run(r#""feed": 1500"#), "1500 3 true ToAndFro fanuc");
}

#[test]
fn settings_of_the_command_line_and_knobs_count_as_set() {
    let shop = shop();
    let text = go("").replace("nodes:", r#"params: {"speed": (sets: ["z.feed"])}, nodes:"#);
    let is_set = |set: &[&str]| {
        let graph = shop.graph_with(&text, set).ok().unwrap();
        graph.nodes[0].values.is_set("feed")
    };
    assert!(!is_set(&[]) && is_set(&["speed=1500"]) && is_set(&["z.feed=1500"]));
}

#[test]
fn its_definition_is_that_of_any_parameter() {
    let shop = shop();
    let kind = shop.registry.kind("go").unwrap();
    let line = |name: &str| {
        let spec = kind.param(name).unwrap();
        format!("{}, default {}", spec.kind, spec.default.as_ref().unwrap())
    };
    assert_eq!(line("feed"), "number, 1 to 10000 mm/min, default 1500");
    assert_eq!(line("dialect"), "a dialect's name (carve dialects), default grbl");
    assert!(kind.params.iter().all(|spec| spec.yields));
    assert!(shop.registry.kind("tool").unwrap().params.iter().all(|spec| !spec.yields));
}

#[test]
fn whether_it_was_set_is_what_a_node_depends_on() {
    let shop = shop();
    let cache = MemoryCache::new(1 << 20);
    shop.run_cached(&go(""), Some(&cache));
    let explain = |set: &str| {
        let graph = shop.graph(&go(set));
        let plan = Plan::new(&graph, &[], &shop.out(), Some(&cache), &Default::default()).unwrap();
        let told = plan.explain("z", Some(&cache)).unwrap().join("\n");
        (matches!(plan.steps[0], Some(Step::Run)), told)
    };
    assert!(!explain("").0);
    let told = "z runs\nz: whether feed is set was false, is true".to_owned();
    assert_eq!(explain(r#""feed": 1500"#), (true, told));
}

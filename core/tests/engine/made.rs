//! Kinds of node that are put together while the program runs.

use crate::toy::{Lab, Number, Shop, Words, catalogs, kinds, lines, recipe, told, types, value};
use carvegraph_core::units::Dimension;
use carvegraph_core::{
    DiskCache, InputValues, NodeError, NodeKind, NodeMaker, ParamKind, ParamSpec, ParamValue,
    ParamValues, Plan, PortSpec, Registry, RegistryError, Value,
};
use std::sync::Arc;

/// Gives `factor` times the number, as a plugin would define it.
fn scale(origin: &str) -> NodeKind {
    let kind = ParamKind::Number { dimension: Dimension::Plain, min: 0.0, max: 100.0 };
    let about = "How much.".into();
    let default = Some(ParamValue::Number(2.0));
    NodeKind {
        name: "scale",
        version: 1,
        origin: Some(origin.to_owned()),
        uses_prefix: false,
        stage: "toys",
        about: "Makes a number larger.",
        params: vec![ParamSpec { name: "factor", about, kind, default, yields: false }],
        inputs: vec![PortSpec::of::<Number>("number", "Any number.", false)],
        outputs: vec![PortSpec::of::<Number>("number", "The larger one.", false)],
        maker: NodeMaker::of_fn(|values, inputs, cx| {
            cx.note("scaled");
            scaled(values, inputs)
        }),
    }
}

fn scaled(values: &ParamValues, inputs: &InputValues) -> Result<Vec<Value>, NodeError> {
    let factor = values.get("factor").number().unwrap();
    let number: &Number = inputs.required("number");
    match factor {
        0.0 => Err(NodeError::refused("factor", "0 makes nothing larger")),
        13.0 => Ok(Vec::new()),
        14.0 => Ok(vec![Arc::new(Words("fourteen".to_owned()))]),
        15.0 => panic!("out of luck"),
        _ => Ok(vec![Arc::new(Number(number.0 * factor))]),
    }
}

fn registry(extra: Vec<NodeKind>) -> Result<Registry, RegistryError> {
    let mut kinds = kinds();
    kinds.extend(extra);
    kinds.sort_by_key(|kind| kind.name);
    Registry::new(kinds, types(), catalogs(&Arc::new(Lab::default()), "1"))
}

fn shop(origin: &str) -> Shop {
    let mut shop = Shop::new();
    shop.registry = registry(vec![scale(origin)]).unwrap();
    shop
}

fn scale_by(factor: &str) -> String {
    let nodes = format!(
        r#""n": (kind: "number", set: {{"value": 5}}),
"z": (kind: "scale", from: {{"number": "n"}}, set: {{{factor}}})"#
    );
    recipe(&nodes, r#""z""#)
}

#[test]
fn they_run_like_any_other() {
    let report = shop("acme 1").run(&scale_by(""));
    assert_eq!((told(&report).as_str(), value(&report, "z")), ("n ran, z ran", 10.0));
    assert_eq!(report.nodes["z"].notes[0].text, "scaled");
    assert_eq!(value(&shop("acme 1").run(&scale_by(r#""factor": 7"#)), "z"), 35.0);
    let faults = shop("acme 1").graph_with(&scale_by(r#""factor": 101, "fcator": 1"#), &[]).err();
    assert_eq!(
        lines(&faults.unwrap()),
        [
            r#"3:61 node "z": factor must be between 0 and 100, not 101"#,
            r#"3:66 node "z" (scale) has no parameter "fcator"; did you mean "factor"?"#,
        ]
    );
}

#[test]
fn they_fail_alone_in_any_way() {
    let told = |factor: &str| told(&shop("acme 1").run(&scale_by(factor)));
    let promised = "it gave other outputs than its definition promises: a fault of acme 1";
    assert_eq!(told(r#""factor": 13"#), format!("n ran, z failed: {promised}"));
    assert_eq!(told(r#""factor": 14"#), format!("n ran, z failed: {promised}"));
    assert!(
        told(r#""factor": 15"#).contains("z failed: ")
            && told(r#""factor": 15"#).contains("out of luck")
    );
    let report = shop("acme 1").run(&scale_by(r#""factor": 0"#));
    assert_eq!(report.nodes["z"].place.as_ref().unwrap().to_string(), "toy.ron:3:61");
}

#[test]
fn where_one_comes_from_is_what_its_values_depend_on() {
    let mut shop = shop("acme 1 (01ab)");
    let cache = DiskCache::open(&shop.path("cache"), 1 << 20).unwrap();
    shop.run_cached(&scale_by(""), Some(&cache));
    assert_eq!(told(&shop.run_cached(&scale_by(""), Some(&cache))), "n cached, z cached");
    shop.registry = registry(vec![scale("acme 1 (02cd)")]).unwrap();
    let graph = shop.graph(&scale_by(""));
    let plan = Plan::new(&graph, &[], &shop.out(), Some(&cache), &Default::default()).unwrap();
    assert_eq!(
        plan.explain("z", Some(&cache)).unwrap(),
        ["z runs", "z: origin of the node kind was acme 1 (01ab), is acme 1 (02cd)"]
    );
}

#[test]
fn names_that_stand_for_two_things_are_refused() {
    let fault = |kind: NodeKind| registry(vec![kind]).err().unwrap().to_string();
    assert_eq!(
        fault(NodeKind { name: "add", ..scale("acme 1") }),
        r#"two nodes are called "add": one from the program, one from acme 1"#
    );
    let mut kind = scale("acme 1");
    kind.params.push(kind.params[0].clone());
    assert_eq!(fault(kind), r#"the node "scale" has "factor" twice"#);
    let mut kind = scale("acme 1");
    kind.outputs.push(kind.outputs[0]);
    assert_eq!(fault(kind), r#"the node "scale" has "number" twice"#);
    let mut kind = scale("acme 1");
    kind.outputs[0] = PortSpec::of::<u8>("number", "A byte.", false);
    assert_eq!(
        fault(kind),
        r#"port "number" of "scale" carries u8, which is not on the list of port types"#
    );
    assert_eq!(
        fault(NodeKind { name: "recipe", ..scale("acme 1") }),
        r#"no node may be called "recipe""#
    );
}

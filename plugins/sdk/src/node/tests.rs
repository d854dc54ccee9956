//! Definitions, jobs and trials.

use super::*;
use crate::value::{GrayImage, HeightField, PortValue, Remark};

/// A node whose definition is whatever a test wants, and whose work is `run`.
struct Toy {
    name: &'static str,
    about: &'static str,
    params: Vec<Param>,
    inputs: Vec<Port>,
    outputs: Vec<Port>,
    run: fn(&Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault>,
}

impl Node for Toy {
    fn name(&self) -> &str {
        self.name
    }

    fn about(&self) -> &str {
        self.about
    }

    fn params(&self) -> &[Param] {
        &self.params
    }

    fn inputs(&self) -> &[Port] {
        &self.inputs
    }

    fn outputs(&self) -> &[Port] {
        &self.outputs
    }

    fn run(&self, job: &Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault> {
        (self.run)(job)
    }
}

const FIELD: Port =
    Port { name: "surface", about: "A surface.", type_name: "height_field", optional: false };

const LENGTH: ParamKind = ParamKind::Number { unit: "mm", default: 1.0, min: 0.0, max: 5.0 };

const COUNT: ParamKind = ParamKind::Integer { unit: "px", default: 3, min: 1, max: 9 };

const WORDS: ParamKind = ParamKind::Choice {
    options: &[
        ParamOption { name: "round", about: "To the nearest." },
        ParamOption { name: "floor", about: "Down." },
    ],
    default: "round",
};

fn param(name: &'static str, kind: ParamKind) -> Param {
    Param { name, about: "Something.", kind }
}

fn toy() -> Toy {
    Toy {
        name: "toy",
        about: "Does what a test wants.",
        params: vec![
            param("step", LENGTH),
            param("count", COUNT),
            param("fast", ParamKind::Switch { default: true }),
            param("title", ParamKind::Text { default: "" }),
            param("how", WORDS),
        ],
        inputs: vec![
            FIELD,
            Port { name: "mask", type_name: "gray_image", optional: true, ..FIELD },
        ],
        outputs: vec![Port { name: "said", type_name: "remark", ..FIELD }],
        run: |job| {
            let field: HeightField = job.input("surface")?;
            let mask: Option<GrayImage> = job.optional_input("mask")?;
            let text = format!(
                "{} {} {} {:?} {} {} {}",
                job.number("step")?,
                job.integer("count")?,
                job.switch("fast")?,
                job.text("title")?,
                job.text("how")?,
                field.heights.len(),
                mask.is_some(),
            );
            Ok(vec![Remark { text: text.into() }.into_raw()])
        },
    }
}

fn field() -> HeightField<'static> {
    HeightField { columns: 2, rows: 2, pitch_mm: 0.1, heights: vec![1.0; 4].into() }
}

fn said(trial: &Trial<'_>) -> String {
    let made = trial.run().unwrap();
    Remark::from_raw(&made[0]).unwrap().text.into_owned()
}

fn fault(toy: Toy) -> String {
    check_definition(&toy).unwrap_err().to_string()
}

fn param_fault(kind: ParamKind) -> String {
    fault(Toy { params: vec![param("step", kind)], ..toy() })
}

#[test]
fn a_node_gets_its_defaults_and_what_is_set() {
    let toy = toy();
    let trial = Trial::of(&toy).input("surface", field());
    assert_eq!(said(&trial), "1 3 true \"\" round 4 false");
    let mask = GrayImage { width: 1, height: 1, values: vec![0.0].into() };
    let trial = trial.input("mask", mask).set("step", 0.5).set("count", 9).set("fast", false);
    let trial = trial.set("title", "x").set("how", "floor");
    assert_eq!(said(&trial), "0.5 9 false \"x\" floor 4 true");
}

#[test]
fn arguments_and_inputs_that_do_not_fit_are_refused() {
    let toy = toy();
    let refusal = |trial: Trial<'_>| trial.run().unwrap_err().to_string();
    let trial = || Trial::of(&toy).input("surface", field());
    assert_eq!(refusal(Trial::of(&toy)), "nothing is connected to \"surface\"");
    assert_eq!(
        refusal(trial().input("surface", Remark { text: "".into() })),
        "the input \"surface\" is a remark; it must be a height_field"
    );
    assert_eq!(refusal(trial().set("step", 6.0)), "the parameter \"step\" cannot be Number(6.0)");
    assert_eq!(
        refusal(trial().set("step", f64::NAN)),
        "the parameter \"step\" cannot be Number(NaN)"
    );
    assert_eq!(refusal(trial().set("step", 1)), "the parameter \"step\" cannot be Integer(1)");
    assert_eq!(refusal(trial().set("count", 0)), "the parameter \"count\" cannot be Integer(0)");
    assert_eq!(refusal(trial().set("how", "up")), "the parameter \"how\" cannot be Text(\"up\")");
    assert_eq!(
        Job::new(&toy, &[], &[], &crate::node::Alone).err(),
        Some(NodeFault::Failed("the node has 5 parameters and was given 0".to_owned()))
    );
}

#[test]
fn a_node_that_asks_for_what_it_has_not_is_told() {
    let asks = |run| {
        let toy = Toy { run, ..toy() };
        Trial::of(&toy).input("surface", field()).run().unwrap_err().to_string()
    };
    assert_eq!(
        asks(|job| job.number("count").map(|_| vec![])),
        "the node is wrong: it has no number called \"count\""
    );
    assert_eq!(
        asks(|job| job.input::<HeightField>("relief").map(|_| vec![])),
        "the node is wrong: it has no input called \"relief\""
    );
    assert_eq!(
        asks(|job| job.input::<GrayImage>("surface").map(|_| vec![])),
        "input \"surface\": it is a height_field; it must be a gray_image"
    );
}

#[test]
fn outputs_that_do_not_fit_are_refused() {
    let makes = |run| {
        let toy = Toy { run, ..toy() };
        Trial::of(&toy).input("surface", field()).run().unwrap_err().to_string()
    };
    assert_eq!(makes(|_| Ok(vec![])), "the node has 1 outputs and made 0");
    assert_eq!(
        makes(|_| Ok(vec![field().into_raw()])),
        "output \"said\": it is a height_field; it must be a remark"
    );
    assert_eq!(
        makes(|_| Ok(vec![Raw::new("remark")])),
        "output \"said\": the remark ends before its array \"text\""
    );
}

#[test]
fn chunks_are_visited_once_each() {
    let toy = Toy {
        run: |job| {
            let mut numbers = vec![0; 10];
            job.parallel_chunks(&mut numbers, 4, |index, chunk| {
                chunk.iter_mut().for_each(|number| *number += index + 1);
            })?;
            Ok(vec![Remark { text: format!("{numbers:?}").into() }.into_raw()])
        },
        ..toy()
    };
    let trial = Trial::of(&toy).input("surface", field());
    assert_eq!(said(&trial), "[1, 1, 1, 1, 2, 2, 2, 2, 3, 3]");
}

#[test]
fn names_and_descriptions_are_checked() {
    assert_eq!(check_definition(&toy()), Ok(()));
    let words = "names are of lower-case letters, digits and _, begin with a letter and have at most 64 \
                 characters";
    for name in ["", "Toy", "2d", "_x", "a-b", "tür"] {
        assert_eq!(fault(Toy { name, ..toy() }), format!("the node is called {name:?}; {words}"));
    }
    assert_eq!(
        fault(Toy { about: " ", ..toy() }),
        "the node \"toy\" has no description; say in a line what it is for"
    );
    assert_eq!(
        fault(Toy { about: "a\nb", ..toy() }),
        "a text of the node \"toy\" is none that can be shown; it must be a line of at most 2000 bytes"
    );
    assert_eq!(
        fault(Toy { params: vec![param("step", LENGTH); 2], ..toy() }),
        "the parameter \"step\" is there twice; give each its own name"
    );
    assert_eq!(
        fault(Toy { inputs: vec![FIELD; 65], ..toy() }),
        "it has 65 inputs; the limit is 64"
    );
}

#[test]
fn ports_carry_known_types_and_outputs_are_never_open() {
    let solid = Port { type_name: "solid", ..FIELD };
    let message = fault(Toy { inputs: vec![solid], ..toy() });
    assert!(
        message.starts_with("the input \"surface\" carries \"solid\"; it must be one of bounds, "),
        "{message}"
    );
    assert_eq!(fault(Toy { outputs: vec![], ..toy() }), "it has no output");
    assert_eq!(
        fault(Toy { outputs: vec![Port { optional: true, ..FIELD }], ..toy() }),
        "the output \"surface\" is optional; only an input may be"
    );
}

#[test]
fn parameters_have_a_unit_a_range_and_a_default_within() {
    let number =
        |unit, default, min, max| param_fault(ParamKind::Number { unit, default, min, max });
    assert_eq!(
        number("in", 1.0, 0.0, 2.0),
        "the parameter \"step\" is in \"in\"; its unit must be one of mm, mm/min, deg, rpm, s, px, %, or \
         empty"
    );
    assert_eq!(
        number("mm", 1.0, 2.0, 0.0),
        "the parameter \"step\" ranges from 2 to 0; give the lesser number first"
    );
    assert_eq!(
        number("mm", 1.0, f64::NAN, 2.0),
        "the parameter \"step\" ranges from NaN to 2; give the lesser number first"
    );
    let none = "which is none of its values";
    assert_eq!(
        number("mm", 3.0, 0.0, 2.0),
        format!("the parameter \"step\" has the default 3, {none}")
    );
    assert_eq!(
        number("", f64::INFINITY, 0.0, f64::INFINITY),
        format!("the parameter \"step\" has the default inf, {none}")
    );
    let integer = ParamKind::Integer { unit: "", default: 0, min: i64::MIN, max: 0 };
    assert_eq!(
        param_fault(integer),
        "the parameter \"step\" reaches beyond ±9007199254740992; narrow its range"
    );
    let choice = |options| param_fault(ParamKind::Choice { options, default: "up" });
    assert_eq!(choice(&[]), "the parameter \"step\" is a choice without options");
    assert_eq!(
        choice(&[ParamOption { name: "down", about: "Down." }]),
        format!("the parameter \"step\" has the default \"up\", {none}")
    );
}

//! Nodes of plugins: every type crosses unharmed, nothing bad comes back, recipes can use them.

mod passing;
mod recipes;
mod refusals;

use super::*;
use crate::testing::run;
use carvegraph_geometry::{
    Contact, ContactKind, DVec3, Feeds, Reduction, Span, SpanKind, Toolpath,
};
use std::any::Any;
use std::sync::Arc;

/// The plugin that the toys come from.
const ORIGIN: &str = "acme 1.2";

/// A node whose definition and work are what a test wants.
struct Toy<F> {
    name: &'static str,
    params: Vec<Param>,
    inputs: Vec<Port>,
    outputs: Vec<Port>,
    run: F,
}

impl<F: Fn(&Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault> + Send + Sync> Node for Toy<F> {
    fn name(&self) -> &str {
        self.name
    }

    fn about(&self) -> &str {
        "Does what a test wants."
    }

    fn version(&self) -> u32 {
        7
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

fn port(name: &'static str, type_name: &'static str) -> Port {
    Port { name, about: "Anything.", type_name, optional: false }
}

/// A node with one input and one output of one type.
fn toy(
    type_name: &'static str,
    run: impl Fn(&Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault> + Send + Sync + 'static,
) -> Box<dyn Node> {
    let ports = || vec![port("value", type_name)];
    Box::new(Toy { name: "toy", params: vec![], inputs: ports(), outputs: ports(), run })
}

/// What `node` makes of `value`.
fn through<T: Any + Send + Sync>(node: Box<dyn Node>, value: T) -> Result<Vec<Value>, NodeError> {
    let mut inputs = InputValues::default();
    inputs.insert("value", Arc::new(value));
    let guest = Guest::new(node, ORIGIN.to_owned());
    run(|cx| guest.run(&ParamValues::default(), &inputs, cx))
}

fn point(k: usize) -> DVec3 {
    DVec3::new(0.1 * k as f64, -0.0, 1.0 / (k as f64 + 3.0))
}

fn path() -> Toolpath {
    use ContactKind::{Edge, Facet, None, Vertex};
    let contact = |(k, kind)| Contact { point: point(k), kind };
    let span = |points, kind, joined| Span { points, kind, joined };
    Toolpath {
        tips: (0..4).map(point).collect(),
        contacts: [Facet, Edge, Vertex, None].into_iter().enumerate().map(contact).collect(),
        spans: vec![
            span(0..1, SpanKind::Rapid, false),
            span(1..2, SpanKind::Plunge, true),
            span(2..3, SpanKind::Pass, true),
            span(3..4, SpanKind::Link, true),
        ],
        feeds: Some(Feeds {
            cut_mm_per_min: 1e3 / 3.0,
            plunge_mm_per_min: 300.0,
            rapid_mm_per_min: 3e3,
        }),
        arcs: Vec::new(),
    }
}

const REDUCTION: Reduction = Reduction {
    points_in: 10,
    points_out: 3,
    max_deviation_mm: 0.1,
    max_above_mm: 0.1 + 0.2,
    max_below_mm: 0.0,
};

#[test]
fn every_unit_is_that_which_the_engine_counts_in() {
    for unit in carvegraph_sdk::node::UNITS {
        match *unit {
            "%" => assert_eq!(dimension(unit), Dimension::Ratio),
            unit => assert_eq!(dimension(unit).base_unit(), unit),
        }
    }
}

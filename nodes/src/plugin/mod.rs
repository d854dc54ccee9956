//! Nodes that plugins bring.
//!
//! [`kind_of`] makes of a plugin's node a kind of node like any other: its definition is checked and
//! becomes parameters and ports, and a run hands the values over ([`crossing`]), calls the node with
//! what its context can do ([`services`]) and takes back what it made.
//!
//! What a plugin makes is as good as what a node of the program makes, or an error: numbers are finite
//! where they must be, indices lead somewhere, nothing is larger than the program's own limits. Whether
//! it makes sense is the plugin's business.

mod crossing;
mod geometry;
mod services;
#[cfg(test)]
mod tests;
mod values;

use carvegraph_core::units::Dimension;
use carvegraph_core::{
    ChoiceOption, Context, InputValues, NodeError, NodeKind, NodeMaker, ParamKind, ParamSpec,
    ParamValue, ParamValues, PortSpec, Value,
};
use carvegraph_sdk::node::{
    Argument, DefinitionError, Job, Node, NodeFault, Param, ParamKind as Kind, ParamOption, Port,
    check_definition,
};
use carvegraph_sdk::value::Raw;
use crossing::Crossing;
use services::OfContext;

/// The stage under which nodes of plugins are listed.
const STAGE: &str = "plugin";

/// A node of a plugin that cannot be taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the node {name:?} of {origin} cannot be used: {fault}")]
pub struct PluginNodeError {
    /// What it is called.
    pub name: String,
    /// The plugin.
    pub origin: String,
    /// What is wrong with its definition.
    pub fault: DefinitionError,
}

/// The kind of node that `node` is. `origin` names the plugin and its version: values of another origin
/// are made anew.
///
/// Its name and description live until the program ends.
///
/// # Errors
/// If the node's definition does not do; see [`check_definition`].
pub fn kind_of(node: Box<dyn Node>, origin: String) -> Result<NodeKind, PluginNodeError> {
    if let Err(fault) = check_definition(&*node) {
        return Err(PluginNodeError { name: node.name().to_owned(), origin, fault });
    }
    let guest = Guest::new(node, origin.clone());
    let node = &guest.node;
    Ok(NodeKind {
        name: node.name().to_owned().leak(),
        version: node.version(),
        origin: Some(origin),
        uses_prefix: false,
        stage: STAGE,
        about: node.about().to_owned().leak(),
        params: node.params().iter().map(spec_of).collect(),
        inputs: ports_of(node.inputs(), &guest.inputs),
        outputs: ports_of(node.outputs(), &guest.outputs),
        maker: NodeMaker::of_fn(move |values, inputs, cx| guest.run(values, inputs, cx)),
    })
}

/// A node of a plugin, and how the values at its ports cross.
struct Guest {
    node: Box<dyn Node>,
    inputs: Vec<Crossing>,
    outputs: Vec<Crossing>,
    origin: String,
}

impl Guest {
    /// A node whose definition was checked, so that every type of its ports is known.
    fn new(node: Box<dyn Node>, origin: String) -> Self {
        let inputs = node.inputs().iter().filter_map(Crossing::of).collect();
        let outputs = node.outputs().iter().filter_map(Crossing::of).collect();
        Self { node, inputs, outputs, origin }
    }

    fn run(
        &self,
        values: &ParamValues,
        inputs: &InputValues,
        cx: &Context<'_>,
    ) -> Result<Vec<Value>, NodeError> {
        let params = self.node.params().iter();
        let arguments: Vec<Argument<'_>> = params.map(|p| argument(values.get(p.name))).collect();
        let ports = self.node.inputs().iter().zip(&self.inputs);
        let give = |(port, crossing): (&Port, &Crossing)| {
            let given = crossing.give(inputs, port.name);
            given.map_err(|why| NodeError::Failed(format!("input {:?}: {why}", port.name)))
        };
        let inputs: Vec<_> = ports.map(give).collect::<Result<_, _>>()?;
        let services = OfContext::new(cx);
        let job = Job::new(&*self.node, &arguments, &inputs, &services);
        let made = job.and_then(|job| self.node.run(&job));
        self.take(made.map_err(|fault| self.error(fault, cx))?)
    }

    fn take(&self, made: Vec<Raw<'static>>) -> Result<Vec<Value>, NodeError> {
        let ports = self.node.outputs();
        if made.len() != ports.len() {
            let counts = format!("{} values for {} outputs", made.len(), ports.len());
            return Err(NodeError::Failed(format!("it made {counts}: {}", self.blame())));
        }
        let made = made.into_iter().zip(ports).zip(&self.outputs);
        made.map(|((raw, port), crossing)| {
            crossing.take(raw).map_err(|fault| {
                NodeError::Failed(format!("output {:?}: {fault}: {}", port.name, self.blame()))
            })
        })
        .collect()
    }

    fn error(&self, fault: NodeFault, cx: &Context<'_>) -> NodeError {
        match fault {
            NodeFault::Cancelled if cx.is_cancelled() => NodeError::Cancelled,
            NodeFault::Cancelled => {
                NodeError::Failed(format!("it stopped unasked: {}", self.blame()))
            }
            NodeFault::Failed(message) => {
                NodeError::Failed(format!("{message} (says {})", self.origin))
            }
        }
    }

    fn blame(&self) -> String {
        format!("a fault of {}", self.origin)
    }
}

fn argument(value: &ParamValue) -> Argument<'_> {
    match value {
        ParamValue::Number(number) => Argument::Number(*number),
        ParamValue::Integer(number) => Argument::Integer(*number),
        ParamValue::Switch(on) => Argument::Switch(*on),
        other => Argument::Text(other.text()),
    }
}

fn ports_of(ports: &[Port], crossings: &[Crossing]) -> Vec<PortSpec> {
    ports.iter().zip(crossings).map(|(port, crossing)| crossing.port(port)).collect()
}

fn spec_of(param: &Param) -> ParamSpec {
    let (kind, default) = kind_and_default(param.kind);
    let about = param.about.into();
    ParamSpec { name: param.name, about, kind, default: Some(default), yields: false }
}

fn kind_and_default(kind: Kind) -> (ParamKind, ParamValue) {
    match kind {
        Kind::Number { unit, default, min, max } => {
            let dimension = dimension(unit);
            (ParamKind::Number { dimension, min, max }, ParamValue::Number(default))
        }
        Kind::Integer { unit, default, min, max } => {
            let dimension = dimension(unit);
            let kind = ParamKind::Integer { dimension, min, max, odd: false };
            (kind, ParamValue::Integer(default))
        }
        Kind::Switch { default } => (ParamKind::Switch, ParamValue::Switch(default)),
        Kind::Text { default } => (ParamKind::Text, ParamValue::Text(default.to_owned())),
        Kind::Choice { options, default } => {
            let options: Vec<ChoiceOption> = options.iter().map(choice_option).collect();
            (ParamKind::Choice(options.leak()), ParamValue::Text(default.to_owned()))
        }
    }
}

fn choice_option(option: &ParamOption) -> ChoiceOption {
    ChoiceOption { name: option.name, about: option.about }
}

/// What a unit measures; the definition was checked, so the only one unknown is the empty one.
fn dimension(unit: &str) -> Dimension {
    Dimension::of_unit(unit).unwrap_or(Dimension::Plain)
}

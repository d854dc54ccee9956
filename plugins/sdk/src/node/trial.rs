//! Runs a node alone, for its tests.

use super::{Argument, Job, Node, NodeFault, Services, check_definition, check_outputs};
use crate::value::{PortValue, Raw};

/// A node about to be run without `carve`: its parameters at their defaults, its inputs open, on one
/// thread, with nobody to listen.
pub struct Trial<'a> {
    node: &'a dyn Node,
    arguments: Vec<Argument<'a>>,
    inputs: Vec<Option<Raw<'a>>>,
}

impl<'a> Trial<'a> {
    /// Begins one.
    ///
    /// # Panics
    /// If the node's definition is one that `carve` would refuse.
    #[must_use]
    pub fn of(node: &'a dyn Node) -> Self {
        check_definition(node).unwrap_or_else(|fault| panic!("{}: {fault}", node.name()));
        let arguments = node.params().iter().map(Argument::default_of).collect();
        Self { node, arguments, inputs: vec![None; node.inputs().len()] }
    }

    /// Sets a parameter.
    ///
    /// # Panics
    /// If the node has none of that name.
    #[must_use]
    pub fn set(mut self, param: &str, value: impl Into<Argument<'a>>) -> Self {
        let place = place_of(param, self.node.params().iter().map(|known| known.name));
        self.arguments[place] = value.into();
        self
    }

    /// Connects an input.
    ///
    /// # Panics
    /// If the node has none of that name.
    #[must_use]
    pub fn input(mut self, port: &str, value: impl PortValue<'a>) -> Self {
        let place = place_of(port, self.node.inputs().iter().map(|known| known.name));
        self.inputs[place] = Some(value.into_raw());
        self
    }

    /// Runs the node: one value for each output, in their order.
    ///
    /// # Errors
    /// What the node answers, or what `carve` would say of wrong parameters, inputs and outputs.
    pub fn run(&self) -> Result<Vec<Raw<'static>>, NodeFault> {
        let job = Job::new(self.node, &self.arguments, &self.inputs, &Alone)?;
        let made = self.node.run(&job)?;
        check_outputs(self.node.outputs(), &made)?;
        Ok(made)
    }
}

/// The place of `name` among the `known` ones.
fn place_of<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> usize {
    let known: Vec<&str> = known.collect();
    let place = known.iter().position(|other| *other == name);
    place.unwrap_or_else(|| panic!("{name:?} is none of {}", known.join(", ")))
}

/// For work that nobody listens to and nobody calls off, on one thread.
#[derive(Clone, Copy, Debug)]
pub struct Alone;

impl Services for Alone {
    fn note(&self, _: &str) {}

    fn warn(&self, _: &str) {}

    fn progress(&self, _: f64) -> bool {
        true
    }

    fn parallel_for(&self, count: usize, body: &(dyn Fn(usize) + Sync)) -> bool {
        (0..count).for_each(body);
        true
    }
}

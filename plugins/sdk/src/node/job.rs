//! What a node is given to work on.

use super::{Node, NodeFault, Param, ParamKind, Port};
use crate::value::{PortValue, Raw};
use std::sync::{Mutex, PoisonError};

/// What a parameter is set to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Argument<'a> {
    /// Of a [`ParamKind::Number`], in its unit.
    Number(f64),
    /// Of a [`ParamKind::Integer`].
    Integer(i64),
    /// Of a [`ParamKind::Switch`].
    Switch(bool),
    /// Of a [`ParamKind::Text`] or a [`ParamKind::Choice`].
    Text(&'a str),
}

/// What whoever runs a node does for it.
pub trait Services: Sync {
    /// Tells the user something.
    fn note(&self, text: &str);

    /// Warns the user.
    fn warn(&self, text: &str);

    /// Tells how much is done, from 0 to 1; answers whether to go on.
    fn progress(&self, share: f64) -> bool;

    /// Calls `body` with each index below `count`, several at once and in no order; answers whether it
    /// was called with all of them, or the work was called off. A loop within a loop runs on one
    /// thread.
    fn parallel_for(&self, count: usize, body: &(dyn Fn(usize) + Sync)) -> bool;
}

/// One run of a node: its parameters, its inputs and [`Services`].
#[derive(Clone, Copy)]
pub struct Job<'a> {
    params: &'a [Param],
    arguments: &'a [Argument<'a>],
    ports: &'a [Port],
    inputs: &'a [Option<Raw<'a>>],
    services: &'a dyn Services,
}

impl<'a> Job<'a> {
    /// The job of running `node` with these `arguments`, one for each parameter, and these `inputs`, one
    /// for each input port, `None` where it is left open; both in the order of the definition.
    ///
    /// # Errors
    /// If there are more or fewer, an argument is of another kind than its parameter or outside its
    /// range, an input is of another type than its port, or a port is open that may not be.
    pub fn new(
        node: &'a dyn Node,
        arguments: &'a [Argument<'a>],
        inputs: &'a [Option<Raw<'a>>],
        services: &'a dyn Services,
    ) -> Result<Self, NodeFault> {
        let (params, ports) = (node.params(), node.inputs());
        check_count("parameters", params.len(), arguments.len())?;
        check_count("inputs", ports.len(), inputs.len())?;
        params.iter().zip(arguments).try_for_each(|(param, given)| check_argument(param, given))?;
        ports.iter().zip(inputs).try_for_each(|(port, given)| check_input(port, given.as_ref()))?;
        Ok(Self { params, arguments, ports, inputs, services })
    }

    /// What its parameters are set to, in the order of the definition.
    #[must_use]
    pub fn arguments(&self) -> &'a [Argument<'a>] {
        self.arguments
    }

    /// What stands at its input ports, in the order of the definition.
    #[must_use]
    pub fn inputs(&self) -> &'a [Option<Raw<'a>>] {
        self.inputs
    }

    /// What whoever runs it does for it.
    #[must_use]
    pub fn services(&self) -> &'a dyn Services {
        self.services
    }

    /// A parameter that is a number, in its unit.
    ///
    /// # Errors
    /// If the node has no such parameter.
    pub fn number(&self, param: &str) -> Result<f64, NodeFault> {
        match self.argument(param) {
            Some(Argument::Number(number)) => Ok(number),
            _ => Err(no_param("number", param)),
        }
    }

    /// A parameter that is a whole number.
    ///
    /// # Errors
    /// If the node has no such parameter.
    pub fn integer(&self, param: &str) -> Result<i64, NodeFault> {
        match self.argument(param) {
            Some(Argument::Integer(number)) => Ok(number),
            _ => Err(no_param("whole number", param)),
        }
    }

    /// A parameter that is true or false.
    ///
    /// # Errors
    /// If the node has no such parameter.
    pub fn switch(&self, param: &str) -> Result<bool, NodeFault> {
        match self.argument(param) {
            Some(Argument::Switch(on)) => Ok(on),
            _ => Err(no_param("switch", param)),
        }
    }

    /// A parameter that is a text or a choice.
    ///
    /// # Errors
    /// If the node has no such parameter.
    pub fn text(&self, param: &str) -> Result<&'a str, NodeFault> {
        match self.argument(param) {
            Some(Argument::Text(text)) => Ok(text),
            _ => Err(no_param("text or choice", param)),
        }
    }

    /// The value at an input port that must be connected.
    ///
    /// # Errors
    /// If the node has no such port, or it carries another type or is open.
    pub fn input<T: PortValue<'a>>(&self, port: &str) -> Result<T, NodeFault> {
        let value = self.optional_input(port)?;
        value.ok_or_else(|| NodeFault::Failed(format!("nothing is connected to {port:?}")))
    }

    /// The value at an input port, if it is connected.
    ///
    /// # Errors
    /// If the node has no such port, or it carries another type.
    pub fn optional_input<T: PortValue<'a>>(&self, port: &str) -> Result<Option<T>, NodeFault> {
        let place = self.ports.iter().position(|known| known.name == port);
        let place = place.ok_or_else(|| {
            NodeFault::Failed(format!("the node is wrong: it has no input called {port:?}"))
        })?;
        let value = self.inputs[place].as_ref().map(T::from_raw).transpose();
        value.map_err(|fault| NodeFault::Failed(format!("input {port:?}: {fault}")))
    }

    /// Tells the user something.
    pub fn note(&self, text: impl AsRef<str>) {
        self.services.note(text.as_ref());
    }

    /// Warns the user.
    pub fn warn(&self, text: impl AsRef<str>) {
        self.services.warn(text.as_ref());
    }

    /// Tells how much is done, from 0 to 1. To be called every few milliseconds of long work.
    ///
    /// # Errors
    /// [`NodeFault::Cancelled`] if the work was called off; pass it on with `?`.
    pub fn progress(&self, share: f64) -> Result<(), NodeFault> {
        done(self.services.progress(share))
    }

    /// Calls `body` with each index below `count`, several at once and in no order. A loop within a
    /// loop runs on one thread.
    ///
    /// # Errors
    /// [`NodeFault::Cancelled`] if the work was called off; pass it on with `?`.
    pub fn parallel_for(&self, count: usize, body: impl Fn(usize) + Sync) -> Result<(), NodeFault> {
        done(self.services.parallel_for(count, &body))
    }

    /// Cuts `elements` into chunks of `size` (the last may be shorter; 0 counts as 1) and calls `body`
    /// with each and its number, several at once and in no order: a grid's rows, if `size` is the number
    /// of its columns. A loop within a loop runs on one thread.
    ///
    /// # Errors
    /// [`NodeFault::Cancelled`] if the work was called off; pass it on with `?`.
    pub fn parallel_chunks<T: Send>(
        &self,
        elements: &mut [T],
        size: usize,
        body: impl Fn(usize, &mut [T]) + Sync,
    ) -> Result<(), NodeFault> {
        // Each is locked once, by whoever gets its number: this only proves it.
        let chunks: Vec<_> = elements.chunks_mut(size.max(1)).map(Mutex::new).collect();
        self.parallel_for(chunks.len(), |index| {
            let mut chunk = chunks[index].lock().unwrap_or_else(PoisonError::into_inner);
            body(index, &mut chunk);
        })
    }

    fn argument(&self, param: &str) -> Option<Argument<'a>> {
        let place = self.params.iter().position(|known| known.name == param)?;
        Some(self.arguments[place])
    }
}

fn done(all: bool) -> Result<(), NodeFault> {
    if all { Ok(()) } else { Err(NodeFault::Cancelled) }
}

fn no_param(kind: &str, name: &str) -> NodeFault {
    NodeFault::Failed(format!("the node is wrong: it has no {kind} called {name:?}"))
}

fn check_count(what: &str, wanted: usize, given: usize) -> Result<(), NodeFault> {
    if wanted == given {
        return Ok(());
    }
    Err(NodeFault::Failed(format!("the node has {wanted} {what} and was given {given}")))
}

fn check_argument(param: &Param, given: &Argument<'_>) -> Result<(), NodeFault> {
    let fits = match (param.kind, *given) {
        (ParamKind::Number { min, max, .. }, Argument::Number(given)) => {
            given.is_finite() && (min..=max).contains(&given)
        }
        (ParamKind::Integer { min, max, .. }, Argument::Integer(given)) => {
            (min..=max).contains(&given)
        }
        (ParamKind::Choice { options, .. }, Argument::Text(given)) => {
            options.iter().any(|option| option.name == given)
        }
        (kind, given) => matches!(
            (kind, given),
            (ParamKind::Switch { .. }, Argument::Switch(_))
                | (ParamKind::Text { .. }, Argument::Text(_))
        ),
    };
    if fits {
        return Ok(());
    }
    Err(NodeFault::Failed(format!("the parameter {:?} cannot be {given:?}", param.name)))
}

fn check_input(port: &Port, given: Option<&Raw<'_>>) -> Result<(), NodeFault> {
    let name = port.name;
    let fault = match given {
        None if port.optional => return Ok(()),
        None => format!("nothing is connected to {name:?}"),
        Some(raw) if raw.type_name == port.type_name => return Ok(()),
        Some(raw) => {
            format!("the input {name:?} is a {}; it must be a {}", raw.type_name, port.type_name)
        }
    };
    Err(NodeFault::Failed(fault))
}

impl Argument<'static> {
    /// What `param` is set to where a recipe says nothing.
    #[must_use]
    pub fn default_of(param: &Param) -> Self {
        match param.kind {
            ParamKind::Number { default, .. } => Self::Number(default),
            ParamKind::Integer { default, .. } => Self::Integer(default),
            ParamKind::Switch { default } => Self::Switch(default),
            ParamKind::Text { default } | ParamKind::Choice { default, .. } => Self::Text(default),
        }
    }
}

impl From<f64> for Argument<'_> {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<i64> for Argument<'_> {
    fn from(number: i64) -> Self {
        Self::Integer(number)
    }
}

impl From<i32> for Argument<'_> {
    fn from(number: i32) -> Self {
        Self::Integer(number.into())
    }
}

impl From<bool> for Argument<'_> {
    fn from(on: bool) -> Self {
        Self::Switch(on)
    }
}

impl<'a> From<&'a str> for Argument<'a> {
    fn from(text: &'a str) -> Self {
        Self::Text(text)
    }
}

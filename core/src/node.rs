//! What a node is.
//!
//! A node reads its inputs, its parameters and what its [`Context`] hands it, and nothing else: no
//! clock, no randomness, no files of its own finding. The same inputs give the same outputs, bit
//! for bit, on any number of threads.

use crate::context::Context;
use crate::node_error::NodeError;
use crate::param::{ParamSpec, ParamValues, Params};
use crate::port::{InputValues, Inputs, Outputs, PortSpec, Value};

/// A parameter that is wrong only beside another one.
#[derive(Debug, PartialEq)]
pub struct Conflict {
    /// The parameter to point at.
    pub param: &'static str,
    /// What is wrong and what to do.
    pub message: String,
}

/// One step of a graph; its parameters are the struct's fields.
pub trait Node: Params + Send + Sync + 'static {
    /// The name recipes call it by.
    const KIND: &'static str;
    /// Raised whenever the same inputs would give other outputs than before, so that cached values
    /// of the older version are not taken.
    const VERSION: u32 = 1;
    /// Whether it asks its context for the [prefix](Context::prefix). If not, the same picture under
    /// another name gives it nothing new to do.
    const USES_PREFIX: bool = false;
    /// What it reads.
    type Inputs<'a>: Inputs<'a>;
    /// What it makes.
    type Outputs: Outputs;

    /// Finds parameters that contradict each other, before anything runs.
    ///
    /// # Errors
    /// The first contradiction.
    fn check(&self) -> Result<(), Conflict> {
        Ok(())
    }

    /// Why this node, set like this, has nothing to do. Such a node is not run, nor is anything
    /// that only it would need.
    fn idle(&self) -> Option<&'static str> {
        None
    }

    /// Does the work.
    ///
    /// # Errors
    /// See [`NodeError`].
    fn run(&self, inputs: Self::Inputs<'_>, cx: &Context<'_>) -> Result<Self::Outputs, NodeError>;
}

/// A node whose types are hidden, as the engine holds it.
pub(crate) trait AnyNode: Send + Sync {
    fn check(&self) -> Result<(), Conflict>;
    fn idle(&self) -> Option<&'static str>;
    fn run(&self, inputs: &InputValues, cx: &Context<'_>) -> Result<Vec<Value>, NodeError>;
}

impl<N: Node> AnyNode for N {
    fn check(&self) -> Result<(), Conflict> {
        Node::check(self)
    }

    fn idle(&self) -> Option<&'static str> {
        Node::idle(self)
    }

    fn run(&self, inputs: &InputValues, cx: &Context<'_>) -> Result<Vec<Value>, NodeError> {
        Ok(Node::run(self, N::Inputs::take(inputs), cx)?.into_values())
    }
}

/// The definition of a kind of node, all read off its type.
pub struct NodeKind {
    /// The name recipes call it by.
    pub name: &'static str,
    /// Its version; see [`Node::VERSION`].
    pub version: u32,
    /// See [`Node::USES_PREFIX`].
    pub uses_prefix: bool,
    /// The stage of the work it belongs to, such as "picture" or "path".
    pub stage: &'static str,
    /// What it does, for a user.
    pub about: &'static str,
    /// Its parameters.
    pub params: Vec<ParamSpec>,
    /// Its input ports.
    pub inputs: Vec<PortSpec>,
    /// Its output ports.
    pub outputs: Vec<PortSpec>,
    pub(crate) make: fn(&ParamValues) -> Box<dyn AnyNode>,
}

impl NodeKind {
    /// The definition of `N`, listed under `stage`.
    #[must_use]
    pub fn of<N: Node>(stage: &'static str) -> Self {
        Self {
            name: N::KIND,
            version: N::VERSION,
            uses_prefix: N::USES_PREFIX,
            stage,
            about: N::about(),
            params: N::specs(),
            inputs: N::Inputs::ports(),
            outputs: N::Outputs::ports(),
            make: |values| Box::new(N::from_values(values)),
        }
    }

    /// Its parameter called `name`.
    #[must_use]
    pub fn param(&self, name: &str) -> Option<&ParamSpec> {
        self.params.iter().find(|param| param.name == name)
    }
}

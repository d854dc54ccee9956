//! What a node is.
//!
//! A node reads its inputs, its parameters and what its [`Context`] hands it, and nothing else: no
//! clock, no randomness, no files of its own finding. The same inputs give the same outputs, bit
//! for bit, on any number of threads.

use crate::context::Context;
use crate::node_error::NodeError;
use crate::param::{ParamKind, ParamSpec, ParamValues, Params};
use crate::port::{InputValues, Inputs, Outputs, PortSpec, Value};
use std::fmt;
use std::sync::Arc;

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

/// Makes a node of its parameters.
#[derive(Clone)]
pub struct NodeMaker(Arc<Make>);

type Make = dyn Fn(&ParamValues) -> Box<dyn AnyNode> + Send + Sync;
type Run =
    dyn Fn(&ParamValues, &InputValues, &Context<'_>) -> Result<Vec<Value>, NodeError> + Send + Sync;

impl NodeMaker {
    /// Makes nodes of type `N`.
    #[must_use]
    pub fn of<N: Node>() -> Self {
        Self(Arc::new(|values| Box::new(N::from_values(values))))
    }

    /// Makes nodes whose work is done by `run`, for definitions that come from elsewhere than a
    /// Rust type, such as a plugin. It gives one value for each output port of the kind, in that
    /// order and of the port's type; a run checks that.
    pub fn of_fn<R>(run: R) -> Self
    where
        R: Fn(&ParamValues, &InputValues, &Context<'_>) -> Result<Vec<Value>, NodeError>
            + Send
            + Sync
            + 'static,
    {
        let run: Arc<Run> = Arc::new(run);
        Self(Arc::new(move |values| {
            Box::new(Made { values: values.clone(), run: Arc::clone(&run) })
        }))
    }

    pub(crate) fn make(&self, values: &ParamValues) -> Box<dyn AnyNode> {
        (self.0)(values)
    }
}

impl fmt::Debug for NodeMaker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("NodeMaker")
    }
}

/// A node whose work is a function.
struct Made {
    values: ParamValues,
    run: Arc<Run>,
}

impl AnyNode for Made {
    fn check(&self) -> Result<(), Conflict> {
        Ok(())
    }

    fn idle(&self) -> Option<&'static str> {
        None
    }

    fn run(&self, inputs: &InputValues, cx: &Context<'_>) -> Result<Vec<Value>, NodeError> {
        (self.run)(&self.values, inputs, cx)
    }
}

/// The definition of a kind of node: read off its type, or put together from what a plugin says.
#[derive(Clone, Debug)]
pub struct NodeKind {
    /// The name recipes call it by.
    pub name: &'static str,
    /// Its version; see [`Node::VERSION`].
    pub version: u32,
    /// Where it comes from if it is no part of the program: the name and the version of a plugin.
    /// From another one its values are made anew.
    pub origin: Option<String>,
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
    /// What makes one of its parameters.
    pub maker: NodeMaker,
}

impl NodeKind {
    /// The definition of `N`, listed under `stage`.
    #[must_use]
    pub fn of<N: Node>(stage: &'static str) -> Self {
        Self {
            name: N::KIND,
            version: N::VERSION,
            origin: None,
            uses_prefix: N::USES_PREFIX,
            stage,
            about: N::about(),
            params: N::specs(),
            inputs: N::Inputs::ports(),
            outputs: N::Outputs::ports(),
            maker: NodeMaker::of::<N>(),
        }
    }

    /// Its own parameter called `name`.
    #[must_use]
    pub fn param(&self, name: &str) -> Option<&ParamSpec> {
        self.params.iter().find(|param| param.name == name)
    }

    /// Its parameters that choose an entry whose parameters it takes, each with the catalog.
    pub fn choosers(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.params.iter().filter_map(|param| match param.kind {
            ParamKind::Catalog { catalog, takes_params: true } => Some((param.name, catalog)),
            _ => None,
        })
    }
}

//! The engine: recipes, typed graphs, parallel runs that remember what they made.
//!
//! It knows nothing of carving. A program gives it a [`Registry`] of nodes and the types that pass
//! between them, and a [`Library`] of recipes. Then, in this order:
//!
//! 1. [`Library::open`] reads a recipe and finds what is wrong with its form;
//! 2. [`Graph::build`] checks it against the registry and finds everything else that is wrong;
//! 3. [`Plan::new`] chooses what has to be done;
//! 4. [`run()`] does it and reports.

// The derives write `::carvegraph_core`, in this crate too.
extern crate self as carvegraph_core;

mod cache;
mod cancel;
mod catalog;
mod context;
pub mod diagnostic;
mod files;
pub mod graph;
mod hashing;
mod library;
mod node;
mod node_error;
mod param;
mod plan;
mod port;
pub mod recipe;
mod registry;
pub mod report;
pub mod ron;
mod run;
pub mod source;
mod staging;
mod trust;
pub mod units;

pub use cache::{Cache, CacheError, DiskCache, Entry, Key, MemoryCache, Parts};
pub use cancel::CancelToken;
pub use carvegraph_derive::{Choice, Inputs, Outputs, Params};
pub use catalog::{CatalogEntry, Catalogs, Missing};
pub use context::{Context, Ticker, with_context};
pub use diagnostic::{Diagnostic, Diagnostics};
pub use files::{Assets, FileError, InputFile, MAX_INPUT_BYTES, Origin, OutputName};
pub use graph::{Graph, Setting};
pub use library::Library;
pub use node::{Conflict, Node, NodeKind, NodeMaker};
pub use node_error::NodeError;
pub use param::{
    ChoiceOption, EntryParams, Given, NO_FILE, ParamFault, ParamField, ParamHints, ParamKind,
    ParamSpec, ParamValue, ParamValues, Params, Yielding,
};
pub use plan::{Plan, Step};
pub use port::{Facts, InputValues, Inputs, Outputs, PortSpec, PortType, Value};
pub use recipe::Recipe;
pub use registry::{Registry, RegistryError};
pub use report::{
    NodeReport, NodeStatus, Note, Observer, PortReport, ReadFile, RunReport, RunStatus, Weight,
};
pub use run::{RunOptions, Session, THREAD_NAME, run};
pub use staging::{OutputFile, WrittenFile};
pub use trust::NO_LIBRARY;

//! What recipes can choose from beside the standard nodes, wherever it comes from: linked plugins,
//! plugins in libraries, files.

use crate::plugin::{PluginNodeError, kind_of};
use crate::registry::kinds;
use crate::services::{Cutters, Dialects};
use crate::shop::{Machine, Machines, NONE, Tool, Tools};
use carvegraph_core::diagnostic::did_you_mean;
use carvegraph_core::{Diagnostics, Missing, NodeKind};
use carvegraph_sdk::node::Node;
use carvegraph_sdk::{CutterShape, Dialect};
use std::collections::BTreeMap;

/// Whose the built-in machines, tools and nodes are.
const OURS: &str = "carve";

/// What one plugin or file brings.
#[derive(Default)]
pub struct Batch {
    /// Cutter shapes.
    pub cutters: Vec<Box<dyn CutterShape>>,
    /// Dialects.
    pub dialects: Vec<Box<dyn Dialect>>,
    /// Kinds of node.
    pub nodes: Vec<Box<dyn Node>>,
    /// Machines.
    pub machines: Vec<Machine>,
    /// Tools.
    pub tools: Vec<Tool>,
}

/// A sort of thing and the name of one.
type Named = (&'static str, String);

/// Everything that is offered; at first the built-in machines and tools.
pub struct Offers {
    pub(crate) cutters: Cutters,
    pub(crate) dialects: Dialects,
    pub(crate) machines: Machines,
    pub(crate) tools: Tools,
    pub(crate) nodes: Vec<NodeKind>,
    pub(crate) missing: Vec<(&'static str, Missing)>,
    /// Where each thing comes from, and in which version.
    origins: BTreeMap<Named, String>,
}

/// Why something cannot be offered.
#[derive(Debug, thiserror::Error)]
pub enum OfferError {
    /// Its name is taken.
    #[error("it offers the {sort} {name:?}, which {owner} has already")]
    Taken {
        /// cutter, dialect, node ...
        sort: &'static str,
        /// The name.
        name: String,
        /// Whose it is.
        owner: String,
    },
    /// A node is defined wrongly.
    #[error(transparent)]
    Node(#[from] PluginNodeError),
    /// A machine's controller is not known.
    #[error("{place}: there is no dialect {dialect:?}{near}")]
    Dialect {
        /// Where the machine says so.
        place: String,
        /// What it says.
        dialect: String,
        /// A name that is near, as the end of a sentence.
        near: String,
    },
    /// Tools have shapes that are not known, or dimensions that the shapes lack.
    #[error("{0}")]
    Tools(Diagnostics),
}

impl Default for Offers {
    fn default() -> Self {
        let (machines, tools) = (Machines::built_in(), Tools::built_in());
        let names = machines.0.iter().map(|machine| ("machine", machine.name.clone()));
        let names = names.chain(tools.0.iter().map(|tool| ("tool", tool.name.clone())));
        let names = names.chain(kinds().into_iter().map(|kind| ("node", kind.name.to_owned())));
        let reserved = ["machine", "tool"].map(|sort| (sort, NONE.to_owned()));
        let origins = names.chain(reserved).map(|name| (name, OURS.to_owned())).collect();
        Self {
            cutters: Cutters(Vec::new()),
            dialects: Dialects(Vec::new()),
            machines,
            tools,
            nodes: Vec::new(),
            missing: Vec::new(),
            origins,
        }
    }
}

impl Offers {
    /// Adds all of a batch, or nothing if something is wrong with it. `origin` says where it comes from
    /// and in which version. Dialects and cutters come before the machines and tools that name them.
    ///
    /// # Errors
    /// If a name is taken, a node is defined wrongly, or a machine or tool needs what there is not.
    pub fn add(&mut self, batch: Batch, origin: &str) -> Result<(), OfferError> {
        let names = self.claimed(&batch, origin)?;
        let Batch { cutters, dialects, nodes, machines, tools } = batch;
        let kind = |node| kind_of(node, origin.to_owned());
        let nodes = nodes.into_iter().map(kind).collect::<Result<Vec<_>, _>>()?;
        machines.iter().try_for_each(|machine| self.check_machine(machine))?;
        let tools = self.checked_tools(tools)?;
        self.cutters.0.extend(cutters);
        self.dialects.0.extend(dialects);
        self.nodes.extend(nodes);
        self.machines.0.extend(machines);
        self.tools.0.extend(tools);
        self.origins.extend(names);
        Ok(())
    }

    /// Adds the name of something that cannot be had; see [`Missing`]. `sort` is "node", or the catalog.
    pub fn miss(&mut self, sort: &'static str, missing: Missing) {
        self.missing.push((sort, missing));
    }

    /// Where a thing comes from, and in which version.
    pub(crate) fn origin(&self, sort: &'static str, name: &str) -> &str {
        self.origins.get(&(sort, name.to_owned())).map_or("", String::as_str)
    }

    /// The names of a batch, if none is taken, nor twice its own.
    fn claimed(&self, batch: &Batch, origin: &str) -> Result<BTreeMap<Named, String>, OfferError> {
        let mut claimed = BTreeMap::new();
        for named in batch.names() {
            let earlier = claimed.insert(named.clone(), origin.to_owned());
            if let Some(owner) = self.origins.get(&named).cloned().or(earlier) {
                let (sort, name) = named;
                return Err(OfferError::Taken { sort, name, owner });
            }
        }
        Ok(claimed)
    }

    fn check_machine(&self, machine: &Machine) -> Result<(), OfferError> {
        let Some(dialect) = &machine.dialect else { return Ok(()) };
        if self.dialects.find(dialect).is_some() {
            return Ok(());
        }
        let near = did_you_mean(dialect, self.dialects.0.iter().map(|known| known.name()));
        Err(OfferError::Dialect {
            place: machine.dialect_place.clone(),
            dialect: dialect.clone(),
            near: near.map(|near| format!(": did you mean {near:?}?")).unwrap_or_default(),
        })
    }

    fn checked_tools(&self, tools: Vec<Tool>) -> Result<Vec<Tool>, OfferError> {
        let tools = Tools(tools);
        let faults = tools.faults(&self.cutters);
        if faults.is_empty() { Ok(tools.0) } else { Err(OfferError::Tools(faults)) }
    }
}

impl Batch {
    fn names(&self) -> Vec<Named> {
        let Self { cutters, dialects, nodes, machines, tools } = self;
        let cutters = cutters.iter().map(|cutter| ("cutter", cutter.name().to_owned()));
        let dialects = dialects.iter().map(|dialect| ("dialect", dialect.name().to_owned()));
        let nodes = nodes.iter().map(|node| ("node", node.name().to_owned()));
        let machines = machines.iter().map(|machine| ("machine", machine.name.clone()));
        let tools = tools.iter().map(|tool| ("tool", tool.name.clone()));
        cutters.chain(dialects).chain(nodes).chain(machines).chain(tools).collect()
    }
}

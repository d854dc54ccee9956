//! A recipe checked, its inner recipes laid out flat, every parameter set and every wire tied.
//!
//! [`Graph::build`] finds everything that can be wrong before anything runs, and says all of it at
//! once. What it returns can be planned and run.

mod assign;
mod flatten;
mod settle;
mod wire;

use crate::catalog::Catalogs;
use crate::diagnostic::Diagnostics;
use crate::files::{Files, InputFile, harmless_stem};
use crate::library::Library;
use crate::node::{AnyNode, NodeKind};
use crate::param::{ParamSpec, ParamValue, ParamValues};
use crate::recipe::Recipe;
use crate::registry::Registry;
use crate::source::Span;
use flatten::{Flattened, Flattener};
use petgraph::graph::{DiGraph, NodeIndex};
use settle::Settled;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

pub use assign::Setting;

/// Where an input's value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Wire {
    /// The node, as an index into [`Graph::nodes`].
    pub node: usize,
    /// Its output port, as an index into its kind's outputs.
    pub port: usize,
}

/// A node of a checked graph.
pub struct GraphNode {
    /// Its name; of a node in an inner recipe `outer/inner`.
    pub id: String,
    /// Its kind, as an index into [`Registry::kinds`].
    kind: usize,
    /// All its parameters.
    pub values: ParamValues,
    /// For each input port of its kind where the value comes from, if anywhere.
    pub inputs: Vec<Option<Wire>>,
    /// Why it has nothing to do, if so.
    pub idle: Option<&'static str>,
    /// What its output files are called after.
    pub prefix: String,
    /// Where those of its parameters are set that are.
    pub(crate) places: BTreeMap<String, Span>,
    pub(crate) node: Box<dyn AnyNode>,
}

impl GraphNode {
    /// The files it reads.
    pub fn files(&self) -> impl Iterator<Item = &InputFile> {
        self.values.iter().filter_map(|(_, value)| match value {
            ParamValue::File(file) => Some(file),
            _ => None,
        })
    }

    /// Whether it writes files: such a node is run for them, not for its values.
    #[must_use]
    pub fn writes_files(&self) -> bool {
        self.values.iter().any(|(_, value)| matches!(value, ParamValue::Output(_)))
    }
}

/// A checked graph.
pub struct Graph {
    /// The name of the recipe.
    pub recipe: String,
    /// All nodes, in the order they are written.
    pub nodes: Vec<GraphNode>,
    /// The nodes that the recipe is run for.
    pub wanted: Vec<usize>,
    pub(crate) order: Vec<usize>,
    pub(crate) registry: Registry,
    pub(crate) files: Files,
}

impl Graph {
    /// Checks `recipe` as changed by `settings` and makes a graph of it, along with what there is
    /// to warn of.
    ///
    /// # Errors
    /// All that is wrong.
    pub fn build(
        recipe: &Recipe,
        settings: &[Setting],
        registry: &Registry,
        library: &Library,
    ) -> Result<Self, Diagnostics> {
        let files = Files { assets: library.assets };
        let mut faults = Diagnostics::default();
        let mut flattener = Flattener::new(recipe, registry, library, &mut faults);
        settings.iter().for_each(|setting| flattener.apply(setting));
        let flat = flattener.flat;
        let wires = wire::tie(&flat, registry, &mut faults);
        let settled = settle::settle(&flat, registry, files, &mut faults);
        let order = wire::order(&flat, &wires, &mut faults);
        let (Some(settled), false) = (settled, faults.has_errors()) else { return Err(faults) };
        let nodes = flat.nodes.iter().zip(wires).zip(settled).map(|((node, inputs), settled)| {
            let idle = settled.node.idle();
            let Settled { kind, values, node: made } = settled;
            let (id, prefix) = (node.id.clone(), String::new());
            let places = node.set.iter().map(|(name, set)| (name.clone(), set.span.clone()));
            let places = places.collect();
            GraphNode { id, kind, values, inputs, idle, prefix, places, node: made }
        });
        let mut wanted: Vec<usize> =
            flat.scopes[0].ports.iter().flat_map(|port| &port.nodes).copied().collect();
        wanted.sort_unstable();
        wanted.dedup();
        let mut graph = Self {
            recipe: recipe.name.clone(),
            nodes: nodes.collect(),
            wanted,
            order,
            registry: registry.clone(),
            files,
        };
        graph.rest_idle(&flat, &mut faults);
        graph.name_outputs();
        if faults.has_errors() { Err(faults) } else { Ok(graph) }
    }

    /// Whether what a node makes depends on its prefix.
    pub(crate) fn uses_prefix(&self, node: &GraphNode) -> bool {
        let is_used =
            |value: &ParamValue| matches!(value, ParamValue::Output(name) if name.uses_prefix());
        self.kind(node).uses_prefix || node.values.iter().any(|(_, value)| is_used(value))
    }

    /// The definition of a node's kind.
    #[must_use]
    pub fn kind(&self, node: &GraphNode) -> &NodeKind {
        &self.registry.kinds()[node.kind]
    }

    /// The definition of a node's parameter: one of its kind's, or one that came with an entry that
    /// the node chose.
    #[must_use]
    pub fn param(&self, node: &GraphNode, name: &str) -> Option<&ParamSpec> {
        let kind = self.kind(node);
        let chosen = |(chooser, catalog)| {
            self.catalogs().entry(catalog, node.values.find(chooser)?.text())?.param(name)
        };
        kind.param(name).or_else(|| kind.choosers().find_map(chosen))
    }

    /// The number of the node called `id`.
    #[must_use]
    pub fn find(&self, id: &str) -> Option<usize> {
        self.nodes.iter().position(|node| node.id == id)
    }

    /// What a file about the whole run is called after: what its output files are, or the recipe if they
    /// are not all called after one thing.
    #[must_use]
    pub fn prefix(&self) -> String {
        let writing = self.nodes.iter().filter(|node| node.writes_files() && node.idle.is_none());
        let prefixes: BTreeSet<&str> = writing.map(|node| node.prefix.as_str()).collect();
        match prefixes.first() {
            Some(one) if prefixes.len() == 1 => (*one).to_owned(),
            _ => harmless_stem(Path::new(&self.recipe)),
        }
    }

    /// The node numbers in an order in which each stands behind those it reads from.
    pub(crate) fn in_order(&self) -> impl DoubleEndedIterator<Item = usize> + '_ {
        self.order.iter().copied()
    }

    pub(crate) fn catalogs(&self) -> &Catalogs {
        self.registry.catalogs()
    }

    /// Cuts the wires from idle nodes where the input may stay open; complains where it may not.
    fn rest_idle(&mut self, flat: &Flattened, faults: &mut Diagnostics) {
        for at in 0..self.nodes.len() {
            let specs = &self.registry.kinds()[self.nodes[at].kind].inputs;
            for (port, spec) in specs.iter().enumerate() {
                let Some(wire) = self.nodes[at].inputs[port] else { continue };
                let source = &self.nodes[wire.node];
                let Some(why) = source.idle else { continue };
                if !spec.optional && self.nodes[at].idle.is_none() {
                    let message = format!(
                        "port {:?} of node {:?} needs {:?}, which makes nothing: {why}",
                        spec.name, self.nodes[at].id, source.id
                    );
                    faults.push(flat.nodes[at].fault(message));
                }
                self.nodes[at].inputs[port] = None;
            }
        }
    }

    /// Names each node's output files after the first file that it, or a node before it, reads, and
    /// after the recipe if there is none. A file that came with a catalog entry is not what the work
    /// is about, nor is one that a node can do without.
    fn name_outputs(&mut self) {
        for at in self.order.clone() {
            let node = &self.nodes[at];
            let mut params = self.kind(node).params.iter().filter(|param| param.default.is_none());
            let own = params.find_map(|param| match node.values.get(param.name) {
                ParamValue::File(file) => Some(file.stem()),
                _ => None,
            });
            let mut before = node.inputs.iter().flatten().map(|wire| &self.nodes[wire.node].prefix);
            let inherited = || before.find(|prefix| !prefix.is_empty()).cloned();
            self.nodes[at].prefix = own.or_else(inherited).unwrap_or_default();
        }
        let recipe = harmless_stem(Path::new(&self.recipe));
        for node in self.nodes.iter_mut().filter(|node| node.prefix.is_empty()) {
            node.prefix.clone_from(&recipe);
        }
    }
}

/// The graph of nodes as petgraph takes it: an arrow from each node to those that read from it.
pub(crate) fn arrows(inputs: &[Vec<Option<Wire>>]) -> DiGraph<(), ()> {
    let mut graph = DiGraph::with_capacity(inputs.len(), inputs.len());
    for _ in inputs {
        graph.add_node(());
    }
    for (reader, wires) in inputs.iter().enumerate() {
        for wire in wires.iter().flatten() {
            graph.update_edge(NodeIndex::new(wire.node), NodeIndex::new(reader), ());
        }
    }
    graph
}

//! Names of sources looked up, types compared, and the nodes put in order.

use super::flatten::{Feed, FlatNode, Flattened, Member};
use super::{Wire, arrows};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::node::NodeKind;
use crate::port::PortSpec;
use crate::registry::Registry;
use crate::ron::Name;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::NodeIndex;
use std::collections::HashSet;

/// Messages name no more nodes or ports than this.
const MAX_NAMED: usize = 12;

/// An output of a recipe, which is its port where it serves as a node.
pub(super) struct Port {
    /// The node, or `node.port`, as the recipe writes it.
    name: String,
    /// The nodes that the recipe is run for on its account.
    pub(super) nodes: Vec<usize>,
    wires: Vec<Wire>,
}

impl Port {
    /// Whether `word` means this port: by its whole name or by its node.
    fn is(&self, word: &str) -> bool {
        let rest = self.name.strip_prefix(word);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    }
}

/// The outputs of a scope whose members are laid out.
pub(super) fn ports(
    flat: &Flattened,
    registry: &Registry,
    scope: usize,
    faults: &mut Diagnostics,
) -> Vec<Port> {
    let outputs = &flat.scopes[scope].recipe.outputs;
    outputs.iter().filter_map(|word| offered(flat, registry, scope, word, faults)).collect()
}

/// What a source could mean: one output where it names a port, else all of the node's. `None` where
/// there was something to complain of.
fn offered(
    flat: &Flattened,
    registry: &Registry,
    scope: usize,
    word: &Name,
    faults: &mut Diagnostics,
) -> Option<Port> {
    let (id, port) = match word.text.split_once('.') {
        Some((id, port)) => (id, Some(port)),
        None => (word.text.as_str(), None),
    };
    let members = &flat.scopes[scope].members;
    let fault = |message: String| Diagnostic::error(message).at(word.span.clone());
    let Some(member) = members.get(id) else {
        let names = members.keys().map(String::as_str);
        faults.push_near(fault(format!("there is no node {id:?}")), id, names);
        return None;
    };
    let name = word.text.clone();
    match member {
        Member::Broken => None,
        Member::Node(at) => {
            let kind = &registry.kinds()[flat.nodes[*at].kind?];
            let is_meant = |spec: &PortSpec| port.is_none_or(|port| port == spec.name);
            let outputs = kind.outputs.iter().enumerate().filter(|(_, spec)| is_meant(spec));
            let wires: Vec<Wire> = outputs.map(|(port, _)| Wire { node: *at, port }).collect();
            if let (Some(port), true) = (port, wires.is_empty()) {
                let message = format!("node {id:?} ({}) has no output {port:?}", kind.name);
                faults.push_near(fault(message), port, kind.outputs.iter().map(|spec| spec.name));
                return None;
            }
            Some(Port { name, nodes: vec![*at], wires })
        }
        Member::Recipe(inner) => {
            let ports = &flat.scopes[*inner].ports;
            let meant = || ports.iter().filter(|known| port.is_none_or(|port| known.is(port)));
            if let (Some(port), None) = (port, meant().next()) {
                let message = format!("recipe {id:?} has no output {port:?}");
                let names = ports.iter().map(|port| port.name.as_str());
                faults.push_near(fault(message), port, names);
                return None;
            }
            let mut nodes: Vec<usize> = meant().flat_map(|port| &port.nodes).copied().collect();
            let mut wires: Vec<Wire> = meant().flat_map(|port| &port.wires).copied().collect();
            // Two outputs may lead to one node.
            nodes.sort_unstable();
            nodes.dedup();
            wires.sort_unstable();
            wires.dedup();
            Some(Port { name, nodes, wires })
        }
    }
}

/// For each node and each input port of its kind, where the value comes from.
pub(super) fn tie(
    flat: &Flattened,
    registry: &Registry,
    faults: &mut Diagnostics,
) -> Vec<Vec<Option<Wire>>> {
    let mut tying = Tying { flat, registry, faults };
    let tie = |node: &FlatNode| match node.kind {
        Some(kind) => tying.inputs(node, &registry.kinds()[kind]),
        None => Vec::new(),
    };
    flat.nodes.iter().map(tie).collect()
}

struct Tying<'a> {
    flat: &'a Flattened,
    registry: &'a Registry,
    faults: &'a mut Diagnostics,
}

impl Tying<'_> {
    fn inputs(&mut self, node: &FlatNode, kind: &NodeKind) -> Vec<Option<Wire>> {
        let unknown = |port: &String| kind.inputs.iter().all(|spec| spec.name != port);
        let tie = |spec: &PortSpec| match node.from.get(spec.name) {
            Some(feed) => self.source(node, spec, feed),
            None if spec.optional => None,
            // A wire to an input that there is not was meant for this one, and complained of.
            None if node.from.keys().any(unknown) => None,
            None => {
                let wanted = self.registry.type_of(spec).name;
                let message =
                    format!("node {:?} ({}) needs its input {:?}", node.id, kind.name, spec.name);
                let help = format!(
                    "add from: {{ {:?}: \"NODE\" }} with a node that gives a {wanted}",
                    spec.name
                );
                self.faults.push(node.fault(message).help(help));
                None
            }
        };
        kind.inputs.iter().map(tie).collect()
    }

    /// The one output behind a feed that fits a port.
    fn source(&mut self, node: &FlatNode, wanted: &PortSpec, feed: &Feed) -> Option<Wire> {
        let Feed { source, scope } = feed;
        let id = source.text.split('.').next().unwrap_or_default();
        let offered = offered(self.flat, self.registry, *scope, source, self.faults)?.wires;
        let type_id = |wire: &&Wire| self.output(wire).map(|spec| spec.type_id);
        let fitting: Vec<Wire> =
            offered.iter().filter(|wire| type_id(wire) == Some(wanted.type_id)).copied().collect();
        if let [wire] = fitting[..] {
            return Some(wire);
        }
        let wanted_type = self.registry.type_of(wanted).name;
        let target = format!("input {:?} of node {:?}", wanted.name, node.id);
        let source_id = &source.text;
        let fault = if offered.is_empty() {
            Diagnostic::error(format!("{source_id:?} has no output to read from"))
        } else if fitting.is_empty() {
            let names = self.names(&offered);
            Diagnostic::error(format!(
                "{target} wants a {wanted_type}, but {source_id:?} gives {names}"
            ))
        } else {
            let names = self.names(&fitting);
            Diagnostic::error(format!("{target} could read several outputs of {source_id:?}"))
                .help(format!("name one as {id}.PORT: {names}"))
        };
        self.faults.push(fault.at(source.span.clone()));
        None
    }

    fn output(&self, wire: &Wire) -> Option<&PortSpec> {
        self.registry.kinds()[self.flat.nodes[wire.node].kind?].outputs.get(wire.port)
    }

    /// Outputs for a message: "low (number), high (number)".
    fn names(&self, wires: &[Wire]) -> String {
        let name = |wire: &Wire| {
            let spec = self.output(wire)?;
            Some(format!("{} ({})", spec.name, self.registry.type_of(spec).name))
        };
        let names: Vec<String> = wires.iter().take(MAX_NAMED).filter_map(name).collect();
        names.join(", ")
    }
}

/// The nodes in an order in which each stands behind those it reads from; complains of loops.
pub(super) fn order(
    flat: &Flattened,
    wires: &[Vec<Option<Wire>>],
    faults: &mut Diagnostics,
) -> Vec<usize> {
    let graph = arrows(wires);
    // Kosaraju's algorithm gives the components in reverse order.
    let mut components = kosaraju_scc(&graph);
    components.reverse();
    let mut order = Vec::with_capacity(flat.nodes.len());
    for component in components {
        let first = component[0];
        if component.len() > 1 || graph.contains_edge(first, first) {
            faults.push(loop_fault(flat, wires, &component));
        }
        order.extend(component.iter().map(|node| node.index()));
    }
    order
}

/// Names a loop among nodes that all lie on loops.
fn loop_fault(
    flat: &Flattened,
    wires: &[Vec<Option<Wire>>],
    component: &[NodeIndex],
) -> Diagnostic {
    let start = component.iter().map(|node| node.index()).min().unwrap_or_default();
    let inside: HashSet<usize> = component.iter().map(|node| node.index()).collect();
    // Each of them reads from another one of them: follow that back until one comes twice.
    let (mut walk, mut unseen, mut at) = (Vec::new(), inside.clone(), start);
    while unseen.remove(&at) {
        walk.push(at);
        let mut sources = wires[at].iter().flatten().map(|wire| wire.node);
        at = sources.find(|source| inside.contains(source)).unwrap_or(at);
    }
    let first = walk.iter().position(|node| *node == at).unwrap_or_default();
    let mut names: Vec<&str> =
        walk[first..].iter().map(|node| flat.nodes[*node].id.as_str()).collect();
    names.push(&flat.nodes[at].id);
    names.reverse();
    let more = names.len().saturating_sub(MAX_NAMED);
    if more > 0 {
        names.splice(MAX_NAMED - 1..names.len() - 1, ["..."]);
    }
    let message = format!("these nodes wait for each other in a loop: {}", names.join(" -> "));
    flat.nodes[at].fault(message).help("take one of these wires out")
}

//! Names of sources looked up, types compared, and the nodes put in order.

use super::flatten::{FlatNode, Flattened, Member, Scope};
use super::{Wire, arrows};
use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::node::NodeKind;
use crate::recipe::{Name, Recipe};
use crate::registry::Registry;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::NodeIndex;

/// For each node and each input port of its kind, where the value comes from.
pub(super) fn tie(
    flat: &Flattened,
    registry: &Registry,
    faults: &mut Diagnostics,
) -> Vec<Vec<Option<Wire>>> {
    let tie = |node: &FlatNode| match node.kind {
        Some(kind) => Tying { flat, registry, faults }.inputs(node, &registry.kinds()[kind]),
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
        let mut wires = vec![None; kind.inputs.len()];
        let mut named = vec![false; kind.inputs.len()];
        for (port, source, scope) in &node.from {
            let Some(at) = kind.inputs.iter().position(|spec| spec.name == port.text) else {
                let message =
                    format!("node {:?} ({}) has no input {:?}", node.id, kind.name, port.text);
                let names: Vec<&str> = kind.inputs.iter().map(|spec| spec.name).collect();
                self.faults.push(near(message, port, &names).node(&node.id));
                continue;
            };
            if named[at] {
                let message = format!("input {:?} of node {:?} is fed twice", port.text, node.id);
                self.faults.push(Diagnostic::error(message).at(port.span.clone()));
            }
            named[at] = true;
            wires[at] = self.source(node, kind, at, source, *scope);
        }
        for (spec, _) in kind.inputs.iter().zip(&named).filter(|(spec, named)| !spec.optional && !**named) {
            let name = self.registry.type_of(spec).name;
            let message =
                format!("node {:?} ({}) needs its input {:?}", node.id, kind.name, spec.name);
            let help = format!("add from: {{ {:?}: \"...\" }} naming a node that gives a {name}", spec.name);
            self.faults.push(node.fault(message).help(help));
        }
        wires
    }

    /// The one output behind `source` that fits input `at`.
    fn source(
        &mut self,
        node: &FlatNode,
        kind: &NodeKind,
        at: usize,
        source: &Name,
        scope: usize,
    ) -> Option<Wire> {
        let offered = self.offered(scope, source)?;
        let wanted = &kind.inputs[at];
        let fitting: Vec<Wire> = offered
            .iter()
            .copied()
            .filter(|wire| self.output(wire).is_some_and(|spec| spec.type_id == wanted.type_id))
            .collect();
        if let [wire] = fitting[..] {
            return Some(wire);
        }
        let names = |wires: &[Wire]| {
            let name = |wire: &Wire| {
                let spec = self.output(wire)?;
                Some(format!("{} ({})", spec.name, self.registry.type_of(spec).name))
            };
            wires.iter().filter_map(name).collect::<Vec<_>>().join(", ")
        };
        let wanted_type = self.registry.type_of(wanted).name;
        let target = format!("input {:?} of node {:?}", wanted.name, node.id);
        let fault = match (offered.is_empty(), fitting.is_empty()) {
            (true, _) => Diagnostic::error(format!("{:?} has no output to read from", source.text)),
            (false, true) => Diagnostic::error(format!(
                "{target} wants a {wanted_type}, but {:?} gives {}",
                source.text,
                names(&offered)
            )),
            (false, false) => Diagnostic::error(format!(
                "{target} could read several outputs of {:?}",
                source.text
            ))
            .help(format!("name one as {}.PORT: {}", source.text, names(&fitting))),
        };
        self.faults.push(fault.at(source.span.clone()).node(&node.id));
        None
    }

    fn output(&self, wire: &Wire) -> Option<&crate::port::PortSpec> {
        self.registry.kinds()[self.flat.nodes[wire.node].kind?].outputs.get(wire.port)
    }

    /// The outputs that a source could mean: one where it names a port, else all of the node's.
    /// `None` where there was something to complain of.
    fn offered(&mut self, scope: usize, source: &Name) -> Option<Vec<Wire>> {
        let (id, port) = match source.text.split_once('.') {
            Some((id, port)) => (id, Some(port)),
            None => (source.text.as_str(), None),
        };
        let members = &self.flat.scopes[scope].members;
        match members.get(id) {
            Some(Member::Node(at)) => self.node_outputs(*at, port, source),
            Some(Member::Recipe(inner)) => self.recipe_outputs(*inner, port, source),
            None => {
                let mut names: Vec<&str> = members.keys().map(String::as_str).collect();
                names.sort_unstable();
                self.faults.push(near(format!("there is no node {id:?}"), source, &names));
                None
            }
        }
    }

    fn node_outputs(&mut self, at: usize, port: Option<&str>, source: &Name) -> Option<Vec<Wire>> {
        let kind = &self.registry.kinds()[self.flat.nodes[at].kind?];
        let all = (0..kind.outputs.len()).map(|port| Wire { node: at, port });
        let Some(port) = port else { return Some(all.collect()) };
        if let Some(port) = kind.outputs.iter().position(|spec| spec.name == port) {
            return Some(vec![Wire { node: at, port }]);
        }
        let id = &self.flat.nodes[at].id;
        let message = format!("node {id:?} ({}) has no output {port:?}", kind.name);
        let names: Vec<&str> = kind.outputs.iter().map(|spec| spec.name).collect();
        self.faults.push(near(message, source, &names));
        None
    }

    fn recipe_outputs(
        &mut self,
        inner: usize,
        port: Option<&str>,
        source: &Name,
    ) -> Option<Vec<Wire>> {
        let outputs = &self.flat.scopes[inner].outputs;
        let name = |word: &Name| word.text.split('.').next().unwrap_or_default().to_owned();
        let chosen: Vec<Name> =
            outputs.iter().filter(|word| port.is_none_or(|port| name(word) == port)).cloned().collect();
        if let (Some(port), true) = (port, chosen.is_empty()) {
            let names: Vec<String> = outputs.iter().map(name).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let message = format!("the recipe behind {:?} has no output {port:?}", source.text);
            self.faults.push(near(message, source, &names));
            return None;
        }
        let mut wires = Vec::new();
        for word in chosen {
            wires.extend(self.offered(inner, &word)?);
        }
        Some(wires)
    }
}

fn near(message: String, word: &Name, names: &[&str]) -> Diagnostic {
    let fault = Diagnostic::error(message).at(word.span.clone());
    let last = word.text.rsplit('.').next().unwrap_or_default();
    let first = word.text.split('.').next().unwrap_or_default();
    let guess = did_you_mean(last, names.iter().copied())
        .or_else(|| did_you_mean(first, names.iter().copied()));
    match guess {
        Some(guess) => fault.help(format!("did you mean {guess:?}?")),
        None if names.is_empty() => fault.help("there is none"),
        None => fault.help(format!("there is {}", names[..names.len().min(40)].join(", "))),
    }
}

/// The nodes that the recipe's outputs name.
pub(super) fn wanted(flat: &Flattened, recipe: &Recipe, faults: &mut Diagnostics) -> Vec<usize> {
    let mut wanted = Vec::new();
    collect_wanted(flat, 0, faults, &mut wanted);
    if recipe.outputs.is_empty() && !faults.has_errors() {
        faults.push(Diagnostic::error("outputs is empty: the recipe is run for nothing"));
    }
    wanted.sort_unstable();
    wanted.dedup();
    wanted
}

fn collect_wanted(
    flat: &Flattened,
    scope: usize,
    faults: &mut Diagnostics,
    wanted: &mut Vec<usize>,
) {
    let Scope { members, outputs, .. } = &flat.scopes[scope];
    for word in outputs {
        let id = word.text.split('.').next().unwrap_or_default();
        match members.get(id) {
            Some(Member::Node(at)) => wanted.push(*at),
            Some(Member::Recipe(inner)) => collect_wanted(flat, *inner, faults, wanted),
            None => {
                let mut names: Vec<&str> = members.keys().map(String::as_str).collect();
                names.sort_unstable();
                faults.push(near(format!("outputs names {id:?}, which is no node"), word, &names));
            }
        }
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

fn loop_fault(flat: &Flattened, wires: &[Vec<Option<Wire>>], component: &[NodeIndex]) -> Diagnostic {
    let members: Vec<usize> = component.iter().map(|node| node.index()).collect();
    let start = members.iter().copied().min().unwrap_or_default();
    // From each node of the loop one that it reads from lies on the loop too: follow them back.
    let before = |node: usize| {
        wires[node].iter().flatten().map(|wire| wire.node).find(|source| members.contains(source))
    };
    let mut walk = vec![start];
    while let Some(next) = walk.last().copied().and_then(before) {
        if let Some(seen) = walk.iter().position(|node| *node == next) {
            walk.drain(..seen);
            walk.push(next);
            break;
        }
        walk.push(next);
    }
    walk.reverse();
    let names: Vec<&str> = walk.iter().take(12).map(|node| flat.nodes[*node].id.as_str()).collect();
    let message = format!("these nodes wait for each other in a loop: {}", names.join(" -> "));
    flat.nodes[start].fault(message).help("take one of these wires out")
}

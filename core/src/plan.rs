//! What has to be done, and why.

use crate::cache::{Cache, Dependencies, Entry, Key, Parts, input_part};
use crate::cancel::CancelToken;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::files::Origin;
use crate::graph::Graph;
use crate::port::{PortType, Value};
use crate::staging::WrittenFile;
use std::collections::{BTreeMap, VecDeque};
use std::path::Path;
use std::sync::Mutex;

/// What is done about a node.
pub enum Step {
    /// It runs.
    Run,
    /// Its values come from the cache, since a node that runs reads them.
    Load {
        /// What is known of it.
        entry: Entry,
        /// The values, one a port; taken when their turn comes.
        values: Mutex<Vec<Value>>,
    },
    /// What it would make is there already and nobody reads it.
    Keep(Entry),
    /// It has nothing to do, or nobody needs it.
    Rest(String),
}

/// A graph and what is to be done about each of its nodes.
pub struct Plan<'g> {
    /// The graph.
    pub graph: &'g Graph,
    /// What is done about each node; `None` for those that the wanted outputs do not need.
    pub steps: Vec<Option<Step>>,
    pub(crate) depends: Option<Dependencies>,
}

impl<'g> Plan<'g> {
    /// Plans what the recipe's outputs need, or only what the nodes called `only` need. With a
    /// cache, whatever it holds is not made again.
    ///
    /// # Errors
    /// If `only` names no node, or a file cannot be read.
    pub fn new(
        graph: &'g Graph,
        only: &[String],
        out: &Path,
        cache: Option<&dyn Cache>,
        cancel: &CancelToken,
    ) -> Result<Self, Diagnostics> {
        let wanted = wanted(graph, only)?;
        let depends = cache.map(|_| Dependencies::of(graph, cancel)).transpose();
        let depends = depends.map_err(|fault| Diagnostic::error(fault.to_string()))?;
        let mut plan = Self { graph, steps: Vec::new(), depends };
        plan.steps.resize_with(graph.nodes.len(), || None);
        plan.choose(&wanted, out, cache, cancel);
        Ok(plan)
    }

    /// The nodes of the plan, each behind those it reads from.
    pub fn in_order(&self) -> impl DoubleEndedIterator<Item = usize> + '_ {
        self.graph.in_order().filter(|node| self.steps[*node].is_some())
    }

    fn choose(
        &mut self,
        wanted: &[usize],
        out: &Path,
        cache: Option<&dyn Cache>,
        cancel: &CancelToken,
    ) {
        let graph = self.graph;
        let mut read = vec![false; graph.nodes.len()];
        let mut asked = vec![false; graph.nodes.len()];
        let mut reached = vec![false; graph.nodes.len()];
        for node in wanted {
            asked[*node] = true;
            reached[*node] = true;
        }
        for at in graph.in_order().rev() {
            if !reached[at] {
                continue;
            }
            let node = &graph.nodes[at];
            if let Some(why) = node.idle {
                self.steps[at] = Some(Step::Rest(why.to_owned()));
                continue;
            }
            let sources = || node.inputs.iter().flatten().map(|wire| wire.node);
            sources().for_each(|source| reached[source] = true);
            // What writes files does so whenever the work leads past it.
            let is_asked = asked[at] || node.writes_files();
            let entry = self.entry(at, cache).filter(|entry| {
                !is_asked || entry.files.iter().all(|file| self.is_there(file, out, cancel))
            });
            let step = match entry {
                Some(entry) if read[at] => self.loaded(at, entry, cache),
                Some(entry) => Some(Step::Keep(entry)),
                None if read[at] || is_asked => None,
                // All that would read it is there already.
                None => Some(Step::Rest("what it would be needed for is cached".to_owned())),
            };
            let step = step.unwrap_or(Step::Run);
            if matches!(step, Step::Run) {
                sources().for_each(|source| read[source] = true);
            }
            self.steps[at] = Some(step);
        }
    }

    fn key(&self, at: usize) -> Option<&Key> {
        Some(&self.depends.as_ref()?.nodes[at].0)
    }

    fn entry(&self, at: usize, cache: Option<&dyn Cache>) -> Option<Entry> {
        cache?.look(self.key(at)?)
    }

    fn loaded(&self, at: usize, entry: Entry, cache: Option<&dyn Cache>) -> Option<Step> {
        let values = cache?.load(self.key(at)?, &output_types(self.graph, at))?;
        Some(Step::Load { entry, values: Mutex::new(values) })
    }

    /// Whether an output file is as it was written.
    fn is_there(&self, file: &WrittenFile, out: &Path, cancel: &CancelToken) -> bool {
        let found = Origin::Folder(out.to_owned()).locate(&file.name);
        let hash = self.graph.files.hash(&found, cancel);
        hash.is_ok_and(|hash| hash.to_hex().as_str() == file.blake3)
    }

    /// Why the node called `id` runs, or does not, compared with the recipe's last run. Where it is
    /// because of a node that it reads from, that one is explained next.
    ///
    /// # Errors
    /// If there is no such node.
    pub fn explain(&self, id: &str, cache: Option<&dyn Cache>) -> Result<Vec<String>, Diagnostics> {
        let first = self.graph.find(id).ok_or_else(|| unknown_node(self.graph, id))?;
        let last = cache.and_then(|cache| cache.last_run(&self.graph.recipe)).unwrap_or_default();
        let mut lines = Vec::new();
        let mut told = vec![false; self.graph.nodes.len()];
        let mut queue = VecDeque::from([first]);
        while let Some(at) = queue.pop_front() {
            if std::mem::replace(&mut told[at], true) {
                continue;
            }
            lines.push(format!("{} {}", self.graph.nodes[at].id, self.doing(at)));
            if at != first || matches!(self.steps[at], Some(Step::Run)) {
                queue.extend(self.changes(at, &last, &mut lines));
            }
        }
        Ok(lines)
    }

    /// What is done about a node, in words.
    fn doing(&self, at: usize) -> String {
        match &self.steps[at] {
            None => "is not needed for the wanted outputs".to_owned(),
            Some(Step::Rest(why)) => format!("has nothing to do: {why}"),
            Some(Step::Load { .. }) => "is read from the cache".to_owned(),
            Some(Step::Keep(_)) => "is cached and nothing that runs reads it".to_owned(),
            Some(Step::Run) if self.depends.is_none() => {
                "runs: there is no cache (--cache DIR)".to_owned()
            }
            Some(Step::Run) => "runs".to_owned(),
        }
    }

    /// Says what changed about a node since the last run, and gives the nodes it is due to.
    fn changes(
        &self,
        at: usize,
        last: &BTreeMap<String, Parts>,
        lines: &mut Vec<String>,
    ) -> Vec<usize> {
        let Some(depends) = &self.depends else { return Vec::new() };
        let (node, now) = (&self.graph.nodes[at], &depends.nodes[at].1);
        let id = &node.id;
        let Some(before) = last.get(id) else {
            lines.push(format!("{id}: no earlier run with this cache is known"));
            return Vec::new();
        };
        if now == before {
            let why = "its values or files are gone, damaged or were too large";
            lines.push(format!("{id}: nothing changed; {why}"));
        }
        let mut due_to = Vec::new();
        let inputs = &self.graph.kind(node).inputs;
        for (what, state) in now {
            let was = before.get(what).map_or("not there", String::as_str);
            if state == was {
                continue;
            }
            let port = inputs.iter().position(|spec| input_part(spec.name) == *what);
            match port.and_then(|port| node.inputs[port]) {
                Some(wire) => {
                    let source = &self.graph.nodes[wire.node].id;
                    if last.get(source) == Some(&depends.nodes[wire.node].1) {
                        lines.push(format!("{id}: {what} is wired anew, to {source}"));
                    } else {
                        lines.push(format!("{id}: {what} changed, since {source} did"));
                        due_to.push(wire.node);
                    }
                }
                None => lines.push(format!("{id}: {what} was {was}, is {state}")),
            }
        }
        due_to
    }
}

/// The types of a node's outputs.
pub(crate) fn output_types(graph: &Graph, at: usize) -> Vec<&PortType> {
    let outputs = &graph.kind(&graph.nodes[at]).outputs;
    outputs.iter().map(|port| graph.registry.type_of(port)).collect()
}

fn wanted(graph: &Graph, only: &[String]) -> Result<Vec<usize>, Diagnostics> {
    if only.is_empty() {
        return Ok(graph.wanted.clone());
    }
    let mut faults = Diagnostics::default();
    let find = |id: &String| graph.find(id).ok_or_else(|| unknown_node(graph, id));
    let wanted = only.iter().filter_map(|id| find(id).map_err(|fault| faults.extend(fault)).ok());
    let wanted = wanted.collect();
    if faults.has_errors() { Err(faults) } else { Ok(wanted) }
}

fn unknown_node(graph: &Graph, id: &str) -> Diagnostics {
    let mut faults = Diagnostics::default();
    let fault = Diagnostic::error(format!("there is no node {id:?}"));
    faults.push_near(fault, id, graph.nodes.iter().map(|node| node.id.as_str()));
    faults
}

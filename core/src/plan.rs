//! What has to be done, and why.

use crate::cache::{Cache, Entry, Key, Parts, all_parts, input_part};
use crate::cancel::CancelToken;
use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::files::{FileError, InputFile, Origin};
use crate::graph::Graph;
use crate::port::{PortType, Value};
use std::collections::BTreeMap;
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
    pub(crate) keys: Option<Vec<(Key, Parts)>>,
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
        let keys = match cache {
            Some(_) => Some(all_parts(graph, cancel).map_err(unreadable)?),
            None => None,
        };
        let mut plan = Self { graph, steps: Vec::new(), keys };
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
            let step = match (read[at], asked[at]) {
                (true, _) => self.loaded(at, cache),
                (false, true) => self.kept(at, out, cache, cancel),
                // All that would read it is there already.
                (false, false) => Some(match self.entry(at, cache) {
                    Some(entry) => Step::Keep(entry),
                    None => Step::Rest("what it would be needed for is cached".to_owned()),
                }),
            };
            let step = step.unwrap_or(Step::Run);
            if matches!(step, Step::Run) {
                sources().for_each(|source| read[source] = true);
            }
            self.steps[at] = Some(step);
        }
    }

    fn key(&self, at: usize) -> Option<&Key> {
        Some(&self.keys.as_ref()?[at].0)
    }

    fn entry(&self, at: usize, cache: Option<&dyn Cache>) -> Option<Entry> {
        cache?.look(self.key(at)?)
    }

    fn loaded(&self, at: usize, cache: Option<&dyn Cache>) -> Option<Step> {
        let entry = self.entry(at, cache)?;
        let values = cache?.load(self.key(at)?, &output_types(self.graph, at))?;
        Some(Step::Load { entry, values: Mutex::new(values) })
    }

    /// A node that is wanted for itself may stay as it is if its files are as it wrote them.
    fn kept(
        &self,
        at: usize,
        out: &Path,
        cache: Option<&dyn Cache>,
        cancel: &CancelToken,
    ) -> Option<Step> {
        let entry = self.entry(at, cache)?;
        let whole = entry.files.iter().all(|file| {
            let found: InputFile = Origin::Folder(out.to_owned()).locate(&file.name);
            let hash = self.graph.files.hash(&found, cancel);
            hash.is_ok_and(|hash| hash.to_hex().as_str() == file.blake3)
        });
        whole.then_some(Step::Keep(entry))
    }

    /// Why the node called `id` runs, or does not, compared with the recipe's last run.
    ///
    /// # Errors
    /// If there is no such node.
    pub fn explain(&self, id: &str, cache: Option<&dyn Cache>) -> Result<Vec<String>, Diagnostics> {
        let at = self.graph.find(id).ok_or_else(|| unknown_node(self.graph, id))?;
        let last = cache.and_then(|cache| cache.last_run(&self.graph.recipe)).unwrap_or_default();
        let mut lines = Vec::new();
        let mut told = vec![false; self.graph.nodes.len()];
        self.explain_node(at, &last, cache.is_some(), &mut told, &mut lines);
        Ok(lines)
    }

    fn explain_node(
        &self,
        at: usize,
        last: &BTreeMap<String, Parts>,
        has_cache: bool,
        told: &mut [bool],
        lines: &mut Vec<String>,
    ) {
        if std::mem::replace(&mut told[at], true) {
            return;
        }
        let id = &self.graph.nodes[at].id;
        let doing = match &self.steps[at] {
            None => "is not needed for the wanted outputs".to_owned(),
            Some(Step::Rest(why)) => format!("has nothing to do: {why}"),
            Some(Step::Load { .. }) => "is read from the cache".to_owned(),
            Some(Step::Keep(_)) => "is cached and nothing that runs reads it".to_owned(),
            Some(Step::Run) if !has_cache => "runs: there is no cache (--cache DIR)".to_owned(),
            Some(Step::Run) => "runs".to_owned(),
        };
        lines.push(format!("{id} {doing}"));
        let (Some(Step::Run), Some(keys)) = (&self.steps[at], &self.keys) else { return };
        let now = &keys[at].1;
        let Some(before) = last.get(id) else {
            lines.push(format!("{id}: no earlier run with this cache is known"));
            return;
        };
        if now == before {
            lines.push(format!(
                "{id}: nothing changed; its values or files are gone, damaged or were too large"
            ));
        }
        let kind = self.graph.kind(&self.graph.nodes[at]);
        for (what, state) in now {
            let was = before.get(what).map_or("not there", String::as_str);
            if state == was {
                continue;
            }
            let port = kind.inputs.iter().position(|spec| input_part(spec.name) == *what);
            match port.and_then(|port| self.graph.nodes[at].inputs[port]) {
                Some(wire) => {
                    let source = &self.graph.nodes[wire.node].id;
                    lines.push(format!("{id}: {what} changed, since {source} did:"));
                    self.explain_node(wire.node, last, has_cache, told, lines);
                }
                None => lines.push(format!("{id}: {what} was {was}, is {state}")),
            }
        }
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
    let mut wanted = Vec::new();
    for id in only {
        match graph.find(id) {
            Some(node) => wanted.push(node),
            None => unknown_node(graph, id).0.into_iter().for_each(|fault| faults.push(fault)),
        }
    }
    if faults.has_errors() { Err(faults) } else { Ok(wanted) }
}

fn unknown_node(graph: &Graph, id: &str) -> Diagnostics {
    let fault = Diagnostic::error(format!("there is no node {id:?}"));
    let fault = match did_you_mean(id, graph.nodes.iter().map(|node| node.id.as_str())) {
        Some(near) => fault.help(format!("did you mean {near:?}?")),
        None => fault,
    };
    Diagnostics(vec![fault])
}

fn unreadable(fault: FileError) -> Diagnostics {
    Diagnostics(vec![Diagnostic::error(fault.to_string())])
}

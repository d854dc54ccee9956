//! Doing what a plan says.
//!
//! Every node is a task on one rayon pool; kernels spread their loops over the same pool. A task
//! starts when the last node it reads from is done, so no task ever waits for another, and no lock
//! is held while a node runs. A value is dropped when its last reader is done. A node that fails or
//! panics takes only those with it that read from it. Output files are put in place at the end, all
//! together; see [`staging`](crate::staging).

use crate::cache::{Cache, Entry};
use crate::cancel::CancelToken;
use crate::context::{Context, Reads};
use crate::files::{FileError, InputFile};
use crate::graph::GraphNode;
use crate::node_error::NodeError;
use crate::plan::{Plan, Step, output_types};
use crate::port::{InputValues, PortSpec, Value};
use crate::report::{
    NodeReport, NodeStatus, Observer, PortReport, ReadFile, RunReport, RunStatus, peak_rss_mb,
};
use crate::staging::{Staging, Writer, WrittenFile};
use rayon::Scope;
use std::any::Any;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// What the names of the threads begin with that nodes run on.
pub const THREAD_NAME: &str = "carve node";

/// Stack of a thread. A kernel that waits for the rest of its loop takes up another node meanwhile,
/// and that one another: so the frames of several nodes stand on one stack. Only what is used counts.
const STACK_BYTES: usize = 16 << 20;

/// How to run a plan.
#[derive(Clone, Copy)]
pub struct RunOptions<'a> {
    /// Number of threads; 0 takes one a core.
    pub threads: usize,
    /// Where values are kept from one run to the next.
    pub cache: Option<&'a dyn Cache>,
    /// Told what happens.
    pub observer: &'a dyn Observer,
}

/// What a run can be stopped by: from another thread, such as one that hears Ctrl-C.
#[derive(Clone)]
pub struct Session {
    /// Called off by this.
    pub cancel: CancelToken,
    out: PathBuf,
    staging: Arc<Staging>,
}

impl Session {
    /// A run that writes its files into the folder `out`.
    #[must_use]
    pub fn new(out: &Path) -> Self {
        let staging = Arc::new(Staging::new(out.to_owned()));
        Self { cancel: CancelToken::default(), out: out.to_owned(), staging }
    }

    /// The output folder.
    #[must_use]
    pub fn out(&self) -> &Path {
        &self.out
    }

    /// Removes every file of the run that is not in place yet, for a program that is about to exit
    /// without waiting for the run to end.
    pub fn abandon(&self) {
        self.cancel.cancel();
        self.staging.abandon();
    }
}

/// What became of a node.
struct Outcome {
    report: NodeReport,
    /// One value a port until the last reader is done; empty for a node that failed or writes only.
    values: Vec<Value>,
    ended: Ended,
}

#[derive(Clone, Copy, PartialEq)]
enum Ended {
    Well,
    Badly,
    Refused,
    Cancelled,
}

/// Why a node did not finish.
#[derive(Debug, thiserror::Error)]
enum Stop {
    #[error("nothing came from {0:?}, which it reads")]
    Lacks(String),
    #[error(transparent)]
    Fault(NodeError),
}

impl Stop {
    /// The parameter that is to blame.
    fn param(&self) -> Option<&'static str> {
        match self {
            Self::Fault(NodeError::Refused { param, .. }) => Some(param),
            _ => None,
        }
    }

    fn end(&self) -> (NodeStatus, Ended) {
        match self {
            Self::Lacks(_) => (NodeStatus::Skipped, Ended::Badly),
            Self::Fault(NodeError::Cancelled | NodeError::File(FileError::Cancelled)) => {
                (NodeStatus::Skipped, Ended::Cancelled)
            }
            Self::Fault(NodeError::Refused { .. }) => (NodeStatus::Failed, Ended::Refused),
            Self::Fault(_) => (NodeStatus::Failed, Ended::Badly),
        }
    }
}

/// One node's state during a run.
#[derive(Default)]
struct Slot {
    /// Nodes it reads from that are not done.
    waits_for: AtomicUsize,
    /// Nodes that read from it and are not done.
    readers: AtomicUsize,
    outcome: Mutex<Option<Outcome>>,
}

struct Runner<'a> {
    plan: &'a Plan<'a>,
    options: RunOptions<'a>,
    session: &'a Session,
    slots: Vec<Slot>,
    /// The nodes that read from each node and have a turn.
    readers: Vec<Vec<usize>>,
    read: Reads,
}

/// Runs a plan. It always comes back with a report, whatever fails.
#[must_use]
pub fn run(plan: &Plan<'_>, session: &Session, options: RunOptions<'_>) -> RunReport {
    let started = Instant::now();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .thread_name(|index| format!("{THREAD_NAME} {index}"))
        .stack_size(STACK_BYTES)
        .build();
    let runner = Runner::new(plan, session, options);
    runner.claim_names();
    let mut threads = 1;
    let mut trouble = None;
    match pool {
        Ok(pool) => {
            threads = pool.current_num_threads();
            // Chosen before the first one begins: those it makes ready are spawned by it.
            let ready: Vec<usize> = runner.turns().filter(|at| runner.is_ready(*at)).collect();
            pool.in_place_scope(|scope| ready.iter().for_each(|at| runner.spawn(scope, *at)));
        }
        Err(fault) => trouble = Some(format!("cannot start {} threads: {fault}", options.threads)),
    }
    runner.report(started, threads, trouble)
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<'a> Runner<'a> {
    fn new(plan: &'a Plan<'a>, session: &'a Session, options: RunOptions<'a>) -> Self {
        let count = plan.graph.nodes.len();
        let mut slots = Vec::new();
        slots.resize_with(count, Slot::default);
        let readers = vec![Vec::new(); count];
        let runner = Self { plan, options, session, slots, readers, read: Reads::default() };
        runner.with_readers()
    }

    /// Notes who reads from whom.
    fn with_readers(mut self) -> Self {
        for at in 0..self.slots.len() {
            if !matches!(self.plan.steps[at], Some(Step::Run)) {
                continue;
            }
            let sources = self.sources(at);
            for source in &sources {
                self.readers[*source].push(at);
            }
            *self.slots[at].waits_for.get_mut() = sources.len();
        }
        for at in 0..self.slots.len() {
            *self.slots[at].readers.get_mut() = self.readers[at].len();
        }
        self
    }

    /// Takes the names of all files that are there already and keeps the inputs from being replaced.
    fn claim_names(&self) {
        let inputs = self.plan.graph.nodes.iter().flat_map(GraphNode::files);
        self.session.staging.protect(inputs.filter_map(InputFile::canonical));
        for (at, entry) in self.found() {
            for file in &entry.files {
                // Two such nodes with one name cannot be: they would not both have finished.
                let _ = self.session.staging.take_name(&file.name, &self.writer(at));
            }
        }
    }

    /// The nodes that need not run, and what is known of them.
    fn found(&self) -> impl Iterator<Item = (usize, &'a Entry)> {
        self.plan.steps.iter().enumerate().filter_map(|(at, step)| match step {
            Some(Step::Keep(entry) | Step::Load { entry, .. }) => Some((at, entry)),
            _ => None,
        })
    }

    fn writer(&self, at: usize) -> Writer {
        Writer { node: at, id: self.plan.graph.nodes[at].id.clone() }
    }

    /// The nodes that a node reads from, each once.
    fn sources(&self, at: usize) -> Vec<usize> {
        let inputs = self.plan.graph.nodes[at].inputs.iter().flatten();
        let mut sources: Vec<usize> = inputs.map(|wire| wire.node).collect();
        sources.sort_unstable();
        sources.dedup();
        sources
    }

    /// The nodes that have a turn: those that run and those whose values are loaded.
    fn turns(&self) -> impl Iterator<Item = usize> {
        let turn = |at: &usize| matches!(self.plan.steps[*at], Some(Step::Run | Step::Load { .. }));
        self.plan.in_order().filter(turn)
    }

    fn is_ready(&self, at: usize) -> bool {
        self.slots[at].waits_for.load(Ordering::Acquire) == 0
    }

    fn spawn<'s>(&'s self, scope: &Scope<'s>, at: usize) {
        scope.spawn(move |scope| {
            self.take_turn(at);
            for reader in &self.readers[at] {
                if self.slots[*reader].waits_for.fetch_sub(1, Ordering::AcqRel) == 1 {
                    self.spawn(scope, *reader);
                }
            }
        });
    }

    fn take_turn(&self, at: usize) {
        let id = &self.plan.graph.nodes[at].id;
        self.options.observer.started(id);
        let mut outcome = match &self.plan.steps[at] {
            Some(Step::Load { entry, values }) => Outcome {
                report: self.cached(at, entry),
                values: std::mem::take(&mut *lock(values)),
                ended: Ended::Well,
            },
            _ => self.run_node(at),
        };
        if outcome.ended == Ended::Refused {
            self.session.cancel.cancel();
        }
        if self.readers[at].is_empty() {
            outcome.values.clear();
        }
        self.options.observer.finished(id, &outcome.report);
        *lock(&self.slots[at].outcome) = Some(outcome);
        // One whose values were loaded reads from nobody.
        if matches!(self.plan.steps[at], Some(Step::Run)) {
            self.sources(at).into_iter().for_each(|source| self.let_go(source));
        }
    }

    /// Drops a node's values if this was its last reader.
    fn let_go(&self, source: usize) {
        if self.slots[source].readers.fetch_sub(1, Ordering::AcqRel) == 1
            && let Some(outcome) = &mut *lock(&self.slots[source].outcome)
        {
            outcome.values.clear();
        }
    }

    fn cached(&self, at: usize, entry: &Entry) -> NodeReport {
        NodeReport {
            kind: self.plan.graph.kind(&self.plan.graph.nodes[at]).name,
            status: NodeStatus::Cached,
            wall_s: 0.0,
            outputs: entry.outputs.clone(),
            notes: entry.notes.clone(),
            reason: None,
            place: None,
            starved: false,
        }
    }

    fn run_node(&self, at: usize) -> Outcome {
        let started = Instant::now();
        let context = self.context(at);
        // A node owns nothing that outlives it: what a panic leaves behind is dropped with it.
        let result = self.inputs(at).and_then(|inputs| {
            let node = &self.plan.graph.nodes[at].node;
            let work = || {
                let values = node.run(&inputs, &context)?;
                self.check_outputs(at, &values)?;
                let outputs = self.facts(at, &values);
                Ok((values, outputs))
            };
            catch_unwind(AssertUnwindSafe(work))
                .unwrap_or_else(|panic| Err(NodeError::Failed(panic_message(&*panic))))
                .map_err(Stop::Fault)
        });
        let mut report = NodeReport {
            kind: self.plan.graph.kind(&self.plan.graph.nodes[at]).name,
            status: NodeStatus::Ran,
            wall_s: started.elapsed().as_secs_f64(),
            outputs: BTreeMap::new(),
            notes: context.notes.into_inner().unwrap_or_else(PoisonError::into_inner),
            reason: None,
            place: None,
            starved: false,
        };
        let mut ended = Ended::Well;
        let mut values = Vec::new();
        match result {
            Ok((made, outputs)) => {
                (values, report.outputs) = (made, outputs);
                self.keep(at, &report, &values);
            }
            Err(stop) => {
                (report.status, ended) = stop.end();
                report.starved = matches!(stop, Stop::Lacks(_));
                report.place = stop
                    .param()
                    .and_then(|param| self.plan.graph.nodes[at].places.get(param).cloned());
                report.reason = Some(stop.to_string());
            }
        }
        Outcome { report, values, ended }
    }

    /// Whether a node gave what its kind promises: one whose work is a function may not.
    fn check_outputs(&self, at: usize, values: &[Value]) -> Result<(), NodeError> {
        let kind = self.plan.graph.kind(&self.plan.graph.nodes[at]);
        let is_promised = |(port, value): (&PortSpec, &Value)| (**value).type_id() == port.type_id;
        if values.len() == kind.outputs.len() && kind.outputs.iter().zip(values).all(is_promised) {
            return Ok(());
        }
        let origin = kind.origin.as_deref().unwrap_or("the program");
        Err(NodeError::failed(format!(
            "it gave other outputs than its definition promises: a fault of {origin}"
        )))
    }

    fn context(&self, at: usize) -> Context<'_> {
        let node = &self.plan.graph.nodes[at];
        Context {
            index: at,
            node: &node.id,
            prefix: &node.prefix,
            uses_prefix: self.plan.graph.kind(node).uses_prefix,
            files: self.plan.graph.files,
            hashes: self.plan.depends.as_ref().map(|depends| &depends.files),
            staging: &self.session.staging,
            catalogs: self.plan.graph.catalogs(),
            cancel: &self.session.cancel,
            observer: self.options.observer,
            notes: Mutex::default(),
            read: &self.read,
        }
    }

    /// The values at a node's inputs, or why it cannot be run.
    fn inputs(&self, at: usize) -> Result<InputValues, Stop> {
        if self.session.cancel.is_cancelled() {
            return Err(Stop::Fault(NodeError::Cancelled));
        }
        let node = &self.plan.graph.nodes[at];
        let specs = &self.plan.graph.kind(node).inputs;
        let mut inputs = InputValues::default();
        for (spec, wire) in specs.iter().zip(&node.inputs) {
            let Some(wire) = wire else { continue };
            let outcome = lock(&self.slots[wire.node].outcome);
            match outcome.as_ref().and_then(|outcome| outcome.values.get(wire.port)) {
                Some(value) => inputs.insert(spec.name, Arc::clone(value)),
                None => return Err(Stop::Lacks(self.plan.graph.nodes[wire.node].id.clone())),
            }
        }
        Ok(inputs)
    }

    fn facts(&self, at: usize, values: &[Value]) -> BTreeMap<String, PortReport> {
        let ports = &self.plan.graph.kind(&self.plan.graph.nodes[at]).outputs;
        let types = output_types(self.plan.graph, at);
        let report =
            |((port, port_type), value): ((&crate::PortSpec, &&crate::PortType), &Value)| {
                let facts = port_type.facts(value).into_iter();
                let facts = facts.map(|(name, fact)| (name.to_owned(), fact)).collect();
                (port.name.to_owned(), PortReport { type_name: port_type.name.to_owned(), facts })
            };
        ports.iter().zip(&types).zip(values).map(report).collect()
    }

    /// Puts what a node made into the cache.
    fn keep(&self, at: usize, report: &NodeReport, values: &[Value]) {
        let (Some(cache), Some(depends)) = (self.options.cache, &self.plan.depends) else { return };
        let (key, parts) = &depends.nodes[at];
        let entry = Entry {
            parts: parts.clone(),
            wall_s: report.wall_s,
            outputs: report.outputs.clone(),
            notes: report.notes.clone(),
            files: self.session.staging.written_by(at),
        };
        let types = output_types(self.plan.graph, at);
        let values: Vec<_> = types.into_iter().zip(values.iter().cloned()).collect();
        cache.store(key, entry, &values);
    }

    /// What is told of a node that had no turn.
    fn rested(&self, at: usize) -> NodeReport {
        let report = |status, reason| NodeReport {
            kind: self.plan.graph.kind(&self.plan.graph.nodes[at]).name,
            status,
            wall_s: 0.0,
            outputs: BTreeMap::new(),
            notes: Vec::new(),
            reason: Some(reason),
            place: None,
            starved: false,
        };
        match &self.plan.steps[at] {
            Some(Step::Keep(entry)) => self.cached(at, entry),
            Some(Step::Rest(why)) => report(NodeStatus::Skipped, why.clone()),
            Some(_) => report(NodeStatus::Skipped, "it was not begun".to_owned()),
            None => report(NodeStatus::Skipped, "no output needs it".to_owned()),
        }
    }

    fn report(self, started: Instant, threads: usize, mut trouble: Option<String>) -> RunReport {
        let graph = self.plan.graph;
        let mut ends = Vec::new();
        let mut nodes = BTreeMap::new();
        // Those whose files and values count.
        let mut finished = Vec::with_capacity(graph.nodes.len());
        for (at, node) in graph.nodes.iter().enumerate() {
            let (mut report, mut ended) = match lock(&self.slots[at].outcome).take() {
                Some(outcome) => (outcome.report, outcome.ended),
                None => (self.rested(at), Ended::Well),
            };
            if let Some(fault) = self.session.staging.ousted(at) {
                (report.status, report.reason) = (NodeStatus::Failed, Some(fault.to_string()));
                report.outputs.clear();
                ended = Ended::Badly;
            }
            finished.push(ended == Ended::Well && report.status != NodeStatus::Skipped);
            ends.push(ended);
            nodes.insert(node.id.clone(), report);
        }
        let mut status = if ends.contains(&Ended::Refused) {
            RunStatus::Refused
        } else if self.session.cancel.is_cancelled() {
            RunStatus::Interrupted
        } else if ends.contains(&Ended::Badly) || trouble.is_some() {
            RunStatus::Failed
        } else {
            RunStatus::Done
        };
        let mut written = Vec::new();
        if matches!(status, RunStatus::Done | RunStatus::Failed) {
            match self.session.staging.publish(|at| finished[at]) {
                None => status = RunStatus::Interrupted,
                Some(published) => {
                    written = self.files(published.files, &finished);
                    if let Some(fault) = published.fault {
                        status = RunStatus::Failed;
                        trouble = Some(fault.to_string());
                    }
                }
            }
        } else {
            self.session.staging.abandon();
        }
        self.remember(&finished);
        let read = self.files_read();
        let path = |name: &str| self.session.out.join(name).display().to_string();
        let files = written.iter().map(|(_, file)| path(&file.name)).collect();
        let wall_s = started.elapsed().as_secs_f64();
        let recipe = graph.recipe.clone();
        RunReport {
            recipe,
            status,
            wall_s,
            peak_rss_mb: peak_rss_mb(),
            threads,
            files,
            written,
            read,
            nodes,
            trouble,
        }
    }

    /// All output files and the nodes that wrote them, those that were there already included, in the
    /// nodes' order.
    fn files(
        &self,
        published: Vec<(usize, WrittenFile)>,
        finished: &[bool],
    ) -> Vec<(String, WrittenFile)> {
        let found = self.found().filter(|(at, _)| finished[*at]);
        let found =
            found.flat_map(|(at, entry)| entry.files.iter().map(move |file| (at, file.clone())));
        let mut files: Vec<_> = published.into_iter().chain(found).collect();
        files.sort_by(|a, b| (a.0, &a.1.name).cmp(&(b.0, &b.1.name)));
        let by_id = |(at, file): (usize, _)| (self.plan.graph.nodes[at].id.clone(), file);
        files.into_iter().map(by_id).collect()
    }

    /// The files that nodes have read, and those whose contents stand for what was cached.
    fn files_read(&self) -> Vec<ReadFile> {
        let mut read = std::mem::take(&mut *lock(&self.read));
        let graph = self.plan.graph;
        for file in self.found().flat_map(|(at, _)| graph.nodes[at].files()) {
            let hash = self.plan.depends.as_ref().and_then(|depends| depends.files.get(file));
            // One that is gone since then is not told of.
            if let (Some(hash), Ok(bytes)) = (hash, graph.files.bytes(file)) {
                let (path, blake3) = (file.to_string(), hash.to_hex().to_string());
                read.entry(path.clone()).or_insert(ReadFile { path, bytes, blake3 });
            }
        }
        read.into_values().collect()
    }

    /// Notes what the nodes that finished depended on; of the others stays what was noted before.
    fn remember(&self, finished: &[bool]) {
        let (Some(cache), Some(depends)) = (self.options.cache, &self.plan.depends) else { return };
        let graph = self.plan.graph;
        let mut last = cache.last_run(&graph.recipe).unwrap_or_default();
        let noted = graph.nodes.iter().enumerate().filter_map(|(at, node)| {
            let known = finished[at].then(|| depends.nodes[at].1.clone());
            Some((node.id.clone(), known.or_else(|| last.remove(&node.id))?))
        });
        let noted = noted.collect();
        cache.remember_run(&graph.recipe, &noted);
    }
}

fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".to_owned());
    format!("this node has a fault of its own and broke off ({text}); please report it")
}

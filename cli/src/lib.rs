//! The `carve` command as a library, so that tests can build it too.
//!
//! Results go to standard output; progress, notes and errors to standard error. The exit status is
//! 0 when done, 1 when a node failed, 2 when the recipe or the call is wrong, 130 when interrupted.

mod arguments;
mod list;
mod offers;
mod plugins;
mod progress;
mod report;
mod run;

use arguments::{Arguments, Command, DialectAction, Job, PluginAction};
use carvegraph_core::{Diagnostics, DiskCache, Graph, Origin, Recipe, Registry, Setting};
use carvegraph_nodes::LIBRARY;
use clap::{CommandFactory, Parser};
use offers::Brought;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// How a command ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Exit {
    Done = 0,
    /// Or a plugin is at fault.
    NodeFailed = 1,
    Wrong = 2,
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Why a command could not be begun: told to the user, exit status 2.
#[derive(Debug)]
struct Refusal(String);

impl From<Diagnostics> for Refusal {
    fn from(faults: Diagnostics) -> Self {
        Self(faults.to_string())
    }
}

/// Runs the command that the process was called with.
#[must_use]
pub fn main() -> ExitCode {
    hush_node_panics();
    let Arguments { command, plugins } = Arguments::parse();
    let exit = obey(command, &plugins).unwrap_or_else(|Refusal(message)| {
        complain(message.trim_end());
        Exit::Wrong
    });
    exit.into()
}

fn obey(command: Command, given: &[PathBuf]) -> Result<Exit, Refusal> {
    let registry = || full_registry(given, false);
    match command {
        Command::Run(arguments) => {
            let registry = full_registry(given, arguments.quiet)?;
            return run::run(&arguments, &registry);
        }
        Command::Check { job } => {
            let registry = registry()?;
            let (_, graph) = build(&job, &registry)?;
            say(&format!("{}: {} nodes, nothing wrong\n", job.recipe, graph.nodes.len()));
        }
        Command::Plan { job, only, out, cache, explain } => {
            let registry = registry()?;
            let (_, graph) = build(&job, &registry)?;
            let cache = cache.map(|folder| open_cache(&folder)).transpose()?;
            say(&list::plan(&graph, &only, &out, cache.as_ref(), explain.as_deref())?);
        }
        Command::Nodes { kind: None, json: false } => say(&list::nodes(&registry()?)),
        Command::Nodes { kind, json } => say(&list::node(&registry()?, kind.as_deref(), json)?),
        Command::Cutters => say(&list::cutters(&registry()?)),
        Command::Dialects { action: None } => say(&list::dialects(&registry()?)),
        Command::Dialects { action: Some(DialectAction::New { name, from }) } => {
            say(&plugins::new_dialect(&name, &from, &plugins::folder_to_write(given)?)?);
        }
        Command::Machines => say(&list::machines(&registry()?)),
        Command::Tools => say(&list::tools(&registry()?)),
        Command::Plugins { action } => return manage(action, given),
        Command::Graphs { name: None, .. } => say(&list::graphs()?),
        Command::Graphs { name: Some(name), text } => {
            say(&list::graph(&registry()?, &name, text)?);
        }
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "carve", &mut script);
            say(&String::from_utf8_lossy(&script));
        }
    }
    Ok(Exit::Done)
}

/// `carve plugins`.
fn manage(action: Option<PluginAction>, given: &[PathBuf]) -> Result<Exit, Refusal> {
    let folders = || plugins::folders(given);
    match action {
        None => say(&plugins::list(&plugins::found(&folders()?), &folders()?)),
        Some(PluginAction::Doctor) => {
            let brought = Brought::load(plugins::found(&folders()?));
            say(&plugins::doctor(&brought, &folders()?));
            return Ok(if brought.faults.is_empty() { Exit::Done } else { Exit::NodeFailed });
        }
        Some(PluginAction::Install { file, id }) => {
            say(&plugins::install(&file, id.as_deref(), &plugins::folder_to_write(given)?)?);
        }
        Some(PluginAction::Probe { library }) => say(&plugins::examine_here(&library)?),
    }
    Ok(Exit::Done)
}

/// All that recipes can use. What cannot be used is told, and no harm to a recipe that does not need it.
fn full_registry(given: &[PathBuf], quiet: bool) -> Result<Registry, Refusal> {
    let brought = Brought::load(plugins::found(&plugins::folders(given)?));
    if !quiet {
        warn(&brought);
    }
    brought.registry().map_err(|fault| Refusal(format!("error: {fault}")))
}

/// Tells what is left out.
fn warn(brought: &Brought) {
    for fault in &brought.faults {
        let first = plugins::without_error(&fault.why).lines().next().unwrap_or_default();
        complain(&format!("warning: {} is left out: {first}", fault.path.display()));
    }
    if !brought.faults.is_empty() {
        complain("  = help: carve plugins doctor tells more");
    }
}

/// Opens and checks the recipe of a job.
fn build(job: &Job, registry: &Registry) -> Result<(Recipe, Graph), Refusal> {
    let here = || Origin::Folder(PathBuf::new());
    let recipe = LIBRARY.open(&job.recipe, &here())?;
    let setting = |(name, value): &(String, String)| Setting {
        name: name.clone(),
        value: value.clone(),
        origin: here(),
    };
    let settings: Vec<Setting> = job.set.iter().map(setting).collect();
    let graph = Graph::build(&recipe, &settings, registry, &LIBRARY)?;
    Ok((recipe, graph))
}

fn open_cache(folder: &Path) -> Result<DiskCache, Refusal> {
    DiskCache::open(folder, DiskCache::DEFAULT_MAX_BYTES)
        .map_err(|fault| Refusal(format!("error: {fault}")))
}

/// Writes to standard output. A reader that has had enough (`carve nodes | head`) is no fault.
fn say(text: &str) {
    let mut out = io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Writes a line to standard error; there is nowhere else to go if that fails.
fn complain(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// A node that panics is reported like any other failure, so the usual message is not wanted,
/// unless somebody asks for it with `RUST_BACKTRACE`.
fn hush_node_panics() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let thread = std::thread::current();
        let in_node =
            thread.name().is_some_and(|name| name.starts_with(carvegraph_core::THREAD_NAME));
        if !in_node || std::env::var_os("RUST_BACKTRACE").is_some() {
            usual(panic);
        }
    }));
}

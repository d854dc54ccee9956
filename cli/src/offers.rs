//! All that recipes can choose from: what is linked, and what the plugin folders bring.
//!
//! What cannot be used is left out and told; a recipe that needs it is told why.

use carvegraph_core::source::Source;
use carvegraph_core::{Diagnostic, Diagnostics, Missing, Registry};
use carvegraph_dialects::{DialectFile, from_file};
use carvegraph_host::{Candidate, Discovered, Fault, Plugin, linked};
use carvegraph_nodes::{Batch, Machine, Offers, Tools, registry};
use carvegraph_sdk::export::{Entry, entry};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::{slice, thread};

/// What a `.ron` file of a plugin folder is, by the name before its first bracket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sort {
    Dialect,
    Machine,
    Tools,
}

impl Sort {
    const ALL: [(&str, Self); 3] =
        [("Dialect(", Self::Dialect), ("Machine(", Self::Machine), ("Tools(", Self::Tools)];

    /// The sort of a file. Its first line that is no comment says it, also in a file with faults, which
    /// whoever reads it tells.
    pub(crate) fn of(file: &Source) -> Option<Self> {
        let lines = file.text().lines().map(str::trim_start);
        let first = lines.into_iter().find(|line| !(line.is_empty() || line.starts_with("//")))?;
        Self::ALL.into_iter().find(|(name, _)| first.starts_with(name)).map(|(_, sort)| sort)
    }

    /// What it is called in lists.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Dialect => "dialect",
            Self::Machine => "machine",
            Self::Tools => "tools",
        }
    }
}

/// What there is, and what cannot be used.
#[derive(Default)]
pub(crate) struct Brought {
    pub(crate) offers: Offers,
    /// What can be used, a line each.
    pub(crate) good: Vec<String>,
    pub(crate) faults: Vec<Fault>,
}

impl Brought {
    /// Loads all that was found.
    pub(crate) fn load(found: Discovered) -> Self {
        let mut brought = Self { faults: found.faults, ..Self::default() };
        brought.linked();
        for (candidate, loaded) in tried(&found.plugins) {
            brought.plugin(candidate, loaded);
        }
        brought.files(&found.files);
        brought
    }

    /// The standard plugins.
    fn linked(&mut self) {
        static CUTTERS: Entry = entry::<carvegraph_cutters::Standard>();
        static DIALECTS: Entry = entry::<carvegraph_dialects::Standard>();
        let ours = concat!("carve ", env!("CARGO_PKG_VERSION"));
        for plugin in [&CUTTERS, &DIALECTS] {
            let added = linked(plugin).map_err(|fault| fault.to_string());
            let added = added.and_then(|plugin| self.add(plugin, ours));
            if let Err(why) = added {
                self.faults.push(Fault { path: PathBuf::from(ours), why });
            }
        }
    }

    fn add(&mut self, plugin: Plugin, origin: &str) -> Result<(), String> {
        let Plugin { cutters, dialects, nodes, .. } = plugin;
        let batch = Batch { cutters, dialects, nodes, ..Batch::default() };
        self.offers.add(batch, origin).map_err(|fault| fault.to_string())
    }

    fn plugin(&mut self, candidate: &Candidate, loaded: Result<Plugin, String>) {
        let id = &candidate.manifest.id;
        let added = loaded.and_then(|plugin| {
            let version = candidate.fingerprint().map_err(|fault| fault.to_string())?;
            self.add(plugin, &format!("plugin {id} {version}"))
        });
        match added {
            Ok(()) => self.good.push(format!("{id}: {}", candidate.folder.display())),
            Err(why) => {
                for (sort, names) in candidate.manifest.offered.sorts() {
                    names
                        .iter()
                        .for_each(|name| self.miss(sort, name, &format!("plugin {id:?}"), &why));
                }
                self.faults.push(Fault { path: candidate.folder.clone(), why });
            }
        }
    }

    /// A name that a recipe may ask for in vain.
    fn miss(&mut self, sort: &'static str, name: &str, who: &str, why: &str) {
        let first = why.lines().next().unwrap_or_default();
        self.offers.miss(
            sort,
            Missing {
                name: name.to_owned(),
                why: format!("{who} offers it but cannot be used: {first}"),
                help: "carve plugins doctor tells more".to_owned(),
            },
        );
    }

    fn files(&mut self, files: &[Arc<Source>]) {
        let dialects: Vec<DialectFile> = files
            .iter()
            .filter(|file| Sort::of(file) == Some(Sort::Dialect))
            .map(dialect_file)
            .collect();
        // Dialects first: machines name them.
        for file in &dialects {
            let batch = self.dialect(file, &dialects);
            // It may build on any other.
            self.file(&file.source, batch, files);
        }
        for file in files {
            let batch = match Sort::of(file) {
                Some(Sort::Dialect) => continue,
                Some(Sort::Machine) => Machine::read(file)
                    .map(|(_, machine)| Batch { machines: vec![machine], ..Batch::default() }),
                Some(Sort::Tools) => {
                    Tools::read(file).map(|(_, tools)| Batch { tools, ..Batch::default() })
                }
                None => {
                    let why = "it begins with none of Dialect(, Machine( and Tools(";
                    Err(Diagnostic::error(why).into())
                }
            };
            self.file(file, batch.map_err(|faults| faults.to_string()), slice::from_ref(file));
        }
    }

    /// Adds what a file brings, which changes with `texts`.
    fn file(&mut self, file: &Source, batch: Result<Batch, String>, texts: &[Arc<Source>]) {
        let mut hasher = blake3::Hasher::new();
        for text in texts {
            hasher.update(text.text().as_bytes());
        }
        let origin = format!("file {} {}", file.name(), &hasher.finalize().to_hex()[..16]);
        let added = batch
            .and_then(|batch| self.offers.add(batch, &origin).map_err(|fault| fault.to_string()));
        match added {
            Ok(()) => self.good.push(file.name().to_owned()),
            Err(why) => self.faults.push(Fault { path: PathBuf::from(file.name()), why }),
        }
    }

    fn dialect(&mut self, file: &DialectFile, all: &[DialectFile]) -> Result<Batch, String> {
        match from_file(file, all) {
            Ok(dialect) => Ok(Batch { dialects: vec![dialect], ..Batch::default() }),
            Err(faults) => {
                let why = faults.to_string();
                let who = format!("the file {}", file.source.name());
                self.miss("dialect", &file.name(), &who, &first_message(&faults));
                Err(why)
            }
        }
    }

    /// The registry of all this.
    pub(crate) fn registry(self) -> Result<Registry, String> {
        registry(self.offers).map_err(|fault| fault.to_string())
    }
}

fn first_message(faults: &Diagnostics) -> String {
    match faults.0.first() {
        Some(Diagnostic { message, help: Some(help), .. }) => format!("{message}: {help}"),
        Some(Diagnostic { message, .. }) => message.clone(),
        None => String::new(),
    }
}

fn dialect_file(file: &Arc<Source>) -> DialectFile {
    let stem = Path::new(file.name()).file_stem().unwrap_or_default();
    DialectFile { stem: stem.to_string_lossy().into_owned(), source: Arc::clone(file) }
}

/// Loads all plugins, each tried by a process of its own first; all of these at once.
fn tried(plugins: &[Candidate]) -> Vec<(&Candidate, Result<Plugin, String>)> {
    let load = |candidate: &Candidate| candidate.load(child(&candidate.library)?);
    thread::scope(|scope| {
        let running: Vec<_> = plugins
            .iter()
            .map(|candidate| (candidate, scope.spawn(move || load(candidate))))
            .collect();
        let done = |(candidate, thread): (_, thread::ScopedJoinHandle<'_, _>)| {
            let panicked = |_| Err("loading it panicked".to_owned());
            (candidate, thread.join().unwrap_or_else(panicked))
        };
        running.into_iter().map(done).collect()
    })
}

/// This program again, about to try a library.
pub(crate) fn child(library: &Path) -> Result<Command, String> {
    let program =
        std::env::current_exe().map_err(|fault| format!("it cannot be tried: {fault}"))?;
    let mut child = Command::new(program);
    child.args(["plugins", "probe"]).arg(library);
    Ok(child)
}

//! Values kept from one run to the next.
//!
//! The key of a value is the hash of all that it depends on: kind and version of its node, the
//! parameters, the contents of the files it reads, the versions of the catalog entries it names,
//! and the keys of its inputs. The parts are kept beside the value, so that it can be told why a
//! node ran again.

mod disk;
mod memory;

pub use disk::DiskCache;
pub use memory::MemoryCache;

use crate::cancel::CancelToken;
use crate::context::Note;
use crate::files::FileError;
use crate::graph::Graph;
use crate::param::{ParamKind, ParamValue};
use crate::port::{PortType, Value};
use crate::report::PortReport;
use crate::staging::WrittenFile;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;

/// Why the cache could not keep or find something. A run goes on without it.
#[derive(Debug, thiserror::Error)]
pub enum CacheError {
    /// A value does not fit its encoding.
    #[error("a value cannot be encoded or decoded: {0}")]
    Encode(#[source] postcard::Error),
    /// A value is not of the type that its port says.
    #[error("a value is not of type {0}")]
    WrongType(&'static str),
    /// The folder cannot be made or read.
    #[error("cannot use the cache folder {folder}: {source}")]
    Folder {
        /// Its path.
        folder: String,
        /// What the system says.
        source: io::Error,
    },
}

/// All that a value depends on: what, and its state.
pub type Parts = BTreeMap<String, String>;

/// The name of a cached value.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Key(String);

impl Key {
    fn of(parts: &Parts) -> Self {
        let mut hasher = blake3::Hasher::new();
        for text in parts.iter().flat_map(|(what, state)| [what, state]) {
            hasher.update(&(text.len() as u64).to_le_bytes());
            hasher.update(text.as_bytes());
        }
        Self(hasher.finalize().to_hex().to_string())
    }

    /// The key as hexadecimal digits.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// What is known of a cached node besides its values.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Entry {
    /// What the values depend on.
    pub parts: Parts,
    /// How long the node took, in seconds.
    pub wall_s: f64,
    /// Its outputs' types and facts by port.
    pub outputs: BTreeMap<String, PortReport>,
    /// What it had to say.
    pub notes: Vec<Note>,
    /// The files it wrote.
    pub files: Vec<WrittenFile>,
}

/// A place that keeps values. Losing one is never an error: the node runs again.
pub trait Cache: Send + Sync {
    /// What is known of a node's values.
    fn look(&self, key: &Key) -> Option<Entry>;
    /// The values themselves, one a port, if they are there and whole.
    fn load(&self, key: &Key, types: &[&PortType]) -> Option<Vec<Value>>;
    /// Keeps the values of a node.
    fn store(&self, key: &Key, entry: Entry, values: &[(&PortType, Value)]);
    /// What each node of the recipe depended on when it was last run.
    fn last_run(&self, recipe: &str) -> Option<BTreeMap<String, Parts>>;
    /// Keeps that for the next time.
    fn remember_run(&self, recipe: &str, nodes: &BTreeMap<String, Parts>);
}

/// The part that an input port contributes.
pub(crate) fn input_part(port: &str) -> String {
    format!("input {port}")
}

/// What each node depends on, by node number. A file that is read by several nodes is hashed once.
///
/// # Errors
/// If a file cannot be read.
pub(crate) fn all_parts(
    graph: &Graph,
    cancel: &CancelToken,
) -> Result<Vec<(Key, Parts)>, FileError> {
    let mut hashes: Vec<(&crate::files::InputFile, String)> = Vec::new();
    let mut all: Vec<Option<(Key, Parts)>> = vec![None; graph.nodes.len()];
    for at in graph.in_order() {
        let node = &graph.nodes[at];
        let kind = graph.kind(node);
        let mut parts = Parts::new();
        parts.insert("node kind".into(), format!("{} version {}", kind.name, kind.version));
        parts.insert("program".into(), env!("CARGO_PKG_VERSION").into());
        for (name, value) in node.values.iter() {
            let state = match value {
                ParamValue::File(file) => match hashes.iter().find(|(known, _)| *known == file) {
                    Some((_, hash)) => hash.clone(),
                    None => {
                        let hash = graph.files.hash(file, cancel)?.to_hex().to_string();
                        hashes.push((file, hash.clone()));
                        hash
                    }
                },
                other => other.to_string(),
            };
            let what = if matches!(value, ParamValue::File(_)) { "contents of" } else { "parameter" };
            parts.insert(format!("{what} {name}"), state);
            if let Some(ParamKind::Catalog(catalog)) = kind.param(name).map(|spec| &spec.kind) {
                let version = graph.catalogs().version(catalog, value.text()).unwrap_or_default();
                parts.insert(format!("version of {catalog} {}", value.text()), version.into());
            }
        }
        if node.writes_files() {
            parts.insert("name of the output".into(), node.prefix.clone());
        }
        for (spec, wire) in kind.inputs.iter().zip(&node.inputs) {
            let state = wire.and_then(|wire| {
                let (key, _) = all[wire.node].as_ref()?;
                Some(format!("{} output {}", key.as_str(), wire.port))
            });
            parts.insert(input_part(spec.name), state.unwrap_or_else(|| "open".into()));
        }
        all[at] = Some((Key::of(&parts), parts));
    }
    Ok(all.into_iter().flatten().collect())
}

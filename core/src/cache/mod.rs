//! Values kept from one run to the next.
//!
//! The key of a value is the hash of all that it depends on: kind and version of its node, the
//! parameters, the contents of the files it reads, the versions of the catalog entries it names,
//! and the keys of its inputs. The parts are kept beside the value, so that it can be told why a
//! node ran again.

mod disk;
mod memory;
mod parts;

pub use disk::DiskCache;
pub use memory::MemoryCache;

pub(crate) use parts::{Dependencies, input_part};

use crate::port::{PortType, Value};
use crate::report::{Note, PortReport};
use crate::staging::WrittenFile;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;

/// Nothing is made faster than this, as far as clocks tell.
const LEAST_WALL_S: f64 = 1e-6;

/// Why the cache could not keep or find something. A run goes on without it.
#[derive(Debug, thiserror::Error)]
pub enum CacheError {
    /// A value does not fit its encoding.
    #[error("a value cannot be encoded or decoded: {0}")]
    Encode(#[source] postcard::Error),
    /// A value is not of the type that its port says.
    #[error("a value is not of type {0}")]
    WrongType(&'static str),
    /// The disk refuses.
    #[error("cannot write to the cache: {0}")]
    Write(#[from] io::Error),
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

//! What is told of a run, while it goes on and afterwards, to people and scripts.

use crate::source::Span;
use crate::staging::WrittenFile;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How much a note matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Weight {
    /// Good to know.
    Note,
    /// The result may not be what was meant.
    Warning,
}

/// Something a node has to say to the user.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Note {
    /// How much it matters.
    pub weight: Weight,
    /// A sentence.
    pub text: String,
}

/// Told what happens during a run. Calls come from many threads at once.
pub trait Observer: Sync {
    /// A node has begun.
    fn started(&self, node: &str) {
        let _ = node;
    }
    /// A node has done `share` (0 to 1) of its work.
    fn progressed(&self, node: &str, share: f64) {
        let _ = (node, share);
    }
    /// A node has something to say.
    fn noted(&self, node: &str, note: &Note) {
        let _ = (node, note);
    }
    /// A node's turn is over.
    fn finished(&self, node: &str, report: &NodeReport) {
        let _ = (node, report);
    }
}

/// An observer that does not look.
impl Observer for () {}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RunStatus {
    /// All that was wanted is there.
    Done,
    /// A node failed; what did not depend on it is there.
    Failed,
    /// A parameter turned out to be absurd; nothing was written.
    Refused,
    /// It was called off; nothing was written.
    Interrupted,
}

/// How a node's turn ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NodeStatus {
    /// It ran.
    Ran,
    /// What it would have made was there already.
    Cached,
    /// It failed.
    Failed,
    /// It had nothing to do, or could not be run.
    Skipped,
}

/// What is told of a value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PortReport {
    /// The name of its type.
    #[serde(rename = "type")]
    pub type_name: String,
    /// Facts by name; which ones depends on the type.
    pub facts: BTreeMap<String, serde_json::Value>,
}

/// What is told of a node.
#[derive(Clone, Debug, Serialize)]
pub struct NodeReport {
    /// Its kind.
    pub kind: &'static str,
    /// How its turn ended.
    pub status: NodeStatus,
    /// How long it took, in seconds.
    pub wall_s: f64,
    /// What it made, by port.
    pub outputs: BTreeMap<String, PortReport>,
    /// What it had to say.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Note>,
    /// Why it failed or was skipped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Where the parameter is set that it refused.
    #[serde(skip)]
    pub place: Option<Span>,
    /// Whether it was skipped because a node that it reads from gave nothing.
    #[serde(skip)]
    pub starved: bool,
}

/// A file that a run read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadFile {
    /// Its path as the recipe or the user gave it; of a built-in file the path inside the program.
    pub path: String,
    /// Its size.
    pub bytes: u64,
    /// The BLAKE3 hash of its contents, in hex.
    pub blake3: String,
}

/// What is told of a run.
#[derive(Clone, Debug, Serialize)]
pub struct RunReport {
    /// The recipe.
    pub recipe: String,
    /// How it ended.
    pub status: RunStatus,
    /// How long it took, in seconds.
    pub wall_s: f64,
    /// The most memory that the program held, in MB; not known on every system.
    pub peak_rss_mb: Option<f64>,
    /// Number of threads.
    pub threads: usize,
    /// The files that were written, or found as they would have been written.
    pub files: Vec<String>,
    /// The same files by node, with their sizes and hashes.
    #[serde(skip)]
    pub written: Vec<(String, WrittenFile)>,
    /// The files that were read, or had been read for what was cached, by path.
    #[serde(skip)]
    pub read: Vec<ReadFile>,
    /// The nodes by name.
    pub nodes: BTreeMap<String, NodeReport>,
    /// What went wrong outside of any node, such as putting the files in place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trouble: Option<String>,
}

/// The most memory that this process ever held, in MB (10⁶ bytes), where the system tells.
pub(crate) fn peak_rss_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024.0 / 1e6)
}

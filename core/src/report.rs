//! What is told of a run afterwards, for people and scripts.

use crate::context::Note;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

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
    /// Whether it was skipped because a node that it reads from gave nothing.
    #[serde(skip)]
    pub starved: bool,
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

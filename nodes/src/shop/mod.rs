//! What stands in the user's shop: machines and tools, each described in a `.ron` file.
//!
//! The built-in ones lie in `machines/` and are read like anybody's. A recipe chooses them by name; where
//! nothing is chosen ([`NONE`]) nothing is decided and nothing is checked.

mod file;
mod limits;
mod machine;
mod tool;

pub(crate) use limits::{Demands, Violation};
pub use machine::{Machine, Machines, SetBy, SpindleRange, ToolChange, Travel};
#[cfg(test)]
pub(crate) use tool::tests;
pub use tool::{Conditions, Tool, ToolSheet, Tools};

use carvegraph_core::source::Source;
use serde::{Deserialize, Serialize};

/// The name of no machine, no tool and no material.
pub const NONE: &str = "none";

/// X, Y and Z, as messages write them.
pub(crate) const AXES: [&str; 3] = ["X", "Y", "Z"];

/// What a job is set up with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// The machine.
    pub machine: Machine,
    /// The tool's name, or [`NONE`].
    pub tool: String,
    /// The tool's place in the controller's tool table.
    pub number: Option<u32>,
    /// The material, or [`NONE`].
    pub material: String,
    /// Speeds of that tool in that material.
    pub conditions: Conditions,
}

impl Default for Setup {
    fn default() -> Self {
        let (machine, conditions) = (Machine::default(), Conditions::default());
        Self { machine, tool: NONE.into(), number: None, material: NONE.into(), conditions }
    }
}

/// What changes with the text of a file: the version of what it describes.
fn version(source: &Source) -> String {
    blake3::hash(source.text().as_bytes()).to_hex()[..16].to_owned()
}

/// A number for a message, to a thousandth at most: 22.5, 180.
pub(crate) fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

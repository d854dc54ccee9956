//! A node: a step that a recipe can wire to others.
//!
//! The same inputs and parameters must give the same outputs, bit for bit, on any number of threads;
//! files, the clock and randomness are out of bounds. `carve` keeps what a node made and takes it again
//! as long as its [`version`](Node::version), its parameters and its inputs stay what they are.
//!
//! A whole node that makes steps of a surface:
//!
//! ```
//! use carvegraph_sdk::node::{Job, Node, NodeFault, Param, ParamKind, Port};
//! use carvegraph_sdk::value::{HeightField, PortValue, Raw};
//!
//! /// Makes steps of equal height of a surface.
//! pub struct Terrace;
//!
//! impl Node for Terrace {
//!     fn name(&self) -> &str {
//!         "terrace"
//!     }
//!
//!     fn about(&self) -> &str {
//!         "Makes steps of a surface, like the terraces of a hillside."
//!     }
//!
//!     fn params(&self) -> &[Param] {
//!         &[Param {
//!             name: "step",
//!             about: "Height of a step.",
//!             kind: ParamKind::Number { unit: "mm", default: 0.5, min: 0.001, max: 1000.0 },
//!         }]
//!     }
//!
//!     fn inputs(&self) -> &[Port] {
//!         &[Port {
//!             name: "surface",
//!             about: "The surface.",
//!             type_name: HeightField::TYPE,
//!             optional: false,
//!         }]
//!     }
//!
//!     fn outputs(&self) -> &[Port] {
//!         &[Port {
//!             name: "surface",
//!             about: "The surface in steps.",
//!             type_name: HeightField::TYPE,
//!             optional: false,
//!         }]
//!     }
//!
//!     fn run(&self, job: &Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault> {
//!         let step = job.number("step")? as f32;
//!         let surface: HeightField = job.input("surface")?;
//!         let mut heights = surface.heights.to_vec();
//!         job.parallel_chunks(&mut heights, surface.columns, |_, row| {
//!             row.iter_mut().for_each(|height| *height = (*height / step).floor() * step);
//!         })?;
//!         Ok(vec![surface.with_heights(heights).into_raw()])
//!     }
//! }
//!
//! // Its test.
//! use carvegraph_sdk::node::Trial;
//!
//! let surface =
//!     HeightField { columns: 2, rows: 2, pitch_mm: 0.1, heights: vec![0.1, 0.6, 1.4, 2.0].into() };
//! let made = Trial::of(&Terrace).set("step", 1.0).input("surface", surface).run().unwrap();
//! let made = HeightField::from_raw(&made[0]).unwrap();
//! assert_eq!(*made.heights, [0.0, 0.0, 1.0, 2.0]);
//! ```

mod definition;
mod job;
#[cfg(test)]
mod tests;
mod trial;

pub use definition::{DefinitionError, UNITS, check_definition, check_outputs};
pub use job::{Argument, Job, Services};
pub use trial::{Alone, Trial};

use crate::value::{Raw, ValueError};

/// A step of a graph. [`check_definition`] says what its definition must be like.
pub trait Node: Send + Sync {
    /// What recipes call it: lower case, digits and `_`.
    fn name(&self) -> &str;

    /// What it does, for a user; a line.
    fn about(&self) -> &str;

    /// Raised whenever the same inputs would give other outputs than before, so that what the older
    /// version made is not taken from a cache.
    fn version(&self) -> u32 {
        1
    }

    /// Its parameters; none unless it says otherwise.
    fn params(&self) -> &[Param] {
        &[]
    }

    /// What it reads; nothing unless it says otherwise.
    fn inputs(&self) -> &[Port] {
        &[]
    }

    /// What it makes, one port at least.
    fn outputs(&self) -> &[Port];

    /// Does the work; gives one value for each of [`outputs`](Self::outputs), in their order. It may be
    /// called several times at once.
    ///
    /// # Errors
    /// If it cannot, or was called off.
    fn run(&self, job: &Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault>;
}

/// One parameter of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Param {
    /// Its name in recipes: lower case, digits and `_`.
    pub name: &'static str,
    /// What it does, for a user; a line.
    pub about: &'static str,
    /// What values it takes.
    pub kind: ParamKind,
}

/// What values a parameter takes, and the one that it has where a recipe says nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParamKind {
    /// A number.
    Number {
        /// What it counts: one of [`UNITS`]. In "%" it is a share of one: a user's 20 % comes as 0.2,
        /// and so are default, least and greatest value.
        unit: &'static str,
        /// Its default, within the range.
        default: f64,
        /// Least value; `f64::NEG_INFINITY` if there is none, `f64::MIN_POSITIVE` for "above 0".
        min: f64,
        /// Greatest value; `f64::INFINITY` if there is none.
        max: f64,
    },
    /// A whole number. None is beyond ±2⁵³: it crosses as a double.
    Integer {
        /// What it counts: "px", or nothing as a rule.
        unit: &'static str,
        /// Its default, within the range.
        default: i64,
        /// Least value.
        min: i64,
        /// Greatest value.
        max: i64,
    },
    /// True or false.
    Switch {
        /// Its default.
        default: bool,
    },
    /// Free text. Not the name of a file: a node reads and writes none.
    Text {
        /// Its default; may be empty.
        default: &'static str,
    },
    /// One of a few words.
    Choice {
        /// The words, in the order in which a user sees them.
        options: &'static [ParamOption],
        /// One of them.
        default: &'static str,
    },
}

/// One word that a [`ParamKind::Choice`] may be set to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParamOption {
    /// The word: lower case, digits and `_`.
    pub name: &'static str,
    /// What it means; a line.
    pub about: &'static str,
}

/// One port of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Port {
    /// Its name in recipes: lower case, digits and `_`.
    pub name: &'static str,
    /// What passes through it, for a user; a line.
    pub about: &'static str,
    /// One of [`crate::value::TYPES`].
    pub type_name: &'static str,
    /// Whether it is an input that may be left open. An output never is.
    pub optional: bool,
}

/// Why a node did not finish.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NodeFault {
    /// It cannot do its work on what it was given; says why, and what to do.
    #[error("{0}")]
    Failed(String),
    /// [`Services`] said to stop.
    #[error("interrupted")]
    Cancelled,
}

impl NodeFault {
    /// The node failed because of `cause`.
    pub fn failed(cause: impl std::fmt::Display) -> Self {
        Self::Failed(cause.to_string())
    }
}

impl From<ValueError> for NodeFault {
    fn from(fault: ValueError) -> Self {
        Self::failed(fault)
    }
}

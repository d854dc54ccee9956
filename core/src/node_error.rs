//! Why a node did not finish.

use crate::files::FileError;
use std::fmt;

/// Why a node did not finish.
#[derive(Debug, thiserror::Error)]
pub enum NodeError {
    /// It cannot do its work on what it was given.
    #[error("{0}")]
    Failed(String),
    /// A parameter that looked fine turned out to be absurd for this job. The whole run is called
    /// off and nothing is written, as if the recipe had been refused when it was checked.
    #[error("{message}")]
    Refused {
        /// The parameter.
        param: &'static str,
        /// What is wrong with it and what to do.
        message: String,
    },
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The run was interrupted.
    #[error("interrupted")]
    Cancelled,
}

impl NodeError {
    /// The node failed because of `cause`.
    pub fn failed(cause: impl fmt::Display) -> Self {
        Self::Failed(cause.to_string())
    }

    /// The value of `param` is absurd for this job.
    pub fn refused(param: &'static str, message: impl Into<String>) -> Self {
        Self::Refused { param, message: message.into() }
    }
}

//! Why a file gives no mesh and no points.

use std::fmt;

/// Why a file gives no mesh or points; the message follows the file's name.
#[derive(Debug, thiserror::Error, PartialEq)]
pub(crate) enum ReadError {
    /// It is of no known format.
    #[error("is {0}")]
    Unknown(&'static str),
    /// Something in it is wrong.
    #[error("is no sound {format} file: {place}: {what}")]
    Bad { format: &'static str, place: Place, what: String },
    /// There is nothing in it.
    #[error("holds no {what}: it is a sound {format} file, but there is nothing in it to carve")]
    Empty { format: &'static str, what: &'static str },
    /// There is too much in it.
    #[error("has {count} {what}; the limit is {limit}: thin it out before it is loaded")]
    TooMany { what: &'static str, count: u64, limit: usize },
    /// The run was interrupted.
    #[error("interrupted")]
    Stopped,
}

impl ReadError {
    pub(crate) fn at_byte(format: &'static str, at: usize, what: impl Into<String>) -> Self {
        Self::Bad { format, place: Place::Byte(at), what: what.into() }
    }

    /// At byte `at` of a text, whose line it is called by.
    pub(crate) fn at_line(
        format: &'static str,
        bytes: &[u8],
        at: usize,
        what: impl Into<String>,
    ) -> Self {
        Self::Bad { format, place: Place::Line(super::text::line_of(bytes, at)), what: what.into() }
    }

    pub(crate) fn in_part(
        format: &'static str,
        part: impl Into<String>,
        what: impl Into<String>,
    ) -> Self {
        Self::Bad { format, place: Place::Part(part.into()), what: what.into() }
    }
}

/// A place in a file.
#[derive(Debug, PartialEq)]
pub(crate) enum Place {
    /// Bytes from its beginning.
    Byte(usize),
    /// Lines, from 1.
    Line(usize),
    /// A part with a name.
    Part(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Byte(at) => write!(f, "byte {at}"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Part(name) => f.write_str(name),
        }
    }
}

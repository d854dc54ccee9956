//! Why a value that crosses is none.

use super::TYPES;
use carvegraph_geometry::ProfileError;

/// Longer names are cut in messages.
const MAX_SHOWN_CHARS: usize = 40;

/// Why a value that crosses is none.
#[non_exhaustive]
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum ValueError {
    /// Another type.
    #[error("it is a {given}; it must be a {wanted}")]
    Type {
        /// The type that it must be of.
        wanted: &'static str,
        /// The type that it says it is of.
        given: String,
    },
    /// No type that passes between nodes.
    #[error("there is no type {given:?}; there are {}", TYPES.join(", "))]
    UnknownType {
        /// The type that it says it is of.
        given: String,
    },
    /// An array is missing.
    #[error("the {of} ends before its array {wanted:?}")]
    Missing {
        /// The type.
        of: &'static str,
        /// The array that must follow.
        wanted: &'static str,
    },
    /// An array more than the type has.
    #[error("the {of} has an array {given:?} more than it must have")]
    Extra {
        /// The type.
        of: &'static str,
        /// The array that is too much.
        given: String,
    },
    /// An array of another name.
    #[error("the {of} has an array {given:?} where {wanted:?} must stand")]
    Name {
        /// The type.
        of: &'static str,
        /// The array that must stand there.
        wanted: &'static str,
        /// The array that does.
        given: String,
    },
    /// Elements of another kind.
    #[error("{array:?} of the {of} is of {given}; it must be of {wanted}")]
    Element {
        /// The type.
        of: &'static str,
        /// The array.
        array: &'static str,
        /// The elements that it must have, such as "f32".
        wanted: &'static str,
        /// The elements that it has.
        given: &'static str,
    },
    /// Too many or too few elements.
    #[error("{array:?} of the {of} has {given} elements; it must have {wanted}")]
    Length {
        /// The type.
        of: &'static str,
        /// The array.
        array: &'static str,
        /// How many it must have, in words.
        wanted: String,
        /// How many it has.
        given: usize,
    },
    /// An index or a code that leads nowhere.
    #[error("element {place} of {array:?} of the {of} is {given}; it must be below {limit}")]
    TooLarge {
        /// The type.
        of: &'static str,
        /// The array.
        array: &'static str,
        /// Which element, from 0.
        place: usize,
        /// What it is.
        given: u64,
        /// What it must be below.
        limit: u64,
    },
    /// A span that reaches beyond the points.
    #[error("span {place} of the {of} has {count} points, but only {left} are left for it")]
    SpanTooLong {
        /// The type.
        of: &'static str,
        /// Which span, from 0.
        place: usize,
        /// Its number of points.
        count: u64,
        /// The points behind the spans before it.
        left: usize,
    },
    /// A span without a point.
    #[error("span {place} of the {of} has no point; leave it out")]
    SpanEmpty {
        /// The type.
        of: &'static str,
        /// Which span, from 0.
        place: usize,
    },
    /// Points that belong to no span.
    #[error("the spans of the {of} hold {start} of its {points} points; they must hold all")]
    SpansTooFew {
        /// The type.
        of: &'static str,
        /// The first point that is in none.
        start: usize,
        /// Number of points.
        points: usize,
    },
    /// A number of samples a pixel that no picture has.
    #[error("the image has {given} samples a pixel; it must have 1 to 4")]
    Channels {
        /// How many it has.
        given: u64,
    },
    /// A text that is not UTF-8.
    #[error("{array:?} of the {of} is not UTF-8")]
    Text {
        /// The type.
        of: &'static str,
        /// The array.
        array: &'static str,
    },
    /// A cutter's profile that is none.
    #[error(transparent)]
    Profile(#[from] ProfileError),
}

impl ValueError {
    pub(super) fn unknown_type(given: &str) -> Self {
        Self::UnknownType { given: shown(given) }
    }
}

/// A name from the other side, cut to a length fit for a message and without control characters.
pub(super) fn shown(name: &str) -> String {
    name.chars().take(MAX_SHOWN_CHARS).flat_map(char::escape_debug).collect()
}

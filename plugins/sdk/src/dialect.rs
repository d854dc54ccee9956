//! A G-code dialect: how one family of controllers wants a program spelled.

use crate::Program;
use std::io;

/// What a dialect's controller can do, for whoever builds a program for it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    /// Takes [`crate::Command::Arc`].
    pub arcs: bool,
    /// Takes [`crate::Command::ToolChange`].
    pub tool_change: bool,
    /// Is told [`Program::path_tolerance_mm`].
    pub path_tolerance: bool,
}

/// A post-processor.
pub trait Dialect: Send + Sync {
    /// What recipes call it: lower case, digits and `_`.
    fn name(&self) -> &str;

    /// The controllers it is for, in a line.
    fn about(&self) -> &str;

    /// File name extension of its programs, without the dot.
    fn extension(&self) -> &str;

    /// What its controllers can do.
    fn capabilities(&self) -> Capabilities;

    /// Writes a program. Output comes in pieces, so that a sink can cancel by returning an error.
    ///
    /// # Errors
    /// If the program asks for what the controller cannot do or must not be told, or the sink
    /// fails. What was written before is not a program and must be thrown away.
    fn post(&self, program: &Program<'_>, out: &mut dyn io::Write) -> Result<(), PostError>;
}

/// Why a program cannot be written. `command` is an index into [`Program::commands`].
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum PostError {
    /// The controller has no such function.
    #[error("command {command}: {message}")]
    Unsupported {
        /// Which command asks for it.
        command: usize,
        /// What is missing and what to do.
        message: String,
    },
    /// A coordinate is NaN, infinite or absurd.
    #[error("command {command}: {axis} is {value_mm} mm; it must lie within ±{limit_mm} mm")]
    Coordinate {
        /// Which command holds it.
        command: usize,
        /// X, Y or Z.
        axis: char,
        /// What stands there.
        value_mm: f64,
        /// The largest magnitude allowed.
        limit_mm: f64,
    },
    /// A feed is missing, or too small or large to be written.
    #[error(
        "command {command}: a feed of {mm_per_min} mm/min cannot be written; give one above 0 and \
         at most {limit_mm_per_min} mm/min"
    )]
    Feed {
        /// Which command holds it.
        command: usize,
        /// What stands there.
        mm_per_min: f64,
        /// The largest feed allowed.
        limit_mm_per_min: f64,
    },
    /// A spindle speed is not one.
    #[error(
        "command {command}: a spindle speed of {rpm} rpm cannot be written; give 1 to {limit_rpm} rpm"
    )]
    SpindleSpeed {
        /// Which command holds it.
        command: usize,
        /// What stands there.
        rpm: f64,
        /// The largest speed allowed.
        limit_rpm: f64,
    },
    /// A dwell is negative, not finite, or longer than the controller can count.
    #[error(
        "command {command}: a dwell of {seconds} s cannot be written; give 0 to {limit_seconds} s"
    )]
    Dwell {
        /// Which command holds it.
        command: usize,
        /// What stands there.
        seconds: f64,
        /// The longest dwell allowed.
        limit_seconds: f64,
    },
    /// A tool number that no tool table has.
    #[error("command {command}: there is no tool {number}; tools are numbered 1 to {limit}")]
    ToolNumber {
        /// Which command holds it.
        command: usize,
        /// What stands there.
        number: u32,
        /// The largest number allowed.
        limit: u32,
    },
    /// The path tolerance is not a positive length.
    #[error("the path tolerance is {0} mm; it must be above 0")]
    PathTolerance(f64),
    /// The stock is no block.
    #[error(
        "the stock reaches from {min:?} to {max:?} mm; give a finite block, least corner first"
    )]
    Stock {
        /// Its least x, y and z.
        min: [f64; 3],
        /// Its greatest.
        max: [f64; 3],
    },
    /// A cutting move comes before the tip's position is known.
    #[error(
        "command {command} cuts before it is known where the tip is; begin the program, and go on \
         after a tool change, with a rapid to above the work"
    )]
    PositionUnknown {
        /// Which command cuts.
        command: usize,
    },
    /// A cutting move follows a tool change that stopped the spindle.
    #[error(
        "command {command} cuts with the spindle stopped by a tool change; start it again first"
    )]
    SpindleStopped {
        /// Which command cuts.
        command: usize,
    },
    /// Start and end of an arc do not lie on one circle.
    #[error(
        "command {command}: the arc starts {start_mm} mm from its centre and ends {end_mm} mm from \
         it; the two may differ by {limit_mm} mm"
    )]
    ArcRadius {
        /// Which command holds the arc.
        command: usize,
        /// Distance from start to centre.
        start_mm: f64,
        /// Distance from end to centre.
        end_mm: f64,
        /// The largest difference allowed.
        limit_mm: f64,
    },
    /// An arc is so flat that controllers lose its shape.
    #[error("command {command}: the arc's radius is {radius_mm} mm; above {limit_mm} mm use lines")]
    ArcTooFlat {
        /// Which command holds the arc.
        command: usize,
        /// Its radius.
        radius_mm: f64,
        /// The largest radius allowed.
        limit_mm: f64,
    },
    /// An index leads outside its table.
    #[error("command {command} refers to {table} {index}, but there are only {length}")]
    Index {
        /// Which command holds the index.
        command: usize,
        /// "text" or "arc".
        table: &'static str,
        /// What stands there.
        index: u32,
        /// Entries in the table.
        length: usize,
    },
    /// A block is longer than the controller can read.
    #[error("a block has {length} characters, the controller reads {limit}: {block:?}")]
    BlockTooLong {
        /// The block.
        block: String,
        /// Characters that count.
        length: usize,
        /// What the controller reads.
        limit: usize,
    },
    /// The dialect itself is at fault.
    #[error("{dialect} would write {line:?}, but its controller rejects {word}")]
    Rejected {
        /// The dialect.
        dialect: String,
        /// What it would write.
        line: String,
        /// The word in it that its controller rejects.
        word: String,
    },
    /// A dialect in a library says why.
    #[error("{0}")]
    Plugin(String),
    /// The sink failed, or asked to stop.
    #[error(transparent)]
    Io(#[from] io::Error),
}

//! A machine program before any controller's spelling: what to do, in order.
//!
//! Frame: right-handed, millimetres, Z up, the cutter's tip is the controlled point, whatever units
//! the written program is in. A job has hundreds of thousands of moves, so a [`Command`] stays at
//! 40 bytes of plain data; the few that need more (texts, arcs) point into tables of the
//! [`Program`]. Enums and structs that stand in slices have a C layout.

pub use carvegraph_geometry::{Direction, Plane};

/// Units of the written program; a [`Program`] itself is always in mm.
#[repr(u32)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// Millimetres and mm/min (G21).
    #[default]
    Mm,
    /// Inches and inches/min (G20).
    Inch,
}

/// An arc from where the tip is to `to`, a helix if `to` lies off the plane.
///
/// Exactly equal start and end in the plane mean one full turn.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// The plane it lies in.
    pub plane: Plane,
    /// The way it turns.
    pub direction: Direction,
    /// Its centre in mm; the coordinate off the plane does not count.
    pub center: [f64; 3],
    /// Its end in mm.
    pub to: [f64; 3],
    /// Speed along it in mm/min.
    pub mm_per_min: f64,
}

/// The block that is cut from, in the program's frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stock {
    /// Its least x, y and z in mm.
    pub min: [f64; 3],
    /// Its greatest, none below the least.
    pub max: [f64; 3],
}

/// One step of a program.
#[repr(u32)]
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// A remark for whoever reads the program.
    Comment {
        /// Index into [`Program::texts`].
        text: u32,
    },
    /// Stops the spindle, changes to a tool and takes up its length. What follows must begin with a
    /// rapid: a tool change leaves the tip anywhere.
    ToolChange {
        /// Number in the controller's tool table, from 1.
        number: u32,
    },
    /// Turns the spindle on.
    Spindle {
        /// The way it turns.
        direction: Direction,
        /// Revolutions per minute, above 0.
        rpm: f64,
    },
    /// Turns the spindle off.
    SpindleStop,
    /// Waits.
    Dwell {
        /// How long, in seconds.
        seconds: f64,
    },
    /// Travels without cutting. Z and XY never move at once: upwards Z goes first, downwards last.
    Rapid {
        /// The end in mm.
        to: [f64; 3],
    },
    /// Feeds in a straight line.
    Feed {
        /// The end in mm.
        to: [f64; 3],
        /// Speed in mm/min, above 0.
        mm_per_min: f64,
    },
    /// Feeds along an arc.
    Arc {
        /// Index into [`Program::arcs`].
        arc: u32,
    },
}

const _: () = assert!(size_of::<Command>() == 40, "a job has 460,000 of them");

/// A whole program. The program's end is not a command: [`crate::Dialect::post`] writes it.
///
/// The first motion must be a rapid, to a point above the start: it raises Z before it travels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Program<'a> {
    /// What the job is, in a line; any text, a dialect makes it harmless.
    pub title: &'a str,
    /// Remarks for the head of the program, a line each; any text.
    pub remarks: &'a [&'a str],
    /// Units to write in.
    pub units: Units,
    /// How far the controller may leave the path to keep its speed, in mm, above 0. Dialects that
    /// cannot say so ignore it; LinuxCNC uses it twice, for blending and for merging points.
    pub path_tolerance_mm: f64,
    /// Whether to write straight moves only, because this machine takes no arcs though its dialect
    /// does: arcs become chords within the path tolerance.
    pub lines_only: bool,
    /// The block that is cut from, for controllers that draw what they do. Without one they draw
    /// what the cuts pass through.
    pub stock: Option<Stock>,
    /// What to do, in order.
    pub commands: &'a [Command],
    /// Texts of [`Command::Comment`].
    pub texts: &'a [&'a str],
    /// Arcs of [`Command::Arc`].
    pub arcs: &'a [Arc],
}

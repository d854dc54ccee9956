//! What every dialect must fulfil.
//!
//! * Its name, description and extension are in order, and so are its capabilities.
//! * What it writes, read back the way its controller would, is the motion that was meant: rapids in
//!   their order, feeds, arcs both ways, full circles, helices, all planes, tool changes; in mm and in
//!   inches; from a short job with something of everything and a random long one.
//! * Numbers, line lengths, frame, block numbers and the radii of rounded arcs are what the controller
//!   takes. Nothing cuts with the spindle stopped.
//! * A title or a remark stays a comment, whatever it holds.
//! * With [`Program::lines_only`](crate::Program::lines_only) no arc is written.
//! * What must not be written is refused: NaN and absurd coordinates, feeds, speeds and dwells, tools
//!   that there are not, arcs that are none, indices that lead nowhere.
//! * A sink that refuses is obeyed soon, and the same program gives the same bytes.
//!
//! A [`Reading`] says how the controller reads. That of a usual one is [`Reading::default`], so for a
//! dialect of G-code words a test is short:
//!
//! ```
//! use carvegraph_sdk::Dialect;
//! use carvegraph_sdk::conformance::dialect::{Arcs, Reading, check};
//!
//! fn holds(dialect: &dyn Dialect) {
//!     let arcs = Arcs { xy_only: true, ..Arcs::default() };
//!     check(dialect, &Reading { line_limit: 79, arcs, ..Reading::default() });
//! }
//! ```
//!
//! For a language of its own the plugin brings [`Reading::read`].
//!
//! Limits: the reader follows one program word by word, it does not know macros, cycles or modes other
//! than motion, plane and units.

mod compare;
mod job;
mod reader;
mod suite;

pub use compare::compare;
pub use job::{Job, Move, long, random, small};
pub use reader::{number, read, sweep};
pub use suite::{HOSTILE_TEXTS, refused_jobs};

use crate::Dialect;

/// `Err` with what is wrong.
type Fault<T = ()> = Result<T, String>;

/// How a controller reads a program, and what a dialect makes of motions for its sake.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Reads a whole program of a language of its own: the moves it makes, a position that is not
    /// known being NaN. It panics where the controller would complain.
    pub read: Option<fn(&str) -> Vec<Move>>,
    /// G and M words that the controller takes, without zeros before their numbers; `None` for any.
    pub codes: Option<&'static [&'static str]>,
    /// Letters that words may begin with.
    pub letters: &'static str,
    /// Letters whose numbers have no decimal point. All others must have one.
    pub whole: &'static str,
    /// Decimals of a coordinate at most, in mm and in inches.
    pub decimals: [usize; 2],
    /// What a feed is rounded to, in mm/min and in/min.
    pub feed_steps: [f64; 2],
    /// The words for mm and for inches.
    pub units: [&'static str; 2],
    /// Characters in a line.
    pub line_limit: usize,
    /// Beginnings of the lines before everything else; what follows is upper case, digits and `_`.
    pub first: &'static [&'static str],
    /// The same for lines after everything else.
    pub last: &'static [&'static str],
    /// The block that ends a program.
    pub end: &'static str,
    /// What begins a comment and what ends it; `""` where the line's end does.
    pub comment: [&'static str; 2],
    /// What must not stand in a comment.
    pub harmful: &'static str,
    /// What comments must begin with, so that none is an order; none for anything.
    pub marks: &'static [&'static str],
    /// Blocks are numbered with this letter, from and by this number.
    pub numbered: Option<(char, u32)>,
    /// Whether a motion word holds until the next.
    pub modal: bool,
    /// A dwell's letter, and how many of its unit make a second.
    pub dwell: (char, f64),
    /// Blocks that send Z to the machine's top.
    pub top: &'static [&'static str],
    /// Beginnings of blocks that are neither words nor motions.
    pub ignored: &'static [&'static str],
    /// Words that take up a tool's length after M6; without any M6 does.
    pub length: &'static [&'static str],
    /// Whether they stand in the block that first moves Z.
    pub length_with_z: bool,
    /// Whether Z is at the top before the first rapid and after a tool change, so that XY goes first.
    pub starts_high: bool,
    /// Whether rapids move one axis at a time.
    pub single_axis_rapids: bool,
    /// Its arcs.
    pub arcs: Arcs,
}

/// Which arcs a dialect writes; the others become lines.
#[derive(Clone, Copy, Debug)]
pub struct Arcs {
    /// How centres are given.
    pub centers: Centers,
    /// None at all.
    pub never: bool,
    /// In XY only.
    pub xy_only: bool,
    /// None that leaves its plane.
    pub flat_only: bool,
    /// The largest angle of one arc, in degrees.
    pub sweep_limit_deg: f64,
    /// By how much distances from the centre to start and end may differ, in mm.
    pub tolerance_mm: f64,
    /// The least radius, in mm.
    pub least_radius_mm: f64,
}

/// How an arc's centre is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Centers {
    /// By I, J, K from the start.
    Incremental,
    /// By I, J, K from the program's zero.
    Absolute,
    /// By R. No arc of more than half a turn is meant.
    Radius,
}

impl Default for Arcs {
    /// All, by I, J, K from the start, as strict as GRBL and LinuxCNC together.
    fn default() -> Self {
        Self {
            centers: Centers::Incremental,
            never: false,
            xy_only: false,
            flat_only: false,
            sweep_limit_deg: 360.0,
            tolerance_mm: 0.005,
            least_radius_mm: 0.001_27,
        }
    }
}

impl Default for Reading {
    /// A controller of plain RS-274: decimal points, comments in brackets, G21 and G20, lines of 79
    /// characters, M30.
    fn default() -> Self {
        Self {
            read: None,
            codes: None,
            letters: "DFGHIJKLMPQRSTXYZ",
            whole: "DHST",
            decimals: [3, 4],
            feed_steps: [0.001, 0.000_1],
            units: ["G21", "G20"],
            line_limit: 79,
            first: &[],
            last: &[],
            end: "M30",
            comment: ["(", ")"],
            harmful: "()!?~;$[]{}\\<>|^`",
            marks: &[],
            numbered: None,
            modal: true,
            dwell: ('P', 1.0),
            top: &[],
            ignored: &[],
            length: &[],
            length_with_z: false,
            starts_high: false,
            single_axis_rapids: false,
            arcs: Arcs::default(),
        }
    }
}

/// Holds a dialect against what [`Dialect`] promises.
///
/// # Panics
/// With what is wrong, if anything is.
#[track_caller]
pub fn check(dialect: &dyn Dialect, reading: &Reading) {
    if let Err(fault) = suite::all(dialect, reading) {
        panic!("dialect {:?}: {fault}", dialect.name());
    }
}

/// Holds one job against what is written of it, and answers the program.
///
/// # Panics
/// With what is wrong, if anything is.
#[track_caller]
pub fn check_job(dialect: &dyn Dialect, reading: &Reading, job: &Job) -> String {
    match suite::job(dialect, reading, job) {
        Ok(text) => text,
        Err(fault) => panic!("dialect {:?}: {fault}", dialect.name()),
    }
}

fn ensure(good: bool, fault: impl FnOnce() -> String) -> Fault {
    if good { Ok(()) } else { Err(fault()) }
}

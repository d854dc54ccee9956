//! ISO 6983, the plain baseline.
//!
//! For controllers without a dialect of their own, and what the others of the family refine: all of
//! [`Rs274`] is said here once. Arcs by I, J, K from the start, no block numbers, nothing that only
//! some controllers know; a tool change takes up the tool's length by `G43 H`.

use crate::comment::BRACKETS;
use crate::front::{Abilities, Arcs, Tools};
use crate::number::{FeedUnit, NumberFormat};
use crate::rs274::{Center, PathTolerance, ProgramNumber, Rs274, Words};

pub(crate) const ISO: Rs274 = Rs274 {
    name: "iso6983",
    about: "ISO 6983: the plain baseline, for controllers without a dialect of their own",
    extension: "nc",
    abilities: Abilities {
        numbers: NumberFormat { decimals_mm: 3, decimals_inch: 4, least_decimals: 1, plus: false },
        feed_unit: FeedUnit::PerMinute,
        arcs: Arcs { all_planes: true, helices: true, sweep_limit_deg: 360.0 },
        single_axis_rapids: false,
        starts_high: false,
        // Two digits of T and H.
        tools: Tools::UpTo(99),
        counterclockwise: true,
        spin_up_s: None,
        // An hour is a slip of the pen.
        dwell_limit_s: 3600.0,
        rapid_mm_per_min: None,
    },
    // What the smallest of the family reads.
    line_limit: 79,
    numbering: None,
    comments: BRACKETS,
    program_number: ProgramNumber { digits: 4, limit: 7999 },
    opening: &[],
    notes: &[],
    note_without_tool: "",
    note_on_dwell: "",
    head: &["G17 {units} G90 G94"],
    path_tolerance: PathTolerance::None,
    retract: &[],
    tool_note: "",
    tool_change: &["T{tool} M6", "G43 H{tool}"],
    length_with_z: "",
    words: Words {
        rapid: "G0",
        feed: "G1",
        clockwise: "G2",
        counterclockwise: "G3",
        planes: ["G17", "G18", "G19"],
        mm: "G21",
        inch: "G20",
        spindle_clockwise: "M3 S{rpm}",
        spindle_counterclockwise: "M4 S{rpm}",
        spindle_stop: "M5",
        dwell: "G4 P{seconds}",
    },
    repeat_motion: false,
    center: Center::Incremental,
    end: &["M30"],
    closing: &[],
    rejects: &[],
};

//! ISO 6983, the plain baseline.
//!
//! For controllers without a dialect of their own, and what the others of the family refine: all of
//! [`Rs274`] is said here once. Arcs by I, J, K from the start, no block numbers, nothing that only
//! some controllers know; a tool change takes up the tool's length by `G43 H`.

use crate::comment::brackets;
use crate::front::Arcs;
use crate::lines::{Lines, ProgramNumber};
use crate::number::{FeedUnit, NumberFormat};
use crate::rs274::{Center, Rs274, Words};

/// An hour: a longer dwell is a slip of the pen.
const DWELL_LIMIT_S: f64 = 3600.0;

/// What the smallest of the family reads.
const LINE_LIMIT: u32 = 79;

/// Two digits of T and H.
const TOOL_LIMIT: u32 = 99;

pub(crate) fn settings() -> Rs274 {
    Rs274 {
        name: "iso6983".into(),
        about: "ISO 6983: the plain baseline, for controllers without a dialect of their own"
            .into(),
        extension: "nc".into(),
        numbers: NumberFormat { decimals_mm: 3, decimals_inch: 4, least_decimals: 1, plus: false },
        feed_unit: FeedUnit::PerMinute,
        arcs: Some(Arcs::ALL),
        center: Center::Incremental,
        radius_word: "R".into(),
        single_axis_rapids: false,
        rapid_mm_per_min: None,
        tool_limit: Some(TOOL_LIMIT),
        tool_refusal: "has no tool change".into(),
        spin_up_s: None,
        dwell_limit_s: DWELL_LIMIT_S,
        line_limit: LINE_LIMIT,
        numbering: None,
        comments: Some(brackets()),
        program_number: ProgramNumber { digits: 4, limit: 7999 },
        words: Words {
            rapid: "G0".into(),
            feed: "G1".into(),
            clockwise: "G2".into(),
            counterclockwise: "G3".into(),
            planes: ["G17".into(), "G18".into(), "G19".into()],
            mm: "G21".into(),
            inch: "G20".into(),
        },
        repeat_motion: false,
        lines: Lines {
            header: "G17 {{ units }} G90 G94".into(),
            tool_change: "T{{ tool }} M6\nG43 H{{ tool }}".into(),
            spindle_clockwise: "M3 S{{ rpm }}".into(),
            spindle_counterclockwise: "M4 S{{ rpm }}".into(),
            spindle_stop: "M5".into(),
            dwell: "G4 P{{ seconds }}".into(),
            footer: "M30".into(),
            ..Lines::default()
        },
        needs_path_tolerance: false,
        rejects: "".into(),
    }
}

//! Marlin 2 with its options for milling.
//!
//! * One command a line, and no motion is kept from the line before: each block has its `G`.
//! * A G0 has no speed of its own but the last F: so rapids have an F.
//! * M30 deletes a file. A program just ends.
//! * `G17` to `G19` are options of the build: only arcs in XY are written, others become lines. So
//!   are `G20`, M3 to M5 and what S means (rpm, percent or 0 to 255): the program says what it needs.
//! * T selects an extruder: there are no tools. Comments begin with `;`, brackets are none.

use crate::comment::{BRACKETS, CommentStyle};
use crate::front::{Abilities, Arcs, Tools};
use crate::grbl::SPIN_UP_S;
use crate::iso6983::ISO;
use crate::rs274::{Rs274, Words};

/// `MAX_CMD_SIZE` is 96, one of which ends the string.
const LINE_LIMIT: usize = 95;

/// What Marlin itself begins with; it takes no axis faster than it can go.
const RAPID_MM_PER_MIN: f64 = 1500.0;

pub(crate) const MARLIN: Rs274 = Rs274 {
    name: "marlin",
    about: "Marlin 2 with spindle support: printers and MPCNC as routers",
    extension: "gcode",
    abilities: Abilities {
        arcs: Arcs { all_planes: false, ..ISO.abilities.arcs },
        tools: Tools::None(
            "marlin has no tool change, its T selects an extruder: write one program for each tool",
        ),
        spin_up_s: Some(SPIN_UP_S),
        rapid_mm_per_min: Some(RAPID_MM_PER_MIN),
        ..ISO.abilities
    },
    line_limit: LINE_LIMIT,
    comments: CommentStyle { open: "; ", close: "", ..BRACKETS },
    notes: &["S is in rpm: CUTTER_POWER_UNIT must be RPM", "{unit}: {units} must be understood"],
    head: &["{units}", "G90"],
    words: Words { dwell: "G4 P{milliseconds}", ..ISO.words },
    repeat_motion: true,
    end: &[],
    rejects: &["T", "H", "%", "G17", "G18", "G19", "G43", "G64", "G94", "M2", "M6", "M30"],
    ..ISO
};

//! Marlin 2 with its options for milling.
//!
//! * One command a line, and no motion is kept from the line before: each block has its `G`.
//! * A G0 has no speed of its own but the last F: so rapids have an F.
//! * M30 deletes a file. A program just ends.
//! * `G17` to `G19` are options of the build: only arcs in XY are written, others become lines. So
//!   are `G20`, M3 to M5 and what S means (rpm, percent or 0 to 255): the program says what it needs.
//! * T selects an extruder: there are no tools. Comments begin with `;`, brackets are none.

use crate::comment::{CommentStyle, brackets};
use crate::front::Arcs;
use crate::grbl::SPIN_UP_S;
use crate::iso6983;
use crate::lines::Lines;
use crate::rs274::Rs274;

/// `MAX_CMD_SIZE` is 96, one of which ends the string.
const LINE_LIMIT: u32 = 95;

/// What Marlin itself begins with; it takes no axis faster than it can go.
const RAPID_MM_PER_MIN: f64 = 1500.0;

pub(crate) fn settings() -> Rs274 {
    let iso = iso6983::settings();
    Rs274 {
        name: "marlin".into(),
        about: "Marlin 2 with spindle support: printers and MPCNC as routers".into(),
        extension: "gcode".into(),
        arcs: Some(Arcs { all_planes: false, ..Arcs::ALL }),
        rapid_mm_per_min: Some(RAPID_MM_PER_MIN),
        tool_limit: None,
        tool_refusal: "has no tool change, its T selects an extruder".into(),
        spin_up_s: Some(SPIN_UP_S),
        line_limit: LINE_LIMIT,
        comments: Some(CommentStyle { open: "; ".into(), close: "".into(), ..brackets() }),
        repeat_motion: true,
        lines: Lines {
            notes: "S is in rpm: CUTTER_POWER_UNIT must be RPM\n\
                    {{ unit }}: {{ units }} must be understood"
                .into(),
            header: "{{ units }}\nG90".into(),
            dwell: "G4 P{{ milliseconds }}".into(),
            footer: "".into(),
            ..iso.lines
        },
        rejects: "T H % G17 G18 G19 G43 G64 G94 M2 M6 M30".into(),
        ..iso
    }
}

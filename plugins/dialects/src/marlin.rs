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

//! Haas mills.
//!
//! As Fanuc, except:
//!
//! * `O` and five digits, up to 99999.
//! * Z goes up by `G53 G0 Z0.`, in the machine's own coordinates: no point in between.
//! * Rapids may be dog-legs that leave the straight line: each moves one axis.
//! * `G187 P3 E` sets the path tolerance, until M30. Brackets do not nest.

use crate::fanuc;
use crate::lines::{Lines, ProgramNumber};
use crate::rs274::Rs274;

/// Tool offsets of a Haas mill.
const TOOL_LIMIT: u32 = 200;

pub(crate) fn settings() -> Rs274 {
    let fanuc = fanuc::settings();
    Rs274 {
        name: "haas".into(),
        about: "Haas mills, classic and next generation control".into(),
        single_axis_rapids: true,
        tool_limit: Some(TOOL_LIMIT),
        program_number: ProgramNumber { digits: 5, limit: 99_999 },
        lines: Lines {
            path_tolerance: "G187 P3 E{{ tolerance }}".into(),
            retract: "G53 G0 Z0.0".into(),
            footer: "G53 G0 Z0.0\nM30".into(),
            ..fanuc.lines
        },
        ..fanuc
    }
}

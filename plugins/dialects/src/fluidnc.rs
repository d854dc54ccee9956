//! FluidNC, GRBL's successor on the ESP32.
//!
//! Source: bdring/FluidNC, `GCode.cpp` and `Spindle.cpp`. As GRBL, but with lines of 255 characters
//! and tool changes: M6 runs what its `config.yaml` names by `atc` or `m6_macro`, which also sees to
//! the tool's length; there is no `G43`. Where neither is named it accepts the M6, changes nothing
//! and says nothing: so the program says it.

use crate::grbl;
use crate::lines::Lines;
use crate::rs274::Rs274;

/// `LINE_BUFFER_SIZE` is 256.
const LINE_LIMIT: u32 = 255;

/// GRBL's `MAX_TOOL_NUMBER`, which it began with.
const TOOL_LIMIT: u32 = 255;

pub(crate) fn settings() -> Rs274 {
    let grbl = grbl::settings();
    Rs274 {
        name: "fluidnc".into(),
        about: "FluidNC: routers with an ESP32 board".into(),
        tool_limit: Some(TOOL_LIMIT),
        line_limit: LINE_LIMIT,
        lines: Lines {
            tool_note:
                "tool {{ tool }}: config.yaml must name an atc or an m6_macro, or M6 does nothing"
                    .into(),
            tool_change: "T{{ tool }} M6".into(),
            ..grbl.lines
        },
        rejects: "H Q G43 G64 G90.1".into(),
        ..grbl
    }
}

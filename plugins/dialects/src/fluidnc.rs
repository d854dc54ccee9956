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

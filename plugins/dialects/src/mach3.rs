use crate::iso6983;
use crate::lines::Lines;
use crate::rs274::Rs274;

/// Its tool table holds 255 tools.
const TOOL_LIMIT: u32 = 255;

pub(crate) fn settings() -> Rs274 {
    let iso = iso6983::settings();
    Rs274 {
        name: "mach3".into(),
        about: "Mach3 mills and routers".into(),
        extension: "tap".into(),
        tool_limit: Some(TOOL_LIMIT),
        lines: Lines {
            note_without_tool: "zero Z without a tool length: G49 cancels it".into(),
            note_on_dwell: "G4 P is in seconds: so must be General Config, G04 Dwell".into(),
            header: "G17 {{ units }} G40 G49 G80 G90 G91.1 G94\nG64".into(),
            ..iso.lines
        },
        rejects: "G90.1".into(),
        ..iso
    }
}

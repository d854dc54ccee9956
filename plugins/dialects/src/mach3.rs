//! Mach3.
//!
//! Whether I and J are absolute is a setting of the machine, so `G91.1` is always said; `G64` keeps
//! it from stopping at every point. M6 runs a macro, which may only ask for the tool; its length is
//! taken up by `G43 H`. The head cancels a length that is left over by `G49`: a program that then
//! takes up none says that Z must have been zeroed without.
//!
//! `G4 P` is in seconds or milliseconds, as the machine is set. Seconds are written, which are its
//! default; read as milliseconds the wait would be too short, the other way a thousand times too
//! long. The program says which.

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

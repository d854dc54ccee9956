//! UCCNC.
//!
//! It takes its units from the profile and ignores `G20` and `G21`; they stand there for the reader,
//! and a remark says what the profile must be. Of the planes only XY is sure: a G2 or G3 without its
//! I and J is skipped in silence, so both are always written and arcs in other planes become lines.
//! M6 runs a macro. It ignores `N`; a first line of `%` names the program.

use crate::comment::{CommentStyle, brackets};
use crate::front::Arcs;
use crate::iso6983;
use crate::lines::Lines;
use crate::rs274::Rs274;

/// Its tool table holds 96 tools.
const TOOL_LIMIT: u32 = 96;

pub(crate) fn settings() -> Rs274 {
    let iso = iso6983::settings();
    Rs274 {
        name: "uccnc".into(),
        about: "UCCNC mills and routers".into(),
        arcs: Some(Arcs { all_planes: false, ..Arcs::ALL }),
        tool_limit: Some(TOOL_LIMIT),
        comments: Some(CommentStyle { punctuation: ".,:+-*/=_'\"@&#".into(), ..brackets() }),
        lines: Lines {
            opening: "%{{ name }}".into(),
            notes: "in {{ unit }}: so must be the profile, UCCNC ignores {{ units }}".into(),
            header: "G17 {{ units }} G40 G80 G90 G91.1 G94".into(),
            ..iso.lines
        },
        rejects: "G18 G19 G90.1".into(),
        ..iso
    }
}

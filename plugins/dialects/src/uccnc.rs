//! UCCNC.
//!
//! It takes its units from the profile and ignores `G20` and `G21`; they stand there for the reader,
//! and a remark says what the profile must be. Of the planes only XY is sure: a G2 or G3 without its
//! I and J is skipped in silence, so both are always written and arcs in other planes become lines.
//! M6 runs a macro. It ignores `N`; a first line of `%` names the program.

use crate::comment::{BRACKETS, CommentStyle};
use crate::front::{Abilities, Arcs, Tools};
use crate::iso6983::ISO;
use crate::rs274::Rs274;

/// Its tool table holds 96 tools.
const TOOL_LIMIT: u32 = 96;

pub(crate) const UCCNC: Rs274 = Rs274 {
    name: "uccnc",
    about: "UCCNC mills and routers",
    abilities: Abilities {
        arcs: Arcs { all_planes: false, ..ISO.abilities.arcs },
        tools: Tools::UpTo(TOOL_LIMIT),
        ..ISO.abilities
    },
    comments: CommentStyle { punctuation: ".,:+-*/=_'\"@&#", ..BRACKETS },
    opening: &["%{name}"],
    notes: &["in {unit}: so must be the profile, UCCNC ignores {units}"],
    head: &["G17 {units} G40 G80 G90 G91.1 G94"],
    rejects: &["G18", "G19", "G90.1"],
    ..ISO
};

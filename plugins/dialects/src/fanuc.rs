//! Fanuc 0i, 16i, 18i, 30i and those that follow them.
//!
//! * Without its decimal point a number counts micrometres: all have one. `G4 P` has none, it
//!   counts milliseconds.
//! * `%`, then `O` and four digits; 8000 to 9999 are reserved. Another `%` ends the file, so no
//!   comment holds one; nor a `:`, which is an `O` in ISO code.
//! * An arc of 180° at most, by I, J, K, is understood everywhere.
//! * `G28` goes by way of the point it names: in `G91` by way of where the tool is, straight up. In
//!   `G90` it would go by way of the work.
//! * `G43 H` stands in the block that moves Z: alone, some move Z by the tool's length at once.
//!   There is no `G49`, which would drop the tip by a length that a program without a tool change
//!   leaves in force; such a program says that Z must have been zeroed with its tool.

use crate::comment::{BRACKETS, CommentStyle};
use crate::front::{Abilities, Arcs, Tools};
use crate::iso6983::ISO;
use crate::rs274::{Rs274, Words};

/// Pairs of offsets that a 0i has as standard; `H` is the tool's number.
const TOOL_LIMIT: u32 = 400;

pub(crate) const FANUC: Rs274 = Rs274 {
    name: "fanuc",
    about: "Fanuc 0i to 30i machining centres",
    abilities: Abilities {
        arcs: Arcs { sweep_limit_deg: 180.0, ..ISO.abilities.arcs },
        starts_high: true,
        tools: Tools::UpTo(TOOL_LIMIT),
        ..ISO.abilities
    },
    comments: CommentStyle { upper: true, punctuation: ".,+-*/=", ..BRACKETS },
    opening: &["%", "O{number}"],
    note_without_tool: "no tool length is taken up: zero Z with this tool",
    head: &["{units}", "G17 G40 G80 G90 G94"],
    retract: &["G91 G28 Z0.0", "G90"],
    tool_change: &["T{tool} M6"],
    length_with_z: "G43 H{tool}",
    words: Words { dwell: "G4 P{milliseconds}", ..ISO.words },
    end: &["G91 G28 Z0.0", "G90", "M30"],
    closing: &["%"],
    rejects: &["G49", "G64"],
    ..ISO
};

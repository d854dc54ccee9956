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

use crate::comment::{CommentStyle, brackets};
use crate::front::Arcs;
use crate::iso6983;
use crate::lines::Lines;
use crate::rs274::Rs274;

/// Pairs of offsets that a 0i has as standard; `H` is the tool's number.
const TOOL_LIMIT: u32 = 400;

pub(crate) fn settings() -> Rs274 {
    let iso = iso6983::settings();
    Rs274 {
        name: "fanuc".into(),
        about: "Fanuc 0i to 30i machining centres".into(),
        arcs: Some(Arcs { sweep_limit_deg: 180.0, ..Arcs::ALL }),
        tool_limit: Some(TOOL_LIMIT),
        comments: Some(CommentStyle { upper: true, punctuation: ".,+-*/=".into(), ..brackets() }),
        lines: Lines {
            opening: "%\nO{{ number }}".into(),
            note_without_tool: "no tool length is taken up: zero Z with this tool".into(),
            header: "{{ units }}\nG17 G40 G80 G90 G94".into(),
            retract: "G91 G28 Z0.0\nG90".into(),
            tool_change: "T{{ tool }} M6".into(),
            tool_length: "G43 H{{ tool }}".into(),
            dwell: "G4 P{{ milliseconds }}".into(),
            footer: "G91 G28 Z0.0\nG90\nM30".into(),
            closing: "%".into(),
            ..iso.lines
        },
        rejects: "G49 G64".into(),
        ..iso
    }
}

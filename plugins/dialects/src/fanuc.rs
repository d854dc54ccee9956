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

//! Siemens Sinumerik 840D, 840D sl, 828D and One, in their own language.
//!
//! * Units by `G710` and `G700`, which switch feeds too; by `G71` and `G70` an F would stay in the
//!   units that the machine was built in, 25.4 times too fast or too slow.
//! * `G4 F` waits for seconds.
//! * T, then M6, then D1, which takes up the tool's length. `TRAORI` is for five axes only.
//! * `CYCLE832` sets the path tolerance: finishing (1), and 1 for no tolerance of orientation, which
//!   must not be left out. M30 takes it back.
//! * `G80` is of its ISO mode, it is not said here. Comments go from `;` to the line's end.

use crate::block::Numbering;
use crate::comment::{CommentStyle, brackets};
use crate::iso6983;
use crate::lines::Lines;
use crate::rs274::{Rs274, Words};

/// Characters of a block on an 840D sl.
const LINE_LIMIT: u32 = 512;

/// T numbers go to 32,000.
const TOOL_LIMIT: u32 = 32_000;

/// Block numbers have eight digits.
const LAST_NUMBER: u32 = 99_999_999;

pub(crate) fn settings() -> Rs274 {
    let iso = iso6983::settings();
    Rs274 {
        name: "siemens".into(),
        about: "Siemens Sinumerik 840D, 828D and One".into(),
        extension: "mpf".into(),
        tool_limit: Some(TOOL_LIMIT),
        line_limit: LINE_LIMIT,
        numbering: Some(Numbering { prefix: "N".into(), first: 10, step: 10, last: LAST_NUMBER }),
        comments: Some(CommentStyle { open: "; ".into(), close: "".into(), ..brackets() }),
        words: Words { mm: "G710".into(), inch: "G700".into(), ..iso.words },
        lines: Lines {
            opening: "; %_N_{{ name }}_MPF".into(),
            header: "G17 {{ units }} G40 G90 G94".into(),
            path_tolerance: "CYCLE832({{ tolerance }},1,1)".into(),
            tool_change: "T{{ tool }}\nM6\nD1".into(),
            dwell: "G4 F{{ seconds }}".into(),
            ..iso.lines
        },
        rejects: "G20 G21 G43 G49 G80 H".into(),
        ..iso
    }
}

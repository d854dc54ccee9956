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
use crate::comment::{BRACKETS, CommentStyle};
use crate::front::{Abilities, Tools};
use crate::iso6983::ISO;
use crate::rs274::{PathTolerance, Rs274, Words};

/// Characters of a block on an 840D sl.
const LINE_LIMIT: usize = 512;

/// T numbers go to 32,000.
const TOOL_LIMIT: u32 = 32_000;

pub(crate) const SIEMENS: Rs274 = Rs274 {
    name: "siemens",
    about: "Siemens Sinumerik 840D, 828D and One",
    extension: "mpf",
    abilities: Abilities { tools: Tools::UpTo(TOOL_LIMIT), ..ISO.abilities },
    line_limit: LINE_LIMIT,
    numbering: Some(Numbering { prefix: "N", first: 10, step: 10 }),
    comments: CommentStyle { open: "; ", close: "", ..BRACKETS },
    opening: &["; %_N_{name}_MPF"],
    head: &["G17 {units} G40 G90 G94"],
    path_tolerance: PathTolerance::IfGiven("CYCLE832({tolerance},1,1)"),
    tool_change: &["T{tool}", "M6", "D1"],
    words: Words { mm: "G710", inch: "G700", dwell: "G4 F{seconds}", ..ISO.words },
    rejects: &["G20", "G21", "G43", "G49", "G80", "H"],
    ..ISO
};

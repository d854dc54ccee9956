//! LinuxCNC 2.8 and later.
//!
//! Source: its `interp_convert.cc`, `interp_arc.cc` and the G-code pages of its manual. Without a
//! `G64 P` it rounds corners as far as it likes to keep its speed, so a relief loses its detail:
//! the path tolerance is always given, as `P` (how far blending may leave the path) and as `Q` (how
//! far points may lie from a line they are merged into), which may add up.
//!
//! The head holds no `G49`: an operator who has touched off with a tool's length in force would find
//! the tip that much lower. A tool change takes up the new length by `G43`. A program ends by `M2`;
//! there is no `%`, which is an error unless there are two. `N` is discouraged.
//!
//! Comments can be orders: `(LOGOPEN,file)` writes a file, `(py,...)` runs Python. See
//! [`crate::comment`] for what keeps a recipe's title from being one.

use crate::iso6983;
use crate::lines::Lines;
use crate::rs274::Rs274;

/// `LINELEN` in its `config.h`.
const LINE_LIMIT: u32 = 255;

/// A tool table holds numbers up to here.
const TOOL_LIMIT: u32 = 99_999;

pub(crate) fn settings() -> Rs274 {
    let iso = iso6983::settings();
    Rs274 {
        name: "linuxcnc".into(),
        about: "LinuxCNC 2.8 and later".into(),
        extension: "ngc".into(),
        tool_limit: Some(TOOL_LIMIT),
        line_limit: LINE_LIMIT,
        lines: Lines {
            header: "G17 {{ units }} G40 G80 G90 G94 G91.1".into(),
            path_tolerance: "G64 P{{ tolerance }} Q{{ tolerance }}".into(),
            tool_change: "T{{ tool }} M6\nG43".into(),
            footer: "M2".into(),
            ..iso.lines
        },
        needs_path_tolerance: true,
        rejects: "% N G49".into(),
        ..iso
    }
}

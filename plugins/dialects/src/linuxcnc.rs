//! LinuxCNC 2.8 and later.
//!
//! Source: its `interp_convert.cc`, `interp_arc.cc` and the G-code pages of its manual. Without a
//! `G64 P` it rounds corners as far as it likes to keep its speed, so a relief loses its detail:
//! the path tolerance is always given, as `P` (how far blending may leave the path) and as `Q` (how
//! far points may lie from a line they are merged into), which may add up.
//!
//! The head holds no `G49`: an operator who has touched off with a tool's length in force would find
//! the tip that much lower. A tool change takes up the new length by `G43`.
//!
//! Comments can be orders: `(LOGOPEN,file)` writes a file, `(py,...)` runs Python. See
//! [`crate::comment`] for what keeps a recipe's title from being one.

use crate::rs274::{ISO, Rs274, ToolChange};

/// `LINELEN` in its `config.h`.
const LINE_LIMIT: usize = 255;

/// A tool table holds numbers up to here.
const TOOL_LIMIT: u32 = 99_999;

/// A dwell is a plain float there; an hour is a slip of the pen.
const DWELL_LIMIT_S: f64 = 3600.0;

pub(crate) const LINUXCNC: Rs274 = Rs274 {
    name: "linuxcnc",
    about: "LinuxCNC 2.8 and later",
    extension: "ngc",
    line_limit: LINE_LIMIT,
    modes: "G40 G80 G90 G94 G91.1",
    path_tolerance: true,
    tool_change: ToolChange::M6 { limit: TOOL_LIMIT },
    dwell_limit_s: DWELL_LIMIT_S,
    end: "M2",
    ..ISO
};

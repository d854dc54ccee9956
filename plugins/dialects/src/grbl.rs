//! GRBL 1.1, the controller of most hobby machines.
//!
//! Source: gnea/grbl, `gcode.c` (the words it accepts), `protocol.c` (lines and comments),
//! `nuts_bolts.c` (dwell). It has no tool change, no tool table and no `G64`; it blends by its own
//! junction deviation. It takes `!`, `?`, `~` and bytes above 127 out of the stream and acts on
//! them wherever they stand, even inside a comment. A `%` is an error.

use crate::iso6983;
use crate::rs274::Rs274;

/// Seconds from M3 to cutting. GRBL does not wait for the spindle, and the routers and small
/// spindles its machines carry need two to three seconds to full speed.
pub(crate) const SPIN_UP_S: f64 = 3.0;

/// `delay_sec` counts steps of 50 ms in 16 bits.
const DWELL_LIMIT_S: f64 = 3276.0;

/// `LINE_BUFFER_SIZE` is 80, one of which ends the string.
const LINE_LIMIT: u32 = 79;

pub(crate) fn settings() -> Rs274 {
    Rs274 {
        name: "grbl".into(),
        about: "GRBL 1.1: hobby routers with an Arduino or 32-bit board".into(),
        tool_limit: None,
        tool_refusal: "has no tool change (M6)".into(),
        spin_up_s: Some(SPIN_UP_S),
        dwell_limit_s: DWELL_LIMIT_S,
        line_limit: LINE_LIMIT,
        rejects: "A B C D H Q % G43 G64 G90.1 M6".into(),
        ..iso6983::settings()
    }
}

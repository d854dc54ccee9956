//! From the program's text back to what a machine makes of it.

mod follow;
mod load_gcode;
mod read;
mod read_gcode;
mod simulate;
mod verify;

pub(crate) use load_gcode::LoadGcode;
pub(crate) use read_gcode::ReadGcode;
pub(crate) use simulate::{Simulate, Simulated};
pub(crate) use verify::{Verification, Verify};

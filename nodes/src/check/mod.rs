//! From the program's text back to what a machine makes of it.

mod deviation;
mod deviation_map;
mod estimate;
mod estimate_time;
mod follow;
mod load_gcode;
mod read;
mod read_gcode;
mod scallop_plot;
mod simulate;
mod verify;

pub(crate) use deviation::DeviationNode;
pub(crate) use deviation_map::DeviationMap;
pub use estimate::{Estimate, RunTimes};
pub(crate) use estimate_time::EstimateTime;
pub(crate) use load_gcode::LoadGcode;
pub(crate) use read_gcode::ReadGcode;
pub(crate) use scallop_plot::ScallopPlot;
pub(crate) use simulate::{Simulate, Simulated};
pub(crate) use verify::{Verification, Verify};

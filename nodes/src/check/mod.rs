//! From the program's text back to what a machine makes of it.

mod estimate;
mod estimate_time;

pub use estimate::{Estimate, RunTimes};
pub(crate) use estimate_time::EstimateTime;

//! Kernels on reliefs: surfaces with one height a node that are reshaped, not yet cut.

mod bas_relief;
mod blur;
mod poisson;
mod slope;

pub use bas_relief::{BasRelief, bas_relief};
pub use slope::{SlopeLimit, limit_slope};

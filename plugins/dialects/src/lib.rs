//! The standard G-code dialects.
//!
//! One core, `rs274`, writes all of them; `grbl` and `linuxcnc` hold only what their controllers
//! do differently.

mod arc;
mod block;
mod comment;
mod grbl;
mod linuxcnc;
mod number;
mod rs274;

use carvegraph_sdk::Dialect;

/// All of them, sorted by name.
#[must_use]
pub fn standard() -> Vec<Box<dyn Dialect>> {
    vec![Box::new(grbl::GRBL), Box::new(linuxcnc::LINUXCNC)]
}

//! The traits a cutter shape or a G-code dialect implements.
//!
//! A plugin offers [`CutterShape`]s and [`Dialect`]s; nodes call them without knowing which plugin
//! they come from. The traits are object safe, free of generics, and hand over only slices, plain
//! structs and sinks, so that a C layout can carry each call.

#[cfg(feature = "conformance")]
pub mod conformance;
mod cutter;
mod dialect;
mod program;

pub use carvegraph_geometry::{Profile, ProfileError, Segment};
pub use cutter::{CutterError, CutterShape, DimensionSpec, DimensionUnit, Dimensions};
pub use dialect::{Capabilities, Dialect, PostError};
pub use program::{Arc, Command, Direction, Plane, Program, Stock, Units};

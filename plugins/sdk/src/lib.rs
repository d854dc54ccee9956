//! What a plugin is written with: the traits of cutter shapes, G-code dialects and nodes.
//!
//! A plugin offers [`CutterShape`]s and [`Dialect`]s; nodes call them without knowing which plugin
//! they come from. The traits are object safe, free of generics, and hand over only slices, plain
//! structs and sinks, so that a C layout can carry each call.

#[cfg(feature = "conformance")]
pub mod conformance;
mod cutter;
mod dialect;
pub mod export;
pub mod node;
mod program;
pub mod value;

pub use carvegraph_geometry::{Profile, ProfileError, Segment};
pub use cutter::{CutterError, CutterShape, DimensionSpec, DimensionUnit, Dimensions};
pub use dialect::{Capabilities, Dialect, PostError};
pub use node::Node;
pub use program::{Arc, Command, Direction, Plane, Program, Stock, Units};

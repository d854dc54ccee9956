//! The standard nodes, one file a step, in folders by stage.
//!
//! Adding a node: write its file, name it in its folder's `mod.rs` and on the list in
//! `registry.rs`. Everything else (its help, its checks, its place in the reference) is read off
//! its definition.

mod assemble;
mod check;
mod job;
mod library;
mod machining;
mod mask;
mod offers;
mod output;
mod path;
mod picture;
mod plugin;
mod registry;
mod relief;
mod services;
mod shop;
mod surface;
#[cfg(test)]
mod testing;
mod values;

pub use assemble::registry;
pub use carvegraph_sdk::{CutterShape, Dialect};
pub use check::{Estimate, RunTimes};
pub use job::{Drive, Job, Operation};
pub use library::LIBRARY;
pub use machining::{Machining, TextFault, ToolRun};
pub use offers::{Batch, OfferError, Offers};
pub use plugin::{PluginNodeError, kind_of};
pub use services::{Cutters, Dialects};
pub use shop::{
    Conditions, Machine, Machines, NONE, SetBy, Setup, SpindleRange, Tool, ToolChange, ToolSheet,
    Tools, Travel,
};
pub use values::{Channels, Gcode, GrayImage, Image, Mask, ProgramText, Remark, Samples, ToolUse};

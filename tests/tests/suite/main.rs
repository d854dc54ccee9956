//! Carvegraph from the outside: what the command, the recipes and the programs do for a user.
//!
//! One binary, so that there is one thing to link. Each file holds what belongs to one promise of
//! the design; `bench.rs` holds what all of them need: a folder to work in and the command to call.

#![allow(clippy::unwrap_used, reason = "a helper that fails fails its test")]

mod arcs;
mod bench;
mod cache;
mod commands;
mod drop_heights;
mod gcode;
mod golden;
mod houses;
mod interrupt;
mod kinds;
mod machines;
mod plugins;
mod portraits;
mod prepared_pictures;
mod program;
mod real_pictures;
mod real_surfaces;
mod recipes;
mod refusals;
mod relief;
mod reliefs;
mod report;
mod sample;
mod surfaces;
mod threads;
mod tutorial;
mod two_tools;
mod verify;

//! The engine from outside, with nodes that do next to nothing.

#![allow(clippy::unwrap_used)] // in what tests call, too

mod cache;
mod check;
mod entries;
mod files;
mod form;
mod inner;
mod made;
mod missing;
mod outputs;
mod plan;
mod registry;
mod run;
mod toy;
mod yielding;

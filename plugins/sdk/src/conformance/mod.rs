//! Tests that any plugin can call on its cutters and dialects: they hold what is offered against what
//! the traits promise, and panic with what is wrong.
//!
//! Add `carvegraph-sdk = { ..., features = ["conformance"] }` to the plugin's `[dev-dependencies]`.

pub mod cutter;
pub mod dialect;

//! Tests that any plugin can call on its cutters and dialects: they hold what is offered against what
//! the traits promise, and panic with what is wrong.
//!
//! Add `carvegraph-sdk = { ..., features = ["conformance"] }` to the plugin's `[dev-dependencies]`.

pub mod cutter;
pub mod dialect;

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::PathBuf;

/// Where cargo puts the library (`crate-type = ["cdylib", "rlib"]`) of a test's dev-dependency: beside
/// the test. `name` is the crate's, with `_` for `-`.
///
/// # Panics
/// If the system does not say where the test is.
#[must_use]
pub fn built_library(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("a running program has a file");
    test.with_file_name(format!("{DLL_PREFIX}{name}{DLL_SUFFIX}"))
}

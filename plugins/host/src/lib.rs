//! Finds, checks and loads plugins.
//!
//! [`discover()`] looks into plugin folders; [`Candidate::load`] lets a child process try a library and
//! then loads it for good. What comes out are the sdk's own traits, whether the plugin is in a library or
//! [linked]. What a plugin gives is checked before it is believed; what it can't do is harm others: a
//! panic, a refusal, a crash at load or output without end are messages.
//!
//! Limits: a library runs with the user's rights. A crash in the middle of a job (a memory fault, a
//! stack overflow, `abort`) ends `carve`, and an endless loop that calls nothing of the host's only ends
//! by Ctrl-C.

#![allow(unsafe_code, reason = "this is the boundary to libraries")]

mod borrow;
mod candidate;
mod cutter;
mod dialect;
mod discover;
mod folders;
mod library;
mod manifest;
mod message;
mod node;
mod probe;
mod watch;

pub use borrow::Given;
pub use carvegraph_abi::{MAJOR as ABI_MAJOR, MINOR as ABI_MINOR};
pub use discover::{Candidate, Discovered, Fault, discover};
pub use folders::user_folder;
pub use library::{LoadError, Plugin, linked, load};
pub use manifest::{MANIFEST, Manifest, Offered};
pub use probe::{Probed, examine, probe};

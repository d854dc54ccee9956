//! What the nodes' own tests share.

use carvegraph_core::{Catalogs, Context, with_context};

/// Calls `work` with a context that knows no catalogs.
pub(crate) fn run<T>(work: impl FnOnce(&Context<'_>) -> T) -> T {
    with_context(&Catalogs::default(), work)
}

//! The standard cutters as a shared library, made of the same entry that `carve` links.

carvegraph_sdk::export!(type carvegraph_cutters::Standard);

//! The standard dialects as a shared library, made of the same entry that `carve` links.

carvegraph_sdk::export!(type carvegraph_dialects::Standard);

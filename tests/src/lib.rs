//! End-to-end tests of Carvegraph; see `tests/`.

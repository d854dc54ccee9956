//! The recipes that are part of the program.

use carvegraph_core::Library;

/// The standard recipes, sorted by name, and the sample that they carve where nothing else is said.
pub const LIBRARY: Library = Library {
    recipes: &[("relief", include_str!("../../graphs/relief.ron"))],
    assets: &[("samples/medallion.png", include_bytes!("../../graphs/samples/medallion.png"))],
};

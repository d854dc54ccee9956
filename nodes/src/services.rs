//! What nodes ask their context for: the cutter shapes and dialects that there are, by name.

use carvegraph_sdk::{CutterShape, Dialect};

/// The cutter shapes that the program knows.
pub struct Cutters(pub Vec<Box<dyn CutterShape>>);

/// The dialects that the program knows.
pub struct Dialects(pub Vec<Box<dyn Dialect>>);

impl Cutters {
    /// The shape called `name`.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&dyn CutterShape> {
        self.0.iter().find(|shape| shape.name() == name).map(AsRef::as_ref)
    }
}

impl Dialects {
    /// The dialect called `name`.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&dyn Dialect> {
        self.0.iter().find(|dialect| dialect.name() == name).map(AsRef::as_ref)
    }
}

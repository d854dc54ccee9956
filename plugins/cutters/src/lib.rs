//! The standard cutter shapes.

mod ball;
mod flat;

use carvegraph_sdk::CutterShape;

/// All of them, sorted by name.
#[must_use]
pub fn standard() -> Vec<Box<dyn CutterShape>> {
    vec![Box::new(ball::Ball), Box::new(flat::Flat)]
}

//! The standard cutter shapes.

mod ball;
mod bull_nose;
mod cone;
mod drawing;
mod flat;
mod form;
mod tapered_ball;
mod v_bit;

use carvegraph_sdk::CutterShape;

/// Radii and flats below this, in mm, are taken as none: a nanometre cannot be told from a sharp
/// edge, and arcs smaller still would lose their digits beside the cutter's radius.
const SHARP_MM: f64 = 1e-6;

/// All of them, sorted by name.
#[must_use]
pub fn standard() -> Vec<Box<dyn CutterShape>> {
    vec![
        Box::new(ball::Ball),
        Box::new(bull_nose::BullNose),
        Box::new(flat::Flat),
        Box::new(form::Form),
        Box::new(tapered_ball::TaperedBall),
        Box::new(v_bit::VBit),
    ]
}

carvegraph_sdk::plugin!(
    /// The standard shapes as a plugin like anybody's: `carve` links it, and `shared` beside this
    /// crate exports it from a library.
    Standard,
    carvegraph_sdk::export::Offers::new().cutters(standard())
);

//! The unit that a file's numbers are in.

use carvegraph_core::{Choice, NodeError};
use carvegraph_geometry::Bounds;

/// Beyond this no coordinate is taken: a thousand times around the earth, in mm, is a damaged file.
const MAX_REACH_MM: f64 = 4e13;

/// A part smaller or larger than this was probably saved in another unit.
const USUAL_MM: std::ops::Range<f64> = 1.0..10_000.0;

/// What a file's numbers count.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Unit {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
    /// Inches.
    Inch,
}

impl Unit {
    /// Its length in mm.
    pub(super) fn mm(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Cm => 10.0,
            Self::M => 1000.0,
            Self::Inch => 25.4,
        }
    }
}

/// Refuses coordinates that are none.
pub(super) fn check_reach(bounds: &Bounds) -> Result<(), NodeError> {
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    match reach <= MAX_REACH_MM {
        true => Ok(()),
        false => Err(NodeError::Failed(format!(
            "a coordinate of {reach:e} mm is beyond the limit of {MAX_REACH_MM:e} mm: the file is \
             damaged, or its unit wrong"
        ))),
    }
}

/// "89.40 × 129.10 × 59.40 mm".
pub(super) fn size_text(bounds: &Bounds) -> String {
    let size = bounds.size();
    format!("{:.2} × {:.2} × {:.2} mm", size.x, size.y, size.z)
}

/// What to ask a user whose part has an unusual size.
pub(super) fn doubt(bounds: &Bounds) -> Option<String> {
    let size = bounds.size().max_element();
    (!USUAL_MM.contains(&size)).then(|| {
        format!(
            "the part measures {}: is its unit right (unit: mm, cm, m, inch)?",
            size_text(bounds)
        )
    })
}

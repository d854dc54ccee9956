//! Where a cutter is to be dropped: lines over the XY plane.

use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A run of points that the cutter visits in order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatternSpan {
    /// Indices into [`Pattern::points`]; never empty.
    pub points: Range<usize>,
    /// Whether this only joins one pass to the next (true) or is a pass itself (false).
    pub link: bool,
    /// Whether the cutter comes to the first point along the surface from the last point of the
    /// span before; if not it retracts, travels and plunges.
    pub joined: bool,
}

/// A plan view of a tool path: passes and the links between them, in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pattern {
    /// All points in the order they are visited.
    pub points: Vec<DVec2>,
    /// The runs they make up, in order, without gaps.
    pub spans: Vec<PatternSpan>,
}

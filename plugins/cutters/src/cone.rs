//! A tip and a straight flank: V-bits and tapered balls.
//!
//! | symbol | meaning |
//! |---|---|
//! | α | angle of the flank to the cutter's axis, half the included angle |
//! | ρ | radius of a rounded tip |
//!
//! A ball of radius ρ whose lowest point is the tip has its centre at (0, ρ). The flank touches it
//! where the ball's radius is square to it: r = ρ·cos α, h = ρ·(1 - sin α).

use carvegraph_sdk::{Profile, ProfileError, Segment};

/// How a cone ends.
#[derive(Clone, Copy)]
pub(crate) enum Tip {
    /// In a point.
    Sharp,
    /// In a disc of this radius, in mm, above 0.
    Flat(f64),
    /// In a ball of this radius ρ, in mm, above 0, tangent to the flank.
    Round(f64),
}

impl Tip {
    /// Where the flank at `half_angle_rad` (α) to the axis starts: (r, h) in mm.
    pub(crate) fn flank_start(self, half_angle_rad: f64) -> [f64; 2] {
        let (sin, cos) = half_angle_rad.sin_cos();
        match self {
            Self::Sharp => [0.0; 2],
            Self::Flat(radius) => [radius, 0.0],
            Self::Round(radius) => [radius * cos, radius * (1.0 - sin)],
        }
    }
}

/// The profile of a cone out to `radius_mm`, which lies beyond the start of the flank.
pub(crate) fn cone(tip: Tip, half_angle_rad: f64, radius_mm: f64) -> Result<Profile, ProfileError> {
    let start = tip.flank_start(half_angle_rad);
    let height = start[1] + (radius_mm - start[0]) / half_angle_rad.tan();
    let flank = Segment::Line { to: [radius_mm, height] };
    Profile::new(match tip {
        Tip::Sharp => vec![flank],
        Tip::Flat(_) => vec![Segment::Line { to: start }, flank],
        Tip::Round(radius) => vec![Segment::Arc { to: start, center: [0.0, radius] }, flank],
    })
}

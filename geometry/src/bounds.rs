//! An axis-aligned box.

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// An axis-aligned box in mm, `min` ≤ `max` on every axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// The corner with the least coordinates.
    pub min: DVec3,
    /// The corner with the greatest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// The box that just holds some points; `None` if there are none.
    #[must_use]
    pub fn of(points: impl ParallelIterator<Item = DVec3>) -> Option<Self> {
        let nothing = || (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (min, max) = points
            .fold(nothing, |(min, max), point| (min.min(point), max.max(point)))
            .reduce(nothing, |a, b| (a.0.min(b.0), a.1.max(b.1)));
        (min.x <= max.x).then_some(Self { min, max })
    }

    /// Length of the box along each axis, in mm.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The middle of the box.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        (self.min + self.max) / 2.0
    }
}

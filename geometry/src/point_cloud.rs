//! Points in space, in an order or none.

use crate::Bounds;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Points in mm. An *ordered* cloud lists the nodes of a grid row by row, x fastest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointCloud {
    /// The points; shared, so that a mesh over the same points holds no copy.
    pub points: Arc<Vec<DVec3>>,
    /// Columns and rows of an ordered cloud; their product is the number of points.
    pub grid: Option<(usize, usize)>,
}

impl PointCloud {
    /// The box that just holds the points, in mm; `None` if there are none.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of(self.points.par_iter().copied())
    }
}

//! Outlines over the XY plane, and what is made of them: unions, intersections, differences, offsets.
//!
//! Inside is what an odd number of loops surround (even-odd rule), so that a loop within a loop is a
//! hole, whichever way either is wound. Loops may cross themselves and each other, touch and repeat.
//! What the operations here make is *clean*: no loop crosses another, outlines are counter-clockwise
//! and holes clockwise, so that the inside lies to the left of every edge.

mod boolean;
mod coverage;
mod offset;
mod simplify;
#[cfg(test)]
mod tests;

pub use boolean::Filling;
pub use offset::offset;
pub(crate) use offset::offset_clean;
pub use simplify::simplify_loop;
pub(crate) use simplify::{nearest_on, simplify_line};
#[cfg(test)]
pub(crate) use {simplify::distance, tests::nasty};

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// More corners than any drawing of an outline needs; checks and cuts stay fast.
const MAX_CORNERS: usize = 100_000;

/// No corner lies farther from the origin along x or y: 1000 km. Squares and products of such lengths
/// are far from where numbers end.
const MAX_REACH_MM: f64 = 1e9;

/// Closed loops over the XY plane; inside is what an odd number of them surround.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Vec<DVec2>>", into = "Vec<Vec<DVec2>>")]
pub struct Polygon {
    loops: Vec<Vec<DVec2>>,
}

/// Why loops are no polygon.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum PolygonError {
    /// There is no loop.
    #[error("there is no loop")]
    Empty,
    /// A loop of less than three corners.
    #[error("loop {loop_number} has {corners} corners; the least is 3")]
    TooFewCorners {
        /// Which loop, from 1.
        loop_number: usize,
        /// How many it has.
        corners: usize,
    },
    /// A coordinate that is not a number.
    #[error("loop {loop_number} has a corner that is not finite")]
    NotFinite {
        /// Which loop, from 1.
        loop_number: usize,
    },
    /// A coordinate beyond what can be computed with.
    #[error("loop {loop_number} has a corner farther than {MAX_REACH_MM:.0e} mm from the origin")]
    TooFar {
        /// Which loop, from 1.
        loop_number: usize,
    },
    /// More than can be handled in time.
    #[error("there are {corners} corners; the limit is {MAX_CORNERS}")]
    TooManyCorners {
        /// How many there are.
        corners: usize,
    },
}

impl TryFrom<Vec<Vec<DVec2>>> for Polygon {
    type Error = PolygonError;

    fn try_from(loops: Vec<Vec<DVec2>>) -> Result<Self, PolygonError> {
        Self::new(loops)
    }
}

impl From<Polygon> for Vec<Vec<DVec2>> {
    fn from(polygon: Polygon) -> Self {
        polygon.loops
    }
}

impl Polygon {
    /// A polygon of loops, each the list of its corners; the last is joined to the first.
    ///
    /// # Errors
    /// If there is no loop, one of less than three corners, a coordinate that is not finite or farther
    /// than the limit, or more corners than the limit.
    pub fn new(loops: Vec<Vec<DVec2>>) -> Result<Self, PolygonError> {
        if loops.is_empty() {
            return Err(PolygonError::Empty);
        }
        for (corners, loop_number) in loops.iter().zip(1..) {
            if corners.len() < 3 {
                return Err(PolygonError::TooFewCorners { loop_number, corners: corners.len() });
            }
            if !corners.iter().all(|corner| corner.is_finite()) {
                return Err(PolygonError::NotFinite { loop_number });
            }
            if corners.iter().any(|corner| corner.abs().max_element() > MAX_REACH_MM) {
                return Err(PolygonError::TooFar { loop_number });
            }
        }
        Self { loops }.within_limit()
    }

    /// The rectangle between two corners, `min` ≤ `max`.
    ///
    /// # Errors
    /// If a coordinate is not finite or farther than the limit.
    pub fn rectangle(min: DVec2, max: DVec2) -> Result<Self, PolygonError> {
        Self::new(vec![vec![min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]])
    }

    /// Itself, unless it has more corners than [`Self::new`] takes: what is computed of polygons may
    /// have more, but is not handed on then.
    ///
    /// # Errors
    /// If there are more corners than the limit.
    pub fn within_limit(self) -> Result<Self, PolygonError> {
        let corners = self.corners();
        if corners > MAX_CORNERS { Err(PolygonError::TooManyCorners { corners }) } else { Ok(self) }
    }

    /// The loops, each the list of its corners.
    #[must_use]
    pub fn loops(&self) -> &[Vec<DVec2>] {
        &self.loops
    }

    /// How many corners all loops have.
    #[must_use]
    pub fn corners(&self) -> usize {
        self.loops.iter().map(Vec::len).sum()
    }

    /// The area that loops wound counter-clockwise surround less that of those wound clockwise, in
    /// mm²; of a clean polygon that of its inside.
    #[must_use]
    pub fn area_mm2(&self) -> f64 {
        // About a corner, so that a small loop far away keeps its digits.
        let twice = |corners: &Vec<DVec2>| -> f64 {
            let from = corners[0];
            corners.windows(2).map(|edge| (edge[0] - from).perp_dot(edge[1] - from)).sum()
        };
        self.loops.iter().map(twice).sum::<f64>() / 2.0
    }

    /// Lets each loop begin at another of its corners, the one that `at` tells of them.
    pub(crate) fn begin_loops(&mut self, mut at: impl FnMut(&[DVec2]) -> usize) {
        for corners in &mut self.loops {
            let first = at(corners);
            corners.rotate_left(first);
        }
    }

    pub(crate) fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.loops.iter().flat_map(|corners| {
            let next = corners.iter().cycle().skip(1);
            corners.iter().zip(next).map(|(a, b)| [*a, *b])
        })
    }

    /// The corners of the rectangle that just holds it.
    pub(crate) fn extent(&self) -> (DVec2, DVec2) {
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        self.loops.iter().flatten().fold(start, |(min, max), p| (min.min(*p), max.max(*p)))
    }
}

//! Runs of a span that lie in one of the planes that arcs may lie in.

use crate::{Direction, PathArc, Plane};
use glam::{DVec2, DVec3};
use std::ops::Range;

/// Points this far off a plane lie in it, in mm: a thousand times the rounding of a coordinate of a metre, a
/// thousandth of the finest step of a controller.
const OFF_PLANE_MM: f64 = 1e-9;

/// A run in a plane breaks a span that goes on otherwise only if it has as many points: an end of a run is a
/// point that is kept, and a short run repays none.
const LEAST_POINTS: usize = 8;

/// A plane that holds a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sheet {
    /// Of a pass along X or Y: u is the way along it, v the height.
    Upright {
        /// Index of the axis along which it runs.
        axis: usize,
        /// Whether towards greater coordinates.
        rising: bool,
    },
    /// Level: u is x, v is y.
    Level,
}

impl Sheet {
    /// A point as (u, v).
    pub(super) fn flat(self, tip: DVec3) -> DVec2 {
        match self {
            Self::Upright { axis, rising } => {
                DVec2::new(if rising { tip[axis] } else { -tip[axis] }, tip.z)
            }
            Self::Level => tip.truncate(),
        }
    }

    /// The arc about a centre in (u, v), for the shorter way between two points.
    pub(super) fn arc(self, center: DVec2, from: DVec3, to: DVec3) -> PathArc {
        let (plane, center) = match self {
            Self::Level => (Plane::Xy, center.extend(from.z)),
            Self::Upright { axis, rising } => {
                let mut point = from.with_z(center.y);
                point[axis] = if rising { center.x } else { -center.x };
                (if axis == 0 { Plane::Zx } else { Plane::Yz }, point)
            }
        };
        let [first, second, _] = plane.axes();
        let in_plane =
            |tip: DVec3| DVec2::new(tip[first] - center[first], tip[second] - center[second]);
        let direction = match in_plane(from).perp_dot(in_plane(to)) > 0.0 {
            true => Direction::CounterClockwise,
            false => Direction::Clockwise,
        };
        PathArc { plane, direction, center }
    }

    /// The last point of the run in this plane that begins at `start`.
    fn end_of_run(self, tips: &[DVec3], start: usize) -> usize {
        let origin = tips[start];
        let goes_on = |pair: &[DVec3]| match self {
            Self::Level => {
                (pair[1].z - origin.z).abs() <= OFF_PLANE_MM
                    && pair[0].truncate() != pair[1].truncate()
            }
            Self::Upright { axis, rising } => {
                let aside = 1 - axis;
                (pair[1][aside] - origin[aside]).abs() <= OFF_PLANE_MM
                    && pair[0][axis] != pair[1][axis]
                    && (pair[0][axis] < pair[1][axis]) == rising
            }
        };
        start + tips[start..].windows(2).take_while(|pair| goes_on(pair)).count()
    }
}

/// A part of a span. The first point of each is the last of the one before.
pub(super) struct Run {
    /// Indices of its points, the last included.
    pub(super) points: Range<usize>,
    /// The plane that holds it; `None` where arcs cannot follow.
    pub(super) sheet: Option<Sheet>,
}

/// Cuts a span into runs: those in a plane, the longest first found, and what is between them.
pub(super) fn runs(tips: &[DVec3]) -> Vec<Run> {
    let last = tips.len() - 1;
    let (mut runs, mut start, mut from) = (Vec::new(), 0, 0);
    while from < last {
        let (end, sheet) = longest(tips, from);
        let whole = from == 0 && end == last;
        if !whole && end - from + 1 < LEAST_POINTS {
            from += 1;
            continue;
        }
        if start < from {
            runs.push(Run { points: start..from + 1, sheet: None });
        }
        runs.push(Run { points: from..end + 1, sheet: Some(sheet) });
        (start, from) = (end, end);
    }
    if start < last {
        runs.push(Run { points: start..last + 1, sheet: None });
    }
    runs
}

/// The plane that holds most points from one on, and the last of them. A straight pass that is level too
/// counts as upright.
fn longest(tips: &[DVec3], from: usize) -> (usize, Sheet) {
    let along =
        |axis: usize| Sheet::Upright { axis, rising: tips[from][axis] < tips[from + 1][axis] };
    let mut best = (from, Sheet::Level);
    for sheet in [along(0), along(1), Sheet::Level] {
        let end = sheet.end_of_run(tips, from);
        if end > best.0 {
            best = (end, sheet);
        }
    }
    best
}

//! Growing and shrinking of polygons.
//!
//! Growing by r is the union of all discs of radius r about places inside (Minkowski sum), shrinking
//! takes away those about places outside. So corners are rounded where the boundary moves outwards of
//! them and stay sharp where it moves inwards, and what is narrower than 2r disappears.
//!
//! `i_overlay` moves every edge, puts arcs into the gaps, and counts windings. Its time goes with the
//! square of how many moved edges lie over each other, so a long way is gone in steps: growing by a and
//! then by b is growing by a + b. After each step, corners closer to a line than a share of the
//! tolerance are taken out. An outline of 100,000 corners is shrunk by 500 times their distance in some
//! two seconds instead of half a minute.
//!
//! Limits: the result lies within the tolerance of the exact one, on either side.

use super::boolean::{polygon, shapes};
use super::{Polygon, simplify_loop};
use i_overlay::mesh::float::outline::offset::OutlineOffset;
use i_overlay::mesh::float::style::{LineJoin, OutlineStyle};

/// No step is longer than this many times the mean length of an edge, unless twice the one before
/// is. Then few moved edges lie over each other, and steps are few.
const STEP_EDGES: f64 = 4.0;

/// What of the tolerance that is left a step may use up, unless it is the last. The first steps meet
/// most corners and are given most.
const SHARE: f64 = 0.3;

/// The least and greatest angle of a chord that the crate takes; finer arcs than the former (chords
/// 0.00012 of the radius off) are not to be had.
const ARC_STEPS_RAD: [f64; 2] = [0.01 * std::f64::consts::PI, 0.25 * std::f64::consts::PI];

/// The least tolerance, as a share of the offset: half of it for chords, which are 0.00012 off at best,
/// and without anything for corners they would double with every step.
const LEAST_TOLERANCE: f64 = 3e-4;

/// `polygon` grown by `by_mm`, or shrunk where that is negative; `None` if nothing is left, or if
/// `by_mm` is no length below 1000 km or `tolerance_mm` negative or no number.
///
/// The boundary of the result lies within `tolerance_mm` of the exact one, or 0.0003 of `by_mm` where
/// that is more. The result is clean ([`Polygon::clean`]) and may have more corners than
/// [`Polygon::new`] takes: see [`Polygon::within_limit`].
#[must_use]
pub fn offset(polygon: &Polygon, by_mm: f64, tolerance_mm: f64) -> Option<Polygon> {
    let is_length = by_mm.abs() <= super::MAX_REACH_MM && tolerance_mm >= 0.0;
    let clean = if is_length { polygon.clean()? } else { return None };
    offset_clean(clean, by_mm, tolerance_mm)
}

/// The same of a clean polygon.
pub(crate) fn offset_clean(clean: Polygon, by_mm: f64, tolerance_mm: f64) -> Option<Polygon> {
    let mut grown = clean;
    let mut tolerance_mm = tolerance_mm.max(LEAST_TOLERANCE * by_mm.abs());
    let (mut left_mm, mut last_mm) = (by_mm.abs(), 0.0);
    while left_mm > 0.0 {
        let length: f64 = grown.edges().map(|[a, b]| a.distance(b)).sum();
        let step_mm = (STEP_EDGES * length / grown.corners() as f64).max(2.0 * last_mm);
        // A last step that would be short is joined to the one before.
        let step_mm = if step_mm * 1.5 >= left_mm { left_mm } else { step_mm };
        let allowed_mm = if step_mm == left_mm { tolerance_mm } else { SHARE * tolerance_mm };
        // Coarser than that, a small part that has grown would be taken for a line.
        let allowed_mm = allowed_mm.min(step_mm / 10.0);
        grown = step(&grown, step_mm.copysign(by_mm), allowed_mm)?;
        tolerance_mm -= allowed_mm;
        (left_mm, last_mm) = (left_mm - step_mm, step_mm);
    }
    Some(grown)
}

/// One step of a clean polygon; the result is clean.
fn step(clean: &Polygon, by_mm: f64, tolerance_mm: f64) -> Option<Polygon> {
    // Half for chords of arcs, half for corners taken out. A chord of angle φ lies r(1 - cos φ/2) off.
    let half_mm = tolerance_mm / 2.0;
    let angle = 2.0 * (1.0 - half_mm / by_mm.abs()).clamp(-1.0, 1.0).acos();
    let angle = angle.clamp(ARC_STEPS_RAD[0], ARC_STEPS_RAD[1]);
    let style = OutlineStyle::new(by_mm).line_join(LineJoin::Round(angle));
    let moved = polygon(shapes(clean).outline_as::<i64>(&style))?;
    simplified(moved, half_mm)
}

/// Takes out corners and what became of loops that are lines then; clean again.
fn simplified(clean: Polygon, tolerance_mm: f64) -> Option<Polygon> {
    let before = clean.corners();
    let mut loops: Vec<_> =
        clean.loops.iter().map(|corners| simplify_loop(corners, tolerance_mm)).collect();
    loops.retain(|corners| corners.len() > 2);
    let simple = Polygon { loops };
    if simple.loops.is_empty() || simple.corners() == before {
        return (!simple.loops.is_empty()).then_some(clean);
    }
    simple.clean()
}

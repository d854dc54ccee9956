//! Points evenly spaced on straight and round lines.

use super::Pace;
use glam::DVec2;
use std::f64::consts::{FRAC_PI_3, TAU};

/// Relative slack when counting whole steps: 3.0 / 0.3 is ten of them, though the quotient of the
/// rounded numbers may fall just short.
pub(crate) const STEP_SLACK: f64 = 1e-9;

/// How many equal steps, none longer than `step`, a length takes; one at least.
pub(crate) fn parts(length: f64, step: f64) -> f64 {
    (length / step * (1.0 - STEP_SLACK)).ceil().max(1.0)
}

/// The points strictly between two places that cut their distance into equal steps.
pub(crate) fn between(from: DVec2, to: DVec2, step: f64) -> impl Iterator<Item = DVec2> {
    let parts = parts(from.distance(to), step) as usize;
    (1..parts).map(move |k| from.lerp(to, k as f64 / parts as f64))
}

/// Points on the lines from corner to corner, corners included, evenly spaced between them.
pub(crate) fn along(corners: &[DVec2], step: f64) -> impl Iterator<Item = DVec2> {
    let sides = corners.windows(2);
    corners.first().copied().into_iter().chain(
        sides.flat_map(move |side| between(side[0], side[1], step).chain(std::iter::once(side[1]))),
    )
}

/// The angle between neighbouring points on a circle: as long an arc as the feed step, unless its
/// chord would lie too far off it. A sixth of a turn at most, so that a small circle is still one.
pub(super) fn angle_step(radius_mm: f64, pace: Pace) -> f64 {
    let flat = 2.0 * (1.0 - pace.sagitta_mm() / radius_mm).max(0.5).acos();
    (pace.feed_step_mm / radius_mm).min(flat).min(FRAC_PI_3)
}

/// About how many points lie on circles or turns one stepover apart within a radius R.
///
/// Each ring of radius r has 2πr / min(f, √(8σr)) points, f the feed step, σ the sagitta (chord
/// c = √(8σr) to first order); the rings are 1/s to the mm. Integrated from 0 to R, with
/// r* = f²/8σ where the two bounds meet.
pub(super) fn points_on_disc(radius_mm: f64, pace: Pace) -> f64 {
    let Pace { stepover_mm: s, feed_step_mm: f } = pace;
    let sigma = pace.sagitta_mm();
    let near = (f * f / (8.0 * sigma)).min(radius_mm);
    let near_points = TAU / s * near.powf(1.5) / 1.5 / (8.0 * sigma).sqrt();
    let far_points = TAU / s * (radius_mm * radius_mm - near * near) / (2.0 * f);
    near_points + far_points + 6.0 * (radius_mm / s).min(1.0)
}

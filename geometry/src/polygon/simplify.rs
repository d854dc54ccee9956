//! Fewer corners for the same loop.
//!
//! Douglas and Peucker, "Algorithms for the reduction of the number of points required to represent a
//! digitized line", Cartographica 10(2), 1973: a run of corners is replaced by the line between its
//! ends if none lies farther from that line than the tolerance, else cut at the farthest. A loop is cut
//! first at its lowest corner (leftmost of equals) and at the one farthest from that, so that the
//! result does not depend on where the loop starts.
//!
//! Limits: loops that pass each other closer than the tolerance may cross afterwards.

use glam::DVec2;

/// The corners that are left of a closed loop; fewer than three where all lie within `tolerance_mm`
/// of a line.
#[must_use]
pub fn simplify_loop(corners: &[DVec2], tolerance_mm: f64) -> Vec<DVec2> {
    let lower = |a: &usize, b: &usize| {
        let (p, q) = (corners[*a], corners[*b]);
        p.y.total_cmp(&q.y).then(p.x.total_cmp(&q.x))
    };
    let Some(first) = (0..corners.len()).min_by(lower) else { return Vec::new() };
    let mut line: Vec<DVec2> = corners[first..].iter().chain(&corners[..=first]).copied().collect();
    let far = |k: &usize| line[*k].distance_squared(line[0]);
    let farthest = (0..line.len()).max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0);
    let mut kept = vec![false; line.len()];
    (kept[0], kept[farthest]) = (true, true);
    keep(&line, tolerance_mm, &mut kept, 0, farthest);
    keep(&line, tolerance_mm, &mut kept, farthest, corners.len());
    // The last is the first.
    kept[corners.len()] = false;
    let mut kept = kept.into_iter();
    line.retain(|_| kept.next() == Some(true));
    line
}

/// The corners that are left of a line; its ends are among them.
pub(crate) fn simplify_line(line: &[DVec2], tolerance_mm: f64) -> Vec<DVec2> {
    let Some(last) = line.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; line.len()];
    (kept[0], kept[last]) = (true, true);
    keep(line, tolerance_mm, &mut kept, 0, last);
    line.iter().zip(kept).filter_map(|(corner, kept)| kept.then_some(*corner)).collect()
}

/// Marks the corners to be kept strictly between two of them.
fn keep(line: &[DVec2], tolerance_mm: f64, kept: &mut [bool], from: usize, to: usize) {
    let mut open = vec![(from, to)];
    while let Some((from, to)) = open.pop() {
        let off = |k: usize| distance(line[k], line[from], line[to]);
        let farthest = (from + 1..to).map(|k| (off(k), k)).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((off, k)) = farthest
            && off > tolerance_mm
        {
            kept[k] = true;
            open.extend([(from, k), (k, to)]);
        }
    }
}

/// Distance of a place from the line between two others.
pub(crate) fn distance(place: DVec2, a: DVec2, b: DVec2) -> f64 {
    place.distance(nearest_on(place, a, b).0)
}

/// The place nearest to another on the line from `a` to `b`, and its share of the line's length.
pub(crate) fn nearest_on(place: DVec2, a: DVec2, b: DVec2) -> (DVec2, f64) {
    let along = b - a;
    let share = (place - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    let share = share.clamp(0.0, 1.0);
    (a + along * share, share)
}

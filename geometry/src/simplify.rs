//! Fewer corners for a closed line.
//!
//! Douglas and Peucker (1973): between two corners that stay, the corner farthest from the line between
//! them stays too, unless all lie within the tolerance. A closed line is begun at two corners that are
//! far from each other.

use glam::DVec2;

/// Leaves out corners of a closed line that lie within `tolerance` of what remains, in the line's own
/// units. A line of which less than three corners would remain stays as it is.
pub(crate) fn simplify_ring(corners: &[DVec2], tolerance: f64) -> Vec<DVec2> {
    let Some(&first) = corners.first() else { return Vec::new() };
    let far = (0..corners.len()).max_by(|a, b| {
        let distance = |k: usize| corners[k].distance_squared(first);
        distance(*a).total_cmp(&distance(*b))
    });
    let far = far.unwrap_or(0);
    let mut stays = vec![false; corners.len()];
    (stays[0], stays[far]) = (true, true);
    // The last corner is followed by the first.
    let mut open = vec![(0, far), (far, corners.len())];
    while let Some((from, to)) = open.pop() {
        let (a, b) = (corners[from], corners[to % corners.len()]);
        let farthest = (from + 1..to).map(|k| (distance_to_line(corners[k], a, b), k));
        let farthest = farthest.max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, k)) = farthest.filter(|(distance, _)| *distance > tolerance) {
            stays[k] = true;
            open.extend([(from, k), (k, to)]);
        }
    }
    let kept: Vec<DVec2> = corners
        .iter()
        .zip(&stays)
        .filter(|(_, stays)| **stays)
        .map(|(corner, _)| *corner)
        .collect();
    if kept.len() < 3 { corners.to_vec() } else { kept }
}

/// Distance of a place from the line between `a` and `b`, ends included.
fn distance_to_line(place: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let share = (place - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    place.distance(a + along * share.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;

    #[test]
    fn corners_along_a_line_go() {
        let square = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 2.0), (0.0, 2.0)];
        let kept = simplify_ring(&square.map(DVec2::from), 0.01);
        assert_eq!(kept, [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(DVec2::from));
    }

    #[test]
    fn no_corner_lies_farther_off_than_the_tolerance() {
        let mut random = Rng::with_seed(5);
        for _ in 0..50 {
            let count = random.usize(3..200);
            let corner = |k: usize| {
                let turn = DVec2::from_angle(k as f64 / count as f64 * std::f64::consts::TAU);
                turn * (10.0 + random.f64())
            };
            let ring: Vec<DVec2> = (0..count).map(corner).collect();
            let tolerance = 0.05 + random.f64();
            let kept = simplify_ring(&ring, tolerance);
            assert!(kept.len() >= 3);
            let next = || kept.iter().cycle().skip(1);
            for place in &ring {
                let off = kept.iter().zip(next()).map(|(a, b)| distance_to_line(*place, *a, *b));
                assert!(off.fold(f64::INFINITY, f64::min) <= tolerance);
            }
        }
    }

    #[test]
    fn a_small_line_stays_a_line() {
        let speck = [(0.0, 0.0), (0.1, 0.0), (0.0, 0.1)].map(DVec2::from);
        assert_eq!(simplify_ring(&speck, 1.0), speck);
        assert!(simplify_ring(&[], 1.0).is_empty());
    }
}

//! The point of a triangle that is closest to another point.
//!
//! Source: C. Ericson, *Real-Time Collision Detection* (2005), section 5.1.5: by the Voronoi region of
//! corner, edge or inside that the point lies in.

use glam::DVec3;

/// The squared distance of a point from a triangle.
pub(super) fn distance2(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac) = (b - a, c - a);
    let of = |corner: DVec3| (ab.dot(p - corner), ac.dot(p - corner));
    let ((a1, a2), (b1, b2), (c1, c2)) = (of(a), of(b), of(c));
    let to = |q: DVec3| p.distance_squared(q);
    if a1 <= 0.0 && a2 <= 0.0 {
        return to(a);
    }
    if b1 >= 0.0 && b2 <= b1 {
        return to(b);
    }
    let on_c = a1 * b2 - b1 * a2;
    if on_c <= 0.0 && a1 >= 0.0 && b1 <= 0.0 {
        return to(a + ab * (a1 / (a1 - b1)));
    }
    if c2 >= 0.0 && c1 <= c2 {
        return to(c);
    }
    let on_b = c1 * a2 - a1 * c2;
    if on_b <= 0.0 && a2 >= 0.0 && c2 <= 0.0 {
        return to(a + ac * (a2 / (a2 - c2)));
    }
    let on_a = b1 * c2 - c1 * b2;
    if on_a <= 0.0 && b2 >= b1 && c1 >= c2 {
        let (from_b, from_c) = (b2 - b1, c1 - c2);
        return to(b + (c - b) * (from_b / (from_b + from_c)));
    }
    let whole = on_a + on_b + on_c;
    if whole > 0.0 {
        return to(a + ab * (on_b / whole) + ac * (on_c / whole));
    }
    // No area: one of its edges is all of it.
    [(a, b), (b, c), (c, a)].map(|(a, b)| to_edge2(p, a, b)).into_iter().fold(f64::MAX, f64::min)
}

fn to_edge2(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let way = b - a;
    let share = way.dot(p - a) / way.length_squared();
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    p.distance_squared(a + way * share)
}

/// The squared distance of a point from a box.
pub(super) fn to_box2(p: DVec3, low: DVec3, high: DVec3) -> f64 {
    (low - p).max(p - high).max(DVec3::ZERO).length_squared()
}

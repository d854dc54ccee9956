//! The slow truth that the drop cutter is held against: every triangle, edge and vertex, by formulas
//! other than the kernels'. For tests, these and those of cutter plugins; the feature `oracle` adds it.
//!
//! Balls and flats are exact to rounding. Others are sampled and refined, and good to 1e-6 mm for
//! profiles of some hundred pieces on fields of a pitch near the cutter's size.

// From the parent: this crate, or its tests, which take the file in so that they need no feature.
use super::{Against, DVec2, DVec3, HeightField, Mesh, Profile};

/// The height of the tip, in mm, at which a cutter lowered at `at` (mm) touches the field; −∞ if
/// there is nothing under it. The time is that of looking at the whole field.
#[must_use]
pub fn drop(field: &HeightField, against: Against, profile: &Profile, at: DVec2) -> f64 {
    let mut best = f64::NEG_INFINITY;
    for j in 0..field.rows() {
        for i in 0..field.columns() {
            let node = field.point(i, j);
            best = best.max(node.z - profile.height(node.truncate().distance(at)));
        }
    }
    if against == Against::Points {
        return best;
    }
    for j in 0..field.rows() - 1 {
        for i in 0..field.columns() - 1 {
            let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                .map(|(i, j)| field.point(i, j) - at.extend(0.0));
            for corners in [[a, b, c], [a, c, d]] {
                best = best.max(on_triangle(profile, corners, best));
            }
        }
    }
    best
}

/// The same for a mesh, whatever its triangles are like.
#[must_use]
pub fn drop_on_mesh(mesh: &Mesh, profile: &Profile, at: DVec2) -> f64 {
    let corners = |t: usize| mesh.corners(t);
    let used = (0..mesh.triangles.len()).flat_map(corners);
    let mut best = drop_on_points(used, profile, at);
    for corners in (0..mesh.triangles.len()).map(corners) {
        // About its own height: the formulas square what they are given.
        let lift = corners[0].z;
        let seen = corners.map(|corner| corner - at.extend(lift));
        best = best.max(on_triangle(profile, seen, best - lift) + lift);
    }
    best
}

/// The same for points alone.
#[must_use]
pub fn drop_on_points(points: impl Iterator<Item = DVec3>, profile: &Profile, at: DVec2) -> f64 {
    points
        .map(|point| point.z - profile.height(point.truncate().distance(at)))
        .fold(f64::NEG_INFINITY, f64::max)
}

/// The same for a triangle, given from the axis; −∞ if it obviously lies too low or too far.
fn on_triangle(profile: &Profile, corners: [DVec3; 3], best: f64) -> f64 {
    let radius = profile.radius_mm();
    let [a, b, c] = corners;
    // The formulas are for triangles that turn counter-clockwise in plan, or stand upright.
    let turns = (b - a).truncate().perp_dot((c - a).truncate());
    let corners = if turns < 0.0 { [a, c, b] } else { corners };
    let nearest = nearest_to_axis(corners) * (1.0 - 1e-9);
    if nearest > radius || a.z.max(b.z).max(c.z) - profile.height(nearest) < best - 1e-9 {
        return f64::NEG_INFINITY;
    }
    let is = |shape: Result<Profile, _>| shape.is_ok_and(|shape| shape == *profile);
    if is(Profile::ball(radius)) {
        ball_on_triangle(radius, corners)
    } else if is(Profile::flat(radius)) {
        disc_on_triangle(radius, corners)
    } else {
        any_on_triangle(profile, corners)
    }
}

/// Distance of a triangle from the axis in plan.
fn nearest_to_axis(corners: [DVec3; 3]) -> f64 {
    if holds(corners, DVec2::ZERO) {
        return 0.0;
    }
    let edges = [(0, 1), (1, 2), (2, 0)];
    let distance = |(a, b): (usize, usize)| {
        let (a, b) = (corners[a].truncate(), corners[b].truncate());
        let t = (-a.dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        a.lerp(b, t).length()
    };
    edges.map(distance).into_iter().fold(f64::INFINITY, f64::min)
}

fn holds([a, b, c]: [DVec3; 3], place: DVec2) -> bool {
    let side = |a: DVec3, b: DVec3| (b - a).truncate().perp_dot(place - a.truncate());
    let sides = [side(a, b), side(b, c), side(c, a)];
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}

/// A sphere of radius R lowered along z: its centre is R off the plane along the unit normal, or R
/// off the line of an edge: a quadratic equation in the centre's height.
fn ball_on_triangle(radius: f64, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize();
    let mut best = f64::NEG_INFINITY;
    // Plane: normal · (center − a) = R.
    let center_z = (radius + normal.dot(a)) / normal.z;
    let touch = DVec3::new(0.0, 0.0, center_z) - normal * radius;
    if normal.z > 0.0 && holds(corners, touch.truncate()) {
        best = center_z - radius;
    }
    for (a, b) in [(a, b), (b, c), (c, a)] {
        // |(center − a) × u|² = R² for the center (0, 0, z).
        let u = (b - a).normalize();
        let (p, q) = ((DVec3::ZERO - a).cross(u), DVec3::Z.cross(u));
        let (qa, qb, qc) = (q.dot(q), 2.0 * p.dot(q), p.dot(p) - radius * radius);
        let root = qb * qb - 4.0 * qa * qc;
        if root < 0.0 {
            continue;
        }
        let z = (-qb + root.sqrt()) / (2.0 * qa);
        let t = (DVec3::new(0.0, 0.0, z) - a).dot(u);
        if t >= 0.0 && t <= a.distance(b) {
            best = best.max(z - radius);
        }
    }
    best
}

/// The highest point of a triangle within a disc: on the disc's rim where the plane is highest if
/// that is inside, or on an edge clipped to the disc.
fn disc_on_triangle(radius: f64, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let uphill = (-normal.truncate() / normal.z).normalize_or_zero();
    let mut best = f64::NEG_INFINITY;
    let place = uphill * radius;
    if normal.z > 0.0 && holds(corners, place) {
        best = a.z - normal.truncate().dot(place - a.truncate()) / normal.z;
    }
    for (a, b) in [(a, b), (b, c), (c, a)] {
        let (p, d) = (a.truncate(), (b - a).truncate());
        let (qa, qb, qc) = (d.dot(d), 2.0 * p.dot(d), p.dot(p) - radius * radius);
        let root = qb * qb - 4.0 * qa * qc;
        if root < 0.0 {
            continue;
        }
        for t in [(-qb - root.sqrt()) / (2.0 * qa), (-qb + root.sqrt()) / (2.0 * qa)] {
            if (0.0..=1.0).contains(&t) {
                best = best.max(a.z + t * (b.z - a.z));
            }
        }
    }
    best
}

/// Along the way uphill from the axis (where the greatest z − h(r) over a plane is) and along the
/// edges: at the ends of the profile's pieces, and by sampling and refinement of what lies in the
/// triangle and under the cutter.
fn any_on_triangle(profile: &Profile, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let radius = profile.radius_mm();
    let normal = (b - a).cross(c - a);
    let gradient = -normal.truncate() / normal.z;
    let uphill = gradient.normalize_or_zero();
    let clearance = |place: DVec2, z: f64| z - profile.height(place.length().min(radius));
    let ends = profile.segments().iter().map(|segment| segment.to()[0]);
    let mut best = f64::NEG_INFINITY;

    let (mut from, mut to) = (0.0_f64, radius);
    for (a, b) in [(a, b), (b, c), (c, a)] {
        // Counter-clockwise: inside is where this is not negative.
        let (way, start) = ((b - a).truncate(), a.truncate());
        let (at_axis, rate) = (way.perp_dot(-start), way.perp_dot(uphill));
        if rate > 0.0 {
            from = from.max(-at_axis / rate);
        } else if rate < 0.0 {
            to = to.min(-at_axis / rate);
        } else if at_axis < 0.0 {
            to = -1.0;
        }
        // The part of the edge under the cutter.
        let (qa, qb) = (way.length_squared(), start.dot(way));
        if qa == 0.0 {
            continue;
        }
        let root = qb * qb - qa * (start.length_squared() - radius * radius);
        if root >= 0.0 {
            let [low, high] = [-1.0, 1.0].map(|sign| (-qb + sign * root.sqrt()) / qa);
            let on_edge = |t: f64| clearance(start + way * t, a.z + (b.z - a.z) * t);
            best = best.max(maximum(on_edge, low.max(0.0), high.min(1.0)));
        }
        for r in ends.clone() {
            let root = (qb * qb - qa * (start.length_squared() - r * r)).sqrt();
            for t in [(-qb - root) / qa, (-qb + root) / qa] {
                if (0.0..=1.0).contains(&t) {
                    best = best.max(a.z + (b.z - a.z) * t - profile.height(r));
                }
            }
        }
    }
    if normal.z <= 0.0 {
        return best;
    }
    let on_plane = |t: f64| {
        let place = uphill * t;
        clearance(place, a.z + gradient.dot(place - a.truncate()))
    };
    let level = a.z - gradient.dot(a.truncate());
    for r in ends.filter(|r| (from..=to).contains(r)) {
        best = best.max(level + gradient.length() * r - profile.height(r));
    }
    best.max(maximum(on_plane, from, to))
}

/// Greatest value over a range of a function that has few humps; −∞ for an empty range.
fn maximum(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    const SAMPLES: usize = 100;
    if low > high {
        return f64::NEG_INFINITY;
    }
    let place = |k: usize| low + (high - low) * (k as f64 / SAMPLES as f64);
    let values: Vec<f64> = (0..=SAMPLES).map(|k| f(place(k))).collect();
    let mut best = f64::NEG_INFINITY;
    for k in 0..=SAMPLES {
        let neighbours = [k.saturating_sub(1), (k + 1).min(SAMPLES)];
        if neighbours.iter().all(|&n| values[n] <= values[k]) {
            let [low, high] = neighbours.map(place);
            best = best.max(values[k]).max(climb(&f, low, high));
        }
    }
    best
}

/// Golden section.
fn climb(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let mut best = f64::NEG_INFINITY;
    for _ in 0..50 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        let (fa, fb) = (f(a), f(b));
        best = best.max(fa).max(fb);
        if fa > fb {
            high = b;
        } else {
            low = a;
        }
    }
    best
}

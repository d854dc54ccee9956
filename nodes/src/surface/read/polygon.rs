//! Faces of many corners, cut into triangles.
//!
//! A convex face becomes a fan. Any other loses its ears one by one (Meisters, "Polygons have ears",
//! American Mathematical Monthly 82, 1975), seen along its normal (Newell's method), so that no
//! triangle covers what the face leaves open. A face that crosses itself has no right answer; what
//! is left of it when no ear can be found becomes a fan.

use carvegraph_geometry::{DVec2, DVec3};

/// A face that is not convex has no more corners: the work grows with their cube.
pub(super) const MAX_CORNERS: usize = 1000;

/// A concave face with more than [`MAX_CORNERS`].
#[derive(Debug, PartialEq)]
pub(super) struct TooManyCorners;

/// Adds the triangles of a face. Its corners are indices into the vertices.
pub(super) fn triangulate(
    corners: &[u32],
    vertices: &[DVec3],
    into: &mut Vec<[u32; 3]>,
) -> Result<(), TooManyCorners> {
    if let [a, b, c] = *corners {
        into.push([a, b, c]);
        return Ok(());
    }
    let flat = flattened(corners, vertices);
    if corners.len() < 3 || is_convex(&flat) {
        fan(corners, into);
        return Ok(());
    }
    if corners.len() > MAX_CORNERS {
        return Err(TooManyCorners);
    }
    clip_ears(corners, &flat, into);
    Ok(())
}

fn fan(corners: &[u32], into: &mut Vec<[u32; 3]>) {
    if let [first, rest @ ..] = corners {
        into.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
    }
}

/// The corners in the plane, counter-clockwise.
fn flattened(corners: &[u32], vertices: &[DVec3]) -> Vec<DVec2> {
    let at = |i: usize| vertices[corners[i % corners.len()] as usize];
    let normal: DVec3 = (0..corners.len()).map(|i| (at(i) - at(0)).cross(at(i + 1) - at(0))).sum();
    let size = normal.abs();
    let project = |p: DVec3| match () {
        () if size.z >= size.x && size.z >= size.y => DVec2::new(p.x * normal.z.signum(), p.y),
        () if size.x >= size.y => DVec2::new(p.y * normal.x.signum(), p.z),
        () => DVec2::new(p.z * normal.y.signum(), p.x),
    };
    (0..corners.len()).map(|i| project(at(i))).collect()
}

/// Twice the area of a triangle, positive if counter-clockwise.
fn doubled_area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

fn is_convex(flat: &[DVec2]) -> bool {
    let n = flat.len();
    (0..n).all(|i| doubled_area(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) >= 0.0)
}

fn clip_ears(corners: &[u32], flat: &[DVec2], into: &mut Vec<[u32; 3]>) {
    let mut left: Vec<usize> = (0..corners.len()).collect();
    while left.len() > 3 {
        let Some(ear) = (0..left.len()).find(|&i| is_ear(&left, flat, i)) else { break };
        into.push(around(&left, ear).map(|corner| corners[corner]));
        left.remove(ear);
    }
    let left: Vec<u32> = left.into_iter().map(|corner| corners[corner]).collect();
    fan(&left, into);
}

/// A corner between its neighbours.
fn around(left: &[usize], i: usize) -> [usize; 3] {
    let n = left.len();
    [left[(i + n - 1) % n], left[i], left[(i + 1) % n]]
}

/// Whether a corner can be cut off: it points outwards and no other corner lies in its triangle.
fn is_ear(left: &[usize], flat: &[DVec2], i: usize) -> bool {
    let [a, b, c] = around(left, i).map(|corner| flat[corner]);
    let is_inside = |p: DVec2| {
        doubled_area(a, b, p) >= 0.0 && doubled_area(b, c, p) >= 0.0 && doubled_area(c, a, p) >= 0.0
    };
    let others = left.iter().map(|&corner| flat[corner]).filter(|p| ![a, b, c].contains(p));
    doubled_area(a, b, c) > 0.0 && !others.into_iter().any(is_inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The triangles of a face with these corners in the plane z = x + y.
    fn cut(outline: &[(f64, f64)]) -> Vec<f64> {
        let vertices: Vec<DVec3> = outline.iter().map(|&(x, y)| DVec3::new(x, y, x + y)).collect();
        let corners: Vec<u32> = (0..outline.len() as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&corners, &vertices, &mut triangles).unwrap();
        assert_eq!(triangles.len(), outline.len() - 2);
        let flat = |v: u32| vertices[v as usize].truncate();
        triangles.iter().map(|t| doubled_area(flat(t[0]), flat(t[1]), flat(t[2])) / 2.0).collect()
    }

    #[test]
    fn a_square_is_a_fan() {
        assert_eq!(cut(&[(0., 0.), (1., 0.), (1., 1.), (0., 1.)]), [0.5, 0.5]);
    }

    #[test]
    fn a_concave_face_is_not_covered_beyond_its_outline() {
        // An arrowhead whose fan from the first corner would turn over, an L and a U.
        let arrow = cut(&[(2., 0.), (0., 1.), (-2., 0.), (0., 3.)]);
        let l = cut(&[(0., 0.), (3., 0.), (3., 1.), (1., 1.), (1., 3.), (0., 3.)]);
        let u = [(0., 0.), (3., 0.), (3., 3.), (2., 3.), (2., 1.), (1., 1.), (1., 3.), (0., 3.)];
        for (areas, whole) in [(arrow, -4.0), (l, 5.0), (cut(&u), 7.0)] {
            assert_eq!(areas.iter().sum::<f64>(), whole);
            assert_eq!(areas.iter().map(|area| area.abs()).sum::<f64>(), f64::abs(whole));
        }
    }

    #[test]
    fn a_face_that_crosses_itself_still_ends() {
        let vertices = [(0., 0.), (1., 1.), (1., 0.), (0., 1.)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let mut triangles = Vec::new();
        triangulate(&[0, 1, 2, 3], &vertices, &mut triangles).unwrap();
        assert_eq!(triangles.len(), 2);
    }
}

//! What is wrong with a mesh, by count.
//!
//! Vertices that are equal bit by bit count as one, so that a seam along which a file repeats them is
//! no crack. Then every edge is listed once for each triangle beside it, with the direction in which
//! the triangle runs along it, and the list is sorted: edges come to lie beside themselves. Triangles
//! with two corners in one vertex are counted and have no edges.

use crate::{Mesh, Tick};
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Defects of a mesh. None of them keeps a cutter from being dropped on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Defects {
    /// Edges of one triangle only: the rim of an open surface, or a hole.
    pub open_edges: usize,
    /// Edges of more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges whose two triangles do not agree on which side is outside.
    pub flipped_edges: usize,
    /// Triangles whose three corners another one has already.
    pub duplicate_triangles: usize,
    /// Triangles without area.
    pub degenerate_triangles: usize,
    /// Vertices that stand where another one stands already.
    pub repeated_vertices: usize,
}

impl Defects {
    /// Whether there are none: a closed surface with one outside.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// Units of work that [`find_defects`] tells for `triangles` triangles.
const STEPS: usize = 4;

/// Counts the defects of a mesh. `tick` is told of a quarter of the triangles at a time.
pub fn find_defects(mesh: &Mesh, tick: Tick<'_>) -> Option<Defects> {
    let step = || tick(mesh.triangles.len().div_ceil(STEPS)).then_some(());
    let (same, repeated_vertices) = representatives(&mesh.vertices);
    step()?;
    let triangles: Vec<[u32; 3]> =
        mesh.triangles.par_iter().map(|t| t.map(|v| same[v as usize])).collect();
    drop(same);
    let corners = |t: &[u32; 3]| t.map(|v| mesh.vertices[v as usize]);
    let degenerate_triangles =
        triangles.par_iter().filter(|t| is_collapsed(t) || has_no_area(corners(t))).count();
    step()?;
    let duplicate_triangles = duplicates(&triangles);
    step()?;
    let edges = edges(&triangles);
    step()?;
    let count = |is_one: fn(&[u64]) -> bool| count_runs(&edges, is_one);
    Some(Defects {
        open_edges: count(|run| run.len() == 1),
        non_manifold_edges: count(|run| run.len() > 2),
        flipped_edges: count(|run| run.len() == 2 && run[0] == run[1]),
        duplicate_triangles,
        degenerate_triangles,
        repeated_vertices,
    })
}

/// For each vertex the first of those that are equal to it, and how many are not the first.
fn representatives(vertices: &[DVec3]) -> (Vec<u32>, usize) {
    // Adding 0 gives zero one sign.
    let bits = |v: u32| (vertices[v as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.par_sort_unstable_by_key(|&v| (bits(v), v));
    let mut same: Vec<u32> = vec![0; vertices.len()];
    let mut repeated = 0;
    let mut first = 0;
    for (place, &vertex) in order.iter().enumerate() {
        match place > 0 && bits(vertex) == bits(first) {
            true => repeated += 1,
            false => first = vertex,
        }
        same[vertex as usize] = first;
    }
    (same, repeated)
}

fn is_collapsed([a, b, c]: &[u32; 3]) -> bool {
    a == b || b == c || c == a
}

fn has_no_area([a, b, c]: [DVec3; 3]) -> bool {
    (b - a).cross(c - a) == DVec3::ZERO
}

/// Triangles over the same three vertices as one before, whichever way they are wound.
fn duplicates(triangles: &[[u32; 3]]) -> usize {
    let mut sorted: Vec<[u32; 3]> = triangles
        .par_iter()
        .filter(|triangle| !is_collapsed(triangle))
        .map(|triangle| {
            let mut triangle = *triangle;
            triangle.sort_unstable();
            triangle
        })
        .collect();
    sorted.par_sort_unstable();
    sorted.par_windows(2).filter(|pair| pair[0] == pair[1]).count()
}

/// Every edge of every triangle, sorted: the smaller vertex, the greater one, and in the lowest bit
/// whether the triangle runs from the greater to the smaller. A mesh in memory has fewer than 2³¹
/// vertices, which would take 50 GB.
fn edges(triangles: &[[u32; 3]]) -> Vec<u64> {
    let key =
        |a: u32, b: u32| u64::from(a.min(b)) << 32 | u64::from(a.max(b)) << 1 | u64::from(a > b);
    let of = |&[a, b, c]: &[u32; 3]| [key(a, b), key(b, c), key(c, a)];
    let sound = triangles.par_iter().filter(|triangle| !is_collapsed(triangle));
    let mut edges: Vec<u64> = sound.flat_map_iter(of).collect();
    edges.par_sort_unstable();
    edges
}

/// How many runs of one edge are such.
fn count_runs(edges: &[u64], is_one: fn(&[u64]) -> bool) -> usize {
    edges.par_chunk_by(|a, b| a >> 1 == b >> 1).filter(|run| is_one(run)).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn found(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Defects {
        let vertices = vertices.iter().map(|v| DVec3::from_array(*v)).collect();
        let mesh = Mesh { vertices: Arc::new(vertices), triangles: triangles.to_vec() };
        find_defects(&mesh, &|_| true).unwrap()
    }

    const TETRAHEDRON: [[f64; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn a_tetrahedron_has_none() {
        assert!(found(&TETRAHEDRON, &FACES).is_none());
    }

    #[test]
    fn a_missing_face_leaves_three_open_edges() {
        assert_eq!(
            found(&TETRAHEDRON, &FACES[1..]),
            Defects { open_edges: 3, ..Defects::default() }
        );
    }

    #[test]
    fn a_turned_face_has_three_flipped_edges() {
        let mut faces = FACES;
        faces[2].reverse();
        assert_eq!(found(&TETRAHEDRON, &faces), Defects { flipped_edges: 3, ..Defects::default() });
    }

    #[test]
    fn a_face_twice_is_a_duplicate_and_its_edges_are_non_manifold() {
        let faces = [&FACES[..], &[[3, 1, 0]]].concat();
        let expected =
            Defects { non_manifold_edges: 3, duplicate_triangles: 1, ..Defects::default() };
        assert_eq!(found(&TETRAHEDRON, &faces), expected);
    }

    #[test]
    fn slivers_and_collapsed_faces_are_degenerate() {
        let vertices = [&TETRAHEDRON[..], &[[0.5, 0., 0.], [0., 0., 0.]]].concat();
        // No area; one vertex twice; two vertices in one place.
        let faces = [&FACES[..], &[[0, 1, 4], [2, 2, 3], [0, 5, 3]]].concat();
        let defects = found(&vertices, &faces);
        assert_eq!((defects.degenerate_triangles, defects.repeated_vertices), (3, 1));
        // Edges 0-4 and 4-1 of the sliver; its edge 0-1 is a third one there.
        assert_eq!((defects.open_edges, defects.non_manifold_edges), (2, 1));
    }

    #[test]
    fn a_seam_of_repeated_vertices_is_no_crack() {
        let soup: Vec<[f64; 3]> =
            FACES.iter().flatten().map(|v| TETRAHEDRON[*v as usize]).collect();
        let faces: Vec<[u32; 3]> = (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        assert_eq!(found(&soup, &faces), Defects { repeated_vertices: 8, ..Defects::default() });
    }

    #[test]
    fn it_stops_when_told_to() {
        let mesh = Mesh { vertices: Arc::default(), triangles: Vec::new() };
        assert_eq!(find_defects(&mesh, &|_| false), None);
    }
}

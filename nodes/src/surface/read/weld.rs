//! Vertices that are equal bit by bit become one.
//!
//! An open-addressing table of indices, at most half full, probed linearly. The vertices keep the
//! order in which they first came. Zero has one sign here: -0 is 0.

use carvegraph_geometry::DVec3;

/// The mark of a place that is free.
const FREE: u32 = u32::MAX;

/// Odd and without pattern, as multiplicative hashing needs it: 2^64 over the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// Finds equal vertices.
pub(crate) struct Welder {
    vertices: Vec<DVec3>,
    table: Vec<u32>,
}

impl Welder {
    /// A welder that has room for about `expected` vertices before it has to grow.
    pub(crate) fn new(expected: usize) -> Self {
        let places = (2 * expected).next_power_of_two().max(64);
        Self { vertices: Vec::with_capacity(expected), table: vec![FREE; places] }
    }

    /// The index of a vertex, which is new if none before was equal.
    pub(crate) fn index(&mut self, vertex: DVec3) -> u32 {
        let vertex = vertex + DVec3::ZERO;
        let mask = self.table.len() - 1;
        let mut place = home(vertex, mask);
        loop {
            let known = self.table[place];
            if known == FREE {
                break;
            }
            if self.vertices[known as usize] == vertex {
                return known;
            }
            place = (place + 1) & mask;
        }
        let index = self.vertices.len() as u32;
        self.table[place] = index;
        self.vertices.push(vertex);
        if 2 * self.vertices.len() > self.table.len() {
            self.grow();
        }
        index
    }

    /// The vertices, in the order in which they first came.
    pub(crate) fn into_vertices(self) -> Vec<DVec3> {
        self.vertices
    }

    fn grow(&mut self) {
        let places = 2 * self.table.len();
        self.table = vec![FREE; places];
        for (index, vertex) in self.vertices.iter().enumerate() {
            let mut place = home(*vertex, places - 1);
            while self.table[place] != FREE {
                place = (place + 1) & (places - 1);
            }
            self.table[place] = index as u32;
        }
    }
}

/// Where a vertex is looked for first.
fn home(vertex: DVec3, mask: usize) -> usize {
    let mix =
        |hash: u64, length: f64| (hash ^ length.to_bits()).wrapping_mul(GOLDEN).rotate_left(29);
    let hash = vertex.to_array().into_iter().fold(0, mix).wrapping_mul(GOLDEN);
    (hash >> 20) as usize & mask
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_vertices_get_one_index_in_order() {
        let mut welder = Welder::new(0);
        let vertex = |i: u32| DVec3::new(f64::from(i % 100), f64::from(i % 7), 0.5);
        let first: Vec<u32> = (0..700).map(|i| welder.index(vertex(i))).collect();
        assert_eq!(first, (0..700).collect::<Vec<u32>>());
        assert!((0..1400).all(|i| welder.index(vertex(i)) == i % 700));
        assert_eq!(welder.into_vertices().len(), 700);
    }

    #[test]
    fn zero_has_one_sign_and_a_bit_is_a_difference() {
        let mut welder = Welder::new(4);
        assert_eq!(welder.index(DVec3::new(0.0, 1.0, 2.0)), 0);
        assert_eq!(welder.index(DVec3::new(-0.0, 1.0, 2.0)), 0);
        assert_eq!(welder.index(DVec3::new(0.0, 1.0_f64.next_up(), 2.0)), 1);
    }
}

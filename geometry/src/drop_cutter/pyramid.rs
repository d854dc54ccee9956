//! The greatest heights of ever larger square blocks of a field.
//!
//! A block of level l holds 4^l × 4^l nodes; level 0 is the field itself and is not copied. The
//! levels above take 1/15 of its memory. Rows are padded with −∞ so that four neighbouring blocks
//! can be read at once wherever the first of them lies in the field.

use crate::{HeightField, Tick};
use rayon::prelude::*;
use wide::f32x4;

/// Blocks of one level have this many blocks of the level below along each side.
pub(super) const FACTOR: usize = 4;

/// Greatest heights of one level, in mm.
pub(super) struct Level {
    pub(super) columns: usize,
    pub(super) rows: usize,
    stride: usize,
    max: Vec<f32>,
}

impl Level {
    /// The blocks (i, j) to (i + 3, j); −∞ for those beyond the border. Block (i, j) must exist.
    #[inline]
    pub(super) fn four(&self, i: usize, j: usize) -> f32x4 {
        let start = j * self.stride + i;
        match self.max[start..].first_chunk() {
            Some(four) => f32x4::from(*four),
            None => f32x4::splat(f32::NEG_INFINITY),
        }
    }

    /// Raises blocks by so many mm each, row by row.
    fn raise(&mut self, by: &[f32]) {
        for (row, by) in self.max.chunks_mut(self.stride).zip(by.chunks(self.columns)) {
            for (most, by) in row.iter_mut().zip(by) {
                *most = ((f64::from(*most) + f64::from(*by)) as f32).next_up();
            }
        }
    }

    /// The level above some rows of heights. `None` if cancelled.
    fn above(heights: &[f32], stride: usize, columns: usize, tick: Tick) -> Option<Self> {
        let blocks = columns.div_ceil(FACTOR);
        let padded = (blocks + FACTOR - 1).next_multiple_of(FACTOR);
        let rows = heights.len().div_ceil(FACTOR * stride);
        let mut max = vec![f32::NEG_INFINITY; rows * padded];
        let bands = heights.par_chunks(FACTOR * stride);
        max.par_chunks_mut(padded).zip(bands).try_for_each_init(
            Vec::new,
            |scratch, (out, band)| {
                max_of_rows(band, stride, columns, scratch);
                for (most, four) in out.iter_mut().zip(scratch.chunks(FACTOR)) {
                    *most = four.iter().copied().fold(f32::NEG_INFINITY, greater);
                }
                tick(0).then_some(())
            },
        )?;
        Some(Self { columns: blocks, rows, stride: padded, max })
    }
}

/// The greatest of each column of a few rows.
fn max_of_rows(band: &[f32], stride: usize, columns: usize, greatest: &mut Vec<f32>) {
    greatest.clear();
    greatest.extend_from_slice(&band[..columns]);
    for row in band.chunks(stride).skip(1) {
        for (most, &height) in greatest.iter_mut().zip(&row[..columns]) {
            *most = greater(*most, height);
        }
    }
}

/// `f32::max` for numbers that are none of them NaN: one instruction.
#[inline]
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// All levels above a field.
pub(super) struct Pyramid {
    levels: Vec<Level>,
}

impl Pyramid {
    /// Builds the levels from 1 to the one that has a single block, with the blocks of level 1 raised by
    /// so many mm, if any are given. `None` if cancelled.
    pub(super) fn build(field: &HeightField, raise: &[f32], tick: Tick) -> Option<Self> {
        let mut first = Level::above(field.heights(), field.columns(), field.columns(), tick)?;
        first.raise(raise);
        let mut levels = vec![first];
        while let Some(last) = levels.last().filter(|l| l.columns * l.rows > 1) {
            levels.push(Level::above(&last.max, last.stride, last.columns, tick)?);
        }
        Some(Self { levels })
    }

    /// Level `l` ≥ 1.
    #[inline]
    pub(super) fn level(&self, l: usize) -> &Level {
        &self.levels[l - 1]
    }

    /// The highest level.
    pub(super) fn top(&self) -> usize {
        self.levels.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_hold_the_greatest_of_their_nodes() {
        let mut random = fastrand::Rng::with_seed(7);
        for (columns, rows) in [(2, 2), (4, 4), (5, 9), (17, 66), (130, 3)] {
            let heights: Vec<f32> = (0..columns * rows).map(|_| random.f32() - 2.0).collect();
            let field = HeightField::new(columns, rows, 1.0, heights).unwrap();
            let pyramid = Pyramid::build(&field, &[], &|_| true).unwrap();
            for l in 1..=pyramid.top() {
                let (level, side) = (pyramid.level(l), FACTOR.pow(l as u32));
                assert_eq!(level.columns, columns.div_ceil(side));
                assert_eq!(level.rows, rows.div_ceil(side));
                for (i, j) in (0..level.rows).flat_map(|j| (0..level.columns).map(move |i| (i, j)))
                {
                    let four = level.four(i, j).to_array();
                    for (k, &found) in four.iter().enumerate() {
                        let mut expected = f32::NEG_INFINITY;
                        for y in j * side..((j + 1) * side).min(rows) {
                            for x in (i + k) * side..((i + k + 1) * side).min(columns) {
                                expected = expected.max(field.row(y)[x]);
                            }
                        }
                        assert_eq!(found, expected, "{columns}x{rows} level {l} {i}+{k} {j}");
                    }
                }
            }
            assert_eq!((pyramid.level(pyramid.top()).columns, pyramid.top() > 0), (1, true));
        }
    }

    #[test]
    fn building_can_be_stopped() {
        let field = HeightField::new(64, 64, 1.0, vec![0.0; 64 * 64]).unwrap();
        assert!(Pyramid::build(&field, &[], &|_| false).is_none());
    }
}

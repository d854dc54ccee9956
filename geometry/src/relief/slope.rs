//! The nearest surface that is nowhere steeper than a slope.
//!
//! With s the greatest slope, filling takes for each node p the highest of all cones of that slope
//! that stand on the nodes q,
//!
//! ```text
//! z'(p) = max over q of z(q) - s·|p - q|,
//! ```
//!
//! which is the dilation of the surface by a cone and the least of all surfaces above it whose slope
//! is at most s (McShane, *Extension of range of functions*, Bulletin of the AMS 40, 1934). Cutting
//! is the same upside down: the greatest of those below it. Distances are Euclidean and every node
//! counts, so the result is exact: any two nodes differ by at most s times their distance, and
//! nothing moves that need not. What is exact at the nodes bounds a facet between them by √2·s, which
//! it reaches only where three nodes form a ridge or a pit of a single pitch.
//!
//! Nodes are looked at through a pyramid of the highest of 4 × 4, branch and bound. A node that lies
//! on or below the cone of one of its eight neighbours never raises another one above what that
//! neighbour does, and is left out: of a steep flank only its upper edge remains. So it takes a
//! fraction of a microsecond a node on reliefs, and more only on wide areas whose slope is within
//! 8 % of s (the eight directions are 45° apart; 1/cos 22.5° = 1.08).

use crate::{HeightField, Tick};
use rayon::prelude::*;

/// On which side of the surface the less steep one lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlopeLimit {
    /// Below it: edges are cut back.
    Cut,
    /// Above it: corners are filled up.
    Fill,
}

/// Nodes along each side of a block of the pyramid.
const FAN: usize = 4;

/// The heights of a field, in mm and in its order, with no two nodes steeper above each other than
/// `slope` (height over distance; positive). `tick` counts rows; `None` if it stopped the work.
#[must_use]
pub fn limit_slope(
    field: &HeightField,
    slope: f64,
    limit: SlopeLimit,
    tick: Tick<'_>,
) -> Option<Vec<f32>> {
    let sign = match limit {
        SlopeLimit::Fill => 1.0,
        SlopeLimit::Cut => -1.0,
    };
    let (columns, rows) = (field.columns(), field.rows());
    let step = slope * field.pitch_mm();
    let upright: Vec<f32> = field.heights().par_iter().map(|z| sign * z).collect();
    let peaks = Pyramid::over(peaks(&upright, columns, step), columns, rows);
    let mut heights = vec![0.0; upright.len()];
    heights
        .par_chunks_exact_mut(columns)
        .zip(upright.par_chunks_exact(columns))
        .enumerate()
        .try_for_each_init(Vec::new, |stack, (j, (row, own))| {
            // The peak that raised a node is likely to raise the next one.
            let mut last = None;
            for (i, (raised, own)) in row.iter_mut().zip(own).enumerate() {
                let reach = Reach { peaks: &peaks, at: [i, j], step };
                *raised = sign * reach.highest(f64::from(*own), &mut last, stack) as f32;
            }
            tick(1).then_some(())
        })?;
    Some(heights)
}

/// The heights with −∞ for nodes that lie on or below the cone of a neighbour. `step` is the height
/// that a cone loses over a pitch.
fn peaks(heights: &[f32], columns: usize, step: f64) -> Vec<f32> {
    let rows = heights.len() / columns;
    let is_peak = |i: usize, j: usize| {
        let own = f64::from(heights[j * columns + i]);
        let around = |k: usize, count: usize| k.saturating_sub(1)..(k + 2).min(count);
        around(j, rows).all(|b| {
            around(i, columns).all(|a| {
                let squares = a.abs_diff(i) + b.abs_diff(j);
                let drop = step * (squares as f64).sqrt();
                squares == 0 || f64::from(heights[b * columns + a]) - drop < own
            })
        })
    };
    let peak = |at: usize| {
        if is_peak(at % columns, at / columns) { heights[at] } else { f32::NEG_INFINITY }
    };
    (0..heights.len()).into_par_iter().map(peak).collect()
}

/// A level of the pyramid: each value is the highest of a block of nodes.
struct Level {
    columns: usize,
    rows: usize,
    highest: Vec<f32>,
}

/// From single nodes up to one block of all.
struct Pyramid(Vec<Level>);

impl Pyramid {
    fn over(highest: Vec<f32>, columns: usize, rows: usize) -> Self {
        let mut levels = vec![Level { columns, rows, highest }];
        loop {
            let below = &levels[levels.len() - 1];
            if below.highest.len() == 1 {
                return Self(levels);
            }
            let (columns, rows) = (below.columns.div_ceil(FAN), below.rows.div_ceil(FAN));
            let block = |at: usize| {
                let children = below.children([at % columns, at / columns]);
                children.map(|child| below.at(child)).fold(f32::NEG_INFINITY, f32::max)
            };
            let highest = (0..columns * rows).into_par_iter().map(block).collect();
            levels.push(Level { columns, rows, highest });
        }
    }
}

impl Level {
    fn at(&self, [i, j]: [usize; 2]) -> f32 {
        self.highest[j * self.columns + i]
    }

    /// The blocks of this level in a block of the one above.
    fn children(&self, [i, j]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> + use<> {
        let within = |k: usize, count: usize| FAN * k..(FAN * (k + 1)).min(count);
        let columns = within(i, self.columns);
        within(j, self.rows).flat_map(move |j| columns.clone().map(move |i| [i, j]))
    }
}

/// The search for the cone that reaches highest over a node.
struct Reach<'a> {
    peaks: &'a Pyramid,
    /// Column and row of the node.
    at: [usize; 2],
    step: f64,
}

impl Reach<'_> {
    /// The height of the highest cone, at least `own`. `last` is a peak to begin with, and then the
    /// one found; `stack` is scratch space.
    fn highest(
        &self,
        own: f64,
        last: &mut Option<[usize; 2]>,
        stack: &mut Vec<(usize, [usize; 2])>,
    ) -> f64 {
        let mut best = last.map_or(own, |peak| self.cone(peak).max(own));
        stack.clear();
        stack.push((self.peaks.0.len() - 1, [0, 0]));
        while let Some((level, block)) = stack.pop() {
            // It may have been raised since the block was put there.
            if !self.may_raise(level, block, best) {
                continue;
            }
            if level == 0 {
                (best, *last) = (self.cone(block).max(best), Some(block));
                continue;
            }
            let children = self.peaks.0[level - 1].children(block);
            let promising = children.filter(|child| self.may_raise(level - 1, *child, best));
            stack.extend(promising.map(|child| (level - 1, child)));
        }
        best
    }

    /// How high the cone of a peak reaches.
    fn cone(&self, peak: [usize; 2]) -> f64 {
        f64::from(self.peaks.0[0].at(peak)) - self.step * self.square(0, peak).sqrt()
    }

    /// Whether a cone of a block may reach higher than `best`; no root, since most do not.
    fn may_raise(&self, level: usize, block: [usize; 2], best: f64) -> bool {
        let above = f64::from(self.peaks.0[level].at(block)) - best;
        above > 0.0 && above * above > self.step * self.step * self.square(level, block)
    }

    /// The square of the distance from a block, in pitches.
    fn square(&self, level: usize, block: [usize; 2]) -> f64 {
        let width = FAN.pow(level as u32);
        let away = |axis: usize| {
            let (at, first) = (self.at[axis], block[axis] * width);
            first.saturating_sub(at).max(at.saturating_sub(first + width - 1)) as f64
        };
        away(0) * away(0) + away(1) * away(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limited(field: &HeightField, slope: f64, limit: SlopeLimit) -> HeightField {
        let heights = limit_slope(field, slope, limit, &|_| true).unwrap();
        HeightField::new(field.columns(), field.rows(), field.pitch_mm(), heights).unwrap()
    }

    /// Every node looked at from every other.
    fn brute(field: &HeightField, slope: f64) -> Vec<f32> {
        let nodes = || (0..field.rows()).flat_map(|j| (0..field.columns()).map(move |i| (i, j)));
        let points: Vec<_> = nodes().map(|(i, j)| field.point(i, j)).collect();
        let raised = points.iter().map(|p| {
            let cones = points.iter().map(|q| q.z - slope * (p - q).truncate().length());
            cones.fold(f64::NEG_INFINITY, f64::max) as f32
        });
        raised.collect()
    }

    fn rough(columns: usize, rows: usize, seed: u64) -> HeightField {
        let mut random = fastrand::Rng::with_seed(seed);
        let heights = (0..columns * rows).map(|at| {
            let hill = (0.2 * (at % columns) as f32).sin() * 2.0;
            hill + if random.u8(..) < 20 { random.f32() * 4.0 } else { 0.0 }
        });
        HeightField::new(columns, rows, 0.5, heights.collect()).unwrap()
    }

    #[test]
    fn it_is_what_trying_every_node_finds() {
        for (columns, rows) in [(2, 2), (2, 40), (37, 3), (33, 29)] {
            for slope in [0.1, 0.7, 1.0, 5.0] {
                let field = rough(columns, rows, 3);
                let found = limited(&field, slope, SlopeLimit::Fill);
                for (a, b) in found.heights().iter().zip(brute(&field, slope)) {
                    assert!((a - b).abs() < 1e-6, "{columns} × {rows}, {slope}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn a_post_becomes_a_cone_and_a_hole_is_one_upside_down() {
        let mut heights = vec![0.0; 21 * 21];
        heights[10 * 21 + 10] = 4.0;
        let post = HeightField::new(21, 21, 0.5, heights.clone()).unwrap();
        let filled = limited(&post, 1.0, SlopeLimit::Fill);
        let hole = HeightField::new(21, 21, 0.5, heights.iter().map(|z| -z).collect()).unwrap();
        let cut = limited(&hole, 1.0, SlopeLimit::Cut);
        for j in 0..21 {
            for i in 0..21 {
                let away = 0.5 * (i as f64 - 10.0).hypot(j as f64 - 10.0);
                assert!((filled.height(i, j) - (4.0 - away).max(0.0)).abs() < 1e-6);
                assert_eq!(filled.height(i, j), -cut.height(i, j));
            }
        }
        // Cut down, nothing is left of a post, nor of a hole filled up.
        assert!(limited(&post, 1.0, SlopeLimit::Cut).heights().iter().all(|z| *z <= 0.5));
    }

    #[test]
    fn nothing_moves_where_nothing_is_too_steep_and_twice_is_once() {
        let plane = (0..35).map(|at| 0.3 * (at % 7) as f32 - 0.4 * (at / 7) as f32).collect();
        let plane = HeightField::new(7, 5, 1.0, plane).unwrap();
        for limit in [SlopeLimit::Cut, SlopeLimit::Fill] {
            assert_eq!(limited(&plane, 0.51, limit), plane);
            let once = limited(&rough(31, 17, 8), 0.8, limit);
            let twice = limited(&once, 0.8, limit);
            let moved = once.heights().iter().zip(twice.heights()).map(|(a, b)| (a - b).abs());
            assert!(moved.fold(0.0, f32::max) < 1e-6);
        }
    }

    #[test]
    fn it_stops_when_told_to() {
        assert!(limit_slope(&rough(9, 9, 1), 1.0, SlopeLimit::Cut, &|_| false).is_none());
    }
}

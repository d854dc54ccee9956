//! The surface whose steps from node to node come nearest to given ones, by least squares.
//!
//! Over all pairs a, b of neighbours along x and y, Σ (z_b - z_a - s_ab)² is least where the discrete
//! Poisson equation holds,
//!
//! ```text
//! Σ over the neighbours b of a:  z_a - z_b = -s_ab,
//! ```
//!
//! with natural (Neumann) borders. Nodes may be fixed at 0 (Dirichlet); if none is, the mean is 0.
//! Grids of any size, odd or narrow, and fixed nodes in any arrangement.
//!
//! Method: conjugate gradients, preconditioned by one multigrid V-cycle (Tatebe, *The multigrid
//! preconditioned conjugate gradient method*, Copper Mountain 1993). Cells of 2 × 2 nodes become a
//! node of the coarser grid. Values go down by bilinear interpolation between the middles of cells,
//! residuals up by its transpose; the smoother is damped Jacobi, as often before as after. So the
//! cycle is symmetric and positive, which is all that conjugate gradients ask, and how well it suits
//! the grid decides only about the number of iterations: some 10, independent of the size. Coarse
//! equations are those of the grid itself: the weight between two coarse nodes is half the sum of
//! those between their cells, since in two dimensions steps of twice the length have the weight of
//! single ones and each coarse pair has two fine ones. Fixed nodes become weights that pull to 0.
//!
//! Memory: 80 bytes a node. Sums are taken row by row in one order, whatever the number of threads.

use crate::Tick;
use rayon::prelude::*;

/// Damping of the smoother: takes at most 3/5 of every wave that is too short for the coarser grid
/// (Trottenberg, Oosterlee, Schüller, *Multigrid*, 2001, section 2.1.2).
const DAMPING: f64 = 0.8;

/// Smoothing steps before and after the coarser grid has been asked.
const SMOOTHING: usize = 2;

/// The residual has fallen enough, as a share of what it was: below the rounding of heights in `f32`.
const TOLERANCE: f64 = 1e-8;

/// Iterations that no problem of this kind has come near to.
const MOST_ITERATIONS: usize = 200;

/// Steps wanted between neighbours.
pub(super) struct Steps {
    /// Nodes along x.
    pub(super) columns: usize,
    /// From each node to the next one along x, in the order of the nodes; those of the last column
    /// do not count.
    pub(super) along_x: Vec<f32>,
    /// The same along y; those of the last row do not count.
    pub(super) along_y: Vec<f32>,
}

/// The heights that fit the steps best, 0 where `is_fixed` holds. `tick` counts iterations; `None`
/// if it stopped the work.
pub(super) fn solve(
    steps: Steps,
    is_fixed: impl Fn(usize) -> bool + Sync,
    tick: Tick<'_>,
) -> Option<Vec<f64>> {
    let (columns, rows) = (steps.columns, steps.along_x.len() / steps.columns);
    let mut residual = right_side(&steps, &is_fixed);
    drop(steps);
    let mut cycle = Cycle::over(Grid::finest(columns, rows, &is_fixed));
    let mut heights = vec![0.0; residual.len()];
    let mut direction = vec![0.0; residual.len()];
    let mut image = vec![0.0; residual.len()];
    let enough = TOLERANCE * dot(&residual, &residual, columns).sqrt();
    let mut before = f64::INFINITY;
    for _ in 0..MOST_ITERATIONS {
        if dot(&residual, &residual, columns).sqrt() <= enough {
            break;
        }
        tick(1).then_some(())?;
        let corrected = cycle.correction(&residual);
        let now = dot(corrected, &residual, columns);
        let keep = now / before;
        before = now;
        direction.par_iter_mut().zip(corrected).for_each(|(d, c)| *d = c + keep * *d);
        cycle.grid().apply(&direction, &mut image);
        let length = now / dot(&direction, &image, columns);
        heights.par_iter_mut().zip(&direction).for_each(|(z, d)| *z += length * d);
        residual.par_iter_mut().zip(&image).for_each(|(r, i)| *r -= length * i);
    }
    if cycle.grid().is_free() {
        let mean = sum(&heights, columns) / heights.len() as f64;
        heights.par_iter_mut().for_each(|z| *z -= mean);
    }
    Some(heights)
}

/// What flows into each node: the steps that lead to it less those that lead away.
fn right_side(steps: &Steps, is_fixed: &(impl Fn(usize) -> bool + Sync)) -> Vec<f64> {
    let Steps { columns, along_x, along_y } = steps;
    let (columns, count) = (*columns, along_x.len());
    let inflow = |at: usize| {
        let column = at % columns;
        let step = |counts: bool, steps: &[f32], at: usize| match counts {
            true => f64::from(steps[at]),
            false => 0.0,
        };
        step(column > 0, along_x, at.wrapping_sub(1)) - step(column + 1 < columns, along_x, at)
            + step(at >= columns, along_y, at.wrapping_sub(columns))
            - step(at + columns < count, along_y, at)
    };
    let of = |at: usize| if is_fixed(at) { 0.0 } else { inflow(at) };
    (0..count).into_par_iter().map(of).collect()
}

/// The sum of products, in an order of its own.
fn dot(a: &[f64], b: &[f64], columns: usize) -> f64 {
    let rows = a.par_chunks(columns).zip(b.par_chunks(columns));
    let sums = rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum());
    sums.collect::<Vec<f64>>().iter().sum()
}

fn sum(values: &[f64], columns: usize) -> f64 {
    let sums = values.par_chunks(columns).map(|row| row.iter().sum());
    sums.collect::<Vec<f64>>().iter().sum()
}

/// The equations of one grid.
struct Grid {
    columns: usize,
    rows: usize,
    /// Weight between a node and the next one along x; 0 in the last column and beside fixed nodes.
    right: Vec<f32>,
    /// Weight between a node and the next one along y.
    up: Vec<f32>,
    /// Sum of all weights of a node, those to fixed ones too; 0 for the fixed ones.
    whole: Vec<f32>,
}

impl Grid {
    fn finest(columns: usize, rows: usize, is_fixed: &(impl Fn(usize) -> bool + Sync)) -> Self {
        let count = columns * rows;
        let free = |at: usize| !is_fixed(at);
        let weight = |is_one: bool| if is_one { 1.0 } else { 0.0 };
        let has_right = |at: usize| at % columns + 1 < columns;
        let right = |at: usize| weight(has_right(at) && free(at) && free(at + 1));
        let up = |at: usize| weight(at + columns < count && free(at) && free(at + columns));
        let whole = |at: usize| {
            let neighbours =
                [has_right(at), !at.is_multiple_of(columns), at + columns < count, at >= columns];
            let count = neighbours.iter().filter(|there| **there).count();
            if free(at) { count as f32 } else { 0.0 }
        };
        let nodes = || (0..count).into_par_iter();
        Self {
            columns,
            rows,
            right: nodes().map(right).collect(),
            up: nodes().map(up).collect(),
            whole: nodes().map(whole).collect(),
        }
    }

    /// Whether no node is fixed.
    fn is_free(&self) -> bool {
        (0..self.whole.len()).into_par_iter().all(|at| self.leak(at) == 0.0)
    }

    /// The weight of a node to fixed ones.
    fn leak(&self, at: usize) -> f32 {
        self.whole[at] - self.weights(at).iter().sum::<f32>()
    }

    /// The weights to the neighbours on the left, right, near and far side; 0 where there is none.
    fn weights(&self, at: usize) -> [f32; 4] {
        let left = if !at.is_multiple_of(self.columns) { self.right[at - 1] } else { 0.0 };
        let near = if at >= self.columns { self.up[at - self.columns] } else { 0.0 };
        [left, self.right[at], near, self.up[at]]
    }

    /// The grid of half as many nodes each way.
    fn coarser(&self) -> Self {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let cells = || (0..columns * rows).into_par_iter();
        let nodes = |cell: usize| {
            let (i, j) = (2 * (cell % columns), 2 * (cell / columns));
            let across = i..(i + 2).min(self.columns);
            (j..(j + 2).min(self.rows))
                .flat_map(move |j| across.clone().map(move |i| j * self.columns + i))
        };
        // Only the edges that leave a cell have a place on the coarser grid.
        let right = |cell: usize| {
            let leaving = nodes(cell).filter(|at| at % self.columns % 2 == 1);
            0.5 * leaving.map(|at| self.right[at]).sum::<f32>()
        };
        let up = |cell: usize| {
            let leaving = nodes(cell).filter(|at| at / self.columns % 2 == 1);
            0.5 * leaving.map(|at| self.up[at]).sum::<f32>()
        };
        let leak = |cell: usize| {
            let is_cut = nodes(cell).any(|at| self.whole[at] == 0.0);
            nodes(cell).map(|at| coarser_leak(self.leak(at), is_cut)).sum()
        };
        let whole = cells().map(leak).collect();
        let (right, up) = (cells().map(right).collect(), cells().map(up).collect());
        let mut grid = Self { columns, rows, right, up, whole };
        let whole = |at: usize| grid.whole[at] + grid.weights(at).iter().sum::<f32>();
        grid.whole = cells().map(whole).collect();
        grid
    }

    /// Calls `change` for each node with what it is to be changed, Σ w·z of its neighbours and the
    /// node's number.
    fn each(&self, values: &[f64], out: &mut [f64], change: impl Fn(&mut f64, f64, usize) + Sync) {
        let columns = self.columns;
        out.par_chunks_exact_mut(columns).enumerate().for_each(|(j, row)| {
            let first = j * columns;
            for (i, out) in row.iter_mut().enumerate() {
                let at = first + i;
                let mut sum = f64::from(self.right[at]) * values[(at + 1).min(values.len() - 1)];
                if i > 0 {
                    sum += f64::from(self.right[at - 1]) * values[at - 1];
                }
                if j > 0 {
                    sum += f64::from(self.up[at - columns]) * values[at - columns];
                }
                if j + 1 < self.rows {
                    sum += f64::from(self.up[at]) * values[at + columns];
                }
                change(out, sum, at);
            }
        });
    }

    /// The left side of the equations.
    fn apply(&self, values: &[f64], image: &mut [f64]) {
        self.each(values, image, |out, sum, at| {
            *out = f64::from(self.whole[at]) * values[at] - sum;
        });
    }
}

/// What a node's weight to fixed ones adds to that of its cell. Weight w stands for a zero at distance
/// 1/w. Seen from the middle of the cell it is half a step farther away, or nearer if it lies in the
/// cell, which then `is_cut`; steps are twice as long and pairs of nodes become one, so there remains
/// 1/(1/w ± 1/2).
fn coarser_leak(leak: f32, is_cut: bool) -> f32 {
    // A zero beyond the middle is taken for one close to it.
    const LEAST: f32 = 0.25;
    let half = if is_cut { -0.5 } else { 0.5 };
    leak / (1.0 + half * leak).max(LEAST)
}

/// One grid of the V-cycle with its working memory.
struct Depth {
    grid: Grid,
    values: Vec<f64>,
    wanted: Vec<f64>,
    scratch: Vec<f64>,
}

/// The V-cycle, finest grid first.
struct Cycle(Vec<Depth>);

impl Cycle {
    fn over(finest: Grid) -> Self {
        let mut grids = vec![finest];
        while let Some(grid) = grids.last().filter(|grid| grid.whole.len() > 1) {
            grids.push(grid.coarser());
        }
        let depth = |grid: Grid| {
            let zeros = || vec![0.0; grid.whole.len()];
            Depth { values: zeros(), wanted: zeros(), scratch: zeros(), grid }
        };
        Self(grids.into_iter().map(depth).collect())
    }

    fn grid(&self) -> &Grid {
        &self.0[0].grid
    }

    /// About the solution of the equations for a right side.
    fn correction(&mut self, right_side: &[f64]) -> &[f64] {
        self.0[0].wanted.copy_from_slice(right_side);
        descend(&mut self.0);
        &self.0[0].values
    }
}

fn descend(depths: &mut [Depth]) {
    let Some((fine, below)) = depths.split_first_mut() else { return };
    fine.start();
    (1..SMOOTHING).for_each(|_| fine.smooth());
    if let Some(coarse) = below.first_mut() {
        fine.leave_residual();
        fine.hand_up(coarse);
        descend(below);
        fine.take_down(&below[0]);
    }
    (0..SMOOTHING).for_each(|_| fine.smooth());
}

/// 1/w, or 0 for a node without equation.
fn inverse(whole: f32) -> f64 {
    if whole > 0.0 { 1.0 / f64::from(whole) } else { 0.0 }
}

impl Depth {
    /// A smoothing step from zeros.
    fn start(&mut self) {
        let equations = self.wanted.par_iter().zip(&self.grid.whole);
        let values = self.values.par_iter_mut().zip(equations);
        values.for_each(|(value, (wanted, whole))| *value = DAMPING * wanted * inverse(*whole));
    }

    fn smooth(&mut self) {
        let Self { grid, values, wanted, scratch } = self;
        grid.each(values, scratch, |out, sum, at| {
            let settled = (wanted[at] + sum) * inverse(grid.whole[at]);
            *out = values[at] + DAMPING * (settled - values[at]);
        });
        std::mem::swap(values, scratch);
    }

    /// Puts what the values leave to be wished into the scratch space.
    fn leave_residual(&mut self) {
        let Self { grid, values, wanted, scratch } = self;
        grid.each(values, scratch, |out, sum, at| {
            *out = wanted[at] - (f64::from(grid.whole[at]) * values[at] - sum);
        });
    }

    /// Gives each coarse node the residual around it.
    fn hand_up(&self, coarse: &mut Depth) {
        let (fine, grid) = (&self.grid, &coarse.grid);
        coarse.wanted.par_chunks_exact_mut(grid.columns).enumerate().for_each(|(j, row)| {
            let from_rows = shares(j, grid.rows, fine.rows);
            for (i, wanted) in row.iter_mut().enumerate() {
                let from_columns = shares(i, grid.columns, fine.columns);
                let along = |j: usize| -> f64 {
                    let at = |i: usize| self.scratch[j * fine.columns + i];
                    from_columns.iter().map(|(i, share)| share * at(*i)).sum()
                };
                *wanted = from_rows.iter().map(|(j, share)| share * along(*j)).sum();
            }
        });
    }

    /// Adds what the coarse grid found. Fixed nodes are brought back to 0.
    fn take_down(&mut self, coarse: &Depth) {
        let (columns, whole) = (self.grid.columns, &self.grid.whole);
        let (across, down) = (coarse.grid.columns, coarse.grid.rows);
        self.values.par_chunks_exact_mut(columns).enumerate().for_each(|(j, row)| {
            let (own, next) = (j / 2, beside(j, down));
            let line = |j: usize| &coarse.values[j * across..][..across];
            let (own, next) = (line(own), line(next));
            let at = |i: usize| 0.75 * own[i] + 0.25 * next[i];
            for (i, value) in row.iter_mut().enumerate() {
                if whole[j * columns + i] > 0.0 {
                    *value += 0.75 * at(i / 2) + 0.25 * at(beside(i, across));
                }
            }
        });
    }
}

/// The coarse node next nearest to fine node `k`: on the other side of it than its own, or its own
/// at the border.
fn beside(k: usize, count: usize) -> usize {
    let own = k / 2;
    if k % 2 == 1 { (own + 1).min(count - 1) } else { own.saturating_sub(1) }
}

/// The fine nodes that take from coarse node `k`, and how much: the transpose of [`Depth::take_down`].
/// Those beyond the border stand for nothing, with share 0.
fn shares(k: usize, coarse: usize, fine: usize) -> [(usize, f64); 4] {
    let own = |is_border: bool| if is_border { 1.0 } else { 0.75 };
    let share = [0.25, own(k == 0), own(k + 1 == coarse), 0.25];
    [0, 1, 2, 3].map(|n| match (2 * k + n).checked_sub(1) {
        Some(node) if node < fine => (node, share[n]),
        _ => (0, 0.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    const SIZES: [(usize, usize); 9] =
        [(1, 1), (1, 2), (1, 33), (57, 1), (2, 2), (3, 5), (64, 64), (101, 37), (129, 255)];

    /// The steps of heights that are known.
    fn steps_of(heights: &[f64], columns: usize) -> Steps {
        let step = |at: usize, by: usize| {
            heights.get(at + by).map_or(9.0, |next| (next - heights[at]) as f32)
        };
        let all = |by: usize| (0..heights.len()).map(|at| step(at, by)).collect();
        Steps { columns, along_x: all(1), along_y: all(columns) }
    }

    fn wavy(columns: usize, rows: usize) -> Vec<f64> {
        let height = |at: usize| {
            let (x, y) = ((at % columns) as f64, (at / columns) as f64);
            3.0 * (0.11 * x + 0.05 * y).sin() + (0.3 * x).cos() * (0.21 * y).sin() + 0.02 * x
        };
        (0..columns * rows).map(height).collect()
    }

    #[track_caller]
    fn assert_near(found: &[f64], expected: &[f64], tolerance: f64) {
        for (at, (a, b)) in found.iter().zip(expected).enumerate() {
            assert!((a - b).abs() < tolerance, "node {at}: {a} for {b}");
        }
    }

    #[test]
    fn the_steps_of_a_field_give_the_field_but_for_its_mean() {
        for (columns, rows) in SIZES {
            let field = wavy(columns, rows);
            let found = solve(steps_of(&field, columns), |_| false, &|_| true).unwrap();
            let mean = field.iter().sum::<f64>() / field.len() as f64;
            let expected: Vec<f64> = field.iter().map(|z| z - mean).collect();
            assert_near(&found, &expected, 1e-5);
        }
    }

    #[test]
    fn nodes_that_are_fixed_stay_and_the_others_fit_them() {
        for (columns, rows) in SIZES {
            // Islands of all shapes in a sea at 0, one node wide here and there.
            let level = wavy(columns, rows);
            let field: Vec<f64> = level.iter().map(|z| z.max(0.0)).collect();
            let found = solve(steps_of(&field, columns), |at| level[at] <= 0.0, &|_| true);
            assert_near(&found.unwrap(), &field, 1e-5);
        }
    }

    /// Steps that belong to no surface: each node's equation must hold all the same.
    #[test]
    fn every_equation_holds() {
        let (columns, rows) = (83, 61);
        let mut random = fastrand::Rng::with_seed(2);
        let mut noise = || (0..columns * rows).map(|_| random.f32() - 0.5).collect::<Vec<f32>>();
        let fixed: Vec<bool> = noise().iter().map(|value| *value > 0.45).collect();
        for is_fixed in [&|at: usize| fixed[at], &|_| false] as [&(dyn Fn(usize) -> bool + Sync); 2]
        {
            let steps = Steps { columns, along_x: noise(), along_y: noise() };
            let wanted = right_side(&steps, &is_fixed);
            let grid = Grid::finest(columns, rows, &is_fixed);
            let found = solve(steps, is_fixed, &|_| true).unwrap();
            let mut image = vec![0.0; found.len()];
            grid.apply(&found, &mut image);
            assert_near(&image, &wanted, 1e-6);
        }
    }

    #[test]
    fn the_number_of_iterations_does_not_grow_with_the_grid() {
        for size in [64, 255, 1000] {
            let (field, told) = (wavy(size, size), AtomicUsize::new(0));
            let middle = size as f64 / 2.0;
            let round = |at: usize| {
                ((at % size) as f64 - middle).hypot((at / size) as f64 - middle)
                    > 0.45 * size as f64
            };
            for is_fixed in [&round, &|_| false] as [&(dyn Fn(usize) -> bool + Sync); 2] {
                told.store(0, Ordering::Relaxed);
                let count = |n| told.fetch_add(n, Ordering::Relaxed) < usize::MAX;
                solve(steps_of(&field, size), is_fixed, &count).unwrap();
                let told = told.load(Ordering::Relaxed);
                assert!(told < 14, "{size}: {told}");
            }
        }
    }

    #[test]
    fn handing_up_is_the_transpose_of_taking_down() {
        for fine in [1, 2, 3, 8, 9] {
            let coarse = usize::div_ceil(fine, 2);
            for k in 0..coarse {
                for i in 0..fine {
                    let down = [(i / 2, 0.75), (beside(i, coarse), 0.25)];
                    let taken: f64 = down.iter().filter(|d| d.0 == k).map(|d| d.1).sum();
                    let up: f64 =
                        shares(k, coarse, fine).iter().filter(|s| s.0 == i).map(|s| s.1).sum();
                    assert_eq!(up, taken, "{fine}: {i} from {k}");
                }
            }
        }
    }

    #[test]
    fn it_stops_when_told_to() {
        assert!(solve(steps_of(&wavy(9, 9), 9), |_| false, &|_| false).is_none());
    }
}

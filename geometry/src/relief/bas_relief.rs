//! A deep surface made a shallow one that still shows its detail.
//!
//! Scaled down to a few millimetres, a head keeps its nose and loses its lips: most of the height is
//! spent on steps from one thing to the next behind it, and on wide slopes. So slopes are changed in
//! place of heights, and the surface is put together from them again:
//!
//! 1. Steps between neighbours give the slope g along each edge of the grid. What is steeper than a
//!    limit is an edge of one thing before another, and is set to 0.
//! 2. Slopes are compressed, g' = g/|g| · ln(1 + α|g|)/α, where |g| is made of the slope along the
//!    edge and the mean of the four across it. α = c/(1 - c) over the mean of |g|, so that a model
//!    and the same model twice as deep make one relief.
//! 3. Detail is what differs from the mean slope around it, g'' = g' + d·(g' - mean g'), the mean
//!    being Gaussian and passing over steps and background.
//! 4. Heights fit g'' by least squares (see `poisson`), with the background held at 0. What they sink
//!    below it, which least squares may do beside an outline by some hundredths of the depth, is
//!    raised to it, and they are scaled to the depth wanted.
//!
//! Steps 1, 2 and 4 are those of Weyrich, Deng, Barnes, Rusinkiewicz, Finkelstein, *Digital Bas-Relief
//! from 3D Scenes*, ACM Transactions on Graphics 26(3), 2007; step 3 is the unsharp masking of gradients by Kerber, Tevs, Belyaev, Zayer,
//! Seidel, *Feature Sensitive Bas Relief Generation*, Shape Modeling International 2009.
//!
//! Memory: 80 bytes a node. Time: some 10 iterations of the solver, linear in the nodes.

use super::blur;
use super::poisson::{self, Steps};
use crate::{HeightField, Tick};
use rayon::prelude::*;

/// What a bas-relief is to be like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BasRelief {
    /// From the background, or the lowest node, to the highest, in mm.
    pub depth_mm: f64,
    /// How much slopes are brought near to each other: 0 leaves them in proportion, at 0.5 the mean
    /// slope counts ln 2 of itself; below 1.
    pub compression: f64,
    /// How much of the detail is added to what is there already; 0 adds nothing.
    pub detail: f64,
    /// σ of the Gaussian that tells detail from form, in mm.
    pub detail_size_mm: f64,
    /// Slopes (height over distance) beyond which a step is one thing before another.
    pub steepest: f64,
    /// Nodes at this height, in mm, and below are background, which becomes flat; `None` if none is.
    pub background_mm: Option<f32>,
}

/// Heights of the bas-relief of a field, in mm and in its order: from 0, where the background lies or,
/// without any, the lowest node, to the depth. A field without slopes stays flat. `tick` is told of each step of the work, some 15; `None` if it stopped that.
#[must_use]
pub fn bas_relief(field: &HeightField, wanted: &BasRelief, tick: Tick<'_>) -> Option<Vec<f32>> {
    let go_on = || tick(1).then_some(());
    let is_background =
        |at: usize| wanted.background_mm.is_some_and(|level| field.heights()[at] <= level);
    let mut slopes = Slopes::of(field, wanted.steepest, is_background);
    go_on()?;
    slopes.compress(wanted.compression);
    go_on()?;
    if wanted.detail > 0.0 {
        let sigma_px = wanted.detail_size_mm / field.pitch_mm();
        for edges in [&mut slopes.along_x, &mut slopes.along_y] {
            edges.sharpen(wanted.detail, field.columns(), sigma_px);
        }
    }
    go_on()?;
    let Slopes { columns, along_x, along_y, .. } = slopes;
    let steps = Steps { columns, along_x: along_x.slope, along_y: along_y.slope };
    let heights = poisson::solve(steps, is_background, tick)?;
    let has_background = wanted
        .background_mm
        .is_some_and(|level| field.heights().par_iter().any(|height| *height <= level));
    let lowest = heights.par_iter().copied().reduce(|| f64::INFINITY, f64::min);
    let highest = heights.par_iter().copied().reduce(|| f64::NEG_INFINITY, f64::max);
    let zero = if has_background { 0.0 } else { lowest };
    let scale = if highest > zero { wanted.depth_mm / (highest - zero) } else { 0.0 };
    Some(heights.par_iter().map(|height| ((height - zero).max(0.0) * scale) as f32).collect())
}

/// The edges of a grid along one axis, each at the place of the node that it begins at.
struct Edges {
    /// Height over distance; 0 for steps.
    slope: Vec<f32>,
    /// 1 where an edge runs within one thing, 0 where it is a step, touches the background or leaves
    /// the grid.
    counts: Vec<f32>,
}

/// All edges of a grid.
struct Slopes {
    columns: usize,
    along_x: Edges,
    along_y: Edges,
}

impl Edges {
    /// `next` is the number of the node at the other end of an edge.
    fn of(
        field: &HeightField,
        steepest: f64,
        is_background: impl Fn(usize) -> bool + Sync,
        next: impl Fn(usize) -> Option<usize> + Sync,
    ) -> Self {
        let heights = field.heights();
        let edge = |at: usize| {
            let Some(next) = next(at) else { return (0.0, 0.0) };
            let rise = f64::from(heights[next]) - f64::from(heights[at]);
            let slope = rise / field.pitch_mm();
            if slope.abs() > steepest {
                return (0.0, 0.0);
            }
            (slope as f32, if is_background(at) || is_background(next) { 0.0 } else { 1.0 })
        };
        let (slope, counts) = (0..heights.len()).into_par_iter().map(edge).unzip();
        Self { slope, counts }
    }

    fn sharpen(&mut self, detail: f64, columns: usize, sigma_px: f64) {
        let mean = blur::mean(&self.slope, &self.counts, columns, sigma_px);
        let around = self.counts.par_iter().zip(mean);
        self.slope.par_iter_mut().zip(around).for_each(|(slope, (counts, mean))| {
            *slope += detail as f32 * counts * (*slope - mean);
        });
    }
}

impl Slopes {
    fn of(
        field: &HeightField,
        steepest: f64,
        is_background: impl Fn(usize) -> bool + Sync,
    ) -> Self {
        let (columns, count) = (field.columns(), field.heights().len());
        let right = |at: usize| (at % columns + 1 < columns).then_some(at + 1);
        let far = |at: usize| Some(at + columns).filter(|next| *next < count);
        Self {
            columns,
            along_x: Edges::of(field, steepest, &is_background, right),
            along_y: Edges::of(field, steepest, &is_background, far),
        }
    }

    /// |g| at each edge along x, then along y.
    fn magnitudes(&self) -> [Vec<f32>; 2] {
        let Self { columns, along_x, along_y } = self;
        let (columns, count) = (*columns, along_x.slope.len());
        // Those of the four edges across that there are; the border has half of them.
        let magnitude = |own: f32, across: [Option<f32>; 4]| {
            let there = across.iter().flatten().count().max(1);
            own.hypot(across.iter().flatten().sum::<f32>() / there as f32)
        };
        let at_x = |at: usize| {
            let before = at.checked_sub(columns);
            let y = |at: usize| along_y.slope.get(at).copied();
            let across = [Some(at), Some(at + 1), before, before.map(|at| at + 1)];
            magnitude(along_x.slope[at], across.map(|at| at.and_then(y)))
        };
        let at_y = |at: usize| {
            let x = |at: usize| along_x.slope.get(at).copied();
            let before = |at: usize| (!at.is_multiple_of(columns)).then(|| at - 1);
            let across = [Some(at), Some(at + columns), before(at), before(at + columns)];
            magnitude(along_y.slope[at], across.map(|at| at.and_then(x)))
        };
        let all = || (0..count).into_par_iter();
        [all().map(at_x).collect(), all().map(at_y).collect()]
    }

    fn compress(&mut self, compression: f64) {
        let magnitudes = self.magnitudes();
        let edges = [&mut self.along_x, &mut self.along_y];
        let (mut sum, mut count) = (0.0, 0.0);
        for (edges, magnitudes) in edges.iter().zip(&magnitudes) {
            let rows = edges.counts.chunks(self.columns).zip(magnitudes.chunks(self.columns));
            for (counts, magnitudes) in rows {
                let weighed = counts.iter().zip(magnitudes).map(|(n, m)| f64::from(n * m));
                sum += weighed.sum::<f64>();
                count += counts.iter().map(|n| f64::from(*n)).sum::<f64>();
            }
        }
        if sum == 0.0 || compression == 0.0 {
            return;
        }
        let alpha = compression / (1.0 - compression) * count / sum;
        for (edges, magnitudes) in edges.into_iter().zip(&magnitudes) {
            edges.slope.par_iter_mut().zip(magnitudes).for_each(|(slope, magnitude)| {
                let bent = alpha * f64::from(*magnitude);
                if bent > 0.0 {
                    *slope *= (bent.ln_1p() / bent) as f32;
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: BasRelief = BasRelief {
        depth_mm: 5.0,
        compression: 0.0,
        detail: 0.0,
        detail_size_mm: 1.0,
        steepest: f64::INFINITY,
        background_mm: None,
    };

    fn field(columns: usize, rows: usize, height: impl Fn(f64, f64) -> f64) -> HeightField {
        let place = |at: usize| ((at % columns) as f64 * 0.5, (at / columns) as f64 * 0.5);
        let heights = (0..columns * rows).map(|at| height(place(at).0, place(at).1) as f32);
        HeightField::new(columns, rows, 0.5, heights.collect()).unwrap()
    }

    fn made(field: &HeightField, wanted: &BasRelief) -> Vec<f32> {
        let heights = bas_relief(field, wanted, &|_| true).unwrap();
        assert!(heights.iter().all(|height| height.is_finite()));
        heights
    }

    fn hills(x: f64, y: f64) -> f64 {
        8.0 * (0.2 * x).sin() + 5.0 * (0.3 * y).cos() + 0.1 * x * y
    }

    #[test]
    fn with_nothing_asked_it_only_scales() {
        for (columns, rows) in [(2, 2), (2, 31), (45, 33)] {
            let deep = field(columns, rows, hills);
            let (low, size) = (deep.bounds().min.z, deep.bounds().size().z);
            for (flat, z) in made(&deep, &PLAIN).iter().zip(deep.heights()) {
                let expected = (f64::from(*z) - low) * 5.0 / size;
                assert!((f64::from(*flat) - expected).abs() < 1e-4, "{flat} {expected}");
            }
        }
    }

    /// A plane that rises at 1, then at 9: slopes become ln(1 + α) and ln(1 + 9α), α = 1/mean.
    #[test]
    fn slopes_are_compressed_by_the_logarithm() {
        let roof = field(41, 7, |x, _| if x <= 10.0 { x } else { 10.0 + 9.0 * (x - 10.0) });
        let flat = made(&roof, &BasRelief { compression: 0.5, ..PLAIN });
        let (gentle, steep) =
            (flat[3 * 41 + 20] - flat[3 * 41], flat[3 * 41 + 40] - flat[3 * 41 + 20]);
        // The edges along y have no slope of their own, but the |g| of the slope across.
        let alpha: f32 = 1.0 / 5.0;
        let expected = (9.0 * alpha).ln_1p() / alpha.ln_1p();
        assert!((steep / gentle / expected - 1.0).abs() < 0.01, "{} {expected}", steep / gentle);
        assert!((flat.iter().fold(0.0_f32, |a, b| a.max(*b)) - 5.0).abs() < 1e-4);
    }

    #[test]
    fn a_model_twice_as_deep_makes_the_same_relief() {
        let wanted = BasRelief { compression: 0.7, detail: 0.5, ..PLAIN };
        let (once, twice) = (field(33, 29, hills), field(33, 29, |x, y| 2.0 * hills(x, y)));
        for (a, b) in made(&once, &wanted).iter().zip(made(&twice, &wanted)) {
            assert!((a - b).abs() < 1e-3);
        }
    }

    #[test]
    fn what_stands_before_something_else_is_no_step_any_more() {
        // A slope of 1 that jumps by 40 in its middle.
        let cliff = field(40, 9, |x, _| x + if x > 9.8 { 40.0 } else { 0.0 });
        let flat = made(&cliff, &BasRelief { steepest: 6.0, ..PLAIN });
        let step = 5.0 / 38.0;
        for (at, pair) in flat[..40].windows(2).enumerate() {
            let expected = if at == 19 { 0.0 } else { step };
            assert!((f64::from(pair[1] - pair[0]) - expected).abs() < 1e-4, "{at}");
        }
    }

    #[test]
    fn the_background_stays_flat_at_0_and_the_rim_of_what_stands_on_it_too() {
        let ball = |x: f64, y: f64| {
            let square = 81.0 - (x - 11.0).powi(2) - (y - 10.0).powi(2);
            if square > 0.0 { 20.0 + square.sqrt() } else { -3.0 }
        };
        let deep = field(45, 41, ball);
        let wanted = BasRelief {
            compression: 0.6,
            steepest: 6.0,
            background_mm: Some(-3.0),
            detail: 1.0,
            ..PLAIN
        };
        let flat = made(&deep, &wanted);
        // Off the plate by a tenth of the depth at most, where the ball itself stands 23 mm above it.
        let (mut top, mut rim) = (0.0_f32, 0.0_f32);
        for (at, (flat, deep)) in flat.iter().zip(deep.heights()).enumerate() {
            match *deep < 0.0 {
                true => assert_eq!(*flat, 0.0),
                false if *deep < 22.0 => rim = rim.max(flat.abs()),
                false if at == 20 * 45 + 22 => top = *flat,
                false => {}
            }
        }
        assert!(top > 4.5 && rim < 0.5, "{top} {rim}");
        let ends = flat.iter().fold([0.0_f32; 2], |[low, high], z| [low.min(*z), high.max(*z)]);
        assert_eq!(ends, [0.0, 5.0]);
    }

    #[test]
    fn detail_gains_on_form() {
        let ripple = |x: f64, y: f64| 4.0 * (0.1 * x + 0.1 * y).sin() + 0.05 * (4.0 * x).sin();
        let deep = field(121, 61, ripple);
        // The ripple's share: the mean bend between three neighbours in a row.
        let bend = |wanted: &BasRelief| -> f32 {
            made(&deep, wanted).windows(3).map(|z| (z[0] - 2.0 * z[1] + z[2]).abs()).sum()
        };
        let ratio = bend(&BasRelief { detail: 1.0, ..PLAIN }) / bend(&PLAIN);
        assert!((1.7..2.1).contains(&ratio), "{ratio}");
    }

    #[test]
    fn what_is_flat_stays_flat_and_all_background_too() {
        for background_mm in [None, Some(1.0)] {
            let wanted = BasRelief { compression: 0.9, detail: 2.0, background_mm, ..PLAIN };
            let flat = made(&field(5, 3, |_, _| 1.0), &wanted);
            assert_eq!(flat, [0.0; 15]);
        }
    }
}

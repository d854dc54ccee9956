//! Plateaus taken out of a depth map that was saved with few levels.
//!
//! A depth map of 8 bits has 255 steps, and a gentle slope becomes a staircase that a cutter
//! reproduces. What was lost is known to a bound: the true value lies within half a step of the saved
//! one. So the picture is smoothed, and every pixel held within that bound.
//!
//! Smoothing: from coarse to fine, with s = 32, 16, 8, 4, 2, 1 px, each pixel moves by a quarter of the
//! second difference I(x - s) - 2 I(x) + I(x + s) along x, and by that along y. The difference counts only
//! if the saved values on both sides lie within a step and a half of the saved one in the middle:
//! beyond, it is no plateau but an edge or a steep slope, which stays as it is. A second difference
//! is 0 on every plane, so that slopes are kept. Coarse strides first bring the middles of wide treads
//! to their places, as in multigrid methods; finer ones then smooth between them.
//!
//! Limits: a tread wider than some 60 px stays level in its middle; what is less than a step high
//! cannot be told from a plateau; noise larger than a step stays (`bilateral_filter` takes it out).

use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;
use wide::f32x8;

/// Distances over which pixels are compared, and how often each is gone through.
const STRIDES: [usize; 6] = [32, 16, 8, 4, 2, 1];
const ROUNDS: usize = 3;
/// Rows of a chain that are gone through at once: some 5 % of them are computed twice.
const SECTION: usize = 128;
/// Pixels that are worked on at once.
const LANES: usize = 8;
/// In steps: neighbouring treads differ by one; more than this is an edge.
const EDGE: f32 = 1.5;

/// Turns the staircases of a depth map of few levels into slopes, without rounding edges.
#[derive(Clone, Debug, Params)]
pub(crate) struct DepthSmooth {
    /// Bits that the depth map was saved with, or had before it was brought to more.
    #[param(default = 8, range = 2..=16)]
    pub(crate) bits: u32,
}

#[derive(Inputs)]
pub(crate) struct Stepped<'a> {
    /// The depth map.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Sloped {
    /// The depth map with slopes, each pixel within half a step of what it was.
    image: GrayImage,
}

impl Node for DepthSmooth {
    const KIND: &'static str = "depth_smooth";
    type Inputs<'a> = Stepped<'a>;
    type Outputs = Sloped;

    fn run(&self, inputs: Stepped<'_>, cx: &Context<'_>) -> Result<Sloped, NodeError> {
        let saved = inputs.image;
        let step = 1.0 / ((1u32 << self.bits) - 1) as f32;
        let ticker = cx.ticker(STRIDES.len() * saved.height);
        let mut image = saved.clone();
        for stride in STRIDES {
            let pass = Pass { saved, stride, step };
            cx.completed(pass.smooth(&mut image.values, &|rows| ticker.tick(rows)))?;
        }
        Ok(Sloped { image })
    }
}

/// All rounds over pixels `stride` apart.
///
/// Rows that far apart are a chain, and know nothing of the other chains. A chain is gone through once: as
/// soon as a row has had a round, the row before it has its next, so that all rounds find their rows in the
/// processor's cache. Long chains are cut into sections, with as many rows on either side as there are rounds,
/// which are computed twice.
struct Pass<'a> {
    saved: &'a GrayImage,
    stride: usize,
    step: f32,
}

impl Pass<'_> {
    /// `None` if the tick says stop.
    fn smooth(&self, values: &mut [f32], tick: &(impl Fn(usize) -> bool + Sync)) -> Option<()> {
        let mut chains: Vec<Vec<&mut [f32]>> = Vec::new();
        chains.resize_with(self.stride, Vec::new);
        for (y, row) in values.chunks_exact_mut(self.saved.width).enumerate() {
            chains[y % self.stride].push(row);
        }
        chains.par_iter_mut().enumerate().try_for_each(|(first, chain)| {
            let margins = margins(chain);
            let sections = chain.par_chunks_mut(SECTION).zip(margins).enumerate();
            sections.try_for_each(|(section, (rows, [mut before, mut after]))| {
                let y = first + (section * SECTION - before.len()) * self.stride;
                let done = rows.len();
                let rows = rows.iter_mut().map(|row| &mut **row);
                let before = before.iter_mut().map(Vec::as_mut_slice);
                let after = after.iter_mut().map(Vec::as_mut_slice);
                self.smooth_rows(y, &mut before.chain(rows).chain(after).collect::<Vec<_>>());
                tick(done).then_some(())
            })
        })
    }

    /// All rounds over rows of a chain, the first of which is row `top` of the picture.
    fn smooth_rows(&self, top: usize, rows: &mut [&mut [f32]]) {
        let width = self.saved.width;
        let mut here = vec![0.0; width];
        // The row before the one that a round is at, as it was before that round.
        let mut before: [Vec<f32>; ROUNDS] = std::array::from_fn(|_| vec![0.0; width]);
        for newest in 0..rows.len() + ROUNDS - 1 {
            for (round, before) in before.iter_mut().enumerate() {
                let at = newest.checked_sub(round).filter(|at| *at < rows.len());
                let Some(at) = at else { continue };
                let (row, after) = rows[at..].split_at_mut(1);
                here.copy_from_slice(row[0]);
                let beside = after.first().filter(|_| at > 0).map(|after| [&before[..], &**after]);
                self.smooth_row(top + at * self.stride, row[0], &here, beside);
                std::mem::swap(before, &mut here);
            }
        }
    }

    /// One round over row `y`: `here` as it is, and the rows on both sides of it, if there are two.
    fn smooth_row(&self, y: usize, row: &mut [f32], here: &[f32], beside: Option<[&[f32]; 2]>) {
        let (width, stride) = (self.saved.width, self.stride);
        let saved_row = |y: usize| &self.saved.values[y * width..][..width];
        let saved = saved_row(y);
        if width > 2 * stride {
            let count = width - 2 * stride;
            let [a, m, b] = [0, stride, 2 * stride].map(|first| &here[first..][..count]);
            let [saved_a, saved_m, saved_b] =
                [0, stride, 2 * stride].map(|first| &saved[first..][..count]);
            let lines = [a, m, b, saved_a, saved_m, saved_b];
            by_lanes(&mut row[stride..][..count], lines, |out, lanes| out + self.change(lanes));
        }
        let half = f32x8::splat(0.5 * self.step);
        let held = |out: f32x8, saved: f32x8| out.fast_max(saved - half).fast_min(saved + half);
        if let Some([before, after]) = beside {
            let [saved_before, saved_after] = [y - stride, y + stride].map(saved_row);
            let lines = [before, here, after, saved_before, saved, saved_after];
            by_lanes(row, lines, |out, lanes| held(out + self.change(lanes), lanes[4]));
        } else {
            by_lanes(row, [saved], |out, [saved]| held(out, saved));
        }
    }

    /// A quarter of the second differences, where they are those of treads: of pixels before, in and
    /// after the middle as they are now, then as they were saved.
    fn change(&self, [a, m, b, saved_a, saved_m, saved_b]: [f32x8; 6]) -> f32x8 {
        let edge = f32x8::splat(EDGE * self.step);
        let is_tread =
            (saved_a - saved_m).abs().simd_lt(edge) & (saved_b - saved_m).abs().simd_lt(edge);
        is_tread.select(0.25 * (a - 2.0 * m + b), f32x8::ZERO)
    }
}

/// Copies of the rows before and after each section of a chain, as many as there are rounds.
fn margins(chain: &[&mut [f32]]) -> Vec<[Vec<Vec<f32>>; 2]> {
    let copies = |rows: &[&mut [f32]]| rows.iter().map(|row| row.to_vec()).collect();
    let around = |first: usize| {
        let end = chain.len().min(first + SECTION);
        let (before, after) = (first.saturating_sub(ROUNDS), chain.len().min(end + ROUNDS));
        [copies(&chain[before..first]), copies(&chain[end..after])]
    };
    (0..chain.len()).step_by(SECTION).map(around).collect()
}

/// Replaces `out` by what `work` makes of it and of the pixels at the same places of `lines`, which are as
/// long.
fn by_lanes<const N: usize>(
    out: &mut [f32],
    lines: [&[f32]; N],
    work: impl Fn(f32x8, [f32x8; N]) -> f32x8,
) {
    let (blocks, rest) = out.as_chunks_mut::<LANES>();
    let lines = lines.map(|line| line.as_chunks::<LANES>());
    for (k, block) in blocks.iter_mut().enumerate() {
        let lanes = lines.map(|(blocks, _)| f32x8::new(blocks[k]));
        *block = work(f32x8::new(*block), lanes).to_array();
    }
    let padded =
        |rest: &[f32]| f32x8::new(std::array::from_fn(|k| rest.get(k).copied().unwrap_or(0.0)));
    let last = work(padded(rest), lines.map(|(_, rest)| padded(rest))).to_array();
    rest.copy_from_slice(&last[..rest.len()]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    const STEP: f64 = 1.0 / 255.0;

    fn picture(width: usize, height: usize, value: impl Fn(f64, f64) -> f64) -> GrayImage {
        let at = |k: usize| value((k % width) as f64, (k / width) as f64) as f32;
        GrayImage { width, height, values: (0..width * height).map(at).collect() }
    }

    fn stepped(image: &GrayImage) -> GrayImage {
        let step = STEP as f32;
        let values = image.values.iter().map(|value| (value / step).round() * step).collect();
        GrayImage { values, ..*image }
    }

    fn smoothed(image: &GrayImage) -> GrayImage {
        run(|cx| DepthSmooth { bits: 8 }.run(Stepped { image }, cx)).unwrap().image
    }

    /// The root mean square of the difference of slopes along x, in steps a pixel, away from the border.
    fn roughness(image: &GrayImage, exact: &GrayImage) -> f64 {
        let slope =
            |image: &GrayImage, k: usize| f64::from(image.values[k + 1] - image.values[k]) / STEP;
        let inner = |k: &usize| (40..image.width - 40).contains(&(k % image.width));
        let all: Vec<f64> = (0..image.values.len() - 1)
            .filter(inner)
            .map(|k| (slope(image, k) - slope(exact, k)).powi(2))
            .collect();
        (all.iter().sum::<f64>() / all.len() as f64).sqrt()
    }

    #[test]
    fn a_staircase_becomes_the_slope_that_it_was() {
        for run_px in [3.0, 8.0, 13.0, 20.0] {
            let exact = picture(240, 9, |x, y| STEP * (20.0 + x / run_px + 0.02 * y));
            let (stairs, slope) = (stepped(&exact), smoothed(&stepped(&exact)));
            let (before, after) = (roughness(&stairs, &exact), roughness(&slope, &exact));
            assert!(after < 0.25 * before, "a tread of {run_px} px: {before} to {after}");
        }
    }

    #[test]
    fn a_dome_gets_nearer_to_what_it_was() {
        let dome = |x: f64, y: f64| {
            0.3 + 0.1 * (1.0 - ((x - 60.0) / 80.0).powi(2) - ((y - 50.0) / 80.0).powi(2))
        };
        let exact = picture(121, 101, dome);
        let off = |image: &GrayImage| {
            let square = |(a, b): (&f32, &f32)| f64::from(a - b).powi(2);
            image.values.iter().zip(&exact.values).map(square).sum::<f64>().sqrt()
        };
        let stairs = stepped(&exact);
        assert!(off(&smoothed(&stairs)) < 0.6 * off(&stairs));
    }

    #[test]
    fn nothing_moves_by_more_than_half_a_step() {
        let mut random = fastrand::Rng::with_seed(2);
        let values = (0..70 * 90).map(|_| f32::from(random.u8(..)) / 255.0).collect();
        let image = GrayImage { width: 70, height: 90, values };
        let moved = smoothed(&image).values.into_iter().zip(&image.values);
        assert!(moved.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) <= 0.5 * STEP as f32 + 1e-7);
    }

    #[test]
    fn an_edge_and_an_exact_slope_stay_as_they_are() {
        let edge = picture(100, 5, |x, _| if x < 50.0 { 0.2 } else { 0.7 });
        assert_eq!(smoothed(&edge), edge);
        let steep = picture(100, 5, |x, _| 2.0 * STEP * x);
        assert_eq!(smoothed(&steep), steep);
        let line = picture(1, 7, |_, y| STEP * y);
        assert!(smoothed(&line).values.iter().zip(&line.values).all(|(a, b)| (a - b).abs() < 1e-6));
    }
}

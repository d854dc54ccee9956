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
        let ticker = cx.ticker(STRIDES.len() * ROUNDS * saved.height);
        let mut image = saved.clone();
        let mut next = vec![0.0; saved.values.len()];
        for stride in STRIDES {
            for _ in 0..ROUNDS {
                let round = Round { values: &image.values, saved, stride, step };
                let rows = next.par_chunks_exact_mut(saved.width).enumerate();
                let done = rows.try_for_each(|(y, row)| {
                    round.smooth_row(y, row);
                    ticker.tick(1).then_some(())
                });
                cx.completed(done)?;
                std::mem::swap(&mut image.values, &mut next);
            }
        }
        Ok(Sloped { image })
    }
}

/// One round over pixels `stride` apart.
struct Round<'a> {
    values: &'a [f32],
    saved: &'a GrayImage,
    stride: usize,
    step: f32,
}

/// Some pixels of a row: what they are now and what was saved.
type Pixels<'a> = (&'a [f32], &'a [f32]);

impl<'a> Round<'a> {
    /// The pixels of row `y` from column `first` on.
    fn pixels(&self, y: usize, first: usize, count: usize) -> Pixels<'a> {
        let at = y * self.saved.width + first;
        (&self.values[at..at + count], &self.saved.values[at..at + count])
    }

    fn smooth_row(&self, y: usize, row: &mut [f32]) {
        let (width, stride) = (self.saved.width, self.stride);
        let (here, saved) = self.pixels(y, 0, width);
        row.copy_from_slice(here);
        if width > 2 * stride {
            let count = width - 2 * stride;
            let at = |first| self.pixels(y, first, count);
            self.flatten(&mut row[stride..][..count], at(0), at(stride), at(2 * stride));
        }
        if y >= stride && y + stride < self.saved.height {
            let at = |y| self.pixels(y, 0, width);
            self.flatten(row, at(y - stride), at(y), at(y + stride));
        }
        for (out, saved) in row.iter_mut().zip(saved) {
            *out = out.clamp(saved - 0.5 * self.step, saved + 0.5 * self.step);
        }
    }

    /// Adds a quarter of the second differences to `out`, where they are those of treads.
    fn flatten(&self, out: &mut [f32], before: Pixels, middle: Pixels, after: Pixels) {
        let edge = f32x8::splat(EDGE * self.step);
        let change = |first: usize, count: usize| {
            let lanes = |line: &[f32]| f32x8::from(&line[first..first + count]);
            let [a, m, b] = [before, middle, after].map(|(values, _)| lanes(values));
            let [sa, sm, sb] = [before, middle, after].map(|(_, saved)| lanes(saved));
            let is_tread = (sa - sm).abs().simd_lt(edge) & (sb - sm).abs().simd_lt(edge);
            is_tread.select(0.25 * (a - 2.0 * m + b), f32x8::ZERO)
        };
        let (blocks, rest) = out.as_chunks_mut::<LANES>();
        let done = blocks.len() * LANES;
        for (k, block) in blocks.iter_mut().enumerate() {
            *block = (f32x8::from(*block) + change(k * LANES, LANES)).to_array();
        }
        let last = change(done, rest.len()).to_array();
        rest.iter_mut().zip(last).for_each(|(out, change)| *out += change);
    }
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

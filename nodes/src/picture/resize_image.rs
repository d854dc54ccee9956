//! A picture made larger or smaller.
//!
//! Lanczos' kernel L(x) = sinc(x)·sinc(x/3) for |x| < 3 (C. Duchon, *Lanczos Filtering in One and Two
//! Dimensions*, J. Appl. Meteor. 18, 1979), along y and then along x. When shrinking, the kernel is
//! stretched by the factor, so that every pixel counts by the area it has in the result and fine
//! patterns do not turn into coarse ones. Weights of a pixel add up to 1; beyond the border the kernel
//! is cut off. Lanczos overshoots at edges by some percent; the result is held within the range of
//! the given picture, so that it gives no height that was not asked for.

use super::rows::{brighter, by_rows, darker, range, weighted_sum};
use crate::picture::MAX_PIXELS;
use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use std::f64::consts::PI;

/// Half width of Lanczos' kernel, in pixels of the coarser picture.
const LOBES: f64 = 3.0;

/// Weights that are multiplied at once.
const GROUP: usize = 8;

/// Makes a picture larger or smaller, its proportions kept.
#[derive(Clone, Debug, Params)]
pub(crate) struct ResizeImage {
    /// The longer side of the result; 0 leaves the picture as it is.
    #[param(unit = "px", default = 0, range = 0..=100_000)]
    pub(crate) longer_side: u32,
}

#[derive(Inputs)]
pub(crate) struct Given<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Resized {
    /// The larger or smaller one.
    image: GrayImage,
}

impl Node for ResizeImage {
    const KIND: &'static str = "resize_image";
    const VERSION: u32 = 2;
    type Inputs<'a> = Given<'a>;
    type Outputs = Resized;

    fn run(&self, inputs: Given<'_>, cx: &Context<'_>) -> Result<Resized, NodeError> {
        let image = inputs.image;
        let longer = image.width.max(image.height);
        if self.longer_side == 0 || self.longer_side as usize == longer {
            return Ok(Resized { image: image.clone() });
        }
        let scale = f64::from(self.longer_side) / longer as f64;
        let side = |count: usize| ((count as f64 * scale).round() as usize).max(1);
        let (width, height) = (side(image.width), side(image.height));
        if (width * height) as u64 > MAX_PIXELS {
            let message = format!("{width} × {height} px are asked for; the limit is {MAX_PIXELS}");
            return Err(NodeError::Refused { param: "longer_side", message });
        }
        let (dark, bright) = range(image);
        let across: Vec<Tap> = taps(image.width, width).into_iter().map(Tap::padded).collect();
        let down = taps(image.height, height);
        let image = by_rows((width, height), cx, |y, row| {
            let tap = &down[y];
            let source = |k: usize| &image.values[(tap.first + k) * image.width..][..image.width];
            let lines: Vec<&[f32]> = (0..tap.weights.len()).map(source).collect();
            // Padded as the weights are.
            let mut line = vec![0.0; image.width + GROUP];
            weighted_sum(&lines, &tap.weights, &mut line[..image.width]);
            for (value, tap) in row.iter_mut().zip(&across) {
                *value = brighter(dark, darker(bright, tap.sum(&line)));
            }
        })?;
        Ok(Resized { image })
    }
}

/// The pixels that one pixel of the result is made of.
#[derive(Debug)]
struct Tap {
    first: usize,
    weights: Vec<f32>,
}

impl Tap {
    /// With weights of 0 added, to whole groups.
    fn padded(mut self) -> Self {
        self.weights.resize(self.weights.len().next_multiple_of(GROUP), 0.0);
        self
    }

    /// The sum of pixels times weights along a line, in groups that the compiler makes vectors of.
    fn sum(&self, line: &[f32]) -> f32 {
        let (weights, _) = self.weights.as_chunks::<GROUP>();
        let (values, _) = line[self.first..].as_chunks::<GROUP>();
        let mut sums = [0.0; GROUP];
        for (weights, values) in weights.iter().zip(values) {
            for k in 0..GROUP {
                sums[k] += weights[k] * values[k];
            }
        }
        sums.iter().sum()
    }
}

/// Those of every pixel along a line of `from` pixels that becomes one of `to`.
fn taps(from: usize, to: usize) -> Vec<Tap> {
    let step = from as f64 / to as f64;
    let stretch = step.max(1.0);
    let tap = |i: usize| {
        let middle = (i as f64 + 0.5) * step - 0.5;
        let first = (middle - LOBES * stretch).ceil().max(0.0) as usize;
        let last = ((middle + LOBES * stretch).floor() as usize).min(from - 1);
        let weights = (first..=last).map(|k| lanczos((k as f64 - middle) / stretch));
        let weights: Vec<f64> = weights.collect();
        let sum: f64 = weights.iter().sum();
        Tap { first, weights: weights.iter().map(|weight| (weight / sum) as f32).collect() }
    };
    (0..to).map(tap).collect()
}

fn lanczos(x: f64) -> f64 {
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
    if x.abs() < LOBES { sinc(x) * sinc(x / LOBES) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn resize(longer_side: u32, image: &GrayImage) -> GrayImage {
        run(|cx| ResizeImage { longer_side }.run(Given { image }, cx)).unwrap().image
    }

    fn picture(width: usize, height: usize, value: impl Fn(f64, f64) -> f64) -> GrayImage {
        let at = |k: usize| value((k % width) as f64 + 0.5, (k / width) as f64 + 0.5) as f32;
        GrayImage { width, height, values: (0..width * height).map(at).collect() }
    }

    #[test]
    fn weights_are_lanczos_and_add_up_to_one() {
        let taps = taps(10, 20);
        let tap = &taps[9];
        // The tenth of twenty lies at 4.25: pixels 2 to 7.
        assert_eq!((tap.first, tap.weights.len()), (2, 6));
        let ratio = lanczos(0.75) / lanczos(-0.25);
        assert!((f64::from(tap.weights[3] / tap.weights[2]) - ratio).abs() < 1e-6);
        assert!(taps.iter().all(|tap| (tap.weights.iter().sum::<f32>() - 1.0).abs() < 1e-6));
    }

    #[test]
    fn flat_stays_flat_and_proportions_are_kept() {
        let small = resize(40, &picture(100, 33, |_, _| 0.7));
        assert_eq!((small.width, small.height), (40, 13));
        assert!(small.values.iter().all(|value| (value - 0.7).abs() < 1e-6));
        let line = resize(5, &picture(1, 50, |_, y| y));
        assert_eq!((line.width, line.height), (1, 5));
        assert_eq!(resize(0, &picture(3, 2, |x, _| x)), picture(3, 2, |x, _| x));
    }

    #[test]
    fn a_wave_is_resampled_where_both_pictures_can_hold_it() {
        let wave = |scale: f64| {
            move |x: f64, y: f64| {
                0.5 + 0.2 * (0.2 * x / scale).sin() + 0.1 * (0.15 * y / scale).cos()
            }
        };
        for (longer, scale) in [(160, 2.0), (40, 0.5), (112, 1.4)] {
            let resized = resize(longer, &picture(80, 60, wave(1.0)));
            let exact = picture(resized.width, resized.height, wave(scale));
            for y in 10..resized.height - 10 {
                for x in 10..resized.width - 10 {
                    let at = y * resized.width + x;
                    assert!(
                        (resized.values[at] - exact.values[at]).abs() < 0.01,
                        "{longer}: {x}, {y}"
                    );
                }
            }
        }
    }

    #[test]
    fn shrinking_keeps_the_mean_and_makes_no_pattern_of_fine_stripes() {
        let stripes = picture(120, 120, |x, _| f64::from(x as u32 % 2));
        let small = resize(30, &stripes);
        assert!(small.values.iter().all(|value| (value - 0.5).abs() < 0.06));
    }
}

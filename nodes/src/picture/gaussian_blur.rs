//! Gaussian blur of a gray picture.
//!
//! Each pixel becomes the mean of its neighbours weighted by exp(-d² / 2σ²), one pass along x and
//! one along y. σ follows the kernel's width k as in OpenCV (`getGaussianKernel`):
//! σ = 0.3·((k - 1)/2 - 1) + 0.8, except that for k = 3, 5 and 7 OpenCV has fixed weights, which
//! are used here too. Beyond the border the picture is mirrored about its edge pixel (reflect-101),
//! so a flat picture stays flat.

use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;

/// Rows that are blurred together: enough that the rows above and below them, which are blurred
/// along x once more by the neighbouring band, count for little.
const BAND_ROWS: usize = 128;

/// Softens abrupt steps so that the cutter is not asked to jump.
#[derive(Clone, Debug, Params)]
pub(crate) struct GaussianBlur {
    /// Kernel width. Larger is softer; 1 leaves the picture as it is.
    #[param(unit = "px", default = 5, range = 1..=255, odd)]
    pub(crate) kernel: u32,
}

#[derive(Inputs)]
pub(crate) struct Sharp<'a> {
    /// The picture to soften.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Soft {
    /// The softened picture.
    image: GrayImage,
}

impl Node for GaussianBlur {
    const KIND: &'static str = "gaussian_blur";
    type Inputs<'a> = Sharp<'a>;
    type Outputs = Soft;

    fn run(&self, inputs: Sharp<'_>, cx: &Context<'_>) -> Result<Soft, NodeError> {
        Ok(Soft { image: self.blurred(inputs.image, cx)? })
    }
}

impl GaussianBlur {
    /// The softened picture.
    pub(super) fn blurred(
        &self,
        image: &GrayImage,
        cx: &Context<'_>,
    ) -> Result<GrayImage, NodeError> {
        if self.kernel == 1 {
            return Ok(image.clone());
        }
        let GrayImage { width, height, values } = image;
        let weights = weights(self.kernel as usize);
        let ticker = cx.ticker(*height);
        let mut blurred = vec![0.0; values.len()];
        blurred
            .par_chunks_mut(BAND_ROWS * width)
            .enumerate()
            .try_for_each(|(band, out)| {
                let tick = || ticker.tick(1);
                blur_band(image, &weights, band * BAND_ROWS, out, &tick)
            })
            .ok_or(NodeError::Cancelled)?;
        Ok(GrayImage { width: *width, height: *height, values: blurred })
    }
}

/// The kernel's weights from one end to the other; they add up to 1.
fn weights(kernel: usize) -> Vec<f32> {
    match kernel {
        3 => return vec![0.25, 0.5, 0.25],
        5 => return [1.0, 4.0, 6.0, 4.0, 1.0].map(|w| w / 16.0).to_vec(),
        7 => return [1.0, 3.5, 7.0, 9.0, 7.0, 3.5, 1.0].map(|w| w / 32.0).to_vec(),
        _ => {}
    }
    let middle = (kernel as f64 - 1.0) / 2.0;
    let sigma = 0.3 * (middle - 1.0) + 0.8;
    let weigh = |i: usize| (-(i as f64 - middle).powi(2) / (2.0 * sigma * sigma)).exp();
    let weights: Vec<f64> = (0..kernel).map(weigh).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| (weight / sum) as f32).collect()
}

/// The index that stands for `i` when a line of `count` is mirrored about its ends without
/// repeating them, as often as it takes.
pub(super) fn reflect(i: isize, count: usize) -> usize {
    let period = (2 * count as isize - 2).max(1);
    let i = i.rem_euclid(period);
    if i < count as isize { i as usize } else { (period - i) as usize }
}

/// Blurs the rows from `first` on into `out`. `tick` is called for each; `None` if it says stop.
fn blur_band(
    image: &GrayImage,
    weights: &[f32],
    first: usize,
    out: &mut [f32],
    tick: &dyn Fn() -> bool,
) -> Option<()> {
    let (width, reach) = (image.width, weights.len() / 2);
    let rows = out.len() / width;
    let mut along_x = vec![0.0; (rows + 2 * reach) * width];
    for (k, line) in along_x.chunks_exact_mut(width).enumerate() {
        let row = reflect((first + k) as isize - reach as isize, image.height);
        blur_line(&image.values[row * width..][..width], weights, line);
    }
    for (row, line) in out.chunks_exact_mut(width).enumerate() {
        for (weight, source) in weights.iter().zip(along_x[row * width..].chunks_exact(width)) {
            for (value, source) in line.iter_mut().zip(source) {
                *value += weight * source;
            }
        }
        if !tick() {
            return None;
        }
    }
    Some(())
}

fn blur_line(line: &[f32], weights: &[f32], out: &mut [f32]) {
    let (count, reach) = (line.len(), weights.len() / 2);
    let mirrored: Vec<f32> =
        (0..count + 2 * reach).map(|i| line[reflect(i as isize - reach as isize, count)]).collect();
    for (k, weight) in weights.iter().enumerate() {
        for (value, source) in out.iter_mut().zip(&mirrored[k..]) {
            *value += weight * source;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn blur(kernel: u32, width: usize, values: &[f32]) -> Vec<f32> {
        let image = GrayImage { width, height: values.len() / width, values: values.to_vec() };
        run(|cx| GaussianBlur { kernel }.run(Sharp { image: &image }, cx)).unwrap().image.values
    }

    fn ramp(count: usize) -> Vec<f32> {
        (0..count).map(|i| (i * i % 31) as f32 / 30.0).collect()
    }

    #[test]
    fn flat_stays_flat() {
        for kernel in [3, 5, 7, 9, 31] {
            let blurred = blur(kernel, 13, &[0.7; 13 * 9]);
            assert!(blurred.iter().all(|value| *value == blurred[0]), "kernel {kernel}");
            assert!((blurred[0] - 0.7).abs() < 1e-6);
        }
    }

    #[test]
    fn kernel_1_is_identity() {
        assert_eq!(blur(1, 5, &ramp(20)), ramp(20));
    }

    #[test]
    fn weights_match_opencv() {
        // A lone white pixel shows the product of the weights along x and y.
        let mut picture = vec![0.0; 13 * 13];
        picture[6 * 13 + 6] = 1.0;
        let fixed = |weights: &[f32]| {
            let reach = weights.len() / 2;
            let blurred = blur(weights.len() as u32, 13, &picture);
            for (i, along) in weights.iter().enumerate() {
                for (j, across) in weights.iter().enumerate() {
                    let value = blurred[(6 + j - reach) * 13 + 6 + i - reach];
                    assert!((value - along * across).abs() < 1e-7);
                }
            }
        };
        fixed(&[0.25, 0.5, 0.25]);
        fixed(&[0.0625, 0.25, 0.375, 0.25, 0.0625]);
        fixed(&[0.03125, 0.109_375, 0.21875, 0.28125, 0.21875, 0.109_375, 0.03125]);
    }

    #[test]
    fn wide_kernels_follow_opencvs_sigma() {
        // σ = 0.3·((9 - 1)/2 - 1) + 0.8 = 1.7, so neighbours of the middle weigh exp(-1/5.78).
        let weights = weights(9);
        assert!((weights[5] / weights[4] - (-1.0f32 / 5.78).exp()).abs() < 1e-6);
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn variances_add() {
        // The variance of a blurred point is the sum of the kernel's variances along x and y.
        let weights = weights(11);
        let variance: f32 =
            weights.iter().enumerate().map(|(i, w)| w * (i as f32 - 5.0).powi(2)).sum();
        let mut picture = vec![0.0; 31 * 31];
        picture[15 * 31 + 15] = 1.0;
        let blurred = blur(11, 31, &picture);
        let measured: f32 = blurred
            .iter()
            .enumerate()
            .map(|(i, v)| v * (((i % 31) as f32 - 15.0).powi(2) + ((i / 31) as f32 - 15.0).powi(2)))
            .sum();
        assert!((measured - 2.0 * variance).abs() < 1e-4);
    }

    #[test]
    fn the_border_is_mirrored_without_repeating_the_edge() {
        assert_eq!([-2, -1, 0, 3, 4, 5].map(|i| reflect(i, 4)), [2, 1, 0, 3, 2, 1]);
        assert_eq!([-7, -1, 0, 1, 9].map(|i| reflect(i, 1)), [0; 5]);
        assert_eq!([-3, -2, -1, 2, 3].map(|i| reflect(i, 2)), [1, 0, 1, 0, 1]);
    }

    #[test]
    fn a_picture_one_pixel_wide_is_blurred_along_its_length_only() {
        let line = ramp(9);
        let (tall, wide) = (blur(5, 1, &line), blur(5, 9, &line));
        assert!(tall.iter().zip(&wide).all(|(a, b)| (a - b).abs() < 1e-6));
    }

    #[test]
    fn bands_do_not_show() {
        let rows = 2 * BAND_ROWS + 3;
        let picture = ramp(rows * 3);
        let image = GrayImage { width: 3, height: rows, values: picture.clone() };
        let mut whole = vec![0.0; picture.len()];
        blur_band(&image, &weights(9), 0, &mut whole, &|| true).unwrap();
        assert_eq!(blur(9, 3, &picture), whole);
    }
}

//! Gaussian blur of a gray picture.
//!
//! Each pixel becomes the mean of its neighbours weighted by exp(-d² / 2σ²), one pass along y and
//! one along x. σ follows the kernel's width k as in OpenCV (`getGaussianKernel`):
//! σ = 0.3·((k - 1)/2 - 1) + 0.8, except that for k = 3, 5 and 7 OpenCV has fixed weights, which
//! are used here too; OpenCV 5 has some for k = 9 besides, which these follow within 0.5 % of the range.
//! Beyond the border the picture is mirrored about its edge pixel (reflect-101), so a flat picture stays
//! flat.

use super::rows::{by_rows, weighted_sum};
use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};

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
    const VERSION: u32 = 2;
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
        let weights = weights(self.kernel as usize);
        let reach = weights.len() / 2;
        let (width, height) = (image.width, image.height);
        by_rows((width, height), cx, |y, row| {
            let source = |k: usize| &image.values[reflect(y + k, reach, height) * width..][..width];
            let lines: Vec<&[f32]> = (0..weights.len()).map(source).collect();
            // Blurred along y, and mirrored beyond both ends.
            let mut line = vec![0.0; width + 2 * reach];
            weighted_sum(&lines, &weights, &mut line[reach..][..width]);
            mirror_ends(&mut line, reach);
            let shifted: Vec<&[f32]> = (0..weights.len()).map(|k| &line[k..]).collect();
            weighted_sum(&shifted, &weights, row);
        })
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

/// The index that stands for `i` - `before` when a line of `count` is mirrored about its ends without
/// repeating them, as often as it takes.
pub(super) fn reflect(i: usize, before: usize, count: usize) -> usize {
    let period = (2 * count as isize - 2).max(1);
    let i = (i as isize - before as isize).rem_euclid(period);
    if i < count as isize { i as usize } else { (period - i) as usize }
}

/// Fills `reach` pixels at both ends of a line with the mirror image of what lies between.
pub(super) fn mirror_ends(line: &mut [f32], reach: usize) {
    let count = line.len() - 2 * reach;
    for i in (0..reach).chain(reach + count..line.len()) {
        line[i] = line[reach + reflect(i, reach, count)];
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
    fn small_pictures_are_blurred_as_by_opencv() {
        // cv2.GaussianBlur of OpenCV 5.0.0; for 9 px with σ = 1.7.
        let picture = |count: usize| -> Vec<f32> {
            (0..count).map(|k| ((k * k * 7 + k * 13) % 97) as f32).collect()
        };
        let near = |found: &[f32], wanted: &[f32]| {
            let near = found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 2e-3);
            assert!(near && found.len() == wanted.len(), "{found:?}");
        };
        let line = [16.75, 22.562, 30.688, 36.25, 43.688, 46.938, 46.0, 49.5, 53.0];
        near(&blur(5, 1, &picture(9)), &line);
        #[rustfmt::skip]
        let nine = [
            37.839, 37.766, 38.149, 38.688, 39.704, 40.876, 41.292,
            39.599, 39.482, 39.669, 39.838, 40.333, 41.038, 41.260,
            43.781, 43.574, 43.305, 42.527, 41.708, 41.278, 41.052,
            48.547, 48.162, 47.196, 45.145, 42.688, 40.924, 40.184,
            50.461, 50.022, 48.804, 46.242, 43.109, 40.781, 39.827,
        ];
        near(&blur(9, 7, &picture(35)), &nine);
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
        assert_eq!([0, 1, 2, 5, 6, 7].map(|i| reflect(i, 2, 4)), [2, 1, 0, 3, 2, 1]);
        assert_eq!([0, 6, 7, 8, 16].map(|i| reflect(i, 7, 1)), [0; 5]);
        assert_eq!([0, 1, 2, 5, 6].map(|i| reflect(i, 3, 2)), [1, 0, 1, 0, 1]);
    }

    #[test]
    fn a_picture_one_pixel_wide_is_blurred_along_its_length_only() {
        let line = ramp(9);
        let (tall, wide) = (blur(5, 1, &line), blur(5, 9, &line));
        assert!(tall.iter().zip(&wide).all(|(a, b)| (a - b).abs() < 1e-6));
    }
}

//! Detail made stronger.
//!
//! Unsharp mask: I' = I + a·(I - G·I), G being the Gaussian blur of `gaussian_blur`: what a blur
//! takes away is added once more, a times. Gradient: I' = I + a·|∇I|, with ∇ by central differences
//! of the blurred picture, in gray per pixel, so that outlines become ridges. Beyond the border both
//! mirror the picture as the blur does. The result may go beyond 0 … 1, as any gray picture may.

use super::gaussian_blur::{GaussianBlur, mirror_ends, reflect};
use super::rows::by_rows;
use crate::values::GrayImage;
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;

/// Makes edges stand out, so that they survive the cutter's radius.
#[derive(Clone, Debug, Params)]
pub(crate) struct EdgeEmphasis {
    /// What is added.
    #[param(default = Method::Unsharp)]
    pub(crate) method: Method,
    /// How much of it is added; 0 leaves the picture as it is.
    #[param(unit = "%", default = 0.5, range = 0.0..=10.0)]
    pub(crate) amount: f64,
    /// Kernel width of the blur: details smaller than this are emphasised.
    #[param(unit = "px", default = 9, range = 1..=255, odd)]
    pub(crate) kernel: u32,
}

/// What is added to a picture.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Method {
    /// The difference from the blurred picture.
    Unsharp,
    /// The steepness of the blurred picture.
    Gradient,
}

#[derive(Inputs)]
pub(crate) struct Dull<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Crisp {
    /// The picture with its edges emphasised.
    image: GrayImage,
}

impl Node for EdgeEmphasis {
    const KIND: &'static str = "edge_emphasis";
    const VERSION: u32 = 2;
    type Inputs<'a> = Dull<'a>;
    type Outputs = Crisp;

    fn run(&self, inputs: Dull<'_>, cx: &Context<'_>) -> Result<Crisp, NodeError> {
        let image = inputs.image;
        let mut soft = GaussianBlur { kernel: self.kernel }.blurred(image, cx)?;
        let amount = self.amount as f32;
        match self.method {
            Method::Unsharp => {
                let pixels = soft.values.par_iter_mut().zip(&image.values);
                pixels.for_each(|(soft, source)| *soft = source + amount * (source - *soft));
                Ok(Crisp { image: soft })
            }
            Method::Gradient => {
                let (width, height) = (image.width, image.height);
                let pixels = |y: usize| &soft.values[y * width..][..width];
                let image = by_rows((width, height), cx, |y, row| {
                    let mut line = [&[0.0], pixels(y), &[0.0]].concat();
                    mirror_ends(&mut line, 1);
                    let [above, below] = [0, 2].map(|k| pixels(reflect(y + k, 1, height)));
                    let source = &image.values[y * width..][..width];
                    for x in 0..width {
                        let (along, across) = (line[x + 2] - line[x], below[x] - above[x]);
                        let steepness = 0.5 * (along * along + across * across).sqrt();
                        row[x] = source[x] + amount * steepness;
                    }
                })?;
                Ok(Crisp { image })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn emphasise(node: &EdgeEmphasis, width: usize, values: &[f32]) -> Vec<f32> {
        let image = GrayImage { width, height: values.len() / width, values: values.to_vec() };
        run(|cx| node.run(Dull { image: &image }, cx)).unwrap().image.values
    }

    #[test]
    fn an_edge_overshoots_by_what_the_blur_takes() {
        let node = EdgeEmphasis { method: Method::Unsharp, amount: 1.0, kernel: 3 };
        // The blur of 0 0 1 1 by 1 2 1 is 0 1/4 3/4 1.
        assert_eq!(emphasise(&node, 4, &[0.0, 0.0, 1.0, 1.0]), [0.0, -0.25, 1.25, 1.0]);
        assert_eq!(emphasise(&node, 1, &[0.0, 0.0, 1.0, 1.0]), [0.0, -0.25, 1.25, 1.0]);
    }

    #[test]
    fn a_ramp_gains_its_steepness() {
        let node = EdgeEmphasis { method: Method::Gradient, amount: 2.0, kernel: 1 };
        let ramp: Vec<f32> = (0..25).map(|k| (k % 5) as f32 * 0.125).collect();
        let out = emphasise(&node, 5, &ramp);
        // Mirrored about its end pixel, a ramp is level there.
        assert_eq!(out[5..10], [0.0, 0.375, 0.5, 0.625, 0.5]);
    }

    #[test]
    fn even_gray_and_no_amount_change_nothing() {
        for method in [Method::Unsharp, Method::Gradient] {
            let node = EdgeEmphasis { method, amount: 3.0, kernel: 5 };
            assert_eq!(emphasise(&node, 3, &[0.5; 9]), [0.5; 9]);
            let node = EdgeEmphasis { method, amount: 0.0, kernel: 5 };
            assert_eq!(emphasise(&node, 2, &[0.1, 0.9, 0.4, 0.3]), [0.1, 0.9, 0.4, 0.3]);
        }
    }
}

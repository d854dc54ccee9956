//! Colour to gray.
//!
//! Y = 0.299 R + 0.587 G + 0.114 B (Sood, *Efficient NC Toolpath Generation …*, Thapar University
//! 2015, section 3.2.1; the weights are those of ITU-R BT.601), on the samples as they are saved.
//! A gray picture is taken as it is. Where the picture is transparent, a backdrop shows through.

use super::rows::by_rows;
use crate::values::{Channels, GrayImage, Image, Samples};
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;

const RED: f64 = 0.299;
const GREEN: f64 = 0.587;
const BLUE: f64 = 0.114;

/// Turns a picture gray by its luminance.
#[derive(Clone, Debug, Params)]
pub(crate) struct Grayscale {
    /// The gray that shows through where the picture is transparent: 0 is black and is carved
    /// deepest, 1 is white and stays highest.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub(crate) backdrop: f64,
}

#[derive(Inputs)]
pub(crate) struct Colored<'a> {
    /// The picture, gray or colour.
    image: &'a Image,
}

#[derive(Outputs)]
pub(crate) struct Gray {
    /// Its luminance, 0 to 1.
    image: GrayImage,
}

impl Node for Grayscale {
    const KIND: &'static str = "grayscale";
    const VERSION: u32 = 2;
    type Inputs<'a> = Colored<'a>;
    type Outputs = Gray;

    fn run(&self, inputs: Colored<'_>, cx: &Context<'_>) -> Result<Gray, NodeError> {
        Ok(Gray { image: self.gray(inputs.image, cx)? })
    }
}

impl Grayscale {
    /// A picture's luminance.
    pub(crate) fn gray(&self, image: &Image, cx: &Context<'_>) -> Result<GrayImage, NodeError> {
        match &image.samples {
            Samples::U8(samples) => self.of_samples(image, samples, 255.0, cx),
            Samples::U16(samples) => self.of_samples(image, samples, 65535.0, cx),
            Samples::F32(samples) => {
                let gray = self.of_samples(image, samples, 1.0, cx)?;
                check_finite(&gray)?;
                Ok(gray)
            }
        }
    }

    /// The gray of every pixel. `white` is the sample value that means 1.
    fn of_samples<S: Copy + Sync + Into<f64>>(
        &self,
        image: &Image,
        samples: &[S],
        white: f64,
        cx: &Context<'_>,
    ) -> Result<GrayImage, NodeError> {
        let over = |gray: f64, opacity: f64| gray * opacity + self.backdrop * (1.0 - opacity);
        let (full, share) = (1.0 / white, |sample: S| sample.into() / white);
        let luminance = |red: S, green: S, blue: S| {
            (RED * red.into() + GREEN * green.into() + BLUE * blue.into()) * full
        };
        match image.channels {
            Channels::Gray => by_samples(image, samples, cx, |[gray]| share(gray)),
            Channels::GrayAlpha => {
                by_samples(image, samples, cx, |[gray, alpha]| over(share(gray), share(alpha)))
            }
            Channels::Rgb => by_samples(image, samples, cx, |[r, g, b]| luminance(r, g, b)),
            Channels::Rgba => by_samples(image, samples, cx, |[r, g, b, alpha]| {
                over(luminance(r, g, b), share(alpha))
            }),
        }
    }
}

/// A picture's gray, from the `COUNT` samples of each pixel.
fn by_samples<S: Copy + Sync, const COUNT: usize>(
    image: &Image,
    samples: &[S],
    cx: &Context<'_>,
    gray: impl Fn([S; COUNT]) -> f64 + Sync,
) -> Result<GrayImage, NodeError> {
    let (pixels, _) = samples.as_chunks::<COUNT>();
    by_rows((image.width, image.height), cx, |y, row| {
        let pixels = &pixels[y * image.width..];
        row.iter_mut().zip(pixels).for_each(|(value, pixel)| *value = gray(*pixel) as f32);
    })
}

/// Refuses a picture with pixels that are no numbers.
fn check_finite(gray: &GrayImage) -> Result<(), NodeError> {
    let found = gray.values.par_iter().position_first(|value| !value.is_finite());
    let Some(at) = found else { return Ok(()) };
    let (x, y, value) = (at % gray.width, at / gray.width, gray.values[at]);
    let message = format!("the picture's pixel at column {x}, row {y} is {value}");
    Err(NodeError::Failed(message + ": mend it or leave such pixels out"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn gray_of(channels: Channels, samples: Samples, backdrop: f64) -> Vec<f32> {
        let image = Image { width: 1, height: 1, channels, samples };
        run(|cx| Grayscale { backdrop }.run(Colored { image: &image }, cx)).unwrap().image.values
    }

    #[test]
    fn luminance_weighs_as_the_thesis_says() {
        let gray = gray_of(Channels::Rgb, Samples::U8(vec![255, 0, 0]), 0.0);
        assert_eq!(gray, [0.299]);
        let gray = gray_of(Channels::Rgb, Samples::U16(vec![0, 65535, 65535]), 0.0);
        assert!((gray[0] - 0.701).abs() < 1e-7);
    }

    #[test]
    fn every_level_of_16_bits_stays_apart() {
        let samples: Vec<u16> = (0..=65535).collect();
        let image = Image {
            width: 256,
            height: 256,
            channels: Channels::Gray,
            samples: Samples::U16(samples),
        };
        let gray =
            run(|cx| Grayscale { backdrop: 0.0 }.run(Colored { image: &image }, cx)).unwrap().image;
        assert!(gray.values.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn the_backdrop_shows_through() {
        let half = Samples::U8(vec![255, 255, 255, 51]);
        assert!((gray_of(Channels::Rgba, half.clone(), 0.0)[0] - 0.2).abs() < 1e-6);
        assert!((gray_of(Channels::Rgba, half, 0.5)[0] - 0.6).abs() < 1e-6);
        assert_eq!(gray_of(Channels::GrayAlpha, Samples::U8(vec![0, 0]), 1.0), [1.0]);
    }

    #[test]
    fn a_pixel_that_is_no_number_is_named() {
        let image = Image {
            width: 2,
            height: 1,
            channels: Channels::Gray,
            samples: Samples::F32(vec![0.0, f32::NAN]),
        };
        let fault = run(|cx| Grayscale { backdrop: 0.0 }.run(Colored { image: &image }, cx)).err();
        let message = fault.unwrap().to_string();
        assert!(message.contains("column 1, row 0 is NaN"), "{message}");
    }
}

//! A part of a picture, pixel by pixel.
//!
//! Margins are shares of the picture, rounded to whole pixels, so that a recipe serves pictures of
//! any size.

use super::rows::by_rows;
use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};

/// Cuts margins off a picture.
#[derive(Clone, Debug, Params)]
pub(crate) struct CropImage {
    /// Share of the width cut off on the left.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub(crate) left: f64,
    /// Share of the width cut off on the right.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub(crate) right: f64,
    /// Share of the height cut off at the top.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub(crate) top: f64,
    /// Share of the height cut off at the bottom.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub(crate) bottom: f64,
}

#[derive(Inputs)]
pub(crate) struct Whole<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Part {
    /// What is left of it.
    image: GrayImage,
}

impl Node for CropImage {
    const KIND: &'static str = "crop_image";
    type Inputs<'a> = Whole<'a>;
    type Outputs = Part;

    fn run(&self, inputs: Whole<'_>, cx: &Context<'_>) -> Result<Part, NodeError> {
        let image = inputs.image;
        let kept = |count: usize, before: f64, after: f64| {
            let share = |share: f64| (share * count as f64).round() as usize;
            (share(before), count.saturating_sub(share(before) + share(after)))
        };
        let (left, width) = kept(image.width, self.left, self.right);
        let (top, height) = kept(image.height, self.top, self.bottom);
        if width == 0 || height == 0 {
            return Err(NodeError::Failed(format!(
                "the margins leave {width} × {height} px of {} × {} px: make them smaller",
                image.width, image.height
            )));
        }
        let image = by_rows((width, height), cx, |y, row| {
            row.copy_from_slice(&image.values[(top + y) * image.width + left..][..width]);
        })?;
        Ok(Part { image })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn crop([left, right, top, bottom]: [f64; 4], image: &GrayImage) -> Result<GrayImage, String> {
        let node = CropImage { left, right, top, bottom };
        let part = run(|cx| node.run(Whole { image }, cx));
        part.map(|part| part.image).map_err(|fault| fault.to_string())
    }

    fn numbers(width: usize, height: usize) -> GrayImage {
        GrayImage { width, height, values: (0..width * height).map(|k| k as f32).collect() }
    }

    #[test]
    fn margins_are_rounded_to_pixels() {
        let part = crop([0.2, 0.4, 0.0, 0.3], &numbers(5, 3)).unwrap();
        assert_eq!((part.width, part.height), (2, 2));
        assert_eq!(part.values, [1.0, 2.0, 6.0, 7.0]);
        assert_eq!(crop([0.0; 4], &numbers(1, 7)).unwrap(), numbers(1, 7));
    }

    #[test]
    fn nothing_left_is_an_error() {
        let message = crop([0.5, 0.5, 0.0, 0.0], &numbers(4, 3)).unwrap_err();
        assert_eq!(message, "the margins leave 0 × 3 px of 4 × 3 px: make them smaller");
        assert!(crop([0.0, 0.0, 1.0, 1.0], &numbers(1, 1)).is_err());
    }
}

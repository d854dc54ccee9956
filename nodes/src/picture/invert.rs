//! A picture's negative: I' = I_max + I_min - I, so that its range stays what it is.

use super::rows::{by_pixels, range};
use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};

/// Turns dark into bright and back, so that what was deep becomes high.
#[derive(Clone, Debug, Params)]
pub(crate) struct Invert {
    /// Whether it does; without, the picture stays as it is.
    #[param(default = true)]
    pub(crate) on: bool,
}

#[derive(Inputs)]
pub(crate) struct Positive<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Negative {
    /// Its negative.
    image: GrayImage,
}

impl Node for Invert {
    const KIND: &'static str = "invert";
    type Inputs<'a> = Positive<'a>;
    type Outputs = Negative;

    fn run(&self, inputs: Positive<'_>, cx: &Context<'_>) -> Result<Negative, NodeError> {
        if !self.on {
            return Ok(Negative { image: inputs.image.clone() });
        }
        let (dark, bright) = range(inputs.image);
        // The larger part first, so that the ends of the range become each other exactly.
        let image = by_pixels(inputs.image, cx, |value| (bright - value) + dark)?;
        Ok(Negative { image })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn invert(on: bool, values: &[f32]) -> Vec<f32> {
        let image = GrayImage { width: 1, height: values.len(), values: values.to_vec() };
        run(|cx| Invert { on }.run(Positive { image: &image }, cx)).unwrap().image.values
    }

    #[test]
    fn the_ends_of_the_range_change_places() {
        assert_eq!(invert(true, &[-1.0, 0.0, 0.25, 3.0]), [3.0, 2.0, 1.75, -1.0]);
        assert_eq!(invert(true, &[0.5]), [0.5]);
        assert_eq!(invert(false, &[0.0, 0.25]), [0.0, 0.25]);
    }
}

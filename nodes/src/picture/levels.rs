//! Black, white and middle of a picture set anew.
//!
//! I' = t^(1/γ) with t = (I - black)/(white - black), held to 0 … 1, as the "levels" of picture
//! editors.

use super::rows::by_pixels;
use crate::values::GrayImage;
use carvegraph_core::{Conflict, Context, Inputs, Node, NodeError, Outputs, Params};

/// Spreads part of a picture's range over all of it, and brightens or darkens its middle.
#[derive(Clone, Debug, Params)]
pub(crate) struct Levels {
    /// What becomes black, and all that is darker.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub(crate) black: f64,
    /// What becomes white, and all that is brighter.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub(crate) white: f64,
    /// Above 1 the middle gets brighter, below darker; 1 leaves it.
    #[param(unit = "%", default = 1.0, range = 0.1..=10.0)]
    pub(crate) gamma: f64,
}

#[derive(Inputs)]
pub(crate) struct Flat<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Spread {
    /// The picture with its new range, 0 to 1.
    image: GrayImage,
}

impl Node for Levels {
    const KIND: &'static str = "levels";
    type Inputs<'a> = Flat<'a>;
    type Outputs = Spread;

    fn check(&self) -> Result<(), Conflict> {
        if self.black < self.white {
            return Ok(());
        }
        let message = format!("white ({}) must be above black ({})", self.white, self.black);
        Err(Conflict { param: "white", message })
    }

    fn run(&self, inputs: Flat<'_>, cx: &Context<'_>) -> Result<Spread, NodeError> {
        let (black, scale) = (self.black as f32, (1.0 / (self.white - self.black)) as f32);
        let exponent = (1.0 / self.gamma) as f32;
        let linear = |value: f32| ((value - black) * scale).clamp(0.0, 1.0);
        let image = match self.gamma == 1.0 {
            true => by_pixels(inputs.image, cx, linear)?,
            false => by_pixels(inputs.image, cx, |value| linear(value).powf(exponent))?,
        };
        Ok(Spread { image })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn levels(black: f64, white: f64, gamma: f64, values: &[f32]) -> Vec<f32> {
        let image = GrayImage { width: values.len(), height: 1, values: values.to_vec() };
        let node = Levels { black, white, gamma };
        run(|cx| node.run(Flat { image: &image }, cx)).unwrap().image.values
    }

    #[test]
    fn what_lies_between_black_and_white_is_spread() {
        let spread = levels(0.25, 0.75, 1.0, &[-3.0, 0.25, 0.375, 0.5, 0.75, 1.0]);
        assert_eq!(spread, [0.0, 0.0, 0.25, 0.5, 1.0, 1.0]);
    }

    #[test]
    fn gamma_two_is_the_square_root() {
        let spread = levels(0.0, 1.0, 2.0, &[0.0, 0.25, 0.81, 1.0]);
        assert!(spread.iter().zip([0.0, 0.5, 0.9, 1.0]).all(|(a, b)| (a - b).abs() < 1e-6));
    }

    #[test]
    fn white_lies_above_black() {
        let fault = Levels { black: 0.5, white: 0.5, gamma: 1.0 }.check().unwrap_err();
        assert_eq!(fault.message, "white (0.5) must be above black (0.5)");
    }
}

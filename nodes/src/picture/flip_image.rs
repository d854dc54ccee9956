//! A picture mirrored, pixel by pixel.

use super::rows::by_rows;
use crate::values::GrayImage;
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};

/// Mirrors a picture, as a stamp or a mould wants it.
#[derive(Clone, Debug, Params)]
pub(crate) struct FlipImage {
    /// What changes places.
    #[param(default = Flip::LeftRight)]
    pub(crate) flip: Flip,
}

/// What changes places in a mirrored picture.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Flip {
    /// Left and right.
    LeftRight,
    /// Top and bottom.
    TopBottom,
    /// Nothing.
    None,
}

#[derive(Inputs)]
pub(crate) struct Straight<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Mirrored {
    /// The mirrored picture.
    image: GrayImage,
}

impl Node for FlipImage {
    const KIND: &'static str = "flip_image";
    type Inputs<'a> = Straight<'a>;
    type Outputs = Mirrored;

    fn run(&self, inputs: Straight<'_>, cx: &Context<'_>) -> Result<Mirrored, NodeError> {
        let GrayImage { width, height, values } = inputs.image;
        let image = by_rows((*width, *height), cx, |y, row| {
            let from = if self.flip == Flip::TopBottom { height - 1 - y } else { y };
            row.copy_from_slice(&values[from * width..][..*width]);
            if self.flip == Flip::LeftRight {
                row.reverse();
            }
        })?;
        Ok(Mirrored { image })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn flip(flip: Flip, width: usize, values: &[f32]) -> Vec<f32> {
        let image = GrayImage { width, height: values.len() / width, values: values.to_vec() };
        run(|cx| FlipImage { flip }.run(Straight { image: &image }, cx)).unwrap().image.values
    }

    #[test]
    fn sides_change_places() {
        let values = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(flip(Flip::LeftRight, 3, &values), [2.0, 1.0, 0.0, 5.0, 4.0, 3.0]);
        assert_eq!(flip(Flip::TopBottom, 3, &values), [3.0, 4.0, 5.0, 0.0, 1.0, 2.0]);
        assert_eq!(flip(Flip::None, 3, &values), values);
        assert_eq!(flip(Flip::LeftRight, 1, &values), values);
    }
}

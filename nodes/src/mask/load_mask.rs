//! A mask from a picture made in any editor.
//!
//! The convention is that of Sood 2015, section 3.2.7: black is selected, on white. Gray is
//! selected in part: the share is 1 - Y, Y being the luminance, held to 0 … 1. Where the picture is
//! transparent, nothing is selected. A colour picture is refused, and one that is gray for the most part
//! warned of: both are photographs taken for masks.

use super::pixels::Pixels;
use crate::picture::{Grayscale, LoadImage};
use crate::values::{GrayImage, Image, Mask};
use carvegraph_core::{Choice, Context, InputFile, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;

/// A pixel is coloured if it is this far from gray: what JPEG makes of black and white is less.
const COLORED: f32 = 0.25;
/// A mask may have stray coloured pixels, such as an editor's guide lines: one in so many.
const STRAY: usize = 100;
/// A pixel is gray if it is this far from black and from white: what JPEG leaves of either is nearer.
const GRAY: f32 = 0.1;

/// Loads a mask: a picture of the same size as the one it is for, black where it is meant.
#[derive(Clone, Debug, Params)]
pub(crate) struct LoadMask {
    /// The mask's file, any picture that load_image reads; none selects nothing of the picture that is
    /// wired in.
    #[param(default = None)]
    pub(crate) path: Option<InputFile>,
    /// What is selected.
    #[param(default = Selected::Black)]
    pub(crate) selected: Selected,
}

/// What of a mask's file is selected.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Selected {
    /// Black on white, as save_mask writes it.
    Black,
    /// White on black.
    White,
}

#[derive(Inputs)]
pub(crate) struct Meant<'a> {
    /// The picture that the mask is for; only its size counts.
    image: Option<&'a GrayImage>,
}

#[derive(Outputs)]
pub(crate) struct Loaded {
    /// What is selected.
    mask: Mask,
}

impl Node for LoadMask {
    const KIND: &'static str = "load_mask";
    const VERSION: u32 = 2;
    type Inputs<'a> = Meant<'a>;
    type Outputs = Loaded;

    fn run(&self, inputs: Meant<'_>, cx: &Context<'_>) -> Result<Loaded, NodeError> {
        let size = inputs.image.map(|image| (image.width, image.height));
        let mask = match (&self.path, size) {
            (Some(path), size) => {
                let image = LoadImage { path: path.clone() }.load(cx)?;
                self.read(path, &image, size, cx)?
            }
            (None, Some((width, height))) => Mask::nothing(width, height),
            (None, None) => {
                return Err(NodeError::failed(
                    "a mask without a file needs a picture for its size",
                ));
            }
        };
        Ok(Loaded { mask })
    }
}

impl LoadMask {
    /// The mask that a file's `image` is, if it is one for a picture of `size`.
    fn read(
        &self,
        path: &InputFile,
        image: &Image,
        size: Option<(usize, usize)>,
        cx: &Context<'_>,
    ) -> Result<Mask, NodeError> {
        let (width, height) = (image.width, image.height);
        if let Some((wanted_width, wanted_height)) = size.filter(|size| *size != (width, height)) {
            return Err(NodeError::failed(format!(
                "{path} has {width} × {height} px and the picture {wanted_width} × {wanted_height} px: \
                 make the mask for this picture, pixel by pixel, or take none"
            )));
        }
        let pixels = Pixels::new(image);
        let is_colored = |at: &usize| pixels.chroma(*at) > COLORED;
        let colored = (0..width * height).into_par_iter().filter(is_colored).count();
        if colored > width * height / STRAY {
            return Err(NodeError::failed(format!(
                "{path} is a colour picture and no mask: paint what is meant black, all else white"
            )));
        }
        let mask = self.selected.of(image, cx)?;
        let is_gray = |share: &&f32| (GRAY..=1.0 - GRAY).contains(*share);
        if 2 * mask.values.par_iter().filter(is_gray).count() > width * height {
            cx.warn(format!("{path} is gray for the most part: is it a photograph and no mask?"));
        }
        if mask.values.par_iter().all(|share| *share == 0.0) {
            let missing = if self.selected == Selected::Black { "black" } else { "white" };
            cx.warn(format!("{path} selects nothing: there is nothing {missing} in it"));
        }
        Ok(mask)
    }
}

impl Selected {
    /// What of `image` is selected.
    fn of(self, image: &Image, cx: &Context<'_>) -> Result<Mask, NodeError> {
        let unselected: f32 = if self == Self::Black { 1.0 } else { 0.0 };
        let gray = Grayscale { backdrop: unselected.into() }.gray(image, cx)?;
        let share = |gray: f32| (unselected - gray.clamp(0.0, 1.0)).abs();
        let values = gray.values.into_par_iter().map(share).collect();
        Ok(Mask { width: gray.width, height: gray.height, values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use crate::values::{Channels, Samples};
    use carvegraph_core::Origin;

    #[test]
    fn black_is_selected_gray_in_part_and_what_is_transparent_not() {
        let samples = Samples::U8(vec![0, 255, 255, 255, 51, 255, 128, 0]);
        let image = Image { width: 4, height: 1, channels: Channels::GrayAlpha, samples };
        let load = |selected: Selected| run(|cx| selected.of(&image, cx)).unwrap().values;
        assert_eq!(load(Selected::Black), [1.0, 0.0, 0.8, 0.0]);
        assert_eq!(load(Selected::White), [0.0, 1.0, 0.2, 0.0]);
    }

    fn levels(width: usize, levels: Vec<u8>, channels: Channels) -> Image {
        let height = levels.len() / channels.count() / width;
        Image { width, height, channels, samples: Samples::U8(levels) }
    }

    fn read(image: &Image, size: Option<(usize, usize)>) -> Result<Vec<f32>, String> {
        let path = Origin::BuiltIn.locate("mask.png");
        let node = LoadMask { path: None, selected: Selected::Black };
        let mask = run(|cx| node.read(&path, image, size, cx));
        mask.map(|mask| mask.values).map_err(|fault| fault.to_string())
    }

    #[test]
    fn sixteen_bits_and_floats_serve_as_well() {
        let load = |samples: Samples| {
            let image = Image { width: 1, height: 3, channels: Channels::Gray, samples };
            run(|cx| Selected::Black.of(&image, cx)).unwrap().values
        };
        assert_eq!(load(Samples::U16(vec![0, 65535, 16384])), [1.0, 0.0, 49151.0 / 65535.0]);
        // What a depth map may have beyond white and black is held within.
        assert_eq!(load(Samples::F32(vec![-0.5, 1.5, 0.25])), [1.0, 0.0, 0.75]);
    }

    #[test]
    fn a_mask_of_another_size_is_refused_with_both() {
        let line = levels(3, vec![0; 3], Channels::Gray);
        assert_eq!(read(&line, Some((3, 1))).unwrap(), [1.0; 3]);
        assert_eq!(read(&line, None).unwrap(), [1.0; 3]);
        assert_eq!(
            read(&line, Some((1, 3))).unwrap_err(),
            "mask.png has 3 × 1 px and the picture 1 × 3 px: make the mask for this picture, pixel by \
             pixel, or take none"
        );
    }

    #[test]
    fn a_colour_picture_is_refused_and_a_stray_colour_is_not() {
        let mut picture = vec![255; 3 * 200];
        picture[..6].copy_from_slice(&[255, 0, 0, 0, 0, 255]);
        assert!(read(&levels(200, picture.clone(), Channels::Rgb), None).is_ok());
        picture[6..9].copy_from_slice(&[255, 190, 255]);
        assert_eq!(
            read(&levels(200, picture, Channels::Rgb), None).unwrap_err(),
            "mask.png is a colour picture and no mask: paint what is meant black, all else white"
        );
        // What an editor leaves of a photograph where it was rubbed out.
        let rubbed_out = levels(2, vec![255, 0, 0, 0, 0, 0, 0, 255], Channels::Rgba);
        assert_eq!(read(&rubbed_out, None).unwrap(), [0.0, 1.0]);
    }

    #[test]
    fn without_a_file_nothing_of_the_picture_is_selected() {
        let picture = GrayImage { width: 1, height: 5, values: vec![0.5; 5] };
        let node = LoadMask { path: None, selected: Selected::White };
        let load = |image| run(|cx| node.run(Meant { image }, cx));
        assert_eq!(load(Some(&picture)).unwrap().mask, Mask::nothing(1, 5));
        let fault = load(None).err().unwrap().to_string();
        assert_eq!(fault, "a mask without a file needs a picture for its size");
    }
}

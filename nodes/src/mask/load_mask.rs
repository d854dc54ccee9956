//! A mask from a picture made in any editor.
//!
//! The convention is that of Sood 2015, section 3.2.7: black is selected, on white. Gray is
//! selected in part: the share is 1 - Y, Y being the luminance, held to 0 … 1. Where the picture is
//! transparent, nothing is selected.

use crate::picture::{Grayscale, LoadImage};
use crate::values::{Image, Mask};
use carvegraph_core::{Choice, Context, InputFile, Node, NodeError, Outputs, Params};
use rayon::prelude::*;

/// Loads a mask: a picture of the same size as the one it is for, black where it is meant.
#[derive(Clone, Debug, Params)]
pub(crate) struct LoadMask {
    /// The mask's file, any picture that load_image reads.
    #[param()]
    pub(crate) path: InputFile,
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

#[derive(Outputs)]
pub(crate) struct Loaded {
    /// What is selected.
    mask: Mask,
}

impl Node for LoadMask {
    const KIND: &'static str = "load_mask";
    type Inputs<'a> = ();
    type Outputs = Loaded;

    fn run(&self, (): (), cx: &Context<'_>) -> Result<Loaded, NodeError> {
        let image = LoadImage { path: self.path.clone() }.load(cx)?;
        Ok(Loaded { mask: self.selected.of(&image, cx)? })
    }
}

impl Selected {
    /// What of `image` is selected.
    fn of(self, image: &Image, cx: &Context<'_>) -> Result<Mask, NodeError> {
        let unselected: f32 = if self == Self::Black { 1.0 } else { 0.0 };
        let gray = Grayscale { backdrop: unselected.into() }.gray(image, cx)?;
        let share = |gray: f32| (unselected - gray).abs().clamp(0.0, 1.0);
        let values = gray.values.into_par_iter().map(share).collect();
        Ok(Mask { width: gray.width, height: gray.height, values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use crate::values::{Channels, Samples};

    #[test]
    fn black_is_selected_gray_in_part_and_what_is_transparent_not() {
        let samples = Samples::U8(vec![0, 255, 255, 255, 51, 255, 128, 0]);
        let image = Image { width: 4, height: 1, channels: Channels::GrayAlpha, samples };
        let load = |selected: Selected| run(|cx| selected.of(&image, cx)).unwrap().values;
        assert_eq!(load(Selected::Black), [1.0, 0.0, 0.8, 0.0]);
        assert_eq!(load(Selected::White), [0.0, 1.0, 0.2, 0.0]);
    }
}

//! A mask saved as a picture.
//!
//! PNG, gray, 8 bits: black is selected, on white (Sood 2015, section 3.2.7), so that `load_mask` and
//! any editor read it. Crisp masks come back as they were, soft ones to 1/510.

use crate::values::Mask;
use carvegraph_core::{Context, Inputs, Node, NodeError, OutputName, Params};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use rayon::prelude::*;
use std::io::Write;

/// Saves a mask to be used again: black where it selects, on white.
#[derive(Clone, Debug, Params)]
pub(crate) struct SaveMask {
    /// The file's name without its extension; {prefix} stands for the input's name.
    #[param(default = "{prefix}-mask")]
    pub(crate) name: OutputName,
}

#[derive(Inputs)]
pub(crate) struct Kept<'a> {
    /// The mask.
    mask: &'a Mask,
}

impl Node for SaveMask {
    const KIND: &'static str = "save_mask";
    type Inputs<'a> = Kept<'a>;
    type Outputs = ();

    fn run(&self, inputs: Kept<'_>, cx: &Context<'_>) -> Result<(), NodeError> {
        let mut file = cx.create(&self.name, "png")?;
        encode(inputs.mask, &mut file).map_err(|fault| match cx.is_cancelled() {
            true => NodeError::Cancelled,
            false => NodeError::failed(fault),
        })?;
        file.finish()?;
        Ok(())
    }
}

fn encode(mask: &Mask, file: impl Write) -> image::ImageResult<()> {
    let level = |share: &f32| ((1.0 - share) * 255.0).round() as u8;
    let levels: Vec<u8> = mask.values.par_iter().map(level).collect();
    // No picture that can be loaded has a side beyond u32.
    let (width, height) = (mask.width as u32, mask.height as u32);
    PngEncoder::new_with_quality(file, CompressionType::Fast, FilterType::Adaptive).write_image(
        &levels,
        width,
        height,
        ExtendedColorType::L8,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn selected_is_black_on_white() {
        let mask = Mask { width: 3, height: 1, values: vec![1.0, 0.0, 0.8] };
        let mut png = Vec::new();
        encode(&mask, &mut png).unwrap();
        let picture = image::load_from_memory(&png).unwrap().into_luma8();
        assert_eq!((picture.dimensions(), picture.into_raw()), ((3, 1), vec![0, 255, 51]));
    }

    #[test]
    fn what_is_saved_is_loaded_again() {
        let mut random = fastrand::Rng::with_seed(5);
        for (width, height) in [(1, 1), (1, 9), (9, 1), (13, 7)] {
            let back = |share: &mut dyn FnMut() -> f32| {
                let values: Vec<f32> = (0..width * height).map(|_| share()).collect();
                let mut png = Vec::new();
                encode(&Mask { width, height, values: values.clone() }, &mut png).unwrap();
                let picture = image::load_from_memory(&png).unwrap().into_luma8().into_raw();
                let loaded = picture.into_iter().map(|level| 1.0 - f32::from(level) / 255.0);
                values.into_iter().zip(loaded).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
            };
            assert_eq!(back(&mut || f32::from(random.bool())), 0.0);
            assert!(back(&mut || random.f32()) <= 1.0 / 510.0 + 1e-6);
        }
    }
}

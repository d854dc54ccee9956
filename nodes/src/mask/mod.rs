//! Masks: which pixels of a picture are meant, drawn, written, chosen by colour or loaded, put
//! together, and traced as outlines.

mod color_mask;
mod combine_masks;
mod edge;
mod feather_mask;
mod grow_mask;
mod load_mask;
mod mask_lift;
mod pixels;
mod polygon_mask;
mod save_mask;
mod shape_mask;
mod sheet;
mod svg_mask;
mod text_mask;
mod trace_mask;

pub(crate) use color_mask::ColorMask;
pub(crate) use combine_masks::CombineMasks;
pub(crate) use edge::from_edge;
pub(crate) use feather_mask::FeatherMask;
pub(crate) use grow_mask::GrowMask;
pub(crate) use load_mask::LoadMask;
pub(crate) use mask_lift::MaskLift;
pub(crate) use polygon_mask::PolygonMask;
pub(crate) use save_mask::SaveMask;
pub(crate) use shape_mask::ShapeMask;
pub(crate) use svg_mask::SvgMask;
pub(crate) use text_mask::TextMask;
pub(crate) use trace_mask::TraceMask;

use crate::values::Mask;
use carvegraph_core::NodeError;

/// A pixel counts as selected from here on, where a node needs a yes or a no.
pub(crate) const SELECTED: f32 = 0.5;

/// Refuses a mask that was made for a picture of another size.
pub(crate) fn check_size(mask: &Mask, what: &str, size: (usize, usize)) -> Result<(), NodeError> {
    if (mask.width, mask.height) == size {
        return Ok(());
    }
    let (width, height) = size;
    Err(NodeError::Failed(format!(
        "the mask has {} × {} px and {what} {width} × {height} px: make the mask for this picture, \
         pixel by pixel",
        mask.width, mask.height
    )))
}

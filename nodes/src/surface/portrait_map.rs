//! A portrait and its background become a surface of a given size.
//!
//! As `z_map` (Sood 2015, equation 3.3), but the portrait and what lies behind it have a range of
//! their own, each spread over its own darkest and brightest pixel (section 3.2.7: the background is
//! "mapped to user defined background's z value and the human portrait is lifted above"):
//!
//! | background | behind | portrait |
//! |---|---|---|
//! | drop | Z_min | Z_min … Z_max |
//! | keep | Z_min … Z_background | Z_background … Z_max |
//!
//! The portrait is what the mask selects by half or more. Where the mask's edge is soft, the height
//! is m·Z_portrait + (1 - m)·Z_behind, both held within their range. The canvas is `z_map`'s; see
//! `canvas`.

use super::canvas::{Canvas, Span};
use crate::mask::{SELECTED, check_size};
use crate::values::{GrayImage, Mask};
use carvegraph_core::{Choice, Conflict, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Bounds, HeightField};

/// Turns brightness into height as z_map does, with the portrait raised above what lies behind it.
#[derive(Clone, Debug, Params)]
pub(crate) struct PortraitMap {
    #[param(shared)]
    pub(crate) canvas: Canvas,
    /// Height of the darkest pixel.
    #[param(unit = "mm", default = 0.0, range = -1000.0..=1000.0)]
    pub(crate) z_min: f64,
    /// Height of the portrait's brightest pixel.
    #[param(unit = "mm", default = 5.0, range = -1000.0..=1000.0)]
    pub(crate) z_max: f64,
    /// What becomes of what lies behind the portrait.
    #[param(default = Background::Drop)]
    pub(crate) background: Background,
    /// Height of the brightest pixel behind the portrait, and of the portrait's darkest, where the
    /// background is kept.
    #[param(unit = "mm", default = 3.0, range = -1000.0..=1000.0)]
    pub(crate) background_z: f64,
}

/// What becomes of what lies behind a portrait.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Background {
    /// It is flat, at z_min.
    Drop,
    /// It is carved from z_min to background_z, and the portrait above it.
    Keep,
}

#[derive(Inputs)]
pub(crate) struct Sitter<'a> {
    /// The picture.
    image: &'a GrayImage,
    /// Where the portrait is.
    mask: &'a Mask,
}

#[derive(Outputs)]
pub(crate) struct Mapped {
    /// The surface; its near left corner is the origin.
    surface: HeightField,
    /// The box that holds it.
    bounds: Bounds,
}

impl Node for PortraitMap {
    const KIND: &'static str = "portrait_map";
    type Inputs<'a> = Sitter<'a>;
    type Outputs = Mapped;

    fn check(&self) -> Result<(), Conflict> {
        let (low, high, between) = (self.z_min, self.z_max, self.background_z);
        if low >= high {
            let message = format!("z_max ({high} mm) must be above z_min ({low} mm)");
            return Err(Conflict { param: "z_max", message });
        }
        if self.background == Background::Keep && !(low <= between && between < high) {
            let message = format!(
                "background_z ({between} mm) must lie between z_min ({low} mm) and z_max ({high} mm)"
            );
            return Err(Conflict { param: "background_z", message });
        }
        Ok(())
    }

    fn run(&self, inputs: Sitter<'_>, cx: &Context<'_>) -> Result<Mapped, NodeError> {
        let Sitter { image, mask } = inputs;
        check_size(mask, "the picture", (image.width, image.height))?;
        let is_portrait = |at: usize| mask.values[at] >= SELECTED;
        let portrait = Span::of(image, is_portrait);
        let behind = Span::of(image, |at| !is_portrait(at));
        if portrait.dark > portrait.bright {
            let message = "the mask selects no portrait: mark it (black on white in a mask's file)";
            return Err(NodeError::failed(message));
        }
        let foot = match self.background {
            Background::Drop => self.z_min,
            Background::Keep => self.background_z,
        };
        if behind.dark > behind.bright {
            cx.warn("the mask selects the whole picture: nothing lies behind the portrait");
        }
        if portrait.is_even() {
            cx.warn(format!("the portrait is one even gray: it is flat, at {foot} mm"));
        }
        let [raise, spread] = [portrait.scale(foot, self.z_max), behind.scale(self.z_min, foot)];
        let height_of = |at: usize, value: f64| {
            let share = f64::from(mask.values[at]);
            let above = ((value - portrait.dark) * raise).clamp(0.0, self.z_max - foot) + foot;
            // The background's span is the wrong way round where there is none of it.
            let below = ((value - behind.dark) * spread).max(0.0).min(foot - self.z_min);
            let below = if spread == 0.0 { self.z_min } else { below + self.z_min };
            share * above + (1.0 - share) * below
        };
        let surface = self.canvas.surface(image, height_of, cx)?;
        let bounds = surface.bounds();
        Ok(Mapped { surface, bounds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn node(background: Background) -> PortraitMap {
        PortraitMap {
            canvas: Canvas { canvas_width: 203.0, canvas_height: 203.0 },
            z_min: 0.0,
            z_max: 5.0,
            background,
            background_z: 3.0,
        }
    }

    fn map(
        node: &PortraitMap,
        width: usize,
        values: &[f32],
        shares: &[f32],
    ) -> Result<HeightField, String> {
        let image = GrayImage { width, height: values.len() / width, values: values.to_vec() };
        let mask = Mask { width, height: shares.len() / width, values: shares.to_vec() };
        let mapped = run(|cx| node.run(Sitter { image: &image, mask: &mask }, cx));
        mapped.map(|mapped| mapped.surface).map_err(|fault| fault.to_string())
    }

    /// The portrait below, 0.25 to 0.75; behind it 0.5 to 1.
    const VALUES: [f32; 6] = [0.5, 1.0, 0.75, 0.25, 0.5, 0.75];
    const BELOW: [f32; 6] = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];

    #[test]
    fn a_dropped_background_is_flat_and_the_portrait_takes_the_whole_range() {
        let field = map(&node(Background::Drop), 3, &VALUES, &BELOW).unwrap();
        assert_eq!((field.row(1), field.row(0)), (&[0.0; 3][..], &[0.0, 2.5, 5.0][..]));
    }

    #[test]
    fn a_kept_background_lies_below_the_portrait() {
        let field = map(&node(Background::Keep), 3, &VALUES, &BELOW).unwrap();
        assert_eq!((field.row(1), field.row(0)), (&[0.0, 3.0, 1.5][..], &[3.0, 4.0, 5.0][..]));
    }

    #[test]
    fn a_soft_edge_leads_from_one_to_the_other() {
        let mut soft = BELOW;
        soft[4] = 0.75;
        let field = map(&node(Background::Keep), 3, &VALUES, &soft).unwrap();
        // 0.5 is 4 mm of the portrait and 0 mm of what lies behind.
        assert_eq!(field.row(0), [3.0, 3.0, 5.0]);
    }

    #[test]
    fn where_all_is_portrait_it_is_as_z_map_makes_it() {
        for background in [Background::Drop, Background::Keep] {
            let mut node = node(background);
            node.background_z = 0.0;
            let field = map(&node, 3, &VALUES, &[1.0; 6]).unwrap();
            let expected = VALUES.map(|value| ((f64::from(value) - 0.25) / 0.75 * 5.0) as f32);
            assert_eq!((field.row(1), field.row(0)), (&expected[..3], &expected[3..]));
        }
    }

    #[test]
    fn even_grays_lie_at_the_foot_of_their_range() {
        let field = map(&node(Background::Keep), 3, &[0.4; 6], &BELOW).unwrap();
        assert_eq!((field.row(1), field.row(0)), (&[0.0; 3][..], &[3.0; 3][..]));
    }

    #[test]
    fn a_mask_that_does_not_serve_is_told() {
        let fault = |shares: &[f32]| map(&node(Background::Drop), 3, &VALUES, shares).unwrap_err();
        assert!(fault(&[0.0; 6]).starts_with("the mask selects no portrait"));
        assert!(fault(&[1.0; 3]).contains("3 × 1 px and the picture 3 × 2 px"));
        let mut node = node(Background::Keep);
        node.background_z = 5.0;
        assert_eq!(
            node.check().unwrap_err().message,
            "background_z (5 mm) must lie between z_min (0 mm) and z_max (5 mm)"
        );
    }
}

//! A picture that fades towards its border.
//!
//! I' = I + s·f(r)·(L - I): L is the gray it fades to, s the strength, r the distance from the middle
//! as a share of that of the corners, each way in half sides, and f the smooth step 3t² - 2t³ from
//! `start` to the corners.

use super::rows::{by_rows, darker};
use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};

/// Lets a picture fade towards its border, so that a relief grows out of the plaque.
#[derive(Clone, Debug, Params)]
pub(crate) struct Vignette {
    /// How far it fades in the corners: 0 leaves the picture as it is, 1 leaves nothing of it there.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub(crate) strength: f64,
    /// Where it begins: 0 is the middle, 0.707 the middle of a side, 1 a corner.
    #[param(default = 0.6, range = 0.0..=1.0)]
    pub(crate) start: f64,
    /// The gray that it fades to.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub(crate) level: f64,
}

#[derive(Inputs)]
pub(crate) struct Full<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Faded {
    /// The picture that fades.
    image: GrayImage,
}

impl Node for Vignette {
    const KIND: &'static str = "vignette";
    const VERSION: u32 = 2;
    type Inputs<'a> = Full<'a>;
    type Outputs = Faded;

    fn run(&self, inputs: Full<'_>, cx: &Context<'_>) -> Result<Faded, NodeError> {
        let GrayImage { width, height, values } = inputs.image;
        // From the middle, in half sides.
        let off = |i: usize, count: usize| ((2.0 * i as f64 + 1.0) / count as f64 - 1.0) as f32;
        let across: Vec<f32> = (0..*width).map(|x| off(x, *width).powi(2)).collect();
        let level = self.level as f32;
        let image = by_rows((*width, *height), cx, |y, row| {
            let down = off(y, *height).powi(2);
            let source = &values[y * width..];
            for ((value, source), across) in row.iter_mut().zip(source).zip(&across) {
                *value = source + self.share(((across + down) / 2.0).sqrt()) * (level - source);
            }
        })?;
        Ok(Faded { image })
    }
}

impl Vignette {
    /// How far it fades at a distance of `r`.
    fn share(&self, r: f32) -> f32 {
        let start = self.start as f32;
        // A start at the corners leaves nothing to fade; the division is then by nothing.
        let t = if r > start { (r - start) / (1.0 - start) } else { 0.0 };
        let t = darker(t, 1.0);
        self.strength as f32 * t * t * (3.0 - 2.0 * t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn fade(strength: f64, start: f64, level: f64, image: &GrayImage) -> Vec<f32> {
        let node = Vignette { strength, start, level };
        run(|cx| node.run(Full { image }, cx)).unwrap().image.values
    }

    fn even(width: usize, height: usize) -> GrayImage {
        GrayImage { width, height, values: vec![0.8; width * height] }
    }

    #[test]
    fn the_middle_stays_and_corners_go() {
        let faded = fade(1.0, 0.5, 0.2, &even(101, 51));
        assert_eq!(faded[25 * 101 + 50], 0.8);
        // The first pixel's middle is not quite the corner.
        assert!((faded[0] - 0.2).abs() < 0.01 && faded[0] == faded[101 * 51 - 1]);
    }

    #[test]
    fn half_way_it_has_faded_by_half() {
        let node = Vignette { strength: 1.0, start: 0.6, level: 0.0 };
        assert!((node.share(0.8) - 0.5).abs() < 1e-6);
        assert_eq!((node.share(0.6), node.share(1.0)), (0.0, 1.0));
        assert_eq!(Vignette { start: 1.0, ..node }.share(1.0), 0.0);
    }

    #[test]
    fn no_strength_changes_nothing_whatever_the_size() {
        for (width, height) in [(1, 1), (1, 8), (7, 1)] {
            let image = even(width, height);
            assert_eq!(fade(0.0, 0.0, 0.0, &image), image.values);
        }
    }
}

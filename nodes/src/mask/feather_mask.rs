//! A mask with a soft edge.
//!
//! With d the distance of a pixel's middle from the mask's edge, positive inside, and w the width
//! asked for, the share is s(t) = 3t² - 2t³ at t = 1/2 + d/w, held to 0 … 1: half at the edge, level
//! at both ends, so that what is lifted under the mask shows no crease. The edge lies half a pixel
//! from the middles on both sides of it; distances are exact ([`distances`]). Inside is what the
//! mask selects by half or more. The picture's border is no edge.

use super::SELECTED;
use crate::values::Mask;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::distances;
use rayon::prelude::*;

/// Softens a mask's edge, so that what is done under it does not end in a cliff.
#[derive(Clone, Debug, Params)]
pub(crate) struct FeatherMask {
    /// Width of the soft edge, half of it inside; 0 leaves the mask as it is.
    #[param(unit = "px", default = 6.0, range = 0.0..=10_000.0)]
    pub(crate) width: f64,
}

#[derive(Inputs)]
pub(crate) struct Hard<'a> {
    /// The mask.
    mask: &'a Mask,
}

#[derive(Outputs)]
pub(crate) struct Soft {
    /// The mask with its soft edge.
    mask: Mask,
}

impl Node for FeatherMask {
    const KIND: &'static str = "feather_mask";
    type Inputs<'a> = Hard<'a>;
    type Outputs = Soft;

    fn run(&self, inputs: Hard<'_>, cx: &Context<'_>) -> Result<Soft, NodeError> {
        if self.width == 0.0 {
            return Ok(Soft { mask: inputs.mask.clone() });
        }
        let Mask { width, height, values } = inputs.mask;
        let size = (*width, *height);
        let ticker = cx.ticker(2 * height);
        let tick = |rows| ticker.tick(rows);
        let is_in = |at: usize| values[at] >= SELECTED;
        let outwards = cx.completed(distances(size, is_in, &tick))?;
        let inwards = cx.completed(distances(size, |at| !is_in(at), &tick))?;
        let values = outwards.into_par_iter().zip(inwards).map(|(out, within)| {
            // One of the two is 0.
            let from_edge = if within > 0.0 { within - 0.5 } else { 0.5 - out };
            self.share(f64::from(from_edge)) as f32
        });
        Ok(Soft { mask: Mask { width: *width, height: *height, values: values.collect() } })
    }
}

impl FeatherMask {
    /// The share `from_edge` pixels inside of the edge.
    fn share(&self, from_edge: f64) -> f64 {
        let t = (0.5 + from_edge / self.width).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn feather(soft: f64, width: usize, values: Vec<f32>) -> Vec<f32> {
        let mask = Mask { width, height: values.len() / width, values };
        run(|cx| FeatherMask { width: soft }.run(Hard { mask: &mask }, cx)).unwrap().mask.values
    }

    #[test]
    fn a_straight_edge_becomes_the_smooth_step() {
        let edge = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        for width in [1, 8] {
            let soft = feather(4.0, width, edge.clone());
            let expected =
                [0.0, 0.0, 0.042_968_75, 0.316_406_25, 0.683_593_75, 0.957_031_25, 1.0, 1.0];
            assert!(soft.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{soft:?}");
        }
    }

    #[test]
    fn no_width_changes_nothing() {
        assert_eq!(feather(0.0, 2, vec![0.1, 0.9, 0.5, 1.0]), [0.1, 0.9, 0.5, 1.0]);
    }

    #[test]
    fn without_an_edge_nothing_is_softened() {
        assert_eq!(feather(9.0, 3, vec![1.0; 6]), [1.0; 6]);
        assert_eq!(feather(9.0, 3, vec![0.0; 6]), [0.0; 6]);
    }

    #[test]
    fn a_mask_and_what_it_leaves_out_add_up_to_one() {
        let mut random = fastrand::Rng::with_seed(1);
        let mask: Vec<f32> = (0..300).map(|_| f32::from(random.bool())).collect();
        let rest = mask.iter().map(|share| 1.0 - share).collect();
        let (mask, rest) = (feather(3.0, 20, mask), feather(3.0, 20, rest));
        assert!(mask.iter().zip(rest).all(|(a, b)| (a + b - 1.0).abs() < 1e-6));
    }

    #[test]
    fn shares_follow_the_distance_that_a_slow_search_finds() {
        let mut random = fastrand::Rng::with_seed(4);
        let soft = 5.0;
        for (width, height) in [(1, 27), (27, 1), (17, 13)] {
            let mask: Vec<f32> =
                (0..width * height).map(|_| f32::from(random.u8(..) < 30)).collect();
            let share = |at: usize| {
                let apart = |other: usize| {
                    let along = |k: fn(usize, usize) -> usize| {
                        k(at, width).abs_diff(k(other, width)) as f64
                    };
                    along(|at, width| at % width).hypot(along(|at, width| at / width))
                };
                let others = (0..mask.len()).filter(|other| mask[*other] != mask[at]);
                let from_edge = others.map(apart).fold(f64::INFINITY, f64::min) - 0.5;
                let signed = if mask[at] == 1.0 { from_edge } else { -from_edge };
                let t = (0.5 + signed / soft).clamp(0.0, 1.0);
                t * t * (3.0 - 2.0 * t)
            };
            let found = feather(soft, width, mask.clone());
            for (at, found) in found.into_iter().enumerate() {
                assert!((f64::from(found) - share(at)).abs() < 1e-6, "{width} × {height} at {at}");
            }
        }
    }
}

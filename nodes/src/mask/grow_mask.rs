//! A mask made larger or smaller by a distance.
//!
//! Grown by r, a mask selects every pixel whose middle is at most r from that of a selected one;
//! shrunk by r, it keeps those that are further than r from every pixel left out. Distances are
//! exact ([`distances`]), so a dot grows to a disk. Selected is what a mask selects by half or
//! more, and the result is crisp. What lies beyond the picture's border counts as nothing: a mask
//! does not shrink from there.

use super::SELECTED;
use crate::values::Mask;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::distances;
use rayon::prelude::*;

/// Moves a mask's edge outwards or inwards by the same distance everywhere.
#[derive(Clone, Debug, Params)]
pub(crate) struct GrowMask {
    /// How far the edge moves: outwards, or inwards where it is negative.
    #[param(unit = "px", default = 3.0, range = -10_000.0..=10_000.0)]
    pub(crate) by: f64,
}

#[derive(Inputs)]
pub(crate) struct Before<'a> {
    /// The mask.
    mask: &'a Mask,
}

#[derive(Outputs)]
pub(crate) struct After {
    /// The larger or smaller one, crisp.
    mask: Mask,
}

impl Node for GrowMask {
    const KIND: &'static str = "grow_mask";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn run(&self, inputs: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let Mask { width, height, values } = inputs.mask;
        let ticker = cx.ticker(*height);
        let grows = self.by >= 0.0;
        // What spreads: the mask, or what it leaves out.
        let spreads = |at: usize| (values[at] >= SELECTED) == grows;
        let found = distances((*width, *height), spreads, &|rows| ticker.tick(rows));
        let reached = |distance: f32| f64::from(distance) <= self.by.abs();
        let share = |distance: f32| if reached(distance) == grows { 1.0 } else { 0.0 };
        let values = cx.completed(found)?.into_par_iter().map(share).collect();
        Ok(After { mask: Mask { width: *width, height: *height, values } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn grow(by: f64, width: usize, values: Vec<f32>) -> Vec<f32> {
        let mask = Mask { width, height: values.len() / width, values };
        run(|cx| GrowMask { by }.run(Before { mask: &mask }, cx)).unwrap().mask.values
    }

    fn disk(size: usize, radius: f64) -> Vec<f32> {
        let middle = (size / 2) as f64;
        let far = |at: usize| ((at % size) as f64 - middle).hypot((at / size) as f64 - middle);
        (0..size * size).map(|at| if far(at) <= radius { 1.0 } else { 0.0 }).collect()
    }

    #[test]
    fn a_dot_grows_to_a_disk() {
        for radius in [0.0, 1.0, 1.5, 7.25] {
            assert_eq!(grow(radius, 21, disk(21, 0.0)), disk(21, radius), "{radius}");
        }
    }

    #[test]
    fn shrinking_is_growing_what_is_left_out() {
        let left_out = |mask: Vec<f32>| mask.iter().map(|share| 1.0 - share).collect::<Vec<_>>();
        let mask = disk(31, 9.3);
        assert_eq!(grow(-3.0, 31, mask.clone()), left_out(grow(3.0, 31, left_out(mask))));
    }

    #[test]
    fn by_nothing_a_mask_only_becomes_crisp() {
        assert_eq!(grow(0.0, 1, vec![0.4, 0.5, 1.0, 0.0]), [0.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn all_and_nothing_stay_as_they_are() {
        for share in [0.0, 1.0] {
            assert_eq!(grow(2.0, 3, vec![share; 6]), [share; 6]);
            assert_eq!(grow(-2.0, 3, vec![share; 6]), [share; 6]);
        }
    }

    #[test]
    fn masks_grow_and_shrink_as_a_slow_search_says() {
        let mut random = fastrand::Rng::with_seed(7);
        for (width, height) in [(1, 1), (1, 29), (29, 1), (19, 11)] {
            let mask: Vec<f32> =
                (0..width * height).map(|_| f32::from(random.u8(..) < 30)).collect();
            let near = |at: usize, share: f32, reach: f64| {
                mask.iter().enumerate().any(|(other, found)| {
                    let along = |k: fn(usize, usize) -> usize| {
                        k(at, width).abs_diff(k(other, width)) as f64
                    };
                    let far = along(|at, width| at % width).hypot(along(|at, width| at / width));
                    *found == share && far <= reach
                })
            };
            for by in [0.0, 1.0, 1.5, 2.9] {
                let all = 0..width * height;
                let grown: Vec<f32> = all.clone().map(|at| f32::from(near(at, 1.0, by))).collect();
                assert_eq!(grow(by, width, mask.clone()), grown, "{width} × {height} by {by}");
                let shrunk: Vec<f32> = all.map(|at| f32::from(!near(at, 0.0, by))).collect();
                // By -0, which is not negative, it grows by nothing.
                let shrunk = if by == 0.0 { mask.clone() } else { shrunk };
                assert_eq!(grow(-by, width, mask.clone()), shrunk, "{width} × {height} by -{by}");
            }
        }
    }
}

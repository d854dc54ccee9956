//! Dark parts of a picture raised towards its brightest.
//!
//! I' = I + m·p·(I_max - I), with m the mask's share at the pixel, p the lift and I_max the
//! brightest of the whole picture. The source (Sood 2015, section 3.2.7; Sood and others 2018,
//! section 3) lets the user set "the proportion by which the intensity of pixels is modified" and
//! prints no formula; this one goes the proportion p of the way to white. So black hair is raised
//! as much as the lift says (a multiple of its gray would leave it black), nothing gets brighter
//! than the picture was, order among the pixels stays, and detail keeps 1 - p of its depth. Of two
//! lifts it does not matter which comes first: both leave I_max - I multiplied by 1 - m·p.

use super::check_size;
use crate::values::{GrayImage, Mask};
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;

/// Brightens what a mask selects, so that dark hair does not become a crater.
#[derive(Clone, Debug, Params)]
pub(crate) struct MaskLift {
    /// How much of the way to the picture's brightest: 0 leaves it as it is, 1 makes all of it
    /// that bright.
    #[param(default = 0.5, range = 0.0..=1.0)]
    pub(crate) lift: f64,
}

#[derive(Inputs)]
pub(crate) struct Dark<'a> {
    /// The picture.
    image: &'a GrayImage,
    /// What of it is lifted.
    mask: &'a Mask,
}

#[derive(Outputs)]
pub(crate) struct Lifted {
    /// The picture with that part lifted.
    image: GrayImage,
}

impl Node for MaskLift {
    const KIND: &'static str = "mask_lift";
    type Inputs<'a> = Dark<'a>;
    type Outputs = Lifted;

    fn run(&self, inputs: Dark<'_>, _: &Context<'_>) -> Result<Lifted, NodeError> {
        let Dark { image, mask } = inputs;
        let (width, height) = (image.width, image.height);
        check_size(mask, "the picture", (width, height))?;
        let brightest = image.values.par_iter().copied().reduce(|| f32::NEG_INFINITY, f32::max);
        let lift = self.lift as f32;
        let lifted = |(value, share): (&f32, &f32)| value + share * lift * (brightest - value);
        let values = image.values.par_iter().zip(&mask.values).map(lifted).collect();
        Ok(Lifted { image: GrayImage { width, height, values } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn lift(lift: f64, values: &[f32], shares: &[f32]) -> Result<Vec<f32>, String> {
        let image = GrayImage { width: values.len(), height: 1, values: values.to_vec() };
        let mask = Mask { width: shares.len(), height: 1, values: shares.to_vec() };
        let lifted = run(|cx| MaskLift { lift }.run(Dark { image: &image, mask: &mask }, cx));
        lifted.map(|lifted| lifted.image.values).map_err(|fault| fault.to_string())
    }

    #[test]
    fn what_is_selected_goes_that_share_of_the_way_to_the_brightest() {
        let lifted = lift(0.5, &[0.0, 0.0, 0.4, 0.8], &[0.0, 1.0, 0.5, 1.0]).unwrap();
        assert_eq!(lifted, [0.0, 0.4, 0.5, 0.8]);
    }

    #[test]
    fn no_lift_changes_nothing_and_a_full_one_is_level() {
        let values = [0.1, 0.7, 0.3, -0.2];
        assert_eq!(lift(0.0, &values, &[1.0; 4]).unwrap(), values);
        assert!(lift(1.0, &values, &[1.0; 4]).unwrap().iter().all(|v| (v - 0.7).abs() < 1e-6));
    }

    #[test]
    fn the_order_of_two_lifts_does_not_matter() {
        let values = [0.05, 0.2, 0.9, 0.4];
        let (hair, beard) = ([1.0, 0.3, 0.0, 0.5], [0.0, 0.8, 1.0, 0.5]);
        let one = lift(0.3, &lift(0.6, &values, &hair).unwrap(), &beard).unwrap();
        let other = lift(0.6, &lift(0.3, &values, &beard).unwrap(), &hair).unwrap();
        assert!(one.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-6));
    }

    #[test]
    fn a_mask_of_another_size_is_refused_with_both() {
        let message = lift(0.5, &[0.0; 3], &[1.0; 2]).unwrap_err();
        assert!(message.starts_with("the mask has 2 × 1 px and the picture 3 × 1 px"), "{message}");
    }

    #[test]
    fn every_pixel_follows_the_formula_and_what_is_left_out_keeps_its_bits() {
        let mut random = fastrand::Rng::with_seed(8);
        let values: Vec<f32> = (0..501).map(|_| random.f32() * 1.5 - 0.25).collect();
        let shares: Vec<f32> =
            (0..501).map(|k| if k % 3 == 0 { 0.0 } else { random.f32() }).collect();
        let brightest = f64::from(values.iter().copied().fold(f32::NEG_INFINITY, f32::max));
        let lifted = lift(0.37, &values, &shares).unwrap();
        for ((before, share), after) in values.iter().zip(&shares).zip(lifted) {
            let (value, share) = (f64::from(*before), f64::from(*share));
            let wanted = value + share * 0.37 * (brightest - value);
            assert!((f64::from(after) - wanted).abs() < 1e-6);
            assert!(share > 0.0 || after.to_bits() == before.to_bits());
        }
    }
}

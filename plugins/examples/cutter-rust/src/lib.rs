//! A lens cutter: an end mill whose bottom is a very flat ball, with rounded corners.
//!
//! A ball of radius ρ leaves scallops of about s²/8ρ between passes that are s apart, so a flatter
//! bottom carves the same surface with fewer passes. It does not get into what is narrower or
//! rounder than itself: lens cutters finish shallow reliefs and lettering on wide, gentle surfaces.
//!
//! | symbol | meaning |
//! |---|---|
//! | R | radius of the cutter: half its diameter |
//! | B | radius of the bottom, R at least; its centre is on the axis |
//! | c | radius of the corner, R at most; it touches the bottom's circle and the side |
//!
//! The corner's centre is c from the side and, as the circles touch, B - c from the bottom's centre.

use carvegraph_sdk::export::Offers;
use carvegraph_sdk::{
    CutterError, CutterShape, DimensionSpec, DimensionUnit, Dimensions, Profile, Segment,
};

carvegraph_sdk::export!(Offers::new().cutter(Lens));

/// Corners below this are sharp, and what is rounder than R by no more than this is R: a micrometre
/// is less than any cutter is ground to.
const SHARP_MM: f64 = 0.001;

struct Lens;

const DIMENSIONS: &[DimensionSpec] = &[
    DimensionSpec::DIAMETER,
    DimensionSpec {
        name: "bottom_radius",
        about: "Radius of the bottom, as catalogues of lens cutters give it",
        unit: DimensionUnit::Mm,
        default: 15.0,
        min: 0.005,
        max: 1000.0,
    },
    DimensionSpec {
        name: "corner",
        about: "Radius between bottom and side; 0 is a sharp edge",
        unit: DimensionUnit::Mm,
        default: 0.5,
        min: 0.0,
        max: 100.0,
    },
];

impl CutterShape for Lens {
    fn name(&self) -> &str {
        "lens"
    }

    fn about(&self) -> &str {
        "Lens cutter: a very flat ball with rounded corners, for shallow reliefs in few passes"
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        DIMENSIONS
    }

    /// The host has seen to it that each dimension is within its range; that they go together is for
    /// the shape to check.
    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        let diameter = dimensions.get("diameter")?;
        let bottom = dimensions.get("bottom_radius")?;
        let corner = dimensions.get("corner")?;
        let radius = diameter / 2.0;
        if bottom < radius {
            return Err(CutterError::Shape(format!(
                "a bottom_radius of {bottom} mm is less than half the diameter of {diameter} mm; give a \
                 bottom_radius of at least {radius} mm"
            )));
        }
        if corner > radius {
            return Err(CutterError::Shape(format!(
                "a corner of {corner} mm is more than half the diameter of {diameter} mm; give a corner \
                 of at most {radius} mm"
            )));
        }
        Ok(Profile::new(segments(radius, bottom, corner))?)
    }
}

/// From the tip outwards, as (distance from the axis, height).
fn segments(radius: f64, bottom: f64, corner: f64) -> Vec<Segment> {
    let center = [0.0, bottom];
    if radius - corner < SHARP_MM || bottom - radius < SHARP_MM {
        return vec![Segment::Arc { to: [radius, radius], center: [0.0, radius] }];
    }
    if corner < SHARP_MM {
        return vec![Segment::Arc { to: [radius, sag(bottom, radius)], center }];
    }
    let axis = radius - corner;
    let height = corner + sag(bottom - corner, axis);
    let meet = axis * bottom / (bottom - corner);
    vec![
        Segment::Arc { to: [meet, sag(bottom, meet)], center },
        Segment::Arc { to: [radius, height], center: [axis, height] },
    ]
}

/// How far a circle has risen at the distance `r` from its lowest point: ρ - √(ρ² - r²), written so
/// that no digits cancel.
fn sag(radius: f64, r: f64) -> f64 {
    r * r / (radius + ((radius - r) * (radius + r)).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_sdk::conformance;

    fn profile(given: &[(&str, f64)]) -> Result<Profile, CutterError> {
        Lens.profile(&Dimensions::new(DIMENSIONS, given)?)
    }

    /// All that carve expects of a shape, over the whole range of its dimensions.
    #[test]
    fn it_keeps_its_promises() {
        conformance::cutter::check(&Lens);
    }

    #[test]
    fn the_bottom_is_a_circle_and_the_corner_touches_the_side() {
        let lens = profile(&[("diameter", 6.0), ("bottom_radius", 15.0), ("corner", 0.5)]).unwrap();
        let bottom = |r: f64| 15.0 - (225.0 - r * r).sqrt();
        // The corner's centre is 14.5 mm from (0, 15), at r 2.5.
        let height = 15.0 - (14.5_f64 * 14.5 - 2.5 * 2.5).sqrt();
        assert!((lens.height(1.0) - bottom(1.0)).abs() < 1e-12);
        assert!((lens.height(2.5) - bottom(2.5)).abs() < 1e-12);
        assert!((lens.height(3.0) - height).abs() < 1e-12);
        assert!((lens.height(2.9) - (height - (0.25_f64 - 0.16).sqrt())).abs() < 1e-12);
    }

    #[test]
    fn at_its_limits_it_is_a_ball() {
        let ball = Profile::ball(3.0).unwrap();
        assert_eq!(profile(&[("bottom_radius", 3.0)]), Ok(ball.clone()));
        assert_eq!(profile(&[("corner", 3.0)]), Ok(ball));
    }

    #[test]
    fn refusals_say_what_to_change() {
        let refusal = |given: &[(&str, f64)]| profile(given).unwrap_err().to_string();
        assert_eq!(
            refusal(&[("bottom_radius", 2.0)]),
            "a bottom_radius of 2 mm is less than half the diameter of 6 mm; give a bottom_radius of at \
             least 3 mm"
        );
        assert_eq!(
            refusal(&[("corner", 4.0)]),
            "a corner of 4 mm is more than half the diameter of 6 mm; give a corner of at most 3 mm"
        );
    }
}

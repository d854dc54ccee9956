//! Tapered ball nose: a small ball that runs smoothly into a slender cone.
//!
//! The taper angle is that of one side to the axis, as catalogues of tapered end mills, Fusion
//! ("taper angle") and Vectric ("side angle") give it. FreeCAD and some makers of router bits give the
//! included angle, twice as much.

use crate::cone::{Tip, cone};
use carvegraph_sdk::{CutterError, CutterShape, DimensionSpec, DimensionUnit, Dimensions, Profile};

pub(crate) struct TaperedBall;

const DIMENSIONS: &[DimensionSpec] = &[
    DimensionSpec {
        about: "Diameter where the taper ends, mostly that of the shank",
        ..DimensionSpec::DIAMETER
    },
    DimensionSpec {
        name: "tip_radius",
        about: "Radius of the ball at the tip",
        unit: DimensionUnit::Mm,
        default: 0.5,
        min: 0.005,
        max: 100.0,
    },
    DimensionSpec {
        name: "taper_angle",
        about: "Angle of one side to the axis; half of an included angle",
        unit: DimensionUnit::Deg,
        default: 5.0,
        min: 0.1,
        max: 60.0,
    },
];

impl CutterShape for TaperedBall {
    fn name(&self) -> &str {
        "tapered_ball"
    }

    fn about(&self) -> &str {
        "Tapered ball nose, for fine detail in reliefs with a stiff shank"
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        DIMENSIONS
    }

    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        let diameter = dimensions.get("diameter")?;
        let radius = dimensions.get("tip_radius")?;
        let angle = dimensions.get("taper_angle")?.to_radians();
        let tip = Tip::Round(radius);
        if 2.0 * tip.flank_start(angle)[0] < diameter {
            return Ok(cone(tip, angle, diameter / 2.0)?);
        }
        Err(CutterError::Shape(format!(
            "a tip_radius of {radius} mm leaves no taper at a diameter of {diameter} mm, which is that \
             where the taper ends; give a tip_radius below {:.4} mm or a diameter above {:.4} mm, or take \
             a ball",
            diameter / (2.0 * angle.cos()),
            2.0 * radius * angle.cos()
        )))
    }
}

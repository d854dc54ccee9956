//! V-bit: a cone whose tip is sharp, flat or rounded. Engraving bits, chamfer mills and countersinks
//! are V-bits too.
//!
//! The angle is the included one, as V-bits are sold (a 60° bit) and as Vectric and FreeCAD have it;
//! Fusion's chamfer mills are given by the angle of one side, half of it.

use crate::SHARP_MM;
use crate::cone::{Tip, cone};
use carvegraph_sdk::{CutterError, CutterShape, DimensionSpec, DimensionUnit, Dimensions, Profile};

pub(crate) struct VBit;

const DIMENSIONS: &[DimensionSpec] = &[
    DimensionSpec { about: "Greatest diameter of the cone", ..DimensionSpec::DIAMETER },
    DimensionSpec {
        name: "included_angle",
        about: "Angle between both sides of the cone, as V-bits are sold: 60, 90, ...",
        unit: DimensionUnit::Deg,
        default: 60.0,
        min: 5.0,
        max: 170.0,
    },
    DimensionSpec {
        name: "tip_diameter",
        about: "Diameter of a flat tip, as engraving bits have; 0 for none",
        unit: DimensionUnit::Mm,
        default: 0.0,
        min: 0.0,
        max: 100.0,
    },
    DimensionSpec {
        name: "tip_radius",
        about: "Radius of a rounded tip, which runs smoothly into the sides; 0 for none",
        unit: DimensionUnit::Mm,
        default: 0.0,
        min: 0.0,
        max: 100.0,
    },
];

impl CutterShape for VBit {
    fn name(&self) -> &str {
        "v_bit"
    }

    fn about(&self) -> &str {
        "V-bit or engraving bit, for lettering, V-carving, chamfers and fine detail"
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        DIMENSIONS
    }

    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        let diameter = dimensions.get("diameter")?;
        let angle = dimensions.get("included_angle")?;
        let tip = tip(dimensions.get("tip_diameter")?, dimensions.get("tip_radius")?)?;
        let half_angle = angle.to_radians() / 2.0;
        if 2.0 * tip.flank_start(half_angle)[0] < diameter {
            return Ok(cone(tip, half_angle, diameter / 2.0)?);
        }
        Err(CutterError::Shape(no_flank(tip, half_angle, diameter)))
    }
}

fn tip(diameter: f64, radius: f64) -> Result<Tip, CutterError> {
    match (diameter < SHARP_MM, radius < SHARP_MM) {
        (true, true) => Ok(Tip::Sharp),
        (false, true) => Ok(Tip::Flat(diameter / 2.0)),
        (true, false) => Ok(Tip::Round(radius)),
        (false, false) => Err(CutterError::Shape(format!(
            "a tip is either flat or rounded, but tip_diameter is {diameter} mm and tip_radius {radius} \
             mm; set one of them to 0"
        ))),
    }
}

/// What is wrong with a tip that reaches as far out as the cutter.
fn no_flank(tip: Tip, half_angle: f64, diameter: f64) -> String {
    match tip {
        Tip::Round(radius) => format!(
            "a tip_radius of {radius} mm leaves no cone at a diameter of {diameter} mm and an \
             included_angle of {:.4} deg; give a tip_radius below {:.4} mm or a diameter above {:.4} mm",
            2.0 * half_angle.to_degrees(),
            diameter / (2.0 * half_angle.cos()),
            2.0 * radius * half_angle.cos()
        ),
        Tip::Flat(_) | Tip::Sharp => format!(
            "a tip_diameter of {} mm leaves no cone at a diameter of {diameter} mm; give a smaller \
             tip_diameter or a larger diameter",
            2.0 * tip.flank_start(half_angle)[0]
        ),
    }
}

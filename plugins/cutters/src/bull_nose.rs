//! Bull-nose end mill: a flat end mill with a rounded corner (a torus cutter).

use crate::SHARP_MM;
use carvegraph_sdk::{CutterError, CutterShape, DimensionSpec, DimensionUnit, Dimensions, Profile};

pub(crate) struct BullNose;

const DIMENSIONS: &[DimensionSpec] = &[
    DimensionSpec::DIAMETER,
    DimensionSpec {
        name: "corner_radius",
        about: "Radius of the corner between floor and side; 0 is a flat end mill, half the diameter a ball",
        unit: DimensionUnit::Mm,
        default: 1.0,
        min: 0.0,
        max: 100.0,
    },
];

impl CutterShape for BullNose {
    fn name(&self) -> &str {
        "bull_nose"
    }

    fn about(&self) -> &str {
        "Bull-nose end mill, for floors that run into curved walls and for roughing reliefs"
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        DIMENSIONS
    }

    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        let diameter = dimensions.get("diameter")?;
        let corner = dimensions.get("corner_radius")?;
        if 2.0 * corner > diameter {
            return Err(CutterError::Shape(format!(
                "a corner_radius of {corner} mm is more than half the diameter of {diameter} mm; give a \
                 corner_radius of at most {} mm, or a diameter of at least {} mm",
                diameter / 2.0,
                2.0 * corner
            )));
        }
        let corner = if corner < SHARP_MM { 0.0 } else { corner };
        Ok(Profile::bull_nose(diameter / 2.0, corner)?)
    }
}

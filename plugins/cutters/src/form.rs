//! Form tool: any round cutter, from a drawing of its right half. [`crate::drawing`] has the rules.

use crate::drawing;
use carvegraph_sdk::{CutterError, CutterShape, DimensionSpec, Dimensions, Profile};

pub(crate) struct Form;

impl CutterShape for Form {
    fn name(&self) -> &str {
        "form"
    }

    fn about(&self) -> &str {
        "Form tool from an SVG drawing: round-over, ogee, cove and other profiled bits"
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        &[]
    }

    fn drawing(&self) -> Option<&str> {
        Some(
            "The right half of the cutter in true size, as one open path from the tip, which lies on the \
             axis, outward and upward to the rim",
        )
    }

    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        drawing::profile(dimensions.drawing()?).map_err(|e| CutterError::Shape(e.to_string()))
    }
}

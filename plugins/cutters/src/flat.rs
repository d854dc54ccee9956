//! Flat end mill: square to its axis right to the edge.

use carvegraph_sdk::{CutterError, CutterShape, DimensionSpec, Dimensions, Profile};

pub(crate) struct Flat;

impl CutterShape for Flat {
    fn name(&self) -> &str {
        "flat"
    }

    fn about(&self) -> &str {
        "Flat end mill, for clearing and for level floors"
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        &[DimensionSpec::DIAMETER]
    }

    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        Ok(Profile::flat(dimensions.get("diameter")? / 2.0)?)
    }
}

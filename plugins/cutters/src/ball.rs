//! Ball-nose end mill: a half ball of the cutter's diameter.

use carvegraph_sdk::{CutterError, CutterShape, DimensionSpec, Dimensions, Profile};

pub(crate) struct Ball;

impl CutterShape for Ball {
    fn name(&self) -> &str {
        "ball"
    }

    fn about(&self) -> &str {
        "Ball-nose end mill, for reliefs and other curved surfaces"
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        &[DimensionSpec::DIAMETER]
    }

    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        Ok(Profile::ball(dimensions.get("diameter")? / 2.0)?)
    }
}

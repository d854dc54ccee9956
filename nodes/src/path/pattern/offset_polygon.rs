//! An outline made larger or smaller by the same length all around; see
//! [`offset`].

use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Polygon, offset};

/// Grows an outline by a length, or shrinks it by a negative one; holes do the opposite.
#[derive(Clone, Debug, Params)]
pub(crate) struct OffsetPolygon {
    /// How far the outline moves outwards; inwards if it is negative.
    #[param(unit = "mm", default = 0.0, range = -10_000.0..=10_000.0)]
    pub(crate) by: f64,
    /// How far the new outline may lie off its exact place.
    #[param(unit = "mm", default = 0.01, range = 1e-6..=100.0)]
    pub(crate) tolerance: f64,
}

#[derive(Inputs)]
pub(crate) struct Before<'a> {
    /// The outline.
    polygon: &'a Polygon,
}

#[derive(Outputs)]
pub(crate) struct After {
    /// The outline that was moved.
    polygon: Polygon,
}

impl Node for OffsetPolygon {
    const KIND: &'static str = "offset_polygon";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn run(&self, inputs: Before<'_>, _: &Context<'_>) -> Result<After, NodeError> {
        let moved = offset(inputs.polygon, self.by, self.tolerance).ok_or_else(|| {
            NodeError::failed(format!(
                "nothing is left of the outline when it grows by {} mm",
                self.by
            ))
        })?;
        let polygon = moved.within_limit().map_err(|fault| {
            NodeError::failed(format!("of the outline that was moved {fault}: raise tolerance"))
        })?;
        Ok(After { polygon })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::DVec2;

    fn moved(by: f64) -> Result<Polygon, String> {
        let polygon = Polygon::rectangle(DVec2::ZERO, DVec2::new(20.0, 10.0)).unwrap();
        let node = OffsetPolygon { by, tolerance: 0.01 };
        let after = run(|cx| node.run(Before { polygon: &polygon }, cx));
        after.map(|after| after.polygon).map_err(|fault| fault.to_string())
    }

    #[test]
    fn it_grows_and_shrinks_until_nothing_is_left() {
        assert!((moved(-2.0).unwrap().area_mm2() - 16.0 * 6.0).abs() < 1e-9);
        let round = 200.0 + 2.0 * 60.0 + std::f64::consts::PI * 4.0;
        assert!((moved(2.0).unwrap().area_mm2() - round).abs() < 0.2);
        assert_eq!(moved(0.0).unwrap().area_mm2(), 200.0);
        let gone = moved(-5.0).unwrap_err();
        assert_eq!(gone, "nothing is left of the outline when it grows by -5 mm");
    }
}

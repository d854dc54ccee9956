//! Turning, scaling, mirroring and placing of points; the order is the kernel's
//! ([`Placing`](carvegraph_geometry::Placing)).

use super::placing::placing_params;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs};
use carvegraph_geometry::{Bounds, PointCloud};
use rayon::prelude::*;
use std::sync::Arc;

placing_params! {
    /// Mirrors, turns, scales and places points.
    TransformPoints
}

#[derive(Inputs)]
pub(crate) struct Before<'a> {
    /// The points.
    points: &'a PointCloud,
}

#[derive(Outputs)]
pub(crate) struct After {
    /// The points in their new place, in no grid's order any more.
    points: PointCloud,
    /// The box that holds them.
    bounds: Bounds,
}

impl Node for TransformPoints {
    const KIND: &'static str = "transform_points";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn run(&self, inputs: Before<'_>, _: &Context<'_>) -> Result<After, NodeError> {
        let points = &inputs.points.points;
        let map = self.placing().map(points.par_iter().copied()).map_err(NodeError::failed)?;
        let points = points.par_iter().map(|point| map.transform_point3(*point)).collect();
        let points = PointCloud { points: Arc::new(points), grid: None };
        let bounds = points.bounds().ok_or_else(|| NodeError::failed("there are no points"))?;
        Ok(After { points, bounds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::placing::Place;
    use crate::testing::run;
    use carvegraph_geometry::DVec3;

    fn transformed(node: &TransformPoints, points: Vec<DVec3>) -> Result<After, String> {
        let points = PointCloud { points: Arc::new(points), grid: Some((1, 2)) };
        run(|cx| node.run(Before { points: &points }, cx)).map_err(|fault| fault.to_string())
    }

    #[test]
    fn a_survey_of_metres_is_fitted_to_the_stock() {
        let node =
            TransformPoints { fit_x: 100.0, place: Place::Center, ..TransformPoints::neutral() };
        let far = DVec3::new(500_000.0, 4_000_000.0, 10.0);
        let after = transformed(&node, vec![far, far + DVec3::new(50.0, 20.0, 0.0)]).unwrap();
        assert_eq!(after.bounds.min, DVec3::new(-50.0, -20.0, 20.0));
        assert_eq!(after.points.grid, None);
    }

    #[test]
    fn what_has_no_size_cannot_fill_a_box() {
        let node = TransformPoints { fit_y: 10.0, ..TransformPoints::neutral() };
        let message = transformed(&node, vec![DVec3::ZERO, DVec3::X]).err().unwrap();
        assert!(message.contains("no size along the axes that it should fit"), "{message}");
    }
}

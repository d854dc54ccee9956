//! Leaving out what of a cloud of points lies beside a box or an outline; see
//! [`Crop`](carvegraph_geometry::Crop).

use super::cropping::{check, crop, crop_params, nothing_left};
use carvegraph_core::{Conflict, Context, Inputs, Node, NodeError, Outputs};
use carvegraph_geometry::{Bounds, PointCloud, Polygon};

crop_params! {
    /// Keeps the points that lie within a box and, if one is connected, within an outline.
    CropPoints
}

#[derive(Inputs)]
pub(crate) struct Before<'a> {
    /// The points.
    points: &'a PointCloud,
    /// Where points are kept, seen from above.
    polygon: Option<&'a Polygon>,
}

#[derive(Outputs)]
pub(crate) struct After {
    /// The points that are left, in their order.
    points: PointCloud,
    /// The box that holds them.
    bounds: Bounds,
}

impl Node for CropPoints {
    const KIND: &'static str = "crop_points";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn check(&self) -> Result<(), Conflict> {
        check(&self.sides())
    }

    fn run(&self, inputs: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let points = crop(&self.sides(), inputs.polygon)?.points(inputs.points);
        let bounds =
            points.bounds().ok_or_else(|| nothing_left("points", inputs.points.bounds()))?;
        let (kept, all) = (points.points.len(), inputs.points.points.len());
        if kept < all {
            cx.note(format!("kept {kept} of {all} points"));
        }
        Ok(After { points, bounds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_core::Yielding;
    use carvegraph_geometry::{DVec2, DVec3};
    use std::sync::Arc;

    fn cropped(node: &CropPoints, polygon: Option<&Polygon>) -> Result<After, String> {
        let points = (0..10).map(|k| DVec3::splat(f64::from(k))).collect();
        let points = PointCloud { points: Arc::new(points), grid: None };
        run(|cx| node.run(Before { points: &points, polygon }, cx))
            .map_err(|fault| fault.to_string())
    }

    #[test]
    fn box_and_outline_both_have_to_hold_a_point() {
        let all = cropped(&CropPoints::neutral(), None).unwrap();
        assert_eq!(all.points.points.len(), 10);
        let node = CropPoints { z_max: Yielding::given(6.0), ..CropPoints::neutral() };
        let outline = Polygon::rectangle(DVec2::splat(3.5), DVec2::splat(99.0)).unwrap();
        let some = cropped(&node, Some(&outline)).unwrap();
        assert_eq!((some.bounds.min, some.bounds.max), (DVec3::splat(4.0), DVec3::splat(6.0)));
    }

    #[test]
    fn a_box_beside_the_points_is_told() {
        let node = CropPoints { y_min: Yielding::given(20.0), ..CropPoints::neutral() };
        let told = cropped(&node, None).err().unwrap();
        assert!(told.starts_with("nothing is left: the points lie between 0.000"), "{told}");
        let bad = CropPoints { y_max: Yielding::given(3.0), ..node };
        assert_eq!(bad.check().unwrap_err().param, "y_max");
    }
}

//! Spokes about the middle of a part.

use super::{Area, Passes, laid};
use carvegraph_core::{Context, Node, NodeError, Params};
use carvegraph_geometry::{Pace, Radial};

/// Lays spokes from the middle of a part to its border, fewer of them near the middle.
#[derive(Clone, Debug, Params)]
pub(crate) struct RadialNode {
    /// Largest distance between neighbouring spokes; they are half as far apart at least.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) stepover: f64,
    /// Largest distance between points along a spoke.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) feed_step: f64,
    /// Whether a pass around the border covers what is left of corners.
    #[param(default = true)]
    pub(crate) border: bool,
}

impl Node for RadialNode {
    const KIND: &'static str = "radial";
    const VERSION: u32 = 2;
    type Inputs<'a> = Area<'a>;
    type Outputs = Passes;

    fn run(&self, area: Area<'_>, _: &Context<'_>) -> Result<Passes, NodeError> {
        let pace = Pace { stepover_mm: self.stepover, feed_step_mm: self.feed_step };
        laid(&Radial { pace, border: self.border }, pace, &area)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{over, over_half, refusal};
    use super::*;
    use crate::testing::run;

    const NODE: RadialNode = RadialNode { stepover: 1.0, feed_step: 0.5, border: true };

    #[test]
    fn the_first_spoke_leads_to_the_middle_and_all_keep_to_a_boundary() {
        let all = over((10.0, 10.0), |area| run(|cx| NODE.run(area, cx))).unwrap();
        let ends = [(10.0, 5.0), (5.0, 5.0)].map(|(x, y)| carvegraph_geometry::DVec2::new(x, y));
        let first = &all.points[all.spans[0].points.clone()];
        assert_eq!([first[0], first[first.len() - 1]], ends);
        let bare = RadialNode { border: false, ..NODE };
        let bare = over((10.0, 10.0), |area| run(|cx| bare.run(area, cx))).unwrap();
        assert!(bare.points.len() + 70 < all.points.len());
        let half = over_half((10.0, 10.0), |area| run(|cx| NODE.run(area, cx)));
        assert!(half.points.len() < all.points.len());
    }

    #[test]
    fn too_many_points_are_refused_with_their_number() {
        let fine = RadialNode { stepover: 1e-9, ..NODE };
        let (param, message) = refusal(over((10.0, 10.0), |area| run(|cx| fine.run(area, cx))));
        assert_eq!(param, "stepover");
        assert!(message.contains("points; the limit is 5e7"), "{message}");
    }
}

//! Circles about the middle of a part.

use super::{Area, Begin, Direction, Passes, laid};
use carvegraph_core::{Context, Node, NodeError, Params};
use carvegraph_geometry::{Circles, Pace};

/// Lays circles about the middle of a part, linked to each other.
#[derive(Clone, Debug, Params)]
pub(crate) struct CirclesNode {
    /// Distance between neighbouring circles.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) stepover: f64,
    /// Distance between points along a circle; less where it bends too much for it.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) feed_step: f64,
    /// Where the passes begin.
    #[param(default = Begin::Middle)]
    pub(crate) from: Begin,
    /// Which way round they go; from the middle counter-clockwise is climb, from outside clockwise. Arcs
    /// cut by the border go there and back.
    #[param(default = Direction::CounterClockwise)]
    pub(crate) direction: Direction,
    /// Whether a pass around the border covers what is left of corners.
    #[param(default = true)]
    pub(crate) border: bool,
}

impl Node for CirclesNode {
    const KIND: &'static str = "circles";
    type Inputs<'a> = Area<'a>;
    type Outputs = Passes;

    fn run(&self, area: Area<'_>, _: &Context<'_>) -> Result<Passes, NodeError> {
        let pace = Pace { stepover_mm: self.stepover, feed_step_mm: self.feed_step };
        let (start, turn, border) = (self.from.start(), self.direction.turn(), self.border);
        laid(&Circles { pace, start, turn, border }, pace, &area)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{over, over_half, refusal};
    use super::*;
    use crate::testing::run;

    const NODE: CirclesNode = CirclesNode {
        stepover: 1.0,
        feed_step: 0.5,
        from: Begin::Middle,
        direction: Direction::CounterClockwise,
        border: true,
    };

    #[test]
    fn it_begins_where_it_is_told_and_keeps_to_a_boundary() {
        let middle = carvegraph_geometry::DVec2::splat(5.0);
        let out = over((10.0, 10.0), |area| run(|cx| NODE.run(area, cx))).unwrap();
        assert_eq!(out.points[0], middle);
        let node = CirclesNode { from: Begin::Outside, ..NODE };
        let inwards = over((10.0, 10.0), |area| run(|cx| node.run(area, cx))).unwrap();
        assert!(inwards.points[0].min_element() < 1e-9 && inwards.points.contains(&middle));
        let half = over_half((10.0, 10.0), |area| run(|cx| NODE.run(area, cx)));
        let share = half.points.len() as f64 / out.points.len() as f64;
        // Half of the area, but 34 mm of border to 40.
        assert!((0.5..0.8).contains(&share), "{share}");
    }

    #[test]
    fn too_many_points_are_refused_with_their_number() {
        let fine = CirclesNode { feed_step: 1e-9, ..NODE };
        let (param, message) = refusal(over((10.0, 10.0), |area| run(|cx| fine.run(area, cx))));
        assert_eq!(param, "feed_step");
        assert!(message.contains("points; the limit is 5e7"), "{message}");
    }
}

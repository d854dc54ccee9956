//! Passes parallel to the outlines of a part or of a boundary.

use super::{Area, Begin, Direction, Passes, laid};
use carvegraph_core::{Context, Node, NodeError, Params};
use carvegraph_geometry::{ContourParallel, Pace};

/// Lays passes parallel to the outlines of a part or of a boundary, each within the last.
#[derive(Clone, Debug, Params)]
pub(crate) struct ContourParallelNode {
    /// Distance between neighbouring passes.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) stepover: f64,
    /// Largest distance between points along a pass.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) feed_step: f64,
    /// Where the passes begin.
    #[param(default = Begin::Outside)]
    pub(crate) from: Begin,
    /// Which way round they go, around holes the other way; from outside clockwise is climb, from the
    /// middle counter-clockwise.
    #[param(default = Direction::CounterClockwise)]
    pub(crate) direction: Direction,
}

impl Node for ContourParallelNode {
    const KIND: &'static str = "contour_parallel";
    const VERSION: u32 = 2;
    type Inputs<'a> = Area<'a>;
    type Outputs = Passes;

    fn run(&self, area: Area<'_>, _: &Context<'_>) -> Result<Passes, NodeError> {
        let pace = Pace { stepover_mm: self.stepover, feed_step_mm: self.feed_step };
        let layout =
            ContourParallel { pace, start: self.from.start(), turn: self.direction.turn() };
        laid(&layout, pace, &area)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{over, over_half, refusal};
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::{DVec2, Pattern};

    const NODE: ContourParallelNode = ContourParallelNode {
        stepover: 1.0,
        feed_step: 0.5,
        from: Begin::Outside,
        direction: Direction::CounterClockwise,
    };

    fn made(node: &ContourParallelNode) -> Result<Pattern, NodeError> {
        over((10.0, 10.0), |area| run(|cx| node.run(area, cx)))
    }

    #[test]
    fn it_begins_where_it_is_told() {
        let (first, ring) = (DVec2::ZERO, DVec2::splat(5.0));
        assert_eq!(made(&NODE).unwrap().points[0], first);
        let out = ContourParallelNode { from: Begin::Middle, ..NODE };
        let out = made(&out).unwrap().points;
        assert!(out[0].distance(ring) < 1.0 && out[out.len() - 1].min_element() < 1e-9);
    }

    #[test]
    fn rings_follow_a_boundary() {
        let half = over_half((10.0, 10.0), |area| run(|cx| NODE.run(area, cx)));
        // The slanted side of the triangle is passed along.
        let on_it = |p: &&DVec2| (p.x + p.y - 10.0).abs() < 1e-9;
        assert!(half.points.iter().filter(on_it).count() > 25);
        // Its inside is 2.9 mm deep: the rings at 0, 1 and 2 mm, and passes in the middle.
        let passes = half.spans.iter().filter(|span| !span.link).count();
        assert!((4..12).contains(&passes), "{passes}");
    }

    #[test]
    fn too_many_points_are_refused_with_their_number() {
        let (param, message) = refusal(made(&ContourParallelNode { stepover: 1e-9, ..NODE }));
        assert_eq!(param, "stepover");
        assert!(message.contains("points; the limit is 5e7"), "{message}");
    }
}

//! Rectangles within a rectangle.

use super::{Area, Begin, Direction, Passes, laid};
use carvegraph_core::{Context, Inputs, Node, NodeError, Params};
use carvegraph_geometry::{Bounds, ContourParallel, Pace};

/// Lays passes parallel to the part's border, each within the last.
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
    /// Which way round they go.
    #[param(default = Direction::CounterClockwise)]
    pub(crate) direction: Direction,
}

#[derive(Inputs)]
pub(crate) struct Rectangle<'a> {
    /// The box that holds the part.
    area: &'a Bounds,
}

impl Node for ContourParallelNode {
    const KIND: &'static str = "contour_parallel";
    type Inputs<'a> = Rectangle<'a>;
    type Outputs = Passes;

    fn run(&self, rectangle: Rectangle<'_>, _: &Context<'_>) -> Result<Passes, NodeError> {
        let pace = Pace { stepover_mm: self.stepover, feed_step_mm: self.feed_step };
        let layout =
            ContourParallel { pace, start: self.from.start(), turn: self.direction.turn() };
        laid(&layout, pace, &Area { area: rectangle.area, boundary: None })
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{over, refusal};
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
        over((10.0, 10.0), |Area { area, .. }| run(|cx| node.run(Rectangle { area }, cx)))
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
    fn too_many_points_are_refused_with_their_number() {
        let (param, message) = refusal(made(&ContourParallelNode { stepover: 1e-9, ..NODE }));
        assert_eq!(param, "stepover");
        assert!(message.contains("points; the limit is 5e7"), "{message}");
    }
}

//! One line that fills a part without a direction of its own: a Hilbert curve.

use super::{Area, Passes, laid};
use carvegraph_core::{Context, Node, NodeError, Params};
use carvegraph_geometry::{Hilbert, Pace};

/// Fills a part with one winding pass that leaves no lines in any direction.
#[derive(Clone, Debug, Params)]
pub(crate) struct HilbertNode {
    /// Largest distance between neighbouring lines of the curve.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) stepover: f64,
    /// Largest distance between points; corners of the curve are points always.
    #[param(unit = "mm", default = 0.3, range = f64::MIN_POSITIVE..=1000.0)]
    pub(crate) feed_step: f64,
}

impl Node for HilbertNode {
    const KIND: &'static str = "hilbert";
    type Inputs<'a> = Area<'a>;
    type Outputs = Passes;

    fn run(&self, area: Area<'_>, _: &Context<'_>) -> Result<Passes, NodeError> {
        let pace = Pace { stepover_mm: self.stepover, feed_step_mm: self.feed_step };
        laid(&Hilbert { pace }, pace, &area)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{over, over_half, refusal};
    use super::*;
    use crate::testing::run;

    const NODE: HilbertNode = HilbertNode { stepover: 1.0, feed_step: 0.5 };

    #[test]
    fn it_has_two_points_a_cell_and_keeps_to_a_boundary() {
        let all = over((10.0, 6.0), |area| run(|cx| NODE.run(area, cx))).unwrap();
        assert_eq!((all.spans.len(), all.points.len()), (1, 2 * 60 - 1));
        let half = over_half((10.0, 6.0), |area| run(|cx| NODE.run(area, cx)));
        assert!(half.points.len() < 90);
    }

    #[test]
    fn too_many_points_are_refused_with_their_number() {
        let fine = HilbertNode { stepover: 1e-9, ..NODE };
        let (param, message) = refusal(over((10.0, 10.0), |area| run(|cx| fine.run(area, cx))));
        assert_eq!(param, "stepover");
        assert!(message.contains("would make 1.000e20 points; the limit is 5e7"), "{message}");
    }
}

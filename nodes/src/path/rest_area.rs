//! Where a larger cutter leaves material that is worth a finer one.
//!
//! A cutter that has gone everywhere leaves its own fillets in all that is narrower than itself. Their
//! outline bounds the passes of the finer cutter, which then need not go over the whole part
//! ([`carvegraph_geometry::leftover`] has the method and its limits).
//!
//! Where nothing is worth it the run is refused, as a recipe for a part that needs no rest pass: an
//! outline cannot be empty, and a program that silently lacks an operation is not what was asked for.

use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Cutter, HeightField, Polygon, RestError, leftover, rest_area};

/// Finds where a larger cutter leaves material, as an outline for the passes of a finer one.
#[derive(Clone, Debug, Params)]
pub(crate) struct RestAreaNode {
    /// How much must be left to be worth the finer cutter.
    #[param(unit = "mm", default = 0.05, range = 0.001..=100.0)]
    pub(crate) threshold: f64,
    /// By how much the outline is grown, so that passes overlap. With the radius of the finer cutter it
    /// reaches all of what is left on steep walls too.
    #[param(unit = "mm", default = 1.0, range = 0.0..=1000.0)]
    pub(crate) margin: f64,
}

#[derive(Inputs)]
pub(crate) struct Finished<'a> {
    /// The surface that the part is to have.
    surface: &'a HeightField,
    /// The larger cutter, which has finished it already.
    cutter: &'a Cutter,
}

#[derive(Outputs)]
pub(crate) struct Rest {
    /// The outline of what is left.
    polygon: Polygon,
    /// The surface that the larger cutter leaves.
    left: HeightField,
}

impl Node for RestAreaNode {
    const KIND: &'static str = "rest_area";
    type Inputs<'a> = Finished<'a>;
    type Outputs = Rest;

    fn run(&self, inputs: Finished<'_>, cx: &Context<'_>) -> Result<Rest, NodeError> {
        let Finished { surface, cutter } = inputs;
        let ticker = cx.ticker(4 * surface.heights().len());
        let tick = |nodes| ticker.tick(nodes);
        let left = leftover(surface, &cutter.profile, &tick);
        let left = cx.completed(left)?;
        let area = rest_area(surface, &left, self.threshold, self.margin, &tick);
        let area = area.map_err(|fault| refusal(fault, cutter))?;
        cx.note(format!(
            "the {} leaves more than {} mm on {:.0} % of the part, {:.3} mm at most; with the margin the finer \
             cutter goes over {:.0} %",
            cutter.name,
            self.threshold,
            100.0 * area.share,
            area.most_mm,
            100.0 * area.outlined
        ));
        Ok(Rest { polygon: area.outline, left })
    }
}

fn refusal(fault: RestError, cutter: &Cutter) -> NodeError {
    let diameter = 2.0 * cutter.profile.radius_mm();
    let message = match fault {
        RestError::Nothing { threshold_mm, most_mm } => format!(
            "the {}, diameter {diameter} mm, leaves nothing above {threshold_mm} mm, {most_mm:.4} mm at \
             most: no rest pass is needed (lower threshold, or carve with this cutter alone)",
            cutter.name
        ),
        RestError::Ragged(_) | RestError::TooLong(_) => {
            format!("{fault} (raise threshold or margin, or smooth the surface)")
        }
        RestError::OtherGrid => return NodeError::failed(fault),
        RestError::Stopped => return NodeError::Cancelled,
    };
    NodeError::refused("threshold", message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::testing::ball;
    use crate::testing::run;

    const NODE: RestAreaNode = RestAreaNode { threshold: 0.05, margin: 0.5 };

    /// A groove of two walls at 45° along y, in the middle of 8 mm.
    fn groove() -> HeightField {
        let wall = |k: usize| ((k % 81) as f32 * 0.1 - 4.0).abs();
        HeightField::new(81, 41, 0.1, (0..81 * 41).map(wall).collect()).unwrap()
    }

    fn rest(node: &RestAreaNode, surface: &HeightField, diameter: f64) -> Result<Rest, NodeError> {
        let cutter = ball(diameter);
        run(|cx| node.run(Finished { surface, cutter: &cutter }, cx))
    }

    #[test]
    fn the_outline_is_that_of_the_fillet_and_the_margin() {
        let Rest { polygon, left } = rest(&NODE, &groove(), 4.0).unwrap();
        assert!((left.height(40, 20) - 2.0 * (2.0_f64.sqrt() - 1.0)).abs() < 1e-6);
        let [corners] = polygon.loops() else { panic!("{:?}", polygon.loops()) };
        let reach = corners.iter().map(|corner| (corner.x - 4.0).abs()).fold(0.0, f64::max);
        // The ball touches 1.414 mm beside the middle; its fillet is 0.05 mm deep 1.09 mm beside it.
        assert!((1.5..1.9).contains(&reach), "{reach}");
    }

    #[test]
    fn a_cutter_that_leaves_nothing_is_told_with_what_it_leaves() {
        let plane = HeightField::new(9, 9, 0.5, vec![1.0; 81]).unwrap();
        let Err(NodeError::Refused { param, message }) = rest(&NODE, &plane, 4.0) else {
            panic!("it must be refused")
        };
        assert_eq!(param, "threshold");
        assert_eq!(
            message,
            "the ball, diameter 4 mm, leaves nothing above 0.05 mm, 0.0000 mm at most: no rest pass is \
             needed (lower threshold, or carve with this cutter alone)"
        );
    }

    #[test]
    fn an_outline_with_too_many_corners_is_told() {
        // Pits at every other node: each has an outline of its own.
        let pit = |k: usize| if (k % 401) % 2 == 1 && (k / 401) % 2 == 1 { 0.0 } else { 1.0 };
        let pits = HeightField::new(401, 401, 1.0, (0..401 * 401).map(pit).collect()).unwrap();
        let fault = rest(&RestAreaNode { margin: 0.0, ..NODE }, &pits, 20.0).err().unwrap();
        assert_eq!(
            fault.to_string(),
            "the outline of what is left is too ragged: there are 160000 corners; the limit is 100000 \
             (raise threshold or margin, or smooth the surface)"
        );
    }
}

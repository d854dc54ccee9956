//! No wall steeper than an angle, so that a cutter reaches its foot and thin ridges hold; see
//! [`limit_slope`] for the method, which is exact.

use super::{After, Before, size};
use carvegraph_core::{Choice, Context, Node, NodeError, Params};
use carvegraph_geometry::{SlopeLimit, limit_slope};

/// Lays back what is steeper than an angle, and leaves everything else as it is.
#[derive(Clone, Debug, Params)]
pub(crate) struct LimitSlope {
    /// The steepest slope, from the horizontal: 90° less half the angle of a V-bit that is to reach
    /// everywhere. 90 changes nothing.
    #[param(unit = "deg", default = 75.0, range = 1.0..=90.0)]
    pub(crate) angle: f64,
    /// Where the room comes from.
    #[param(default = Way::Fill)]
    pub(crate) way: Way,
}

/// How a steep wall is laid back.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Way {
    /// Its upper edge is cut down; nothing gets higher.
    Cut,
    /// Its foot is filled up; nothing gets lower.
    Fill,
}

impl Node for LimitSlope {
    const KIND: &'static str = "limit_slope";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn run(&self, Before { surface }: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        if self.angle >= 90.0 {
            return After::of(surface.heights().to_vec(), size(surface), surface);
        }
        let limit = match self.way {
            Way::Cut => SlopeLimit::Cut,
            Way::Fill => SlopeLimit::Fill,
        };
        let ticker = cx.ticker(surface.rows());
        let slope = self.angle.to_radians().tan();
        let heights = limit_slope(surface, slope, limit, &|rows| ticker.tick(rows));
        After::of(cx.completed(heights)?, size(surface), surface)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{field, shaped};
    use super::*;

    #[test]
    fn a_wall_gets_a_slope_below_or_above_its_edge() {
        let wall = field(&[[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]; 2]);
        let row = |angle, way| shaped(&LimitSlope { angle, way }, &wall).unwrap().row(1).to_vec();
        let near = |found: Vec<f32>, expected: [f32; 6]| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
        };
        // 45° over pitches of 0.5 mm.
        near(row(45.0, Way::Fill), [0.0, 0.0, 0.5, 1.0, 1.0, 1.0]);
        near(row(45.0, Way::Cut), [0.0, 0.0, 0.0, 0.5, 1.0, 1.0]);
        near(row(90.0, Way::Cut), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    }
}

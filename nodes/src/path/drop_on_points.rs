//! Cutter location on points without an order: the drop cutter.
//!
//! The cutter is lowered at each point of a pattern until it first touches a point of the cloud. That
//! is as good as a mesh where the points are dense: at most a fifth of the cutter's radius apart
//! (Sood 2015, section 4.2). Elsewhere the cutter sinks between them. The heights are exact for every
//! cutter, see [`carvegraph_geometry::DropCutter`].

use super::dropping::{Tip, dropped};
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Cutter, Pattern, PointCloud, Surface, Toolpath};

/// Lowers the cutter onto points at every point of a pattern. The path is that of the tip.
#[derive(Clone, Debug, Params)]
pub(crate) struct DropOnPoints {
    #[param(shared)]
    pub(crate) tip: Tip,
}

#[derive(Inputs)]
pub(crate) struct Dropping<'a> {
    /// Points of the surface to be cut, much denser than the cutter is wide.
    points: &'a PointCloud,
    /// The cutter.
    cutter: &'a Cutter,
    /// Where to drop it.
    pattern: &'a Pattern,
}

#[derive(Outputs)]
pub(crate) struct Dropped {
    /// The path of the tip, without the moves from one pass to the next.
    toolpath: Toolpath,
}

impl Node for DropOnPoints {
    const KIND: &'static str = "drop_on_points";
    type Inputs<'a> = Dropping<'a>;
    type Outputs = Dropped;

    fn run(&self, inputs: Dropping<'_>, cx: &Context<'_>) -> Result<Dropped, NodeError> {
        let Dropping { points, cutter, pattern } = inputs;
        let surface = Surface::Points(points);
        let toolpath = dropped(surface, cutter, pattern, &self.tip, cx)?;
        Ok(Dropped { toolpath })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_core::Yielding;
    use carvegraph_geometry::{Contact, ContactKind, DVec2, DVec3, PatternSpan, Profile};
    use std::sync::Arc;

    #[test]
    fn a_flat_cutter_rests_on_the_highest_point_under_it() {
        let points =
            [DVec3::new(0.0, 0.0, 2.0), DVec3::new(1.9, 0.0, 3.0), DVec3::new(2.1, 0.0, 4.0)];
        let points = PointCloud { points: Arc::new(points.to_vec()), grid: None };
        let cutter = Cutter { name: "flat".into(), profile: Profile::flat(2.0).unwrap() };
        let spans = vec![PatternSpan { points: 0..2, link: false, joined: false }];
        let pattern = Pattern { points: vec![DVec2::ZERO, DVec2::splat(9.0)], spans };
        let inputs = Dropping { points: &points, cutter: &cutter, pattern: &pattern };
        let path = run(|cx| {
            DropOnPoints {
                tip: Tip { floor: Yielding::given(-1.0), allowance: 0.0, chord_tolerance: 0.0 },
            }
            .run(inputs, cx)
        })
        .unwrap()
        .toolpath;
        assert_eq!((path.tips[0].z, path.tips[1].z), (3.0, -1.0));
        let touched = Contact { point: points.points[1], kind: ContactKind::Vertex };
        assert_eq!(path.contacts, [touched, Contact::NONE]);
    }
}

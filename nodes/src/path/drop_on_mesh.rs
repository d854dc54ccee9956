//! Cutter location on a mesh of any kind: the drop cutter.
//!
//! The cutter is lowered at each point of a pattern until it first touches a facet, an edge or a
//! vertex. The mesh may be open, dirty or a closed solid; of overhangs the highest is touched, and
//! which way a facet points does not matter. The heights are exact for every cutter, see
//! [`carvegraph_geometry::DropCutter`]. For a surface with one height above each node of a grid,
//! `drop_cutter` does the same without triangles.

use super::dropping::{Tip, dropped};
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Cutter, Mesh, Pattern, Surface, Toolpath};

/// Lowers the cutter onto a mesh at every point of a pattern. The path is that of the tip.
#[derive(Clone, Debug, Params)]
pub(crate) struct DropOnMesh {
    #[param(shared)]
    pub(crate) tip: Tip,
}

#[derive(Inputs)]
pub(crate) struct Dropping<'a> {
    /// The surface to be cut.
    mesh: &'a Mesh,
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

impl Node for DropOnMesh {
    const KIND: &'static str = "drop_on_mesh";
    type Inputs<'a> = Dropping<'a>;
    type Outputs = Dropped;

    fn run(&self, inputs: Dropping<'_>, cx: &Context<'_>) -> Result<Dropped, NodeError> {
        let Dropping { mesh, cutter, pattern } = inputs;
        let surface = Surface::Mesh(mesh);
        let toolpath = dropped(surface, cutter, pattern, &self.tip, cx)?;
        Ok(Dropped { toolpath })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_core::Yielding;
    use carvegraph_geometry::{ContactKind, DVec2, DVec3, PatternSpan, Profile};
    use std::sync::Arc;

    fn drop_on(triangle: [u32; 3]) -> Result<Dropped, NodeError> {
        let corners = [DVec3::ZERO, DVec3::new(10.0, 0.0, 0.0), DVec3::new(0.0, 10.0, 10.0)];
        let mesh = Mesh { vertices: Arc::new(corners.to_vec()), triangles: vec![triangle] };
        let cutter = Cutter { name: "ball".into(), profile: Profile::ball(1.0).unwrap() };
        let points = vec![DVec2::splat(3.0), DVec2::splat(30.0)];
        let spans = vec![PatternSpan { points: 0..2, link: false, joined: false }];
        let pattern = Pattern { points, spans };
        let node = DropOnMesh {
            tip: Tip { floor: Yielding::given(-5.0), allowance: 0.0, chord_tolerance: 0.0 },
        };
        run(|cx| node.run(Dropping { mesh: &mesh, cutter: &cutter, pattern: &pattern }, cx))
    }

    #[test]
    fn a_ball_stands_off_the_slope_and_falls_to_the_floor_beside_it() {
        let path = drop_on([0, 1, 2]).unwrap().toolpath;
        // On a slope of 45° it is raised by R·(√2 − 1).
        assert!((path.tips[0].z - (3.0 + 2.0_f64.sqrt() - 1.0)).abs() < 1e-12);
        assert_eq!(path.contacts[0].kind, ContactKind::Facet);
        assert_eq!((path.tips[1].z, path.contacts[1].kind), (-5.0, ContactKind::None));
    }

    #[test]
    fn a_vertex_that_is_missing_is_told() {
        let error = drop_on([0, 1, 3]).map(|_| ()).unwrap_err();
        let told = "triangle 0 has vertex 3, but there are only 3";
        assert!(error.to_string().contains(told), "{error}");
    }
}

//! Finishing steep walls at constant heights.
//!
//! At each level the cutter goes around the surface where it touches it at just that height. What
//! passes from above are poor at, steep walls, has them evenly spaced; level ground, which lies between
//! two of them, is left to passes from above.

use super::level::{Side, WayDown, made, only, pitch, widened};
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{
    Bounds, Cutter, HeightField, Levels, Mesh, PointCloud, Polygon, Toolpath, Waterline,
};

/// Goes around the surface at constant heights.
#[derive(Clone, Debug, Params)]
pub(crate) struct WaterlineNode {
    /// Greatest distance between levels.
    #[param(unit = "mm", default = 0.5, range = 0.001..=200.0)]
    pub(crate) depth_per_pass: f64,
    /// What is left on the surface.
    #[param(unit = "mm", default = 0.0, range = 0.0..=50.0)]
    pub(crate) allowance: f64,
    /// Which side of the cutter the material is on.
    #[param(default = Side::Climb)]
    pub(crate) milling: Side,
    /// How the cutter gets down to a level.
    #[param(default = WayDown::Ramp)]
    pub(crate) entry: WayDown,
    /// How steep the way down is, at the most.
    #[param(unit = "deg", default = 10.0, range = 0.1..=45.0)]
    pub(crate) angle: f64,
    /// How far beyond the part's box the cutter's axis may go; less than its radius leaves the outermost
    /// walls.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1000.0)]
    pub(crate) around: f64,
    /// Distance between the places where outlines are looked for; 0 takes an eighth of the cutter's
    /// radius.
    #[param(unit = "mm", default = 0.0, range = 0.0..=100.0)]
    pub(crate) grid: f64,
    /// How far outlines may lie off; as much more may be left.
    #[param(unit = "mm", default = 0.005, range = 0.0001..=10.0)]
    pub(crate) tolerance: f64,
}

#[derive(Inputs)]
pub(crate) struct Walls<'a> {
    /// The surface, if it is a height field.
    field: Option<&'a HeightField>,
    /// The surface, if it is a mesh.
    mesh: Option<&'a Mesh>,
    /// The surface, if it is points.
    points: Option<&'a PointCloud>,
    /// The cutter.
    cutter: &'a Cutter,
    /// The box of the part, in which the cutter's axis stays; that of the surface if nothing is
    /// connected.
    part: Option<&'a Bounds>,
    /// What of it is to be cut; all of it if nothing is connected.
    boundary: Option<&'a Polygon>,
}

#[derive(Outputs)]
pub(crate) struct Lines {
    /// The path of the tip, without the travel between passes.
    toolpath: Toolpath,
}

impl Node for WaterlineNode {
    const KIND: &'static str = "waterline";
    type Inputs<'a> = Walls<'a>;
    type Outputs = Lines;

    fn run(&self, inputs: Walls<'_>, cx: &Context<'_>) -> Result<Lines, NodeError> {
        let Walls { field, mesh, points, cutter, part, boundary } = inputs;
        let (surface, bounds) = only(field, mesh, points)?;
        let part = part.unwrap_or(&bounds);
        let levels = Levels {
            area: widened(part, self.around),
            boundary,
            top_mm: part.max.z,
            floor_mm: part.min.z,
            step_mm: self.depth_per_pass,
            allowance_mm: self.allowance,
            pitch_mm: pitch(self.grid, cutter.profile.radius_mm()),
            tolerance_mm: self.tolerance,
            entry: self.entry.entry(self.angle),
        };
        let waterline = Waterline { levels, milling: self.milling.milling() };
        let toolpath = made(&levels, cx, |tick| waterline.path(surface, &cutter.profile, tick))?;
        Ok(Lines { toolpath })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::{DVec3, Profile, SpanKind};
    use std::sync::Arc;

    #[test]
    fn a_cone_gets_a_ring_at_each_level() {
        // 12 mm high and wide, of 360 sides, its tip at 0, 0.
        let rim = (0..360).map(|k| f64::from(k).to_radians());
        let mut vertices = vec![DVec3::new(0.0, 0.0, 12.0)];
        vertices.extend(rim.map(|angle| DVec3::new(12.0 * angle.cos(), 12.0 * angle.sin(), 0.0)));
        let triangles = (1..=360).map(|k| [0, k, k % 360 + 1]).collect();
        let mesh = Mesh { vertices: Arc::new(vertices), triangles };
        let node = WaterlineNode {
            depth_per_pass: 3.0,
            allowance: 0.0,
            milling: Side::Climb,
            entry: WayDown::Plunge,
            angle: 10.0,
            around: 4.0,
            grid: 0.5,
            tolerance: 0.001,
        };
        let cutter = Cutter { name: "ball".into(), profile: Profile::ball(2.0).unwrap() };
        let (mesh, cutter) = (Some(&mesh), &cutter);
        let walls = Walls { field: None, mesh, points: None, cutter, part: None, boundary: None };
        let path = run(|cx| node.run(walls, cx)).unwrap().toolpath;
        assert_eq!(path.passes(), 4);
        for span in path.spans.iter().filter(|span| span.kind == SpanKind::Pass) {
            for tip in &path.tips[span.points.clone()] {
                // On a slope of 45° the ball stands off by R·(√2 − 1) in height, and as much aside.
                let off = 2.0 * (2.0_f64.sqrt() - 1.0);
                let should = 12.0 - tip.z + off;
                let is = tip.truncate().length();
                let slack = if tip.z == 0.0 { 2.0 } else { 0.01 };
                assert!((is - should).abs() < slack, "{tip}: {is} from the axis, not {should}");
            }
        }
    }
}

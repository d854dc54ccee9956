//! Roughing in levels.
//!
//! The stock is taken away level by level, each cleared wherever the cutter can be without coming
//! closer to the surface than the allowance. The drop cutter tells where that is, for any cutter and
//! any surface. What is left are steps of at most the depth of a pass on slopes, the allowance on
//! level ground, and what the cutter is too wide for.
//!
//! The cutter comes down around a circle or along its pass, so that it need not cut at its centre, and
//! only to the level above is it lowered straight, through what is cut already.

use super::level::{Side, WayDown, made, only, pitch, widened};
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{
    Bounds, Cutter, HeightField, Levels, Mesh, PointCloud, Polygon, Rough, RoughStyle, Toolpath,
};

/// Takes the stock away down to an allowance, level by level.
#[derive(Clone, Debug, Params)]
pub(crate) struct Roughing {
    /// Greatest depth of a level.
    #[param(unit = "mm", default = 2.0, range = 0.01..=200.0)]
    pub(crate) depth_per_pass: f64,
    /// What is left on the surface for finishing.
    #[param(unit = "mm", default = 0.3, range = 0.0..=50.0)]
    pub(crate) allowance: f64,
    /// Distance between neighbouring passes; some 40 % of the cutter's diameter is usual.
    #[param(unit = "mm", default = 2.4, range = 0.001..=500.0)]
    pub(crate) stepover: f64,
    /// How a level is cleared.
    #[param(default = Style::Offset)]
    pub(crate) style: Style,
    /// Which side of the cutter the material is on, in passes along outlines.
    #[param(default = Side::Climb)]
    pub(crate) milling: Side,
    /// How the cutter gets down to a level.
    #[param(default = WayDown::Helix)]
    pub(crate) entry: WayDown,
    /// How steep the way down is, at the most.
    #[param(unit = "deg", default = 3.0, range = 0.1..=45.0)]
    pub(crate) angle: f64,
    /// How far beyond the part's box the cutter's axis may go.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1000.0)]
    pub(crate) around: f64,
    /// Height of the stock above the part's top.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1000.0)]
    pub(crate) stock_above: f64,
    /// Distance between the places where outlines are looked for; 0 takes an eighth of the cutter's
    /// radius.
    #[param(unit = "mm", default = 0.0, range = 0.0..=100.0)]
    pub(crate) grid: f64,
    /// How far outlines may lie off; as much more may be left.
    #[param(unit = "mm", default = 0.02, range = 0.0001..=10.0)]
    pub(crate) tolerance: f64,
}

/// How a level is cleared.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Style {
    /// Along its outlines, from within.
    Offset,
    /// In parallel passes along x, and then around its outlines.
    Zigzag,
}

#[derive(Inputs)]
pub(crate) struct Stock<'a> {
    /// The surface under the stock, if it is a height field.
    field: Option<&'a HeightField>,
    /// The surface under the stock, if it is a mesh.
    mesh: Option<&'a Mesh>,
    /// The surface under the stock, if it is points.
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
pub(crate) struct Roughed {
    /// The path of the tip, without the travel between passes.
    toolpath: Toolpath,
}

impl Node for Roughing {
    const KIND: &'static str = "roughing";
    type Inputs<'a> = Stock<'a>;
    type Outputs = Roughed;

    fn run(&self, inputs: Stock<'_>, cx: &Context<'_>) -> Result<Roughed, NodeError> {
        let Stock { field, mesh, points, cutter, part, boundary } = inputs;
        let (surface, bounds) = only(field, mesh, points)?;
        let part = part.unwrap_or(&bounds);
        let radius = cutter.profile.radius_mm();
        if self.stepover > 2.0 * radius {
            let message = format!(
                "stepover {} mm is more than the cutter's diameter, {} mm: material would be left standing",
                self.stepover,
                2.0 * radius
            );
            return Err(NodeError::refused("stepover", message));
        }
        let levels = Levels {
            area: widened(part, self.around),
            boundary,
            top_mm: part.max.z + self.stock_above,
            floor_mm: part.min.z,
            step_mm: self.depth_per_pass,
            allowance_mm: self.allowance,
            pitch_mm: pitch(self.grid, radius),
            tolerance_mm: self.tolerance,
            entry: self.entry.entry(self.angle),
        };
        let style = match self.style {
            Style::Offset => RoughStyle::Offset,
            Style::Zigzag => RoughStyle::Zigzag,
        };
        let rough =
            Rough { levels, stepover_mm: self.stepover, style, milling: self.milling.milling() };
        let toolpath = made(&levels, cx, |tick| rough.path(surface, &cutter.profile, tick))?;
        Ok(Roughed { toolpath })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::{Profile, SpanKind};

    const NODE: Roughing = Roughing {
        depth_per_pass: 2.0,
        allowance: 0.5,
        stepover: 1.5,
        style: Style::Zigzag,
        milling: Side::Climb,
        entry: WayDown::Ramp,
        angle: 3.0,
        around: 0.0,
        stock_above: 0.0,
        grid: 0.0,
        tolerance: 0.01,
    };

    /// A pocket of 20 mm and 6 mm depth in a block of 40 mm.
    fn pocket() -> HeightField {
        let inside = |k: usize| (20..=60).contains(&k);
        let height = |k: usize| if inside(k % 81) && inside(k / 81) { 4.0 } else { 10.0 };
        HeightField::new(81, 81, 0.5, (0..81 * 81).map(height).collect()).unwrap()
    }

    fn roughed(node: &Roughing, field: &HeightField) -> Result<Toolpath, NodeError> {
        let cutter = Cutter { name: "flat".into(), profile: Profile::flat(1.5).unwrap() };
        let (field, cutter) = (Some(field), &cutter);
        let stock = Stock { field, mesh: None, points: None, cutter, part: None, boundary: None };
        run(|cx| node.run(stock, cx)).map(|roughed| roughed.toolpath)
    }

    #[test]
    fn a_pocket_is_cleared_down_to_the_allowance() {
        let path = roughed(&NODE, &pocket()).unwrap();
        let passes = path.spans.iter().filter(|span| span.kind == SpanKind::Pass);
        let mut levels: Vec<f64> =
            passes.clone().map(|span| path.tips[span.points.start].z).collect();
        levels.dedup();
        // 5.5 mm in steps of 2 at most, and the tolerance with the allowance.
        assert_eq!(levels.len(), 3);
        assert!((levels[2] - 4.51).abs() < 1e-9, "{levels:?}");
        for tip in passes.flat_map(|span| &path.tips[span.points.clone()]) {
            // Walls lean from 10 mm off the middle to 10.5 mm; the cutter's radius; the allowance.
            let wall = 10.0 + 0.5 * (tip.z - 4.0) / 6.0;
            let out = (tip.truncate() - 20.0).abs().max_element();
            assert!(out < wall - 1.5 - 0.5 + 0.01, "{tip}");
        }
    }

    #[test]
    fn what_cannot_be_roughed_is_told() {
        let flat = HeightField::new(9, 9, 1.0, vec![3.0; 81]).unwrap();
        let fault = roughed(&NODE, &flat).unwrap_err().to_string();
        assert!(fault.contains("no level at which the cutter has room"), "{fault}");
        let wide = Roughing { stepover: 4.0, ..NODE };
        let fault = roughed(&wide, &flat).unwrap_err().to_string();
        assert!(fault.contains("more than the cutter's diameter, 3 mm"), "{fault}");
        let cutter = Cutter { name: "flat".into(), profile: Profile::flat(1.5).unwrap() };
        let nothing = Stock {
            field: None,
            mesh: None,
            points: None,
            cutter: &cutter,
            part: None,
            boundary: None,
        };
        let fault = run(|cx| NODE.run(nothing, cx).map(|_| ())).unwrap_err().to_string();
        assert!(fault.contains("connect one of field, mesh and points"), "{fault}");
    }
}

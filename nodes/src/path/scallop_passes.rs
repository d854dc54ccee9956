//! Passes by the scallop that they leave.
//!
//! Two planners, see [`carvegraph_geometry::ScallopRaster`] and [`carvegraph_geometry::ConstantScallop`]. The
//! first is the bidirectional scallop control of Sood, *Novel algorithms for CAD-free machining* (thesis,
//! 2015), chapter 5: lines across at the largest steps that hold the scallop say where the cutter is located
//! along the passes, then the passes themselves lie as far apart as the scallop allows. The second lets each
//! pass advance place by place.

use super::dropping::{Tip, fault};
use super::level::only;
use super::pattern::MAX_POINTS;
use super::raster::{Along, Style};
use crate::values::Remark;
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{
    Borders, Bounds, ConstantScallop, Cutter, Finish, Finished, HeightField, Mesh, PointCloud,
    ScallopError, ScallopRaster, Toolpath,
};

/// What the last decimal of a program may add to a scallop, in mm.
const ROUNDING_MM: f64 = 0.0005;

/// Lays passes as far apart as a scallop allows, and lowers the cutter along them. The path is that of the
/// tip. The cutter's tip must be round: a ball, a bull nose, a tapered ball.
#[derive(Clone, Debug, Params)]
pub(crate) struct ScallopPasses {
    /// Whether passes bend.
    #[param(default = Planner::Raster)]
    pub(crate) planner: Planner,
    /// The highest that material may stand between two passes, along the surface's normal.
    #[param(unit = "mm", default = 0.08, range = 0.001..=10.0)]
    pub(crate) scallop: f64,
    /// No step from pass to pass is less, whatever is left; what was not held is told.
    #[param(unit = "mm", default = 0.05, range = 0.001..=100.0)]
    pub(crate) least_stepover: f64,
    /// Steeper surface does not count: between passes along a wall no step is small enough. It is cut, but
    /// what is left on it is another finish's business, such as waterline's.
    #[param(unit = "deg", default = 75.0, range = 1.0..=89.0)]
    pub(crate) steepest: f64,
    /// Which way the passes follow each other.
    #[param(default = Style::Zigzag)]
    pub(crate) style: Style,
    /// The side that passes run along.
    #[param(default = Along::Longer)]
    pub(crate) along: Along,
    /// Where the first and the last straight pass lie.
    #[param(default = Border::Inset)]
    pub(crate) border: Border,
    #[param(shared)]
    pub(crate) tip: Tip,
}

/// How passes are planned.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Planner {
    /// Straight: each as far from the one before as the scallop allows everywhere along it.
    Raster,
    /// Bent: each place by place as far from the one before as the scallop allows there.
    Constant,
}

/// Where the outermost passes lie.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Border {
    /// In from the border, by what leaves no more than the scallop on it: a pass less. Passes that bend do
    /// so always.
    Inset,
    /// On the border.
    On,
}

#[derive(Inputs)]
pub(crate) struct Part<'a> {
    /// The surface, if it is a height field.
    field: Option<&'a HeightField>,
    /// The surface, if it is a mesh.
    mesh: Option<&'a Mesh>,
    /// The surface, if it is points.
    points: Option<&'a PointCloud>,
    /// The cutter; its tip must be round.
    cutter: &'a Cutter,
    /// The box over which the tip stays; that of the surface if nothing is connected.
    area: Option<&'a Bounds>,
}

#[derive(Outputs)]
pub(crate) struct Planned {
    /// The path of the tip, without the travel between passes.
    toolpath: Toolpath,
    /// How many passes there are, and what they leave.
    outcome: Remark,
}

impl Node for ScallopPasses {
    const KIND: &'static str = "scallop_passes";
    type Inputs<'a> = Part<'a>;
    type Outputs = Planned;

    fn run(&self, part: Part<'_>, cx: &Context<'_>) -> Result<Planned, NodeError> {
        let found = self.planned(&part, cx).map_err(|error| match error {
            Fault::Node(error) => error,
            Fault::Plan(ScallopError::Drop(error)) => fault(error),
            Fault::Plan(
                error @ (ScallopError::TooManyPoints(_) | ScallopError::BadScallop { .. }),
            ) => NodeError::refused("scallop", error.to_string()),
            Fault::Plan(error) => NodeError::failed(error),
        })?;
        let text = outcome(&found);
        cx.note(&text);
        if found.held.above > 0 {
            cx.warn(self.unheld(&found));
        }
        Ok(Planned { toolpath: found.path, outcome: Remark { text } })
    }
}

/// Why nothing was planned.
enum Fault {
    Node(NodeError),
    Plan(ScallopError),
}

impl ScallopPasses {
    fn planned(&self, part: &Part<'_>, cx: &Context<'_>) -> Result<Finished, Fault> {
        let (surface, bounds) = only(part.field, part.mesh, part.points).map_err(Fault::Node)?;
        let area = *part.area.unwrap_or(&bounds);
        let size = area.size();
        let finish = Finish {
            surface,
            profile: &part.cutter.profile,
            area,
            along_y: match self.along {
                Along::Longer => size.y > size.x,
                Along::X => false,
                Along::Y => true,
            },
            style: self.style.into(),
            scallop_mm: (self.scallop - ROUNDING_MM).max(self.scallop / 2.0),
            least_step_mm: self.least_stepover,
            steepest_rad: self.steepest.to_radians(),
            floor_mm: self.tip.floor.or(Some(bounds.min.z)),
            allowance_mm: self.tip.allowance,
            chord_tolerance_mm: self.tip.chord_tolerance,
            most_points: MAX_POINTS as usize,
        };
        let borders = match self.border {
            Border::Inset => Borders::Inset,
            Border::On => Borders::On,
        };
        let units = match self.planner {
            Planner::Raster => ScallopRaster::UNITS,
            Planner::Constant => ConstantScallop::UNITS,
        };
        let ticker = cx.ticker(units);
        let tick = |count| ticker.tick(count);
        match self.planner {
            Planner::Raster => ScallopRaster { finish, borders }.plan(&tick),
            Planner::Constant => ConstantScallop { finish }.plan(&tick),
        }
        .map_err(Fault::Plan)
    }

    fn unheld(&self, found: &Finished) -> String {
        let held = &found.held;
        format!(
            "{} of {} probes have more than {} mm left, up to {:.4} mm at {:.2}, {:.2}, where steps would \
             have to be less than {} mm: a smaller cutter or least_stepover leaves less",
            held.above,
            held.probes,
            self.scallop,
            held.worst_mm,
            held.at.x,
            held.at.y,
            self.least_stepover
        )
    }
}

fn outcome(found: &Finished) -> String {
    let (passes, points, held) = (found.path.passes(), found.path.cl_points(), &found.held);
    format!(
        "{passes} passes, {points} points; the highest scallop expected is {:.4} mm, at {:.2}, {:.2}",
        held.worst_mm, held.at.x, held.at.y
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_core::Yielding;
    use carvegraph_geometry::{BezierPatch, Profile, Span};

    fn node(planner: Planner, border: Border) -> ScallopPasses {
        ScallopPasses {
            planner,
            scallop: 0.1,
            least_stepover: 0.05,
            steepest: 75.0,
            style: Style::Zigzag,
            along: Along::Longer,
            border,
            tip: Tip { floor: Yielding::left(0.0), allowance: 0.0, chord_tolerance: 0.01 },
        }
    }

    /// Plans over the source's rising part.
    fn planned(node: &ScallopPasses, profile: Profile) -> Result<(Toolpath, String), String> {
        let mesh = BezierPatch::rising().part(20, 0.0, &|_| true).unwrap();
        let cutter = &Cutter { name: "cutter".into(), profile };
        let part = Part { field: None, mesh: Some(&mesh), points: None, cutter, area: None };
        let planned = run(|cx| node.run(part, cx)).map_err(|fault| fault.to_string())?;
        Ok((planned.toolpath, planned.outcome.text))
    }

    fn ball() -> Profile {
        Profile::ball(3.0).unwrap()
    }

    #[test]
    fn straight_passes_are_no_more_than_in_the_source() {
        let (path, text) = planned(&node(Planner::Raster, Border::Inset), ball()).unwrap();
        assert!(path.passes() <= 35 && path.cl_points() <= 2485, "{text}");
        assert!(text.starts_with(&format!("{} passes, {}", path.passes(), path.cl_points())));
        // Along the longer side, the first half a step in.
        assert!(path.tips[0].x > 0.5 && path.tips[1].x == path.tips[0].x);
        let (on, _) = planned(&node(Planner::Raster, Border::On), ball()).unwrap();
        assert_eq!((on.tips[0].x, on.passes()), (0.0, path.passes() + 1));
    }

    #[test]
    fn constant_passes_bend_and_stay_over_the_part() {
        let (path, text) = planned(&node(Planner::Constant, Border::Inset), ball()).unwrap();
        let bend = |span: &Span| {
            let x = path.tips[span.points.clone()].iter().map(|tip| tip.x);
            let (low, high) = x.fold((99.0_f64, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
            high - low
        };
        let most = path.spans.iter().map(bend).fold(0.0, f64::max);
        assert!(most > 0.02, "{most}: {text}");
        assert!(path.tips.iter().all(|tip| (0.0..=50.0).contains(&tip.x)));
    }

    #[test]
    fn a_flat_cutter_and_a_scallop_as_high_as_the_ball_are_refused() {
        let straight = node(Planner::Raster, Border::On);
        let fault = planned(&straight, Profile::flat(3.0).unwrap()).unwrap_err();
        assert!(fault.contains("a cutter without a round tip"), "{fault}");
        let fault = planned(&ScallopPasses { scallop: 3.5, ..straight }, ball()).unwrap_err();
        assert!(fault.contains("less than the radius of the tip, 3 mm"), "{fault}");
    }
}

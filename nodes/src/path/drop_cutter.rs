//! Cutter location on a surface: the drop cutter.
//!
//! The cutter is lowered at each point of a pattern until it first touches the surface (ball drop:
//! Sood 2015, section 4.1, after Manos et al.). Against the *mesh* it may touch facets, edges and
//! vertices; against the *points* only vertices, which is faster and as good where the points are
//! dense: the source takes them when their distance is at most a fifth of the cutter's radius
//! (section 4.2). The heights are exact for every cutter, see
//! [`geometry::DropCutter`].

use super::dropping::{Tip, dropped};
use crate::values::Remark;
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{self as geometry, Against, Cutter, HeightField, Pattern, Toolpath};

/// The largest pitch at which points are dense, as a share of the cutter's radius.
const DENSE: f64 = 0.2;

/// Lowers the cutter onto the surface at every point of a pattern. The path is that of the tip.
#[derive(Clone, Debug, Params)]
pub(crate) struct DropCutter {
    /// What the cutter is dropped on.
    #[param(default = Surface::Auto)]
    pub(crate) against: Surface,
    #[param(shared)]
    pub(crate) tip: Tip,
}

/// What a cutter is dropped on.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Surface {
    /// Points where they are dense (a fifth of the cutter's radius or less apart), else the mesh.
    Auto,
    /// The points alone: fast, but a cutter sinks between points that lie wide apart.
    Points,
    /// The triangles between the points.
    Mesh,
}

#[derive(Inputs)]
pub(crate) struct Dropping<'a> {
    /// The surface to be cut.
    surface: &'a HeightField,
    /// The cutter.
    cutter: &'a Cutter,
    /// Where to drop it.
    pattern: &'a Pattern,
}

#[derive(Outputs)]
pub(crate) struct Dropped {
    /// The path of the tip, without the moves from one pass to the next.
    toolpath: Toolpath,
    /// What it was dropped on, and why.
    choice: Remark,
}

impl Node for DropCutter {
    const KIND: &'static str = "drop_cutter";
    type Inputs<'a> = Dropping<'a>;
    type Outputs = Dropped;

    fn run(&self, inputs: Dropping<'_>, cx: &Context<'_>) -> Result<Dropped, NodeError> {
        let Dropping { surface, cutter, pattern } = inputs;
        let (against, text) = self.choose(surface.pitch_mm(), cutter.profile.tip_radius_mm());
        cx.note(&text);
        let surface = geometry::Surface::Field(surface, against);
        let toolpath = dropped(surface, cutter, pattern, &self.tip, cx)?;
        Ok(Dropped { toolpath, choice: Remark { text } })
    }
}

impl DropCutter {
    fn choose(&self, pitch_mm: f64, tip_radius_mm: f64) -> (Against, String) {
        let against = match self.against {
            Surface::Points => Against::Points,
            Surface::Mesh => Against::Mesh,
            Surface::Auto if pitch_mm <= DENSE * tip_radius_mm => Against::Points,
            Surface::Auto => Against::Mesh,
        };
        let on = match against {
            Against::Points => "points",
            Against::Mesh => "mesh",
        };
        let share = 100.0 * pitch_mm / tip_radius_mm;
        let why = match self.against {
            _ if tip_radius_mm == 0.0 && against == Against::Mesh => {
                "a pointed cutter would sink between points".to_owned()
            }
            Surface::Auto => format!(
                "their distance, {pitch_mm:.3} mm, is {share:.1} % of the cutter's radius, {} {:.0} %",
                if against == Against::Points { "at most" } else { "more than" },
                100.0 * DENSE
            ),
            _ => {
                format!("as set; the points lie {pitch_mm:.3} mm apart, {share:.1} % of the radius")
            }
        };
        (against, format!("dropped on the {on}: {why}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_core::Yielding;

    fn against(against: Surface) -> DropCutter {
        let tip = Tip { floor: Yielding::left(0.0), allowance: 0.0, chord_tolerance: 0.0 };
        DropCutter { against, tip }
    }

    #[test]
    fn auto_follows_the_fifth_of_the_radius() {
        let auto = against(Surface::Auto);
        assert_eq!(auto.choose(0.6, 3.0).0, Against::Points);
        assert_eq!(auto.choose(0.6000001, 3.0).0, Against::Mesh);
        assert!(
            auto.choose(1.706, 3.0).1.contains("56.9 % of the cutter's radius, more than 20 %")
        );
    }

    #[test]
    fn a_set_surface_is_taken_as_it_is() {
        assert_eq!(against(Surface::Points).choose(5.0, 3.0).0, Against::Points);
        assert_eq!(against(Surface::Mesh).choose(0.01, 3.0).0, Against::Mesh);
    }
}

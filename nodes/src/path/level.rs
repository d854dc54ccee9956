//! What roughing and waterlines share: the surface that is connected, and the area they work in.

use carvegraph_core::{Choice, Context, NodeError};
use carvegraph_geometry::{
    Against, Bounds, DropError, Entry, HeightField, LevelError, Levels, Mesh, Milling, PointCloud,
    Surface, Toolpath,
};

/// The finest grid that is taken unasked, as a share of the cutter's radius.
const GRID: f64 = 0.125;

/// Which side of the cutter the material is on, the spindle turning clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Side {
    /// On the right: the tooth bites thickly first; for machines without play.
    Climb,
    /// On the left: the tooth bites thickly last; for machines with play.
    Conventional,
}

impl Side {
    pub(super) fn milling(self) -> Milling {
        match self {
            Self::Climb => Milling::Climb,
            Self::Conventional => Milling::Conventional,
        }
    }
}

/// How the cutter gets down to a level.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum WayDown {
    /// Around a circle where there is room for one, else back and forth along the pass.
    Helix,
    /// Back and forth along the pass.
    Ramp,
    /// Straight down: only for cutters that cut at their centre.
    Plunge,
}

impl WayDown {
    pub(super) fn entry(self, angle_deg: f64) -> Entry {
        match self {
            Self::Helix => Entry::Helix(angle_deg.to_radians()),
            Self::Ramp => Entry::Ramp(angle_deg.to_radians()),
            Self::Plunge => Entry::Plunge,
        }
    }
}

/// The one surface that is connected, and the box that holds it.
pub(super) fn only<'a>(
    field: Option<&'a HeightField>,
    mesh: Option<&'a Mesh>,
    points: Option<&'a PointCloud>,
) -> Result<(Surface<'a>, Bounds), NodeError> {
    let field = field.map(|field| Surface::Field(field, Against::Mesh));
    let given = [field, mesh.map(Surface::Mesh), points.map(Surface::Points)];
    let mut given = given.into_iter().flatten();
    let (Some(surface), None) = (given.next(), given.next()) else {
        return Err(NodeError::failed("connect one of field, mesh and points: what is to be cut"));
    };
    let bounds = surface.bounds();
    Ok((surface, bounds.ok_or_else(|| NodeError::failed("there is nothing in the surface"))?))
}

/// The box in plan, wider by `around` on every side.
pub(super) fn widened(bounds: &Bounds, around: f64) -> Bounds {
    Bounds { min: bounds.min - around, max: bounds.max + around }
}

/// The distance between nodes: what is set, or what suits the cutter.
pub(super) fn pitch(grid: f64, radius_mm: f64) -> f64 {
    if grid > 0.0 { grid } else { radius_mm * GRID }
}

/// Runs the work of a node with levels.
pub(super) fn made(
    levels: &Levels<'_>,
    cx: &Context<'_>,
    work: impl FnOnce(&(dyn Fn(usize) -> bool + Sync)) -> Result<Toolpath, LevelError>,
) -> Result<Toolpath, NodeError> {
    let ticker = cx.ticker(2 * levels.count());
    let path = work(&|count| ticker.tick(count)).map_err(|fault| match fault {
        LevelError::Drop(DropError::Stopped) => NodeError::Cancelled,
        fault => NodeError::failed(fault),
    })?;
    if path.tips.is_empty() {
        return Err(NodeError::failed(
            "there is no level at which the cutter has room: the surface may be flat, or the cutter too \
             large for it",
        ));
    }
    Ok(path)
}

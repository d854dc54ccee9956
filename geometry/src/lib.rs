//! The trade's types and kernels: height fields, point clouds, meshes, cutters, tool paths, and the
//! drop cutter. Nothing here knows of nodes, recipes or files.
//!
//! Frame: right-handed, millimetres, Z up. The controlled point of a cutter is its **tip**.
//!
//! Long kernels take a [`Tick`]: they call it with the share of work done since the last call and
//! stop, returning `None`, as soon as it answers `false`.

mod bezier;
mod bounds;
mod crop;
mod defects;
mod deviation;
mod distance;
mod drop_cutter;
mod grown;
mod height_field;
mod leftover;
mod level;
mod link;
mod mesh;
mod mesh_to_field;
mod motion;
#[cfg(any(feature = "oracle", test))]
pub mod oracle;
mod pattern;
mod placing;
mod point_cloud;
mod polygon;
mod profile;
mod raster;
mod reduce;
mod relief;
mod scallop;
mod simulate;
mod stitch;
mod time;
mod toolpath;
mod trace;

pub use bezier::{BezierError, BezierPatch};
pub use bounds::Bounds;
pub use crop::Crop;
pub use defects::{Defects, find_defects};
pub use deviation::{Deviation, DeviationError, Extent, FIRST_ORDER_MM, Target, deviation};
pub use distance::distances;
pub use drop_cutter::{
    Against, DropCutter, DropError, Surface, drop_on_height_field, drop_on_mesh, drop_on_points,
};
pub use glam::{DAffine3, DVec2, DVec3};
pub use height_field::{HeightField, HeightFieldError};
pub use leftover::{RestArea, RestError, leftover, rest_area};
pub use level::{Entry, LevelError, Levels, Milling, Rough, RoughStyle, Waterline};
pub use link::{LinkError, link_passes};
pub use mesh::Mesh;
pub use mesh_to_field::{FieldGrid, mesh_to_field};
pub use motion::{Direction, Motion, Move, MoveKind, PathArc, Plane};
pub use pattern::{
    Circles, ContourParallel, CrossRaster, Hilbert, Layout, Pace, Pattern, PatternSpan, Radial,
    Region, Spiral, Start, Turn,
};
pub use placing::{Axis, Datum, Fit, HeightDatum, Placing, PlacingError};
pub use point_cloud::PointCloud;
pub use polygon::{Filling, Polygon, PolygonError, offset, simplify_loop};
pub use profile::{Cutter, Profile, ProfileError, Segment};
pub use raster::{Raster, RasterStyle};
pub use reduce::{CHORD_ALLOWANCE_MM, Reduction, fit_arcs, reduce_chord, reduce_z_band};
pub use relief::{BasRelief, SlopeLimit, bas_relief, limit_slope};
pub use scallop::{Borders, ConstantScallop, Finish, Finished, Held, ScallopError, ScallopRaster};
pub use simulate::{
    ARC_TOLERANCE_MM, Cut, Load, RAPID_TOLERANCE_MM, RapidCut, Removal, SimulateError, Simulation,
    StepDown, Stock, simulate,
};
pub use stitch::{StitchError, close_solid, point_cloud, stitch};
pub use time::{Kinematics, TimeError, Times, machining_time};
pub use toolpath::{Contact, ContactKind, Feeds, Span, SpanKind, Toolpath};
pub use trace::{TraceError, trace_level};

/// Told how many units of work were done since the last call; answers whether to go on.
pub type Tick<'a> = &'a (dyn Fn(usize) -> bool + Sync);

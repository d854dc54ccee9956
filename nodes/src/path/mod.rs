//! Paths: where a cutter goes.

mod cutter;
mod drop_cutter;
mod drop_on_mesh;
mod drop_on_points;
mod dropping;
mod level;
mod link;
mod pattern;
mod raster;
mod reduce_cl;
mod rest_area;
mod roughing;
mod scallop_passes;
mod setup;
mod waterline;

pub(crate) use cutter::{CutterNode, DRAWING};
pub(crate) use drop_cutter::DropCutter;
pub(crate) use drop_on_mesh::DropOnMesh;
pub(crate) use drop_on_points::DropOnPoints;
pub(crate) use link::Link;
pub(crate) use pattern::{
    CirclesNode, ContourParallelNode, CrossRasterNode, HilbertNode, MAX_POINTS, OffsetPolygon,
    PolygonNode, RadialNode, SpiralNode, read_corner, read_corners,
};
pub(crate) use raster::RasterNode;
pub(crate) use reduce_cl::ReduceCl;
pub(crate) use rest_area::RestAreaNode;
pub(crate) use roughing::Roughing;
pub(crate) use scallop_passes::ScallopPasses;
pub(crate) use setup::SetupNode;
pub(crate) use waterline::WaterlineNode;

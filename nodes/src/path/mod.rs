//! Paths: where a cutter goes.

mod cutter;
mod drop_cutter;
mod link;
mod raster;
mod reduce_cl;
mod setup;

pub(crate) use cutter::{CutterNode, DRAWING};
pub(crate) use drop_cutter::DropCutter;
pub(crate) use link::Link;
pub(crate) use raster::{MAX_POINTS, RasterNode};
pub(crate) use reduce_cl::ReduceCl;
pub(crate) use setup::SetupNode;

//! Surfaces: made of pictures and points.

mod point_cloud;
mod stitch;
mod z_map;

pub(crate) use point_cloud::PointCloudNode;
pub(crate) use stitch::Stitch;
pub(crate) use z_map::ZMap;

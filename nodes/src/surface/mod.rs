//! Surfaces: made of pictures and points, read from files, turned, cropped and looked at.

mod bezier_surface;
mod canvas;
mod crop_field;
mod crop_mesh;
mod crop_points;
mod cropping;
mod inspect_mesh;
mod load_mesh;
mod load_points;
mod mesh_to_field;
mod placing;
mod point_cloud;
mod portrait_map;
mod read;
mod stitch;
mod transform_mesh;
mod transform_points;
mod unit;
mod z_map;

pub(crate) use bezier_surface::BezierSurface;
pub(crate) use crop_field::CropField;
pub(crate) use crop_mesh::CropMesh;
pub(crate) use crop_points::CropPoints;
pub(crate) use inspect_mesh::InspectMesh;
pub(crate) use load_mesh::LoadMesh;
pub(crate) use load_points::LoadPoints;
pub(crate) use mesh_to_field::MeshToField;
pub(crate) use point_cloud::PointCloudNode;
pub(crate) use portrait_map::PortraitMap;
#[cfg(test)]
pub(crate) use read::read_mesh;
pub(crate) use stitch::Stitch;
pub(crate) use transform_mesh::TransformMesh;
pub(crate) use transform_points::TransformPoints;
pub(crate) use z_map::ZMap;

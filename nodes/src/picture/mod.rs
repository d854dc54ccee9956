//! Pictures: loading and preparing them.

mod bilateral_filter;
mod clahe;
mod crop_image;
mod curves;
mod depth_smooth;
mod edge_emphasis;
mod flip_image;
mod gaussian_blur;
mod grayscale;
mod invert;
mod levels;
mod load_image;
mod median_blur;
mod resize_image;
mod rotate_image;
mod rows;
mod vignette;

pub(crate) use bilateral_filter::BilateralFilter;
pub(crate) use clahe::Clahe;
pub(crate) use crop_image::CropImage;
pub(crate) use curves::Curves;
pub(crate) use depth_smooth::DepthSmooth;
pub(crate) use edge_emphasis::EdgeEmphasis;
pub(crate) use flip_image::FlipImage;
pub(crate) use gaussian_blur::GaussianBlur;
pub(crate) use grayscale::Grayscale;
pub(crate) use invert::Invert;
pub(crate) use levels::Levels;
pub(crate) use load_image::{LoadImage, MAX_PIXELS};
pub(crate) use median_blur::MedianBlur;
pub(crate) use resize_image::ResizeImage;
pub(crate) use rotate_image::RotateImage;
pub(crate) use vignette::Vignette;

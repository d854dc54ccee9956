//! Pictures: loading and preparing them.

mod gaussian_blur;
mod grayscale;
mod load_image;

pub(crate) use gaussian_blur::GaussianBlur;
pub(crate) use grayscale::Grayscale;
pub(crate) use load_image::{LoadImage, MAX_PIXELS};

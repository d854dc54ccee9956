//! Pictures: loading and preparing them.

mod gaussian_blur;
mod grayscale;
mod load_image;
mod trace_mask;

pub(crate) use gaussian_blur::GaussianBlur;
pub(crate) use grayscale::Grayscale;
pub(crate) use load_image::{LoadImage, MAX_PIXELS};
pub(crate) use trace_mask::TraceMask;

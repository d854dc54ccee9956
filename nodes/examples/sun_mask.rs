//! Makes the bundled sample `graphs/samples/sun_mask.png`: a mask of the sun in the middle of
//! `medallion.png`, white inside.
//!
//! Its outline over the angle φ, on a plaque of 203 mm: 37 + 17 ((1 + cos 24φ) / 2)² mm, so that there is
//! a ray for each of the sun's. Each pixel is the mean of a grid of samples: half of one that the outline
//! divides in halves.
//!
//! ```text
//! cargo run --release --example sun_mask [graphs/samples/sun_mask.png]
//! ```

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, GrayImage, ImageEncoder, ImageResult, Luma};
use std::path::{Path, PathBuf};

/// Side of the plaque, in mm.
const SIDE_MM: f64 = 203.0;
/// Side of the shipped picture: half of that of `medallion.png`.
const SIZE_PX: u32 = 320;
/// Samples a pixel along x and along y.
const SAMPLES: u32 = 8;
/// The round of the face and the length of the rays, in mm.
const FACE_MM: f64 = 37.0;
const RAY_MM: f64 = 17.0;
const RAYS: f64 = 24.0;

fn main() -> ImageResult<()> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs/samples/sun_mask.png");
    let path = std::env::args_os().nth(1).map_or(default, PathBuf::from);
    let file = std::io::BufWriter::new(std::fs::File::create(path)?);
    PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive).write_image(
        sun_mask().as_raw(),
        SIZE_PX,
        SIZE_PX,
        ExtendedColorType::L8,
    )
}

/// The mask.
#[must_use]
pub fn sun_mask() -> GrayImage {
    let step = SIDE_MM / f64::from(SIZE_PX * SAMPLES);
    let place = |pixel: u32, sample: u32| {
        (f64::from(pixel * SAMPLES + sample) + 0.5) * step - SIDE_MM / 2.0
    };
    GrayImage::from_fn(SIZE_PX, SIZE_PX, |i, j| {
        let samples =
            (0..SAMPLES * SAMPLES).map(|k| (place(i, k % SAMPLES), place(j, k / SAMPLES)));
        let inside = samples.filter(|(x, y)| x.hypot(*y) < outline_mm(y.atan2(*x))).count();
        Luma([(inside as f64 / f64::from(SAMPLES * SAMPLES) * 255.0).round() as u8])
    })
}

fn outline_mm(angle: f64) -> f64 {
    let ray = (1.0 + (RAYS * angle).cos()) / 2.0;
    FACE_MM + RAY_MM * ray * ray
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_mask_is_what_this_computes() {
        let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/../graphs/samples/sun_mask.png");
        let shipped = image::open(shipped).unwrap().into_luma8();
        let computed = sun_mask();
        assert_eq!(shipped.dimensions(), computed.dimensions());
        // A sample on the outline may fall to either side on another machine.
        let same = |(a, b): (&u8, &u8)| a.abs_diff(*b) <= 4;
        assert!(shipped.as_raw().iter().zip(computed.as_raw()).all(same));
    }
}

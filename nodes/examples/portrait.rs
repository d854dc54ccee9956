//! Makes the bundled samples `graphs/samples/portrait*.png`: a person lit from the front, and the
//! three masks that the portrait recipe wants (Sood 2015, section 3.2.7): the portrait, the head
//! hair, the facial hair, black on white.
//!
//! The picture is computed, not painted, and is nobody's: ellipses with smooth bumps on them, bright
//! where they face the viewer. Hair, brows and moustache are dark, so that without a lift they
//! would be carved as craters. Each pixel is the mean of a grid of samples, so outlines are smooth;
//! a mask's pixel is decided at its middle, by the same shapes. `sin` may differ in its last bit
//! between machines; after rounding a level may then differ by one.
//!
//! ```text
//! cargo run --release --example portrait [graphs/samples]
//! ```

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, GrayImage, ImageEncoder, ImageResult, Luma};
use std::path::{Path, PathBuf};

/// The shipped pictures.
const WIDTH_PX: u32 = 400;
const HEIGHT_PX: u32 = 500;
/// Samples a pixel along x and along y.
const SAMPLES: u32 = 3;

fn main() -> ImageResult<()> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs/samples");
    let folder = std::env::args_os().nth(1).map_or(default, PathBuf::from);
    for (name, picture) in pictures() {
        let file = std::io::BufWriter::new(std::fs::File::create(folder.join(name))?);
        PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive)
            .write_image(&picture, WIDTH_PX, HEIGHT_PX, ExtendedColorType::L8)?;
    }
    Ok(())
}

/// The picture and its masks, each with the name of its file.
#[must_use]
pub fn pictures() -> [(&'static str, GrayImage); 4] {
    let masked = |is_in: fn(P) -> bool| {
        let level = |i, j| Luma([if is_in(place(i, j, 0.5, 0.5)) { 0 } else { 255 }]);
        GrayImage::from_fn(WIDTH_PX, HEIGHT_PX, level)
    };
    [
        ("portrait.png", GrayImage::from_fn(WIDTH_PX, HEIGHT_PX, |i, j| Luma([level(i, j)]))),
        ("portrait-mask.png", masked(is_sitter)),
        ("portrait-hair.png", masked(is_hair)),
        ("portrait-facial.png", masked(is_facial_hair)),
    ]
}

fn level(i: u32, j: u32) -> u8 {
    let at = |sample: u32| (f64::from(sample) + 0.5) / f64::from(SAMPLES);
    let samples =
        (0..SAMPLES * SAMPLES).map(|s| brightness(place(i, j, at(s % SAMPLES), at(s / SAMPLES))));
    let mean = samples.sum::<f64>() / f64::from(SAMPLES * SAMPLES);
    (mean * 255.0).round().clamp(0.0, 255.0) as u8
}

/// A place in the picture: x from -0.8 to 0.8 to the right, y from -1 to 1 upwards.
#[derive(Clone, Copy)]
struct P {
    x: f64,
    y: f64,
}

fn place(i: u32, j: u32, dx: f64, dy: f64) -> P {
    let half = f64::from(HEIGHT_PX) / 2.0;
    P {
        x: (f64::from(i) + dx - f64::from(WIDTH_PX) / 2.0) / half,
        y: (half - f64::from(j) - dy) / half,
    }
}

impl P {
    /// 1 in the middle of an ellipse, 0 on its outline, negative outside.
    fn dome(self, x: f64, y: f64, half_x: f64, half_y: f64) -> f64 {
        let (dx, dy) = ((self.x - x) / half_x, (self.y - y) / half_y);
        1.0 - (dx * dx + dy * dy)
    }

    /// A smooth hill over an ellipse.
    fn hill(self, x: f64, y: f64, half_x: f64, half_y: f64) -> f64 {
        let u = self.dome(x, y, half_x, half_y).max(0.0);
        u * u * u
    }

    /// The same on the other side of the face, so that what comes in pairs is told once.
    fn mirrored(self) -> P {
        P { x: self.x.abs(), y: self.y }
    }
}

fn face(p: P) -> f64 {
    p.dome(0.0, 0.02, 0.36, 0.5)
}

fn is_hair(p: P) -> bool {
    let cap = p.dome(0.0, 0.2, 0.44, 0.5) > 0.0 && p.y > -0.08;
    let brow_line = p.dome(0.0, -0.1, 0.335, 0.5 + 0.03 * (9.0 * p.x).sin());
    cap && brow_line < 0.0
}

fn is_brow(p: P) -> bool {
    let p = p.mirrored();
    p.dome(0.155, 0.165 - 0.9 * (p.x - 0.15) * (p.x - 0.15), 0.105, 0.026) > 0.0
}

fn is_moustache(p: P) -> bool {
    let p = p.mirrored();
    p.dome(0.07, -0.225 - 0.5 * p.x * p.x, 0.105, 0.04) > 0.0
}

fn is_facial_hair(p: P) -> bool {
    is_brow(p) || is_moustache(p)
}

fn is_ear(p: P) -> bool {
    p.mirrored().dome(0.365, 0.02, 0.055, 0.11) > 0.0
}

fn is_neck(p: P) -> bool {
    p.x.abs() < 0.19 && (-0.8..-0.2).contains(&p.y)
}

fn shoulders(p: P) -> f64 {
    p.dome(0.0, -1.2, 0.72, 0.62)
}

fn is_sitter(p: P) -> bool {
    is_hair(p) || face(p) > 0.0 || is_ear(p) || is_neck(p) || shoulders(p) > 0.0
}

/// What reaches the camera, 0 to 1.
fn brightness(p: P) -> f64 {
    if is_hair(p) {
        let strand = (60.0 * p.x + 8.0 * (7.0 * p.y).sin()).sin();
        0.1 + 0.09 * p.dome(0.0, 0.2, 0.44, 0.5).max(0.0).sqrt() + 0.035 * strand
    } else if is_facial_hair(p) {
        0.12 + 0.03 * (150.0 * p.x + 40.0 * p.y).sin()
    } else if face(p) > 0.0 {
        skin(p)
    } else if is_ear(p) {
        0.42 + 0.2 * p.mirrored().dome(0.365, 0.02, 0.055, 0.11)
    } else if shoulders(p) > 0.0 {
        cloth(p)
    } else if is_neck(p) {
        0.38 + 0.2 * (1.0 - (p.x / 0.19) * (p.x / 0.19)).sqrt()
    } else {
        0.5 + 0.16 * p.y + 0.03 * (11.0 * p.x).sin() * (9.0 * p.y).sin()
    }
}

fn skin(p: P) -> f64 {
    let dome = 0.4 + 0.36 * face(p).sqrt();
    let side = p.mirrored();
    let nose = 0.2 * p.hill(0.0, 0.0, 0.07, 0.2) + 0.13 * p.hill(0.0, -0.11, 0.085, 0.07);
    let cheeks = 0.1 * side.hill(0.19, -0.08, 0.15, 0.15);
    let sockets = 0.17 * side.hill(0.15, 0.09, 0.12, 0.08);
    let ball = 0.24 * side.hill(0.15, 0.085, 0.075, 0.04);
    let pupil = 0.4 * side.hill(0.15, 0.085, 0.03, 0.03);
    let lips = 0.12 * p.hill(0.0, -0.335, 0.13, 0.045) - 0.16 * p.hill(0.0, -0.305, 0.13, 0.016);
    let chin = 0.1 * p.hill(0.0, -0.43, 0.12, 0.09);
    dome + nose + cheeks - sockets + ball - pupil + lips + chin
}

fn cloth(p: P) -> f64 {
    let lapel = p.x.abs() < 0.3 * (-0.56 - p.y);
    let fold = 0.03 * (30.0 * p.x.abs() + 6.0 * p.y).sin();
    let weight = if lapel { 0.62 } else { 0.3 + fold };
    weight + 0.2 * shoulders(p).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_portrait_is_what_this_computes() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs/samples");
        for (name, computed) in pictures() {
            let shipped = image::open(folder.join(name)).unwrap().into_luma8();
            assert_eq!(shipped.dimensions(), computed.dimensions());
            for (shipped, computed) in shipped.pixels().zip(computed.pixels()) {
                assert!(shipped[0].abs_diff(computed[0]) <= 1, "{name} is out of date");
            }
        }
    }

    #[test]
    fn hair_belongs_to_the_portrait_and_is_dark() {
        let [(_, picture), (_, portrait), (_, hair), (_, facial)] = pictures();
        let mean = |mask: &GrayImage| {
            let chosen = picture.pixels().zip(mask.pixels()).filter(|(_, m)| m[0] == 0);
            let levels: Vec<f64> = chosen.map(|(level, _)| f64::from(level[0])).collect();
            levels.iter().sum::<f64>() / levels.len() as f64
        };
        assert!(mean(&hair) < 60.0 && mean(&facial) < 60.0 && mean(&portrait) > 90.0);
        for part in [&hair, &facial] {
            assert!(part.pixels().zip(portrait.pixels()).all(|(a, b)| a[0] >= b[0]));
        }
    }
}

//! Loading a picture.
//!
//! The format is told from the file's first bytes, whatever its name says. Samples keep the depth
//! they were saved with: nothing is brought down to 8 bits. A picture that a camera noted as turned
//! (EXIF orientation) is turned upright.

use crate::values::{Channels, Image, Samples};
use carvegraph_core::{Context, InputFile, Node, NodeError, Outputs, Params};
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::io::{self, BufRead, Cursor, Read, Seek, SeekFrom};
use tiff::decoder::DecodingResult;

/// No picture has more pixels: 20,000 × 20,000 of them take 1.6 GB as a surface.
pub(crate) const MAX_PIXELS: u64 = 400_000_000;

/// A decoder may take this much besides: eight bytes a pixel and some.
const MAX_DECODER_BYTES: u64 = 8 * MAX_PIXELS + (1 << 30);

/// Loads a picture: png, jpeg, bmp, gif (its first frame), tiff, webp or pnm, of 8 or 16 bits or
/// floating point, gray or colour, with or without transparency.
#[derive(Clone, Debug, Params)]
pub(crate) struct LoadImage {
    /// The picture's file.
    #[param()]
    pub(crate) path: InputFile,
}

#[derive(Outputs)]
pub(crate) struct Loaded {
    /// The picture, upright, at the depth it was saved with.
    image: Image,
}

impl Node for LoadImage {
    const KIND: &'static str = "load_image";
    type Inputs<'a> = ();
    type Outputs = Loaded;

    fn run(&self, (): (), cx: &Context<'_>) -> Result<Loaded, NodeError> {
        Ok(Loaded { image: self.load(cx)? })
    }
}

impl LoadImage {
    /// The picture in the file.
    pub(crate) fn load(&self, cx: &Context<'_>) -> Result<Image, NodeError> {
        let bytes = cx.read(&self.path)?;
        decode(&bytes, cx).map_err(|fault| match fault {
            _ if cx.is_cancelled() => NodeError::Cancelled,
            fault => NodeError::Failed(format!("{} {fault}", self.path)),
        })
    }
}

/// Why a file gives no picture; the message follows the file's name.
#[derive(Debug, thiserror::Error)]
enum DecodeError {
    #[error("is no picture that can be read: png, jpeg, bmp, gif, tiff, webp and pnm can")]
    UnknownFormat,
    #[error("is damaged or cut short: {0}")]
    Broken(#[from] image::ImageError),
    #[error("has {width} × {height} = {pixels} pixels; the limit is {MAX_PIXELS}")]
    TooLarge { width: u32, height: u32, pixels: u64 },
}

fn decode(bytes: &[u8], cx: &Context<'_>) -> Result<Image, DecodeError> {
    let source = || Watched { inner: Cursor::new(bytes), cx };
    let mut reader = ImageReader::new(source());
    reader = reader.with_guessed_format().map_err(image::ImageError::IoError)?;
    let format = reader.format().ok_or(DecodeError::UnknownFormat)?;
    if format == ImageFormat::Tiff
        && let Some(image) = decode_float_tiff(source())
    {
        return image;
    }
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MAX_DECODER_BYTES);
    reader.limits(limits);
    let mut decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    check_size(width, height)?;
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let mut picture = DynamicImage::from_decoder(decoder)?;
    picture.apply_orientation(orientation);
    Ok(to_image(picture))
}

fn check_size(width: u32, height: u32) -> Result<(), DecodeError> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MAX_PIXELS {
        return Err(DecodeError::TooLarge { width, height, pixels });
    }
    Ok(())
}

/// A gray floating-point TIFF, the usual form of a depth map, which the `image` crate does not
/// read. `None` for any other TIFF.
fn decode_float_tiff(source: Watched<'_>) -> Option<Result<Image, DecodeError>> {
    let mut decoder = tiff::decoder::Decoder::new(source).ok()?;
    if !matches!(decoder.colortype(), Ok(tiff::ColorType::Gray(32 | 64))) {
        return None;
    }
    let (width, height) = decoder.dimensions().ok()?;
    if let Err(fault) = check_size(width, height) {
        return Some(Err(fault));
    }
    let mut limits = tiff::decoder::Limits::unlimited();
    limits.decoding_buffer_size = usize::try_from(MAX_DECODER_BYTES).unwrap_or(usize::MAX);
    decoder = decoder.with_limits(limits);
    let samples = match decoder.read_image() {
        Ok(DecodingResult::F32(samples)) => samples,
        Ok(DecodingResult::F64(samples)) => samples.into_iter().map(|s| s as f32).collect(),
        Ok(_) => return None,
        Err(fault) => return Some(Err(image::ImageError::IoError(io::Error::other(fault)).into())),
    };
    let (width, height) = (width as usize, height as usize);
    let samples = Samples::F32(samples);
    Some(Ok(Image { width, height, channels: Channels::Gray, samples }))
}

fn to_image(picture: DynamicImage) -> Image {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let (channels, samples) = match picture {
        DynamicImage::ImageLuma8(p) => (Channels::Gray, Samples::U8(p.into_raw())),
        DynamicImage::ImageLumaA8(p) => (Channels::GrayAlpha, Samples::U8(p.into_raw())),
        DynamicImage::ImageRgb8(p) => (Channels::Rgb, Samples::U8(p.into_raw())),
        DynamicImage::ImageRgba8(p) => (Channels::Rgba, Samples::U8(p.into_raw())),
        DynamicImage::ImageLuma16(p) => (Channels::Gray, Samples::U16(p.into_raw())),
        DynamicImage::ImageLumaA16(p) => (Channels::GrayAlpha, Samples::U16(p.into_raw())),
        DynamicImage::ImageRgb16(p) => (Channels::Rgb, Samples::U16(p.into_raw())),
        DynamicImage::ImageRgba16(p) => (Channels::Rgba, Samples::U16(p.into_raw())),
        DynamicImage::ImageRgb32F(p) => (Channels::Rgb, Samples::F32(p.into_raw())),
        // The last of the kinds there are today, and a form that any later one can be brought to.
        other => (Channels::Rgba, Samples::F32(other.into_rgba32f().into_raw())),
    };
    Image { width, height, channels, samples }
}

/// A source that ends when the run is called off, so that a decoder does too.
struct Watched<'a> {
    inner: Cursor<&'a [u8]>,
    cx: &'a Context<'a>,
}

impl Watched<'_> {
    fn check(&self) -> io::Result<()> {
        match self.cx.is_cancelled() {
            true => Err(io::Error::other("interrupted")),
            false => Ok(()),
        }
    }
}

impl Read for Watched<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.check()?;
        self.inner.read(buffer)
    }
}

impl BufRead for Watched<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.check()?;
        // Handed on in pieces, so that a decoder that takes what it gets comes back now and then.
        const PIECE_BYTES: usize = 1 << 16;
        let all = self.inner.fill_buf()?;
        Ok(&all[..all.len().min(PIECE_BYTES)])
    }

    fn consume(&mut self, count: usize) {
        self.inner.consume(count);
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use image::{ExtendedColorType, ImageEncoder};

    fn decoded(bytes: &[u8]) -> Result<Image, String> {
        run(|cx| decode(bytes, cx)).map_err(|fault| fault.to_string())
    }

    fn png(width: u32, samples: &[u8], color: ExtendedColorType) -> Vec<u8> {
        let mut bytes = Vec::new();
        let height = samples.len() as u32 * 8 / u32::from(color.bits_per_pixel()) / width;
        image::codecs::png::PngEncoder::new(&mut bytes)
            .write_image(samples, width, height, color)
            .unwrap();
        bytes
    }

    #[test]
    fn sixteen_bits_stay_sixteen() {
        let samples: Vec<u16> = vec![0, 1, 256, 65535];
        let bytes: Vec<u8> = samples.iter().flat_map(|s| s.to_ne_bytes()).collect();
        let image = decoded(&png(2, &bytes, ExtendedColorType::L16)).unwrap();
        assert_eq!((image.width, image.height, image.bits()), (2, 2, 16));
        assert_eq!(image.samples, Samples::U16(samples));
    }

    #[test]
    fn every_layout_of_channels_is_kept() {
        for (color, channels) in [
            (ExtendedColorType::L8, Channels::Gray),
            (ExtendedColorType::La8, Channels::GrayAlpha),
            (ExtendedColorType::Rgb8, Channels::Rgb),
            (ExtendedColorType::Rgba8, Channels::Rgba),
        ] {
            let samples: Vec<u8> = (0..4 * channels.count() as u8).collect();
            let image = decoded(&png(2, &samples, color)).unwrap();
            assert_eq!((image.channels, image.samples), (channels, Samples::U8(samples)));
        }
    }

    #[test]
    fn a_gray_float_tiff_keeps_its_values() {
        let samples = [0.25f32, -3.5, 1e-7, 70_000.0, 0.0, 1.0];
        let mut bytes = Cursor::new(Vec::new());
        tiff::encoder::TiffEncoder::new(&mut bytes)
            .unwrap()
            .write_image::<tiff::encoder::colortype::Gray32Float>(3, 2, &samples)
            .unwrap();
        let image = decoded(bytes.get_ref()).unwrap();
        assert_eq!((image.width, image.height, image.channels), (3, 2, Channels::Gray));
        assert_eq!(image.samples, Samples::F32(samples.to_vec()));
    }

    #[test]
    fn a_picture_cut_short_is_refused() {
        let whole = png(64, &[7; 64 * 64], ExtendedColorType::L8);
        for kept in [1, 9, 40, whole.len() / 2, whole.len() - 13] {
            assert!(decoded(&whole[..kept]).is_err(), "{kept} of {} bytes", whole.len());
        }
    }

    #[test]
    fn words_are_no_picture() {
        let message = decoded(b"The quick brown fox jumps over the lazy dog").unwrap_err();
        assert!(message.starts_with("is no picture that can be read: png, jpeg"), "{message}");
    }

    /// A JPEG of quarters of 16 × 8 px, with an EXIF orientation.
    fn quarters(orientation: u8) -> Vec<u8> {
        let mut jpeg = Vec::new();
        let gray = |k: usize| [[0, 80], [160, 240]][k / 32 / 8][k % 32 / 16];
        let samples: Vec<u8> = (0..32 * 16).map(gray).collect();
        image::codecs::jpeg::JpegEncoder::new_with_quality(&mut jpeg, 100)
            .write_image(&samples, 32, 16, ExtendedColorType::L8)
            .unwrap();
        let mut exif = *b"\xff\xe1\x00\x22Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\0\0\0\0\0\0\0";
        exif[29] = orientation;
        [&jpeg[..2], &exif, &jpeg[2..]].concat()
    }

    #[test]
    fn a_turned_picture_is_set_upright() {
        // What EXIF 2.32 calls the 0th row and column of each orientation, as upright quarters.
        let upright = [
            [0, 80, 160, 240],
            [80, 0, 240, 160],
            [240, 160, 80, 0],
            [160, 240, 0, 80],
            [0, 160, 80, 240],
            [160, 0, 240, 80],
            [240, 80, 160, 0],
            [80, 240, 0, 160],
        ];
        for (orientation, quarters_wanted) in (1..).zip(upright) {
            let image = decoded(&quarters(orientation)).unwrap();
            let (width, height) = if orientation < 5 { (32, 16) } else { (16, 32) };
            assert_eq!((image.width, image.height), (width, height), "{orientation}");
            let Samples::U8(samples) = image.samples else { panic!("8 bits expected") };
            let middle = |x: usize, y: usize| {
                i32::from(samples[(2 * y + 1) * height / 4 * width + (2 * x + 1) * width / 4])
            };
            let found = [middle(0, 0), middle(1, 0), middle(0, 1), middle(1, 1)];
            let near =
                found.iter().zip(quarters_wanted).all(|(a, b): (&i32, i32)| (a - b).abs() < 4);
            assert!(near, "{orientation}: {found:?}");
        }
    }
}

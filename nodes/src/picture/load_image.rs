//! Loading a picture.
//!
//! The format is told from the file's first bytes, whatever its name says. Samples keep the depth
//! they were saved with: nothing is brought down to 8 bits. A picture that a camera noted as turned
//! (EXIF orientation) is turned upright.

use crate::values::{Channels, Image, Samples};
use carvegraph_core::{Context, InputFile, Node, NodeError, Outputs, Params};
use image::{DynamicImage, ImageDecoder, ImageReader, Limits, metadata::Orientation};
use std::io::{self, BufRead, Cursor, Read, Seek, SeekFrom};

/// No picture has more pixels: 20,000 × 20,000 of them take 1.6 GB as a surface.
const MAX_PIXELS: u64 = 400_000_000;

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
        let bytes = cx.read(&self.path)?;
        let fail = |what: String| NodeError::Failed(format!("{} {what}", self.path));
        let source = Watched { inner: Cursor::new(&bytes[..]), cx };
        let mut reader = ImageReader::new(source).with_guessed_format().map_err(NodeError::failed)?;
        if reader.format().is_none() {
            return Err(fail(
                "is no picture that can be read: png, jpeg, bmp, gif, tiff, webp and pnm can".into(),
            ));
        }
        let mut limits = Limits::no_limits();
        limits.max_alloc = Some(MAX_DECODER_BYTES);
        reader.limits(limits);
        let broken = |fault: image::ImageError| match cx.is_cancelled() {
            true => NodeError::Cancelled,
            false => fail(format!("is damaged or cut short: {fault}")),
        };
        let mut decoder = reader.into_decoder().map_err(broken)?;
        let (width, height) = decoder.dimensions();
        let pixels = u64::from(width) * u64::from(height);
        if pixels > MAX_PIXELS {
            return Err(fail(format!(
                "has {width} × {height} = {pixels} pixels; the limit is {MAX_PIXELS}"
            )));
        }
        let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
        let mut picture = DynamicImage::from_decoder(decoder).map_err(broken)?;
        drop(bytes);
        picture.apply_orientation(orientation);
        Ok(Loaded { image: to_image(picture) })
    }
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

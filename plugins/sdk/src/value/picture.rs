//! Pictures.

use super::fields::Fields;
use super::{Elements, PortValue, Raw, ValueError};
use std::borrow::Cow;

/// A gray picture. 0 is black and 1 white; a depth map may go beyond.
#[derive(Clone, Debug, PartialEq)]
pub struct GrayImage<'a> {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Row by row from the top.
    pub values: Cow<'a, [f32]>,
}

impl GrayImage<'_> {
    /// Other values for the same pixels.
    #[must_use]
    pub fn with_values(&self, values: Vec<f32>) -> GrayImage<'static> {
        GrayImage { width: self.width, height: self.height, values: values.into() }
    }
}

impl<'a> PortValue<'a> for GrayImage<'a> {
    const TYPE: &'static str = "gray_image";

    fn into_raw(self) -> Raw<'a> {
        Raw::new(Self::TYPE)
            .with_count("width", self.width)
            .with_count("height", self.height)
            .with("values", self.values)
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let (width, height) = (fields.count("width")?, fields.count("height")?);
        let values = fields.array("values")?;
        let fits = width.checked_mul(height) == Some(values.len());
        fields.check_length("values", values.len(), fits, &format_args!("{width} × {height}"))?;
        fields.end()?;
        Ok(Self { width, height, values })
    }
}

/// What the samples of a pixel mean, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// Gray.
    Gray,
    /// Gray and opacity.
    GrayAlpha,
    /// Red, green, blue.
    Rgb,
    /// Red, green, blue, opacity.
    Rgba,
}

impl Channels {
    /// Samples a pixel.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Self::Gray => 1,
            Self::GrayAlpha => 2,
            Self::Rgb => 3,
            Self::Rgba => 4,
        }
    }

    fn of_count(count: u64) -> Result<Self, ValueError> {
        match count {
            1 => Ok(Self::Gray),
            2 => Ok(Self::GrayAlpha),
            3 => Ok(Self::Rgb),
            4 => Ok(Self::Rgba),
            given => Err(ValueError::Channels { given }),
        }
    }
}

/// What a picture's samples are.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples<'a> {
    /// 0 is black, 255 white.
    U8(Cow<'a, [u8]>),
    /// 0 is black, 65535 white.
    U16(Cow<'a, [u16]>),
    /// 0 is black, 1 white; depth maps may go beyond.
    F32(Cow<'a, [f32]>),
}

/// A picture as it was loaded, at the depth it was saved with.
#[derive(Clone, Debug, PartialEq)]
pub struct Image<'a> {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// What a pixel's samples mean.
    pub channels: Channels,
    /// Pixel by pixel, row by row from the top.
    pub samples: Samples<'a>,
}

impl<'a> PortValue<'a> for Image<'a> {
    const TYPE: &'static str = "image";

    fn into_raw(self) -> Raw<'a> {
        let samples = match self.samples {
            Samples::U8(samples) => Elements::U8(samples),
            Samples::U16(samples) => Elements::U16(samples),
            Samples::F32(samples) => Elements::F32(samples),
        };
        Raw::new(Self::TYPE)
            .with_count("width", self.width)
            .with_count("height", self.height)
            .with_count("channels", self.channels.count())
            .with("samples", samples)
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let (width, height) = (fields.count("width")?, fields.count("height")?);
        let channels = Channels::of_count(fields.one("channels")?)?;
        let samples = fields.any("samples")?;
        let (given, each) = (samples.count(), channels.count());
        let wanted = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(each));
        let words = format_args!("{width} × {height} × {each}");
        fields.check_length("samples", given, wanted == Some(given), &words)?;
        fields.end()?;
        Ok(Self { width, height, channels, samples: Samples::of_elements(samples)? })
    }
}

impl<'a> Samples<'a> {
    fn of_elements(elements: Elements<'a>) -> Result<Self, ValueError> {
        match elements {
            Elements::U8(samples) => Ok(Self::U8(samples)),
            Elements::U16(samples) => Ok(Self::U16(samples)),
            Elements::F32(samples) => Ok(Self::F32(samples)),
            other => Err(ValueError::Element {
                of: Image::TYPE,
                array: "samples",
                wanted: "u8, u16 or f32",
                given: other.element(),
            }),
        }
    }
}

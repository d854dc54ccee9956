//! How pictures, programs and remarks cross.

use super::crossing::{Crosses, MAX_CL_POINTS, MAX_NODES, OutputFault, check_count, not_finite};
use crate::values::{Channels, Gcode, GrayImage, Image, Remark, Samples};
use carvegraph_sdk::value as seen;
use std::borrow::Cow;

/// Bytes of a program: a block of a hundred characters for each cutter location.
const MAX_PROGRAM_BYTES: usize = MAX_CL_POINTS.saturating_mul(100);

/// Bytes of a text that a user is shown: a long paragraph.
const MAX_TEXT_BYTES: usize = 10_000;

/// Characters of a file name's extension: controllers want up to eight.
const MAX_EXTENSION: usize = 16;

/// Whether a text can be shown in a line.
pub(super) fn check_line(what: &'static str, text: &str) -> Result<(), OutputFault> {
    check_count("bytes of text", text.len(), MAX_TEXT_BYTES)?;
    let fits = !text.trim().is_empty() && !text.contains(char::is_control);
    check_word(what, text, fits, "a line of text")
}

fn check_word(
    what: &'static str,
    text: &str,
    fits: bool,
    wanted: &'static str,
) -> Result<(), OutputFault> {
    if fits { Ok(()) } else { Err(OutputFault::Word { what, text: text.to_owned(), wanted }) }
}

fn check_pixels(width: usize, height: usize) -> Result<(), OutputFault> {
    if width == 0 || height == 0 {
        return Err(OutputFault::NoPixels { width, height });
    }
    // What was read has as many samples, so this cannot overflow.
    check_count("pixels", width * height, MAX_NODES)
}

impl Crosses for GrayImage {
    type Seen<'a> = seen::GrayImage<'a>;

    fn seen(&self) -> seen::GrayImage<'_> {
        let (width, height) = (self.width, self.height);
        seen::GrayImage { width, height, values: self.values.as_slice().into() }
    }

    fn taken(made: seen::GrayImage<'static>) -> Result<Self, OutputFault> {
        check_pixels(made.width, made.height)?;
        if let Some(place) = made.values.iter().position(|value| !value.is_finite()) {
            return Err(not_finite("pixel", place, made.values[place]));
        }
        Ok(Self { width: made.width, height: made.height, values: made.values.into_owned() })
    }
}

/// Its samples may be infinite or NaN, as those of a file may: what reads them checks them.
impl Crosses for Image {
    type Seen<'a> = seen::Image<'a>;

    fn seen(&self) -> seen::Image<'_> {
        let samples = match &self.samples {
            Samples::U8(samples) => seen::Samples::U8(samples.into()),
            Samples::U16(samples) => seen::Samples::U16(samples.into()),
            Samples::F32(samples) => seen::Samples::F32(samples.into()),
        };
        let channels = match self.channels {
            Channels::Gray => seen::Channels::Gray,
            Channels::GrayAlpha => seen::Channels::GrayAlpha,
            Channels::Rgb => seen::Channels::Rgb,
            Channels::Rgba => seen::Channels::Rgba,
        };
        seen::Image { width: self.width, height: self.height, channels, samples }
    }

    fn taken(made: seen::Image<'static>) -> Result<Self, OutputFault> {
        check_pixels(made.width, made.height)?;
        let samples = match made.samples {
            seen::Samples::U8(samples) => Samples::U8(samples.into_owned()),
            seen::Samples::U16(samples) => Samples::U16(samples.into_owned()),
            seen::Samples::F32(samples) => Samples::F32(samples.into_owned()),
        };
        let channels = match made.channels {
            seen::Channels::Gray => Channels::Gray,
            seen::Channels::GrayAlpha => Channels::GrayAlpha,
            seen::Channels::Rgb => Channels::Rgb,
            seen::Channels::Rgba => Channels::Rgba,
        };
        Ok(Self { width: made.width, height: made.height, channels, samples })
    }
}

impl Crosses for Gcode {
    type Seen<'a> = seen::Gcode<'a>;

    fn seen(&self) -> seen::Gcode<'_> {
        let text = self.programs.first().map(|program| program.text.as_slice());
        seen::Gcode {
            text: text.unwrap_or_default().into(),
            dialect: self.dialect.as_str().into(),
            extension: self.extension.as_str().into(),
        }
    }

    fn kept_back(&self) -> Option<String> {
        let count = self.programs.len();
        let why = format!("it is {count} programs, one for each tool, and a plugin takes one");
        (count > 1).then_some(why)
    }

    fn taken(made: seen::Gcode<'static>) -> Result<Self, OutputFault> {
        check_count("bytes", made.text.len(), MAX_PROGRAM_BYTES)?;
        check_line("dialect", &made.dialect)?;
        check_extension(&made.extension)?;
        let (dialect, extension) = (made.dialect.into_owned(), made.extension.into_owned());
        Ok(Self::single(made.text.into_owned(), dialect, extension))
    }
}

fn check_extension(extension: &str) -> Result<(), OutputFault> {
    let fits = (1..=MAX_EXTENSION).contains(&extension.len())
        && extension.bytes().all(|byte| byte.is_ascii_alphanumeric());
    check_word("extension", extension, fits, "1 to 16 letters and digits")
}

impl Crosses for Remark {
    type Seen<'a> = seen::Remark<'a>;

    fn seen(&self) -> seen::Remark<'_> {
        seen::Remark { text: Cow::Borrowed(&self.text) }
    }

    fn taken(made: seen::Remark<'static>) -> Result<Self, OutputFault> {
        check_line("text", &made.text)?;
        Ok(Self { text: made.text.into_owned() })
    }
}

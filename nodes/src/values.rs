//! Values that pass between nodes and are no geometry: pictures, programs, remarks.

use carvegraph_geometry::{Cutter, DVec3};
use serde::{Deserialize, Serialize};

/// What a picture's samples are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Samples {
    /// 0 is black, 255 white.
    U8(Vec<u8>),
    /// 0 is black, 65535 white.
    U16(Vec<u16>),
    /// 0 is black, 1 white; depth maps may go beyond.
    F32(Vec<f32>),
}

/// What the samples of a pixel mean, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
}

/// A picture as it was loaded, at the depth it was saved with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Image {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// What a pixel's samples mean.
    pub channels: Channels,
    /// Pixel by pixel, row by row from the top.
    pub samples: Samples,
}

impl Image {
    /// Bits a sample.
    #[must_use]
    pub fn bits(&self) -> u32 {
        match self.samples {
            Samples::U8(_) => 8,
            Samples::U16(_) => 16,
            Samples::F32(_) => 32,
        }
    }
}

/// A gray picture. 0 is black and 1 white; a floating-point depth map may go beyond.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GrayImage {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Row by row from the top; finite.
    pub values: Vec<f32>,
}

/// Which pixels of a picture are meant: 0 is out and 1 in; between them a pixel is in by that share.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mask {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Row by row from the top; 0 to 1.
    pub values: Vec<f32>,
}

impl Mask {
    /// One that selects nothing.
    pub(crate) fn nothing(width: usize, height: usize) -> Self {
        Self { width, height, values: vec![0.0; width * height] }
    }

    /// The pixels selected, those selected in part by their share.
    #[must_use]
    pub fn selected_px(&self) -> f64 {
        self.values.iter().map(|share| f64::from(*share)).sum()
    }
}

/// A machine program, or one for each tool where the controller does not change them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gcode {
    /// The programs in the order in which they are to be run; never none.
    pub programs: Vec<ProgramText>,
    /// The dialect they are written in.
    pub dialect: String,
    /// The extension that the controller wants its files to have.
    pub extension: String,
    /// Where the zero of the programs lies in the part's frame, in mm, if it is known.
    pub zero: Option<DVec3>,
}

/// One program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProgramText {
    /// What tells it from the others of the job, such as "1-rough"; empty if it is the only one.
    pub name: String,
    /// The tools that it uses, in their order; none if nobody said.
    pub tools: Vec<ToolUse>,
    /// Its text.
    pub text: Vec<u8>,
}

/// A tool in a program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToolUse {
    /// The number that the program calls it by, if it does.
    pub number: Option<u32>,
    /// The cutter.
    pub cutter: Cutter,
    /// What it is used for.
    pub operations: String,
}

impl Gcode {
    /// A single program.
    #[must_use]
    pub fn single(text: Vec<u8>, dialect: String, extension: String) -> Self {
        let program = ProgramText { name: String::new(), tools: Vec::new(), text };
        Self { programs: vec![program], dialect, extension, zero: None }
    }

    /// Number of lines of all programs.
    #[must_use]
    pub fn lines(&self) -> usize {
        self.programs.iter().map(ProgramText::lines).sum()
    }

    /// Number of bytes of all programs.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.programs.iter().map(|program| program.text.len()).sum()
    }
}

impl ProgramText {
    /// Number of lines.
    #[must_use]
    pub fn lines(&self) -> usize {
        self.text.iter().filter(|byte| **byte == b'\n').count()
    }
}

/// A choice that a node made by itself, for the summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Remark {
    /// A sentence.
    pub text: String,
}

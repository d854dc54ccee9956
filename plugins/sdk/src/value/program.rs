//! Texts: programs and remarks.

use super::fields::Fields;
use super::{PortValue, Raw, Reduction, ValueError};
use std::borrow::Cow;

/// A machine program.
#[derive(Clone, Debug, PartialEq)]
pub struct Gcode<'a> {
    /// Its text, as the controller wants it.
    pub text: Cow<'a, [u8]>,
    /// The dialect it is written in.
    pub dialect: Cow<'a, str>,
    /// The extension that the controller wants its files to have, without the dot.
    pub extension: Cow<'a, str>,
}

impl<'a> PortValue<'a> for Gcode<'a> {
    const TYPE: &'static str = "gcode";

    fn into_raw(self) -> Raw<'a> {
        Raw::new(Self::TYPE)
            .with("text", self.text)
            .with_text("dialect", self.dialect)
            .with_text("extension", self.extension)
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let text = fields.array("text")?;
        let (dialect, extension) = (fields.text("dialect")?, fields.text("extension")?);
        fields.end()?;
        Ok(Self { text, dialect, extension })
    }
}

/// A choice that a node made by itself, for the summary.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark<'a> {
    /// A sentence.
    pub text: Cow<'a, str>,
}

impl<'a> PortValue<'a> for Remark<'a> {
    const TYPE: &'static str = "remark";

    fn into_raw(self) -> Raw<'a> {
        Raw::new(Self::TYPE).with_text("text", self.text)
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let text = fields.text("text")?;
        fields.end()?;
        Ok(Self { text })
    }
}

impl<'a> PortValue<'a> for Reduction {
    const TYPE: &'static str = "reduction";

    fn into_raw(self) -> Raw<'a> {
        Raw::new(Self::TYPE)
            .with_count("points_in", self.points_in)
            .with_count("points_out", self.points_out)
            .with("max_deviation_mm", vec![self.max_deviation_mm])
            .with("max_above_mm", vec![self.max_above_mm])
            .with("max_below_mm", vec![self.max_below_mm])
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let read = Self {
            points_in: fields.count("points_in")?,
            points_out: fields.count("points_out")?,
            max_deviation_mm: fields.one("max_deviation_mm")?,
            max_above_mm: fields.one("max_above_mm")?,
            max_below_mm: fields.one("max_below_mm")?,
        };
        fields.end()?;
        Ok(read)
    }
}

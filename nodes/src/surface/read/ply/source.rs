//! The body of a PLY file, value by value.

use super::header::{Element, Encoding, Header, Scalar};
use crate::surface::read::ReadError;
use crate::surface::read::text::{Words, number, quoted};

/// Reads values one after the other. `f64` holds every type's values exactly.
pub(super) struct Source<'a> {
    bytes: &'a [u8],
    encoding: Encoding,
    format: &'static str,
    /// Where the next binary value stands.
    at: usize,
    words: Words<'a>,
}

impl<'a> Source<'a> {
    pub(super) fn new(header: &Header, bytes: &'a [u8]) -> Self {
        let (encoding, at) = (header.encoding, header.end);
        Self { bytes, encoding, format: header.format(), at, words: Words::new(bytes, at) }
    }

    pub(super) fn at(&self) -> usize {
        if self.encoding == Encoding::Ascii { self.words.at() } else { self.at }
    }

    /// Something is wrong here.
    pub(super) fn fault(&self, what: impl Into<String>) -> ReadError {
        match self.encoding {
            Encoding::Ascii => ReadError::at_line(self.format, self.bytes, self.at(), what),
            Encoding::Little | Encoding::Big => ReadError::at_byte(self.format, self.at(), what),
        }
    }

    fn cut_short(&self) -> ReadError {
        self.fault("the file ends before all that its header promises: it was cut short")
    }

    /// Refuses an element that cannot fit into what is left of the file.
    pub(super) fn must_hold(&self, element: &Element) -> Result<(), ReadError> {
        let least = |property: &super::Property| match self.encoding {
            // A digit, and a blank or a line end.
            Encoding::Ascii => 2,
            Encoding::Little | Encoding::Big => property.counted_by.unwrap_or(property.of).bytes(),
        };
        let record: usize = element.properties.iter().map(least).sum();
        // The last line may do without its end.
        let left = self.bytes.len() - self.at() + 1;
        match element.count.checked_mul(record) {
            Some(needed) if needed <= left => Ok(()),
            _ => Err(self.fault(format!(
                "the header promises {} of element {}, for which the {} bytes that follow are too \
                 few: the file was cut short",
                element.count,
                quoted(element.name.as_bytes()),
                left - 1
            ))),
        }
    }

    /// The next value.
    pub(super) fn value(&mut self, of: Scalar) -> Result<f64, ReadError> {
        if self.encoding == Encoding::Ascii {
            let Some(word) = self.words.word() else { return Err(self.cut_short()) };
            return number(word)
                .ok_or_else(|| self.fault(format!("{} is no number", quoted(word))));
        }
        let Some(bytes) = self.bytes.get(self.at..self.at + of.bytes()) else {
            return Err(self.cut_short());
        };
        self.at += bytes.len();
        // All types, widened at their upper end.
        let mut wide = [0; 8];
        wide[..bytes.len()].copy_from_slice(bytes);
        if self.encoding == Encoding::Big {
            wide[..bytes.len()].reverse();
        }
        let [a, b, c, d, ..] = wide;
        Ok(match of {
            Scalar::I8 => f64::from(a as i8),
            Scalar::U8 => f64::from(a),
            Scalar::I16 => f64::from(i16::from_le_bytes([a, b])),
            Scalar::U16 => f64::from(u16::from_le_bytes([a, b])),
            Scalar::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Scalar::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Scalar::F64 => f64::from_le_bytes(wide),
        })
    }

    /// How many values a list has; no more than what is left of the file could hold.
    fn length(&mut self, counted_by: Scalar, of: Scalar) -> Result<usize, ReadError> {
        let count = self.value(counted_by)?;
        if count.is_nan() || count < 0.0 || count.fract() != 0.0 {
            return Err(self.fault(format!("a list cannot have {count} values")));
        }
        let least = if self.encoding == Encoding::Ascii { 2 } else { of.bytes() };
        match count * least as f64 <= (self.bytes.len() - self.at() + 1) as f64 {
            true => Ok(count as usize),
            false => Err(self.cut_short()),
        }
    }

    /// The next list.
    pub(super) fn list(
        &mut self,
        counted_by: Scalar,
        of: Scalar,
        into: &mut Vec<f64>,
    ) -> Result<(), ReadError> {
        into.clear();
        for _ in 0..self.length(counted_by, of)? {
            into.push(self.value(of)?);
        }
        Ok(())
    }

    /// Passes over a list.
    pub(super) fn pass_list(&mut self, counted_by: Scalar, of: Scalar) -> Result<(), ReadError> {
        let count = self.length(counted_by, of)?;
        (0..count).try_for_each(|_| self.value(of).map(drop))
    }
}

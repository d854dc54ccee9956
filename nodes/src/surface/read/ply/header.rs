//! The header of a PLY file: what is declared to follow, and how it is written.

use crate::surface::read::ReadError;
use crate::surface::read::text::{lines, quoted, words};

const PLY: &str = "PLY";

/// Longer headers are none: it takes some hundred bytes.
const MAX_HEADER_BYTES: usize = 1 << 20;

/// How the body is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    /// In words.
    Ascii,
    /// Binary, the low byte first.
    Little,
    /// Binary, the high byte first.
    Big,
}

/// A type of number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes that one takes in a binary file.
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// One property of a record.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of its value, or of its values.
    pub(super) of: Scalar,
    /// The type of the number of values, if it is a list.
    pub(super) counted_by: Option<Scalar>,
}

/// Records of one kind.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

/// What a header says.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the body begins.
    pub(super) end: usize,
}

/// Whether a file begins like PLY.
pub(in crate::surface::read) fn is_ply(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

/// Reads the header.
pub(super) fn read(bytes: &[u8]) -> Result<Header, ReadError> {
    let within = bytes.len().min(MAX_HEADER_BYTES);
    let (mut encoding, mut elements) = (None, Vec::new());
    for (at, line) in lines(bytes, 0..within).skip(1) {
        let words: Vec<&[u8]> = words(line).collect();
        let fault = |what: String| ReadError::at_line(PLY, bytes, at, what);
        match words[..] {
            [b"end_header"] => {
                let encoding =
                    encoding.ok_or_else(|| fault("the header names no format".to_owned()))?;
                return Ok(Header { encoding, elements, end: after(bytes, at + line.len()) });
            }
            [b"format", name, ..] => encoding = Some(named_encoding(name).map_err(fault)?),
            [b"element", ..] => elements.push(element(&words).map_err(fault)?),
            [b"property", ..] => {
                let property = property(&words).map_err(fault)?;
                let Some(element) = elements.last_mut() else {
                    return Err(fault("a property stands before any element".to_owned()));
                };
                element.properties.push(property);
            }
            [] | [b"comment" | b"obj_info", ..] => {}
            [word, ..] => return Err(fault(format!("{} is no word of a header", quoted(word)))),
        }
    }
    Err(ReadError::at_byte(PLY, within, "the header has no end (end_header): it was cut short"))
}

/// The first byte after the line end that stands at `at`: LF, CR or both.
fn after(bytes: &[u8], at: usize) -> usize {
    match bytes.get(at..) {
        Some([b'\r', b'\n', ..]) => at + 2,
        Some([_, ..]) => at + 1,
        _ => bytes.len(),
    }
}

fn named_encoding(name: &[u8]) -> Result<Encoding, String> {
    match name {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::Little),
        b"binary_big_endian" => Ok(Encoding::Big),
        _ => Err(format!(
            "{} is no format; ascii, binary_little_endian and binary_big_endian are",
            quoted(name)
        )),
    }
}

fn element(words: &[&[u8]]) -> Result<Element, String> {
    let [_, name, count] = words else {
        return Err("an element needs a name and a count".to_owned());
    };
    let parsed = std::str::from_utf8(count).ok().and_then(|text| text.parse().ok());
    let count = parsed.ok_or_else(|| format!("{} is no count", quoted(count)))?;
    let name = String::from_utf8_lossy(name).into_owned();
    Ok(Element { name, count, properties: Vec::new() })
}

fn property(words: &[&[u8]]) -> Result<Property, String> {
    let scalar = |word: &[u8]| {
        Scalar::named(word).ok_or_else(|| format!("{} is no type of a property", quoted(word)))
    };
    let (counted_by, of, name) = match words {
        [_, b"list", counted_by, of, name] => (Some(scalar(counted_by)?), scalar(of)?, name),
        [_, of, name] => (None, scalar(of)?, name),
        _ => return Err("a property needs a type and a name".to_owned()),
    };
    Ok(Property { name: String::from_utf8_lossy(name).into_owned(), of, counted_by })
}

//! PCD (Point Cloud Library, *The PCD file format*, version 0.7): ASCII, binary and
//! binary_compressed.
//!
//! Read are the fields x, y and z, of any type and in any place. A compressed body holds all of one
//! field before the next one, packed with LZF. A point with a NaN is one that the scanner missed.

use super::lzf::unpack;
use super::text::{lines, number, quoted, skip_mark, words};
use super::{BATCH, MAX_POINTS, ReadError, ReadPoints, go_on, limited};
use carvegraph_geometry::{DVec3, Tick};

const PCD: &str = "PCD";

/// A header has ten lines; one this long has lost its end.
const MAX_HEADER_BYTES: usize = 1 << 16;

/// LZF makes 264 bytes of 3 at most.
const MAX_EXPANSION: usize = 88;

/// What stands for each point, once or several times.
#[derive(Clone, Copy, Debug)]
struct Field {
    kind: u8,
    bytes: usize,
    count: usize,
}

/// What the header says.
#[derive(Debug, Default)]
struct Header {
    names: Vec<Vec<u8>>,
    sizes: Vec<usize>,
    kinds: Vec<u8>,
    counts: Vec<usize>,
    width: usize,
    height: usize,
    points: Option<usize>,
    encoding: Vec<u8>,
    end: usize,
}

/// Whether a file begins like PCD.
pub(super) fn is_pcd(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(MAX_HEADER_BYTES)];
    let first = lines(head, skip_mark(head)..head.len())
        .filter_map(|(_, line)| words(line).next())
        .find(|word| !word.starts_with(b"#") || *word == b"#.PCD");
    bytes.starts_with(b"# .PCD") || matches!(first, Some(b"VERSION" | b"FIELDS" | b"#.PCD"))
}

/// Reads the points.
pub(super) fn read_points(bytes: &[u8], tick: Tick<'_>) -> Result<ReadPoints, ReadError> {
    let header = read_header(bytes)?;
    let fault = |what: &str| ReadError::at_byte(PCD, header.end, what);
    let fields = header.fields().map_err(|what| fault(&what))?;
    let places = ["x", "y", "z"].map(|name| header.names.iter().position(|n| n == name.as_bytes()));
    let [Some(x), Some(y), Some(z)] = places else {
        return Err(fault("the points have no fields x, y and z"));
    };
    let product = header.width.checked_mul(header.height);
    let count = header.points.or(product).unwrap_or(usize::MAX);
    limited("points", count as u64, MAX_POINTS)?;
    let body = &bytes[header.end..];
    let body = Body { bytes, body, start: header.end, fields: &fields, at: [x, y, z], count };
    match &header.encoding[..] {
        b"ascii" => body.ascii(tick),
        b"binary" => body.binary(tick),
        b"binary_compressed" => body.compressed(tick),
        other => Err(fault(&format!(
            "{} is no encoding; ascii, binary and binary_compressed are",
            quoted(other)
        ))),
    }
}

fn read_header(bytes: &[u8]) -> Result<Header, ReadError> {
    let mut header = Header::default();
    let within = bytes.len().min(MAX_HEADER_BYTES);
    for (at, line) in lines(bytes, skip_mark(bytes)..within) {
        let mut words = words(line);
        let Some(word) = words.next() else { continue };
        let whole = |word: &[u8]| -> Result<usize, ReadError> {
            let parsed = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
            parsed.ok_or_else(|| {
                ReadError::at_line(PCD, bytes, at, format!("{} is no whole number", quoted(word)))
            })
        };
        match word {
            b"FIELDS" | b"COLUMNS" => header.names = words.map(<[u8]>::to_vec).collect(),
            b"SIZE" => header.sizes = words.map(whole).collect::<Result<_, _>>()?,
            b"TYPE" => header.kinds = words.map(|word| word[0]).collect(),
            b"COUNT" => header.counts = words.map(whole).collect::<Result<_, _>>()?,
            b"WIDTH" => header.width = whole(words.next().unwrap_or_default())?,
            b"HEIGHT" => header.height = whole(words.next().unwrap_or_default())?,
            b"POINTS" => header.points = Some(whole(words.next().unwrap_or_default())?),
            b"DATA" => {
                header.encoding = words.next().unwrap_or_default().to_vec();
                let end = at + line.len();
                let breaks = if bytes[end..].starts_with(b"\r\n") { 2 } else { 1 };
                header.end = (end + breaks).min(bytes.len());
                return Ok(header);
            }
            _ => {}
        }
    }
    Err(ReadError::at_byte(PCD, within, "the header has no end (DATA): it was cut short"))
}

impl Header {
    fn fields(&self) -> Result<Vec<Field>, String> {
        let n = self.names.len();
        let counts = if self.counts.is_empty() { vec![1; n] } else { self.counts.clone() };
        if [self.sizes.len(), self.kinds.len(), counts.len()] != [n; 3] {
            return Err(format!("FIELDS names {n} fields, but SIZE, TYPE or COUNT do not"));
        }
        let field = |i: usize| {
            let (kind, bytes, count) = (self.kinds[i], self.sizes[i], counts[i]);
            let is_number = matches!((kind, bytes), (b'F', 4 | 8) | (b'I' | b'U', 1 | 2 | 4 | 8));
            // More would be no point's; and sums of these cannot overflow.
            match is_number && count <= 1 << 16 {
                true => Ok(Field { kind, bytes, count }),
                false => Err(format!(
                    "field {} has SIZE {bytes}, TYPE {} and COUNT {count}, which is no number",
                    quoted(&self.names[i]),
                    char::from(kind).escape_default()
                )),
            }
        };
        (0..n).map(field).collect()
    }
}

/// The points of a file.
struct Body<'a> {
    bytes: &'a [u8],
    body: &'a [u8],
    start: usize,
    fields: &'a [Field],
    /// Which fields are x, y and z.
    at: [usize; 3],
    count: usize,
}

impl Body<'_> {
    fn fault(&self, at: usize, what: impl Into<String>) -> ReadError {
        ReadError::at_byte(PCD, self.start + at, what)
    }

    /// Bytes that a point takes.
    fn stride(&self) -> usize {
        self.fields.iter().map(|field| field.bytes * field.count).sum()
    }

    fn empty(&self) -> ReadPoints {
        ReadPoints { format: PCD, ..ReadPoints::default() }
    }

    fn ascii(&self, tick: Tick<'_>) -> Result<ReadPoints, ReadError> {
        let mut read = self.empty();
        let before = |field: usize| self.fields[..field].iter().map(|field| field.count).sum();
        let columns: [usize; 3] = self.at.map(before);
        let mut told = self.start;
        let mut rows = 0;
        for (at, line) in lines(self.bytes, self.start..self.bytes.len()) {
            let values: Vec<&[u8]> = words(line).collect();
            if values.is_empty() {
                continue;
            }
            let fault = |what: String| ReadError::at_line(PCD, self.bytes, at, what);
            let mut point = [0.0; 3];
            for (length, column) in point.iter_mut().zip(columns) {
                let word = values.get(column).copied().unwrap_or_default();
                *length = number(word).ok_or_else(|| {
                    fault(format!("{} in column {} is no number", quoted(word), column + 1))
                })?;
            }
            rows += 1;
            limited("points", rows as u64, MAX_POINTS)?;
            read.push(DVec3::from_array(point));
            if at - told >= 1 << 20 {
                go_on(tick, at - told)?;
                told = at;
            }
        }
        match rows == self.count {
            true => Ok(read),
            false => Err(self.fault(self.body.len(), self.promise(rows))),
        }
    }

    fn promise(&self, found: usize) -> String {
        format!("the header promises {} points, the file holds {found}", self.count)
    }

    fn binary(&self, tick: Tick<'_>) -> Result<ReadPoints, ReadError> {
        let stride = self.stride();
        let whole = self.body.len() / stride;
        if whole < self.count {
            return Err(
                self.fault(self.body.len(), format!("{}: it was cut short", self.promise(whole)))
            );
        }
        let before = |field: usize| self.fields[..field].iter().map(|f| f.bytes * f.count).sum();
        let offsets: [usize; 3] = self.at.map(before);
        self.gather(self.body, tick, |point, axis| point * stride + offsets[axis])
    }

    fn compressed(&self, tick: Tick<'_>) -> Result<ReadPoints, ReadError> {
        let size = |at: usize| match self.body.get(at..at + 4) {
            Some(&[a, b, c, d]) => Ok(u32::from_le_bytes([a, b, c, d]) as usize),
            _ => {
                Err(self.fault(at, "the sizes of the packed points are missing: it was cut short"))
            }
        };
        let (packed, unpacked) = (size(0)?, size(4)?);
        let Some(packed) = self.body[8..].get(..packed) else {
            return Err(self.fault(
                8,
                format!(
                    "{packed} packed bytes are promised, {} follow: it was cut short",
                    self.body.len() - 8
                ),
            ));
        };
        let needed = self.count.saturating_mul(self.stride());
        if unpacked < needed || needed > packed.len().saturating_mul(MAX_EXPANSION) {
            let what =
                format!("{} bytes are packed, which {} points cannot be", unpacked, self.count);
            return Err(self.fault(4, what));
        }
        let plain = unpack(packed, unpacked).filter(|plain| plain.len() >= needed);
        let plain = plain.ok_or_else(|| self.fault(8, "the packed points are damaged"))?;
        let before = |field: usize| -> usize {
            self.fields[..field].iter().map(|f| f.bytes * f.count * self.count).sum()
        };
        let starts = self.at.map(before);
        let strides = self.at.map(|field| self.fields[field].bytes * self.fields[field].count);
        self.gather(&plain, tick, |point, axis| starts[axis] + point * strides[axis])
    }

    /// Reads all points out of `plain`, where `place` says a coordinate stands.
    fn gather(
        &self,
        plain: &[u8],
        tick: Tick<'_>,
        place: impl Fn(usize, usize) -> usize,
    ) -> Result<ReadPoints, ReadError> {
        let mut read = self.empty();
        read.points.reserve(self.count);
        for point in 0..self.count {
            let length = |axis: usize| {
                let field = self.fields[self.at[axis]];
                let at = place(point, axis);
                value(field, &plain[at..at + field.bytes])
            };
            read.push(DVec3::new(length(0), length(1), length(2)));
            if point % BATCH == BATCH - 1 {
                go_on(tick, BATCH * self.body.len() / self.count)?;
            }
        }
        Ok(read)
    }
}

/// The number that a field holds; all are little-endian.
fn value(field: Field, bytes: &[u8]) -> f64 {
    // Widened with the sign that it has.
    let is_negative = field.kind == b'I' && bytes.last().is_some_and(|byte| *byte >= 0x80);
    let mut wide = [if is_negative { 0xff } else { 0 }; 8];
    wide[..bytes.len()].copy_from_slice(bytes);
    match (field.kind, field.bytes) {
        (b'F', 4) => f64::from(f32::from_le_bytes([wide[0], wide[1], wide[2], wide[3]])),
        (b'F', _) => f64::from_le_bytes(wide),
        (b'I', _) => i64::from_le_bytes(wide) as f64,
        _ => u64::from_le_bytes(wide) as f64,
    }
}

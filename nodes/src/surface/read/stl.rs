//! STL, binary and ASCII (3D Systems, *StereoLithography Interface Specification*, 1988).
//!
//! Binary: 80 bytes of header, the count of triangles, 50 bytes a triangle, see `save_stl`. ASCII:
//! `facet normal`, `outer loop`, three `vertex`, in words. Normals are not read: the corners' order
//! says the same and, where the two differ, what other programs believe.
//!
//! Files lie. A binary one may begin with "solid", so a count that fits the file's length makes it
//! binary, whatever its first word. A count of 0 or 2³²-1 is what programs leave there that did not
//! know it when they began; the file's length tells then, as it does when there are more whole
//! triangles than promised. A file with *fewer* than promised is taken for cut short.
//!
//! The crate `stl_io` reads binary files one `Read` at a time and welds through a `HashMap`; its
//! errors name no place. So this is our own.

use super::text::{Words, is_text, number, quoted, skip_mark};
use super::{BATCH, MAX_TRIANGLES, ReadError, ReadMesh, Welder, go_on, limited};
use carvegraph_geometry::{DVec3, Tick};

const BINARY: &str = "binary STL";
const ASCII: &str = "ASCII STL";

/// Header and count.
const HEAD_BYTES: usize = 84;

/// Normal, three corners, two spare bytes.
const TRIANGLE_BYTES: usize = 50;

/// Counts that mean "not known when the file was begun".
const PLACEHOLDERS: [usize; 2] = [0, u32::MAX as usize];

/// A file without a count to go by is STL if its first triangles have lengths below this. Bytes that
/// mean something else soon give a greater one, or none.
const PLAUSIBLE: f32 = 1e9;

/// How many triangles are looked at for that.
const LOOKED_AT: usize = 10;

/// The count that a binary file promises.
fn promised(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEAD_BYTES)?;
    Some(u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize)
}

/// Whether the file's length is what its count makes of it.
pub(super) fn has_honest_count(bytes: &[u8]) -> bool {
    promised(bytes).is_some_and(|count| bytes.len() == HEAD_BYTES + count * TRIANGLE_BYTES)
}

/// Whether it begins like an ASCII file.
pub(super) fn is_ascii(bytes: &[u8]) -> bool {
    let word = Words::new(bytes, skip_mark(bytes)).word();
    word.is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && is_text(bytes)
}

/// Whether the records of a file with a wrong count could be triangles.
pub(super) fn could_be_binary(bytes: &[u8]) -> bool {
    let Some(records) = bytes.get(HEAD_BYTES..) else { return false };
    let plausible = |record: &[u8]| record.chunks_exact(4).all(|b| length(b).abs() < PLAUSIBLE);
    let mut looked_at = records.chunks_exact(TRIANGLE_BYTES).take(LOOKED_AT).peekable();
    looked_at.peek().is_some() && looked_at.all(|record| plausible(&record[..48]))
}

fn length(bytes: &[u8]) -> f32 {
    f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

fn corner(bytes: &[u8]) -> DVec3 {
    let [x, y, z] = [0, 4, 8].map(|at| f64::from(length(&bytes[at..at + 4])));
    DVec3::new(x, y, z)
}

/// How many triangles there are, and what is odd about that.
fn count(bytes: &[u8]) -> Result<(usize, Vec<String>), ReadError> {
    let promised = promised(bytes).unwrap_or(0);
    let body = bytes.len() - HEAD_BYTES;
    let (whole, rest) = (body / TRIANGLE_BYTES, body % TRIANGLE_BYTES);
    if promised > whole && !PLACEHOLDERS.contains(&promised) {
        let what = format!(
            "the header promises {promised} triangles, the file ends after {whole}: it was cut \
             short, or its count is wrong; save it again"
        );
        return Err(ReadError::at_byte(BINARY, bytes.len(), what));
    }
    let mut odd = Vec::new();
    if rest != 0 && PLACEHOLDERS.contains(&promised) {
        let what = "the file ends within a triangle: it was cut short; save it again";
        return Err(ReadError::at_byte(BINARY, bytes.len(), what));
    }
    if rest != 0 {
        let more = body - promised * TRIANGLE_BYTES;
        odd.push(format!("{more} bytes after the {promised} triangles are left out"));
        return Ok((promised, odd));
    }
    if promised != whole {
        odd.push(format!("the header promises {promised} triangles, the file holds {whole}"));
    }
    Ok((whole, odd))
}

/// Reads a binary file of at least a header.
pub(super) fn read_binary(bytes: &[u8], tick: Tick<'_>) -> Result<ReadMesh, ReadError> {
    let (count, oddities) = count(bytes)?;
    limited("triangles", count as u64, MAX_TRIANGLES)?;
    let records = &bytes[HEAD_BYTES..][..count * TRIANGLE_BYTES];
    // A closed surface has half as many vertices as triangles.
    let mut welder = Welder::new(count / 2 + 2);
    let mut triangles = Vec::with_capacity(count);
    for (batch, records) in records.chunks(BATCH * TRIANGLE_BYTES).enumerate() {
        for (n, record) in records.chunks_exact(TRIANGLE_BYTES).enumerate() {
            let corners = [12, 24, 36].map(|at| corner(&record[at..at + 12]));
            if !corners.iter().all(|corner| corner.is_finite()) {
                let index = batch * BATCH + n;
                let at = HEAD_BYTES + index * TRIANGLE_BYTES;
                let what = format!("a corner of triangle {index} (from 0) is no finite number");
                return Err(ReadError::at_byte(BINARY, at, what));
            }
            triangles.push(corners.map(|corner| welder.index(corner)));
        }
        go_on(tick, records.len())?;
    }
    let vertices = welder.into_vertices();
    Ok(ReadMesh { vertices, triangles, format: BINARY, unit_mm: None, oddities })
}

/// An ASCII file on its way through.
struct Ascii<'a> {
    bytes: &'a [u8],
    words: Words<'a>,
    welder: Welder,
    triangles: Vec<[u32; 3]>,
}

/// Reads an ASCII file: one `solid` or several.
pub(super) fn read_ascii(bytes: &[u8], tick: Tick<'_>) -> Result<ReadMesh, ReadError> {
    let words = Words::new(bytes, skip_mark(bytes));
    let mut reader = Ascii { bytes, words, welder: Welder::new(0), triangles: Vec::new() };
    let (mut told, mut open) = (0, false);
    while let Some(word) = reader.words.word() {
        let known = [&b"solid"[..], b"facet", b"endsolid"];
        match known.iter().position(|known| word.eq_ignore_ascii_case(known)) {
            Some(1) if open => reader.facet()?,
            Some(0) if !open => open = true,
            Some(2) if open => open = false,
            _ => {
                return Err(
                    reader.unexpected(word, if open { "facet or endsolid" } else { "solid" })
                );
            }
        }
        if !word.eq_ignore_ascii_case(b"facet") {
            // Its name.
            reader.words.skip_line();
        }
        if reader.words.at() - told >= 1 << 20 {
            go_on(tick, reader.words.at() - told)?;
            told = reader.words.at();
        }
    }
    if open {
        return Err(reader.fault("the file ends without endsolid: it was cut short; save it again"));
    }
    let (vertices, triangles) = (reader.welder.into_vertices(), reader.triangles);
    Ok(ReadMesh { vertices, triangles, format: ASCII, ..ReadMesh::default() })
}

impl Ascii<'_> {
    fn fault(&self, what: impl Into<String>) -> ReadError {
        ReadError::at_line(ASCII, self.bytes, self.words.at(), what)
    }

    fn unexpected(&self, word: &[u8], wanted: &str) -> ReadError {
        self.fault(format!("{} stands where {wanted} belongs", quoted(word)))
    }

    fn expect(&mut self, wanted: &str) -> Result<(), ReadError> {
        match self.words.word() {
            Some(word) if word.eq_ignore_ascii_case(wanted.as_bytes()) => Ok(()),
            Some(word) => Err(self.unexpected(word, wanted)),
            None => {
                Err(self.fault(format!("the file ends where {wanted} belongs: it was cut short")))
            }
        }
    }

    /// What follows the word `facet`.
    fn facet(&mut self) -> Result<(), ReadError> {
        self.expect("normal")?;
        // Whatever the three say: some programs write "nan" for the normal of a sliver.
        (0..3).for_each(|_| _ = self.words.word());
        self.expect("outer")?;
        self.expect("loop")?;
        let mut triangle = [0; 3];
        for index in &mut triangle {
            let corner = self.corner()?;
            *index = self.welder.index(corner);
        }
        self.expect("endloop")?;
        self.expect("endfacet")?;
        self.triangles.push(triangle);
        limited("triangles", self.triangles.len() as u64, MAX_TRIANGLES)
    }

    fn corner(&mut self) -> Result<DVec3, ReadError> {
        self.expect("vertex")?;
        let mut corner = [0.0; 3];
        for length in &mut corner {
            let word = self.words.word().unwrap_or_default();
            *length = number(word).filter(|length| length.is_finite()).ok_or_else(|| {
                self.fault(format!("{} is no finite number of a vertex", quoted(word)))
            })?;
        }
        Ok(DVec3::from_array(corner))
    }
}

//! LAS 1.0 to 1.4 (ASPRS, *LAS Specification 1.4 - R15*, 2019) and its packed form, LAZ.
//!
//! A point is three whole numbers; scale and offset of the header make lengths of them, in `f64`, so
//! coordinates of a country's grid keep their millimetres. Only these are read: the header's places
//! for them and the first twelve bytes of a point are the same in all versions. The crate `laz`
//! unpacks; `las` would bring dates, identifiers and a struct of 100 bytes a point that we do not need.

use super::{BATCH, MAX_POINTS, ReadError, ReadPoints, go_on, limited};
use carvegraph_geometry::{DVec3, Tick};
use laz::{LasZipDecompressor, LazVlr};
use std::io::Cursor;

const LAS: &str = "LAS";

/// The head of a variable length record.
const RECORD_HEAD_BYTES: usize = 54;

/// Who wrote the record that says how points are packed, and its number.
const PACKING: (&[u8], u16) = (b"laszip encoded", 22204);

/// The longest point that is taken: formats have 67 bytes at most, and some extra ones.
const MAX_POINT_BYTES: usize = 4096;

/// What the header says of the points.
#[derive(Debug)]
struct Header {
    is_packed: bool,
    stride: usize,
    count: u64,
    start: usize,
    scale: DVec3,
    offset: DVec3,
}

/// Whether a file begins like LAS or LAZ.
pub(super) fn is_las(bytes: &[u8]) -> bool {
    bytes.starts_with(b"LASF")
}

fn fault(at: usize, what: impl Into<String>) -> ReadError {
    ReadError::at_byte(LAS, at, what)
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> Result<[u8; N], ReadError> {
    let found = bytes.get(at..).and_then(|rest| rest.first_chunk::<N>());
    found
        .copied()
        .ok_or_else(|| fault(bytes.len(), "the file ends within its header: it was cut short"))
}

fn vector(bytes: &[u8], at: usize) -> Result<DVec3, ReadError> {
    let length = |i: usize| Ok(f64::from_le_bytes(array(bytes, at + 8 * i)?));
    Ok(DVec3::new(length(0)?, length(1)?, length(2)?))
}

fn header(bytes: &[u8]) -> Result<Header, ReadError> {
    let [minor, format] = [array::<1>(bytes, 25)?[0], array::<1>(bytes, 104)?[0]];
    let old_count = u64::from(u32::from_le_bytes(array(bytes, 107)?));
    let count = match minor {
        4.. => u64::from_le_bytes(array(bytes, 247)?),
        _ => old_count,
    };
    let header = Header {
        is_packed: format & 0xc0 != 0,
        stride: usize::from(u16::from_le_bytes(array(bytes, 105)?)),
        count,
        start: u32::from_le_bytes(array(bytes, 96)?) as usize,
        scale: vector(bytes, 131)?,
        offset: vector(bytes, 155)?,
    };
    if !(12..=MAX_POINT_BYTES).contains(&header.stride) {
        let what = format!("a point of {} bytes; 12 to {MAX_POINT_BYTES} can be", header.stride);
        return Err(fault(105, what));
    }
    if !(header.scale.is_finite() && header.offset.is_finite()) {
        return Err(fault(131, "scale or offset are no finite numbers"));
    }
    if header.start > bytes.len() {
        return Err(fault(bytes.len(), "the file ends before its first point: it was cut short"));
    }
    limited("points", header.count, MAX_POINTS)?;
    Ok(header)
}

/// Reads the points.
pub(super) fn read_points(bytes: &[u8], tick: Tick<'_>) -> Result<ReadPoints, ReadError> {
    let header = header(bytes)?;
    if header.is_packed {
        read_packed(bytes, &header, tick)
    } else {
        read_plain(bytes, &header, tick)
    }
}

impl Header {
    fn point(&self, record: &[u8]) -> DVec3 {
        let whole = |at: usize| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| record[at + i]);
            f64::from(i32::from_le_bytes([a, b, c, d]))
        };
        DVec3::new(whole(0), whole(4), whole(8)) * self.scale + self.offset
    }
}

fn read_plain(bytes: &[u8], header: &Header, tick: Tick<'_>) -> Result<ReadPoints, ReadError> {
    let records = &bytes[header.start..];
    let (whole, count) = (records.len() / header.stride, header.count as usize);
    if whole < count {
        let what = format!(
            "the header promises {count} points, the file ends after {whole}: it was cut short"
        );
        return Err(fault(bytes.len(), what));
    }
    let mut read = ReadPoints { format: "LAS", ..ReadPoints::default() };
    read.points.reserve(count);
    for batch in records[..count * header.stride].chunks(BATCH * header.stride) {
        batch.chunks_exact(header.stride).for_each(|record| read.push(header.point(record)));
        go_on(tick, batch.len())?;
    }
    Ok(read)
}

fn read_packed(bytes: &[u8], header: &Header, tick: Tick<'_>) -> Result<ReadPoints, ReadError> {
    let packing = packing(bytes)?;
    let vlr = LazVlr::from_buffer(packing).map_err(|what| fault(header.start, what.to_string()))?;
    let items: u64 = vlr.items().iter().map(|item| u64::from(item.size())).sum();
    if items != header.stride as u64 {
        return Err(fault(105, format!("points have {} bytes, packed are {items}", header.stride)));
    }
    check_chunks(bytes, header)?;
    let mut source = Cursor::new(bytes);
    source.set_position(header.start as u64);
    let damaged = |what: laz::LasZipError| {
        fault(header.start, format!("the packed points are damaged or cut short: {what}"))
    };
    let mut points = LasZipDecompressor::new(source, vlr).map_err(damaged)?;
    let mut read = ReadPoints { format: "LAZ", ..ReadPoints::default() };
    let mut record = vec![0; header.stride];
    let share = bytes.len() / (header.count as usize).max(1);
    for index in 0..header.count as usize {
        points.decompress_one(&mut record).map_err(|what| damaged(what.into()))?;
        read.push(header.point(&record));
        if index % BATCH == BATCH - 1 {
            go_on(tick, BATCH * share)?;
        }
    }
    Ok(read)
}

/// Refuses a table of more chunks than the file can hold, each of which begins with a whole point: the
/// crate would allocate what the table promises. The table's place stands before the first point or,
/// where the writer could not go back, at the end of the file.
fn check_chunks(bytes: &[u8], header: &Header) -> Result<(), ReadError> {
    let place = |at: usize| {
        let table = usize::try_from(i64::from_le_bytes(array(bytes, at)?)).unwrap_or(0);
        Ok(Some(table).filter(|table| *table > header.start))
    };
    let table = match place(header.start)? {
        Some(table) => Some(table),
        None => place(bytes.len().saturating_sub(8))?,
    };
    let table = table.filter(|table| *table < bytes.len());
    let table = table.ok_or_else(|| {
        fault(header.start, "the table of packed chunks is missing: the file was cut short")
    })?;
    let chunks = u32::from_le_bytes(array(bytes, table + 4)?) as usize;
    match chunks.saturating_mul(header.stride) <= bytes.len() {
        true => Ok(()),
        false => {
            Err(fault(table, format!("{chunks} packed chunks are more than the file can hold")))
        }
    }
}

/// The record that says how the points are packed.
fn packing(bytes: &[u8]) -> Result<&[u8], ReadError> {
    let mut at = usize::from(u16::from_le_bytes(array(bytes, 94)?));
    for _ in 0..u32::from_le_bytes(array(bytes, 100)?) {
        let author: [u8; 16] = array(bytes, at + 2)?;
        let number = u16::from_le_bytes(array(bytes, at + 18)?);
        let length = usize::from(u16::from_le_bytes(array(bytes, at + 20)?));
        let start = at + RECORD_HEAD_BYTES;
        if author.starts_with(PACKING.0) && number == PACKING.1 {
            let record = bytes.get(start..start + length);
            return record.ok_or_else(|| fault(start, "the record of the packing is cut short"));
        }
        at = start + length;
    }
    Err(fault(at.min(bytes.len()), "no record says how the points are packed"))
}

//! Points as text: XYZ, CSV and their kin, a line a point.
//!
//! Columns are parted by blanks, tabs, commas or semicolons; which of them is seen from the first
//! line of numbers. Where semicolons or blanks part them, a comma within a number is a decimal mark.
//! Lines before the first one of numbers are headings; one that names x, y and z says which columns
//! these are, otherwise they are the first three. Lines that begin with `#`, `//`, `%` or `!` are
//! comments. After the first point, a line that is none of this is an error, not a gap.

use super::text::{lines, number, quoted, skip_mark, words};
use super::{MAX_POINTS, ReadError, ReadPoints, limited};
use carvegraph_geometry::{DVec3, Tick};
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;

const TEXT: &str = "point text";

/// More headings than this before the first point are no table of points.
const MAX_HEADINGS: usize = 100;

/// What one thread reads at a time.
const CHUNK_BYTES: usize = 1 << 20;

/// What parts the columns.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Parting {
    Blanks,
    /// Blanks, and commas as decimal marks.
    BlanksDecimalComma,
    Commas,
    /// Semicolons, and commas as decimal marks if there are any.
    Semicolons,
}

/// How lines are read.
#[derive(Clone, Copy, Debug)]
struct Layout {
    parting: Parting,
    /// The columns of x, y and z.
    columns: [usize; 3],
}

/// Something is wrong at a byte.
type Fault = (usize, String);

/// Reads the points.
pub(super) fn read_points(bytes: &[u8], tick: Tick<'_>) -> Result<ReadPoints, ReadError> {
    let (start, layout) = begin(bytes)?;
    let chunks = chunks(bytes, start);
    let read: Vec<Result<ReadPoints, Option<Fault>>> = chunks
        .into_par_iter()
        .map(|chunk| {
            let length = chunk.len();
            let read = read_chunk(bytes, chunk, layout).map_err(Some)?;
            if tick(length) { Ok(read) } else { Err(None) }
        })
        .collect();
    let mut all = ReadPoints { format: TEXT, ..ReadPoints::default() };
    for chunk in read {
        let chunk = chunk.map_err(|fault| match fault {
            Some((at, what)) => ReadError::at_line(TEXT, bytes, at, what),
            None => ReadError::Stopped,
        })?;
        all.missed += chunk.missed;
        limited("points", (all.points.len() + chunk.points.len()) as u64, MAX_POINTS)?;
        all.points.extend(chunk.points);
    }
    Ok(all)
}

fn is_comment(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    line.is_empty() || line.starts_with(b"//") || b"#%!\x1a".contains(&line[0])
}

/// Where the first point stands and how lines are read.
fn begin(bytes: &[u8]) -> Result<(usize, Layout), ReadError> {
    let (mut headings, mut named) = (0, None);
    for (at, line) in lines(bytes, skip_mark(bytes)..bytes.len()) {
        if let Some(parting) = parting(line) {
            let columns = named.unwrap_or([0, 1, 2]);
            return Ok((at, Layout { parting, columns }));
        }
        if line.trim_ascii().is_empty() {
            continue;
        }
        named = names(line).or(named);
        headings += usize::from(!is_comment(line));
        if headings > MAX_HEADINGS {
            let what = format!("none of the first {MAX_HEADINGS} lines begins with three numbers");
            return Err(ReadError::at_line(TEXT, bytes, at, what));
        }
    }
    Err(ReadError::at_line(TEXT, bytes, bytes.len(), "no line has three numbers: x, y and z"))
}

/// How a line is parted, if that gives three numbers or more.
fn parting(line: &[u8]) -> Option<Parting> {
    let is_row = |parting: &Parting| {
        let numbers = fields(line, *parting).filter(|field| value(field, *parting).is_some());
        !is_comment(line) && numbers.count() >= 3
    };
    let comma = line.contains(&b',');
    let tried: &[Parting] = match () {
        () if line.contains(&b';') => &[Parting::Semicolons],
        () if comma && has_decimal_commas(line) => &[Parting::BlanksDecimalComma],
        () if comma => &[Parting::Commas],
        () => &[Parting::Blanks],
    };
    tried.iter().copied().find(is_row)
}

/// Whether each of three columns or more is parted by blanks and has one comma inside.
fn has_decimal_commas(line: &[u8]) -> bool {
    let is_decimal = |word: &[u8]| {
        let inner = word.get(1..word.len() - 1).unwrap_or_default();
        inner.contains(&b',') && word.iter().filter(|byte| **byte == b',').count() == 1
    };
    words(line).take(3).filter(|word| is_decimal(word)).count() == 3
}

fn fields(line: &[u8], parting: Parting) -> Box<dyn Iterator<Item = &[u8]> + '_> {
    match parting {
        Parting::Blanks | Parting::BlanksDecimalComma => Box::new(words(line)),
        Parting::Commas => Box::new(line.split(|byte| *byte == b',').map(<[u8]>::trim_ascii)),
        Parting::Semicolons => Box::new(line.split(|byte| *byte == b';').map(<[u8]>::trim_ascii)),
    }
}

fn value(field: &[u8], parting: Parting) -> Option<f64> {
    let takes_comma = matches!(parting, Parting::BlanksDecimalComma | Parting::Semicolons);
    match field.iter().position(|byte| *byte == b',').filter(|_| takes_comma) {
        None => number(field),
        Some(comma) => {
            let mut field = field.to_vec();
            field[comma] = b'.';
            number(&field)
        }
    }
}

/// The columns that a heading calls x, y and z, whatever parts them.
fn names(line: &[u8]) -> Option<[usize; 3]> {
    let line = line.trim_ascii_start();
    let line = line.strip_prefix(b"//").or(line.strip_prefix(b"#")).unwrap_or(line);
    let parted: Vec<Cow<'_, str>> = line
        .split(|byte| b",; \t".contains(byte))
        .filter(|name| !name.is_empty())
        .map(String::from_utf8_lossy)
        .collect();
    let is_called = |field: &str, name: char| {
        let mut letters =
            field.chars().filter(|letter| *letter != '"').map(|l| l.to_ascii_lowercase());
        letters.next() == Some(name) && !letters.next().is_some_and(char::is_alphanumeric)
    };
    let column = |name: char| parted.iter().position(|field| is_called(field, name));
    Some([column('x')?, column('y')?, column('z')?])
}

/// Pieces of the text that end with a line.
fn chunks(bytes: &[u8], start: usize) -> Vec<Range<usize>> {
    let mut chunks = Vec::new();
    let mut at = start;
    while at < bytes.len() {
        let end = (at + CHUNK_BYTES).min(bytes.len());
        let line = bytes[end..].iter().position(|byte| *byte == b'\n' || *byte == b'\r');
        let end = line.map_or(bytes.len(), |length| end + length + 1);
        chunks.push(at..end);
        at = end;
    }
    chunks
}

fn read_chunk(bytes: &[u8], chunk: Range<usize>, layout: Layout) -> Result<ReadPoints, Fault> {
    let mut read = ReadPoints::default();
    for (at, line) in lines(bytes, chunk) {
        if !is_comment(line) {
            read.push(point(line, layout).map_err(|what| (at, what))?);
        }
    }
    Ok(read)
}

fn point(line: &[u8], layout: Layout) -> Result<DVec3, String> {
    let last = layout.columns.into_iter().max().unwrap_or(0);
    let mut point = [None; 3];
    for (column, field) in fields(line, layout.parting).enumerate().take(last + 1) {
        for (length, wanted) in point.iter_mut().zip(layout.columns) {
            if wanted == column {
                let number = value(field, layout.parting);
                *length = Some(number.ok_or_else(|| {
                    format!("{} in column {} is no number", quoted(field), column + 1)
                })?);
            }
        }
    }
    match point {
        [Some(x), Some(y), Some(z)] => Ok(DVec3::new(x, y, z)),
        _ => Err(format!("a point needs {} columns, as the first one has", last + 1)),
    }
}

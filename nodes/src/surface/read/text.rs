//! Words, numbers and lines of text files, whatever their line ends.

use std::ops::Range;

/// How much of a file's beginning is looked at to tell text from binary. Headers are shorter, and
/// binary lengths have zero bytes sooner.
const LOOK_BYTES: usize = 1024;

/// Whether a file begins like text: no control signs but blanks and line ends.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(LOOK_BYTES)];
    !head.is_empty() && head.iter().all(|byte| *byte >= b' ' || is_blank(*byte))
}

/// Blanks and line ends, and the end-of-text sign that old programs close files with.
fn is_blank(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x1a
}

/// Without the mark that some editors put before UTF-8.
pub(super) fn skip_mark(bytes: &[u8]) -> usize {
    if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 }
}

/// The number of the line, from 1, in which byte `at` stands.
pub(super) fn line_of(bytes: &[u8], at: usize) -> usize {
    let before = &bytes[..at.min(bytes.len())];
    let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    1 + before.iter().filter(|byte| **byte == end).count()
}

/// A number as programs write it.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A few letters of a file for a message, without anything a terminal would obey.
pub(super) fn quoted(word: &[u8]) -> String {
    const MAX_BYTES: usize = 24;
    let shown = &word[..word.len().min(MAX_BYTES)];
    let ellipsis = if shown.len() < word.len() { "..." } else { "" };
    format!("\"{}{ellipsis}\"", shown.escape_ascii())
}

/// Goes through a text word by word.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    /// The words from byte `at` on.
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// The byte after the last word.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// The next word.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|byte| !is_blank(*byte))?;
        let rest = &rest[start..];
        let length = rest.iter().position(|byte| is_blank(*byte)).unwrap_or(rest.len());
        self.at += start + length;
        Some(&rest[..length])
    }

    /// Passes over the rest of the line.
    pub(super) fn skip_line(&mut self) {
        let rest = &self.bytes[self.at..];
        self.at += rest.iter().position(|byte| is_line_end(*byte)).unwrap_or(rest.len());
    }
}

fn is_line_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

/// The lines of a text, each with where it begins. CRLF gives an empty one more.
pub(super) fn lines(bytes: &[u8], within: Range<usize>) -> impl Iterator<Item = (usize, &[u8])> {
    let Range { start: mut at, end } = within;
    std::iter::from_fn(move || {
        let rest = bytes[..end].get(at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|byte| is_line_end(*byte)).unwrap_or(rest.len());
        let line = (at, &rest[..length]);
        at += length + 1;
        Some(line)
    })
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|byte| is_blank(*byte)).filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_any_way_and_keep_their_place() {
        let text = b"a b\r\nc\rd\n\ne";
        let found: Vec<_> =
            lines(text, 0..text.len()).filter(|(_, line)| !line.is_empty()).collect();
        assert_eq!(found, [(0, &b"a b"[..]), (5, b"c"), (7, b"d"), (10, b"e")]);
        assert_eq!(line_of(text, 10), 4);
        assert_eq!(line_of(b"a\rb\rc", 4), 3);
    }

    #[test]
    fn zeros_are_no_text() {
        assert!(is_text(b"solid x\r\n\t facet") && !is_text(b"solid\0\0") && !is_text(b""));
    }
}

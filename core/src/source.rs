//! Texts that errors point into: files, and arguments of the command line.
//!
//! A [`Source`] is a name and a text with an index of its lines; a [`Span`] is a byte range of one,
//! and stays valid for as long as it is kept. Lines end at a line feed (a carriage return before it
//! is not part of the line), and columns count characters, as editors do; a leading byte order mark
//! counts for nothing.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// U+FEFF, which some editors put before the first character of a file.
pub(crate) const BYTE_ORDER_MARK: char = '\u{feff}';

/// A named text. Share it as `Arc<Source>`.
pub struct Source {
    name: String,
    text: String,
    /// Byte offset of the first character of each line; never empty.
    line_starts: Vec<usize>,
}

impl Source {
    /// A text under the name that errors print: a path as the user wrote it, or `--set`.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let text = text.into();
        let ends = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n');
        let line_starts = std::iter::once(0).chain(ends.map(|(at, _)| at + 1)).collect();
        Self { name: name.into(), text, line_starts }
    }

    /// The name errors print.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The range of bytes as a span; what lies beyond the text or inside a character is cut off.
    pub fn span(self: &Arc<Self>, range: Range<usize>) -> Span {
        let start = self.floor(range.start);
        let end = self.floor(range.end).max(start);
        Span { source: Arc::clone(self), start, end }
    }

    /// Line and column of a byte offset, both counted from 1, the column in characters.
    pub fn position(&self, offset: usize) -> (usize, usize) {
        let offset = self.floor(offset);
        let line = self.line_number(offset);
        let before = &self.text[self.line_starts[line - 1]..offset];
        let marks = usize::from(line == 1 && before.starts_with(BYTE_ORDER_MARK));
        (line, before.chars().count() - marks + 1)
    }

    /// The line a byte offset stands on, counted from 1. Unlike [`Source::position`] it takes no
    /// longer on long lines.
    pub fn line_number(&self, offset: usize) -> usize {
        self.line_starts.partition_point(|&start| start <= offset)
    }

    /// The text of a line, counted from 1, without its line ending; empty if there is none such.
    pub fn line(&self, number: usize) -> &str {
        &self.text[self.line_range(number)]
    }

    /// Where a line, counted from 1, stands in the text, without its line ending.
    pub(crate) fn line_range(&self, number: usize) -> Range<usize> {
        let end_of_text = self.text.len();
        let Some(&start) = number.checked_sub(1).and_then(|index| self.line_starts.get(index))
        else {
            return end_of_text..end_of_text;
        };
        let end = self.line_starts.get(number).copied().unwrap_or(end_of_text);
        let line = &self.text[start..end];
        let line = line.strip_suffix('\n').unwrap_or(line);
        start..start + line.strip_suffix('\r').unwrap_or(line).len()
    }

    /// The last character boundary at or before an offset.
    fn floor(&self, offset: usize) -> usize {
        let offset = offset.min(self.text.len());
        (0..=offset).rev().find(|&at| self.text.is_char_boundary(at)).unwrap_or(0)
    }
}

impl fmt::Debug for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Source({:?}, {} bytes)", self.name, self.text.len())
    }
}

/// A byte range of a source, on character boundaries.
#[derive(Clone)]
pub struct Span {
    /// The text it is a part of.
    pub source: Arc<Source>,
    /// Offset of its first byte.
    pub start: usize,
    /// Offset after its last byte.
    pub end: usize,
}

impl Span {
    /// The part of the source it covers.
    pub fn text(&self) -> &str {
        &self.source.text[self.start..self.end]
    }

    /// Line and column where it starts, both counted from 1, the column in characters.
    pub fn position(&self) -> (usize, usize) {
        self.source.position(self.start)
    }
}

/// `file:line:column`, as editors and terminals make clickable.
impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.position();
        write!(f, "{}:{line}:{column}", self.source.name)
    }
}

impl fmt::Debug for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_characters_from_one() {
        let check = |text: &str, offset, expected| {
            assert_eq!(Source::new("t", text).position(offset), expected, "{text:?} at {offset}");
        };
        check("", 0, (1, 1));
        check("ab\ncd", 1, (1, 2));
        check("ab\ncd", 2, (1, 3));
        check("ab\ncd", 3, (2, 1));
        check("ab\r\ncd", 5, (2, 2));
        check("µm x", 4, (1, 4));
        check("µm", 1, (1, 1)); // inside µ
        check("a\n", 2, (2, 1));
        check("a", 99, (1, 2));
        check("\u{feff}(", 3, (1, 1));
        check("\u{feff}(", 0, (1, 1));
    }

    #[test]
    fn lines_come_without_their_ending() {
        let source = Source::new("t", "one\r\n\ntwo");
        let lines = [0, 1, 2, 3, 4].map(|number| source.line(number));
        assert_eq!(lines, ["", "one", "", "two", ""]);
    }

    #[test]
    fn spans_name_their_place_and_stay_inside_the_text() {
        let source = Arc::new(Source::new("--set", "diameter=0"));
        let span = source.span(9..999);
        assert_eq!((span.text(), span.to_string().as_str()), ("0", "--set:1:10"));
    }
}

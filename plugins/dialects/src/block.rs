//! Puts blocks together out of words and hands them to the sink, many at a time.

use crate::Text;
use crate::number::Grid;
use carvegraph_sdk::PostError;
use std::io;

/// Bytes handed to the sink at once: large enough that a call costs nothing beside them, small
/// enough that a sink which cancels is asked every few milliseconds.
const PIECE: usize = 64 * 1024;

/// How blocks are numbered.
#[derive(Clone, Debug)]
pub(crate) struct Numbering {
    /// What stands before the number.
    pub(crate) prefix: Text,
    /// The first number.
    pub(crate) first: u32,
    /// From one number to the next.
    pub(crate) step: u32,
    /// The largest number; behind it they begin again.
    pub(crate) last: u32,
}

/// Writes blocks, one a line.
pub(crate) struct Blocks<'a> {
    out: &'a mut dyn io::Write,
    /// Finished blocks, then the one being written.
    text: Vec<u8>,
    /// Where in `text` the one being written begins.
    begin: usize,
    limit: usize,
    numbering: Option<&'a Numbering>,
    /// The number of the next block.
    number: u32,
}

impl<'a> Blocks<'a> {
    /// Blocks of at most `limit` characters. Some controllers do not count spaces; no block comes
    /// near enough to its limit for that to matter.
    pub(crate) fn new(
        out: &'a mut dyn io::Write,
        limit: usize,
        numbering: Option<&'a Numbering>,
    ) -> Self {
        let number = numbering.map_or(0, |n| n.first);
        Self { out, text: Vec::with_capacity(PIECE + 512), begin: 0, limit, numbering, number }
    }

    /// Adds to the block what stands there as it is, after a space.
    #[inline]
    pub(crate) fn word(&mut self, text: &str) {
        self.space();
        self.text.extend_from_slice(text.as_bytes());
    }

    /// Adds a letter with a number.
    #[inline]
    pub(crate) fn number(&mut self, letter: u8, grid: Grid, steps: i64) {
        self.space();
        self.text.push(letter);
        grid.push(&mut self.text, steps);
    }

    /// Adds to what stands there, without a space.
    #[inline]
    pub(crate) fn text(&mut self, text: &str) {
        self.text.extend_from_slice(text.as_bytes());
    }

    /// Adds a number to what stands there, without a space.
    #[inline]
    pub(crate) fn digits(&mut self, grid: Grid, steps: i64) {
        grid.push(&mut self.text, steps);
    }

    /// Ends the block; an empty one leaves no line.
    #[inline]
    pub(crate) fn end(&mut self) -> Result<(), PostError> {
        let length = self.text.len() - self.begin;
        if length == 0 {
            return Ok(());
        }
        if length > self.limit {
            return Err(self.too_long());
        }
        self.text.push(b'\n');
        self.begin = self.text.len();
        if self.begin >= PIECE { self.hand_over() } else { Ok(()) }
    }

    /// Writes a block of its own.
    pub(crate) fn line(&mut self, text: &str) -> Result<(), PostError> {
        self.word(text);
        self.end()
    }

    /// Writes a line that is no block and has no number.
    pub(crate) fn bare_line(&mut self, text: &str) -> Result<(), PostError> {
        self.text(text);
        self.end()
    }

    /// Hands over all that is left.
    pub(crate) fn finish(mut self) -> Result<(), PostError> {
        self.hand_over()?;
        Ok(self.out.flush()?)
    }

    #[inline]
    fn space(&mut self) {
        if self.text.len() > self.begin {
            self.text.push(b' ');
        } else if self.numbering.is_some() {
            self.begin_numbered();
        }
    }

    fn begin_numbered(&mut self) {
        let Some(Numbering { prefix, first, step, last }) = self.numbering else { return };
        self.text.extend_from_slice(prefix.as_bytes());
        Grid::WHOLE.push(&mut self.text, i64::from(self.number));
        self.text.push(b' ');
        self.number =
            if self.number <= last.saturating_sub(*step) { self.number + step } else { *first };
    }

    fn hand_over(&mut self) -> Result<(), PostError> {
        self.out.write_all(&self.text)?;
        self.text.clear();
        self.begin = 0;
        Ok(())
    }

    #[cold]
    fn too_long(&self) -> PostError {
        let block = &self.text[self.begin..];
        let length = block.len();
        let block = String::from_utf8_lossy(block).into_owned();
        PostError::BlockTooLong { block, length, limit: self.limit }
    }
}

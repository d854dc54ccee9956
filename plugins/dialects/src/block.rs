//! Puts blocks together out of words and hands them to the sink, many at a time.

use crate::number::Grid;
use carvegraph_sdk::PostError;
use std::io;

/// Bytes handed to the sink at once: large enough that a call costs nothing beside them, small
/// enough that a sink which cancels is asked every few milliseconds.
const PIECE: usize = 64 * 1024;

/// Writes blocks, one a line.
pub(crate) struct Blocks<'a> {
    out: &'a mut dyn io::Write,
    /// Finished blocks, then the one being written.
    text: Vec<u8>,
    /// Where in `text` the one being written begins.
    begin: usize,
    limit: usize,
}

impl<'a> Blocks<'a> {
    /// Blocks of at most `limit` characters; spaces do not count.
    pub(crate) fn new(out: &'a mut dyn io::Write, limit: usize) -> Self {
        Self { out, text: Vec::with_capacity(PIECE + 512), begin: 0, limit }
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

    /// Adds a letter with a whole number, written without a point.
    pub(crate) fn whole(&mut self, letter: char, number: u32) {
        self.word(&format!("{letter}{number}"));
    }

    /// Ends the block; an empty one leaves no line.
    #[inline]
    pub(crate) fn end(&mut self) -> Result<(), PostError> {
        let length = self.text.len() - self.begin;
        if length == 0 {
            return Ok(());
        }
        if length > self.limit {
            self.check_length()?;
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

    /// Hands over all that is left.
    pub(crate) fn finish(mut self) -> Result<(), PostError> {
        self.hand_over()?;
        Ok(self.out.flush()?)
    }

    #[inline]
    fn space(&mut self) {
        if self.text.len() > self.begin {
            self.text.push(b' ');
        }
    }

    fn hand_over(&mut self) -> Result<(), PostError> {
        self.out.write_all(&self.text)?;
        self.text.clear();
        self.begin = 0;
        Ok(())
    }

    #[cold]
    fn check_length(&self) -> Result<(), PostError> {
        let block = &self.text[self.begin..];
        let length = block.iter().filter(|&&b| b != b' ').count();
        if length <= self.limit {
            return Ok(());
        }
        let block = String::from_utf8_lossy(block).into_owned();
        Err(PostError::BlockTooLong { block, length, limit: self.limit })
    }
}

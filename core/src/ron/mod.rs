//! A reader of RON that keeps the place of every value and reports every fault at once.
//!
//! Method: recursive descent over the bytes. A fault inside an item is reported once; what is left
//! of the item, up to the `,` or the closing bracket at its depth, is skipped with strings and
//! comments respected, and reading goes on. Slips that leave no doubt (`=` for `:`, a missing comma,
//! a field name in quotes, a lost bracket that indentation or what follows gives away) are reported
//! and read as what was meant, so that one slip does not hide the next.
//!
//! Unlike the `ron` crate it refuses duplicate keys and fields, of which that keeps the last.
//!
//! Limits: [`MAX_TEXT_BYTES`], [`MAX_DEPTH`], [`MAX_FAULTS`]; whole numbers of 64 bits with sign.
//! Byte strings and type suffixes (`1u8`) are not read, `#![enable(...)]` lines are skipped. Time is
//! linear in the length of the text, and so is memory (some hundred times the text at worst).

mod brackets;
mod file;
pub mod form;
mod lexer;
mod reader;
mod recovery;
#[cfg(test)]
mod tests;
mod value;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::Source;
use reader::Reader;
use std::sync::Arc;

pub(crate) use file::read_text;
pub use file::{TextError, read_file};
pub use form::{Fields, Form, Item};
pub use value::{Name, Value, ValueKind};

/// The longest text read, 4 MiB: a recipe of 10,000 nodes has less than half of it.
pub const MAX_TEXT_BYTES: usize = 4 << 20;

/// The deepest nesting of brackets read: a recipe has 5 levels, and 64 are safe on any stack.
pub const MAX_DEPTH: usize = 64;

/// Reading stops at so many faults.
pub const MAX_FAULTS: usize = 100;

/// Longer excerpts are cut in messages.
const MAX_SHOWN_CHARS: usize = 40;

/// The text, cut to a length fit for a message.
fn shown(text: &str) -> String {
    match text.char_indices().nth(MAX_SHOWN_CHARS) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// Reads a text that holds one value, or reports all its faults.
pub fn parse(source: &Arc<Source>) -> Result<Value, Diagnostics> {
    let text = source.text();
    if text.len() > MAX_TEXT_BYTES {
        let message =
            format!("the text has {} bytes; {MAX_TEXT_BYTES} at most are read", text.len());
        return Err(Diagnostic::error(message).at(source.span(0..0)).into());
    }
    let mut reader = Reader::new(source);
    match reader.document() {
        Ok(value) if reader.faults.is_empty() => Ok(value),
        _ => Err(reader.faults),
    }
}

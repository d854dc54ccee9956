//! Text files, never more of one than is read.

use super::MAX_TEXT_BYTES;
use crate::source::Source;
use std::fmt::Display;
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::sync::Arc;

/// Why a text file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextError {
    /// There is none.
    #[error("there is no file {path}")]
    NotFound {
        /// The path that was tried.
        path: String,
    },
    /// It is no plain file, is too long or no UTF-8, or the system refuses.
    #[error("cannot read {path}: {why}")]
    Unreadable {
        /// Its path.
        path: String,
        /// What is wrong.
        why: String,
    },
}

/// Reads a file of at most [`MAX_TEXT_BYTES`] bytes of UTF-8, for [`parse`](super::parse). `what`
/// says what it is to be, such as "a machine".
///
/// # Errors
/// See [`TextError`].
pub fn read_file(path: &Path, what: &str) -> Result<Arc<Source>, TextError> {
    Ok(Arc::new(Source::new(path.display().to_string(), read_text(path, what)?)))
}

/// The text of such a file.
pub(crate) fn read_text(path: &Path, what: &str) -> Result<String, TextError> {
    let shown = || path.display().to_string();
    let unreadable =
        |why: &dyn Display| TextError::Unreadable { path: shown(), why: why.to_string() };
    // The kind is looked at before the file is opened: opening a pipe would wait for its writer.
    let about = fs::metadata(path).map_err(|fault| match fault.kind() {
        ErrorKind::NotFound => TextError::NotFound { path: shown() },
        _ => unreadable(&fault),
    })?;
    if !about.is_file() {
        return Err(unreadable(&"it is not a plain file"));
    }
    let bytes = about.len();
    if bytes > MAX_TEXT_BYTES as u64 {
        let why = format!("it has {bytes} bytes; {what} has at most {MAX_TEXT_BYTES}");
        return Err(unreadable(&why));
    }
    let mut text = Vec::new();
    File::open(path)
        .and_then(|file| file.take(MAX_TEXT_BYTES as u64).read_to_end(&mut text))
        .map_err(|fault| unreadable(&fault))?;
    let no_utf8 = |at: usize| unreadable(&format!("byte {at} is no UTF-8"));
    String::from_utf8(text).map_err(|fault| no_utf8(fault.utf8_error().valid_up_to()))
}

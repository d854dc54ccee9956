//! What is wrong with a text of a dialect's file: what it must be instead, if anything.

use crate::comment::PUNCTUATION;

pub(super) fn bad_about(text: &str) -> Option<&'static str> {
    let fits = !text.trim().is_empty() && text.len() <= 200 && !text.contains(char::is_control);
    (!fits).then_some("must be a line of 1 to 200 characters")
}

pub(super) fn bad_extension(text: &str) -> Option<&'static str> {
    let fits = (1..=8).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_alphanumeric());
    (!fits).then_some("must be 1 to 8 letters and digits")
}

/// It must not be read as a word.
pub(super) fn bad_open(text: &str) -> Option<&'static str> {
    let sign = text.starts_with(|c: char| c.is_ascii_punctuation());
    let fits = sign && text.len() <= 4 && printable(text);
    (!fits).then_some("must be a sign such as ( or ; and 4 characters at most")
}

pub(super) fn bad_close(text: &str) -> Option<&'static str> {
    let sign = text.is_empty() || text.bytes().all(|b| b.is_ascii_punctuation());
    (!sign || text.len() > 4).then_some("must be signs such as ) and 4 characters at most")
}

pub(super) fn bad_punctuation(text: &str) -> Option<&'static str> {
    let harmless = text.chars().all(|c| PUNCTUATION.contains(c));
    let fits = harmless && text.contains('-') && text.contains('.');
    (!fits).then_some("must be some of .,:+-*/=_'\"@&#% with - and . among them")
}

pub(super) fn bad_prefix(text: &str) -> Option<&'static str> {
    let fits = text.len() <= 4 && text.bytes().all(|b| b.is_ascii_uppercase() || b == b':');
    (!fits).then_some("must be upper-case letters, 4 at most")
}

/// Whether a text is ASCII without control characters.
pub(super) fn printable(text: &str) -> bool {
    text.bytes().all(|b| (b' '..=b'~').contains(&b))
}

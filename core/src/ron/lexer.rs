//! Where words, texts, comments and numbers begin and end.

use super::reader::Reported;
use super::value::ValueKind;
use std::ops::Range;

pub(super) fn is_closer(byte: u8) -> bool {
    matches!(byte, b')' | b']' | b'}')
}

/// Whether a byte can start a word; those beyond ASCII need a look at the character.
pub(super) fn starts_word(byte: u8) -> bool {
    byte.is_ascii_alphabetic() || byte == b'_' || !byte.is_ascii()
}

/// Whether a value other than a word or a group starts with the byte.
pub(super) fn starts_literal(byte: u8) -> bool {
    matches!(byte, b'"' | b'\'' | b'[' | b'{' | b'0'..=b'9' | b'+' | b'-' | b'.')
}

/// Where the word at an offset ends; there if none stands there.
pub(super) fn word_end(text: &str, at: usize) -> usize {
    let rest = &text[at..];
    at + rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len())
}

/// The first byte behind blanks and comments, or the start of a comment that is never closed.
pub(super) fn space_end(text: &str, mut at: usize) -> Result<usize, usize> {
    loop {
        let rest = text[at..].trim_start();
        at = text.len() - rest.len();
        if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            at = comment_end(text, at).ok_or(at)?;
        } else {
            return Ok(at);
        }
    }
}

/// Where the nested comment at an offset ends.
pub(super) fn comment_end(text: &str, at: usize) -> Option<usize> {
    let bytes = text.as_bytes();
    let (mut at, mut depth) = (at + 2, 1);
    while depth > 0 {
        at += match bytes.get(at..at + 2)? {
            b"*/" => {
                depth -= 1;
                2
            }
            b"/*" => {
                depth += 1;
                2
            }
            _ => 1,
        };
    }
    Some(at)
}

/// The end of a text that starts with a double quote.
pub(super) enum Scan {
    /// Behind the closing quote.
    Closed(usize),
    /// The next quote, which opens another text: something that never follows a closing quote
    /// stands behind it. So the closing quote was forgotten.
    Swallowing(usize),
    /// There is no further quote.
    Unclosed,
}

pub(super) fn scan_text(text: &str, start: usize) -> Scan {
    let bytes = text.as_bytes();
    let mut at = start + 1;
    // A text with escaped quotes is never taken for one that swallows: it would be scanned again
    // from each of them.
    let mut has_escaped_quote = false;
    loop {
        match bytes.get(at) {
            None => return Scan::Unclosed,
            Some(b'\\') => {
                has_escaped_quote |= bytes.get(at + 1) == Some(&b'"');
                at += 2;
            }
            Some(b'"') => break,
            Some(_) => at += 1,
        }
    }
    let follows = text[at + 1..].chars().next();
    let may_follow = |c: char| c.is_whitespace() || ",:;=/\"'()[]{}".contains(c);
    if has_escaped_quote || follows.is_none_or(may_follow) {
        Scan::Closed(at + 1)
    } else {
        Scan::Swallowing(at)
    }
}

/// Where a text without closing quote was meant to end, most likely. `range` is what it swallows.
pub(super) fn unclosed_text_end(text: &str, range: Range<usize>, is_key: bool) -> usize {
    let swallowed = &text[range.clone()];
    let line = swallowed.lines().next().unwrap_or("");
    let end = if is_key {
        line.find([':', '='])
    } else if line.len() < swallowed.len() {
        // It is the last text of its line, so it may hold anything but what ends the line.
        Some(line.trim_end_matches(|c: char| c.is_whitespace() || ",)]}".contains(c)).len())
    } else {
        line.find([',', ')', ']', '}'])
    };
    range.start + end.unwrap_or(line.len())
}

/// The closing quote, on its line, of a text without opening quote whose first word ends at `at`.
pub(super) fn unopened_text_end(text: &str, at: usize) -> Option<usize> {
    let rest = &text[at..];
    let (length, stop) = rest
        .match_indices(['"', '\n', ',', ':', ';', '=', '(', ')', '[', ']', '{', '}', '/'])
        .find(|&(at, stop)| stop != "/" || rest[at + 1..].starts_with(['/', '*']))?;
    // A quote behind a blank opens the next text.
    let closes = stop == "\"" && !rest[..length].ends_with(char::is_whitespace);
    closes.then_some(at + length)
}

/// The content and the end of a raw text `r#"..."#`, if one starts at the offset.
pub(super) fn raw_text(text: &str, at: usize) -> Option<Result<(Range<usize>, usize), Reported>> {
    let rest = text[at..].strip_prefix('r')?;
    let hashes = rest.len() - rest.trim_start_matches('#').len();
    let content = rest[hashes..].strip_prefix('"')?;
    let start = text.len() - content.len();
    let closing = format!("\"{}", &rest[..hashes]);
    Some(match content.find(&closing) {
        Some(length) => Ok((start..start + length, start + length + closing.len())),
        None => Err(Reported),
    })
}

/// Where a text in single quotes ends, on its own line.
pub(super) fn single_quoted_end(text: &str, start: usize) -> Option<usize> {
    let rest = &text[start + 1..];
    let escaped = if rest.starts_with("\\'") { 2 } else { 0 };
    let length = escaped + rest[escaped..].find(['\'', '\n'])?;
    rest[length..].starts_with('\'').then_some(start + 1 + length + 1)
}

/// The character an escape means and the length of what stands behind the backslash.
pub(super) fn escape(after: &str) -> Option<(char, usize)> {
    let hexadecimal = |digits: &str| {
        let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
        is_number.then(|| u32::from_str_radix(digits, 16).ok()).flatten().and_then(char::from_u32)
    };
    let plain = match after.bytes().next()? {
        b'n' => '\n',
        b'r' => '\r',
        b't' => '\t',
        b'0' => '\0',
        quoted @ (b'\\' | b'"' | b'\'') => quoted as char,
        b'x' => return Some((hexadecimal(after.get(1..3)?)?, 3)),
        b'u' => {
            let digits = after[1..].strip_prefix('{')?;
            // Six digits reach the last character.
            let length = digits.bytes().take(7).position(|byte| byte == b'}')?;
            return Some((hexadecimal(&digits[..length])?, length + 3));
        }
        _ => return None,
    };
    Some((plain, 1))
}

pub(super) fn number_literal(literal: &str) -> Option<ValueKind> {
    let clean = literal.replace('_', "");
    let unsigned = clean.strip_prefix(['+', '-']).unwrap_or(&clean);
    let sign = &clean[..clean.len() - unsigned.len()];
    let is_made_of = |set: &str| unsigned.chars().all(|c| c.is_ascii_digit() || set.contains(c));
    let prefix = unsigned.get(..2).unwrap_or("");
    let radix = [("0x", 16), ("0o", 8), ("0b", 2)].into_iter().find(|(name, _)| *name == prefix);
    if let Some((_, radix)) = radix {
        let digits = &unsigned[2..];
        let is_number = digits.starts_with(|c: char| c.is_ascii_hexdigit());
        let value = is_number.then(|| i64::from_str_radix(&format!("{sign}{digits}"), radix))?;
        value.ok().map(ValueKind::Integer)
    } else if is_made_of("") {
        clean.parse().ok().map(ValueKind::Integer)
    } else if is_made_of(".eE+-") || matches!(unsigned, "inf" | "NaN") {
        clean.parse().ok().map(ValueKind::Number)
    } else {
        None
    }
}

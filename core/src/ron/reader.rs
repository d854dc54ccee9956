//! The state of reading, faults, and single values.

use super::lexer::{
    Scan, escape, is_closer, number_literal, raw_text, scan_text, single_quoted_end, space_end,
    starts_word, unclosed_text_end, unopened_text_end, word_end,
};
use super::value::{Name, Value, ValueKind};
use super::{MAX_FAULTS, MAX_SHOWN_CHARS, shown};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{BYTE_ORDER_MARK, Source};
use std::fmt;
use std::mem;
use std::ops::Range;
use std::sync::Arc;

/// The fault has been reported already.
pub(super) struct Reported;

/// A bracket that is open.
#[derive(Clone, Copy)]
pub(super) struct Opener<'s> {
    pub(super) at: usize,
    pub(super) bracket: u8,
    /// The key or name it belongs to as written; empty if none.
    pub(super) owner: &'s str,
}

impl Opener<'_> {
    pub(super) fn closer(&self) -> char {
        match self.bracket {
            b'(' => ')',
            b'[' => ']',
            _ => '}',
        }
    }
}

/// "the `(` of smooth", or "this `(`".
impl fmt::Display for Opener<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.bracket as char, self.owner) {
            (bracket, "") => write!(f, "this `{bracket}`"),
            (bracket, owner) => write!(f, "the `{bracket}` of {}", shown(owner)),
        }
    }
}

/// How a key before a colon is written.
#[derive(PartialEq)]
pub(super) enum Key {
    Quoted,
    Bare,
    Number,
}

/// What stands between commas in `(...)`.
pub(super) enum Item {
    Field(Name, Value),
    Value(Value),
}

/// A text on its way to become a value.
pub(super) struct Reader<'s> {
    pub(super) source: &'s Arc<Source>,
    pub(super) text: &'s str,
    /// The next byte to read.
    pub(super) at: usize,
    /// The brackets open, outermost first.
    pub(super) openers: Vec<Opener<'s>>,
    /// The key of the value about to be read.
    pub(super) owner: &'s str,
    /// Where brackets were found not to match; those that end there too go without a report.
    pub(super) blamed: Option<usize>,
    /// The `{` whose keys were found to lack values; reported once.
    pub(super) listlike: Option<usize>,
    /// Brackets no longer match up, so nothing more is said about them.
    pub(super) lost: bool,
    pub(super) faults: Diagnostics,
}
impl<'s> Reader<'s> {
    pub(super) fn new(source: &'s Arc<Source>) -> Self {
        let text = source.text();
        let at = if text.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len_utf8() } else { 0 };
        Self {
            source,
            text,
            at,
            openers: Vec::new(),
            owner: "",
            blamed: None,
            listlike: None,
            lost: false,
            faults: Diagnostics::new(),
        }
    }

    pub(super) fn document(&mut self) -> Result<Value, Reported> {
        self.space();
        while self.rest().starts_with("#![") {
            let Some(length) = self.rest().find(']') else {
                return Err(self.report(self.at..self.at + 3, "this `#![` is never closed"));
            };
            self.at += length + 1;
            self.space();
        }
        let value = self.value("a value")?;
        self.space();
        if self.at < self.text.len() && !self.lost {
            self.expected("the end of the text");
        }
        Ok(value)
    }

    // Faults.

    pub(super) fn report(&mut self, range: Range<usize>, message: impl Into<String>) -> Reported {
        self.report_with_help(range, message, None)
    }

    pub(super) fn report_with_help(
        &mut self,
        range: Range<usize>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Reported {
        if self.faults.len() < MAX_FAULTS {
            let fault = Diagnostic::error(message).at(self.source.span(range));
            self.faults.push(Diagnostic { help: help.map(Into::into), ..fault });
        }
        if self.faults.len() == MAX_FAULTS {
            let message = format!("reading stopped at {MAX_FAULTS} faults");
            self.faults.push(Diagnostic::error(message).at(self.source.span(self.at..self.at)));
        }
        if self.faults.len() > MAX_FAULTS {
            self.stop();
        }
        Reported
    }

    /// Reports that something else stands here.
    pub(super) fn expected(&mut self, wanted: &str) -> Reported {
        let wrong_closer = self.byte(self.at).is_some_and(is_closer)
            && self.openers.last().is_some_and(|opener| !self.rest().starts_with(opener.closer()));
        // Of a closing bracket that does not match, and of what cannot be read, more is said where
        // it is found out.
        if wrong_closer || self.lost && self.at == self.text.len() {
            return Reported;
        }
        let (range, found) = self.found();
        let quotes = ['“', '”', '„', '‘', '’', '«', '»'];
        let help = if self.rest().starts_with(quotes) {
            Some("a text stands between straight double quotes: \"...\"".to_owned())
        } else {
            None
        };
        self.report_with_help(range, format!("expected {wanted}, found {found}"), help)
    }

    /// What stands here, in words.
    pub(super) fn found(&self) -> (Range<usize>, String) {
        let at = self.at;
        let word = word_end(self.text, at);
        match self.rest().chars().next() {
            None => {
                let end = self.text.trim_end().len();
                (end..end, "the end of the text".to_owned())
            }
            Some('"') => (at..at + 1, "a text".to_owned()),
            Some(_) if word > at => (at..word, format!("`{}`", shown(&self.text[at..word]))),
            Some(c) if c.is_control() => {
                (at..at + c.len_utf8(), format!("`{}`", c.escape_default()))
            }
            Some(c) => (at..at + c.len_utf8(), format!("`{c}`")),
        }
    }

    /// Nothing more can be read.
    pub(super) fn stop(&mut self) {
        self.at = self.text.len();
        self.lost = true;
    }

    // Bytes, blanks and looking ahead.

    pub(super) fn rest(&self) -> &'s str {
        &self.text[self.at..]
    }

    pub(super) fn byte(&self, at: usize) -> Option<u8> {
        self.text.as_bytes().get(at).copied()
    }

    /// Skips blanks and comments.
    pub(super) fn space(&mut self) {
        match space_end(self.text, self.at) {
            Ok(end) => self.at = end,
            Err(comment) => {
                self.report(comment..comment + 2, "this comment is never closed");
                self.stop();
            }
        }
    }

    /// The first byte behind blanks and comments.
    pub(super) fn after_space(&self, at: usize) -> usize {
        space_end(self.text, at).unwrap_or(self.text.len())
    }
    pub(super) fn value(&mut self, wanted: &str) -> Result<Value, Reported> {
        let owner = mem::take(&mut self.owner);
        self.space();
        let start = self.at;
        let kind = match self.byte(start) {
            Some(b'"') => ValueKind::Text(self.quoted_text(wanted == "a key")?),
            Some(b'\'') => self.single_quoted()?,
            Some(b'[') => {
                let opener = self.opener(owner);
                ValueKind::List(self.bracket(opener, |reader| reader.value("a value"))?)
            }
            Some(b'{') => {
                let opener = self.opener(owner);
                self.map(opener)?
            }
            Some(b'(') => {
                let opener = self.opener(owner);
                self.group(None, opener)?
            }
            Some(b'0'..=b'9' | b'+' | b'-' | b'.') => self.number()?,
            Some(b'r') if raw_text(self.text, start).is_some() => self.raw_text()?,
            Some(byte) if starts_word(byte) && word_end(self.text, start) > start => self.word()?,
            _ => return Err(self.expected(wanted)),
        };
        Ok(Value { kind, span: self.source.span(start..self.at) })
    }

    pub(super) fn word(&mut self) -> Result<ValueKind, Reported> {
        let start = self.at;
        self.at = word_end(self.text, start);
        let word = &self.text[start..self.at];
        if let Some(end) = unopened_text_end(self.text, self.at) {
            let text = &self.text[start..end];
            self.report(start..end, format!("`{}` lacks its opening quote", shown(text)));
            self.at = self.at.max(end + 1);
            return Ok(ValueKind::Text(text.to_owned()));
        }
        let group = self.after_space(self.at);
        if self.byte(group) == Some(b'(') {
            let name = self.name(start..self.at);
            self.at = group;
            let opener = self.opener(word);
            return self.group(Some(name), opener);
        }
        Ok(match word {
            "true" => ValueKind::Bool(true),
            "false" => ValueKind::Bool(false),
            "inf" => ValueKind::Number(f64::INFINITY),
            "NaN" => ValueKind::Number(f64::NAN),
            _ => ValueKind::Word(word.to_owned()),
        })
    }

    pub(super) fn name(&self, range: Range<usize>) -> Name {
        Name { text: self.text[range.clone()].to_owned(), span: self.source.span(range) }
    }

    pub(super) fn number(&mut self) -> Result<ValueKind, Reported> {
        let start = self.at;
        let mut before = b'e';
        let hexadecimal = self.rest().trim_start_matches(['+', '-']).starts_with("0x");
        let length = self.rest().find(|c: char| {
            let exponent = matches!(mem::replace(&mut before, c as u8), b'e' | b'E');
            let sign = matches!(c, '+' | '-') && exponent && !hexadecimal;
            !(c.is_alphanumeric() || matches!(c, '_' | '.' | '%' | '°') || sign)
        });
        self.at = length.map_or(self.text.len(), |length| start + length);
        let literal = &self.text[start..self.at];
        if let Some(kind) = number_literal(literal) {
            return Ok(kind);
        }
        let message = format!("`{}` is not a number", shown(literal));
        let digits = literal.trim_start_matches(['+', '-']);
        let help = if digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'_') {
            (!digits.is_empty())
                .then(|| "whole numbers have 64 bits; larger ones are written as 1e20".to_owned())
        } else {
            let unit = digits.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
            let tail = self.rest().find(|c: char| c.is_whitespace() || ",)]}".contains(c));
            let end = self.at + tail.unwrap_or(self.rest().len().min(MAX_SHOWN_CHARS));
            let has_unit = unit.len() < digits.len() && !unit.is_empty() && !hexadecimal;
            has_unit.then(|| {
                let written = self.source.span(start..end);
                format!("a number with a unit is a text: write \"{}\"", shown(written.text()))
            })
        };
        Err(self.report_with_help(start..start + literal.len(), message, help))
    }

    pub(super) fn single_quoted(&mut self) -> Result<ValueKind, Reported> {
        let start = self.at;
        let Some(end) = single_quoted_end(self.text, start) else {
            return Err(self.report(start..start + 1, "this `'` is never closed"));
        };
        self.at = end;
        let text = &self.text[start + 1..end - 1];
        let mut chars = text.chars();
        let help = match (chars.next(), chars.next()) {
            (Some(c), None) => return Ok(ValueKind::Char(c)),
            (Some('\\'), Some(_)) => match escape(&text[1..]) {
                Some((c, length)) if length + 1 == text.len() => return Ok(ValueKind::Char(c)),
                _ => None,
            },
            _ => Some(format!("write \"{}\"", shown(text))),
        };
        self.report_with_help(start..end, "a text stands between double quotes", help);
        Ok(ValueKind::Text(text.to_owned()))
    }

    pub(super) fn raw_text(&mut self) -> Result<ValueKind, Reported> {
        let start = self.at;
        let Some(Ok((text, end))) = raw_text(self.text, start) else {
            let fault = self.report(start..start + 1, "this text has no closing quote");
            self.stop();
            return Err(fault);
        };
        self.at = end;
        Ok(ValueKind::Text(self.text[text].to_owned()))
    }

    pub(super) fn quoted_text(&mut self, is_key: bool) -> Result<String, Reported> {
        let start = self.at;
        match scan_text(self.text, start) {
            Scan::Closed(end) => {
                self.at = end;
                let is_doubled = self.byte(end) == Some(b'"')
                    && !matches!(scan_text(self.text, end), Scan::Closed(_));
                if is_doubled {
                    self.at += 1;
                    self.report(end..end + 1, "one `\"` too many");
                }
                Ok(self.unescaped(start + 1..end - 1))
            }
            Scan::Swallowing(next) if next == start + 1 => {
                self.report(start..next, "one `\"` too many");
                self.at = next;
                self.quoted_text(is_key)
            }
            Scan::Swallowing(next) => {
                self.report(start..start + 1, "this text has no closing quote");
                self.at = unclosed_text_end(self.text, start + 1..next, is_key);
                Ok(self.text[start + 1..self.at].to_owned())
            }
            Scan::Unclosed => {
                let fault = self.report(start..start + 1, "this text has no closing quote");
                self.stop();
                Err(fault)
            }
        }
    }

    /// The text with its escapes replaced; of several bad ones the first is reported.
    pub(super) fn unescaped(&mut self, range: Range<usize>) -> String {
        let mut rest = &self.text[range.clone()];
        let mut out = String::with_capacity(rest.len());
        let mut is_bad = false;
        while let Some(before) = rest.find('\\') {
            out.push_str(&rest[..before]);
            let after = &rest[before + 1..];
            let (c, length) = escape(after).unwrap_or_else(|| {
                let at = range.end - after.len();
                let length = after.chars().next().map_or(0, char::len_utf8);
                if !mem::replace(&mut is_bad, true) {
                    let message = format!("bad escape `\\{}`", shown(&after[..length]));
                    let help = "write \\\\ for a backslash; paths may use / instead".to_owned();
                    self.report_with_help(at - 1..at + length, message, Some(help));
                }
                ('\\', 0)
            });
            out.push(c);
            rest = &after[length..];
        }
        out.push_str(rest);
        out
    }
}

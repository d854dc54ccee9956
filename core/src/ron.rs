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

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt;
use std::mem;
use std::ops::Range;
use std::sync::Arc;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{BYTE_ORDER_MARK, Source, Span};

/// The longest text read, 4 MiB: a recipe of 10,000 nodes has less than half of it.
pub const MAX_TEXT_BYTES: usize = 4 << 20;

/// The deepest nesting of brackets read: a recipe has 5 levels, and 64 are safe on any stack.
pub const MAX_DEPTH: usize = 64;

/// Reading stops at so many faults.
pub const MAX_FAULTS: usize = 100;

/// Longer excerpts are cut in messages.
const MAX_SHOWN_CHARS: usize = 40;

/// Blanks looked at to compare indentations; a bound, so that a line of a million does not cost
/// a million times its length.
const MAX_INDENT: usize = 200;

/// A value and its place.
#[derive(Clone, Debug)]
pub struct Value {
    /// What it is.
    pub kind: ValueKind,
    /// Where it stands, brackets and quotes included.
    pub span: Span,
}

/// What a value is.
#[derive(Clone, Debug)]
pub enum ValueKind {
    /// `()`
    Unit,
    /// `true` or `false`
    Bool(bool),
    /// A number written without fraction or exponent.
    Integer(i64),
    /// Any other number, infinities and NaN included.
    Number(f64),
    /// `'a'`
    Char(char),
    /// `"text"` or `r#"text"#`, without escapes.
    Text(String),
    /// A bare word, such as the unit variant `None`.
    Word(String),
    /// `[a, b]`
    List(Vec<Value>),
    /// `{a: b}` in the order written; the keys differ.
    Map(Vec<(Value, Value)>),
    /// `Name(field: value)` or `(field: value)` in the order written; the names differ.
    Struct {
        /// The word before the bracket.
        name: Option<(String, Span)>,
        /// Names, their places, and what stands behind the colons.
        fields: Vec<(String, Span, Value)>,
    },
    /// `Name(a, b)` or `(a, b)`
    Tuple {
        /// The word before the bracket.
        name: Option<(String, Span)>,
        /// What stands in the brackets.
        items: Vec<Value>,
    },
}

impl Value {
    /// The kind with its article, for messages: "a number", "a list [...]".
    pub fn describe(&self) -> &'static str {
        match &self.kind {
            ValueKind::Unit => "an empty ()",
            ValueKind::Bool(_) => "true or false",
            ValueKind::Integer(_) => "a whole number",
            ValueKind::Number(_) => "a number",
            ValueKind::Char(_) => "a character in single quotes",
            ValueKind::Text(_) => "a text",
            ValueKind::Word(_) => "a bare word",
            ValueKind::List(_) => "a list [...]",
            ValueKind::Map(_) => "a map {...}",
            ValueKind::Struct { .. } => "fields in (...)",
            ValueKind::Tuple { .. } => "values in (...)",
        }
    }

    /// The text, if it is one.
    pub fn as_str(&self) -> Option<&str> {
        match &self.kind {
            ValueKind::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The truth value, if it is one.
    pub fn as_bool(&self) -> Option<bool> {
        match self.kind {
            ValueKind::Bool(value) => Some(value),
            _ => None,
        }
    }

    /// The number, if it is one, whole or not; it may be infinite or NaN.
    pub fn as_number(&self) -> Option<f64> {
        match self.kind {
            ValueKind::Integer(value) => Some(value as f64),
            ValueKind::Number(value) => Some(value),
            _ => None,
        }
    }

    /// The text, or the fault that `what`, such as `"kind"`, must be one.
    pub fn as_text(&self, what: &str) -> Result<&str, Diagnostic> {
        self.as_str().ok_or_else(|| {
            let fault = self.mismatch(what, "a text in double quotes");
            let written = shown(self.span.text());
            match &self.kind {
                ValueKind::Char(c) => fault.help(format!("write \"{c}\"")),
                ValueKind::Bool(_)
                | ValueKind::Integer(_)
                | ValueKind::Number(_)
                | ValueKind::Word(_) => fault.help(format!("write \"{written}\"")),
                _ => fault,
            }
        })
    }

    /// The fault that `what` must be of another kind than the value is, such as "a number".
    pub fn mismatch(&self, what: &str, wanted: &str) -> Diagnostic {
        let found = self.describe();
        Diagnostic::error(format!("{what} must be {wanted}, not {found}")).at(self.span.clone())
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
    let start = if text.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len_utf8() } else { 0 };
    let mut reader = Reader {
        source,
        text,
        at: start,
        openers: Vec::new(),
        owner: "",
        blamed: None,
        listlike: None,
        lost: false,
        faults: Diagnostics::new(),
    };
    let value = reader.document();
    match value {
        Ok(value) if reader.faults.is_empty() => Ok(value),
        _ => Err(reader.faults),
    }
}

/// The fault has been reported already.
struct Reported;

/// A bracket that is open.
#[derive(Clone, Copy)]
struct Opener<'s> {
    at: usize,
    bracket: u8,
    /// The key or name it belongs to as written; empty if none.
    owner: &'s str,
}

impl Opener<'_> {
    fn closer(&self) -> char {
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
enum Key {
    Quoted,
    Bare,
    Number,
}

/// What stands between commas in `(...)`.
enum Item {
    Field((String, Span, Value)),
    Value(Value),
}

struct Reader<'s> {
    source: &'s Arc<Source>,
    text: &'s str,
    /// The next byte to read.
    at: usize,
    /// The brackets open, outermost first.
    openers: Vec<Opener<'s>>,
    /// The key of the value about to be read.
    owner: &'s str,
    /// Where brackets were found not to match; those that end there too go without a report.
    blamed: Option<usize>,
    /// The `{` whose keys were found to lack values; reported once.
    listlike: Option<usize>,
    /// Brackets no longer match up, so nothing more is said about them.
    lost: bool,
    faults: Diagnostics,
}

impl<'s> Reader<'s> {
    fn document(&mut self) -> Result<Value, Reported> {
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

    fn report(&mut self, range: Range<usize>, message: impl Into<String>) -> Reported {
        self.report_with_help(range, message, None)
    }

    fn report_with_help(
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
    fn expected(&mut self, wanted: &str) -> Reported {
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
    fn found(&self) -> (Range<usize>, String) {
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
    fn stop(&mut self) {
        self.at = self.text.len();
        self.lost = true;
    }

    // Bytes, blanks and looking ahead.

    fn rest(&self) -> &'s str {
        &self.text[self.at..]
    }

    fn byte(&self, at: usize) -> Option<u8> {
        self.text.as_bytes().get(at).copied()
    }

    /// Skips blanks and comments.
    fn space(&mut self) {
        match space_end(self.text, self.at) {
            Ok(end) => self.at = end,
            Err(comment) => {
                self.report(comment..comment + 2, "this comment is never closed");
                self.stop();
            }
        }
    }

    /// The first byte behind blanks and comments.
    fn after_space(&self, at: usize) -> usize {
        space_end(self.text, at).unwrap_or(self.text.len())
    }

    /// The key at an offset, if one and its colon stand there.
    fn key_at(&self, at: usize) -> Option<Key> {
        let (key, end) = match self.byte(at)? {
            b'"' => match scan_text(self.text, at) {
                Scan::Closed(end) => (Key::Quoted, end),
                _ => return None,
            },
            byte if byte.is_ascii_digit() => (Key::Number, word_end(self.text, at)),
            _ => (Key::Bare, word_end(self.text, at)),
        };
        let colon = matches!(self.byte(self.after_space(end)), Some(b':' | b'='));
        (end > at && colon).then_some(key)
    }

    /// Whether what stands at an offset is clearly an item for the bracket.
    fn is_item(&self, opener: &Opener<'s>, at: usize) -> bool {
        match opener.bracket {
            b'[' => self.byte(at).is_some_and(starts_literal) || self.byte(at) == Some(b'('),
            b'(' => self.key_at(at).is_some_and(|key| key != Key::Number),
            _ => self.key_at(at).is_some(),
        }
    }

    /// Whether a key that cannot belong to the bracket stands here, so that the closing bracket was
    /// forgotten before it. That is so in a list if the bracket around it takes such keys, and in
    /// any if the key starts a line that is indented no deeper than the bracket's.
    fn is_outside(&self, opener: &Opener<'s>, at: usize) -> bool {
        let (key, around) = match self.byte(at) {
            Some(b'"') => (Key::Quoted, b'{'),
            Some(byte) if starts_word(byte) => (Key::Bare, b'('),
            _ => return false,
        };
        let outer = self.openers.len().checked_sub(2).map(|index| self.openers[index].bracket);
        let is_foreign = match opener.bracket {
            b'[' => outer == Some(around) || self.is_dedented(opener, at),
            bracket => bracket != around && self.is_dedented(opener, at),
        };
        is_foreign && self.key_at(at) == Some(key)
    }

    /// Whether a line starts here that is indented no deeper than the one of the bracket.
    fn is_dedented(&self, opener: &Opener<'s>, at: usize) -> bool {
        self.indents(opener, at).is_some_and(|(inner, outer)| inner <= outer)
    }

    /// The blanks before what stands here and before the line of the bracket, if a later line
    /// starts here. Where there is no indentation it means nothing, and none is told.
    fn indents(&self, opener: &Opener<'s>, at: usize) -> Option<(usize, usize)> {
        let is_blank = |byte: &&u8| matches!(byte, b' ' | b'\t');
        let bytes = self.text.as_bytes();
        let line = self.source.line_range(self.source.line_number(opener.at));
        let outer = bytes[line.start..].iter().take(MAX_INDENT).take_while(is_blank).count();
        let inner = bytes[..at].iter().rev().take(MAX_INDENT).take_while(is_blank).count();
        let starts_line = at > line.end && bytes[at - inner - 1] == b'\n';
        (starts_line && outer > 0).then_some((inner, outer))
    }

    /// Whether what follows a closing bracket could go on inside `opener`, or end the text if none.
    fn goes_on(&self, opener: Option<&Opener<'s>>, at: usize) -> bool {
        let at = self.after_space(at);
        let Some(opener) = opener else { return at == self.text.len() };
        let next = if self.byte(at) == Some(b',') { self.after_space(at + 1) } else { at };
        let closes = self.byte(next) == Some(opener.closer() as u8);
        closes || next > at && self.is_item(opener, next)
    }

    // Values.

    fn value(&mut self, wanted: &str) -> Result<Value, Reported> {
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

    fn word(&mut self) -> Result<ValueKind, Reported> {
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

    fn name(&self, range: Range<usize>) -> (String, Span) {
        (self.text[range.clone()].to_owned(), self.source.span(range))
    }

    fn number(&mut self) -> Result<ValueKind, Reported> {
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

    fn single_quoted(&mut self) -> Result<ValueKind, Reported> {
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

    fn raw_text(&mut self) -> Result<ValueKind, Reported> {
        let start = self.at;
        let Some(Ok((text, end))) = raw_text(self.text, start) else {
            let fault = self.report(start..start + 1, "this text has no closing quote");
            self.stop();
            return Err(fault);
        };
        self.at = end;
        Ok(ValueKind::Text(self.text[text].to_owned()))
    }

    fn quoted_text(&mut self, is_key: bool) -> Result<String, Reported> {
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
    fn unescaped(&mut self, range: Range<usize>) -> String {
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

    // Brackets.

    fn map(&mut self, opener: Opener<'s>) -> Result<ValueKind, Reported> {
        let next = self.after_space(self.at);
        if self.byte(next) == Some(b'{') {
            self.at = next + 1;
            self.report(opener.at..opener.at + 1, "one `{` too many");
        }
        let entries = self.bracket(opener, Self::entry)?;
        self.refuse_duplicates("key", entries.iter().map(|(key, _)| (sameness(key), &key.span)));
        Ok(ValueKind::Map(entries))
    }

    fn entry(&mut self) -> Result<(Value, Value), Reported> {
        let mut key = self.value("a key")?;
        self.colon()?;
        if let ValueKind::Word(word) = &key.kind {
            let help = format!("write \"{}\"", shown(word));
            let range = key.span.start..key.span.end;
            key.kind = ValueKind::Text(word.clone());
            self.report_with_help(range, "a key of a map stands in quotes", Some(help));
        }
        self.owner = &self.text[key.span.start..key.span.end];
        Ok((key, self.content()?))
    }

    fn group(
        &mut self,
        name: Option<(String, Span)>,
        opener: Opener<'s>,
    ) -> Result<ValueKind, Reported> {
        let (mut fields, mut items) = (Vec::new(), Vec::new());
        for item in self.bracket(opener, Self::group_item)? {
            match item {
                Item::Field(field) => fields.push(field),
                Item::Value(value) => items.push(value),
            }
        }
        if fields.is_empty() {
            return Ok(match (name, items.is_empty()) {
                (None, true) => ValueKind::Unit,
                (name, true) => ValueKind::Struct { name, fields },
                (name, false) => ValueKind::Tuple { name, items },
            });
        }
        for value in items {
            let range = value.span.start..value.span.end;
            self.report(range, "a name and a `:` are missing before this value");
        }
        let names = fields.iter().map(|(name, span, _)| (Same::Text(name), span));
        self.refuse_duplicates("field", names);
        Ok(ValueKind::Struct { name, fields })
    }

    fn group_item(&mut self) -> Result<Item, Reported> {
        let start = self.at;
        let range = match self.key_at(start) {
            Some(Key::Quoted) => {
                let Scan::Closed(end) = scan_text(self.text, start) else { unreachable!() };
                let name = &self.text[start + 1..end - 1];
                let help = Some(format!("write {}", shown(name)));
                self.report_with_help(
                    start..end,
                    "the name of a field stands without quotes",
                    help,
                );
                self.at = end;
                start + 1..end - 1
            }
            Some(Key::Bare) => start..word_end(self.text, start),
            _ if self.lacks_colon(start) => start..word_end(self.text, start),
            _ => return self.value("a value").map(Item::Value),
        };
        self.at = self.at.max(range.end);
        self.colon()?;
        self.owner = &self.text[range.clone()];
        let (name, span) = self.name(range);
        Ok(Item::Field((name, span, self.content()?)))
    }

    /// Reads the value behind a colon. If another key stands there the bracket before it was
    /// forgotten, and is taken as read.
    fn content(&mut self) -> Result<Value, Reported> {
        self.space();
        let start = self.at;
        let bracket = match self.key_at(start) {
            Some(Key::Bare) => b'(',
            Some(Key::Quoted) => b'{',
            _ => return self.value("a value"),
        };
        self.report(start..start, format!("a `{}` is missing here", bracket as char));
        self.lost = true;
        let opener = Opener { at: start, bracket, owner: mem::take(&mut self.owner) };
        let kind = if bracket == b'{' { self.map(opener)? } else { self.group(None, opener)? };
        Ok(Value { kind, span: self.source.span(start..self.at) })
    }

    /// Whether a word and behind it a value stand here.
    fn lacks_colon(&self, at: usize) -> bool {
        let end = word_end(self.text, at);
        let next = self.after_space(end);
        let is_word = self.byte(at).is_some_and(starts_word) && next > end;
        is_word && self.byte(next).is_some_and(starts_literal)
    }

    /// Reads the `:` between a key and its value.
    fn colon(&mut self) -> Result<(), Reported> {
        let end = self.at;
        self.space();
        match self.byte(self.at) {
            Some(b':') => self.at += 1,
            Some(b'=') => {
                let arrow = self.rest().starts_with("=>") || self.rest().starts_with("==");
                let length = 1 + usize::from(arrow);
                let found = &self.rest()[..length];
                self.report(self.at..self.at + length, format!("expected `:`, found `{found}`"));
                self.at = (self.at + length).min(self.text.len());
            }
            Some(byte) if starts_literal(byte) || starts_word(byte) || byte == b'(' => {
                self.report(end..end, "a `:` is missing here");
            }
            Some(b',' | b'}') => {
                let opener = self.openers.last().map(|opener| opener.at);
                if mem::replace(&mut self.listlike, opener) != opener {
                    let help = "a map is {key: value, ...}; a list is [value, ...]".to_owned();
                    let (range, found) = self.found();
                    let message = format!("expected `:` and a value, found {found}");
                    return Err(self.report_with_help(range, message, Some(help)));
                }
                return Err(Reported);
            }
            _ => return Err(self.expected("`:`")),
        }
        Ok(())
    }

    /// The bracket that stands here, taken.
    fn opener(&mut self, owner: &'s str) -> Opener<'s> {
        let opener = Opener { at: self.at, bracket: self.text.as_bytes()[self.at], owner };
        self.at += 1;
        opener
    }

    /// Reads the items up to the partner of a bracket.
    fn bracket<T>(
        &mut self,
        opener: Opener<'s>,
        item: impl FnMut(&mut Self) -> Result<T, Reported>,
    ) -> Result<Vec<T>, Reported> {
        if self.openers.len() == MAX_DEPTH {
            // What is skipped now starts with the bracket.
            self.at = opener.at;
            let message = format!("brackets nest deeper than {MAX_DEPTH} levels");
            return Err(self.report(self.at..self.at + 1, message));
        }
        self.openers.push(opener);
        let items = self.items(opener, item);
        self.openers.pop();
        Ok(items)
    }

    fn items<T>(
        &mut self,
        opener: Opener<'s>,
        mut item: impl FnMut(&mut Self) -> Result<T, Reported>,
    ) -> Vec<T> {
        let mut items = Vec::new();
        loop {
            self.space();
            match self.byte(self.at) {
                None => {
                    self.unclosed(&opener, "the end of the text");
                    self.lost = true;
                    return items;
                }
                Some(byte) if byte == opener.closer() as u8 => {
                    self.at += 1;
                    return items;
                }
                Some(byte) if is_closer(byte) => {
                    if self.ends_at_wrong_closer(&opener, byte) {
                        return items;
                    }
                    continue;
                }
                Some(_) if self.is_outside(&opener, self.at) => {
                    let line = self.source.line_number(self.at);
                    let (_, found) = self.found();
                    self.unclosed(&opener, &format!("{found} on line {line}"));
                    return items;
                }
                Some(_) => {}
            }
            match item(self) {
                Ok(item) => items.push(item),
                Err(Reported) => self.skip_item(),
            }
            self.separator(&opener);
        }
    }

    /// Reads what stands between two items.
    fn separator(&mut self, opener: &Opener<'s>) {
        let end = self.at;
        self.space();
        let next = self.at;
        match self.byte(next) {
            Some(b',') => self.at += 1,
            None => {}
            Some(byte) if is_closer(byte) => {}
            Some(b';') => {
                self.at += 1;
                self.report(next..next + 1, "expected `,`, found `;`");
            }
            // The lost bracket has been reported, or is about to be.
            Some(_) if self.blamed == Some(next) || self.is_outside(opener, next) => {}
            Some(_) if self.is_item(opener, next) => {
                self.report(end..end, "a `,` is missing here");
            }
            Some(_) => {
                self.expected(&format!("`,` or `{}`", opener.closer()));
                self.skip_item();
                if self.byte(self.at) == Some(b',') {
                    self.at += 1;
                }
            }
        }
    }

    fn unclosed(&mut self, opener: &Opener<'s>, before: &str) {
        if !self.lost && self.blamed.replace(self.at) != Some(self.at) {
            let message = format!("{opener} is never closed");
            let help = format!("`{}` is missing before {before}", opener.closer());
            self.report_with_help(opener.at..opener.at + 1, message, Some(help));
        }
    }

    /// Handles a closing bracket that does not match `opener`; whether the items end here. What
    /// follows it tells whether the right one is missing before it, or it is surplus, or mistyped.
    fn ends_at_wrong_closer(&mut self, opener: &Opener<'s>, byte: u8) -> bool {
        let at = self.at;
        let outer = &self.openers[..self.openers.len() - 1];
        let partner = outer.iter().rposition(|outer| outer.closer() as u8 == byte);
        if self.lost || self.blamed == Some(at) {
            self.at += usize::from(partner.is_none());
            return partner.is_some();
        }
        let closer = byte as char;
        let line = self.source.line_number(at);
        let around = partner.map(|index| index.checked_sub(1).map(|index| &outer[index]));
        if !self.is_inside(opener, at + 1)
            && around.is_some_and(|around| self.goes_on(around, at + 1))
        {
            self.unclosed(opener, &format!("the `{closer}` on line {line}"));
            return true;
        }
        if self.goes_on(Some(opener), at + 1) {
            self.report(at..at + 1, format!("this `{closer}` closes nothing"));
            self.at = self.after_space(at + 1);
            self.at += usize::from(self.byte(self.at) == Some(b','));
            return false;
        }
        if partner.is_none() || self.goes_on(outer.last(), at + 1) {
            self.at += 1;
            let message = format!("{opener} is closed by `{closer}`, not `{}`", opener.closer());
            self.report(at..at + 1, message);
            return true;
        }
        self.unclosed(opener, &format!("the `{closer}` on line {line}"));
        self.lost = true;
        true
    }

    /// Whether what follows a closing bracket goes on inside `opener` without doubt: the right
    /// closing bracket on the same line, or something on a line indented as it should be.
    fn is_inside(&self, opener: &Opener<'s>, at: usize) -> bool {
        let next = self.after_space(at);
        if !self.goes_on(Some(opener), at) {
            return false;
        }
        if self.byte(next) == Some(b',') {
            let next = self.after_space(next + 1);
            let deepest = usize::from(self.byte(next) == Some(opener.closer() as u8));
            let indents = self.indents(opener, next);
            return indents.is_some_and(|(inner, outer)| inner + deepest > outer);
        }
        self.source.line_number(at) == self.source.line_number(next)
    }

    /// Skips to the `,` or closing bracket that ends the item, or to the end of the text.
    fn skip_item(&mut self) {
        let mut depth = 0_usize;
        loop {
            self.space();
            let Some(byte) = self.byte(self.at) else {
                self.lost = true;
                return;
            };
            self.at = match byte {
                b',' if depth == 0 => return,
                b'"' => match scan_text(self.text, self.at) {
                    Scan::Closed(end) => end,
                    Scan::Swallowing(_) => self.at + 1,
                    Scan::Unclosed => self.text.len(),
                },
                b'\'' => single_quoted_end(self.text, self.at).unwrap_or(self.at + 1),
                b'(' | b'[' | b'{' => {
                    depth += 1;
                    self.at + 1
                }
                byte if is_closer(byte) => match depth.checked_sub(1) {
                    None => return,
                    Some(outer) => {
                        depth = outer;
                        self.at + 1
                    }
                },
                _ => match raw_text(self.text, self.at) {
                    Some(Ok((_, end))) => end,
                    Some(Err(Reported)) => self.text.len(),
                    None => {
                        let c = self.rest().chars().next().map_or(1, char::len_utf8);
                        word_end(self.text, self.at).max(self.at + c)
                    }
                },
            };
        }
    }

    fn refuse_duplicates<'a>(
        &mut self,
        what: &str,
        keys: impl Iterator<Item = (Same<'a>, &'a Span)>,
    ) {
        let mut first = HashMap::new();
        for (key, span) in keys {
            match first.entry(key) {
                Entry::Vacant(entry) => _ = entry.insert(span.start),
                Entry::Occupied(entry) => {
                    let line = self.source.line_number(*entry.get());
                    let key = shown(&self.text[span.start..span.end]);
                    let message = format!("duplicate {what} {key}; the first is on line {line}");
                    self.report(span.start..span.end, message);
                }
            }
        }
    }
}

/// What makes two keys the same.
#[derive(PartialEq, Eq, Hash)]
enum Same<'a> {
    Text(&'a str),
    Integer(i64),
    /// Anything else is compared as written.
    Written(&'a str),
}

fn sameness(key: &Value) -> Same<'_> {
    match &key.kind {
        ValueKind::Text(text) => Same::Text(text),
        ValueKind::Integer(value) => Same::Integer(*value),
        _ => Same::Written(key.span.text()),
    }
}

/// The text, cut to a length fit for a message.
fn shown(text: &str) -> String {
    match text.char_indices().nth(MAX_SHOWN_CHARS) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

fn is_closer(byte: u8) -> bool {
    matches!(byte, b')' | b']' | b'}')
}

/// Whether a byte can start a word; those beyond ASCII need a look at the character.
fn starts_word(byte: u8) -> bool {
    byte.is_ascii_alphabetic() || byte == b'_' || !byte.is_ascii()
}

/// Whether a value other than a word or a group starts with the byte.
fn starts_literal(byte: u8) -> bool {
    matches!(byte, b'"' | b'\'' | b'[' | b'{' | b'0'..=b'9' | b'+' | b'-' | b'.')
}

/// Where the word at an offset ends; there if none stands there.
fn word_end(text: &str, at: usize) -> usize {
    let rest = &text[at..];
    at + rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len())
}

/// The first byte behind blanks and comments, or the start of a comment that is never closed.
fn space_end(text: &str, mut at: usize) -> Result<usize, usize> {
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
fn comment_end(text: &str, at: usize) -> Option<usize> {
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
enum Scan {
    /// Behind the closing quote.
    Closed(usize),
    /// The next quote, which opens another text: something that never follows a closing quote
    /// stands behind it. So the closing quote was forgotten.
    Swallowing(usize),
    /// There is no further quote.
    Unclosed,
}

fn scan_text(text: &str, start: usize) -> Scan {
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
fn unclosed_text_end(text: &str, range: Range<usize>, is_key: bool) -> usize {
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
fn unopened_text_end(text: &str, at: usize) -> Option<usize> {
    let rest = &text[at..];
    let (length, stop) = rest
        .match_indices(['"', '\n', ',', ':', ';', '=', '(', ')', '[', ']', '{', '}', '/'])
        .find(|&(at, stop)| stop != "/" || rest[at + 1..].starts_with(['/', '*']))?;
    // A quote behind a blank opens the next text.
    let closes = stop == "\"" && !rest[..length].ends_with(char::is_whitespace);
    closes.then_some(at + length)
}

/// The content and the end of a raw text `r#"..."#`, if one starts at the offset.
fn raw_text(text: &str, at: usize) -> Option<Result<(Range<usize>, usize), Reported>> {
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
fn single_quoted_end(text: &str, start: usize) -> Option<usize> {
    let rest = &text[start + 1..];
    let escaped = if rest.starts_with("\\'") { 2 } else { 0 };
    let length = escaped + rest[escaped..].find(['\'', '\n'])?;
    rest[length..].starts_with('\'').then_some(start + 1 + length + 1)
}

/// The character an escape means and the length of what stands behind the backslash.
fn escape(after: &str) -> Option<(char, usize)> {
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

fn number_literal(literal: &str) -> Option<ValueKind> {
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

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    fn read(text: impl Into<String>) -> Result<Value, Diagnostics> {
        parse(&Arc::new(Source::new("t.ron", text)))
    }

    /// A value without its places, in the notation of Rust.
    fn outline(value: &Value) -> String {
        let all = |values: &[Value]| values.iter().map(outline).collect::<Vec<_>>().join(", ");
        let name = || value.name_for_tests();
        match &value.kind {
            ValueKind::Unit => "()".to_owned(),
            ValueKind::Bool(value) => value.to_string(),
            ValueKind::Integer(value) => value.to_string(),
            ValueKind::Number(value) => format!("{value:?}"),
            ValueKind::Char(value) => format!("{value:?}"),
            ValueKind::Text(value) => format!("{value:?}"),
            ValueKind::Word(value) => value.clone(),
            ValueKind::List(items) => format!("[{}]", all(items)),
            ValueKind::Tuple { items, .. } => format!("{}({})", name(), all(items)),
            ValueKind::Map(entries) => {
                let entry = |(key, value): &_| format!("{}: {}", outline(key), outline(value));
                format!("{{{}}}", entries.iter().map(entry).collect::<Vec<_>>().join(", "))
            }
            ValueKind::Struct { fields, .. } => {
                let field =
                    |(name, _, value): &(String, _, _)| format!("{name}: {}", outline(value));
                let fields = fields.iter().map(field).collect::<Vec<_>>().join(", ");
                format!("{}({fields})", name())
            }
        }
    }

    impl Value {
        fn name_for_tests(&self) -> &str {
            match &self.kind {
                ValueKind::Struct { name, .. } | ValueKind::Tuple { name, .. } => {
                    name.as_ref().map_or("", |(name, _)| name)
                }
                _ => "",
            }
        }
    }

    #[track_caller]
    fn check(text: &str, expected: &str) {
        match read(text) {
            Ok(value) => assert_eq!(outline(&value), expected, "{text}"),
            Err(faults) => panic!("{faults}"),
        }
    }

    /// Compares all the faults, each as `line:column message` and `; help` if any.
    #[track_caller]
    fn check_faults(text: &str, expected: &[&str]) {
        let faults = read(text).map(|value| outline(&value)).expect_err(text);
        let lines: Vec<_> = faults
            .sorted()
            .into_iter()
            .map(|fault| {
                let place = fault.span.as_ref().map(ToString::to_string).unwrap_or_default();
                let help = fault.help.as_ref().map(|help| format!("; {help}")).unwrap_or_default();
                format!("{} {}{help}", place.trim_start_matches("t.ron:"), fault.message)
            })
            .collect();
        assert_eq!(lines, expected, "{text}\n{faults}");
    }

    #[test]
    fn every_kind_of_value_is_read() {
        check("()", "()");
        check(" true ", "true");
        check("[1, -2, +3, 1_000, 0x1f, -0o17, 0b101,]", "[1, -2, 3, 1000, 31, -15, 5]");
        check("-9223372036854775808", "-9223372036854775808");
        check(
            "[1.0, .5, 5., 1e3, -1.5E-2, 1_0.0, inf, -inf, NaN]",
            "[1.0, 0.5, 5.0, 1000.0, -0.015, 10.0, inf, -inf, NaN]",
        );
        check(r#""a\n\t\r\0\\\"\'\u{b5}\x41é""#, r#""a\n\t\r\0\\\"'µAé""#);
        check("\"a\nb\"", r#""a\nb""#);
        check(r###"[r"a\b", r#"a"b"#, r##"a"#b"##]"###, r###"["a\\b", "a\"b", "a\"#b"]"###);
        check(r"['a', 'é', '\n', '\'', '\u{b5}']", r"['a', 'é', '\n', '\'', 'µ']");
        check(r#"{"a": 1, 2: [], (): {}, 'c': ()}"#, r#"{"a": 1, 2: [], (): {}, 'c': ()}"#);
        check("Recipe(a: 1, größe: None, r: Some(2),)", "Recipe(a: 1, größe: None, r: Some(2))");
        check("[(1, 2), P(), Q (x), ball]", "[(1, 2), P(), Q(x), ball]");
        check("[true, (true: 1)]", "[true, (true: 1)]");
    }

    #[test]
    fn comments_marks_and_attributes_are_skipped() {
        check("\u{feff}#![enable(implicit_some)]\r\n#![enable(x)] // c\r\n(a: 1)\r\n", "(a: 1)");
        check("/* a /* b */ \" */ [1 /**/, // ]\n 2] // end", "[1, 2]");
        check("(a /* : */ : /* x */ 1 // \"\n)", "(a: 1)");
    }

    #[test]
    fn values_know_their_place() {
        let text = "Recipe(\n  a: {\"k\": [ 1.5 ]},\n)";
        let value = read(text).unwrap();
        assert_eq!(value.span.text(), text);
        let ValueKind::Struct { name: Some((_, name)), fields } = &value.kind else { panic!() };
        let (_, field, map) = &fields[0];
        let ValueKind::Map(entries) = &map.kind else { panic!() };
        let spans = [name, field, &map.span, &entries[0].0.span, &entries[0].1.span];
        let places = spans.map(|span| format!("{span} {}", span.text()));
        let expected = ["1:1 Recipe", "2:3 a", "2:6 {\"k\": [ 1.5 ]}", "2:7 \"k\"", "2:12 [ 1.5 ]"];
        assert_eq!(places, expected.map(|place| format!("t.ron:{place}")));
    }

    #[test]
    fn slips_are_named_at_their_place() {
        check_faults("", &["1:1 expected a value, found the end of the text"]);
        check_faults("(a: 1) x", &["1:8 expected the end of the text, found `x`"]);
        check_faults("(a: 1\n b: 2)", &["1:6 a `,` is missing here"]);
        check_faults("[\"a\" \"b\", \"c\"]", &["1:5 a `,` is missing here"]);
        check_faults("{\"a\": 1; \"b\": 2}", &["1:8 expected `,`, found `;`"]);
        check_faults("(a: 5 mm, b: 1)", &["1:7 expected `,` or `)`, found `mm`"]);
        check_faults(
            "(a 1, b \"x\", c: {\"d\" 2})",
            &[
                "1:3 a `:` is missing here",
                "1:8 a `:` is missing here",
                "1:21 a `:` is missing here",
            ],
        );
        check_faults(
            "(a = 1, b => 2)",
            &["1:4 expected `:`, found `=`", "1:11 expected `:`, found `=>`"],
        );
        check_faults(
            "{\"a\", \"b\"}",
            &[
                "1:5 expected `:` and a value, found `,`; a map is {key: value, ...}; a list is [value, ...]",
            ],
        );
        check_faults(
            "(a: , b: )",
            &["1:5 expected a value, found `,`", "1:10 expected a value, found `)`"],
        );
        check_faults("[1,,2]", &["1:4 expected a value, found `,`"]);
        check_faults("{a: 1}", &["1:2 a key of a map stands in quotes; write \"a\""]);
        check_faults("(\"a\": 1)", &["1:2 the name of a field stands without quotes; write a"]);
        check_faults("(a: 1, \"x\")", &["1:8 a name and a `:` are missing before this value"]);
        check_faults("(a: 'x y')", &["1:5 a text stands between double quotes; write \"x y\""]);
        check_faults("(a: 'x, b: 1)", &["1:5 this `'` is never closed"]);
        check_faults(
            "(a: “x”, b: 1)",
            &[
                "1:5 expected a value, found `“`; a text stands between straight double quotes: \"...\"",
            ],
        );
        check_faults(
            "(a: @, b: \u{1b})",
            &["1:5 expected a value, found `@`", "1:11 expected a value, found `\\u{1b}`"],
        );
        check_faults("/* /* */ (", &["1:1 this comment is never closed"]);
        check_faults("#![x", &["1:1 this `#![` is never closed"]);
    }

    #[test]
    fn bad_literals_are_named_at_their_place() {
        check_faults(
            "[5mm, 600mm/min, 20%, 15°]",
            &[
                "1:2 `5mm` is not a number; a number with a unit is a text: write \"5mm\"",
                "1:7 `600mm` is not a number; a number with a unit is a text: write \"600mm/min\"",
                "1:18 `20%` is not a number; a number with a unit is a text: write \"20%\"",
                "1:23 `15°` is not a number; a number with a unit is a text: write \"15°\"",
            ],
        );
        check_faults(
            "[1.2.3, 1u8, -, ., 0x, 0xg, 99999999999999999999]",
            &[
                "1:2 `1.2.3` is not a number",
                "1:9 `1u8` is not a number; a number with a unit is a text: write \"1u8\"",
                "1:14 `-` is not a number",
                "1:17 `.` is not a number",
                "1:20 `0x` is not a number",
                "1:24 `0xg` is not a number",
                "1:29 `99999999999999999999` is not a number; whole numbers have 64 bits; larger ones are written as 1e20",
            ],
        );
        check_faults(
            r#"["C:\pics\x.png", "\u{d800}", "\xZZ", "ok"]"#,
            &[
                "1:5 bad escape `\\p`; write \\\\ for a backslash; paths may use / instead",
                "1:20 bad escape `\\u`; write \\\\ for a backslash; paths may use / instead",
                "1:32 bad escape `\\x`; write \\\\ for a backslash; paths may use / instead",
            ],
        );
    }

    #[test]
    fn lost_quotes_are_found() {
        check_faults("(a: \"x)", &["1:5 this text has no closing quote"]);
        check_faults("(a: r#\"x\")", &["1:5 this text has no closing quote"]);
        let text = "Recipe(\n \"n\": 1,\n a: (kind: \"x, set: { \"p\": 1 }),\n b: @,\n)";
        check_faults(
            text,
            &[
                "2:2 the name of a field stands without quotes; write n",
                "3:12 this text has no closing quote",
                "4:5 expected a value, found `@`",
            ],
        );
        check_faults(
            "(a: \"One, two.,\n b: \"x\",\n c: @)",
            &["1:5 this text has no closing quote", "3:5 expected a value, found `@`"],
        );
        check_faults(
            "{\"a: 1, \"b\": @}",
            &["1:2 this text has no closing quote", "1:14 expected a value, found `@`"],
        );
        check_faults(
            "(a: x\", b: \"y\", c: @)",
            &["1:5 `x` lacks its opening quote", "1:20 expected a value, found `@`"],
        );
        check_faults(
            "(a: x y z\", b: \"y\", c: @)",
            &["1:5 `x y z` lacks its opening quote", "1:24 expected a value, found `@`"],
        );
    }

    #[test]
    fn lost_brackets_are_found() {
        check_faults(
            "(a: [1, 2",
            &["1:5 the `[` of a is never closed; `]` is missing before the end of the text"],
        );
        check_faults(
            "R(\n  a: {\n    \"x\": (k: 1),\n    \"y\": (k: 2,\n    \"z\": (k: @),\n  },\n)",
            &[
                "4:10 the `(` of \"y\" is never closed; `)` is missing before a text on line 5",
                "5:14 expected a value, found `@`",
            ],
        );
        check_faults(
            "R(\n  a: {\n    \"x\": 1,\n  b: [@],\n)",
            &[
                "2:6 the `{` of a is never closed; `}` is missing before `b` on line 4",
                "4:7 expected a value, found `@`",
            ],
        );
        check_faults(
            "{\n  \"x\": (k: 1, set: {\"a\": 1 ),\n  \"y\": @\n}",
            &[
                "2:20 the `{` of set is never closed; `}` is missing before the `)` on line 2",
                "3:8 expected a value, found `@`",
            ],
        );
        check_faults(
            "(a: [1, 2), b: @)",
            &["1:10 the `[` of a is closed by `)`, not `]`", "1:16 expected a value, found `@`"],
        );
        check_faults(
            "{\"x\": (s: {\"a\": 1)), \"y\": @}",
            &["1:18 the `{` of s is closed by `)`, not `}`", "1:27 expected a value, found `@`"],
        );
        check_faults(
            "{\"x\": (s: 1)), \"y\": @}",
            &["1:13 this `)` closes nothing", "1:21 expected a value, found `@`"],
        );
        check_faults("(a: 1))", &["1:7 expected the end of the text, found `)`"]);
        check_faults("[1, 2)", &["1:6 this `[` is closed by `)`, not `]`"]);
        check_faults(
            "([{1)",
            &["1:3 this `{` is never closed; `}` is missing before the `)` on line 1"],
        );
        check_faults(
            "(a: (b: 1, c: @)",
            &[
                "1:1 this `(` is never closed; `)` is missing before the end of the text",
                "1:15 expected a value, found `@`",
            ],
        );
    }

    /// Of all the recipes with one punctuation mark lost or doubled.
    #[test]
    fn one_slip_is_one_fault_nearly_always() {
        let (mut slips, mut pairs) = (0, 0);
        for (at, mark) in RECIPE.char_indices().filter(|(_, c)| "\"'()[]{}:".contains(*c)) {
            let (before, after) = (&RECIPE[..at], &RECIPE[at + 1..]);
            for text in [format!("{before}{after}"), format!("{before}{mark}{mark}{after}")] {
                let faults = read(text.as_str()).map(|_| text.clone()).unwrap_err();
                assert!(faults.len() <= 2, "{text}\n{faults}");
                slips += 1;
                pairs += usize::from(faults.len() == 2);
            }
        }
        assert!(pairs * 25 < slips, "{pairs} of {slips} slips make two faults");
    }

    #[test]
    fn any_fragment_is_read_or_refused() {
        for (at, _) in RECIPE.char_indices() {
            // The first word alone is a value.
            assert!((1..=6).contains(&at) || read(&RECIPE[..at]).is_err());
            assert!(at <= 6 || read(&RECIPE[at..]).is_err());
        }
    }

    #[test]
    fn limits_are_named() {
        let nested = |depth| "[".repeat(depth) + &"]".repeat(depth);
        assert!(read(nested(MAX_DEPTH)).is_ok());
        check_faults(&nested(MAX_DEPTH + 1), &["1:65 brackets nest deeper than 64 levels"]);
        assert!(read(" ".repeat(MAX_TEXT_BYTES - 2) + "()").is_ok());
        let expected = "1:1 the text has 4194305 bytes; 4194304 at most are read";
        check_faults(&" ".repeat(MAX_TEXT_BYTES + 1), &[expected]);
        let faults = read("[".to_owned() + &"@,".repeat(MAX_FAULTS * 2)).unwrap_err();
        assert_eq!(faults.len(), MAX_FAULTS + 1);
        let last = faults.sorted().pop().map(|fault| fault.message.as_str());
        assert_eq!(last, Some("reading stopped at 100 faults"));
    }

    /// Quadratic reading of any of these takes minutes.
    #[test]
    fn time_is_linear_in_the_text() {
        let pieces = r##"( [ { " ' r# r#" /* a( a: a= a:( "a":{ [] ) (} "" "x ""x "a"b "\" "\",
            a" a; 1, a, [( [1 1e - @ , 'a', /**/ \ é"##;
        let pieces = pieces.split_whitespace();
        for piece in
            pieces.chain([" ", "\n", "a ", "\"a\" ", "\"\\\",\n", "//\n", "a\n,", "\u{feff}"])
        {
            for start in ["", "[", "{", "(", &format!("(\n [\n{}", " ".repeat(1 << 18))] {
                quick(&format!("{start}{}", piece.repeat((1 << 18) / piece.len())));
            }
        }
        quick(&"(".repeat(MAX_TEXT_BYTES));
        quick(&"[\"\n".repeat(MAX_TEXT_BYTES / 3));
        quick(&format!("{{{}}}", "1:1,".repeat(MAX_TEXT_BYTES / 4 - 1)));
        let distinct =
            |quote| (0..300_000).map(|k| format!("{quote}k{k}{quote}:1,")).collect::<String>();
        quick(&format!("{{{}}}", distinct("\"")));
        quick(&format!("({})", distinct("")));
    }

    /// Reads and renders a text within two seconds, which unoptimised builds need.
    #[track_caller]
    fn quick(text: &str) {
        let start = Instant::now();
        let _ = read(text).map_err(|faults| faults.to_string());
        let took = start.elapsed();
        let beginning: String = text.chars().take(20).collect();
        assert!(took < Duration::from_secs(2), "{took:?} for {beginning:?}...");
    }

    const RECIPE: &str = r#"Recipe(
    format: 1,
    title: "Relief from a picture",
    about: "Luminance becomes height; ball-nose finish.",
    params: {
        "image": (sets: ["photo.path"], about: "Picture to carve"),
        "diameter": (sets: ["cutter.diameter", "b"], about: "Ball diameter"),
    },
    nodes: {
        "photo":  (kind: "load_image", set: { "path": "samples/medallion.png" }),
        "gray":   (kind: "grayscale", from: { "image": "photo" }),
        "smooth": (kind: "gaussian_blur", from: { "image": "gray" }, set: { "kernel": 5 }),
        "relief": (
            kind: "z_map",
            from: { "image": "smooth" },
            set: { "z_max": -5.0, "on": true },
        ),
    },
    outputs: ["save_gcode", "preview"],
)"#;

    #[test]
    fn duplicates_name_the_first() {
        check_faults(
            "{\"a\": 1,\n \"b\": 2,\n \"\\x61\": 3, \"b\": 4}",
            &[
                "3:2 duplicate key \"\\x61\"; the first is on line 1",
                "3:13 duplicate key \"b\"; the first is on line 2",
            ],
        );
        check_faults(
            "(a: 1, b: (a: 1), a: 2)",
            &["1:19 duplicate field a; the first is on line 1"],
        );
        check_faults(
            "{1: 1, 0x1: 2, true: 1, true: 2}",
            &[
                "1:8 duplicate key 0x1; the first is on line 1",
                "1:25 duplicate key true; the first is on line 1",
            ],
        );
    }
}

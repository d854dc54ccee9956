//! Lists, maps and groups.

use super::lexer::{Scan, is_closer, scan_text, starts_literal, starts_word, word_end};
use super::reader::{Item, Key, Opener, Reader, Reported};
use super::value::{Name, Value, ValueKind};
use super::{MAX_DEPTH, shown};
use crate::source::Span;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::mem;

impl<'s> Reader<'s> {
    pub(super) fn map(&mut self, opener: Opener<'s>) -> Result<ValueKind, Reported> {
        let next = self.after_space(self.at);
        if self.byte(next) == Some(b'{') {
            self.at = next + 1;
            self.report(opener.at..opener.at + 1, "one `{` too many");
        }
        let entries = self.bracket(opener, Self::entry)?;
        self.refuse_duplicates("key", entries.iter().map(|(key, _)| (sameness(key), &key.span)));
        Ok(ValueKind::Map(entries))
    }

    pub(super) fn entry(&mut self) -> Result<(Value, Value), Reported> {
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

    pub(super) fn group(
        &mut self,
        name: Option<Name>,
        opener: Opener<'s>,
    ) -> Result<ValueKind, Reported> {
        let (mut fields, mut items) = (Vec::new(), Vec::new());
        for item in self.bracket(opener, Self::group_item)? {
            match item {
                Item::Field(name, value) => fields.push((name, value)),
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
        let names = fields.iter().map(|(name, _)| (Same::Text(&name.text), &name.span));
        self.refuse_duplicates("field", names);
        Ok(ValueKind::Struct { name, fields })
    }

    pub(super) fn group_item(&mut self) -> Result<Item, Reported> {
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
        let name = self.name(range);
        Ok(Item::Field(name, self.content()?))
    }

    /// Reads the value behind a colon. If another key stands there the bracket before it was
    /// forgotten, and is taken as read.
    pub(super) fn content(&mut self) -> Result<Value, Reported> {
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
    pub(super) fn lacks_colon(&self, at: usize) -> bool {
        let end = word_end(self.text, at);
        let next = self.after_space(end);
        let is_word = self.byte(at).is_some_and(starts_word) && next > end;
        is_word && self.byte(next).is_some_and(starts_literal)
    }

    /// Reads the `:` between a key and its value.
    pub(super) fn colon(&mut self) -> Result<(), Reported> {
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
    pub(super) fn opener(&mut self, owner: &'s str) -> Opener<'s> {
        let opener = Opener { at: self.at, bracket: self.text.as_bytes()[self.at], owner };
        self.at += 1;
        opener
    }

    /// Reads the items up to the partner of a bracket.
    pub(super) fn bracket<T>(
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

    pub(super) fn items<T>(
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
    pub(super) fn separator(&mut self, opener: &Opener<'s>) {
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

//! What was meant where brackets and commas are lost.

use super::lexer::{
    Scan, is_closer, raw_text, scan_text, single_quoted_end, starts_literal, starts_word, word_end,
};
use super::reader::{Key, Opener, Reader, Reported};

/// Blanks looked at to compare indentations; a bound, so that a line of a million does not cost
/// a million times its length.
const MAX_INDENT: usize = 200;

impl<'s> Reader<'s> {
    /// The key at an offset, if one and its colon stand there.
    pub(super) fn key_at(&self, at: usize) -> Option<Key> {
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
    pub(super) fn is_item(&self, opener: &Opener<'s>, at: usize) -> bool {
        match opener.bracket {
            b'[' => self.byte(at).is_some_and(starts_literal) || self.byte(at) == Some(b'('),
            b'(' => self.key_at(at).is_some_and(|key| key != Key::Number),
            _ => self.key_at(at).is_some(),
        }
    }

    /// Whether a key that cannot belong to the bracket stands here, so that the closing bracket was
    /// forgotten before it. That is so in a list if the bracket around it takes such keys, and in
    /// any if the key starts a line that is indented no deeper than the bracket's.
    pub(super) fn is_outside(&self, opener: &Opener<'s>, at: usize) -> bool {
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
    pub(super) fn is_dedented(&self, opener: &Opener<'s>, at: usize) -> bool {
        self.indents(opener, at).is_some_and(|(inner, outer)| inner <= outer)
    }

    /// The blanks before what stands here and before the line of the bracket, if a later line
    /// starts here. Where there is no indentation it means nothing, and none is told.
    pub(super) fn indents(&self, opener: &Opener<'s>, at: usize) -> Option<(usize, usize)> {
        let is_blank = |byte: &&u8| matches!(byte, b' ' | b'\t');
        let bytes = self.text.as_bytes();
        let line = self.source.line_range(self.source.line_number(opener.at));
        let outer = bytes[line.start..].iter().take(MAX_INDENT).take_while(is_blank).count();
        let inner = bytes[..at].iter().rev().take(MAX_INDENT).take_while(is_blank).count();
        let starts_line = at > line.end && bytes[at - inner - 1] == b'\n';
        (starts_line && outer > 0).then_some((inner, outer))
    }

    /// Whether what follows a closing bracket could go on inside `opener`, or end the text if none.
    pub(super) fn goes_on(&self, opener: Option<&Opener<'s>>, at: usize) -> bool {
        let at = self.after_space(at);
        let Some(opener) = opener else { return at == self.text.len() };
        let next = if self.byte(at) == Some(b',') { self.after_space(at + 1) } else { at };
        let closes = self.byte(next) == Some(opener.closer() as u8);
        closes || next > at && self.is_item(opener, next)
    }

    pub(super) fn unclosed(&mut self, opener: &Opener<'s>, before: &str) {
        if !self.lost && self.blamed.replace(self.at) != Some(self.at) {
            let message = format!("{opener} is never closed");
            let help = format!("`{}` is missing before {before}", opener.closer());
            self.report_with_help(opener.at..opener.at + 1, message, Some(help));
        }
    }

    /// Handles a closing bracket that does not match `opener`; whether the items end here. What
    /// follows it tells whether the right one is missing before it, or it is surplus, or mistyped.
    pub(super) fn ends_at_wrong_closer(&mut self, opener: &Opener<'s>, byte: u8) -> bool {
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
    pub(super) fn is_inside(&self, opener: &Opener<'s>, at: usize) -> bool {
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
    pub(super) fn skip_item(&mut self) {
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
}

//! Comments that are nothing but comments.
//!
//! A recipe's title is anybody's text. Written as it is it could close its bracket and go on with a
//! block of its own; hold a grbl board by a `!` (real-time characters count inside comments too);
//! or, where a controller takes comments beginning with certain words for orders (LinuxCNC's
//! `(LOGOPEN,...)` and `(py,...)`, Mach's `(MSG,...)`), be one. So:
//!
//! * only letters, digits, spaces and the punctuation that a dialect allows are kept; what is not
//!   ASCII becomes `_` where that is allowed, everything else a space;
//! * no comment begins with the text's own word: a mark comes first;
//! * long texts go on in further comments, up to a number of them, and end in `...`.

use crate::Text;

/// Comments one text may take; a longer one is cut.
const MAX_LINES: usize = 4;

/// What stands before a remark, and before what is left of a text after its first line.
pub(crate) const MARK: &str = "- ";

/// All punctuation that no controller known to us acts on.
pub(crate) const PUNCTUATION: &str = ".,:+-*/=_'\"@&#%";

/// The least width of a comment: its brackets, the longest mark, and a word.
pub(crate) const LEAST_WIDTH: usize = 40;

/// How a dialect writes comments.
#[derive(Clone, Debug)]
pub(crate) struct CommentStyle {
    /// What begins a comment.
    pub(crate) open: Text,
    /// What ends it; nothing where the line's end does.
    pub(crate) close: Text,
    /// Whether the controller knows upper case only.
    pub(crate) upper: bool,
    /// What may stand in a comment besides letters, digits and spaces: some of [`PUNCTUATION`], with
    /// `-` and `.`.
    pub(crate) punctuation: Text,
}

impl CommentStyle {
    /// Whether a line begins with a comment.
    pub(crate) fn opens(&self, line: &str) -> bool {
        line.starts_with(self.open.trim())
    }
}

/// Comments in brackets.
pub(crate) fn brackets() -> CommentStyle {
    CommentStyle {
        open: "(".into(),
        close: ")".into(),
        upper: false,
        punctuation: PUNCTUATION.into(),
    }
}

/// `text` as whole comments of at most `width` characters each, the first beginning with `mark`.
/// There must be room for the mark and some words: [`LEAST_WIDTH`] is enough.
pub(crate) fn comments(style: &CommentStyle, mark: &str, text: &str, width: usize) -> Vec<String> {
    let CommentStyle { open, close, .. } = style;
    let mark = format!("{} ", harmless(style, mark, width));
    let clean = harmless(style, text, width * MAX_LINES);
    let mut rest = clean.as_str();
    let mut lines = Vec::new();
    while !rest.is_empty() {
        let mark = if lines.is_empty() { &mark } else { MARK };
        let room = width - mark.len() - open.len() - close.len();
        if lines.len() + 1 == MAX_LINES && rest.len() > room {
            let kept = rest[..room - "...".len()].trim_end();
            lines.push(format!("{open}{mark}{kept}...{close}"));
            break;
        }
        let (line, left) = break_at(rest, room);
        lines.push(format!("{open}{mark}{line}{close}"));
        rest = left;
    }
    lines
}

/// The part of `text` that fits, whole words if there are any, and what is left.
fn break_at(text: &str, room: usize) -> (&str, &str) {
    if text.len() <= room {
        return (text, "");
    }
    let end = text[..=room].rfind(' ').unwrap_or(room);
    (&text[..end], text[end..].trim_start())
}

/// The first `limit` characters that are left when all that could do harm is gone; ASCII.
pub(crate) fn harmless(style: &CommentStyle, text: &str, limit: usize) -> String {
    let mut clean = String::new();
    for character in text.chars() {
        let kept = match character {
            'a'..='z' if style.upper => character.to_ascii_uppercase(),
            'a'..='z' | 'A'..='Z' | '0'..='9' => character,
            _ if style.punctuation.contains(character) => character,
            _ if character.is_ascii() || character.is_whitespace() => ' ',
            _ if style.punctuation.contains('_') => '_',
            _ => ' ',
        };
        if kept != ' ' || !(clean.is_empty() || clean.ends_with(' ')) {
            clean.push(kept);
        }
        if clean.len() == limit {
            break;
        }
    }
    clean.truncate(clean.trim_end().len());
    clean
}

#[cfg(test)]
mod tests {
    use super::*;

    fn remark(text: &str) -> Vec<String> {
        comments(&brackets(), MARK, text, 79)
    }

    #[test]
    fn plain_text_stays() {
        assert_eq!(remark("Ball 6 mm, stepover 40%"), ["(- Ball 6 mm, stepover 40%)"]);
        assert_eq!(comments(&brackets(), "Carvegraph: ", "Relief", 79), ["(Carvegraph: Relief)"]);
        assert_eq!(remark(""), [""; 0]);
        assert_eq!(remark(" \n "), [""; 0]);
    }

    #[test]
    fn no_text_leaves_its_comment() {
        assert_eq!(remark("a)\nG0 Z-50\r\n(b"), ["(- a G0 Z-50 b)"]);
        assert_eq!(remark("x;M3\0\u{1b}\u{85}y\u{2028}z"), ["(- x M3 y z)"]);
    }

    #[test]
    fn no_text_is_an_order() {
        assert_eq!(remark("LOGOPEN,/etc/passwd"), ["(- LOGOPEN,/etc/passwd)"]);
        assert_eq!(remark("hold! who? ~ me \u{18}"), ["(- hold who me)"]);
        assert_eq!(remark("Café 10×10 \u{84}"), ["(- Caf_ 10_10 _)"]);
    }

    #[test]
    fn a_style_keeps_what_its_controller_reads() {
        let plain = CommentStyle { upper: true, punctuation: ".,+-".into(), ..brackets() };
        let lines = comments(&plain, "Carvegraph: ", "Relief_2 %O9000 é", 79);
        assert_eq!(lines, ["(CARVEGRAPH RELIEF 2 O9000)"]);
        let to_the_end = CommentStyle { open: "; ".into(), close: "".into(), ..brackets() };
        assert_eq!(comments(&to_the_end, MARK, "a\nG0 Z-50", 79), ["; - a G0 Z-50"]);
    }

    #[test]
    fn long_texts_wrap_between_words_and_end() {
        let lines = remark(&"word ".repeat(40));
        assert!(
            lines.iter().all(|l| l.len() <= 79 && l.starts_with("(- ") && l.ends_with("word)"))
        );
        assert_eq!(lines.iter().map(|l| l.matches("word").count()).sum::<usize>(), 40);
        let lines = remark(&"x".repeat(1_000_000));
        assert_eq!(lines.len(), MAX_LINES);
        assert!(lines.iter().all(|l| l.len() == 79));
        assert!(lines[MAX_LINES - 1].ends_with("...)"));
    }
}

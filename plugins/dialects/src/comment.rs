//! Comments that are nothing but comments.
//!
//! A recipe's title is anybody's text. Written as it is it could close its bracket and go on with a
//! block of its own; hold a grbl board by a `!` (real-time characters count inside comments too);
//! or, where a controller takes comments beginning with certain words for orders (LinuxCNC's
//! `(LOGOPEN,...)` and `(py,...)`, Mach's `(MSG,...)`), be one. So:
//!
//! * only letters, digits, spaces and `. , : + - * / = _ ' " @ & # %` are kept; what is not ASCII
//!   becomes `_`, everything else a space;
//! * no comment begins with the text's own word: a mark comes first;
//! * long texts go on in further comments, up to a number of them, and end in `...`.

/// Comments one text may take; a longer one is cut.
const MAX_LINES: usize = 4;

/// What stands before a remark, and before what is left of a text after its first line.
pub(crate) const MARK: &str = "- ";

/// `text` as whole comments of at most `width` characters each, the first beginning with `mark`.
pub(crate) fn comments(mark: &str, text: &str, width: usize) -> Vec<String> {
    let clean = harmless(text, width * MAX_LINES);
    let mut rest = clean.as_str();
    let mut lines = Vec::new();
    while !rest.is_empty() {
        let mark = if lines.is_empty() { mark } else { MARK };
        let room = width - mark.len() - "()".len();
        if lines.len() + 1 == MAX_LINES && rest.len() > room {
            let kept = rest[..room - "...".len()].trim_end();
            lines.push(format!("({mark}{kept}...)"));
            break;
        }
        let (line, left) = break_at(rest, room);
        lines.push(format!("({mark}{line})"));
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
fn harmless(text: &str, limit: usize) -> String {
    let mut clean = String::new();
    for character in text.chars() {
        let kept = match character {
            'a'..='z' | 'A'..='Z' | '0'..='9' => character,
            '.' | ',' | ':' | '+' | '-' | '*' | '/' | '=' | '_' => character,
            '\'' | '"' | '@' | '&' | '#' | '%' => character,
            _ if character.is_ascii() || character.is_whitespace() => ' ',
            _ => '_',
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
        comments(MARK, text, 79)
    }

    #[test]
    fn plain_text_stays() {
        assert_eq!(remark("Ball 6 mm, stepover 40%"), ["(- Ball 6 mm, stepover 40%)"]);
        assert_eq!(comments("Carvegraph: ", "Relief", 79), ["(Carvegraph: Relief)"]);
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

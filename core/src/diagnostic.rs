//! Faults of a recipe or a call, and how they are shown.
//!
//! A [`Diagnostic`] is rendered as plain text in the manner of rustc: what is wrong,
//! `file:line:column`, the line quoted and underlined, and what to do. Quoted text is harmless on a
//! terminal: control characters are replaced, tabs become blanks, and long lines are cut to a window
//! around the fault. [`Diagnostics`] are all the faults found, in the order of their place.
//!
//! Limits: every character counts as one column wide, so carets drift under East Asian text.

use std::error::Error;
use std::fmt;

use crate::source::{BYTE_ORDER_MARK, Span};

/// How many diagnostics are printed before "and N more": past that nobody reads.
pub const MAX_RENDERED: usize = 50;

/// Characters quoted of a long line.
const WINDOW: usize = 100;

/// Of those, at most so many stand before the fault if the line goes on behind it.
const WINDOW_BEFORE: usize = 40;

/// Blanks shown for a tab.
const TAB: &str = "    ";

/// Of so many words that are known all are listed where none is near.
const MAX_KNOWN: usize = 40;

/// Longer words have no suggestions: the distance takes time with the product of the lengths.
const MAX_SUGGESTED_CHARS: usize = 64;

/// Whether a diagnostic stops the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Nothing runs.
    Error,
    /// Worth knowing; the run goes on.
    Warning,
}

/// One fault: what is wrong, where, and what to do.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// Whether it stops the run.
    pub severity: Severity,
    /// What is wrong: one line, no capital, no full stop.
    pub message: String,
    /// The text at fault.
    pub span: Option<Span>,
    /// What to do. Boxed to keep results that hold a diagnostic small.
    pub help: Option<Box<str>>,
}

impl Diagnostic {
    /// A fault that stops the run.
    pub fn error(message: impl Into<String>) -> Self {
        let message = message.into();
        Self { severity: Severity::Error, message, span: None, help: None }
    }

    /// A fault the run survives.
    pub fn warning(message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(message) }
    }

    /// Says where.
    #[must_use]
    pub fn at(self, span: Span) -> Self {
        Self { span: Some(span), ..self }
    }

    /// Says what to do.
    #[must_use]
    pub fn help(self, help: impl Into<Box<str>>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// The fault as text of several lines, the last one ended too.
    pub fn render(&self) -> String {
        self.to_string()
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        writeln!(f, "{severity}: {}", harmless(&self.message))?;
        let mut gutter = 1;
        if let Some(span) = &self.span {
            let (line, column) = span.position();
            let quote = Quote::new(span, line);
            gutter = line.to_string().len();
            writeln!(f, "{:gutter$}--> {}:{line}:{column}", "", harmless(span.source.name()))?;
            writeln!(f, "{:gutter$} |", "")?;
            writeln!(f, "{line} | {}", quote.line)?;
            writeln!(f, "{:gutter$} | {:2$}{3}", "", "", quote.indent, "^".repeat(quote.carets))?;
        }
        for (index, line) in self.help.iter().flat_map(|help| help.lines()).enumerate() {
            let lead = if index == 0 { "= help:" } else { "       " };
            writeln!(f, "{:gutter$} {lead} {}", "", harmless(line))?;
        }
        Ok(())
    }
}

/// The line of a fault as it is printed, and where the carets go.
struct Quote {
    line: String,
    indent: usize,
    carets: usize,
}

impl Quote {
    /// Quotes the first line of a span. The work is bounded by the window, not by the line.
    fn new(span: &Span, line: usize) -> Self {
        let text = span.source.text();
        let range = span.source.line_range(line);
        // A fault at the line ending itself is shown behind the line's last character.
        let start = span.start.min(range.end);
        let marked = &text[start..span.end.clamp(start, range.end)];
        let before = text[range.start..start].trim_start_matches(BYTE_ORDER_MARK);
        let after = &text[start + marked.len()..range.end];

        let count = |part: &str| part.chars().take(WINDOW + 1).count();
        let tail = count(&text[start..range.end]);
        let left = WINDOW.saturating_sub(tail).max(WINDOW_BEFORE);
        let (before, cut_left) = last_chars(before, left);
        let room = WINDOW - before.chars().count();
        let (marked, _) = first_chars(marked, room);
        let (after, _) = first_chars(after, room - marked.chars().count());

        let ellipsis = |cut: bool| if cut { "…" } else { "" };
        let lead = format!("{}{}", ellipsis(cut_left), harmless(before));
        let marked = harmless(marked);
        Self {
            indent: lead.chars().count(),
            carets: marked.chars().count().max(1),
            line: format!("{lead}{marked}{}{}", harmless(after), ellipsis(tail > room)),
        }
    }
}

/// At most the first `count` characters, and whether any were cut.
fn first_chars(text: &str, count: usize) -> (&str, bool) {
    let end = text.char_indices().nth(count).map_or(text.len(), |(at, _)| at);
    (&text[..end], end < text.len())
}

/// At most the last `count` characters, and whether any were cut.
fn last_chars(text: &str, count: usize) -> (&str, bool) {
    let start = text.char_indices().rev().take(count).last().map_or(text.len(), |(at, _)| at);
    (&text[start..], start > 0)
}

/// The text without anything a terminal would obey: tabs become blanks; control characters and
/// those that reorder or hide text become �.
pub(crate) fn harmless(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\t' => out.push_str(TAB),
            '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' => {
                out.push('\u{fffd}');
            }
            BYTE_ORDER_MARK => out.push('\u{fffd}'),
            c if c.is_control() => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// All the faults found.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl Diagnostics {
    /// No fault yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a fault.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.0.push(diagnostic);
    }

    /// Adds the fault that a word is not among those known, with the help of what may have been
    /// meant. To compare a word with 10,000 others takes a millisecond, so only of the first faults
    /// it is told; more are not printed either.
    pub fn push_near<'k>(
        &mut self,
        fault: Diagnostic,
        word: &str,
        known: impl IntoIterator<Item = &'k str>,
    ) {
        let help = (self.len() < MAX_RENDERED).then(|| instead_of(word, known).into());
        self.push(Diagnostic { help, ..fault });
    }

    /// Whether one of them stops the run.
    pub fn has_errors(&self) -> bool {
        self.0.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// Whether there is none, not even a warning.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The faults in the order they were found.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.0.iter()
    }

    /// The faults in the order they are printed: errors, then warnings, each by file and place;
    /// those without a place come last.
    pub fn sorted(&self) -> Vec<&Diagnostic> {
        let mut sorted: Vec<_> = self.0.iter().collect();
        sorted.sort_by_key(|diagnostic| {
            let span = diagnostic.span.as_ref();
            let place = span.map(|span| (span.source.name(), span.start));
            (diagnostic.severity, place.is_none(), place)
        });
        sorted
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, diagnostic) in self.sorted().iter().take(MAX_RENDERED).enumerate() {
            let gap = if index == 0 { "" } else { "\n" };
            write!(f, "{gap}{diagnostic}")?;
        }
        match self.len().saturating_sub(MAX_RENDERED) {
            0 => Ok(()),
            more => writeln!(f, "\nand {more} more"),
        }
    }
}

impl Error for Diagnostics {}

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Self {
        Self(vec![diagnostic])
    }
}

impl FromIterator<Diagnostic> for Diagnostics {
    fn from_iter<I: IntoIterator<Item = Diagnostic>>(diagnostics: I) -> Self {
        Self(diagnostics.into_iter().collect())
    }
}

impl Extend<Diagnostic> for Diagnostics {
    fn extend<I: IntoIterator<Item = Diagnostic>>(&mut self, diagnostics: I) {
        self.0.extend(diagnostics);
    }
}

impl IntoIterator for Diagnostics {
    type Item = Diagnostic;
    type IntoIter = std::vec::IntoIter<Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

/// What may have been meant by a word that is not known, or else what is known.
fn instead_of<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> String {
    let mut known: Vec<&str> = known.into_iter().collect();
    known.sort_unstable();
    if let Some(near) = did_you_mean(word, known.iter().copied()) {
        return format!("did you mean {near:?}?");
    }
    let more = known.len().saturating_sub(MAX_KNOWN);
    known.truncate(MAX_KNOWN);
    match (known.join(", "), more) {
        (_, 0) if known.is_empty() => "there is none".to_owned(),
        (names, 0) => format!("there is {names}"),
        (names, more) => format!("there is {names} and {more} more"),
    }
}

/// The candidate a mistyped word most likely meant, if any is near.
///
/// A candidate that differs only in case, `-`, `_` or blanks always wins. Otherwise it is the one
/// of the least Damerau-Levenshtein distance, which may be a third of the longer word's length;
/// between equals the alphabet decides, so the order of the candidates does not matter.
pub fn did_you_mean<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let plain = |text: &str| -> String {
        let kept = text.chars().filter(|c| !matches!(c, '-' | '_' | ' '));
        kept.flat_map(char::to_lowercase).collect()
    };
    let wanted = plain(word);
    let length = wanted.chars().count();
    if length == 0 || length > MAX_SUGGESTED_CHARS {
        return None;
    }
    let scored = candidates.into_iter().filter_map(|candidate| {
        let offered = plain(candidate);
        let longer = offered.chars().count().max(length);
        if longer > MAX_SUGGESTED_CHARS {
            return None;
        }
        let shorter = offered.chars().count().min(length);
        if longer - shorter > longer.max(3) / 3 {
            return None;
        }
        let distance = strsim::damerau_levenshtein(&wanted, &offered);
        // At a distance of the whole word nothing of it is left.
        let near = distance == 0 || (distance <= longer.max(3) / 3 && distance < length);
        near.then_some((distance, candidate))
    });
    scored.min().map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use std::ops::Range;
    use std::sync::Arc;

    use super::*;
    use crate::source::Source;

    fn at(text: &str, range: Range<usize>) -> Diagnostic {
        Diagnostic::error("bad").at(Arc::new(Source::new("t.ron", text)).span(range))
    }

    /// Compares the quoted line and the carets.
    #[track_caller]
    fn check(text: &str, range: Range<usize>, line: &str, carets: &str) {
        let rendered = at(text, range).render();
        let mut bars = rendered.lines().filter_map(|line| line.split_once('|')).skip(1);
        let (quoted, marked) = (bars.next().unwrap().1, bars.next().unwrap().1);
        assert_eq!((quoted, marked), (format!(" {line}").as_str(), format!(" {carets}").as_str()));
    }

    #[test]
    fn a_fault_is_rendered_with_its_line() {
        let line = r#"  "relief": (kind: "z_map", set: { "z_mx": 5.0 }),"#;
        let text = "\n".repeat(11) + line;
        let source = Arc::new(Source::new("graphs/relief.ron", text.as_str()));
        let start = text.find("\"z_mx").unwrap();
        let fault = Diagnostic::error(r#"node "relief" has no parameter "z_mx""#)
            .at(source.span(start..start + 6))
            .help(r#"did you mean "z_max"?"#);
        let expected = r#"error: node "relief" has no parameter "z_mx"
  --> graphs/relief.ron:12:36
   |
12 |   "relief": (kind: "z_map", set: { "z_mx": 5.0 }),
   |                                    ^^^^^^
   = help: did you mean "z_max"?
"#;
        assert_eq!(fault.render(), expected);
    }

    #[test]
    fn a_fault_may_have_no_place() {
        let fault = Diagnostic::warning("slow").help("one\ntwo");
        assert_eq!(fault.render(), "warning: slow\n  = help: one\n          two\n");
    }

    #[test]
    fn carets_stand_below_the_span() {
        check("a: b", 3..4, "a: b", "   ^");
        check("\ta: b", 4..5, "    a: b", "       ^");
        check("a: (\n b", 3..7, "a: (", "   ^");
        check("ab", 2..2, "ab", "  ^");
        check("ab\r\ncd", 2..4, "ab", "  ^");
        check("\u{feff}ab", 3..4, "ab", "^");
        check("µ°x", 4..5, "µ°x", "  ^");
        check("\u{1b}[31m\u{202e}x", 8..9, "\u{fffd}[31m\u{fffd}x", "      ^");
    }

    #[test]
    fn long_lines_are_cut_around_the_span() {
        let (x, y) = ("x".repeat(300), "y".repeat(300));
        let (left, carets) = ("x".repeat(40), " ".repeat(41));
        check(
            &format!("{x}!{y}"),
            300..301,
            &format!("…{left}!{}…", "y".repeat(59)),
            &(carets + "^"),
        );
        check(
            &format!("{x}!"),
            300..301,
            &format!("…{}!", "x".repeat(99)),
            &(" ".repeat(100) + "^"),
        );
        check(&format!("!{y}"), 0..1, &format!("!{}…", "y".repeat(99)), "^");
        check(&y, 0..300, &format!("{}…", "y".repeat(100)), &"^".repeat(100));
        check(&y[..100], 50..51, &y[..100], &(" ".repeat(50) + "^"));
    }

    #[test]
    fn faults_come_sorted_and_capped() {
        let mut faults = Diagnostics::from(Diagnostic::warning("w"));
        faults.push(Diagnostic::error("nowhere"));
        faults.extend([at("ab", 1..2), at("ab", 0..1)]);
        assert!(faults.has_errors());
        let places: Vec<_> =
            faults.sorted().iter().map(|d| d.span.as_ref().map(|s| s.start)).collect();
        assert_eq!(places, [Some(0), Some(1), None, None]);

        let many: Diagnostics = (0..MAX_RENDERED + 7).map(|_| Diagnostic::warning("w")).collect();
        assert!(!many.has_errors());
        assert!(many.to_string().ends_with("warning: w\n\nand 7 more\n"));
    }

    #[test]
    fn suggestions_are_near_and_deterministic() {
        let check = |word: &str, candidates: &[&str], expected: Option<&str>| {
            assert_eq!(did_you_mean(word, candidates.iter().copied()), expected, "{word}");
            assert_eq!(did_you_mean(word, candidates.iter().rev().copied()), expected, "{word}");
        };
        check("z_mx", &["z_min", "z_max", "blur"], Some("z_max"));
        check("Z-MAX", &["z_mix", "z_max"], Some("z_max"));
        check("kern", &["kernel", "sigma"], Some("kernel"));
        check("kenrel", &["kernel"], Some("kernel"));
        check("z_m", &["z_b", "z_a"], Some("z_a"));
        check("diameter", &["kernel", "path"], None);
        check("x", &["y"], None);
        check("", &["y"], None);
        check(&"x".repeat(10_000), &["x"], None);
    }
}

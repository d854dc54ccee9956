//! Which templates there are: their form is checked before minijinja sees them.

use crate::template::{FILTERS, engine};
use carvegraph_core::diagnostic::did_you_mean;
use std::ops::Range;

/// The longest template: a hundred lines.
pub(crate) const MAX_CHARS: usize = 4000;

/// The longest expression or condition. Whatever it does, with `*` for numbers only, its result is
/// not much longer.
const MAX_EXPRESSION_CHARS: usize = 200;

/// Conditions inside conditions. The compiler calls itself for each.
const MAX_NESTED: usize = 16;

/// What `{% ... %}` may begin with.
const TAGS: [&str; 4] = ["if", "elif", "else", "endif"];

/// Words of the language that are no values.
const WORDS: [&str; 10] =
    ["if", "elif", "else", "endif", "and", "or", "not", "in", "true", "false"];

/// Values that are texts, which `*` would repeat.
const TEXTS: [&str; 5] = ["name", "number", "title", "unit", "units"];

/// What is wrong with a template.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    /// Where in its source.
    pub(crate) range: Range<usize>,
    /// What.
    pub(crate) message: String,
    /// What to do.
    pub(crate) help: Option<String>,
}

impl Fault {
    fn new(range: Range<usize>, message: impl Into<String>) -> Self {
        Self { range, message: message.into(), help: None }
    }
}

/// All that is wrong with a template that may name the values `known`.
pub(crate) fn faults(source: &str, known: &[&str]) -> Vec<Fault> {
    if source.len() > MAX_CHARS {
        let message = format!("the template has {} characters; {MAX_CHARS} at most", source.len());
        return vec![Fault::new(0..0, message)];
    }
    let mut faults = Vec::new();
    let mut depth = 0_usize;
    for part in parts(source) {
        match part {
            Part::Text(range) => unwritable(source, range, &mut faults),
            Part::Open(range) => {
                let message = format!("{:?} is not closed", &source[range.clone()]);
                faults.push(Fault::new(range, message));
                return faults;
            }
            Part::Tag(range) => {
                tag(source, range.clone(), &mut depth, &mut faults);
                expression(source, range, known, &mut faults);
            }
            Part::Value(range) => expression(source, range, known, &mut faults),
            Part::Note => {}
        }
    }
    if faults.is_empty() { compiled(source) } else { faults }
}

/// What the compiler has to say.
fn compiled(source: &str) -> Vec<Fault> {
    let mut engine = engine();
    engine.set_debug(true);
    let Err(error) = engine.template_from_str(source) else { return Vec::new() };
    let range = error.range().filter(|range| source.get(range.clone()).is_some());
    let message = error.detail().unwrap_or("the template cannot be read");
    vec![Fault::new(range.unwrap_or(0..source.len()), message)]
}

/// A stretch of a template; the ranges of tags and values are what stands between their brackets.
enum Part {
    Text(Range<usize>),
    Value(Range<usize>),
    Tag(Range<usize>),
    Note,
    /// An opening bracket without its closing one.
    Open(Range<usize>),
}

fn parts(source: &str) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut at = 0;
    while let Some(found) = source[at..]
        .find("{{")
        .into_iter()
        .chain(source[at..].find("{%"))
        .chain(source[at..].find("{#"))
        .min()
    {
        let open = at + found;
        parts.push(Part::Text(at..open));
        let inner = open + 2;
        let close = match &source[open..inner] {
            "{{" => "}}",
            "{%" => "%}",
            _ => "#}",
        };
        let Some(length) = source[inner..].find(close) else {
            parts.push(Part::Open(open..inner));
            return parts;
        };
        parts.push(match close {
            "}}" => Part::Value(inner..inner + length),
            "%}" => Part::Tag(inner..inner + length),
            _ => Part::Note,
        });
        at = inner + length + 2;
    }
    parts.push(Part::Text(at..source.len()));
    parts
}

fn unwritable(source: &str, range: Range<usize>, faults: &mut Vec<Fault>) {
    let start = range.start;
    let bad =
        source[range].char_indices().find(|(_, c)| !matches!(c, ' '..='~' | '\n' | '\r' | '\t'));
    if let Some((at, bad)) = bad {
        let message =
            format!("{bad:?} cannot be written: only ASCII letters, digits and signs can");
        faults.push(Fault::new(start + at..start + at + bad.len_utf8(), message));
    }
}

fn tag(source: &str, range: Range<usize>, depth: &mut usize, faults: &mut Vec<Fault>) {
    let word =
        source[range.clone()].trim_matches(['-', '+']).split_whitespace().next().unwrap_or("");
    match word {
        "if" => *depth += 1,
        "endif" => *depth = depth.saturating_sub(1),
        _ if TAGS.contains(&word) => {}
        _ => {
            let message = format!("{word:?} is nothing that a template can do");
            let help = Some(format!("it has {}", TAGS.join(", ")));
            faults.push(Fault { help, ..Fault::new(range.clone(), message) });
        }
    }
    if *depth > MAX_NESTED {
        *depth = 0;
        let message = format!("conditions may nest {MAX_NESTED} deep");
        faults.push(Fault::new(range, message));
    }
}

fn expression(source: &str, range: Range<usize>, known: &[&str], faults: &mut Vec<Fault>) {
    let text = &source[range.clone()];
    if text.len() > MAX_EXPRESSION_CHARS {
        let message = format!("this has {} characters; {MAX_EXPRESSION_CHARS} at most", text.len());
        return faults.push(Fault::new(range, message));
    }
    let Some(names) = names(text) else {
        return faults.push(Fault::new(range, "a text in quotes is not closed"));
    };
    if text.contains(['[', '{', '\\']) {
        let message = "a template has values, numbers and 'texts', no lists, maps or escapes";
        faults.push(Fault::new(range.clone(), message));
    }
    let grows = text.contains(['\'', '"', '~'])
        || names
            .iter()
            .any(|name| TEXTS.contains(&name.text) || name.filter && name.text != "round");
    if text.contains('*') && grows {
        let message = "* multiplies numbers, it cannot stand beside texts";
        faults.push(Fault::new(range.clone(), message));
    }
    for name in names {
        let place = range.start + name.at..range.start + name.at + name.text.len();
        let (known, what): (&[&str], _) =
            if name.filter { (&FILTERS, "filter") } else { (known, "value") };
        if !known.contains(&name.text) && (name.filter || !WORDS.contains(&name.text)) {
            let help = did_you_mean(name.text, known.iter().copied());
            let help = match help {
                Some(near) => format!("did you mean {near:?}?"),
                None => format!("there is {}", known.join(", ")),
            };
            let message = format!("there is no {what} {:?} here", name.text);
            faults.push(Fault { help: Some(help), ..Fault::new(place, message) });
        }
    }
}

/// A word of an expression.
struct Name<'s> {
    text: &'s str,
    at: usize,
    /// Whether it stands behind a `|`.
    filter: bool,
}

/// The words of an expression, without what stands in quotes; `None` if a quote is open at its end.
/// For minijinja the expression would then go on, here unseen.
fn names(text: &str) -> Option<Vec<Name<'_>>> {
    let mut names = Vec::new();
    let mut quote = None;
    let mut filter = false;
    let mut begin = None;
    // A blank behind the end closes the last word.
    for (at, c) in text.char_indices().chain([(text.len(), ' ')]) {
        let in_word = quote.is_none() && (c.is_alphanumeric() || c == '_');
        match begin {
            None if in_word => begin = Some(at),
            Some(start) if !in_word => {
                let word = &text[start..at];
                if !word.starts_with(|c: char| c.is_ascii_digit()) {
                    names.push(Name { text: word, at: start, filter });
                }
                (begin, filter) = (None, false);
            }
            _ => {}
        }
        match (quote, c) {
            (None, '\'' | '"') => quote = Some(c),
            (Some(open), _) if open == c => quote = None,
            (None, '|') => filter = true,
            _ => {}
        }
    }
    quote.is_none().then_some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(source: &str) -> Vec<(String, String)> {
        let faults = faults(source, &["name", "rpm", "tool"]);
        faults.into_iter().map(|f| (source[f.range].to_owned(), f.message)).collect()
    }

    #[test]
    fn what_machinists_write_is_fine() {
        let good = [
            "",
            "%\nO{{ name }}",
            "M3 S{{ (rpm * 255 / 24000)|round }}",
            "T{{ tool|pad(2) }} M6 {# the carousel #}\n{% if tool > 9 and name != 'x' %}M1{% else %}M0{% endif %}",
            "{%- if not (rpm < 100) -%}S{{ rpm }}{%- elif true -%}S0{%- endif -%}",
            "#100=[1+2*3]",
        ];
        for source in good {
            assert_eq!(found(source), [], "{source}");
        }
    }

    #[test]
    fn faults_say_where_and_what() {
        let check = |source: &str, place: &str, message: &str| {
            assert_eq!(found(source), [(place.to_owned(), message.to_owned())], "{source}");
        };
        check("T{{ toll }}", "toll", "there is no value \"toll\" here");
        check("T{{ tool|padd(2) }}", "padd", "there is no filter \"padd\" here");
        check("M6 é", "é", "'é' cannot be written: only ASCII letters, digits and signs can");
        check("T{{ tool", "{{", "\"{{\" is not closed");
        let only_numbers = "* multiplies numbers, it cannot stand beside texts";
        for grown in [" 'x' * 100000000 ", " name * 9 ", " (1 ~ 1) * 9 ", " (tool|pad(9)) * 9 "] {
            check(&format!("{{{{{grown}}}}}"), grown, only_numbers);
        }
        let message = "a template has values, numbers and 'texts', no lists, maps or escapes";
        check("{{ name[1] }}", " name[1] ", message);
        check("{{ '}}' ~ name * 9 }}", " '", "a text in quotes is not closed");
        let help = faults("T{{ toll }}", &["tool"])[0].help.clone();
        assert_eq!(help.as_deref(), Some("did you mean \"tool\"?"));
    }

    #[test]
    fn nothing_repeats_or_remembers() {
        for source in [
            "{% for x in name %}G1{% endfor %}",
            "{% set x = 'G1' %}",
            "{% include 'x' %}",
            "{% raw %}{% endraw %}",
            "{% macro x() %}{% endmacro %}",
            "{% %}",
        ] {
            assert!(!found(source).is_empty(), "{source}");
        }
        assert!(!found("{% if tool %}").is_empty());
        assert!(!found("{% endif %}").is_empty());
        assert!(!found("{{ tool tool }}").is_empty());
        assert!(!found("{{ }}").is_empty());
    }

    #[test]
    fn templates_and_expressions_have_a_length() {
        let long = format!("{{{{ {} }}}}", "(".repeat(300));
        assert!(found(&long)[0].1.contains("at most"));
        assert!(found(&"x".repeat(MAX_CHARS + 1))[0].1.contains("at most"));
        assert!(found(&"{%if 1%}".repeat(400)).iter().any(|f| f.1.contains("deep")));
        let nested =
            format!("{}{}", "{%if tool%}".repeat(MAX_NESTED), "{%endif%}".repeat(MAX_NESTED));
        assert_eq!(found(&nested), []);
    }

    #[test]
    fn no_text_brings_the_compiler_down() {
        let pieces = [
            "{{", "}}", "{%", "%}", "if", "endif", "'", "\"", "-", "|", "(", ")", "tool", "1", ".",
            "é", " ", "*", "/", "==", "not ", "{#", "#}", ",", "=", "\n",
        ];
        let mut seed = 9_u64;
        for _ in 0..20_000 {
            let mut source = String::new();
            for _ in 0..12 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                source.push_str(pieces[(seed >> 40) as usize % pieces.len()]);
            }
            if faults(&source, &["tool"]).is_empty() {
                let engine = engine();
                let template = engine.template_from_str(&source).unwrap();
                let values = [("tool", minijinja::value::Value::from(1))];
                if let Ok(lines) = crate::template::render(&template, values) {
                    assert!(lines.concat().len() < 4 * MAX_EXPRESSION_CHARS);
                }
            }
        }
    }
}

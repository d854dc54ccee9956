//! Lines with places for values: `T{{ tool }} M6`, in the language of minijinja.
//!
//! A template is the text of several lines; what it renders is cut into lines, each trimmed, and
//! empty ones vanish. It has `{{ value }}`, `{% if %}` and four filters, and nothing else:
//!
//! * A dialect may come from a file of somebody's, and nothing in it may hang or crash carve. So
//!   there are no loops and no assignments, expressions are short, and `*` multiplies numbers only:
//!   no text can grow. [`faults`] finds what breaks this before a template is compiled.
//! * A value that is not known, or no number where one is meant, is an error, not an empty place.
//! * The title is anybody's text. It carries a mark through the template, and a line that holds it
//!   must be a comment: see [`settled`].

mod language;

use crate::comment::CommentStyle;
pub(crate) use language::{Fault, faults};
use minijinja::value::Value;
use minijinja::{Environment, Error, ErrorKind, Output, State, Template, UndefinedBehavior};

/// What every template may name; the rest depends on what it is for.
pub(crate) const PROGRAM_VALUES: [&str; 5] = ["name", "number", "title", "unit", "units"];

/// Filters there are: nearest whole number or so many decimals, leading zeros, letters' case.
pub(crate) const FILTERS: [&str; 4] = ["lower", "pad", "round", "upper"];

/// Instructions that one rendering may take; no template of [`language::MAX_CHARS`] needs more.
const FUEL: u64 = 10_000;

/// How deep conditions may nest when they are rendered.
const RECURSION_LIMIT: usize = 100;

/// Digits that `pad` fills up to.
const MAX_PAD: usize = 16;

/// Decimals that `round` leaves.
const MAX_DECIMALS: i32 = 9;

/// Stands before the title while a template is rendered: a character for private use, which no text
/// that was made harmless holds.
const TITLE_MARK: char = '\u{e000}';

/// What compiles and renders templates that live as long as `'t`.
pub(crate) fn engine<'t>() -> Environment<'t> {
    let mut engine = Environment::empty();
    engine.set_undefined_behavior(UndefinedBehavior::Strict);
    engine.set_fuel(Some(FUEL));
    engine.set_recursion_limit(RECURSION_LIMIT);
    engine.set_formatter(write_value);
    engine.add_filter("lower", |text: String| text.to_lowercase());
    engine.add_filter("upper", |text: String| text.to_uppercase());
    engine.add_filter("pad", pad);
    engine.add_filter("round", round);
    engine
}

/// A title, made harmless, on its way through a template.
pub(crate) fn title_value(title: &str) -> Value {
    if title.is_empty() { Value::from("") } else { Value::from(format!("{TITLE_MARK}{title}")) }
}

/// The lines that a template gives with these values, before they are [`settled`].
pub(crate) fn render<'v>(
    template: &Template<'_, '_>,
    values: impl IntoIterator<Item = (&'v str, Value)>,
) -> Result<Vec<String>, Error> {
    let text = template.render(Value::from_pairs(values))?;
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    Ok(lines.map(str::to_owned).collect())
}

/// A rendered line as it may be written.
///
/// # Errors
/// What is wrong with it: it holds what is not ASCII, or the title outside a comment, where it might
/// be read as a block.
pub(crate) fn settled(line: &str, comments: Option<&CommentStyle>) -> Result<String, &'static str> {
    let text = unmarked(line);
    if !text.bytes().all(|byte| (b' '..=b'~').contains(&byte)) {
        return Err("only ASCII letters, digits and signs can be written");
    }
    let Some(last) = line.rfind(TITLE_MARK) else { return Ok(text) };
    let in_comment = comments.is_some_and(|style| {
        let closed = !style.close.is_empty() && line[..last].contains(&*style.close);
        style.opens(line) && !closed
    });
    if in_comment { Ok(text) } else { Err("the title may stand in a comment only") }
}

/// A rendered line without its marks.
pub(crate) fn unmarked(line: &str) -> String {
    line.replace(TITLE_MARK, "")
}

/// Writes numbers as controllers read them: without exponents, and never what is not a number.
fn write_value(out: &mut Output, _: &mut State, value: &Value) -> Result<(), Error> {
    if value.is_number() && !value.is_integer() {
        let number = f64::try_from(value.clone())?;
        if !number.is_finite() {
            return Err(Error::new(ErrorKind::InvalidOperation, "the result is not a number"));
        }
        let text = number.to_string();
        let point = if text.contains('.') { "" } else { ".0" };
        return Ok(write!(out, "{text}{point}")?);
    }
    Ok(write!(out, "{value}")?)
}

/// `{{ tool|pad(2) }}`: at least so many digits.
fn pad(value: Value, width: usize) -> Result<String, Error> {
    if !value.is_integer() || width > MAX_PAD {
        let message = format!("pad takes a whole number, and 0 to {MAX_PAD} digits");
        return Err(Error::new(ErrorKind::InvalidOperation, message));
    }
    Ok(format!("{value:0>width$}"))
}

/// `{{ value|round }}` gives a whole number, `{{ value|round(2) }}` one of two decimals.
fn round(value: f64, decimals: Option<i32>) -> Result<Value, Error> {
    match decimals {
        // Every number that a controller reads is much smaller.
        None if value.abs() < 1e15 => Ok(Value::from(value.round() as i64)),
        Some(decimals @ 0..=MAX_DECIMALS) if value.is_finite() => {
            let scale = 10_f64.powi(decimals);
            Ok(Value::from((value * scale).round() / scale))
        }
        _ => {
            let message = format!("round takes a number, and 0 to {MAX_DECIMALS} decimals");
            Err(Error::new(ErrorKind::InvalidOperation, message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comment::brackets;

    fn lines(source: &str) -> Result<Vec<String>, String> {
        let engine = engine();
        let template = engine.template_from_str(source).map_err(|e| e.to_string())?;
        let values = [("tool", Value::from(7)), ("seconds", Value::from(0.5))];
        let values = values.into_iter().chain([("title", title_value("G0 Z-50"))]);
        render(&template, values).map_err(|e| e.to_string())
    }

    #[test]
    fn places_take_values() {
        assert_eq!(lines("T{{ tool }} M6").unwrap(), ["T7 M6"]);
        assert_eq!(lines("T{{ tool|pad(2) }} H{{ tool + 100 }}").unwrap(), ["T07 H107"]);
        assert_eq!(lines("G4 P{{ (seconds * 1000)|round }}").unwrap(), ["G4 P500"]);
        assert_eq!(lines("{{ seconds }} {{ 2.0 }} {{ 0.00001 }}").unwrap(), ["0.5 2.0 0.00001"]);
        assert_eq!(lines("{{ (1 / 3)|round(2) }}").unwrap(), ["0.33"]);
    }

    #[test]
    fn lines_are_trimmed_and_empty_ones_vanish() {
        let text = "\n    M5\n{% if tool == 7 %}\n    M6\n{% else %}\n    M7\n{% endif %}\n\n";
        assert_eq!(lines(text).unwrap(), ["M5", "M6"]);
        assert_eq!(lines(" \n ").unwrap(), [""; 0]);
    }

    #[test]
    fn what_is_no_number_or_not_known_is_an_error() {
        for bad in ["{{ toll }}", "{{ 1 / 0 }}", "{{ tool|sqrt }}", "{{ 'x'|round }}", "{{ tool"] {
            assert!(lines(bad).is_err(), "{bad}");
        }
        assert!(lines("{{ tool|pad(1000000000) }}").is_err());
    }

    #[test]
    fn the_title_stays_in_comments() {
        let settle = |source: &str| settled(&lines(source).unwrap()[0], Some(&brackets()));
        assert_eq!(settle("({{ title }})"), Ok("(G0 Z-50)".to_owned()));
        assert_eq!(settle("(for {{ title|lower }}) M5"), Ok("(for g0 z-50) M5".to_owned()));
        for outside in ["{{ title }}", "O1 {{ title }}", "(x) {{ title }}", "({{ ')' ~ title }}"] {
            assert!(settle(outside).is_err(), "{outside}");
        }
        assert!(settled("(\u{e000}x)", None).is_err());
        assert!(settled("(é)", Some(&brackets())).is_err());
    }
}

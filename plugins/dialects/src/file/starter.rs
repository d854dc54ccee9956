//! The text of a new dialect's file: every setting as a comment, with its parent's value.

use super::fields::{FIELDS, Field, Kind, Maybe};
use super::{FORMAT, name_fault, standard_parent, unknown_parent};
use crate::rs274::Rs274;
use carvegraph_core::Diagnostic;
use std::fmt::Write;

/// The text of a file that builds on a standard dialect and changes nothing yet. Each of its settings
/// stands there as a comment, with the parent's value and what it means.
///
/// # Errors
/// If the name is none or taken, or there is no such parent.
pub fn starter(name: &str, parent: &str) -> Result<String, Diagnostic> {
    if let Some(fault) = name_fault(name) {
        return Err(fault);
    }
    let mut settings =
        standard_parent(parent).unwrap_or_else(|| Err(unknown_parent(parent, &[])))?;
    let mut text = format!(
        "// A dialect that builds on {parent}: what is not said here is as there.\n\
         //\n\
         // A line that begins with // and no space is a setting with its present value: take the //\n\
         // away to change it. Lengths are in mm, or carry their unit: \"0.25in\", \"600mm/min\", \"3s\".\n\
         //\n\
         // Texts with {{{{ name }}}} are templates (minijinja): {{{{ value }}}}, {{{{ value|round }}}},\n\
         // {{{{ tool|pad(2) }}}}, {{% if unit == \"inches\" %}} ... {{% endif %}}. They may have several\n\
         // lines; empty ones vanish. All of them know {{{{ title }}}} (in comments only), {{{{ name }}}}\n\
         // and {{{{ number }}}} of the program, {{{{ units }}}} (the word) and {{{{ unit }}}} (its name).\n\
         Dialect(\n    format: {FORMAT},\n    //name: \"{name}\",\n    parent: \"{parent}\",\n"
    );
    for field in FIELDS {
        write_field(&mut text, field, &mut settings, field.name, 1);
    }
    text.push_str(")\n");
    Ok(text)
}

fn write_field(text: &mut String, field: &Field, settings: &mut Rs274, path: &str, depth: usize) {
    let indent = "    ".repeat(depth);
    let line = |text: &mut String, mark: &str, words: &str| {
        let _ = writeln!(text, "{indent}{mark}{words}");
    };
    text.push('\n');
    line(text, "// ", field.about);
    if let Some(values) = values(path, settings) {
        line(text, "// ", &values);
    }
    let name = field.name;
    match &field.kind {
        Kind::Group(fields) => group(text, name, fields, settings, depth),
        Kind::MaybeGroup(Maybe { is_some, .. }, fields) if is_some(settings) => {
            group(text, name, fields, settings, depth);
        }
        kind => {
            let value = value(kind, settings);
            for words in format!("{name}: {value},").lines() {
                line(text, "//", words);
            }
        }
    }
}

fn group(
    text: &mut String,
    name: &str,
    fields: &'static [Field],
    settings: &mut Rs274,
    depth: usize,
) {
    let indent = "    ".repeat(depth);
    let _ = write!(text, "{indent}{name}: (");
    for field in fields {
        write_field(text, field, settings, &format!("{name}.{}", field.name), depth + 1);
    }
    let _ = writeln!(text, "{indent}),");
}

/// What a template may name besides what all may.
fn values(path: &str, settings: &Rs274) -> Option<String> {
    let mut known = None;
    settings.lines.each(|line, _| {
        if line.name == path && !line.values.is_empty() {
            let names: Vec<String> = line.values.iter().map(|v| format!("{{{{ {v} }}}}")).collect();
            known = Some(format!("It also knows {}.", names.join(" and ")));
        }
    });
    known
}

/// A setting as a file says it.
fn value(kind: &Kind, settings: &mut Rs274) -> String {
    match kind {
        Kind::Text(get, _) | Kind::Word(get) => quoted(get(settings)),
        Kind::Template(get) => lines(get(settings)),
        Kind::Words(get) => {
            let words: Vec<String> = get(settings).split_whitespace().map(quoted).collect();
            format!("[{}]", words.join(", "))
        }
        Kind::Switch(get) => get(settings).to_string(),
        Kind::Count(get, _) => get(settings).to_string(),
        Kind::Number(get, dimension, _) => quantity(*get(settings), dimension.base_unit()),
        Kind::MaybeCount(get, _) => get(settings).map_or("none".to_owned(), |n| n.to_string()),
        Kind::MaybeNumber(get, dimension, _) => {
            get(settings).map_or("none".to_owned(), |n| quantity(n, dimension.base_unit()))
        }
        Kind::Choice(choices) => {
            let chosen = choices.iter().find(|choice| (choice.is)(settings));
            quoted(chosen.map_or("", |choice| choice.word))
        }
        Kind::Group(_) | Kind::MaybeGroup(..) => "none".to_owned(),
    }
}

fn quantity(value: f64, unit: &str) -> String {
    format!("\"{value}{unit}\"")
}

/// A template; several lines stand below each other. None is indented: a space behind the `//` of a
/// starter would make a comment of it.
fn lines(text: &str) -> String {
    if text.lines().count() < 2 { quoted(text) } else { quoted(&format!("\n{text}\n")) }
}

/// A text as RON reads it.
fn quoted(text: &str) -> String {
    if text.contains(['"', '\\']) { format!("r#\"{text}\"#") } else { format!("\"{text}\"") }
}

//! What the files of machines and of tools have in common: a format, and names.

use super::NONE;
use carvegraph_core::Diagnostic;
use carvegraph_core::ron::{Fields, Form, Item, Name, ValueKind};
use carvegraph_core::source::Source;
use std::path::Path;

/// The newest format that is read.
const FORMAT: i64 = 1;

/// Longer names are none.
const MAX_NAME_CHARS: usize = 64;

const NAME_HELP: &str = "letters, digits, _ and - do, 64 at most";

/// Whether the format is one that this program reads. A newer file may mean anything by its fields, so
/// that nothing else is to be said about it.
pub(super) fn is_readable(form: &Form, fields: &mut Fields<'_>) -> bool {
    let Some(item) = fields.required("format") else { return true };
    match item.value().kind {
        ValueKind::Integer(format) if format > FORMAT => {
            let message =
                format!("this file has format {format}; this program reads formats up to {FORMAT}");
            let fault = Diagnostic::error(message).at(item.span().clone());
            form.push(fault.help("update carve to use it"));
            false
        }
        ValueKind::Integer(format) if format < 1 => {
            item.fault(format!("there is no format {format}; the first one is 1"));
            true
        }
        _ => item.integer(1..=FORMAT).is_some(),
    }
}

/// A name that recipes can use, complained of where it stands; `what` is "a machine".
pub(super) fn check_name(form: &Form, name: &Name, what: &str) -> bool {
    let fault = match fault_of(&name.text) {
        None => return true,
        Some(fault) => format!("{:?} is no name for {what}{fault}", name.text),
    };
    form.push(Diagnostic::error(fault).at(name.span.clone()).help(NAME_HELP));
    false
}

/// What is wrong with a name.
fn fault_of(name: &str) -> Option<&'static str> {
    let fits = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
    if name == NONE {
        return Some(": it stands for having none");
    }
    let bad = name.is_empty() || name.len() > MAX_NAME_CHARS || !name.chars().all(fits);
    bad.then_some("")
}

/// The name that a file gives, or else its own without extension.
pub(super) fn name_of(
    form: &Form,
    fields: &mut Fields<'_>,
    source: &Source,
    what: &str,
) -> Option<String> {
    if let Some(item) = fields.optional("name") {
        let name = item.name()?;
        return check_name(form, &name, what).then_some(name.text);
    }
    let stem = Path::new(source.name()).file_stem().unwrap_or_default().to_string_lossy();
    if let Some(fault) = fault_of(&stem) {
        let message = format!("the file's name, {stem:?}, is no name for {what}{fault}");
        let help = format!("add the field name; {NAME_HELP}");
        form.push(Diagnostic::error(message).at(fields.span().clone()).help(help));
        return None;
    }
    Some(stem.into_owned())
}

/// A text that may be left out.
pub(super) fn text(item: Option<Item<'_>>) -> String {
    item.and_then(Item::text).unwrap_or_default()
}

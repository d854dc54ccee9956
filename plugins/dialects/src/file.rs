//! Dialects without code: a `.ron` file that says what a controller does differently from another.
//!
//! A file names its parent, one of the standard family or another file's dialect, and overrides some
//! of its settings; [`fields`] lists them all. What is wrong with a file is told all at once, with its
//! place: what no field takes, what contradicts itself, and lines that the dialect must not write.
//! What can only be seen while a program is written (a branch of a template that no sample reached) is
//! refused then.
//!
//! A file is somebody's: it is short, its templates cannot loop or grow, and its numbers have limits.

mod check;
mod fields;
mod groups;
mod read;
mod rules;
mod starter;

use crate::family;
use crate::rs274::Rs274;
use carvegraph_core::diagnostic::did_you_mean;
use carvegraph_core::ron::{self, Name, Value, ValueKind};
use carvegraph_core::source::Source;
use carvegraph_core::{Diagnostic, Diagnostics};
use carvegraph_sdk::Dialect;
use read::Written;
use std::sync::Arc;

pub use starter::starter;

/// The version of the form that this program writes, and the newest that it reads.
pub const FORMAT: i64 = 1;

/// The longest file: several times a starter with all its comments.
const MAX_FILE_BYTES: usize = 64 << 10;

/// The longest name of a dialect.
const MAX_NAME_CHARS: usize = 64;

/// How many dialects from files may build on each other.
const MAX_ANCESTORS: usize = 16;

/// Dialects that have languages of their own.
const NO_PARENTS: [&str; 2] = ["heidenhain", "shopbot"];

/// The text of a dialect's file.
#[derive(Clone, Debug)]
pub struct DialectFile {
    /// The file's name without folder and extension: what the dialect is called if it says nothing
    /// else.
    pub stem: String,
    /// Its text, under the name that errors print.
    pub source: Arc<Source>,
}

impl DialectFile {
    /// What the dialect is called, as far as the file can be read.
    #[must_use]
    pub fn name(&self) -> String {
        let stated = self.value().ok().and_then(|value| match value.kind {
            ValueKind::Struct { fields, .. } => {
                let name = fields.iter().find(|(field, _)| field.text == "name");
                name.and_then(|(_, value)| value.as_str().map(str::to_owned))
            }
            _ => None,
        });
        stated.unwrap_or_else(|| self.stem.clone())
    }

    fn value(&self) -> Result<Value, Diagnostics> {
        let bytes = self.source.text().len();
        if bytes > MAX_FILE_BYTES {
            let message =
                format!("the file has {bytes} bytes; a dialect has at most {MAX_FILE_BYTES}");
            return Err(Diagnostic::error(message).at(self.source.span(0..0)).into());
        }
        ron::parse(&self.source)
    }
}

/// Makes the dialect of a file. Its parent is one of the standard family or of `others`, all the
/// dialects' files there are (the file itself among them does no harm).
///
/// # Errors
/// All that is wrong with the file, or with those it builds on.
pub fn from_file(
    file: &DialectFile,
    others: &[DialectFile],
) -> Result<Box<dyn Dialect>, Diagnostics> {
    let others: Vec<(String, &DialectFile)> =
        others.iter().map(|other| (other.name(), other)).collect();
    Ok(Box::new(settings(file, &others, &mut Vec::new())?))
}

/// The settings of a file's dialect, on those of its parent. `children` are the names of the
/// dialects that build on it.
fn settings(
    file: &DialectFile,
    others: &[(String, &DialectFile)],
    children: &mut Vec<String>,
) -> Result<Rs274, Diagnostics> {
    let value = file.value()?;
    let written = Written::new(file, &value)?;
    let name = written.name.text.clone();
    children.push(name.clone());
    let parent = parent(&written.parent, others, children)?;
    children.pop();
    let (settings, places) = written.over(Rs274 { name: name.into(), ..parent })?;
    check::check(&settings, &places)?;
    Ok(settings)
}

/// The settings that a file builds on.
fn parent(
    name: &Name,
    others: &[(String, &DialectFile)],
    children: &mut Vec<String>,
) -> Result<Rs274, Diagnostics> {
    if let Some(standard) = standard_parent(&name.text) {
        return standard.map_err(|fault| fault.at(name.span.clone()).into());
    }
    let fault = |message: String| Diagnostic::error(message).at(name.span.clone());
    if children.len() > MAX_ANCESTORS {
        let message = format!("more than {MAX_ANCESTORS} dialects build on each other");
        return Err(fault(message)
            .help("build on one that is nearer to a standard dialect")
            .into());
    }
    if children.contains(&name.text) {
        let way = format!("{} builds on {}", children.join(" builds on "), name.text);
        let help = "name a parent that does not build on this dialect";
        return Err(fault(format!("{way}: a dialect cannot build on itself")).help(help).into());
    }
    let mut found = others.iter().filter(|(other, _)| *other == name.text);
    match (found.next(), found.next()) {
        (Some((_, file)), None) => settings(file, others, children),
        (Some((_, one)), Some((_, two))) => {
            let files = format!("{} and {}", one.source.name(), two.source.name());
            let message = format!("there are two dialects {:?}: {files}", name.text);
            Err(fault(message).help("give one of them another name").into())
        }
        _ => {
            let known = others.iter().map(|(name, _)| name.as_str());
            let known = known.filter(|known| !children.iter().any(|child| child == known));
            let known: Vec<&str> = known.collect();
            Err(unknown_parent(&name.text, &known).at(name.span.clone()).into())
        }
    }
}

/// The settings of a standard dialect, if there is one of that name.
fn standard_parent(name: &str) -> Option<Result<Rs274, Diagnostic>> {
    if NO_PARENTS.contains(&name) {
        let message = format!("{name} cannot be a parent: it has a language of its own");
        return Some(Err(Diagnostic::error(message).help("build on a dialect with G-code words")));
    }
    family().into_iter().find(|dialect| dialect.name == name).map(Ok)
}

/// What is wrong with a dialect's name, if anything.
fn name_fault(name: &str) -> Option<Diagnostic> {
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    let begins = name.starts_with(|c: char| c.is_ascii_lowercase());
    if !begins || name.len() > MAX_NAME_CHARS || !name.chars().all(fits) {
        let fault = Diagnostic::error(format!("{name:?} is no name for a dialect"));
        let help = format!(
            "a lower-case letter, then lower-case letters, digits and _, {MAX_NAME_CHARS} at most"
        );
        return Some(fault.help(help));
    }
    if standard_parent(name).is_some() {
        let fault = Diagnostic::error(format!("{name:?} is one of the standard dialects"));
        return Some(fault.help("choose another name"));
    }
    None
}

/// The fault that there is no such parent among the standard dialects and `others`.
fn unknown_parent(name: &str, others: &[&str]) -> Diagnostic {
    let family = family();
    let mut known: Vec<&str> = family.iter().map(|dialect| &*dialect.name).collect();
    known.extend(others);
    known.sort_unstable();
    let fault = Diagnostic::error(format!("there is no dialect {name:?} to build on"));
    fault.help(match did_you_mean(name, known.iter().copied()) {
        Some(near) => format!("did you mean {near:?}?"),
        None => format!("there is {}", known.join(", ")),
    })
}

//! Reads what a file says over its parent's settings.

use super::fields::{FIELDS, Field, Kind, Maybe};
use super::rules::printable;
use super::{DialectFile, FORMAT, name_fault};
use crate::Text;
use crate::rs274::Rs274;
use carvegraph_core::ron::{Fields, Form, Item, Name, Value, ValueKind};
use carvegraph_core::source::Span;
use carvegraph_core::{Diagnostic, Diagnostics};
use std::collections::BTreeMap;

/// The longest word for a block.
const MAX_WORD_CHARS: usize = 16;

/// The most words that a controller rejects.
const MAX_REJECTED: usize = 200;

/// Where a file says what it says: by the path of its fields, such as `words.rapid`.
pub(super) struct Places {
    pub(super) said: BTreeMap<String, Span>,
    /// Where it names its parent, which said the rest.
    pub(super) parent: Span,
}

impl Places {
    /// Where the first of these is said that is; else where the parent is named.
    pub(super) fn of(&self, paths: &[&str]) -> &Span {
        paths.iter().find_map(|path| self.said.get(*path)).unwrap_or(&self.parent)
    }
}

/// A file of which name and parent are known.
pub(super) struct Written<'f> {
    pub(super) name: Name,
    pub(super) parent: Name,
    value: &'f Value,
}

impl<'f> Written<'f> {
    /// Reads what comes before the settings.
    pub(super) fn new(file: &DialectFile, value: &'f Value) -> Result<Self, Diagnostics> {
        let form = Form::default();
        let read = header(&form, file, value);
        form.finish(read)
    }

    /// Its settings, with its parent's where it says nothing.
    pub(super) fn over(self, settings: Rs274) -> Result<(Rs274, Places), Diagnostics> {
        let form = Form::default();
        let places = Places { said: BTreeMap::new(), parent: self.parent.span };
        let mut reader = Reader { settings, places };
        let read =
            form.item(self.value, "the dialect").fields(Some("Dialect")).map(|mut fields| {
                for taken in ["format", "name", "parent"] {
                    fields.optional(taken);
                }
                reader.fields(fields, FIELDS, "");
            });
        form.finish(read).map(|()| (reader.settings, reader.places))
    }
}

fn header<'f>(form: &Form, file: &DialectFile, value: &'f Value) -> Option<Written<'f>> {
    let mut fields = form.item(value, "the dialect").fields(Some("Dialect"))?;
    let format = fields.required("format");
    if let Some(format) = format
        && is_newer(form, &format)
    {
        return None;
    }
    let name = match fields.optional("name") {
        Some(item) => item.name()?,
        None => Name { text: file.stem.clone(), span: file.source.span(0..0) },
    };
    if let Some(fault) = name_fault(&name.text) {
        form.push(fault.at(name.span.clone()));
    }
    let parent = fields.required("parent").and_then(Item::name);
    Some(Written { name, parent: parent?, value })
}

/// Whether the format is newer than what this program reads. Such a one may mean anything by its
/// fields, so nothing else is said about it.
fn is_newer(form: &Form, item: &Item<'_>) -> bool {
    if let ValueKind::Integer(format) = item.value().kind
        && format > FORMAT
    {
        let message =
            format!("this dialect has format {format}; this program reads formats up to {FORMAT}");
        form.push(
            Diagnostic::error(message).at(item.span().clone()).help("update carve to use it"),
        );
        return true;
    }
    item.clone().integer(1..=FORMAT);
    false
}

struct Reader {
    settings: Rs274,
    places: Places,
}

impl Reader {
    fn fields(&mut self, mut fields: Fields<'_>, known: &'static [Field], group: &str) {
        for field in known {
            if let Some(item) = fields.optional(field.name) {
                let path = format!("{group}{}", field.name);
                self.places.said.insert(path.clone(), item.span().clone());
                self.field(item, &field.kind, &path);
            }
        }
        fields.no_more();
    }

    /// Sets one setting, or tells why not.
    fn field(&mut self, item: Item<'_>, kind: &'static Kind, path: &str) -> Option<()> {
        let settings = &mut self.settings;
        match kind {
            Kind::Text(get, bad) => {
                *get(settings) = text(item, |text| bad(text).map(str::to_owned))?
            }
            Kind::Word(get) => *get(settings) = text(item, bad_word)?,
            Kind::Template(get) => {
                let text = item.text()?;
                *get(settings) = if text.trim().is_empty() { "".into() } else { text.into() };
            }
            Kind::Words(get) => *get(settings) = words(item)?,
            Kind::Switch(get) => *get(settings) = item.switch()?,
            Kind::Count(get, range) => *get(settings) = count(item, *range)?,
            Kind::Number(get, dimension, [least, most]) => {
                *get(settings) = item.number(*dimension, *least..=*most)?;
            }
            Kind::MaybeCount(get, range) => {
                *get(settings) = if is_none(&item) { None } else { Some(count(item, *range)?) };
            }
            Kind::MaybeNumber(get, dimension, [least, most]) => {
                let none = is_none(&item);
                let read = |item: Item<'_>| item.number(*dimension, *least..=*most);
                *get(settings) = if none { None } else { Some(read(item)?) };
            }
            Kind::Choice(choices) => {
                let options: Vec<_> = choices.iter().map(|c| (c.word, c.set)).collect();
                item.choice(&options)?(settings);
            }
            Kind::Group(known) => self.fields(item.fields(None)?, known, &format!("{path}.")),
            Kind::MaybeGroup(Maybe { clear, .. }, _) if is_none(&item) => clear(settings),
            Kind::MaybeGroup(Maybe { fill, .. }, known) => {
                fill(settings);
                self.fields(item.fields(None)?, known, &format!("{path}."));
            }
        }
        Some(())
    }
}

/// Whether it says `none`, in quotes or not.
fn is_none(item: &Item<'_>) -> bool {
    match &item.value().kind {
        ValueKind::Word(word) | ValueKind::Text(word) => word.eq_ignore_ascii_case("none"),
        _ => false,
    }
}

fn text(item: Item<'_>, bad: impl Fn(&str) -> Option<String>) -> Option<Text> {
    let text = item.clone().text()?;
    match bad(&text) {
        Some(why) => {
            item.fault(format!("{text:?} does not do: it {why}"));
            None
        }
        None => Some(text.into()),
    }
}

fn bad_word(word: &str) -> Option<String> {
    let fits = !word.is_empty() && word.len() <= MAX_WORD_CHARS && printable(word);
    let plain =
        fits && word.starts_with(|c: char| c.is_ascii_alphanumeric()) && !word.contains(' ');
    (!plain).then(|| {
        format!("must be one word such as G1, in ASCII and {MAX_WORD_CHARS} characters at most")
    })
}

fn count(item: Item<'_>, [least, most]: [u32; 2]) -> Option<u32> {
    let count = item.integer(i64::from(least)..=i64::from(most))?;
    u32::try_from(count).ok()
}

/// A list of words as one text, blanks between them.
fn words(item: Item<'_>) -> Option<Text> {
    let names = item.clone().names()?;
    if names.len() > MAX_REJECTED {
        item.fault(format!("{} words are too many; {MAX_REJECTED} at most", names.len()));
        return None;
    }
    let items = item.list()?;
    let words = items.into_iter().map(|item| text(item, bad_rejected));
    let words: Option<Vec<Text>> = words.collect();
    Some(words?.join(" ").into())
}

/// A word, or a sign such as `%`.
fn bad_rejected(word: &str) -> Option<String> {
    let sign = word.len() == 1 && word.bytes().all(|b| b.is_ascii_punctuation());
    if sign { None } else { bad_word(word) }
}

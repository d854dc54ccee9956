//! Values read as the structs they are to be: what is missing, unknown or of the wrong type is told
//! with its place.
//!
//! A [`Form`] collects the faults, so that all of them are told at once. An [`Item`] is a value and
//! what messages call it; it is read as a text, a number with a unit, a list and so on. [`Fields`]
//! are the fields of a struct, taken out one by one; what is left in the end is unknown. A reading
//! that gives `None` has told why, unless the field is optional and not there.
//!
//! ```
//! use carvegraph_core::ron::{Form, Item, parse};
//! use carvegraph_core::source::Source;
//! use carvegraph_core::units::Dimension;
//! use carvegraph_core::Diagnostics;
//! use std::sync::Arc;
//!
//! #[derive(Debug, PartialEq)]
//! struct Machine {
//!     name: String,
//!     travel_mm: f64,
//!     spindle_rpm: Option<f64>,
//! }
//!
//! fn read(name: &str, text: &str) -> Result<Machine, Diagnostics> {
//!     let value = parse(&Arc::new(Source::new(name, text)))?;
//!     let form = Form::default();
//!     let machine = machine(form.item(&value, "the machine"));
//!     form.finish(machine)
//! }
//!
//! fn machine(item: Item<'_>) -> Option<Machine> {
//!     let mut fields = item.fields(Some("Machine"))?;
//!     let name = fields.required("name").and_then(Item::text);
//!     let travel = fields.required("travel");
//!     let travel_mm = travel.and_then(|item| item.number(Dimension::Length, 1.0..=10_000.0));
//!     let spindle = fields.optional("spindle");
//!     let spindle_rpm = spindle.and_then(|item| item.number(Dimension::Spindle, 1.0..=60_000.0));
//!     fields.no_more();
//!     Some(Machine { name: name?, travel_mm: travel_mm?, spindle_rpm })
//! }
//!
//! let machine = read("my.ron", r#"Machine(name: "mill", travel: "30cm")"#).unwrap();
//! assert_eq!(machine, Machine { name: "mill".into(), travel_mm: 300.0, spindle_rpm: None });
//!
//! let faults = read("my.ron", r#"(name: 5, travl: 300)"#).unwrap_err().to_string();
//! assert!(faults.contains("name must be a text in double quotes, not a whole number"));
//! assert!(faults.contains("the machine lacks the field \"travel\""));
//! assert!(faults.contains("the machine has no field \"travl\""));
//! assert!(faults.contains("--> my.ron:1:11"));
//! ```

use super::{Name, Value, ValueKind};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::param::{Given, ParamFault, check_range, number, place_among, whole};
use crate::source::Span;
use crate::units::Dimension;
use std::cell::RefCell;
use std::ops::RangeInclusive;

/// The faults found while a value is read.
#[derive(Debug, Default)]
pub struct Form {
    faults: RefCell<Diagnostics>,
}

impl Form {
    /// The value to begin with; `what` is what messages call it, such as "the machine".
    pub fn item<'a>(&'a self, value: &'a Value, what: &str) -> Item<'a> {
        Item { form: self, what: what.to_owned(), value }
    }

    /// Tells a fault.
    pub fn push(&self, fault: Diagnostic) {
        self.faults.borrow_mut().push(fault);
    }

    /// Tells a fault at a place.
    pub fn fault(&self, span: &Span, message: impl Into<String>) {
        self.push(Diagnostic::error(message).at(span.clone()));
    }

    /// What was read, or all that is wrong with it.
    ///
    /// # Errors
    /// If any fault was told, or nothing was read.
    pub fn finish<T>(self, read: Option<T>) -> Result<T, Diagnostics> {
        let mut faults = self.faults.into_inner();
        match read {
            Some(read) if !faults.has_errors() => return Ok(read),
            None if !faults.has_errors() => faults.push(Diagnostic::error("something is missing")),
            _ => {}
        }
        Err(faults)
    }
}

/// A value, and what messages call it.
#[derive(Clone)]
pub struct Item<'a> {
    form: &'a Form,
    what: String,
    value: &'a Value,
}

impl<'a> Item<'a> {
    /// The value as it stands.
    pub fn value(&self) -> &'a Value {
        self.value
    }

    /// Where it stands.
    pub fn span(&self) -> &'a Span {
        &self.value.span
    }

    /// The same value under another name for messages.
    #[must_use]
    pub fn called(self, what: impl Into<String>) -> Self {
        Self { what: what.into(), ..self }
    }

    /// Tells a fault at its place.
    pub fn fault(&self, message: impl Into<String>) {
        self.form.fault(self.span(), message);
    }

    /// Tells that it is of the wrong kind; `wanted` has an article: "a number".
    pub fn mismatch<T>(&self, wanted: &str) -> Option<T> {
        self.form.push(self.value.mismatch(&self.what, wanted));
        None
    }

    fn told<T>(&self, read: Result<T, ParamFault>) -> Option<T> {
        let tell = |ParamFault { message, help }: ParamFault| {
            let fault = Diagnostic::error(message).at(self.span().clone());
            self.form.push(Diagnostic { help: help.map(Into::into), ..fault });
        };
        read.map_err(tell).ok()
    }

    /// A text.
    pub fn text(self) -> Option<String> {
        self.name().map(|name| name.text)
    }

    /// A text and its place.
    pub fn name(self) -> Option<Name> {
        let read = self.value.as_text(&self.what);
        let text = read.map_err(|fault| self.form.push(fault)).ok()?.to_owned();
        Some(Name { text, span: self.span().clone() })
    }

    /// true or false.
    pub fn switch(self) -> Option<bool> {
        self.value.as_bool().or_else(|| self.mismatch("true or false"))
    }

    /// A whole number without unit.
    pub fn integer(self, range: RangeInclusive<i64>) -> Option<i64> {
        self.told(whole(&self.what, Given::Literal(self.value), range, Dimension::Plain))
    }

    /// A finite number in the dimension's base unit, written as a number or as a text with a unit.
    /// With [`f64::MIN_POSITIVE`] the range begins behind 0.
    pub fn number(self, dimension: Dimension, range: RangeInclusive<f64>) -> Option<f64> {
        let value = self.told(number(&self.what, Given::Literal(self.value), dimension))?;
        self.told(check_range(&self.what, value, range, dimension)).map(|()| value)
    }

    /// One of a few words, each with what it means.
    pub fn choice<T: Clone>(self, options: &[(&str, T)]) -> Option<T> {
        let word = self.clone().text()?;
        let words: Vec<&str> = options.iter().map(|(word, _)| *word).collect();
        let at = self.told(place_among(&self.what, &word, &words))?;
        Some(options[at].1.clone())
    }

    /// The items of a list, all called as the list is.
    pub fn list(self) -> Option<Vec<Item<'a>>> {
        match &self.value.kind {
            ValueKind::List(items) => {
                Some(items.iter().map(|item| self.form.item(item, &self.what)).collect())
            }
            _ => self.mismatch("a list [...]"),
        }
    }

    /// The texts of a list and their places; those that are none are told and left out.
    pub fn names(self) -> Option<Vec<Name>> {
        Some(self.list()?.into_iter().filter_map(Item::name).collect())
    }

    /// The entries of a map whose keys are texts, in the order written, each called by its key.
    pub fn entries(self) -> Option<Vec<(Name, Item<'a>)>> {
        let ValueKind::Map(entries) = &self.value.kind else {
            return self.mismatch("a map {...}");
        };
        let key = format!("a key of {}", self.what);
        let entry = |(key_value, value): &'a (Value, Value)| {
            let name = self.form.item(key_value, &key).name()?;
            let item = self.form.item(value, &name.text);
            Some((name, item))
        };
        Some(entries.iter().filter_map(entry).collect())
    }

    /// The fields of a struct. `named` is the word that may stand before the bracket.
    pub fn fields(self, named: Option<&str>) -> Option<Fields<'a>> {
        let Self { form, what, value } = self;
        let (name, fields) = match &value.kind {
            ValueKind::Struct { name, fields } => (name.as_ref(), fields.as_slice()),
            ValueKind::Unit => (None, [].as_slice()),
            _ => return form.item(value, &what).mismatch("fields in (...)"),
        };
        if let Some(Name { text, span }) = name
            && named != Some(text.as_str())
        {
            let wanted =
                named.map_or("nothing".to_owned(), |named| format!("{named:?} or nothing"));
            form.fault(span, format!("before the fields of {what} stands {wanted}, not {text:?}"));
        }
        let left = fields.iter().map(|(name, value)| (name, value)).collect();
        Some(Fields { form, what, span: &value.span, left, known: Vec::new() })
    }
}

/// The fields of a struct, taken out one by one.
pub struct Fields<'a> {
    form: &'a Form,
    what: String,
    span: &'a Span,
    left: Vec<(&'a Name, &'a Value)>,
    known: Vec<&'static str>,
}

impl<'a> Fields<'a> {
    /// Where the struct stands.
    pub fn span(&self) -> &'a Span {
        self.span
    }

    /// A field that may be left out.
    pub fn optional(&mut self, name: &'static str) -> Option<Item<'a>> {
        self.known.push(name);
        let at = self.left.iter().position(|(known, _)| known.text == name)?;
        Some(self.form.item(self.left.remove(at).1, name))
    }

    /// A field that may not be left out.
    pub fn required(&mut self, name: &'static str) -> Option<Item<'a>> {
        let item = self.optional(name);
        if item.is_none() {
            self.form.fault(self.span, format!("{} lacks the field {name:?}", self.what));
        }
        item
    }

    /// Complains about the fields that nobody took.
    pub fn no_more(self) {
        self.no_more_but_say(|_| None);
    }

    /// Complains about the fields that nobody took; `help` knows what to say of some of them.
    pub fn no_more_but_say(self, help: impl Fn(&str) -> Option<&'static str>) {
        for (name, _) in &self.left {
            let message = format!("{} has no field {:?}", self.what, name.text);
            let fault = Diagnostic::error(message).at(name.span.clone());
            match help(&name.text) {
                Some(help) => self.form.push(fault.help(help)),
                None => {
                    let known = self.known.iter().copied();
                    self.form.faults.borrow_mut().push_near(fault, &name.text, known);
                }
            }
        }
    }
}

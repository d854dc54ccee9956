//! Values of parameters.

use crate::files::{InputFile, OutputName};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// A value that fulfils a [`ParamSpec`](super::ParamSpec).
#[derive(Clone, Debug, PartialEq)]
pub enum ParamValue {
    /// Of a [`ParamKind::Number`](super::ParamKind::Number), in its base unit.
    Number(f64),
    /// Of a [`ParamKind::Integer`](super::ParamKind::Integer).
    Integer(i64),
    /// Of a [`ParamKind::Switch`](super::ParamKind::Switch).
    Switch(bool),
    /// Of a text, choice or catalog name.
    Text(String),
    /// Of a [`ParamKind::InputFile`](super::ParamKind::InputFile).
    File(InputFile),
    /// Of a [`ParamKind::OutputName`](super::ParamKind::OutputName).
    Output(OutputName),
}

impl ParamValue {
    /// The text of a text, choice or catalog name; empty for anything else.
    #[must_use]
    pub fn text(&self) -> &str {
        match self {
            Self::Text(text) => text,
            _ => "",
        }
    }

    /// The number, if it is one, whole or not.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Integer(number) => Some(*number as f64),
            _ => None,
        }
    }

    /// The file to read, if it is one.
    #[must_use]
    pub fn file(&self) -> Option<&InputFile> {
        match self {
            Self::File(file) => Some(file),
            _ => None,
        }
    }
}

impl fmt::Display for ParamValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => write!(f, "{value}"),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Switch(value) => write!(f, "{value}"),
            Self::Text(text) => f.write_str(text),
            Self::File(file) => write!(f, "{file}"),
            Self::Output(name) => f.write_str(name.pattern()),
        }
    }
}

/// All parameters of one node, each set or at its default; those of the catalog entries that it
/// chose stand among them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParamValues {
    values: BTreeMap<&'static str, ParamValue>,
    /// Those that a recipe or a user set.
    set: BTreeSet<&'static str>,
    /// The names of the parameters that came with an entry, by the parameter that chose it.
    entries: BTreeMap<&'static str, Vec<&'static str>>,
}

impl ParamValues {
    /// Sets a parameter, as a recipe or a user does.
    pub fn insert(&mut self, name: &'static str, value: ParamValue) {
        self.values.insert(name, value);
        self.set.insert(name);
    }

    /// Leaves a parameter at its default.
    pub fn leave(&mut self, name: &'static str, default: ParamValue) {
        self.values.insert(name, default);
        self.set.remove(name);
    }

    /// Says which parameters came with the entry that `chooser` chose.
    pub(crate) fn name_entry(&mut self, chooser: &'static str, names: Vec<&'static str>) {
        self.entries.insert(chooser, names);
    }

    /// The value of a parameter of this node's definition.
    ///
    /// # Panics
    /// If the parameter was never set; checking a recipe sets them all.
    #[must_use]
    pub fn get(&self, name: &str) -> &ParamValue {
        self.find(name).unwrap_or_else(|| unreachable!("{name} is set when a recipe is checked"))
    }

    /// The value of a parameter, if the node has it: the entry that it chose may lack it.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&ParamValue> {
        self.values.get(name)
    }

    /// Whether a recipe or a user set a parameter, be it to its default.
    #[must_use]
    pub fn is_set(&self, name: &str) -> bool {
        self.set.contains(name)
    }

    /// The parameters of the entry that `chooser` chose.
    #[must_use]
    pub fn of_entry(&self, chooser: &str) -> EntryParams {
        let names = || self.entries.get(chooser).into_iter().flatten().copied();
        let values = names().filter_map(|name| Some((name, self.find(name)?.clone()))).collect();
        EntryParams { values, set: names().filter(|name| self.is_set(name)).collect() }
    }

    /// All parameters by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &ParamValue)> {
        self.values.iter().map(|(name, value)| (*name, value))
    }
}

/// The parameters of the catalog entry that another parameter of the node chose, each set or at its
/// default: the type of a field with `#[param(entry_of = "…")]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EntryParams {
    values: BTreeMap<&'static str, ParamValue>,
    /// Those that a recipe or a user set.
    set: BTreeSet<&'static str>,
}

impl EntryParams {
    /// The value of a parameter, if the entry has it.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&ParamValue> {
        self.values.get(name)
    }

    /// Whether a recipe or a user set a parameter. A node that asks lets its values depend on it with
    /// [`ParamSpec::yields`](crate::ParamSpec::yields).
    #[must_use]
    pub fn is_set(&self, name: &str) -> bool {
        self.set.contains(name)
    }

    /// The file that a parameter names, if the entry has such a one.
    #[must_use]
    pub fn file(&self, name: &str) -> Option<&InputFile> {
        self.get(name)?.file()
    }

    /// Those that are numbers, by name.
    pub fn numbers(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.iter().filter_map(|(name, value)| Some((name, value.number()?)))
    }

    /// All of them by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &ParamValue)> {
        self.values.iter().map(|(name, value)| (*name, value))
    }
}

/// What is put together so counts as set.
impl FromIterator<(&'static str, ParamValue)> for EntryParams {
    fn from_iter<I: IntoIterator<Item = (&'static str, ParamValue)>>(values: I) -> Self {
        let values: BTreeMap<_, _> = values.into_iter().collect();
        Self { set: values.keys().copied().collect(), values }
    }
}

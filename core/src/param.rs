//! Parameters of nodes: what a definition says of them, and values that fulfil it.
//!
//! A node's struct is the one place where a parameter stands. `#[derive(Params)]` turns each field
//! into a [`ParamSpec`]; [`ParamSpec::read`] turns what a recipe or a command line says into a
//! [`ParamValue`], or says what is wrong with it.

use crate::catalog::Catalogs;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::files::{InputFile, OutputName};
use crate::ron::{self, ValueKind};
use crate::units::{self, Dimension};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::RangeInclusive;

/// One word a parameter may be set to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ChoiceOption {
    /// The word.
    pub name: &'static str,
    /// What it means.
    pub about: &'static str,
}

/// What values a parameter takes.
#[derive(Clone, Debug, PartialEq)]
pub enum ParamKind {
    /// A number with a unit.
    Number {
        /// What it measures.
        dimension: Dimension,
        /// Least value, in the dimension's base unit.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// A whole number.
    Integer {
        /// What it counts.
        dimension: Dimension,
        /// Least value.
        min: i64,
        /// Greatest value.
        max: i64,
        /// Whether only odd values do.
        odd: bool,
    },
    /// true or false.
    Switch,
    /// Free text.
    Text,
    /// One of a few words.
    Choice(&'static [ChoiceOption]),
    /// A name from one of the engine's catalogs, such as its dialects.
    Catalog(&'static str),
    /// A file to read.
    InputFile,
    /// The name of a file to write inside the output folder.
    OutputName,
}

/// What values a parameter takes, for a user: "0.1 to 10000 mm", "one of open, closed".
impl fmt::Display for ParamKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number { dimension, min, max } => {
                f.write_str("number")?;
                fmt_range(f, *dimension, *min, *max)
            }
            Self::Integer { dimension, min, max, odd } => {
                f.write_str(if *odd { "odd whole number" } else { "whole number" })?;
                fmt_range(f, *dimension, *min as f64, *max as f64)
            }
            Self::Switch => f.write_str("true or false"),
            Self::Text => f.write_str("text"),
            Self::Choice(options) => {
                let names: Vec<&str> = options.iter().map(|option| option.name).collect();
                write!(f, "one of {}", names.join(", "))
            }
            Self::Catalog(catalog) => write!(f, "a {catalog}'s name (carve {catalog}s)"),
            Self::InputFile => f.write_str("file to read"),
            Self::OutputName => f.write_str("name of a file to write"),
        }
    }
}

fn fmt_range(f: &mut fmt::Formatter<'_>, of: Dimension, min: f64, max: f64) -> fmt::Result {
    let unit = of.base_unit();
    match (min == f64::MIN_POSITIVE, min.is_finite(), max.is_finite()) {
        (true, ..) => write!(f, ", more than 0 up to {max}")?,
        (_, true, true) => write!(f, ", {min} to {max}")?,
        (_, true, false) => write!(f, ", {min} or more")?,
        (_, false, true) => write!(f, ", {max} or less")?,
        (_, false, false) => {}
    }
    if unit.is_empty() { Ok(()) } else { write!(f, " {unit}") }
}

/// The definition of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamSpec {
    /// Its name in recipes.
    pub name: &'static str,
    /// What it does, for a user.
    pub about: &'static str,
    /// What values it takes.
    pub kind: ParamKind,
    /// Its value where a recipe says nothing; without one the recipe must say something.
    pub default: Option<ParamValue>,
}

/// What a field's `#[param(…)]` says, as the derive hands it over.
#[derive(Clone, Debug)]
pub struct ParamHints {
    /// Unit of a number.
    pub unit: Option<&'static str>,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Whether only odd values do.
    pub odd: bool,
    /// Catalog that a name comes from.
    pub catalog: Option<&'static str>,
}

/// A value that fulfils a [`ParamSpec`].
#[derive(Clone, Debug, PartialEq)]
pub enum ParamValue {
    /// Of a [`ParamKind::Number`], in its base unit.
    Number(f64),
    /// Of a [`ParamKind::Integer`].
    Integer(i64),
    /// Of a [`ParamKind::Switch`].
    Switch(bool),
    /// Of a text, choice or catalog name.
    Text(String),
    /// Of a [`ParamKind::InputFile`].
    File(InputFile),
    /// Of a [`ParamKind::OutputName`].
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

/// All parameters of one node, each set or at its default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParamValues(BTreeMap<&'static str, ParamValue>);

impl ParamValues {
    /// Sets a parameter.
    pub fn insert(&mut self, name: &'static str, value: ParamValue) {
        self.0.insert(name, value);
    }

    /// The value of a parameter of this node's definition.
    ///
    /// # Panics
    /// If the parameter was never set; checking a recipe sets them all.
    #[must_use]
    pub fn get(&self, name: &str) -> &ParamValue {
        self.0.get(name).unwrap_or_else(|| unreachable!("{name} is set when a recipe is checked"))
    }

    /// All parameters by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &ParamValue)> {
        self.0.iter().map(|(name, value)| (*name, value))
    }
}

/// A struct that holds the parameters of a node; derive it.
///
/// ```
/// /// Softens steps.
/// #[derive(carvegraph_core::Params)]
/// struct Blur {
///     /// Width of the kernel.
///     #[param(unit = "px", default = 5, range = 1..=255, odd)]
///     kernel: u32,
/// }
/// ```
///
/// Users read the doc comments, so none may be missing:
///
/// ```compile_fail
/// /// Softens steps.
/// #[derive(carvegraph_core::Params)]
/// struct Blur {
///     #[param(unit = "px", default = 5, range = 1..=255, odd)]
///     kernel: u32,
/// }
/// ```
pub trait Params: Sized {
    /// What the node does, from the struct's doc comment.
    fn about() -> &'static str;
    /// The parameters, in the order of the fields.
    fn specs() -> Vec<ParamSpec>;
    /// The struct made of checked values.
    fn from_values(values: &ParamValues) -> Self;
}

/// A type that a field of a [`Params`] struct may have.
pub trait ParamField: Sized {
    /// What values it takes.
    fn kind(hints: &ParamHints) -> ParamKind;
    /// A default as a value.
    fn to_value(&self) -> ParamValue;
    /// The field made of a checked value.
    fn from_value(value: &ParamValue) -> Self;
}

fn dimension(hints: &ParamHints) -> Dimension {
    match hints.unit {
        None => Dimension::Plain,
        Some(unit) => Dimension::of_unit(unit)
            .unwrap_or_else(|| unreachable!("the registry's test knows every unit: {unit}")),
    }
}

impl ParamField for f64 {
    fn kind(hints: &ParamHints) -> ParamKind {
        ParamKind::Number { dimension: dimension(hints), min: hints.min, max: hints.max }
    }

    fn to_value(&self) -> ParamValue {
        ParamValue::Number(*self)
    }

    fn from_value(value: &ParamValue) -> Self {
        match value {
            ParamValue::Number(number) => *number,
            other => unreachable!("{other} was checked to be a number"),
        }
    }
}

impl ParamField for u32 {
    fn kind(hints: &ParamHints) -> ParamKind {
        ParamKind::Integer {
            dimension: dimension(hints),
            min: hints.min.max(0.0) as i64,
            max: hints.max.min(f64::from(Self::MAX)) as i64,
            odd: hints.odd,
        }
    }

    fn to_value(&self) -> ParamValue {
        ParamValue::Integer(i64::from(*self))
    }

    fn from_value(value: &ParamValue) -> Self {
        match value {
            ParamValue::Integer(number) => u32::try_from(*number).unwrap_or(Self::MAX),
            other => unreachable!("{other} was checked to be a whole number"),
        }
    }
}

impl ParamField for bool {
    fn kind(_: &ParamHints) -> ParamKind {
        ParamKind::Switch
    }

    fn to_value(&self) -> ParamValue {
        ParamValue::Switch(*self)
    }

    fn from_value(value: &ParamValue) -> Self {
        matches!(value, ParamValue::Switch(true))
    }
}

impl ParamField for String {
    fn kind(hints: &ParamHints) -> ParamKind {
        hints.catalog.map_or(ParamKind::Text, ParamKind::Catalog)
    }

    fn to_value(&self) -> ParamValue {
        ParamValue::Text(self.clone())
    }

    fn from_value(value: &ParamValue) -> Self {
        value.text().to_owned()
    }
}

impl ParamField for InputFile {
    fn kind(_: &ParamHints) -> ParamKind {
        ParamKind::InputFile
    }

    fn to_value(&self) -> ParamValue {
        ParamValue::File(self.clone())
    }

    fn from_value(value: &ParamValue) -> Self {
        match value {
            ParamValue::File(file) => file.clone(),
            other => unreachable!("{other} was checked to be a file"),
        }
    }
}

impl ParamField for OutputName {
    fn kind(_: &ParamHints) -> ParamKind {
        ParamKind::OutputName
    }

    fn to_value(&self) -> ParamValue {
        ParamValue::Output(self.clone())
    }

    fn from_value(value: &ParamValue) -> Self {
        match value {
            ParamValue::Output(name) => name.clone(),
            other => unreachable!("{other} was checked to be an output name"),
        }
    }
}

/// What a recipe or a command line gives for a parameter.
#[derive(Clone, Copy, Debug)]
pub enum Given<'a> {
    /// A literal of a recipe.
    Literal(&'a ron::Value),
    /// A word of a command line: taken as whatever the parameter wants.
    Word(&'a str),
}

/// What is wrong with a given value, and what to do about it.
#[derive(Debug, PartialEq)]
pub struct ParamFault {
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
}

impl ParamFault {
    fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None }
    }

    fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

impl ParamSpec {
    /// Reads a given value. Files are resolved with `locate`.
    ///
    /// # Errors
    /// If the value is of the wrong type, unit or range, or not among the options.
    pub fn read(
        &self,
        given: Given<'_>,
        catalogs: &Catalogs,
        locate: &dyn Fn(&str) -> InputFile,
    ) -> Result<ParamValue, ParamFault> {
        match &self.kind {
            ParamKind::Number { dimension, min, max } => {
                let value = self.number(given, *dimension)?;
                self.check_range(value, *min, *max, *dimension)?;
                Ok(ParamValue::Number(value))
            }
            ParamKind::Integer { dimension, min, max, odd } => {
                let value = self.number(given, *dimension)?;
                self.check_range(value, *min as f64, *max as f64, *dimension)?;
                self.whole(value, *odd, *min..=*max).map(ParamValue::Integer)
            }
            ParamKind::Switch => self.switch(given).map(ParamValue::Switch),
            ParamKind::Text => self.text(given).map(|text| ParamValue::Text(text.to_owned())),
            ParamKind::Choice(options) => {
                let names: Vec<&str> = options.iter().map(|option| option.name).collect();
                self.one_of(self.text(given)?, &names)
            }
            ParamKind::Catalog(catalog) => {
                let names: Vec<&str> = catalogs.names(catalog).collect();
                self.one_of(self.text(given)?, &names)
            }
            ParamKind::InputFile => match self.text(given)? {
                "" => Err(ParamFault::new(format!("{} names no file", self.name))),
                path => Ok(ParamValue::File(locate(path))),
            },
            ParamKind::OutputName => OutputName::new(self.text(given)?)
                .map(ParamValue::Output)
                .map_err(|fault| ParamFault::new(format!("{}: {fault}", self.name))),
        }
    }

    fn number(&self, given: Given<'_>, dimension: Dimension) -> Result<f64, ParamFault> {
        let fault = |fault: units::UnitError| ParamFault::new(format!("{}: {fault}", self.name));
        let value = match given {
            Given::Word(word) => units::parse_quantity(word, dimension).map_err(fault)?,
            Given::Literal(value) => match &value.kind {
                ValueKind::Integer(number) => *number as f64,
                ValueKind::Number(number) => *number,
                ValueKind::Text(text) => units::parse_quantity(text, dimension).map_err(fault)?,
                _ => return Err(self.wrong_type("a number", value.describe())),
            },
        };
        if value.is_finite() {
            return Ok(value);
        }
        Err(ParamFault::new(format!("{} must be a finite number, not {value}", self.name)))
    }

    fn check_range(
        &self,
        value: f64,
        min: f64,
        max: f64,
        dimension: Dimension,
    ) -> Result<(), ParamFault> {
        if (min..=max).contains(&value) {
            return Ok(());
        }
        let unit = dimension.base_unit();
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let wanted = match (min.is_finite(), max.is_finite()) {
            _ if min == f64::MIN_POSITIVE && value <= 0.0 => format!("more than 0{unit}"),
            (true, true) if min == f64::MIN_POSITIVE => format!("at most {max}{unit}"),
            (true, true) => format!("between {min} and {max}{unit}"),
            (true, false) => format!("at least {min}{unit}"),
            _ => format!("at most {max}{unit}"),
        };
        Err(ParamFault::new(format!("{} must be {wanted}, not {value}", self.name)))
    }

    fn whole(&self, value: f64, odd: bool, range: RangeInclusive<i64>) -> Result<i64, ParamFault> {
        if value.fract() != 0.0 {
            let message = format!("{} must be a whole number, not {value}", self.name);
            return Err(ParamFault::new(message));
        }
        let value = value as i64;
        if odd && value % 2 == 0 {
            let message = format!("{} must be odd, not {value}", self.name);
            let near = [value - 1, value + 1].into_iter().filter(|near| range.contains(near));
            let near: Vec<String> = near.map(|near| near.to_string()).collect();
            return Err(ParamFault::new(message).help(format!("take {}", near.join(" or "))));
        }
        Ok(value)
    }

    fn switch(&self, given: Given<'_>) -> Result<bool, ParamFault> {
        let word = match given {
            Given::Word(word) => word,
            Given::Literal(value) => match value.as_bool() {
                Some(on) => return Ok(on),
                None => return Err(self.wrong_type("true or false", value.describe())),
            },
        };
        match word {
            "true" => Ok(true),
            "false" => Ok(false),
            _ => Err(self.wrong_type("true or false", &format!("{word:?}"))),
        }
    }

    fn text<'a>(&self, given: Given<'a>) -> Result<&'a str, ParamFault> {
        match given {
            Given::Word(word) => Ok(word),
            Given::Literal(value) => {
                let fault = |fault: Diagnostic| ParamFault {
                    message: fault.message,
                    help: fault.help.map(String::from),
                };
                value.as_text(self.name).map_err(fault)
            }
        }
    }

    fn wrong_type(&self, wanted: &str, got: &str) -> ParamFault {
        ParamFault::new(format!("{} must be {wanted}, not {got}", self.name))
    }

    fn one_of(&self, word: &str, names: &[&str]) -> Result<ParamValue, ParamFault> {
        if names.contains(&word) {
            return Ok(ParamValue::Text(word.to_owned()));
        }
        let fault = ParamFault::new(format!("{} cannot be {word:?}", self.name));
        let options = format!("one of {}", names.join(", "));
        Err(fault.help(match did_you_mean(word, names.iter().copied()) {
            Some(near) => format!("did you mean {near:?}? It is {options}"),
            None => format!("it is {options}"),
        }))
    }
}

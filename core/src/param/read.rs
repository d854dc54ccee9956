//! What a recipe or a command line says, read as what a parameter wants.
//!
//! The functions below the definition serve whatever is read from `.ron` files, see
//! [`form`](crate::ron::form); `what` is what messages call the value by.

use super::{NO_FILE, ParamKind, ParamSpec, ParamValue};
use crate::catalog::Catalogs;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::files::{InputFile, OutputName};
use crate::ron::{self, ValueKind};
use crate::trust;
use crate::units::{self, Dimension};
use std::ops::RangeInclusive;

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

impl From<Diagnostic> for ParamFault {
    fn from(fault: Diagnostic) -> Self {
        Self { message: fault.message, help: fault.help.map(String::from) }
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
        let what = self.name;
        match &self.kind {
            ParamKind::Number { dimension, min, max } => {
                let value = number(what, given, *dimension)?;
                check_range(what, value, *min..=*max, *dimension)?;
                Ok(ParamValue::Number(value))
            }
            ParamKind::Integer { dimension, min, max, odd } => {
                let value = whole(what, given, *min..=*max, *dimension)?;
                if *odd {
                    check_odd(what, value, *min..=*max)?;
                }
                Ok(ParamValue::Integer(value))
            }
            ParamKind::Switch => switch(what, given).map(ParamValue::Switch),
            ParamKind::Text => text(what, given).map(|text| ParamValue::Text(text.to_owned())),
            ParamKind::Choice(options) => {
                let names: Vec<&str> = options.iter().map(|option| option.name).collect();
                one_of(what, text(what, given)?, &names)
            }
            ParamKind::Catalog { catalog, .. } => {
                chosen(what, text(what, given)?, catalogs, catalog)
            }
            ParamKind::InputFile { optional } => match text(what, given)? {
                NO_FILE if *optional => Ok(ParamValue::Text(NO_FILE.to_owned())),
                "" => Err(ParamFault::new(format!("{what} names no file"))),
                path => Ok(ParamValue::File(locate(path))),
            },
            ParamKind::OutputName => OutputName::new(text(what, given)?)
                .map(ParamValue::Output)
                .map_err(|fault| ParamFault::new(format!("{what}: {fault}"))),
        }
    }
}

/// A finite number in the dimension's base unit.
pub(crate) fn number(
    what: &str,
    given: Given<'_>,
    dimension: Dimension,
) -> Result<f64, ParamFault> {
    let fault = |fault: units::UnitError| ParamFault::new(format!("{what}: {fault}"));
    let value = match given {
        Given::Word(word) => units::parse_quantity(word, dimension).map_err(fault)?,
        Given::Literal(value) => match &value.kind {
            ValueKind::Integer(number) => *number as f64,
            ValueKind::Number(number) => *number,
            ValueKind::Text(text) => units::parse_quantity(text, dimension).map_err(fault)?,
            _ => return Err(wrong_type(what, "a number", value.describe())),
        },
    };
    if value.is_finite() {
        return Ok(value);
    }
    Err(ParamFault::new(format!("{what} must be a finite number, not {value}")))
}

pub(crate) fn check_range(
    what: &str,
    value: f64,
    range: RangeInclusive<f64>,
    dimension: Dimension,
) -> Result<(), ParamFault> {
    if range.contains(&value) {
        return Ok(());
    }
    let (min, max) = range.into_inner();
    let unit = dimension.base_unit();
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let wanted = match (min.is_finite(), max.is_finite()) {
        _ if min == f64::MIN_POSITIVE && value <= 0.0 => format!("more than 0{unit}"),
        (true, true) if min == f64::MIN_POSITIVE => format!("at most {max}{unit}"),
        (true, true) => format!("between {min} and {max}{unit}"),
        (true, false) => format!("at least {min}{unit}"),
        _ => format!("at most {max}{unit}"),
    };
    Err(ParamFault::new(format!("{what} must be {wanted}, not {value}")))
}

/// A whole number within a range.
pub(crate) fn whole(
    what: &str,
    given: Given<'_>,
    range: RangeInclusive<i64>,
    dimension: Dimension,
) -> Result<i64, ParamFault> {
    let value = number(what, given, dimension)?;
    check_range(what, value, *range.start() as f64..=*range.end() as f64, dimension)?;
    if value.fract() != 0.0 {
        return Err(ParamFault::new(format!("{what} must be a whole number, not {value}")));
    }
    Ok(value as i64)
}

fn check_odd(what: &str, value: i64, range: RangeInclusive<i64>) -> Result<(), ParamFault> {
    if value % 2 != 0 {
        return Ok(());
    }
    let near = [value - 1, value + 1].into_iter().filter(|near| range.contains(near));
    let near: Vec<String> = near.map(|near| near.to_string()).collect();
    let fault = ParamFault::new(format!("{what} must be odd, not {value}"));
    Err(fault.help(format!("take {}", near.join(" or "))))
}

fn switch(what: &str, given: Given<'_>) -> Result<bool, ParamFault> {
    let wanted = "true or false";
    match given {
        Given::Word("true") => Ok(true),
        Given::Word("false") => Ok(false),
        Given::Word(word) => Err(wrong_type(what, wanted, &format!("{word:?}"))),
        Given::Literal(value) => {
            value.as_bool().ok_or_else(|| wrong_type(what, wanted, value.describe()))
        }
    }
}

fn text<'a>(what: &str, given: Given<'a>) -> Result<&'a str, ParamFault> {
    match given {
        Given::Word(word) => Ok(word),
        Given::Literal(value) => Ok(value.as_text(what)?),
    }
}

fn wrong_type(what: &str, wanted: &str, got: &str) -> ParamFault {
    ParamFault::new(format!("{what} must be {wanted}, not {got}"))
}

fn one_of(what: &str, word: &str, names: &[&str]) -> Result<ParamValue, ParamFault> {
    place_among(what, word, names).map(|at| ParamValue::Text(names[at].to_owned()))
}

/// Where among `names` a word stands.
pub(crate) fn place_among(what: &str, word: &str, names: &[&str]) -> Result<usize, ParamFault> {
    if let Some(at) = names.iter().position(|name| *name == word) {
        return Ok(at);
    }
    let fault = ParamFault::new(format!("{what} cannot be {word:?}"));
    let options = format!("one of {}", names.join(", "));
    Err(fault.help(match did_you_mean(word, names.iter().copied()) {
        Some(near) => format!("did you mean {near:?}? It is {options}"),
        None => format!("it is {options}"),
    }))
}

/// A name from a catalog.
fn chosen(
    what: &str,
    word: &str,
    catalogs: &Catalogs,
    catalog: &str,
) -> Result<ParamValue, ParamFault> {
    let names: Vec<&str> = catalogs.names(catalog).collect();
    one_of(what, word, &names).map_err(|fault| {
        if let Some(missing) = catalogs.missing(catalog, word) {
            let message = format!("{}: {}", fault.message, missing.why);
            return ParamFault::new(message).help(&missing.help);
        }
        if trust::looks_like_library(word) {
            let message = format!("{}; {}", fault.message, trust::NO_LIBRARY);
            return ParamFault { message, ..fault };
        }
        fault
    })
}

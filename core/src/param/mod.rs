//! Parameters of nodes: what a definition says of them, and values that fulfil it.
//!
//! A node's struct is the one place where a parameter stands. `#[derive(Params)]` turns each field
//! into a [`ParamSpec`]; [`ParamSpec::read`] turns what a recipe or a command line says into a
//! [`ParamValue`], or says what is wrong with it.

mod field;
mod read;
mod values;

use crate::units::Dimension;
use serde::Serialize;
use std::borrow::Cow;
use std::fmt;

pub use field::{ParamField, Yielding};
pub use read::{Given, ParamFault};
pub(crate) use read::{check_range, number, place_among, whole};
pub use values::{EntryParams, ParamValue, ParamValues};

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
    Catalog {
        /// The catalog.
        catalog: &'static str,
        /// Whether the parameters of the entry chosen are fields of the node too.
        takes_params: bool,
    },
    /// A file to read.
    InputFile {
        /// Whether there may be none, said as [`NO_FILE`].
        optional: bool,
    },
    /// The name of a file to write inside the output folder.
    OutputName,
}

/// What a recipe or a user sets where a file may be left out; a file of that name is `./none`.
pub const NO_FILE: &str = "none";

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
            Self::Catalog { catalog, .. } => write!(f, "a {catalog}'s name (carve {catalog}s)"),
            Self::InputFile { optional: false } => f.write_str("file to read"),
            Self::InputFile { optional: true } => write!(f, "file to read, or {NO_FILE}"),
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
    pub about: Cow<'static, str>,
    /// What values it takes.
    pub kind: ParamKind,
    /// Its value where a recipe says nothing; without one the recipe must say something.
    pub default: Option<ParamValue>,
    /// Whether the node asks if it was set: see [`Yielding`].
    pub yields: bool,
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
    /// Whether another field holds the parameters of the entry chosen.
    pub takes_params: bool,
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
/// A node may take the parameters of the entry that another one of its parameters chose. In recipes
/// they are plain fields of the node:
///
/// ```
/// # use carvegraph_core::{EntryParams, Params};
/// /// Draws a form.
/// #[derive(Params)]
/// struct Draw {
///     /// Which form.
///     #[param(catalog = "form", default = "circle")]
///     form: String,
///     /// The measures of that form.
///     #[param(entry_of = "form")]
///     measures: EntryParams,
/// }
/// ```
///
/// What several nodes have in common is declared once, and is a plain field of each in recipes:
///
/// ```
/// # use carvegraph_core::Params;
/// /// Distances of passes.
/// #[derive(Params)]
/// struct Pace {
///     /// Distance between neighbouring passes.
///     #[param(unit = "mm", default = 0.3)]
///     stepover: f64,
/// }
///
/// /// Lays passes in rings.
/// #[derive(Params)]
/// struct Rings {
///     #[param(shared)]
///     pace: Pace,
///     /// Where they begin.
///     #[param(unit = "mm", default = 0.0)]
///     x: f64,
/// }
///
/// let names: Vec<_> = Rings::specs().iter().map(|spec| spec.name).collect();
/// assert_eq!(names, ["stepover", "x"]);
/// ```
pub trait Params: Sized {
    /// What the node does, from the struct's doc comment.
    fn about() -> &'static str;
    /// The parameters, in the order of the fields.
    fn specs() -> Vec<ParamSpec>;
    /// The struct made of checked values.
    fn from_values(values: &ParamValues) -> Self;
}

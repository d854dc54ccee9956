//! The types that a field of a node's struct may have.

use super::{NO_FILE, ParamHints, ParamKind, ParamValue, ParamValues};
use crate::files::{InputFile, OutputName};
use crate::units::Dimension;

/// A type that a field of a [`Params`](super::Params) struct may have.
pub trait ParamField: Sized {
    /// The type in which a definition states the default.
    type Plain: ParamField;
    /// Whether it matters that the parameter was set: see [`Yielding`].
    const YIELDS: bool = false;
    /// What values it takes.
    fn kind(hints: &ParamHints) -> ParamKind;
    /// A default as a value.
    fn to_value(&self) -> ParamValue;
    /// The field made of a checked value that was set.
    fn from_value(value: &ParamValue) -> Self;
    /// The field made of all the checked values of the node.
    fn from_values(values: &ParamValues, name: &str) -> Self {
        Self::from_value(values.get(name))
    }
}

fn dimension(hints: &ParamHints) -> Dimension {
    match hints.unit {
        None => Dimension::Plain,
        Some(unit) => Dimension::of_unit(unit)
            .unwrap_or_else(|| unreachable!("the registry's test knows every unit: {unit}")),
    }
}

impl ParamField for f64 {
    type Plain = Self;

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
    type Plain = Self;

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
    type Plain = Self;

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
    type Plain = Self;

    fn kind(hints: &ParamHints) -> ParamKind {
        let takes_params = hints.takes_params;
        let named = |catalog| ParamKind::Catalog { catalog, takes_params };
        hints.catalog.map_or(ParamKind::Text, named)
    }

    fn to_value(&self) -> ParamValue {
        ParamValue::Text(self.clone())
    }

    fn from_value(value: &ParamValue) -> Self {
        value.text().to_owned()
    }
}

impl ParamField for InputFile {
    type Plain = Self;

    fn kind(_: &ParamHints) -> ParamKind {
        ParamKind::InputFile { optional: false }
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

/// A file that may be left out, see [`NO_FILE`].
impl ParamField for Option<InputFile> {
    type Plain = Self;

    fn kind(_: &ParamHints) -> ParamKind {
        ParamKind::InputFile { optional: true }
    }

    fn to_value(&self) -> ParamValue {
        let none = || ParamValue::Text(NO_FILE.to_owned());
        self.clone().map_or_else(none, ParamValue::File)
    }

    fn from_value(value: &ParamValue) -> Self {
        value.file().cloned()
    }
}

impl ParamField for OutputName {
    type Plain = Self;

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

/// A parameter whose default yields: where neither the recipe nor the user set it, something else
/// may decide, such as the description of a machine.
///
/// ```
/// # use carvegraph_core::{Params, Yielding};
/// /// Goes on.
/// #[derive(Params)]
/// struct Go {
///     /// How fast.
///     #[param(unit = "mm/min", default = 1500.0, range = 1.0..=10_000.0)]
///     feed: Yielding<f64>,
/// }
///
/// assert_eq!(Yielding::left(1500.0).or(Some(800.0)), 800.0);
/// assert_eq!(Yielding::left(1500.0).or(None), 1500.0);
/// assert_eq!(Yielding::given(1500.0).or(Some(800.0)), 1500.0);
/// ```
///
/// Whether it was set is part of what the node's values depend on.
#[derive(Clone, Debug, PartialEq)]
pub struct Yielding<T> {
    value: T,
    is_set: bool,
}

impl<T> Yielding<T> {
    /// One that was set.
    pub const fn given(value: T) -> Self {
        Self { value, is_set: true }
    }

    /// One that was left at its default.
    pub const fn left(default: T) -> Self {
        Self { value: default, is_set: false }
    }

    /// Whether the recipe or the user set it.
    pub const fn is_set(&self) -> bool {
        self.is_set
    }

    /// The value that was set, else `other`, else the default.
    pub fn or(&self, other: Option<T>) -> T
    where
        T: Clone,
    {
        other.filter(|_| !self.is_set).unwrap_or_else(|| self.value.clone())
    }
}

impl<T: ParamField<Plain = T>> ParamField for Yielding<T> {
    type Plain = T;
    const YIELDS: bool = true;

    fn kind(hints: &ParamHints) -> ParamKind {
        T::kind(hints)
    }

    fn to_value(&self) -> ParamValue {
        self.value.to_value()
    }

    fn from_value(value: &ParamValue) -> Self {
        Self::given(T::from_value(value))
    }

    fn from_values(values: &ParamValues, name: &str) -> Self {
        Self { value: T::from_value(values.get(name)), is_set: values.is_set(name) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::files::Origin;
    use crate::param::{Given, ParamSpec};

    #[test]
    fn a_file_may_be_left_out_where_the_field_says_so() {
        let (min, max) = (f64::NEG_INFINITY, f64::INFINITY);
        let hints =
            ParamHints { unit: None, min, max, odd: false, catalog: None, takes_params: false };
        let read = |kind: ParamKind, word: &str| {
            let spec = ParamSpec {
                name: "path",
                about: "A file.".into(),
                kind,
                default: None,
                yields: false,
            };
            let locate = |path: &str| Origin::BuiltIn.locate(path);
            spec.read(Given::Word(word), &Catalogs::default(), &locate)
                .map_err(|fault| fault.message)
        };
        let path = |value: &ParamValue| {
            let file = Option::<InputFile>::from_value(value)?;
            Some(file.path().display().to_string())
        };
        let optional = |word| read(Option::<InputFile>::kind(&hints), word);
        assert_eq!(path(&optional("none").unwrap()), None);
        assert_eq!(optional("none").unwrap(), None::<InputFile>.to_value());
        assert_eq!(path(&optional("./none").unwrap()).as_deref(), Some("./none"));
        assert_eq!(optional("").unwrap_err(), "path names no file");
        let needed = read(InputFile::kind(&hints), "none").unwrap();
        assert_eq!(InputFile::from_value(&needed).stem(), "none");
    }
}

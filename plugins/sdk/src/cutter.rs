//! A cutter shape: which dimensions describe it, and the profile they make.

use carvegraph_geometry::{Profile, ProfileError};

/// What a dimension is measured in.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DimensionUnit {
    /// Millimetres.
    Mm,
    /// Degrees.
    Deg,
}

impl DimensionUnit {
    /// As written behind a number.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::Deg => "deg",
        }
    }
}

/// One dimension of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DimensionSpec {
    /// What recipes call it: lower case, digits and `_`.
    pub name: &'static str,
    /// What it measures, in a line.
    pub about: &'static str,
    /// Its unit.
    pub unit: DimensionUnit,
    /// Its value where none is given; within `min..=max`.
    pub default: f64,
    /// The least value allowed.
    pub min: f64,
    /// The greatest value allowed.
    pub max: f64,
}

impl DimensionSpec {
    /// The cutter's diameter, which every shape has and names so.
    ///
    /// The range is that of cutters sold: engraving balls from 0.1 mm, fly cutters up to 200 mm.
    pub const DIAMETER: Self = Self {
        name: "diameter",
        about: "Diameter of the cutting part",
        unit: DimensionUnit::Mm,
        default: 6.0,
        min: 0.01,
        max: 200.0,
    };
}

/// A family of cutters of one form. It is round: its profile is turned about the tool axis.
pub trait CutterShape: Send + Sync {
    /// What recipes call it: lower case, digits and `_`.
    fn name(&self) -> &str;

    /// What it is, in a line.
    fn about(&self) -> &str;

    /// Its dimensions; the first is [`DimensionSpec::DIAMETER`] or one of that name, unless a drawing
    /// says how wide it is.
    fn dimensions(&self) -> &[DimensionSpec];

    /// What its drawing must show, in a line; `None` for a shape that needs no drawing.
    fn drawing(&self) -> Option<&str> {
        None
    }

    /// The profile of the cutter with these dimensions, its tip at height 0.
    ///
    /// # Errors
    /// If dimensions that are each in range do not go together.
    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError>;
}

/// A value for each dimension of a shape, in the order of its specs and each within its range, and
/// its drawing if it needs one.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimensions<'a> {
    specs: &'a [DimensionSpec],
    values: Vec<f64>,
    drawing: Option<&'a str>,
}

impl<'a> Dimensions<'a> {
    /// Takes `given` by name, in each dimension's own unit, and the defaults for the rest.
    ///
    /// # Errors
    /// If a name is unknown or given twice, or a value lies outside its range.
    pub fn new(specs: &'a [DimensionSpec], given: &[(&str, f64)]) -> Result<Self, CutterError> {
        let mut values: Vec<Option<f64>> = vec![None; specs.len()];
        for &(name, value) in given {
            let place = specs.iter().position(|s| s.name == name);
            let place = place.ok_or_else(|| CutterError::unknown(name, specs))?;
            let spec = &specs[place];
            if !(spec.min..=spec.max).contains(&value) {
                return Err(CutterError::OutOfRange { spec: *spec, value });
            }
            if values[place].replace(value).is_some() {
                return Err(CutterError::Twice { name: name.to_owned() });
            }
        }
        let values = values.iter().zip(specs).map(|(v, s)| v.unwrap_or(s.default)).collect();
        Ok(Self { specs, values, drawing: None })
    }

    /// Adds the text of a drawing (SVG).
    #[must_use]
    pub fn with_drawing(self, text: &'a str) -> Self {
        Self { drawing: Some(text), ..self }
    }

    /// The text of the drawing (SVG).
    ///
    /// # Errors
    /// If none was given.
    pub fn drawing(&self) -> Result<&'a str, CutterError> {
        self.drawing.ok_or(CutterError::NoDrawing)
    }

    /// The value of a dimension.
    ///
    /// # Errors
    /// If the shape has no dimension of that name.
    pub fn get(&self, name: &str) -> Result<f64, CutterError> {
        let place = self.specs.iter().position(|s| s.name == name);
        place.map(|p| self.values[p]).ok_or_else(|| CutterError::unknown(name, self.specs))
    }

    /// The values alone, in the order of the specs.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// Why dimensions do not make a cutter.
#[non_exhaustive]
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum CutterError {
    /// The shape has no such dimension.
    #[error("the cutter has no dimension {name:?}; it has {known}")]
    Unknown {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A dimension is given more than once.
    #[error("the cutter's {name} is given twice")]
    Twice {
        /// The name given.
        name: String,
    },
    /// A value lies outside its range, or is not a number.
    #[error(
        "the cutter's {} is {value} {unit}; it must be {} to {} {unit}",
        .spec.name, .spec.min, .spec.max, unit = .spec.unit.symbol()
    )]
    OutOfRange {
        /// The dimension.
        spec: DimensionSpec,
        /// What was given.
        value: f64,
    },
    /// A shape that needs a drawing was given none.
    #[error("this cutter is made from a drawing, and none is given")]
    NoDrawing,
    /// The profile they make is none.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// Dimensions do not go together; says which, and what to change.
    #[error("{0}")]
    Shape(String),
}

impl CutterError {
    fn unknown(name: &str, specs: &[DimensionSpec]) -> Self {
        let known = specs.iter().map(|s| s.name).collect::<Vec<_>>().join(", ");
        Self::Unknown { name: name.to_owned(), known }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPECS: &[DimensionSpec] = &[
        DimensionSpec::DIAMETER,
        DimensionSpec { name: "corner_radius", default: 1.0, min: 0.0, ..DimensionSpec::DIAMETER },
    ];

    fn refusal(given: &[(&str, f64)]) -> String {
        Dimensions::new(SPECS, given).unwrap_err().to_string()
    }

    #[test]
    fn what_is_not_given_takes_its_default() {
        let dimensions = Dimensions::new(SPECS, &[("corner_radius", 0.5)]).unwrap();
        assert_eq!(dimensions.values(), [6.0, 0.5]);
        assert_eq!(dimensions.get("diameter"), Ok(6.0));
    }

    #[test]
    fn refusals_say_what_to_do() {
        assert_eq!(
            refusal(&[("radius", 3.0)]),
            "the cutter has no dimension \"radius\"; it has diameter, corner_radius"
        );
        assert_eq!(
            refusal(&[("diameter", 3.0), ("diameter", 4.0)]),
            "the cutter's diameter is given twice"
        );
        assert_eq!(
            refusal(&[("diameter", 0.0)]),
            "the cutter's diameter is 0 mm; it must be 0.01 to 200 mm"
        );
        assert_eq!(
            refusal(&[("diameter", f64::NAN)]),
            "the cutter's diameter is NaN mm; it must be 0.01 to 200 mm"
        );
    }
}

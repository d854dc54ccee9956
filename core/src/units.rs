//! Quantities as users write them: a number and a unit, such as `0.25in` or `600 mm/min`.
//!
//! A parameter has a [`Dimension`], and every dimension a base unit in which the engine counts; a
//! bare number is in the base unit. A factor is a quotient of two numbers, whole but for π, so that
//! `0.25in` is exactly the float 6.35. Units are case-sensitive. There is no arithmetic, no
//! fraction (`1/4in`) and no compound (`5ft 3in`).

use std::f64::consts::PI;
use std::fmt;

use thiserror::Error;

use crate::diagnostic::did_you_mean;

/// Longer texts are cut in messages.
const MAX_SHOWN_CHARS: usize = 40;

/// What a parameter measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// Counted in mm.
    Length,
    /// Counted in mm/min.
    Feed,
    /// Counted in mm/s².
    Acceleration,
    /// Counted in degrees.
    Angle,
    /// Counted in revolutions per minute.
    Spindle,
    /// Counted in s.
    Time,
    /// Counted in pixels.
    Pixels,
    /// A share of one; `20%` is 0.2.
    Ratio,
    /// A number without unit.
    Plain,
}

/// A unit: one of it is `over / under` of its dimension's base unit.
struct Unit {
    dimension: Dimension,
    /// The first is the one messages list.
    names: &'static [&'static str],
    over: f64,
    under: f64,
}

const fn unit(dimension: Dimension, names: &'static [&'static str], over: f64, under: f64) -> Unit {
    Unit { dimension, names, over, under }
}

/// Every unit, the base unit of each dimension first. The international inch is 25.4 mm exactly.
const UNITS: &[Unit] = &[
    unit(Dimension::Length, &["mm"], 1.0, 1.0),
    unit(Dimension::Length, &["cm"], 10.0, 1.0),
    unit(Dimension::Length, &["m"], 1000.0, 1.0),
    // The micro sign and the Greek letter are different characters.
    unit(Dimension::Length, &["um", "\u{b5}m", "\u{3bc}m"], 1.0, 1000.0),
    unit(Dimension::Length, &["in", "inch", "\""], 254.0, 10.0),
    unit(Dimension::Length, &["thou", "mil"], 254.0, 10_000.0),
    unit(Dimension::Length, &["ft"], 3048.0, 10.0),
    unit(Dimension::Feed, &["mm/min"], 1.0, 1.0),
    unit(Dimension::Feed, &["mm/s"], 60.0, 1.0),
    unit(Dimension::Feed, &["cm/min"], 10.0, 1.0),
    unit(Dimension::Feed, &["m/min"], 1000.0, 1.0),
    unit(Dimension::Feed, &["in/min", "ipm"], 254.0, 10.0),
    unit(Dimension::Feed, &["in/s"], 1524.0, 1.0),
    unit(Dimension::Acceleration, &["mm/s2", "mm/s²"], 1.0, 1.0),
    unit(Dimension::Acceleration, &["m/s2", "m/s²"], 1000.0, 1.0),
    unit(Dimension::Acceleration, &["in/s2", "in/s²"], 254.0, 10.0),
    unit(Dimension::Angle, &["deg", "°"], 1.0, 1.0),
    unit(Dimension::Angle, &["rad"], 180.0, PI),
    unit(Dimension::Spindle, &["rpm", "RPM", "1/min", "/min"], 1.0, 1.0),
    unit(Dimension::Time, &["s"], 1.0, 1.0),
    unit(Dimension::Time, &["ms"], 1.0, 1000.0),
    unit(Dimension::Time, &["min"], 60.0, 1.0),
    unit(Dimension::Time, &["h"], 3600.0, 1.0),
    unit(Dimension::Pixels, &["px"], 1.0, 1.0),
    unit(Dimension::Ratio, &["%"], 1.0, 100.0),
];

impl Dimension {
    /// The unit the engine counts in; empty if it has no name.
    pub fn base_unit(self) -> &'static str {
        match self {
            Self::Ratio | Self::Plain => "",
            _ => self.units().next().map_or("", |unit| unit.names[0]),
        }
    }

    /// The dimension that a unit belongs to.
    pub fn of_unit(name: &str) -> Option<Self> {
        UNITS.iter().find(|unit| unit.names.contains(&name)).map(|unit| unit.dimension)
    }

    fn units(self) -> impl Iterator<Item = &'static Unit> {
        UNITS.iter().filter(move |unit| unit.dimension == self)
    }

    /// "a length is wanted: mm, cm, ..." for messages.
    fn wanted(self) -> String {
        let units: Vec<_> = self.units().map(|unit| unit.names[0]).collect();
        match units.as_slice() {
            [] => "a plain number is wanted, without unit".to_owned(),
            units => format!("{self} is wanted: {}", units.join(", ")),
        }
    }
}

/// The dimension with its article: "a length".
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Length => "a length",
            Self::Feed => "a feed",
            Self::Acceleration => "an acceleration",
            Self::Angle => "an angle",
            Self::Spindle => "a spindle speed",
            Self::Time => "a time",
            Self::Pixels => "a number of pixels",
            Self::Ratio => "a ratio",
            Self::Plain => "a plain number",
        })
    }
}

/// Why a text is not the quantity wanted. Texts are cut to a length fit for a message.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum UnitError {
    /// No number stands at its start, or something that is no unit follows.
    #[error("\"{text}\" is not a number; {}", wanted.wanted())]
    NotANumber {
        /// What was written.
        text: String,
        /// What it should be.
        wanted: Dimension,
    },
    /// No dimension has the unit.
    #[error("unknown unit in \"{text}\"; {}{}", wanted.wanted(), suggestion(suggested))]
    UnknownUnit {
        /// What was written.
        text: String,
        /// What it should be.
        wanted: Dimension,
        /// A unit of the wanted dimension that is spelt much the same.
        suggested: Option<&'static str>,
    },
    /// The unit measures something else.
    #[error("\"{text}\" is {found}; {}", wanted.wanted())]
    OtherDimension {
        /// What was written.
        text: String,
        /// What the unit measures.
        found: Dimension,
        /// What it should be.
        wanted: Dimension,
    },
    /// Infinite, not a number, or too large to count with.
    #[error("\"{text}\" is not a finite number")]
    NotFinite {
        /// What was written.
        text: String,
    },
}

fn suggestion(suggested: &Option<&str>) -> String {
    suggested.map_or_else(String::new, |unit| format!("; did you mean \"{unit}\"?"))
}

/// Reads a number and an optional unit, blanks allowed between and around, as a number in the
/// dimension's base unit.
pub fn parse_quantity(text: &str, dimension: Dimension) -> Result<f64, UnitError> {
    let shown = || match text.trim().char_indices().nth(MAX_SHOWN_CHARS) {
        Some((end, _)) => format!("{}…", &text.trim()[..end]),
        None => text.trim().to_owned(),
    };
    let (number, name) = split_number(text.trim());
    let Ok(value) = number.parse::<f64>() else {
        let unsigned = name.trim_start_matches(['+', '-']).to_ascii_lowercase();
        return Err(match unsigned.as_str() {
            "inf" | "infinity" | "nan" => UnitError::NotFinite { text: shown() },
            _ => UnitError::NotANumber { text: shown(), wanted: dimension },
        });
    };
    let (over, under) = match UNITS.iter().find(|unit| unit.names.contains(&name)) {
        _ if name.is_empty() => (1.0, 1.0),
        Some(unit) if unit.dimension == dimension => (unit.over, unit.under),
        Some(unit) => {
            let (text, found) = (shown(), unit.dimension);
            return Err(UnitError::OtherDimension { text, found, wanted: dimension });
        }
        // `2,5` and `1/4in` are misspelt numbers rather than units.
        None if name.starts_with([',', '.', '/', '_', '+', '-']) || starts_with_digit(name) => {
            return Err(UnitError::NotANumber { text: shown(), wanted: dimension });
        }
        None => {
            let names = dimension.units().flat_map(|unit| unit.names).copied();
            let suggested = did_you_mean(name, names);
            return Err(UnitError::UnknownUnit { text: shown(), wanted: dimension, suggested });
        }
    };
    let value = value * over / under;
    if value.is_finite() { Ok(value) } else { Err(UnitError::NotFinite { text: shown() }) }
}

/// Splits a text behind the number it starts with: sign, digits, fraction, exponent.
fn split_number(text: &str) -> (&str, &str) {
    let unsigned = |text: &str| text.strip_prefix(['+', '-']).unwrap_or(text).len();
    let digits = |from: usize| {
        let rest = &text[from..];
        from + rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())
    };
    let start = text.len() - unsigned(text);
    let mut end = digits(start);
    let mut found = end > start;
    if text[end..].starts_with('.') {
        let fraction = digits(end + 1);
        found |= fraction > end + 1;
        end = fraction;
    }
    if !found {
        return ("", text);
    }
    if let Some(exponent) = text[end..].strip_prefix(['e', 'E']) {
        let first = text.len() - unsigned(exponent);
        if digits(first) > first {
            end = digits(first);
        }
    }
    (&text[..end], text[end..].trim_start())
}

fn starts_with_digit(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::Dimension::*;
    use super::*;

    #[test]
    fn quantities_come_in_the_base_unit() {
        #[track_caller]
        fn check(text: &str, dimension: Dimension, expected: f64) {
            assert_eq!(parse_quantity(text, dimension), Ok(expected), "{text}");
        }
        check("5", Length, 5.0);
        check(" -5.5 mm ", Length, -5.5);
        check("1in", Length, 25.4);
        check("0.25in", Length, 6.35);
        check("1/min", Spindle, 1.0);
        check("0.5\"", Length, 12.7);
        check("1 thou", Length, 0.0254);
        check("5mil", Length, 0.127);
        check("1ft", Length, 304.8);
        check("3um", Length, 0.003);
        check("3µm", Length, 0.003);
        check("3μm", Length, 0.003);
        check("2cm", Length, 20.0);
        check("+.2m", Length, 200.0);
        check("1.e1mm", Length, 10.0);
        check("600mm/min", Feed, 600.0);
        check("10mm/s", Feed, 600.0);
        check("1.5 m/min", Feed, 1500.0);
        check("60cm/min", Feed, 600.0);
        check("10ipm", Feed, 254.0);
        check("10 in/min", Feed, 254.0);
        check("1in/s", Feed, 1524.0);
        check("300mm/s2", Acceleration, 300.0);
        check("0.5 m/s²", Acceleration, 500.0);
        check("10in/s2", Acceleration, 254.0);
        check("15deg", Angle, 15.0);
        check("15°", Angle, 15.0);
        check("3.141592653589793rad", Angle, 180.0);
        check("12000 1/min", Spindle, 12000.0);
        check("1.2e4RPM", Spindle, 12000.0);
        check("250ms", Time, 0.25);
        check("2min", Time, 120.0);
        check("1h", Time, 3600.0);
        check("20%", Ratio, 0.2);
        check("0.2", Ratio, 0.2);
        check("5px", Pixels, 5.0);
        check("1e-3", Plain, 0.001);
    }

    #[test]
    fn what_is_no_such_quantity_is_explained() {
        #[track_caller]
        fn check(text: &str, dimension: Dimension, expected: &str) {
            assert_eq!(parse_quantity(text, dimension).unwrap_err().to_string(), expected);
        }
        let lengths = "a length is wanted: mm, cm, m, um, in, thou, ft";
        let number = |text: &str| format!("\"{text}\" is not a number; {lengths}");
        for text in ["", "ball", "2,5", "1/4in", "5 6", "1_000", ".", "-", "--5"] {
            check(text, Length, &number(text));
        }
        check("15deg", Length, &format!("\"15deg\" is an angle; {lengths}"));
        check(
            "5mm",
            Feed,
            "\"5mm\" is a length; a feed is wanted: mm/min, mm/s, cm/min, m/min, in/min, in/s",
        );
        check("5mm", Plain, "\"5mm\" is a length; a plain number is wanted, without unit");
        check("5mm", Ratio, "\"5mm\" is a length; a ratio is wanted: %");
        check(
            "5 inc",
            Length,
            &format!("unknown unit in \"5 inc\"; {lengths}; did you mean \"in\"?"),
        );
        check("5MM", Length, &format!("unknown unit in \"5MM\"; {lengths}; did you mean \"mm\"?"));
        check("5 furlong", Length, &format!("unknown unit in \"5 furlong\"; {lengths}"));
        check("5e", Length, &format!("unknown unit in \"5e\"; {lengths}"));
        for text in ["inf", "-inf", "NaN", "1e999", "1e308m"] {
            check(text, Length, &format!("\"{text}\" is not a finite number"));
        }
        let long = "5".to_owned() + &"ü".repeat(1000);
        check(
            &long,
            Plain,
            &format!(
                "unknown unit in \"5{}…\"; a plain number is wanted, without unit",
                "ü".repeat(39)
            ),
        );
    }

    #[test]
    fn a_unit_name_belongs_to_one_unit_and_base_units_count_one() {
        let mut names: Vec<_> = UNITS.iter().flat_map(|unit| unit.names).collect();
        names.sort();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]));
        for dimension in [Length, Feed, Angle, Spindle, Time, Pixels] {
            let one = format!("1{}", dimension.base_unit());
            assert_eq!(parse_quantity(&one, dimension), Ok(1.0));
        }
        assert_eq!(Length.base_unit(), "mm");
        assert_eq!(Ratio.base_unit(), "");
    }
}

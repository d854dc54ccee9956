//! What the definition of a node must be like.

use super::{Node, NodeFault, Param, ParamKind, ParamOption, Port};
use crate::value::{self, Raw};

/// The units of numbers.
pub const UNITS: &[&str] = &["mm", "mm/min", "deg", "rpm", "s", "px", "%", ""];

/// Characters of a name: what still fits a line of a recipe.
const MAX_NAME: usize = 64;

/// Bytes of a description or a default text: a long paragraph. One longer than that is a mistake.
const MAX_TEXT: usize = 2000;

/// Params, ports and options of one node: more than a user can survey. Larger counts are a mistake.
const MAX_COUNT: usize = 64;

/// Whole numbers beyond this are not exact as doubles.
const MAX_INTEGER: u64 = 1 << f64::MANTISSA_DIGITS;

/// What is wrong with the definition of a node.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DefinitionError {
    /// A name that recipes cannot say.
    #[error(
        "{what} is called {name:?}; names are of lower-case letters, digits and _, begin with a letter \
         and have at most {MAX_NAME} characters"
    )]
    Name {
        /// What is called so.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A description is missing.
    #[error("{what} {name:?} has no description; say in a line what it is for")]
    NoAbout {
        /// What lacks it.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// A text is too long or has control characters.
    #[error(
        "a text of {what} {name:?} is none that can be shown; it must be a line of at most {MAX_TEXT} \
         bytes"
    )]
    Text {
        /// What it belongs to.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// Two things are called the same.
    #[error("{what} {name:?} is there twice; give each its own name")]
    Twice {
        /// What they are.
        what: &'static str,
        /// Their name.
        name: String,
    },
    /// More than a node may have.
    #[error("it has {count} {what}s; the limit is {MAX_COUNT}")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many.
        count: usize,
    },
    /// A node that makes nothing is of no use: it cannot write files either.
    #[error("it has no output")]
    NoOutput,
    /// An output cannot be optional.
    #[error("the output {0:?} is optional; only an input may be")]
    OptionalOutput(String),
    /// A type that does not pass between nodes.
    #[error("the {what} {name:?} carries {type_name:?}; it must be one of {}", value::TYPES.join(", "))]
    Type {
        /// Input or output.
        what: &'static str,
        /// The port.
        name: String,
        /// Its type.
        type_name: String,
    },
    /// A unit that numbers do not have.
    #[error(
        "the parameter {param:?} is in {unit:?}; its unit must be one of {}, or empty",
        UNITS[..UNITS.len() - 1].join(", ")
    )]
    Unit {
        /// The parameter.
        param: String,
        /// Its unit.
        unit: String,
    },
    /// No number lies in the range.
    #[error("the parameter {param:?} ranges from {min} to {max}; give the lesser number first")]
    Range {
        /// The parameter.
        param: String,
        /// Its least value.
        min: f64,
        /// Its greatest.
        max: f64,
    },
    /// A whole number that a double cannot hold.
    #[error("the parameter {param:?} reaches beyond ±{MAX_INTEGER}; narrow its range")]
    IntegerRange {
        /// The parameter.
        param: String,
    },
    /// A choice between nothing.
    #[error("the parameter {0:?} is a choice without options")]
    NoOptions(String),
    /// A default that a recipe could not set.
    #[error("the parameter {param:?} has the default {default}, which is none of its values")]
    Default {
        /// The parameter.
        param: String,
        /// Its default.
        default: String,
    },
}

/// Finds the first fault in what a node says of itself.
///
/// # Errors
/// If a name cannot stand in a recipe or stands twice, a description is missing, a port's type or a
/// unit is unknown, a default is outside its range, it has no output or too many of something.
pub fn check_definition(node: &dyn Node) -> Result<(), DefinitionError> {
    check_names("the node", std::iter::once((node.name(), node.about())))?;
    check_count("param", node.params().len())?;
    check_names("the parameter", node.params().iter().map(|param| (param.name, param.about)))?;
    node.params().iter().try_for_each(check_param)?;
    check_ports("input", node.inputs())?;
    check_ports("output", node.outputs())?;
    if node.outputs().is_empty() {
        return Err(DefinitionError::NoOutput);
    }
    match node.outputs().iter().find(|port| port.optional) {
        Some(port) => Err(DefinitionError::OptionalOutput(port.name.to_owned())),
        None => Ok(()),
    }
}

/// Finds the first fault in what a node with these `outputs` made.
///
/// # Errors
/// If there are more or fewer values than outputs, or one is of another type than its port or malformed.
pub fn check_outputs(outputs: &[Port], made: &[Raw<'_>]) -> Result<(), NodeFault> {
    if outputs.len() != made.len() {
        let message = format!("the node has {} outputs and made {}", outputs.len(), made.len());
        return Err(NodeFault::Failed(message));
    }
    outputs.iter().zip(made).try_for_each(|(port, raw)| {
        let fault = |fault| NodeFault::Failed(format!("output {:?}: {fault}", port.name));
        value::check_type(raw, port.type_name).and_then(|()| value::check(raw)).map_err(fault)
    })
}

/// Checks the names and descriptions of things of one kind.
fn check_names<'a>(
    what: &'static str,
    named: impl Iterator<Item = (&'a str, &'a str)>,
) -> Result<(), DefinitionError> {
    let mut seen = Vec::new();
    for (name, about) in named {
        let owned = || name.to_owned();
        if !is_name(name) {
            return Err(DefinitionError::Name { what, name: owned() });
        }
        if seen.contains(&name) {
            return Err(DefinitionError::Twice { what, name: owned() });
        }
        if about.trim().is_empty() {
            return Err(DefinitionError::NoAbout { what, name: owned() });
        }
        if !is_line(about) {
            return Err(DefinitionError::Text { what, name: owned() });
        }
        seen.push(name);
    }
    Ok(())
}

fn check_count(what: &'static str, count: usize) -> Result<(), DefinitionError> {
    if count <= MAX_COUNT { Ok(()) } else { Err(DefinitionError::TooMany { what, count }) }
}

fn is_name(name: &str) -> bool {
    let tail = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    name.len() <= MAX_NAME
        && name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(tail)
}

fn is_line(text: &str) -> bool {
    text.len() <= MAX_TEXT && !text.contains(char::is_control)
}

fn check_ports(what: &'static str, ports: &[Port]) -> Result<(), DefinitionError> {
    check_count(what, ports.len())?;
    let the = if what == "input" { "the input" } else { "the output" };
    check_names(the, ports.iter().map(|port| (port.name, port.about)))?;
    match ports.iter().find(|port| !value::TYPES.contains(&port.type_name)) {
        None => Ok(()),
        Some(port) => {
            let (name, type_name) = (port.name.to_owned(), port.type_name.to_owned());
            Err(DefinitionError::Type { what, name, type_name })
        }
    }
}

fn check_param(param: &Param) -> Result<(), DefinitionError> {
    match param.kind {
        ParamKind::Number { unit, default, min, max } => {
            check_unit(param, unit)?;
            check_range(param, min, max)?;
            check_default(param, default.is_finite() && (min..=max).contains(&default))
        }
        ParamKind::Integer { unit, default, min, max } => {
            check_unit(param, unit)?;
            check_integers(param, min, max)?;
            check_default(param, (min..=max).contains(&default))
        }
        ParamKind::Switch { .. } => Ok(()),
        ParamKind::Text { default } => {
            if is_line(default) {
                return Ok(());
            }
            Err(DefinitionError::Text { what: "the parameter", name: param.name.to_owned() })
        }
        ParamKind::Choice { options, default } => {
            check_options(param, options)?;
            check_default(param, options.iter().any(|option| option.name == default))
        }
    }
}

fn check_unit(param: &Param, unit: &str) -> Result<(), DefinitionError> {
    if UNITS.contains(&unit) {
        return Ok(());
    }
    Err(DefinitionError::Unit { param: param.name.to_owned(), unit: unit.to_owned() })
}

fn check_range(param: &Param, min: f64, max: f64) -> Result<(), DefinitionError> {
    // Not `min > max`: that lets NaN pass.
    if min <= max {
        Ok(())
    } else {
        Err(DefinitionError::Range { param: param.name.to_owned(), min, max })
    }
}

fn check_integers(param: &Param, min: i64, max: i64) -> Result<(), DefinitionError> {
    check_range(param, min as f64, max as f64)?;
    if min.unsigned_abs().max(max.unsigned_abs()) <= MAX_INTEGER {
        return Ok(());
    }
    Err(DefinitionError::IntegerRange { param: param.name.to_owned() })
}

fn check_options(param: &Param, options: &[ParamOption]) -> Result<(), DefinitionError> {
    check_count("option", options.len())?;
    if options.is_empty() {
        return Err(DefinitionError::NoOptions(param.name.to_owned()));
    }
    check_names("the option", options.iter().map(|option| (option.name, option.about)))
}

fn check_default(param: &Param, fits: bool) -> Result<(), DefinitionError> {
    if fits {
        return Ok(());
    }
    let default = match param.kind {
        ParamKind::Number { default, .. } => default.to_string(),
        ParamKind::Integer { default, .. } => default.to_string(),
        ParamKind::Switch { default } => default.to_string(),
        ParamKind::Text { default } | ParamKind::Choice { default, .. } => format!("{default:?}"),
    };
    Err(DefinitionError::Default { param: param.name.to_owned(), default })
}

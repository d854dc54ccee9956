//! Values and their places.

use super::shown;
use crate::diagnostic::Diagnostic;
use crate::source::Span;

/// A word and where it stands.
#[derive(Clone, Debug)]
pub struct Name {
    /// The word.
    pub text: String,
    /// Where it stands.
    pub span: Span,
}

/// A value and its place.
#[derive(Clone, Debug)]
pub struct Value {
    /// What it is.
    pub kind: ValueKind,
    /// Where it stands, brackets and quotes included.
    pub span: Span,
}

/// What a value is.
#[derive(Clone, Debug)]
pub enum ValueKind {
    /// `()`
    Unit,
    /// `true` or `false`
    Bool(bool),
    /// A number written without fraction or exponent.
    Integer(i64),
    /// Any other number, infinities and NaN included.
    Number(f64),
    /// `'a'`
    Char(char),
    /// `"text"` or `r#"text"#`, without escapes.
    Text(String),
    /// A bare word, such as the unit variant `None`.
    Word(String),
    /// `[a, b]`
    List(Vec<Value>),
    /// `{a: b}` in the order written; the keys differ.
    Map(Vec<(Value, Value)>),
    /// `Name(field: value)` or `(field: value)` in the order written; the names differ.
    Struct {
        /// The word before the bracket.
        name: Option<Name>,
        /// Names, and what stands behind the colons.
        fields: Vec<(Name, Value)>,
    },
    /// `Name(a, b)` or `(a, b)`
    Tuple {
        /// The word before the bracket.
        name: Option<Name>,
        /// What stands in the brackets.
        items: Vec<Value>,
    },
}

impl Value {
    /// The kind with its article, for messages: "a number", "a list [...]".
    pub fn describe(&self) -> &'static str {
        match &self.kind {
            ValueKind::Unit => "an empty ()",
            ValueKind::Bool(_) => "true or false",
            ValueKind::Integer(_) => "a whole number",
            ValueKind::Number(_) => "a number",
            ValueKind::Char(_) => "a character in single quotes",
            ValueKind::Text(_) => "a text",
            ValueKind::Word(_) => "a bare word",
            ValueKind::List(_) => "a list [...]",
            ValueKind::Map(_) => "a map {...}",
            ValueKind::Struct { .. } => "fields in (...)",
            ValueKind::Tuple { .. } => "values in (...)",
        }
    }

    /// The text, if it is one.
    pub fn as_str(&self) -> Option<&str> {
        match &self.kind {
            ValueKind::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The truth value, if it is one.
    pub fn as_bool(&self) -> Option<bool> {
        match self.kind {
            ValueKind::Bool(value) => Some(value),
            _ => None,
        }
    }

    /// The number, if it is one, whole or not; it may be infinite or NaN.
    pub fn as_number(&self) -> Option<f64> {
        match self.kind {
            ValueKind::Integer(value) => Some(value as f64),
            ValueKind::Number(value) => Some(value),
            _ => None,
        }
    }

    /// The text, or the fault that `what`, such as `"kind"`, must be one.
    pub fn as_text(&self, what: &str) -> Result<&str, Diagnostic> {
        self.as_str().ok_or_else(|| {
            let fault = self.mismatch(what, "a text in double quotes");
            let written = shown(self.span.text());
            match &self.kind {
                ValueKind::Char(c) => fault.help(format!("write \"{c}\"")),
                ValueKind::Bool(_)
                | ValueKind::Integer(_)
                | ValueKind::Number(_)
                | ValueKind::Word(_) => fault.help(format!("write \"{written}\"")),
                _ => fault,
            }
        })
    }

    /// The fault that `what` must be of another kind than the value is, such as "a number".
    pub fn mismatch(&self, what: &str, wanted: &str) -> Diagnostic {
        let found = self.describe();
        Diagnostic::error(format!("{what} must be {wanted}, not {found}")).at(self.span.clone())
    }
}

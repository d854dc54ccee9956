//! A recipe as it is written: nodes, wires, knobs, each with its place in the text.
//!
//! Reading a recipe finds what is wrong with its form: missing or unknown fields, values of the
//! wrong type, names that are no names, a field that two knobs drive. Whether the nodes exist and
//! fit together is found when a [graph](crate::graph) is built of it.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::files::Origin;
use crate::ron::{self, MAX_TEXT_BYTES, Value, ValueKind};
use crate::source::{Source, Span};
use std::collections::HashSet;
use std::sync::Arc;

pub use crate::ron::Name;

/// The version of the format that this program writes, and the newest that it reads.
pub const FORMAT: i64 = 1;

/// No recipe has more nodes, those of its inner recipes included.
pub const MAX_NODES: usize = 10_000;

/// Recipes inside recipes go no deeper.
pub const MAX_DEPTH: usize = 16;

/// A recipe with its inner ones, each counted as often as it is used, has no more text: 10,000
/// nodes of 1,600 bytes each.
pub const MAX_LAID_OUT_BYTES: usize = 4 * MAX_TEXT_BYTES;

/// What a field is set to has no more bytes, since one knob may set 10,000 fields.
pub const MAX_VALUE_BYTES: usize = 16 << 10;

/// The kind of node that stands for another recipe.
pub(crate) const RECIPE_KIND: &str = "recipe";

/// A name that stands for places inside the recipe: a knob or, in an inner recipe, an input.
#[derive(Clone, Debug)]
pub struct Alias {
    /// The name.
    pub name: Name,
    /// The `node.field` or `node.port` places that it drives.
    pub targets: Vec<Name>,
    /// What it does, for a user.
    pub about: String,
}

/// One node of a recipe.
#[derive(Clone, Debug)]
pub struct RecipeNode {
    /// Its name in this recipe.
    pub id: Name,
    /// The kind of node that it is.
    pub kind: Name,
    /// Input port and where its value comes from.
    pub from: Vec<(Name, Name)>,
    /// Parameters and what they are set to.
    pub set: Vec<(Name, Value)>,
}

/// A recipe as it is written.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// What it is called on the command line.
    pub name: String,
    /// A line for lists.
    pub title: String,
    /// A few sentences.
    pub about: String,
    /// Where its relative paths start.
    pub origin: Origin,
    /// Its text.
    pub source: Arc<Source>,
    /// The ports that it has when it serves as a node in another recipe.
    pub inputs: Vec<Alias>,
    /// The knobs a user turns.
    pub params: Vec<Alias>,
    /// Its nodes, in the order they are written.
    pub nodes: Vec<RecipeNode>,
    /// The nodes it is run for; as a node in another recipe, its output ports.
    pub outputs: Vec<Name>,
}

impl Recipe {
    /// Reads a recipe.
    ///
    /// # Errors
    /// All that is wrong with its form.
    pub fn read(name: &str, source: Source, origin: Origin) -> Result<Self, Diagnostics> {
        let source = Arc::new(source);
        let value = ron::parse(&source)?;
        let mut reader = Reader { faults: Diagnostics::default() };
        let recipe = reader.recipe(name, &source, origin, &value);
        match recipe {
            Some(recipe) if !reader.faults.has_errors() => Ok(recipe),
            _ => Err(reader.faults),
        }
    }
}

/// The fields of a struct of a recipe, taken out one by one.
struct Fields<'a> {
    what: String,
    span: Span,
    left: Vec<(&'a Name, &'a Value)>,
    known: Vec<&'static str>,
}

struct Reader {
    faults: Diagnostics,
}

impl Reader {
    fn fault(&mut self, span: &Span, message: impl Into<String>) {
        self.faults.push(Diagnostic::error(message).at(span.clone()));
    }

    fn recipe(
        &mut self,
        name: &str,
        source: &Arc<Source>,
        origin: Origin,
        value: &Value,
    ) -> Option<Recipe> {
        let mut fields = self.fields(value, "the recipe", Some("Recipe"))?;
        if self.is_newer(&mut fields) {
            return None;
        }
        let (nodes, outputs) = (fields.required("nodes", self), fields.required("outputs", self));
        let recipe = Recipe {
            name: name.to_owned(),
            origin,
            source: Arc::clone(source),
            title: self.text(fields.take("title"), "title"),
            about: self.text(fields.take("about"), "about"),
            inputs: self.aliases(fields.take("inputs"), "inputs", "feeds"),
            params: self.aliases(fields.take("params"), "params", "sets"),
            nodes: self.nodes(nodes),
            outputs: self.outputs(outputs),
        };
        fields.take("layout");
        self.no_more(fields);
        Some(recipe)
    }

    /// Whether the format is newer than what this program reads. Such a one may mean anything by
    /// its fields, so nothing else is said about it.
    fn is_newer(&mut self, fields: &mut Fields<'_>) -> bool {
        let Some(value) = fields.required("format", self) else { return false };
        let fault = match value.kind {
            ValueKind::Integer(1..=FORMAT) => return false,
            ValueKind::Integer(format) if format > FORMAT => Diagnostic::error(format!(
                "this recipe has format {format}; this program reads formats up to {FORMAT}"
            ))
            .help("update carve to run it"),
            ValueKind::Integer(format) => {
                Diagnostic::error(format!("there is no format {format}; the first one is 1"))
            }
            _ => value.mismatch("format", "a whole number"),
        };
        self.faults.push(fault.at(value.span.clone()));
        matches!(value.kind, ValueKind::Integer(format) if format > FORMAT)
    }

    fn outputs(&mut self, value: Option<&Value>) -> Vec<Name> {
        let names = self.names(value, "outputs");
        if let Some(value) = value
            && matches!(&value.kind, ValueKind::List(items) if items.is_empty())
        {
            self.fault(&value.span, "outputs is empty, so the recipe is run for nothing");
        }
        let mut seen = HashSet::new();
        for name in names.iter().filter(|name| !seen.insert(name.text.as_str())) {
            self.fault(&name.span, format!("outputs names {:?} twice", name.text));
        }
        names
    }

    fn nodes(&mut self, value: Option<&Value>) -> Vec<RecipeNode> {
        let entries = self.entries(value, "nodes");
        if entries.len() > MAX_NODES
            && let Some(value) = value
        {
            let count = entries.len();
            let message = format!("the recipe has {count} nodes; the limit is {MAX_NODES}");
            self.fault(&value.span, message);
            return Vec::new();
        }
        entries.into_iter().filter_map(|(id, value)| self.node(id, value)).collect()
    }

    fn node(&mut self, id: Name, value: &Value) -> Option<RecipeNode> {
        self.check_name(&id, "a node");
        let mut fields = self.fields(value, &format!("node {:?}", id.text), None)?;
        let kind = fields.required("kind", self).and_then(|value| self.name(value, "kind"));
        let from = self.entries(fields.take("from"), "from");
        let from = from
            .into_iter()
            .filter_map(|(port, value)| Some((port, self.name(value, "a source in from")?)))
            .collect();
        let set = self.entries(fields.take("set"), "set");
        let set = set.into_iter().filter_map(|(name, value)| self.literal(name, value)).collect();
        self.text(fields.take("note"), "note");
        self.no_more(fields);
        Some(RecipeNode { id, kind: kind?, from, set })
    }

    /// What a field is set to; complains of what no field takes.
    fn literal(&mut self, name: Name, value: &Value) -> Option<(Name, Value)> {
        match &value.kind {
            ValueKind::Text(text) if text.len() > MAX_VALUE_BYTES => {
                let (what, bytes) = (&name.text, text.len());
                let message = format!("{what} has {bytes} bytes; the limit is {MAX_VALUE_BYTES}");
                self.fault(&value.span, message);
                None
            }
            ValueKind::Unit
            | ValueKind::List(_)
            | ValueKind::Map(_)
            | ValueKind::Struct { .. }
            | ValueKind::Tuple { .. } => {
                let fault = value.mismatch(&name.text, "a number, a text, true or false");
                self.faults.push(fault);
                None
            }
            _ => Some((name, value.clone())),
        }
    }

    fn check_name(&mut self, name: &Name, what: &str) {
        let fits = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
        let Name { text, span } = name;
        if text.is_empty() || text.len() > 64 || !text.chars().all(fits) {
            let fault = Diagnostic::error(format!("{text:?} is no name for {what}"));
            let help = "letters, digits, _ and - do, 64 at most";
            self.faults.push(fault.at(span.clone()).help(help));
        }
    }

    /// Names for what is inside the recipe. Nothing may be driven by two of them: which one counts
    /// would depend on their order.
    fn aliases(&mut self, value: Option<&Value>, what: &str, targets: &'static str) -> Vec<Alias> {
        let mut aliases = Vec::new();
        for (name, value) in self.entries(value, what) {
            self.check_name(&name, "what a user sets");
            let Some(mut fields) = self.fields(value, &format!("{:?}", name.text), None) else {
                continue;
            };
            let about = self.text(fields.take("about"), "about");
            let list = fields.required(targets, self);
            let targets = self.names(list, targets);
            self.no_more(fields);
            aliases.push(Alias { name, targets, about });
        }
        let mut seen = HashSet::new();
        let targets = aliases.iter().flat_map(|alias| &alias.targets);
        for target in targets.filter(|target| !seen.insert(target.text.as_str())) {
            self.fault(&target.span, format!("{what} drives {:?} twice", target.text));
        }
        aliases
    }

    /// A struct's fields. `named` is the name that the struct may carry.
    fn fields<'a>(
        &mut self,
        value: &'a Value,
        what: &str,
        named: Option<&str>,
    ) -> Option<Fields<'a>> {
        let (name, fields) = match &value.kind {
            ValueKind::Struct { name, fields } => (name.as_ref(), fields.as_slice()),
            ValueKind::Unit => (None, [].as_slice()),
            _ => {
                self.faults.push(value.mismatch(what, "fields in (...)"));
                return None;
            }
        };
        if let Some(Name { text, span }) = name
            && named != Some(text.as_str())
        {
            let wanted =
                named.map_or("nothing".to_owned(), |named| format!("{named:?} or nothing"));
            self.fault(span, format!("before the fields of {what} stands {wanted}, not {text:?}"));
        }
        let left = fields.iter().map(|(name, value)| (name, value)).collect();
        Some(Fields { what: what.to_owned(), span: value.span.clone(), left, known: Vec::new() })
    }

    /// Complains about the fields that nobody took.
    fn no_more(&mut self, fields: Fields<'_>) {
        for (name, _) in &fields.left {
            let message = format!("{} has no field {:?}", fields.what, name.text);
            let fault = Diagnostic::error(message).at(name.span.clone());
            self.faults.push_near(fault, &name.text, fields.known.iter().copied());
        }
    }

    /// The entries of a map whose keys are texts.
    fn entries<'a>(&mut self, value: Option<&'a Value>, what: &str) -> Vec<(Name, &'a Value)> {
        let Some(value) = value else { return Vec::new() };
        let ValueKind::Map(entries) = &value.kind else {
            self.faults.push(value.mismatch(what, "a map {...}"));
            return Vec::new();
        };
        let key = format!("a key of {what}");
        entries.iter().filter_map(|(name, value)| Some((self.name(name, &key)?, value))).collect()
    }

    fn names(&mut self, value: Option<&Value>, what: &str) -> Vec<Name> {
        let Some(value) = value else { return Vec::new() };
        let ValueKind::List(items) = &value.kind else {
            self.faults.push(value.mismatch(what, "a list [...]"));
            return Vec::new();
        };
        items.iter().filter_map(|item| self.name(item, what)).collect()
    }

    fn name(&mut self, value: &Value, what: &str) -> Option<Name> {
        match value.as_text(what) {
            Ok(text) => Some(Name { text: text.to_owned(), span: value.span.clone() }),
            Err(fault) => {
                self.faults.push(fault);
                None
            }
        }
    }

    fn text(&mut self, value: Option<&Value>, what: &str) -> String {
        value.and_then(|value| self.name(value, what)).map(|name| name.text).unwrap_or_default()
    }
}

impl<'a> Fields<'a> {
    fn take(&mut self, name: &'static str) -> Option<&'a Value> {
        self.known.push(name);
        let at = self.left.iter().position(|(known, _)| known.text == name)?;
        Some(self.left.remove(at).1)
    }

    fn required(&mut self, name: &'static str, reader: &mut Reader) -> Option<&'a Value> {
        let value = self.take(name);
        if value.is_none() {
            reader.fault(&self.span, format!("{} lacks the field {name:?}", self.what));
        }
        value
    }
}

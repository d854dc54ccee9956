//! A recipe as it is written: nodes, wires, knobs, each with its place in the text.
//!
//! Reading a recipe finds what is wrong with its form: missing or unknown fields, values of the
//! wrong type, names that are no names, a field that two knobs drive. Whether the nodes exist and
//! fit together is found when a [graph](crate::graph) is built of it.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::files::Origin;
use crate::ron::{self, Fields, Form, Item, MAX_TEXT_BYTES, Value, ValueKind};
use crate::source::Source;
use crate::trust;
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
        let form = Form::default();
        let recipe = Reader { form: &form }.recipe(name, &source, origin, &value);
        form.finish(recipe)
    }
}

struct Reader<'f> {
    form: &'f Form,
}

impl<'f> Reader<'f> {
    fn recipe(
        &self,
        name: &str,
        source: &Arc<Source>,
        origin: Origin,
        value: &'f Value,
    ) -> Option<Recipe> {
        let mut fields = self.form.item(value, "the recipe").fields(Some("Recipe"))?;
        if self.is_newer(&mut fields) {
            return None;
        }
        let (nodes, outputs) = (fields.required("nodes"), fields.required("outputs"));
        let recipe = Recipe {
            name: name.to_owned(),
            origin,
            source: Arc::clone(source),
            title: text(fields.optional("title")),
            about: text(fields.optional("about")),
            inputs: self.aliases(fields.optional("inputs"), "inputs", "feeds"),
            params: self.aliases(fields.optional("params"), "params", "sets"),
            nodes: self.nodes(nodes),
            outputs: self.outputs(outputs),
        };
        fields.optional("layout");
        fields.no_more_but_say(trust::about_field);
        Some(recipe)
    }

    /// Whether the format is newer than what this program reads. Such a one may mean anything by
    /// its fields, so nothing else is said about it.
    fn is_newer(&self, fields: &mut Fields<'f>) -> bool {
        let Some(item) = fields.required("format") else { return false };
        let value = item.value();
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
        self.form.push(fault.at(value.span.clone()));
        matches!(value.kind, ValueKind::Integer(format) if format > FORMAT)
    }

    fn outputs(&self, item: Option<Item<'f>>) -> Vec<Name> {
        let Some(item) = item else { return Vec::new() };
        if matches!(&item.value().kind, ValueKind::List(items) if items.is_empty()) {
            item.fault("outputs is empty, so the recipe is run for nothing");
        }
        let names = item.names().unwrap_or_default();
        let mut seen = HashSet::new();
        for name in names.iter().filter(|name| !seen.insert(name.text.as_str())) {
            self.form.fault(&name.span, format!("outputs names {:?} twice", name.text));
        }
        names
    }

    fn nodes(&self, item: Option<Item<'f>>) -> Vec<RecipeNode> {
        let Some(item) = item else { return Vec::new() };
        let entries = item.clone().entries().unwrap_or_default();
        if entries.len() > MAX_NODES {
            let count = entries.len();
            item.fault(format!("the recipe has {count} nodes; the limit is {MAX_NODES}"));
            return Vec::new();
        }
        entries.into_iter().filter_map(|(id, item)| self.node(id, item)).collect()
    }

    fn node(&self, id: Name, item: Item<'f>) -> Option<RecipeNode> {
        self.check_name(&id, "a node");
        let mut fields = item.called(format!("node {:?}", id.text)).fields(None)?;
        let kind = fields.required("kind").and_then(Item::name);
        let source =
            |(port, item): (Name, Item<'f>)| Some((port, item.called("a source in from").name()?));
        let from = entries(fields.optional("from")).into_iter().filter_map(source).collect();
        let set = entries(fields.optional("set"));
        let set = set.into_iter().filter_map(|(name, item)| self.literal(name, &item)).collect();
        text(fields.optional("note"));
        fields.no_more_but_say(trust::about_field);
        Some(RecipeNode { id, kind: kind?, from, set })
    }

    /// What a field is set to; complains of what no field takes.
    fn literal(&self, name: Name, item: &Item<'f>) -> Option<(Name, Value)> {
        match &item.value().kind {
            ValueKind::Text(text) if text.len() > MAX_VALUE_BYTES => {
                let (what, bytes) = (&name.text, text.len());
                item.fault(format!("{what} has {bytes} bytes; the limit is {MAX_VALUE_BYTES}"));
                None
            }
            ValueKind::Unit
            | ValueKind::List(_)
            | ValueKind::Map(_)
            | ValueKind::Struct { .. }
            | ValueKind::Tuple { .. } => item.mismatch("a number, a text, true or false"),
            _ => Some((name, item.value().clone())),
        }
    }

    fn check_name(&self, name: &Name, what: &str) {
        let fits = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
        let Name { text, span } = name;
        if text.is_empty() || text.len() > 64 || !text.chars().all(fits) {
            let fault = Diagnostic::error(format!("{text:?} is no name for {what}"));
            let help = "letters, digits, _ and - do, 64 at most";
            self.form.push(fault.at(span.clone()).help(help));
        }
    }

    /// Names for what is inside the recipe. Nothing may be driven by two of them: which one counts
    /// would depend on their order.
    fn aliases(&self, item: Option<Item<'f>>, what: &str, targets: &'static str) -> Vec<Alias> {
        let mut aliases = Vec::new();
        for (name, item) in entries(item) {
            self.check_name(&name, "what a user sets");
            let Some(mut fields) = item.called(format!("{:?}", name.text)).fields(None) else {
                continue;
            };
            let about = text(fields.optional("about"));
            let targets = fields.required(targets).and_then(Item::names).unwrap_or_default();
            fields.no_more();
            aliases.push(Alias { name, targets, about });
        }
        let mut seen = HashSet::new();
        let targets = aliases.iter().flat_map(|alias| &alias.targets);
        for target in targets.filter(|target| !seen.insert(target.text.as_str())) {
            self.form.fault(&target.span, format!("{what} drives {:?} twice", target.text));
        }
        aliases
    }
}

fn text(item: Option<Item<'_>>) -> String {
    item.and_then(Item::text).unwrap_or_default()
}

fn entries<'f>(item: Option<Item<'f>>) -> Vec<(Name, Item<'f>)> {
    item.and_then(Item::entries).unwrap_or_default()
}

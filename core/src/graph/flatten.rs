//! Inner recipes laid out flat.
//!
//! A recipe is untrusted, and recipes inside recipes multiply: a few kilobytes can ask for 2¹⁶
//! copies. So nodes and text are counted before a copy is laid out, a recipe is read once however
//! often it is used, and one with faults is laid out once, to name them. With the rule that nothing
//! is driven by two names (see [`recipe`](crate::recipe)) all work is linear in the text laid out.

use super::wire::{self, Port};
use crate::catalog::Catalogs;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::files::Origin;
use crate::library::Library;
use crate::node::NodeKind;
use crate::param::Given;
use crate::recipe::{
    MAX_DEPTH, MAX_LAID_OUT_BYTES, MAX_NODES, Name, RECIPE_KIND, Recipe, RecipeNode,
};
use crate::registry::Registry;
use crate::ron::Value;
use crate::source::Span;
use crate::trust;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::rc::Rc;

/// The parameter of a node that stands for another recipe: which one.
const RECIPE_PARAM: &str = "recipe";

/// What a field is set to.
#[derive(Clone, Debug)]
pub(super) enum Content {
    Literal(Value),
    Word(String),
}

impl Content {
    fn as_word(&self) -> Option<&str> {
        match self {
            Self::Literal(value) => value.as_str(),
            Self::Word(word) => Some(word),
        }
    }
}

/// What a field is set to, and by what.
#[derive(Clone, Debug)]
pub(super) struct Assigned {
    pub(super) content: Content,
    pub(super) span: Span,
    pub(super) origin: Origin,
}

impl Assigned {
    fn literal(value: &Value, origin: &Origin) -> Self {
        let (content, span) = (Content::Literal(value.clone()), value.span.clone());
        Self { content, span, origin: origin.clone() }
    }

    pub(super) fn given(&self) -> Given<'_> {
        match &self.content {
            Content::Literal(value) => Given::Literal(value),
            Content::Word(word) => Given::Word(word),
        }
    }
}

/// What an input is fed from: a name, and the scope in which it is to be looked up.
pub(super) struct Feed {
    pub(super) source: Name,
    pub(super) scope: usize,
}

/// A node of the flat graph, not yet checked.
pub(super) struct FlatNode {
    pub(super) id: String,
    pub(super) span: Span,
    /// Index into the registry's kinds; `None` where the kind is unknown, which was complained of.
    pub(super) kind: Option<usize>,
    pub(super) set: BTreeMap<String, Assigned>,
    pub(super) from: BTreeMap<String, Feed>,
}

impl FlatNode {
    pub(super) fn fault(&self, message: String) -> Diagnostic {
        Diagnostic::error(message).at(self.span.clone())
    }

    /// Whether an entry is chosen that is known but not to be had.
    fn misses_entry(&self, kind: &NodeKind, catalogs: &Catalogs) -> bool {
        kind.choosers().any(|(chooser, catalog)| {
            let chosen = self.set.get(chooser).and_then(|assigned| assigned.content.as_word());
            chosen.is_some_and(|chosen| {
                catalogs.entry(catalog, chosen).is_none()
                    && catalogs.missing(catalog, chosen).is_some()
            })
        })
    }
}

/// What a name in a recipe stands for.
#[derive(Clone, Copy)]
pub(super) enum Member {
    Node(usize),
    Recipe(usize),
    /// An inner recipe that was complained of; nothing more is said about it.
    Broken,
}

/// One recipe, outer or inner, and its names.
pub(super) struct Scope {
    pub(super) recipe: Rc<Recipe>,
    pub(super) members: HashMap<String, Member>,
    /// Its outputs, which are its ports where it serves as a node.
    pub(super) ports: Vec<Port>,
}

/// All nodes of a recipe and of those inside it. Scope 0 is the outermost.
#[derive(Default)]
pub(super) struct Flattened {
    pub(super) nodes: Vec<FlatNode>,
    pub(super) scopes: Vec<Scope>,
}

pub(super) struct Flattener<'a> {
    pub(super) registry: &'a Registry,
    library: &'a Library,
    pub(super) faults: &'a mut Diagnostics,
    pub(super) flat: Flattened,
    /// The recipes read so far, by where and under what name they were looked for; `None` for those
    /// that were complained of.
    opened: HashMap<(Origin, String), Option<Rc<Recipe>>>,
    /// The recipes being laid out, outermost first.
    open: Vec<Rc<Recipe>>,
    nodes: usize,
    bytes: usize,
    /// Whether a limit was reached, of which enough was said.
    full: bool,
}

impl<'a> Flattener<'a> {
    /// Lays out a recipe.
    pub(super) fn new(
        recipe: &Recipe,
        registry: &'a Registry,
        library: &'a Library,
        faults: &'a mut Diagnostics,
    ) -> Self {
        let mut flattener = Self {
            registry,
            library,
            faults,
            flat: Flattened::default(),
            opened: HashMap::new(),
            open: Vec::new(),
            nodes: recipe.nodes.len(),
            bytes: recipe.source.text().len(),
            full: false,
        };
        flattener.lay_out(&Rc::new(recipe.clone()), "");
        flattener
    }

    pub(super) fn fault(&mut self, span: &Span, message: String) {
        self.faults.push(Diagnostic::error(message).at(span.clone()));
    }

    /// Adds a recipe's nodes; `prefix` goes before their names. Returns its scope.
    fn lay_out(&mut self, recipe: &Rc<Recipe>, prefix: &str) -> usize {
        let scope = self.flat.scopes.len();
        let (members, ports) = (HashMap::with_capacity(recipe.nodes.len()), Vec::new());
        self.flat.scopes.push(Scope { recipe: Rc::clone(recipe), members, ports });
        self.open.push(Rc::clone(recipe));
        for node in &recipe.nodes {
            let member = if node.kind.text == RECIPE_KIND {
                self.inner_recipe(recipe, node, prefix, scope).unwrap_or(Member::Broken)
            } else {
                Member::Node(self.node(recipe, node, prefix, scope))
            };
            self.flat.scopes[scope].members.insert(node.id.text.clone(), member);
        }
        self.open.pop();
        for target in recipe.params.iter().flat_map(|alias| &alias.targets) {
            self.check_param(scope, target);
        }
        for target in recipe.inputs.iter().flat_map(|alias| &alias.targets) {
            self.check_input(scope, target);
        }
        let ports = wire::ports(&self.flat, self.registry, scope, self.faults);
        self.flat.scopes[scope].ports = ports;
        scope
    }

    fn node(&mut self, recipe: &Recipe, node: &RecipeNode, prefix: &str, scope: usize) -> usize {
        let kinds = self.registry.kinds();
        let kind = kinds.binary_search_by(|kind| kind.name.cmp(&node.kind.text)).ok();
        let set = node
            .set
            .iter()
            .map(|(name, value)| (name.text.clone(), Assigned::literal(value, &recipe.origin)));
        let from = node
            .from
            .iter()
            .map(|(port, source)| (port.text.clone(), Feed { source: source.clone(), scope }));
        let (id, span) = (format!("{prefix}{}", node.id.text), node.id.span.clone());
        let flat = FlatNode { id, span, kind, set: set.collect(), from: from.collect() };
        self.flat.nodes.push(flat);
        let at = self.flat.nodes.len() - 1;
        let Some(kind) = kind else {
            self.unknown_kind(&node.kind);
            return at;
        };
        for (name, _) in &node.set {
            self.check_field(at, &node.id.text, &name.text, &name.span);
        }
        for (port, _) in &node.from {
            self.check_port(kind, &node.id.text, &port.text, &port.span);
        }
        at
    }

    fn unknown_kind(&mut self, kind: &Name) {
        let message = format!("there is no kind of node called {:?}", kind.text);
        let fault = |message: String| Diagnostic::error(message).at(kind.span.clone());
        if let Some(missing) = self.registry.missing_kind(&kind.text) {
            let fault = fault(format!("{message}: {}", missing.why));
            return self.faults.push(fault.help(missing.help.as_str()));
        }
        if trust::looks_like_library(&kind.text) {
            let help = format!(
                "for another recipe write kind: {RECIPE_KIND:?}, set: {{ {RECIPE_PARAM:?}: \"name.ron\" }}"
            );
            let fault = fault(format!("{message}; {}", trust::NO_LIBRARY));
            return self.faults.push(fault.help(help));
        }
        let names = self.registry.kinds().iter().map(|kind| kind.name).chain([RECIPE_KIND]);
        self.faults.push_near(fault(message), &kind.text, names);
    }

    /// Whether a node has a parameter, of its own or of some entry that it may choose; complains if
    /// not. Which entry it will choose is not known yet.
    pub(super) fn check_field(&mut self, at: usize, id: &str, field: &str, span: &Span) -> bool {
        let node = &self.flat.nodes[at];
        let Some(kind) = node.kind else { return true };
        let kind = &self.registry.kinds()[kind];
        if kind.param(field).is_some() {
            return true;
        }
        let catalogs = self.registry.catalogs();
        let entries = kind.choosers().flat_map(|(_, catalog)| catalogs.entries(catalog));
        let brought = entries.flat_map(|entry| &entry.params);
        let names: BTreeSet<&str> =
            kind.params.iter().chain(brought).map(|param| param.name).collect();
        // Of an entry that is not to be had nobody knows the parameters.
        if names.contains(field) || node.misses_entry(kind, catalogs) {
            return true;
        }
        let message = format!("node {id:?} ({}) has no parameter {field:?}", kind.name);
        let fault = Diagnostic::error(message).at(span.clone());
        self.faults.push_near(fault, field, names);
        false
    }

    /// Complains if a kind lacks an input.
    pub(super) fn check_port(&mut self, kind: usize, id: &str, port: &str, span: &Span) {
        let kind = &self.registry.kinds()[kind];
        if kind.inputs.iter().any(|spec| spec.name == port) {
            return;
        }
        let message = format!("node {id:?} ({}) has no input {port:?}", kind.name);
        let fault = Diagnostic::error(message).at(span.clone());
        self.faults.push_near(fault, port, kind.inputs.iter().map(|spec| spec.name));
    }

    /// Lays out the recipe that a node stands for. `None` where there was something to complain of.
    fn inner_recipe(
        &mut self,
        outer: &Recipe,
        node: &RecipeNode,
        prefix: &str,
        scope: usize,
    ) -> Option<Member> {
        let Some((_, path)) = node.set.iter().find(|(name, _)| name.text == RECIPE_PARAM) else {
            let message =
                format!("node {:?} does not say which recipe it stands for", node.id.text);
            let help = format!("add set: {{ {RECIPE_PARAM:?}: \"name.ron\" }}");
            self.faults.push(Diagnostic::error(message).at(node.id.span.clone()).help(help));
            return None;
        };
        let reference = path.as_text(RECIPE_PARAM).map_err(|fault| self.faults.push(fault)).ok()?;
        let recipe = self.open(outer, reference, &path.span)?;
        if !self.has_room_for(&recipe, &path.span) {
            return None;
        }
        let faults = self.faults.len();
        let inner = self.lay_out(&recipe, &format!("{prefix}{}/", node.id.text));
        if self.faults.len() > faults {
            self.opened.insert((outer.origin.clone(), reference.to_owned()), None);
            return None;
        }
        for (port, source) in &node.from {
            let feed = || Feed { source: source.clone(), scope };
            self.feed(inner, &node.id.text, port, &feed);
        }
        for (name, value) in node.set.iter().filter(|(name, _)| name.text != RECIPE_PARAM) {
            let assigned = Assigned::literal(value, &outer.origin);
            self.assign_param(inner, &node.id.text, name, &assigned);
        }
        Some(Member::Recipe(inner))
    }

    /// Reads a recipe, if that was not done already.
    fn open(&mut self, outer: &Recipe, reference: &str, span: &Span) -> Option<Rc<Recipe>> {
        let key = (outer.origin.clone(), reference.to_owned());
        if let Some(known) = self.opened.get(&key) {
            return known.clone();
        }
        let opened = match self.library.open(reference, &outer.origin) {
            Ok(recipe) => Some(Rc::new(recipe)),
            Err(faults) => {
                for mut fault in faults.0 {
                    fault.span.get_or_insert_with(|| span.clone());
                    self.faults.push(fault);
                }
                None
            }
        };
        self.opened.insert(key, opened.clone());
        opened
    }

    /// Counts a recipe that is about to be laid out; complains if that leads nowhere.
    fn has_room_for(&mut self, recipe: &Recipe, span: &Span) -> bool {
        let is_same = |outer: &Rc<Recipe>| {
            outer.origin == recipe.origin && outer.source.text() == recipe.source.text()
        };
        if let Some(start) = self.open.iter().position(is_same) {
            let names = self.open[start..].iter().map(|recipe| recipe.name.as_str());
            let names: Vec<&str> = names.chain([recipe.name.as_str()]).collect();
            let message = format!("these recipes use each other in a loop: {}", names.join(" -> "));
            self.fault(span, message);
            return false;
        }
        if self.open.len() > MAX_DEPTH {
            self.fault(span, format!("recipes are nested deeper than {MAX_DEPTH}"));
            return false;
        }
        self.nodes += recipe.nodes.len();
        self.bytes += recipe.source.text().len();
        let message = if self.nodes > MAX_NODES {
            format!("with its inner recipes the recipe has more than {MAX_NODES} nodes")
        } else if self.bytes > MAX_LAID_OUT_BYTES {
            format!("with its inner recipes the recipe has more than {MAX_LAID_OUT_BYTES} bytes")
        } else {
            return true;
        };
        if !std::mem::replace(&mut self.full, true) {
            self.fault(span, message);
        }
        false
    }
}

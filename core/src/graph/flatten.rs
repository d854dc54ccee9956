//! Inner recipes laid out flat, and each thing that is set brought to the node that it sets.

use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::files::Origin;
use crate::library::Library;
use crate::param::Given;
use crate::recipe::{Alias, MAX_DEPTH, MAX_NODES, Name, Recipe, RecipeNode};
use crate::registry::Registry;
use crate::ron::Value;
use crate::source::{Source, Span};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The kind that stands for another recipe, and its parameter that names it.
pub(super) const RECIPE_KIND: &str = "recipe";
pub(super) const RECIPE_PARAM: &str = "recipe";

/// Something set from outside the recipe, as `--set name=value` does.
#[derive(Clone, Debug)]
pub struct Setting {
    /// A knob of the recipe, or `node.field`.
    pub name: String,
    /// Its value as it was typed.
    pub value: String,
    /// Where relative paths in it start.
    pub origin: Origin,
}

/// What a field is set to.
#[derive(Clone, Debug)]
enum Content {
    Literal(Value),
    Word(String),
}

/// What a field is set to, and by what.
#[derive(Clone, Debug)]
pub(super) struct Assigned {
    content: Content,
    pub(super) span: Span,
    pub(super) origin: Origin,
}

impl Assigned {
    pub(super) fn given(&self) -> Given<'_> {
        match &self.content {
            Content::Literal(value) => Given::Literal(value),
            Content::Word(word) => Given::Word(word),
        }
    }
}

/// A node of the flat graph, not yet checked.
pub(super) struct FlatNode {
    pub(super) id: String,
    pub(super) span: Span,
    /// Index into the registry's kinds; `None` where the kind is unknown, which was complained of.
    pub(super) kind: Option<usize>,
    pub(super) set: BTreeMap<String, Assigned>,
    /// Input port, where from, and the scope in which that is to be looked up.
    pub(super) from: Vec<(Name, Name, usize)>,
}

impl FlatNode {
    pub(super) fn fault(&self, message: String) -> Diagnostic {
        Diagnostic::error(message).at(self.span.clone()).node(&self.id)
    }
}

/// What a name in a recipe stands for.
#[derive(Clone, Copy)]
pub(super) enum Member {
    Node(usize),
    Recipe(usize),
}

/// One recipe, outer or inner, and its names.
pub(super) struct Scope {
    pub(super) members: HashMap<String, Member>,
    pub(super) outputs: Vec<Name>,
    params: Vec<Alias>,
    inputs: Vec<Alias>,
}

/// All nodes of a recipe and of those inside it. Scope 0 is the outermost.
pub(super) struct Flattened {
    pub(super) nodes: Vec<FlatNode>,
    pub(super) scopes: Vec<Scope>,
}

struct Flattener<'a> {
    registry: &'a Registry,
    library: &'a Library,
    faults: &'a mut Diagnostics,
    flat: Flattened,
}

pub(super) fn flatten(
    recipe: &Recipe,
    settings: &[Setting],
    registry: &Registry,
    library: &Library,
    faults: &mut Diagnostics,
) -> Flattened {
    let flat = Flattened { nodes: Vec::new(), scopes: Vec::new() };
    let mut flattener = Flattener { registry, library, faults, flat };
    let outer = flattener.lay_out(recipe, "", 0);
    for setting in settings {
        flattener.apply(outer, setting);
    }
    flattener.flat
}

impl Flattener<'_> {
    fn fault(&mut self, span: &Span, message: String) {
        self.faults.push(Diagnostic::error(message).at(span.clone()));
    }

    fn fault_near<'n>(
        &mut self,
        span: &Span,
        message: String,
        word: &str,
        names: impl IntoIterator<Item = &'n str> + Clone,
    ) {
        let fault = Diagnostic::error(message).at(span.clone());
        let help = match did_you_mean(word, names.clone()) {
            Some(near) => format!("did you mean {near:?}?"),
            None => {
                let mut names: Vec<&str> = names.into_iter().collect();
                names.sort_unstable();
                names.truncate(40);
                format!("there is {}", if names.is_empty() { "none".into() } else { names.join(", ") })
            }
        };
        self.faults.push(fault.help(help));
    }

    /// Adds a recipe's nodes; `prefix` goes before their names. Returns its scope.
    fn lay_out(&mut self, recipe: &Recipe, prefix: &str, depth: usize) -> usize {
        let scope = self.flat.scopes.len();
        self.flat.scopes.push(Scope {
            members: HashMap::new(),
            outputs: recipe.outputs.clone(),
            params: recipe.params.clone(),
            inputs: recipe.inputs.clone(),
        });
        for node in &recipe.nodes {
            let member = if node.kind.text == RECIPE_KIND {
                self.inner_recipe(recipe, node, prefix, depth, scope).map(Member::Recipe)
            } else {
                Some(Member::Node(self.node(recipe, node, prefix, scope)))
            };
            if let Some(member) = member {
                self.flat.scopes[scope].members.insert(node.id.text.clone(), member);
            }
        }
        for alias in &recipe.params {
            for target in &alias.targets {
                self.check_target(scope, alias, target);
            }
        }
        if self.flat.nodes.len() > MAX_NODES {
            let count = self.flat.nodes.len();
            let message = format!(
                "with its inner recipes this has {count} nodes or more; the limit is {MAX_NODES}"
            );
            self.faults.push(Diagnostic::error(message));
            // What is over the limit is left out, so that nothing grows with it.
            self.flat.nodes.truncate(MAX_NODES);
        }
        scope
    }

    fn node(&mut self, recipe: &Recipe, node: &RecipeNode, prefix: &str, scope: usize) -> usize {
        let kinds = self.registry.kinds();
        let kind = kinds.iter().position(|kind| kind.name == node.kind.text);
        if kind.is_none() {
            let message = format!("there is no kind of node called {:?}", node.kind.text);
            let names = kinds.iter().map(|kind| kind.name).chain([RECIPE_KIND]);
            self.fault_near(&node.kind.span, message, &node.kind.text, names);
        }
        let set = node.set.iter().map(|(name, value)| {
            let (span, origin) = (value.span.clone(), recipe.origin.clone());
            let content = Content::Literal(value.clone());
            (name.text.clone(), Assigned { content, span, origin })
        });
        let set = set.collect();
        let from = node.from.iter().map(|(port, source)| (port.clone(), source.clone(), scope));
        let from = from.collect();
        let (id, span) = (format!("{prefix}{}", node.id.text), node.id.span.clone());
        if let Some(kind) = kind {
            for (name, _) in &node.set {
                self.check_field(kind, &node.id.text, &name.text, &name.span);
            }
        }
        self.flat.nodes.push(FlatNode { id, span, kind, set, from });
        self.flat.nodes.len() - 1
    }

    fn check_field(&mut self, kind: usize, node: &str, field: &str, span: &Span) -> bool {
        let kind = &self.registry.kinds()[kind];
        if kind.param(field).is_some() {
            return true;
        }
        let message = format!("node {node:?} ({}) has no parameter {field:?}", kind.name);
        let names: Vec<&str> = kind.params.iter().map(|param| param.name).collect();
        self.fault_near(span, message, field, names);
        false
    }

    fn inner_recipe(
        &mut self,
        outer: &Recipe,
        node: &RecipeNode,
        prefix: &str,
        depth: usize,
        scope: usize,
    ) -> Option<usize> {
        let path = node.set.iter().find(|(name, _)| name.text == RECIPE_PARAM);
        let Some((_, path)) = path else {
            let message = format!(
                "node {:?} does not say which recipe: set: {{ {RECIPE_PARAM:?}: \"name.ron\" }}",
                node.id.text
            );
            self.fault(&node.id.span, message);
            return None;
        };
        let reference = path.as_text(RECIPE_PARAM).map_err(|fault| self.faults.push(fault)).ok()?;
        if depth >= MAX_DEPTH {
            let message = format!("recipes are nested deeper than {MAX_DEPTH}: does one use itself?");
            self.fault(&path.span, message);
            return None;
        }
        let recipe = match self.library.open(reference, &outer.origin) {
            Ok(recipe) => recipe,
            Err(faults) => {
                for mut fault in faults.0 {
                    fault.span.get_or_insert_with(|| path.span.clone());
                    self.faults.push(fault);
                }
                return None;
            }
        };
        if self.flat.nodes.len() + recipe.nodes.len() > MAX_NODES {
            let message = format!("with this recipe there are more than {MAX_NODES} nodes");
            self.fault(&path.span, message);
            return None;
        }
        let inner = self.lay_out(&recipe, &format!("{prefix}{}/", node.id.text), depth + 1);
        self.feed_inputs(inner, node, scope);
        for (name, value) in node.set.iter().filter(|(name, _)| name.text != RECIPE_PARAM) {
            let (span, origin) = (value.span.clone(), outer.origin.clone());
            let assigned = Assigned { content: Content::Literal(value.clone()), span, origin };
            self.assign_param(inner, &node.id.text, name, &assigned);
        }
        Some(inner)
    }

    /// Ties what the outer recipe wires to an inner one to the nodes behind its inputs.
    fn feed_inputs(&mut self, inner: usize, node: &RecipeNode, scope: usize) {
        for (port, source) in &node.from {
            let inputs = &self.flat.scopes[inner].inputs;
            let Some(input) = inputs.iter().find(|input| input.name.text == port.text).cloned()
            else {
                let names: Vec<String> = inputs.iter().map(|i| i.name.text.clone()).collect();
                let message = format!("recipe {:?} has no input {:?}", node.id.text, port.text);
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                self.fault_near(&port.span, message, &port.text, names);
                continue;
            };
            for target in &input.targets {
                match self.resolve(inner, target) {
                    Some((Member::Node(at), field)) => {
                        let port = Name { text: field, span: target.span.clone() };
                        self.flat.nodes[at].from.push((port, source.clone(), scope));
                    }
                    Some((Member::Recipe(_), _)) => {
                        let message = "an input must feed a node, not a recipe".to_owned();
                        self.fault(&target.span, message);
                    }
                    None => {}
                }
            }
        }
    }

    /// The member and field that `node.field` names.
    fn resolve(&mut self, scope: usize, target: &Name) -> Option<(Member, String)> {
        let Some((id, field)) = target.text.split_once('.') else {
            let message = format!("{:?} does not name a field: write node.field", target.text);
            self.fault(&target.span, message);
            return None;
        };
        let members = &self.flat.scopes[scope].members;
        let Some(member) = members.get(id).copied() else {
            let names: Vec<String> = members.keys().cloned().collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            self.fault_near(&target.span, format!("there is no node {id:?}"), id, names);
            return None;
        };
        Some((member, field.to_owned()))
    }

    fn check_target(&mut self, scope: usize, alias: &Alias, target: &Name) {
        match self.resolve(scope, target) {
            Some((Member::Node(at), field)) => {
                if let Some(kind) = self.flat.nodes[at].kind {
                    let id = self.flat.nodes[at].id.clone();
                    self.check_field(kind, &id, &field, &target.span);
                }
            }
            Some((Member::Recipe(inner), field)) => {
                self.inner_param(inner, &alias.name.text, &field, &target.span);
            }
            None => {}
        }
    }

    fn inner_param(&mut self, inner: usize, id: &str, name: &str, span: &Span) -> Option<Alias> {
        let params = &self.flat.scopes[inner].params;
        if let Some(alias) = params.iter().find(|alias| alias.name.text == name) {
            return Some(alias.clone());
        }
        let names: Vec<String> = params.iter().map(|alias| alias.name.text.clone()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        self.fault_near(span, format!("recipe {id:?} has no parameter {name:?}"), name, names);
        None
    }

    /// Sets a knob of a recipe: all that it drives.
    fn assign_param(&mut self, scope: usize, id: &str, name: &Name, assigned: &Assigned) {
        let Some(alias) = self.inner_param(scope, id, &name.text, &name.span) else { return };
        for target in &alias.targets {
            self.assign(scope, target, assigned);
        }
    }

    /// Sets what `target` names in a scope.
    fn assign(&mut self, scope: usize, target: &Name, assigned: &Assigned) {
        match self.resolve(scope, target) {
            Some((Member::Node(at), field)) => {
                self.flat.nodes[at].set.insert(field, assigned.clone());
            }
            Some((Member::Recipe(inner), field)) => {
                let id = target.text.clone();
                let name = Name { text: field, span: target.span.clone() };
                self.assign_param(inner, &id, &name, assigned);
            }
            None => {}
        }
    }

    /// Applies `--set name=value` to the outermost recipe.
    fn apply(&mut self, outer: usize, setting: &Setting) {
        let text = format!("{}={}", setting.name, setting.value);
        let source = Arc::new(Source::new("--set", text));
        let name_end = setting.name.len();
        let name = Name { text: setting.name.clone(), span: source.span(0..name_end) };
        let span = source.span(name_end + 1..source.text().len());
        let content = Content::Word(setting.value.clone());
        let assigned = Assigned { content, span, origin: setting.origin.clone() };
        let scope = &self.flat.scopes[outer];
        let alias = scope.params.iter().find(|alias| alias.name.text == name.text).cloned();
        if let Some(alias) = alias {
            for target in &alias.targets {
                self.assign(outer, target, &assigned);
            }
            return;
        }
        match name.text.split_once('.') {
            Some((id, field)) => self.apply_to_node(id, field, &name, assigned),
            None => {
                let names: Vec<String> =
                    scope.params.iter().map(|alias| alias.name.text.clone()).collect();
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                let message = format!("the recipe has no parameter {:?}", name.text);
                self.fault_near(&name.span, message, &name.text, names);
            }
        }
    }

    fn apply_to_node(&mut self, id: &str, field: &str, name: &Name, assigned: Assigned) {
        let Some(at) = self.flat.nodes.iter().position(|node| node.id == id) else {
            let names: Vec<String> = self.flat.nodes.iter().map(|node| node.id.clone()).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            self.fault_near(&name.span, format!("there is no node {id:?}"), id, names);
            return;
        };
        let known = match self.flat.nodes[at].kind {
            Some(kind) => self.check_field(kind, id, field, &name.span),
            None => false,
        };
        if known {
            self.flat.nodes[at].set.insert(field.to_owned(), assigned);
        }
    }
}

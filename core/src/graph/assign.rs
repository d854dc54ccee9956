//! What is set and fed from outside a recipe, brought to the nodes inside it.

use super::flatten::{Assigned, Content, Feed, Flattener, Member};
use crate::diagnostic::Diagnostic;
use crate::files::Origin;
use crate::recipe::{Alias, Name};
use crate::source::Source;
use std::sync::Arc;

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

impl Flattener<'_> {
    /// The member and field that `node.field` names.
    fn resolve(&mut self, scope: usize, target: &Name) -> Option<(Member, Name)> {
        let Some((id, field)) = target.text.split_once('.') else {
            let message = format!("{:?} names no field: write node.field", target.text);
            self.fault(&target.span, message);
            return None;
        };
        let members = &self.flat.scopes[scope].members;
        let Some(member) = members.get(id).copied() else {
            let fault = Diagnostic::error(format!("there is no node {id:?}"));
            let names = members.keys().map(String::as_str);
            self.faults.push_near(fault.at(target.span.clone()), id, names);
            return None;
        };
        Some((member, Name { text: field.to_owned(), span: target.span.clone() }))
    }

    /// Complains if a knob drives what is not there.
    pub(super) fn check_param(&mut self, scope: usize, target: &Name) {
        match self.resolve(scope, target) {
            Some((Member::Node(at), field)) => {
                let id = self.flat.nodes[at].id.clone();
                self.check_field(at, &id, &field.text, &field.span);
            }
            Some((Member::Recipe(inner), field)) => {
                self.alias(inner, &target.text, &field, "parameter", |recipe| &recipe.params);
            }
            Some((Member::Broken, _)) | None => {}
        }
    }

    /// Complains if an input feeds what is not there.
    pub(super) fn check_input(&mut self, scope: usize, target: &Name) {
        match self.resolve(scope, target) {
            Some((Member::Node(at), port)) => {
                if let Some(kind) = self.flat.nodes[at].kind {
                    let id = self.flat.nodes[at].id.clone();
                    self.check_port(kind, &id, &port.text, &port.span);
                }
            }
            Some((Member::Recipe(inner), port)) => {
                self.alias(inner, &target.text, &port, "input", |recipe| &recipe.inputs);
            }
            Some((Member::Broken, _)) | None => {}
        }
    }

    /// The knob or input of an inner recipe that `name` names; complains if there is none. `node`
    /// is the node that stands for the recipe, or a field of it.
    fn alias(
        &mut self,
        scope: usize,
        node: &str,
        name: &Name,
        what: &str,
        aliases: impl Fn(&crate::Recipe) -> &Vec<Alias>,
    ) -> Option<Alias> {
        let aliases = aliases(&self.flat.scopes[scope].recipe);
        let found = aliases.iter().find(|alias| alias.name.text == name.text).cloned();
        if found.is_none() {
            let id = node.split('.').next().unwrap_or_default();
            let message = format!("recipe {id:?} has no {what} {:?}", name.text);
            let fault = Diagnostic::error(message).at(name.span.clone());
            let names = aliases.iter().map(|alias| alias.name.text.as_str());
            self.faults.push_near(fault, &name.text, names);
        }
        found
    }

    /// Feeds an input of a recipe: all ports that it stands for, in place of what the recipe feeds
    /// them with when it runs alone.
    pub(super) fn feed(&mut self, scope: usize, id: &str, port: &Name, feed: &dyn Fn() -> Feed) {
        let Some(alias) = self.alias(scope, id, port, "input", |recipe| &recipe.inputs) else {
            return;
        };
        for target in &alias.targets {
            match self.resolve(scope, target) {
                Some((Member::Node(at), port)) => {
                    self.flat.nodes[at].from.insert(port.text, feed());
                }
                Some((Member::Recipe(inner), port)) => self.feed(inner, &target.text, &port, feed),
                Some((Member::Broken, _)) | None => {}
            }
        }
    }

    /// Sets a knob of a recipe: all that it drives.
    pub(super) fn assign_param(
        &mut self,
        scope: usize,
        id: &str,
        name: &Name,
        assigned: &Assigned,
    ) {
        let Some(alias) = self.alias(scope, id, name, "parameter", |recipe| &recipe.params) else {
            return;
        };
        for target in &alias.targets {
            if let Some((member, field)) = self.resolve(scope, target) {
                self.assign(member, &target.text, &field, assigned);
            }
        }
    }

    fn assign(&mut self, member: Member, id: &str, field: &Name, assigned: &Assigned) {
        match member {
            Member::Node(at) => {
                self.flat.nodes[at].set.insert(field.text.clone(), assigned.clone());
            }
            Member::Recipe(inner) => self.assign_param(inner, id, field, assigned),
            Member::Broken => {}
        }
    }

    /// Applies `--set name=value` to the outermost recipe.
    pub(super) fn apply(&mut self, setting: &Setting) {
        let text = format!("{}={}", setting.name, setting.value);
        let source = Arc::new(Source::new("--set", text));
        let name_end = setting.name.len();
        let name = Name { text: setting.name.clone(), span: source.span(0..name_end) };
        let span = source.span(name_end + 1..source.text().len());
        let content = Content::Word(setting.value.clone());
        let assigned = Assigned { content, span, origin: setting.origin.clone() };
        let Some((id, field)) = name.text.split_once('.') else {
            return self.assign_outermost(&name, &assigned);
        };
        let Some(member) = self.member(id) else {
            let fault = Diagnostic::error(format!("there is no node {id:?}"));
            let names = self.flat.nodes.iter().map(|node| node.id.as_str());
            return self.faults.push_near(fault.at(name.span.clone()), id, names);
        };
        let field = Name { text: field.to_owned(), span: name.span.clone() };
        if let Member::Node(at) = member
            && !self.check_field(at, id, &field.text, &field.span)
        {
            return;
        }
        self.assign(member, id, &field, &assigned);
    }

    /// What a name means from outside: `node`, or `inner/node`.
    fn member(&self, id: &str) -> Option<Member> {
        let mut scope = 0;
        let mut path = id.split('/').peekable();
        while let Some(step) = path.next() {
            let member = self.flat.scopes[scope].members.get(step)?;
            match member {
                Member::Recipe(inner) if path.peek().is_some() => scope = *inner,
                member if path.peek().is_none() => return Some(*member),
                _ => return None,
            }
        }
        None
    }

    fn assign_outermost(&mut self, name: &Name, assigned: &Assigned) {
        let recipe = &self.flat.scopes[0].recipe;
        if recipe.params.iter().any(|alias| alias.name.text == name.text) {
            return self.assign_param(0, "", name, assigned);
        }
        let fault = Diagnostic::error(format!("the recipe has no parameter {:?}", name.text));
        let names = recipe.params.iter().map(|alias| alias.name.text.as_str());
        self.faults.push_near(fault.at(name.span.clone()), &name.text, names);
    }
}

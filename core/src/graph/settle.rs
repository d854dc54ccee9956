//! Every parameter read, checked and set.

use super::flatten::{FlatNode, Flattened};
use crate::catalog::CatalogEntry;
use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::files::{FileError, Files};
use crate::node::{AnyNode, NodeKind};
use crate::param::{ParamSpec, ParamValue, ParamValues};
use crate::registry::Registry;

/// A node with all its parameters.
pub(super) struct Settled {
    pub(super) kind: usize,
    pub(super) values: ParamValues,
    pub(super) node: Box<dyn AnyNode>,
}

/// All the nodes made of their parameters, or `None` if there was something to complain of.
pub(super) fn settle(
    flat: &Flattened,
    registry: &Registry,
    files: Files,
    faults: &mut Diagnostics,
) -> Option<Vec<Settled>> {
    let mut all = Some(Vec::with_capacity(flat.nodes.len()));
    for node in &flat.nodes {
        match (settled(node, registry, files, faults), &mut all) {
            (Some(settled), Some(all)) => all.push(settled),
            _ => all = None,
        }
    }
    all
}

fn settled(
    node: &FlatNode,
    registry: &Registry,
    files: Files,
    faults: &mut Diagnostics,
) -> Option<Settled> {
    let kind = node.kind?;
    let values = values(node, &registry.kinds()[kind], registry, files, faults)?;
    let made = registry.kinds()[kind].maker.make(&values);
    if let Err(conflict) = made.check() {
        faults.push(at_param(node, conflict.param, conflict.message));
        return None;
    }
    Some(Settled { kind, values, node: made })
}

fn at_param(node: &FlatNode, param: &str, message: String) -> Diagnostic {
    let span = node.set.get(param).map_or(&node.span, |assigned| &assigned.span);
    let message = format!("node {:?}: {message}", node.id);
    Diagnostic::error(message).at(span.clone())
}

fn values(
    node: &FlatNode,
    kind: &NodeKind,
    registry: &Registry,
    files: Files,
    faults: &mut Diagnostics,
) -> Option<ParamValues> {
    let values = ParamValues::default();
    let mut settling = Settling { node, registry, files, faults, values, complete: true };
    settling.settle(&kind.params);
    for (chooser, catalog) in kind.choosers() {
        settling.settle_entry(chooser, catalog);
    }
    settling.complete.then_some(settling.values)
}

/// A node on its way to all its values.
struct Settling<'a> {
    node: &'a FlatNode,
    registry: &'a Registry,
    files: Files,
    faults: &'a mut Diagnostics,
    values: ParamValues,
    /// Whether nothing was complained of.
    complete: bool,
}

impl Settling<'_> {
    fn settle(&mut self, specs: &[ParamSpec]) {
        for spec in specs {
            match value(self.node, spec, self.registry, self.files) {
                Ok(value) if self.node.set.contains_key(spec.name) => {
                    self.values.insert(spec.name, value);
                }
                Ok(default) => self.values.leave(spec.name, default),
                Err(fault) => self.complain(fault),
            }
        }
    }

    fn complain(&mut self, fault: Diagnostic) {
        self.faults.push(fault);
        self.complete = false;
    }

    /// Settles what comes with the entry that `chooser` chose, if it chose one.
    fn settle_entry(&mut self, chooser: &'static str, catalog: &str) {
        let catalogs = self.registry.catalogs();
        let chosen =
            self.values.find(chooser).and_then(|name| catalogs.entry(catalog, name.text()));
        let Some(entry) = chosen else { return };
        self.settle(&entry.params);
        self.values.name_entry(chooser, entry.params.iter().map(|spec| spec.name).collect());
        let others = catalogs.entries(catalog);
        for field in self.node.set.keys().filter(|field| entry.param(field).is_none()) {
            // What no entry has was complained of where it is set.
            if others.iter().any(|other| other.param(field).is_some()) {
                self.complain(lacking(self.node, entry, field));
            }
        }
    }
}

/// The fault that an entry was chosen that lacks a field.
fn lacking(node: &FlatNode, entry: &CatalogEntry, field: &str) -> Diagnostic {
    let names: Vec<&str> = entry.params.iter().map(|spec| spec.name).collect();
    let article = if entry.name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    let has = if names.is_empty() { "nothing to set".to_owned() } else { names.join(", ") };
    let message = format!("{article} {} has no {field:?}; it has {has}", entry.name);
    let fault = at_param(node, field, message);
    match did_you_mean(field, names) {
        Some(near) => fault.help(format!("did you mean {near:?}?")),
        None => fault,
    }
}

fn value(
    node: &FlatNode,
    spec: &ParamSpec,
    registry: &Registry,
    files: Files,
) -> Result<ParamValue, Diagnostic> {
    let Some(assigned) = node.set.get(spec.name) else {
        return spec.default.clone().ok_or_else(|| {
            let message = format!("parameter {:?} must be set ({})", spec.name, spec.about);
            at_param(node, spec.name, message)
        });
    };
    let locate = |path: &str| assigned.origin.locate(path);
    let value = spec.read(assigned.given(), registry.catalogs(), &locate).map_err(|fault| {
        let diagnostic = at_param(node, spec.name, fault.message);
        match fault.help {
            Some(help) => diagnostic.help(help),
            None => diagnostic,
        }
    })?;
    if let ParamValue::File(file) = &value {
        files.check(file).map_err(|fault| {
            let diagnostic = at_param(node, spec.name, fault.to_string());
            match fault {
                FileError::NotFound { .. } => diagnostic.help(
                    "a path in a recipe starts at the recipe's folder, one after --set at the \
                     current one",
                ),
                _ => diagnostic,
            }
        })?;
    }
    Ok(value)
}

//! Every parameter read, checked and set.

use super::flatten::{FlatNode, Flattened};
use crate::diagnostic::{Diagnostic, Diagnostics};
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
    let made = (registry.kinds()[kind].make)(&values);
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
    let mut values = ParamValues::default();
    let mut complete = true;
    for spec in &kind.params {
        match value(node, spec, registry, files) {
            Ok(value) => values.insert(spec.name, value),
            Err(fault) => {
                faults.push(fault);
                complete = false;
            }
        }
    }
    complete.then_some(values)
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

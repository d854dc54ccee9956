//! The registry of everything: the standard nodes, and what is offered beside them as catalogs.

use crate::offers::Offers;
use crate::path;
use crate::registry::{kinds, types};
use crate::shop::{Machine, NONE, Tool};
use carvegraph_core::units::Dimension;
use carvegraph_core::{
    CatalogEntry, Catalogs, NodeKind, ParamKind, ParamSpec, ParamValue, Registry, RegistryError,
};
use carvegraph_sdk::{CutterShape, Dialect, DimensionSpec, DimensionUnit};

/// The standard nodes, and all that is offered beside them.
///
/// # Errors
/// If something that is offered does not describe itself soundly, or the lists below are not in order,
/// which is a fault in this file.
pub fn registry(offers: Offers) -> Result<Registry, RegistryError> {
    let shapes = offers.cutters.0.iter().map(|shape| cutter_entry(&**shape, &offers));
    let shapes: Vec<CatalogEntry> = shapes.collect();
    let spoken = offers.dialects.0.iter().map(|dialect| dialect_entry(&**dialect, &offers));
    let spoken: Vec<CatalogEntry> = spoken.collect();
    let Offers { cutters, dialects, machines, tools, nodes, missing, .. } = offers;
    let catalogs = Catalogs::default();
    let catalogs = catalogs.with("cutter", shapes, cutters).with("dialect", spoken, dialects);
    let entries = machines.0.iter().map(|machine| machine_entry(machine, &catalogs));
    let entries: Vec<_> = entries.chain([nothing()]).collect();
    let catalogs = catalogs.with("machine", entries, machines);
    let entries = tools.0.iter().map(|tool| tool_entry(tool, &catalogs));
    let entries: Vec<_> = entries.chain([nothing()]).collect();
    let catalogs = catalogs.with("tool", entries, tools);
    let registry = Registry::new(merged(kinds(), nodes), types(), catalogs)?;
    Ok(missing.into_iter().fold(registry, |registry, (sort, missing)| match sort {
        "node" => registry.with_missing_kinds([missing]),
        catalog => registry.with_missing_entries(catalog, [missing]),
    }))
}

/// The entry that stands for choosing none.
fn nothing() -> CatalogEntry {
    CatalogEntry::new(NONE, "")
}

/// A machine. It may decide the dialect, so that its version is that of both.
fn machine_entry(machine: &Machine, catalogs: &Catalogs) -> CatalogEntry {
    let dialect = machine.dialect.as_deref().and_then(|name| catalogs.entry("dialect", name));
    CatalogEntry::new(machine.name.as_str(), both(&machine.version, dialect))
}

/// A tool. It may decide the shape, so that its version is that of both.
fn tool_entry(tool: &Tool, catalogs: &Catalogs) -> CatalogEntry {
    let shape = catalogs.entry("cutter", &tool.shape.text);
    CatalogEntry::new(tool.name.as_str(), both(&tool.version, shape))
}

fn both(version: &str, decided: Option<&CatalogEntry>) -> String {
    let decided = decided.map(|entry| entry.version.as_str());
    [Some(version), decided].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Adds `extra` to a list that is in order. Each goes to its place; the list is not sorted anew, or
/// a slip in its order would go unseen.
fn merged(mut kinds: Vec<NodeKind>, extra: Vec<NodeKind>) -> Vec<NodeKind> {
    for kind in extra {
        let place = kinds.partition_point(|known| known.name <= kind.name);
        kinds.insert(place, kind);
    }
    kinds
}

/// A shape, and its dimensions and drawing as parameters of the node that chooses it.
fn cutter_entry(shape: &dyn CutterShape, offers: &Offers) -> CatalogEntry {
    let dimensions = shape.dimensions().iter().map(dimension_param);
    let params = dimensions.chain(shape.drawing().map(drawing_param)).collect();
    let version = offers.origin("cutter", shape.name());
    CatalogEntry { params, ..CatalogEntry::new(shape.name(), version) }
}

fn dialect_entry(dialect: &dyn Dialect, offers: &Offers) -> CatalogEntry {
    CatalogEntry::new(dialect.name(), offers.origin("dialect", dialect.name()))
}

fn dimension_param(spec: &DimensionSpec) -> ParamSpec {
    let dimension = match spec.unit {
        DimensionUnit::Mm => Dimension::Length,
        DimensionUnit::Deg => Dimension::Angle,
    };
    ParamSpec {
        name: spec.name,
        about: sentence(spec.about).into(),
        kind: ParamKind::Number { dimension, min: spec.min, max: spec.max },
        default: Some(ParamValue::Number(spec.default)),
        // To a tool of a library.
        yields: true,
    }
}

fn drawing_param(about: &str) -> ParamSpec {
    let (name, about) = (path::DRAWING, sentence(about).into());
    ParamSpec {
        name,
        about,
        kind: ParamKind::InputFile { optional: false },
        default: None,
        yields: false,
    }
}

/// A line with the full stop that parameters are described with.
fn sentence(line: &str) -> String {
    if line.ends_with('.') { line.to_owned() } else { format!("{line}.") }
}

//! What `carve` knows, as text: nodes, cutters, dialects, recipes, plans.

use crate::Refusal;
use carvegraph_core::diagnostic::did_you_mean;
use carvegraph_core::{
    Cache, CancelToken, CatalogEntry, DiskCache, Graph, NodeKind, Origin, ParamKind, ParamSpec,
    ParamValue, Plan, PortSpec, Recipe, Registry, Step,
};
use carvegraph_nodes::{Cutters, Dialects, LIBRARY, Machines, Tools};
use serde_json::{Map, Value as Json, json};
use std::fmt::Write;
use std::path::Path;

/// Rows of text in columns; the last column is as wide as it wants to be.
pub(crate) fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or_default();
    let width = |at: usize| {
        rows.iter().filter_map(|row| row.get(at)).map(|cell| cell.chars().count()).max()
    };
    let widths: Vec<usize> = (0..columns).map(|at| width(at).unwrap_or_default()).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        let line = cells.collect::<Vec<_>>().join("  ");
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

fn first_sentence(text: &str) -> &str {
    text.split_once(". ").map_or(text, |(first, _)| first).trim_end_matches('.')
}

/// All kinds of node by stage.
pub(crate) fn nodes(registry: &Registry) -> String {
    let mut stages: Vec<&str> = Vec::new();
    for kind in registry.kinds() {
        if !stages.contains(&kind.stage) {
            stages.push(kind.stage);
        }
    }
    stages.sort_unstable();
    let mut text = String::new();
    for stage in stages {
        let of_stage = registry.kinds().iter().filter(|kind| kind.stage == stage);
        let rows: Vec<Vec<String>> = of_stage
            .map(|kind| vec![format!("  {}", kind.name), first_sentence(kind.about).to_owned()])
            .collect();
        let _ = write!(text, "{stage}\n{}\n", table(&rows));
    }
    text + "carve nodes KIND describes one.\n"
}

/// One kind of node, or all of them as JSON.
pub(crate) fn node(registry: &Registry, kind: Option<&str>, json: bool) -> Result<String, Refusal> {
    let Some(name) = kind else {
        let all: Vec<Json> =
            registry.kinds().iter().map(|kind| kind_json(registry, kind)).collect();
        return Ok(pretty(&json!(all)));
    };
    let kind = registry.kind(name).ok_or_else(|| {
        let names = registry.kinds().iter().map(|kind| kind.name);
        unknown("kind of node", name, names)
    })?;
    Ok(if json { pretty(&kind_json(registry, kind)) } else { kind_text(registry, kind) })
}

fn unknown<'n>(what: &str, name: &str, names: impl Iterator<Item = &'n str>) -> Refusal {
    let mut message = format!("error: there is no {what} {name:?}");
    if let Some(near) = did_you_mean(name, names) {
        let _ = write!(message, "\n  = help: did you mean {near:?}?");
    }
    Refusal(message)
}

fn pretty(json: &Json) -> String {
    format!("{json:#}\n")
}

fn default_text(spec: &ParamSpec) -> String {
    match &spec.default {
        None => "must be set".to_owned(),
        Some(value) => format!("default {value}"),
    }
}

fn kind_text(registry: &Registry, kind: &NodeKind) -> String {
    let mut text =
        format!("{} ({}, version {})\n\n{}\n", kind.name, kind.stage, kind.version, kind.about);
    if let Some(origin) = &kind.origin {
        let _ = write!(text, "\nFrom {origin}.\n");
    }
    let port = |port: &PortSpec| {
        let optional = if port.optional { " (optional)" } else { "" };
        let name = registry.type_of(port).name;
        vec![format!("  {}", port.name), format!("{name}{optional}"), port.about.to_owned()]
    };
    for (title, ports) in [("Inputs", &kind.inputs), ("Outputs", &kind.outputs)] {
        if !ports.is_empty() {
            let rows: Vec<_> = ports.iter().map(port).collect();
            let _ = write!(text, "\n{title}\n{}", table(&rows));
        }
    }
    if !kind.params.is_empty() {
        text.push_str("\nParameters\n");
    }
    kind.params.iter().for_each(|param| text.push_str(&param_text(param)));
    text
}

fn param_text(param: &ParamSpec) -> String {
    let mut text = format!("  {}: {}, {}\n", param.name, param.kind, default_text(param));
    let _ = writeln!(text, "      {}", param.about);
    match &param.kind {
        ParamKind::Choice(options) => {
            for option in *options {
                let _ = writeln!(text, "      {}: {}", option.name, option.about);
            }
        }
        ParamKind::Catalog { catalog, takes_params: true } => {
            let _ = writeln!(
                text,
                "      The fields of the {catalog} chosen come in addition: carve {catalog}s lists them."
            );
        }
        _ => {}
    }
    text
}

fn kind_json(registry: &Registry, kind: &NodeKind) -> Json {
    let port = |port: &PortSpec| {
        json!({
            "name": port.name,
            "type": registry.type_of(port).name,
            "about": port.about,
            "optional": port.optional,
        })
    };
    json!({
        "kind": kind.name,
        "version": kind.version,
        "stage": kind.stage,
        "origin": kind.origin,
        "about": kind.about,
        "inputs": kind.inputs.iter().map(port).collect::<Vec<_>>(),
        "outputs": kind.outputs.iter().map(port).collect::<Vec<_>>(),
        "params": kind.params.iter().map(|param| param_json(registry, param)).collect::<Vec<_>>(),
    })
}

/// The parameters that a node has in addition, by the entry that brings them.
fn entries_json(registry: &Registry, catalog: &str) -> Json {
    let params = |entry: &CatalogEntry| {
        entry.params.iter().map(|param| param_json(registry, param)).collect::<Vec<_>>()
    };
    let entries = registry.catalogs().entries(catalog).iter();
    entries.map(|entry| (entry.name.clone(), json!(params(entry)))).collect::<Map<_, _>>().into()
}

fn param_json(registry: &Registry, param: &ParamSpec) -> Json {
    let mut json = match &param.kind {
        ParamKind::Number { dimension, min, max } => {
            json!({"type": "number", "unit": dimension.base_unit(), "min": min, "max": max})
        }
        ParamKind::Integer { dimension, min, max, odd } => {
            let unit = dimension.base_unit();
            json!({"type": "integer", "unit": unit, "min": min, "max": max, "odd": odd})
        }
        ParamKind::Switch => json!({"type": "switch"}),
        ParamKind::Text => json!({"type": "text"}),
        ParamKind::Choice(options) => json!({"type": "choice", "options": options}),
        ParamKind::Catalog { catalog, takes_params: false } => {
            json!({"type": "name", "catalog": catalog})
        }
        ParamKind::Catalog { catalog, takes_params: true } => {
            let entries = entries_json(registry, catalog);
            json!({"type": "name", "catalog": catalog, "entry_params": entries})
        }
        ParamKind::InputFile { optional } => json!({"type": "input_file", "optional": optional}),
        ParamKind::OutputName => json!({"type": "output_name"}),
    };
    json["name"] = json!(param.name);
    json["about"] = json!(param.about);
    json["default"] = match &param.default {
        None => Json::Null,
        Some(ParamValue::Number(number)) => json!(number),
        Some(ParamValue::Integer(number)) => json!(number),
        Some(ParamValue::Switch(on)) => json!(on),
        Some(other) => json!(other.to_string()),
    };
    json
}

/// The shapes of cutter and their dimensions.
pub(crate) fn cutters(registry: &Registry) -> String {
    let Some(Cutters(cutters)) = registry.catalogs().service() else { return String::new() };
    let mut text = String::new();
    for cutter in cutters {
        let _ = writeln!(text, "{}\n  {}", cutter.name(), cutter.about());
        let entry = registry.catalogs().entry("cutter", cutter.name());
        let params = entry.into_iter().flat_map(|entry| &entry.params);
        params.for_each(|param| text.push_str(&param_text(param)));
        text.push('\n');
    }
    text + "Set with --set cutter=NAME and --set tool.DIMENSION=VALUE.\n"
}

/// The dialects of G-code.
pub(crate) fn dialects(registry: &Registry) -> String {
    let Some(Dialects(dialects)) = registry.catalogs().service() else { return String::new() };
    let row = |dialect: &dyn carvegraph_nodes::Dialect| {
        let extension = format!(".{}", dialect.extension());
        vec![dialect.name().to_owned(), extension, dialect.about().to_owned()]
    };
    table(&dialects.iter().map(|dialect| row(dialect.as_ref())).collect::<Vec<_>>())
}

/// The machines.
pub(crate) fn machines(registry: &Registry) -> String {
    let machines = registry.catalogs().service::<Machines>();
    table(&machines.map(Machines::rows).unwrap_or_default())
}

/// The tools.
pub(crate) fn tools(registry: &Registry) -> String {
    match (registry.catalogs().service::<Tools>(), registry.catalogs().service::<Cutters>()) {
        (Some(tools), Some(cutters)) => table(&tools.rows(cutters)),
        _ => String::new(),
    }
}

fn built_in(name: &str) -> Result<Recipe, Refusal> {
    if !LIBRARY.recipes.iter().any(|(known, _)| *known == name) {
        return Err(unknown(
            "built-in recipe",
            name,
            LIBRARY.recipes.iter().map(|(name, _)| *name),
        ));
    }
    Ok(LIBRARY.open(name, &Origin::BuiltIn)?)
}

/// The built-in recipes.
pub(crate) fn graphs() -> Result<String, Refusal> {
    let row = |(name, _): &(&str, &str)| Ok(vec![(*name).to_owned(), built_in(name)?.title]);
    let rows = LIBRARY.recipes.iter().map(row).collect::<Result<Vec<_>, Refusal>>()?;
    Ok(table(&rows) + "\ncarve graphs NAME describes one.\n")
}

/// One built-in recipe: its text, or what can be set in it.
pub(crate) fn graph(registry: &Registry, name: &str, text: bool) -> Result<String, Refusal> {
    let recipe = built_in(name)?;
    if text {
        return Ok(recipe.source.text().to_owned());
    }
    let graph = Graph::build(&recipe, &[], registry, &LIBRARY)?;
    let value = |target: &str| {
        let (node, field) = target.split_once('.')?;
        let node = &graph.nodes[graph.find(node)?];
        let spec = graph.param(node, field)?;
        Some((node.values.find(field)?.to_string(), spec.kind.to_string()))
    };
    let row = |param: &carvegraph_core::recipe::Alias| {
        let target = param.targets.first().map(|target| target.text.as_str()).unwrap_or_default();
        let (now, kind) = value(target).unwrap_or_default();
        vec![format!("  {} = {now}", param.name.text), format!("{} ({kind})", param.about)]
    };
    let rows: Vec<_> = recipe.params.iter().map(row).collect();
    Ok(format!(
        "{}: {}\n\n{}\n\nSet with --set NAME=VALUE:\n{}",
        recipe.name,
        recipe.title,
        recipe.about,
        table(&rows)
    ))
}

/// What running a graph would do.
pub(crate) fn plan(
    graph: &Graph,
    only: &[String],
    out: &Path,
    cache: Option<&DiskCache>,
    explain: Option<&str>,
) -> Result<String, Refusal> {
    let cache = cache.map(|cache| cache as &dyn Cache);
    let plan = Plan::new(graph, only, out, cache, &CancelToken::default())?;
    if let Some(node) = explain {
        return Ok(plan.explain(node, cache)?.join("\n") + "\n");
    }
    let row = |at: usize| {
        let node = &graph.nodes[at];
        let doing = match &plan.steps[at] {
            Some(Step::Run) => "runs".to_owned(),
            Some(Step::Load { .. }) => "is read from the cache".to_owned(),
            Some(Step::Keep(_)) => "is cached".to_owned(),
            Some(Step::Rest(why)) => format!("rests: {why}"),
            None => String::new(),
        };
        let mut sources: Vec<&str> =
            node.inputs.iter().flatten().map(|wire| graph.nodes[wire.node].id.as_str()).collect();
        sources.sort_unstable();
        sources.dedup();
        vec![node.id.clone(), graph.kind(node).name.to_owned(), doing, sources.join(" ")]
    };
    let head = ["NODE", "KIND", "", "READS"].map(str::to_owned).to_vec();
    let rows: Vec<_> = std::iter::once(head).chain(plan.in_order().map(row)).collect();
    Ok(table(&rows))
}

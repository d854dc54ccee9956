//! What `carve` knows, as text: nodes, cutters, dialects, recipes, plans.

use crate::Refusal;
use carvegraph_core::diagnostic::did_you_mean;
use carvegraph_core::{
    Cache, CancelToken, DiskCache, Graph, NodeKind, Origin, ParamKind, ParamSpec, ParamValue, Plan,
    PortSpec, Recipe, Registry, Step,
};
use carvegraph_nodes::{Cutters, Dialects, LIBRARY};
use serde_json::{Value as Json, json};
use std::fmt::Write;
use std::path::Path;

/// Rows of text in columns; the last column is as wide as it wants to be.
fn table(rows: &[Vec<String>]) -> String {
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
    for param in &kind.params {
        let _ = writeln!(text, "  {}: {}, {}", param.name, param.kind, default_text(param));
        let _ = writeln!(text, "      {}", param.about);
        if let ParamKind::Choice(options) = &param.kind {
            for option in *options {
                let _ = writeln!(text, "      {}: {}", option.name, option.about);
            }
        }
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
        "about": kind.about,
        "inputs": kind.inputs.iter().map(port).collect::<Vec<_>>(),
        "outputs": kind.outputs.iter().map(port).collect::<Vec<_>>(),
        "params": kind.params.iter().map(param_json).collect::<Vec<_>>(),
    })
}

fn param_json(param: &ParamSpec) -> Json {
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
        ParamKind::Catalog(catalog) => json!({"type": "name", "catalog": catalog}),
        ParamKind::InputFile => json!({"type": "input_file"}),
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

/// The shapes of cutter.
pub(crate) fn cutters(registry: &Registry) -> String {
    let Some(Cutters(cutters)) = registry.catalogs().service() else { return String::new() };
    let row = |cutter: &dyn carvegraph_nodes::CutterShape| {
        let dimensions: Vec<String> = cutter
            .dimensions()
            .iter()
            .map(|spec| format!("{} ({})", spec.name, spec.unit.symbol()))
            .collect();
        vec![cutter.name().to_owned(), dimensions.join(", "), cutter.about().to_owned()]
    };
    table(&cutters.iter().map(|cutter| row(cutter.as_ref())).collect::<Vec<_>>())
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
        let spec = graph.kind(node).param(field)?;
        Some((node.values.get(field).to_string(), spec.kind.to_string()))
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

//! All that stands on a run's page, ready for the template.

use super::Run;
use super::embed::{Embedded, Picture, Text};
use super::glance::{Line, Verdict, glance, verdicts};
use super::words::{clean, fact, size, time};
use carvegraph_core::Weight;
use carvegraph_core::report::{NodeReport, NodeStatus, RunStatus};
use serde::Serialize;
use std::path::Path;

/// A run's page.
#[derive(Serialize)]
pub(super) struct Page {
    title: String,
    /// What the files are called after.
    prefix: String,
    about: String,
    recipe: String,
    failed: bool,
    failures: Vec<Failure>,
    starved: Vec<String>,
    trouble: Option<String>,
    verdicts: Vec<Verdict>,
    glance: Vec<Line>,
    cover: Option<Picture>,
    pictures: Vec<Picture>,
    texts: Vec<Text>,
    notes: Vec<Said>,
    nodes: Vec<Row>,
    source: String,
    settings: Vec<(String, String)>,
    parameters: Vec<Parameter>,
    parameter_count: usize,
    read: Vec<FileRow>,
    written: Vec<FileRow>,
    run: Vec<Line>,
}

/// Why a node failed.
#[derive(Serialize)]
struct Failure {
    node: String,
    kind: String,
    place: String,
    reason: String,
}

/// What a node had to say.
#[derive(Serialize)]
struct Said {
    is_warning: bool,
    node: String,
    text: String,
}

/// What became of a node.
#[derive(Serialize)]
struct Row {
    id: String,
    kind: String,
    status: &'static str,
    time: String,
    why: String,
    outputs: Vec<(String, Vec<(String, String)>)>,
}

/// A parameter as it was in force.
#[derive(Serialize)]
struct Parameter {
    name: String,
    value: String,
    is_set: bool,
}

/// A file.
#[derive(Serialize)]
struct FileRow {
    name: String,
    node: String,
    size: String,
    blake3: String,
}

impl Page {
    pub(super) fn of(run: &Run<'_>) -> Self {
        let (recipe, report) = (run.recipe, run.report);
        let mut embedded = embedded(run);
        let cover = cover(&embedded.pictures, &run.graph.prefix());
        let cover = cover.map(|at| embedded.pictures.remove(at));
        let starved = in_order(run).filter(|(_, node)| node.starved).map(|(id, _)| clean(id));
        let parameters = parameters(run);
        let setting = |(name, value): &(String, String)| (clean(name), clean(value));
        Self {
            title: clean(if recipe.title.is_empty() { &recipe.name } else { &recipe.title }),
            prefix: clean(&run.graph.prefix()),
            about: clean(&recipe.about),
            recipe: clean(&recipe.name),
            failed: report.status != RunStatus::Done,
            failures: failures(run),
            starved: starved.collect(),
            trouble: report.trouble.as_deref().map(clean),
            verdicts: verdicts(run),
            glance: glance(run),
            cover,
            pictures: embedded.pictures,
            texts: embedded.texts,
            notes: notes(run),
            nodes: in_order(run).map(|(id, node)| row(id, node)).collect(),
            source: clean(recipe.source.text()),
            settings: run.settings.iter().map(setting).collect(),
            parameter_count: parameters.len(),
            parameters,
            read: read(run),
            written: written(run),
            run: about_run(run),
        }
    }
}

/// The nodes in the recipe's order.
fn in_order<'a>(run: &'a Run<'_>) -> impl Iterator<Item = (&'a String, &'a NodeReport)> {
    let nodes = run.graph.nodes.iter();
    nodes.filter_map(|node| run.report.nodes.get(&node.id).map(|report| (&node.id, report)))
}

/// What the run wrote, as far as a page can show it.
fn embedded(run: &Run<'_>) -> Embedded {
    let mut embedded = Embedded::default();
    for (path, (_, file)) in run.report.files.iter().zip(&run.report.written) {
        embedded.take(Path::new(path), &file.name, file.bytes);
    }
    embedded
}

/// The picture that shows the part: as it is carved, else the one that is called like it, else the first.
fn cover(pictures: &[Picture], prefix: &str) -> Option<usize> {
    let called = |suffix: &str| {
        let stem = format!("{prefix}{suffix}.");
        pictures.iter().position(|picture| picture.name.starts_with(&stem))
    };
    called("-carved").or_else(|| called("")).or((!pictures.is_empty()).then_some(0))
}

fn failures(run: &Run<'_>) -> Vec<Failure> {
    let failed = in_order(run).filter(|(_, node)| node.status == NodeStatus::Failed);
    let failure = |(id, node): (&String, &NodeReport)| Failure {
        node: clean(id),
        kind: node.kind.to_owned(),
        place: node.place.as_ref().map(|place| clean(&place.to_string())).unwrap_or_default(),
        reason: clean(node.reason.as_deref().unwrap_or_default()),
    };
    failed.map(failure).collect()
}

/// Warnings first.
fn notes(run: &Run<'_>) -> Vec<Said> {
    let said = in_order(run).flat_map(|(id, node)| {
        node.notes.iter().map(move |note| Said {
            is_warning: note.weight == Weight::Warning,
            node: clean(id),
            text: clean(&note.text),
        })
    });
    let mut said: Vec<_> = said.collect();
    said.sort_by_key(|said| !said.is_warning);
    said
}

fn row(id: &str, node: &NodeReport) -> Row {
    let status = match node.status {
        NodeStatus::Ran => "ran",
        NodeStatus::Cached => "cached",
        NodeStatus::Failed => "failed",
        NodeStatus::Skipped => "skipped",
    };
    let outputs = node.outputs.iter().map(|(port, output)| {
        let facts = output.facts.iter().map(|(name, value)| fact(name, value));
        (format!("{port} ({})", output.type_name), facts.collect())
    });
    Row {
        id: clean(id),
        kind: node.kind.to_owned(),
        status,
        time: if node.status == NodeStatus::Ran { time(node.wall_s) } else { String::new() },
        why: clean(node.reason.as_deref().unwrap_or_default()),
        outputs: outputs.collect(),
    }
}

fn parameters(run: &Run<'_>) -> Vec<Parameter> {
    let all = run.graph.nodes.iter().flat_map(|node| {
        node.values.iter().map(move |(name, value)| Parameter {
            name: clean(&format!("{}.{name}", node.id)),
            value: clean(&value.to_string()),
            is_set: node.values.is_set(name),
        })
    });
    all.collect()
}

fn read(run: &Run<'_>) -> Vec<FileRow> {
    let row = |file: &carvegraph_core::ReadFile| FileRow {
        name: clean(&file.path),
        node: String::new(),
        size: size(file.bytes),
        blake3: file.blake3.clone(),
    };
    run.report.read.iter().map(row).collect()
}

fn written(run: &Run<'_>) -> Vec<FileRow> {
    let row = |(node, file): &(String, carvegraph_core::WrittenFile)| FileRow {
        name: clean(&file.name),
        node: clean(node),
        size: size(file.bytes),
        blake3: file.blake3.clone(),
    };
    run.report.written.iter().map(row).collect()
}

/// How it was run.
fn about_run(run: &Run<'_>) -> Vec<Line> {
    let report = run.report;
    let memory = report.peak_rss_mb.map(|megabytes| ("Most memory", format!("{megabytes:.0} MB")));
    let lines = [
        ("Program", concat!("carve ", env!("CARGO_PKG_VERSION")).to_owned()),
        ("Threads", report.threads.to_string()),
        ("Took", time(report.wall_s)),
    ];
    lines.into_iter().chain(memory).collect()
}

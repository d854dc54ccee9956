//! What a run leaves behind to be read: a page for people beside its files, and JSON for scripts.
//!
//! The page is one HTML file that needs nothing else: pictures stand in it as data, there are no scripts,
//! and a policy in its head forbids a browser to load or run anything, whatever names and notes say. It is
//! a template of minijinja (`report.html`), which escapes every value that comes into it: the crate is linked
//! for dialects anyway, nothing can be forgotten as in a page put together by hand, and what it looks like
//! is read where it is written. A page tells how long things took, so no two are equal; it holds no date.
//!
//! A run that wrote nothing has no page, be it refused, interrupted or failed before its first file: it is
//! to leave nothing behind.

mod embed;
mod glance;
mod page;
mod words;

use crate::Refusal;
use carvegraph_core::report::RunReport;
use carvegraph_core::{Graph, Recipe};
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, UndefinedBehavior, Value};
use page::Page;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// All that is known of a run.
pub(crate) struct Run<'a> {
    pub(crate) recipe: &'a Recipe,
    pub(crate) graph: &'a Graph,
    /// What was set from outside.
    pub(crate) settings: &'a [(String, String)],
    pub(crate) report: &'a RunReport,
    /// The output folder.
    pub(crate) out: &'a Path,
}

/// Writes the page; answers where. A name that an output or the file `taken` has is left to it.
pub(crate) fn write_page(run: &Run<'_>, taken: Option<&Path>) -> Result<PathBuf, String> {
    let prefix = run.graph.prefix();
    let names = [format!("{prefix}.html"), format!("{prefix}-report.html")];
    let free = names.into_iter().find(|name| is_free(name, run, taken));
    let name = free
        .ok_or_else(|| format!("cannot write {prefix}.html: files of this run have that name"))?;
    let path = run.out.join(name);
    let fail = |fault: String| format!("cannot write {}: {fault}", path.display());
    let text = render(&Page::of(run)).map_err(|fault| fail(format!("{fault:#}")))?;
    write_whole(&path, text.as_bytes()).map_err(|fault| fail(fault.to_string()))?;
    Ok(path)
}

/// Whether no file that the run wrote or read is called so; names that differ in case only are one file on
/// Windows and macOS.
fn is_free(name: &str, run: &Run<'_>, taken: Option<&Path>) -> bool {
    let place = run.out.join(name);
    let here = place.canonicalize().ok();
    let is_here = |path: &Path| here.is_some() && path.canonicalize().ok() == here;
    let is_output = |known: &str| known.to_lowercase() == name.to_lowercase();
    !run.report.written.iter().any(|(_, file)| is_output(&file.name))
        && !run.report.read.iter().any(|file| is_here(Path::new(&file.path)))
        && !is_here(Path::new(run.recipe.source.name()))
        && !taken.is_some_and(|taken| taken == place || is_here(taken))
}

fn render(page: &Page) -> Result<String, minijinja::Error> {
    let mut engine = Environment::empty();
    engine.set_undefined_behavior(UndefinedBehavior::Strict);
    engine.set_auto_escape_callback(|_| AutoEscape::Html);
    engine.template_from_str(include_str!("report.html"))?.render(Value::from(Serde(page)))
}

/// Writes the report for scripts.
pub(crate) fn write_json(report: &RunReport, path: &Path) -> Result<(), Refusal> {
    let fail = |fault: &dyn std::fmt::Display| {
        Refusal(format!("error: cannot write the report {}: {fault}", path.display()))
    };
    let mut text = serde_json::to_vec_pretty(report).map_err(|fault| fail(&fault))?;
    text.push(b'\n');
    write_whole(path, &text).map_err(|fault| fail(&fault))
}

/// A report is written whole or not at all, like any other file.
fn write_whole(path: &Path, text: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let mut aside = path.as_os_str().to_owned();
    aside.push(".part");
    let written = fs::write(&aside, text).and_then(|()| fs::rename(&aside, path));
    written.inspect_err(|_| {
        // There is nothing to remove where not even that could be written.
        let _ = fs::remove_file(&aside);
    })
}

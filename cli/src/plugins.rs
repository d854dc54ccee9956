//! `carve plugins`: what lies in the plugin folders, what is wrong with it, and putting something there.

use crate::list::table;
use crate::offers::{Brought, Sort, child};
use crate::{Refusal, complain};
use carvegraph_core::ron::read_file;
use carvegraph_host::{
    Discovered, MANIFEST, Manifest, Probed, discover, examine, probe, user_folder,
};
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The folders that are looked into: the user's, then those of the command line.
pub(crate) fn folders(given: &[PathBuf]) -> Result<Vec<PathBuf>, Refusal> {
    if let Some(missing) = given.iter().find(|folder| !folder.is_dir()) {
        return Err(Refusal(format!("error: --plugins: there is no folder {}", missing.display())));
    }
    Ok(user_folder().into_iter().chain(given.iter().cloned()).collect())
}

/// What the folders hold.
pub(crate) fn found(folders: &[PathBuf]) -> Discovered {
    discover(folders.iter().map(PathBuf::as_path))
}

/// The folder that something is put into: the first of the command line, else the user's.
pub(crate) fn folder_to_write(given: &[PathBuf]) -> Result<PathBuf, Refusal> {
    let folder = given.first().cloned().or_else(user_folder);
    folder.ok_or_else(|| {
        Refusal("error: this user has no home folder: name a folder with --plugins".to_owned())
    })
}

/// Begins a dialect like another one; answers where.
pub(crate) fn new_dialect(name: &str, from: &str, folder: &Path) -> Result<String, Refusal> {
    let text = carvegraph_dialects::starter(name, from)
        .map_err(|fault| Refusal(fault.render().trim_end().to_owned()))?;
    let path = folder.join(format!("{name}.ron"));
    let fail =
        |fault: io::Error| Refusal(format!("error: cannot write {}: {fault}", path.display()));
    fs::create_dir_all(folder).map_err(fail)?;
    // Never over what somebody has worked on.
    let mut file = File::create_new(&path).map_err(fail)?;
    file.write_all(text.as_bytes()).map_err(fail)?;
    Ok(format!("{}\n", path.display()))
}

/// What there is, without loading any of it.
pub(crate) fn list(found: &Discovered, folders: &[PathBuf]) -> String {
    let mut rows = Vec::new();
    for plugin in &found.plugins {
        let manifest = &plugin.manifest;
        let place = plugin.folder.display().to_string();
        rows.push(vec![manifest.id.clone(), manifest.version.clone(), offered(manifest), place]);
    }
    for file in &found.files {
        let sort = Sort::of(file).map_or("file of an unknown sort", Sort::word);
        let stem = Path::new(file.name()).file_stem().unwrap_or_default().to_string_lossy();
        rows.push(vec![stem.into_owned(), String::new(), sort.to_owned(), file.name().to_owned()]);
    }
    let mut text = table(&rows);
    if rows.is_empty() {
        text.push_str("no plugins\n");
    }
    let _ = writeln!(text, "\nLooked into:");
    for folder in folders {
        let missing = if folder.is_dir() { "" } else { " (not there yet)" };
        let _ = writeln!(text, "  {}{missing}", folder.display());
    }
    if !found.faults.is_empty() {
        let _ = writeln!(text, "\n{} cannot be used: carve plugins doctor", found.faults.len());
    }
    text
}

/// What a plugin offers, in a line.
fn offered(manifest: &Manifest) -> String {
    let sorts = manifest.offered.sorts();
    let sorts = sorts.iter().filter(|(_, names)| !names.is_empty());
    let sorts = sorts.map(|(sort, names)| format!("{sort} {}", names.join(", ")));
    sorts.collect::<Vec<_>>().join("; ")
}

/// What works and what does not, and why.
pub(crate) fn doctor(brought: &Brought, folders: &[PathBuf]) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "carve {}, plugin ABI {}.{}",
        env!("CARGO_PKG_VERSION"),
        carvegraph_host::ABI_MAJOR,
        carvegraph_host::ABI_MINOR
    );
    for folder in folders {
        let state = if folder.is_dir() { "" } else { ": not there, nothing is looked for" };
        let _ = writeln!(text, "folder {}{state}", folder.display());
    }
    for good in &brought.good {
        let _ = writeln!(text, "ok     {good}");
    }
    for fault in &brought.faults {
        let _ = writeln!(text, "FAULT  {}\n       {}", fault.path.display(), indented(&fault.why));
    }
    let _ = writeln!(text, "{} fine, {} at fault", brought.good.len(), brought.faults.len());
    text
}

fn indented(text: &str) -> String {
    without_error(text).trim_end().replace('\n', "\n       ")
}

/// What is wrong, to be said within a sentence: without the word that a diagnostic begins with.
pub(crate) fn without_error(why: &str) -> &str {
    why.strip_prefix("error: ").unwrap_or(why)
}

/// The child's part of trying a library.
pub(crate) fn examine_here(library: &Path) -> Result<String, Refusal> {
    let mut found = Vec::new();
    examine(library, &mut found).map_err(|fault| Refusal(format!("error: {fault}")))?;
    Ok(String::from_utf8_lossy(&found).into_owned())
}

/// Puts a library or a `.ron` file into a plugin folder; answers what was done.
pub(crate) fn install(from: &Path, id: Option<&str>, folder: &Path) -> Result<String, Refusal> {
    let refuse = |why: String| {
        let (file, why) = (from.display(), without_error(&why));
        Refusal(format!("error: {file} cannot be installed: {why}"))
    };
    if !from.is_file() {
        return Err(refuse("there is no such file".into()));
    }
    if from.extension().is_some_and(|extension| extension == "ron") {
        return install_file(from, folder).map_err(refuse);
    }
    let library = fs::canonicalize(from).map_err(|fault| refuse(fault.to_string()))?;
    let probed = child(&library).and_then(probe).map_err(refuse)?;
    let manifest = manifest(from, id, probed).map_err(refuse)?;
    let folder = folder.join(&manifest.id);
    copy(from, &folder.join(manifest.file_name())).map_err(refuse)?;
    let path = folder.join(MANIFEST);
    fs::write(&path, manifest.text())
        .map_err(|fault| refuse(format!("{}: {fault}", path.display())))?;
    Ok(format!(
        "{} {}: {}\n{}\n",
        manifest.id,
        manifest.version,
        offered(&manifest),
        folder.display()
    ))
}

/// Puts a `.ron` file into a plugin folder, if it is sound beside what lies there.
fn install_file(from: &Path, folder: &Path) -> Result<String, String> {
    let file = read_file(from, "such a file").map_err(|fault| fault.to_string())?;
    let sort = Sort::of(&file).map_or("file", Sort::word);
    let mut found = discover([folder]);
    let name = from.file_name().unwrap_or_default();
    found.files.retain(|other| Path::new(other.name()).file_name() != Some(name));
    found.files.push(Arc::clone(&file));
    let brought = Brought::load(found);
    if let Some(fault) = brought.faults.iter().find(|fault| fault.path == Path::new(file.name())) {
        return Err(fault.why.clone());
    }
    Ok(format!("{sort} {}", copy(from, &folder.join(name))?))
}

/// Copies under another name first: a library that is in use must not change under whoever uses it.
fn copy(from: &Path, to: &Path) -> Result<String, String> {
    let fail = |fault: io::Error| format!("{}: {fault}", to.display());
    fs::create_dir_all(to.parent().unwrap_or(to)).map_err(fail)?;
    let aside = to.with_extension("part");
    fs::copy(from, &aside).and_then(|_| fs::rename(&aside, to)).map_err(|fault| {
        let _ = fs::remove_file(&aside);
        fail(fault)
    })?;
    Ok(format!("{}\n", to.display()))
}

fn manifest(from: &Path, id: Option<&str>, probed: Probed) -> Result<Manifest, String> {
    let stem = from.file_stem().unwrap_or_default().to_string_lossy();
    let library = stem.strip_prefix(std::env::consts::DLL_PREFIX).unwrap_or(&stem).to_owned();
    let (said, version) = probed.about.unwrap_or_else(|| (library.clone(), "0".to_owned()));
    let id = id.map_or(said, str::to_owned);
    if probed.offered.sorts().iter().all(|(_, names)| names.is_empty()) {
        complain("warning: it offers nothing");
    }
    let manifest = Manifest { id, version, about: String::new(), library, offered: probed.offered };
    // What was written must be read again, whatever the library said of itself.
    manifest.checked()
}

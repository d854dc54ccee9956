//! What lies in the plugin folders.
//!
//! A folder with a manifest is a plugin; a `.ron` file is a dialect, a machine or a list of tools, by
//! the name before its first bracket. Nothing is loaded here.

use crate::manifest::{MANIFEST, Manifest};
use carvegraph_core::ron::read_file;
use carvegraph_core::source::Source;
use std::env::consts::DLL_SUFFIX;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A plugin that is there and not yet loaded.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Its folder.
    pub folder: PathBuf,
    /// What it says of itself.
    pub manifest: Manifest,
    /// Its library.
    pub library: PathBuf,
}

/// Something in a plugin folder that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What.
    pub path: PathBuf,
    /// Why not.
    pub why: String,
}

/// All that the plugin folders hold, in a fixed order: folder by folder as given, each by name.
#[derive(Clone, Debug, Default)]
pub struct Discovered {
    /// Plugins in libraries.
    pub plugins: Vec<Candidate>,
    /// Other `.ron` files: dialects, machines, tools.
    pub files: Vec<Arc<Source>>,
    /// What is wrong.
    pub faults: Vec<Fault>,
}

/// Looks into folders. One that does not exist holds nothing.
#[must_use]
pub fn discover<'f>(folders: impl IntoIterator<Item = &'f Path>) -> Discovered {
    let mut found = Discovered::default();
    let mut seen = Vec::new();
    for folder in folders {
        // The same folder may be named twice.
        let same = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
        if !seen.contains(&same) {
            found.folder(folder);
            seen.push(same);
        }
    }
    found
}

impl Discovered {
    fn folder(&mut self, folder: &Path) {
        if folder.join(MANIFEST).is_file() {
            return self.plugin(folder);
        }
        match entries(folder) {
            Ok(paths) => paths.iter().for_each(|path| self.entry(path)),
            Err(fault) if fault.kind() == io::ErrorKind::NotFound => {}
            Err(fault) => self.fault(folder, format!("the folder cannot be read: {fault}")),
        }
    }

    fn entry(&mut self, path: &Path) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with('.') {
            return;
        }
        if path.is_dir() {
            if path.join(MANIFEST).is_file() {
                self.plugin(path);
            } else {
                self.fault(path, format!("the folder has no {MANIFEST}, so nothing in it is used"));
            }
        } else if name.ends_with(".ron") {
            match read_file(path, "such a file") {
                Ok(source) => self.files.push(source),
                Err(fault) => self.fault(path, fault.to_string()),
            }
        } else if name.ends_with(DLL_SUFFIX) {
            let help = format!("a library needs a folder with a {MANIFEST}");
            self.fault(path, format!("{help}: carve plugins install {}", path.display()));
        }
    }

    fn plugin(&mut self, folder: &Path) {
        match candidate(folder) {
            Ok(candidate) => self.plugins.push(candidate),
            Err(why) => self.fault(folder, why),
        }
    }

    fn fault(&mut self, path: &Path, why: String) {
        self.faults.push(Fault { path: path.to_owned(), why });
    }
}

fn candidate(folder: &Path) -> Result<Candidate, String> {
    let source = read_file(&folder.join(MANIFEST), "a manifest").map_err(|f| f.to_string())?;
    let manifest = Manifest::read(&source).map_err(|faults| faults.to_string())?;
    let library = folder.join(manifest.file_name());
    if !library.is_file() {
        return Err(format!("its library {} is not there", library.display()));
    }
    // From here on it does not matter where the process is.
    let library = std::path::absolute(&library).map_err(|fault| fault.to_string())?;
    Ok(Candidate { folder: folder.to_owned(), manifest, library })
}

/// What a folder holds, sorted.
fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let paths = fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut paths = paths.collect::<io::Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_hold_plugins_and_files_in_order() {
        let home = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = home.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        write("mine.ron", "Dialect()");
        write("b/plugin.ron", "Plugin(format: 1, id: \"b\", version: \"1\", library: \"x\")");
        write(&format!("b/{}", library_name("x")), "");
        write("a/plugin.ron", "Plugin(format: 1, id: \"a\", version: \"1\", library: \"x\")");
        write("c/readme.txt", "");
        write(&library_name("stray"), "");
        write(".hidden.ron", "");
        let nowhere = home.path().join("nowhere");
        let found = discover([home.path(), &nowhere, home.path()]);
        let ids: Vec<_> = found.plugins.iter().map(|p| p.manifest.id.as_str()).collect();
        assert_eq!(ids, ["b"]);
        assert_eq!(found.files.len(), 1);
        let whys: Vec<_> = found.faults.iter().map(|fault| fault.why.as_str()).collect();
        assert!(whys[0].starts_with("its library") && whys[0].ends_with("is not there"));
        assert_eq!(whys[1], "the folder has no plugin.ron, so nothing in it is used");
        assert!(whys[2].contains("carve plugins install"));
        assert_eq!(whys.len(), 3);
    }

    #[test]
    fn a_plugins_own_folder_can_be_named() {
        let home = tempfile::tempdir().unwrap();
        let manifest = "Plugin(format: 1, id: \"a\", version: \"1\", library: \"x\")";
        fs::write(home.path().join(MANIFEST), manifest).unwrap();
        fs::write(home.path().join(library_name("x")), "").unwrap();
        assert_eq!(discover([home.path()]).plugins.len(), 1);
    }

    fn library_name(name: &str) -> String {
        format!("{}{name}{DLL_SUFFIX}", std::env::consts::DLL_PREFIX)
    }
}

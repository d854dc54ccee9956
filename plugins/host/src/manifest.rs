//! A plugin's manifest: what it is and offers, so that it can be listed without being loaded.
//!
//! ```ron
//! Plugin(
//!     format: 1,
//!     id: "acme-ogee",
//!     version: "1.0.0",
//!     about: "Ogee bits by Acme",
//!     library: "acme_ogee",
//!     cutters: ["ogee"],
//! )
//! ```

use carvegraph_core::Diagnostics;
use carvegraph_core::ron::{self, Form, Item};
use carvegraph_core::source::Source;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fmt::Write;
use std::sync::Arc;

/// The file that makes a folder a plugin's.
pub const MANIFEST: &str = "plugin.ron";

/// The version of the form, and the newest that is read.
const FORMAT: i64 = 1;

/// The names of what a plugin offers, sorted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Offered {
    /// Cutter shapes.
    pub cutters: Vec<String>,
    /// Dialects.
    pub dialects: Vec<String>,
    /// Kinds of node.
    pub nodes: Vec<String>,
}

impl Offered {
    /// Each sort with its names.
    pub fn sorts(&self) -> [(&'static str, &[String]); 3] {
        [("cutter", &self.cutters), ("dialect", &self.dialects), ("node", &self.nodes)]
    }

    pub(crate) fn sorted(mut self) -> Self {
        for names in [&mut self.cutters, &mut self.dialects, &mut self.nodes] {
            names.sort();
        }
        self
    }
}

/// What a plugin says of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Manifest {
    /// Its name.
    pub id: String,
    /// Its version.
    pub version: String,
    /// What it is, in a line.
    pub about: String,
    /// Its library's name without what the system puts before and behind it.
    pub library: String,
    /// What it offers.
    pub offered: Offered,
}

impl Manifest {
    /// Reads one.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn read(source: &Arc<Source>) -> Result<Self, Diagnostics> {
        let value = ron::parse(source)?;
        let form = Form::default();
        let manifest = manifest(form.item(&value, "the manifest"));
        form.finish(manifest)
    }

    /// Its text, to be read again.
    #[must_use]
    pub fn text(&self) -> String {
        let Self { id, version, about, library, offered } = self;
        let mut text = format!(
            "Plugin(\n    format: {FORMAT},\n    id: {id:?},\n    version: {version:?},\n    \
             about: {about:?},\n    library: {library:?},\n"
        );
        for (sort, names) in offered.sorts() {
            let _ = writeln!(text, "    {sort}s: {names:?},");
        }
        text + ")\n"
    }

    /// Itself, if its text would be read again.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn checked(self) -> Result<Self, String> {
        match Self::read(&Arc::new(Source::new(MANIFEST, self.text()))) {
            Ok(_) => Ok(self),
            Err(faults) => Err(faults.to_string()),
        }
    }

    /// The name of its library's file on this system.
    #[must_use]
    pub fn file_name(&self) -> String {
        format!("{DLL_PREFIX}{}{DLL_SUFFIX}", self.library)
    }
}

fn manifest(item: Item<'_>) -> Option<Manifest> {
    let mut fields = item.fields(Some("Plugin"))?;
    let format = fields.required("format").and_then(|item| item.integer(1..=FORMAT));
    let id = fields.required("id").and_then(plain_name);
    let version = fields.required("version").and_then(Item::text);
    let about = fields.optional("about").and_then(Item::text).unwrap_or_default();
    let library = fields.required("library").and_then(plain_name);
    let mut names = |field| match fields.optional(field) {
        Some(item) => Some(item.names()?.into_iter().map(|name| name.text).collect()),
        None => Some(Vec::new()),
    };
    let (cutters, dialects, nodes) = (names("cutters"), names("dialects"), names("nodes"));
    fields.no_more();
    format?;
    let offered = Offered { cutters: cutters?, dialects: dialects?, nodes: nodes? }.sorted();
    Some(Manifest { id: id?, version: version?, about, library: library?, offered })
}

/// Whether a text is a name that is no path.
pub(crate) fn is_plain_name(text: &str) -> bool {
    let fits = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '_' | '-' | '.');
    (1..=64).contains(&text.len()) && text.chars().all(fits) && !text.starts_with('.')
}

fn plain_name(item: Item<'_>) -> Option<String> {
    let text = item.clone().text()?;
    if is_plain_name(&text) {
        return Some(text);
    }
    item.fault(format!(
        "{text:?} is no plain name: letters, digits, _, - and . make one, 64 at most"
    ));
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Manifest, String> {
        let source = Arc::new(Source::new("plugin.ron", text));
        Manifest::read(&source).map_err(|faults| faults.to_string())
    }

    #[test]
    fn what_is_written_is_read_again() {
        let offered = Offered {
            cutters: vec!["cove".into(), "ogee".into()],
            nodes: vec!["terrace".into()],
            ..Offered::default()
        };
        let manifest = Manifest {
            id: "acme-ogee".into(),
            version: "1.0.0".into(),
            about: "Bits by \"Acme\"".into(),
            library: "acme_ogee".into(),
            offered,
        };
        assert_eq!(read(&manifest.text()), Ok(manifest));
    }

    #[test]
    fn a_library_is_a_plain_name_beside_the_manifest() {
        for path in ["../evil", "/usr/lib/libc", "a\\b", ".hidden", ""] {
            let text = format!("Plugin(format: 1, id: \"a\", version: \"1\", library: {path:?})");
            let faults = read(&text).unwrap_err();
            assert!(faults.contains("is no plain name"), "{faults}");
        }
    }

    #[test]
    fn what_is_missing_or_unknown_is_told_with_its_place() {
        let faults = read("Plugin(format: 1, id: \"a\",\n  libary: \"a\")").unwrap_err();
        assert!(faults.contains("the manifest lacks the field \"version\""), "{faults}");
        assert!(faults.contains("plugin.ron:2:3"), "{faults}");
        assert!(faults.contains("did you mean \"library\"?"), "{faults}");
        let newer = read("Plugin(format: 2, id: \"a\", version: \"1\", library: \"a\")");
        assert!(newer.unwrap_err().contains("format"));
    }
}

//! Where recipes come from: built into the program by bare name, or files.

use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::files::{Assets, Origin};
use crate::recipe::Recipe;
use crate::ron::{TextError, read_text};
use crate::source::Source;
use std::path::Path;

/// Recipes that are part of the program, by bare name, and the files that they read.
#[derive(Clone, Copy, Debug)]
pub struct Library {
    /// Name and text of each recipe, sorted by name.
    pub recipes: &'static [(&'static str, &'static str)],
    /// Path and contents of each file.
    pub assets: Assets,
}

impl Library {
    /// Opens a recipe: one of the built-in ones by bare name, else a file, its path starting at
    /// `origin`.
    ///
    /// # Errors
    /// If there is none, or it cannot be read.
    pub fn open(&self, reference: &str, origin: &Origin) -> Result<Recipe, Diagnostics> {
        if let Some((name, text)) = self.recipes.iter().find(|(name, _)| *name == reference) {
            let source = Source::new(format!("{name} (built in)"), *text);
            return Recipe::read(name, source, Origin::BuiltIn);
        }
        let fail = |message: String| Diagnostics(vec![Diagnostic::error(message)]);
        let Origin::Folder(folder) = origin else {
            return Err(fail(format!("there is no built-in recipe {reference:?}")));
        };
        let path = folder.join(reference);
        let text = read_text(&path, "a recipe").map_err(|fault| match fault {
            TextError::NotFound { .. } => self.not_found(reference),
            fault => fail(fault.to_string()),
        })?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        // Shown as the user would write it, not as it was put together.
        let shown = path.strip_prefix(".").unwrap_or(&path).display().to_string();
        Recipe::read(&name, Source::new(shown, text), Origin::Folder(folder))
    }

    fn not_found(&self, reference: &str) -> Diagnostics {
        let names = || self.recipes.iter().map(|(name, _)| *name);
        let message = format!("there is no recipe {reference:?}, built in or as a file");
        let built_in = names().collect::<Vec<_>>().join(", ");
        let help = match did_you_mean(reference, names()) {
            Some(near) => format!("did you mean {near:?}? Built in are {built_in}"),
            None => format!("built in are {built_in}"),
        };
        Diagnostics(vec![Diagnostic::error(message).help(help)])
    }
}

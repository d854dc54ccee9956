//! What a recipe may not say, since it is untrusted.

/// Why a recipe that names a library is refused: it could make the program run any code.
pub const NO_LIBRARY: &str =
    "a recipe cannot name a library: plugins are loaded only from the plugin folders and --plugins";

/// How the names of libraries, and of files that describe plugins, end.
const LIBRARY_ENDS: [&str; 7] = ["so", "dll", "dylib", "wasm", "exe", "ron", "toml"];

/// Whether a name that is to be one of a catalog or of a kind of node looks like a path or a
/// library.
pub(crate) fn looks_like_library(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    // Behind a library's ending may stand a version, as in libm.so.6.
    let mut ends = name.split('.').skip(1);
    name.contains(['/', '\\']) || ends.any(|end| LIBRARY_ENDS.contains(&end))
}

/// What to tell of a field that no recipe has, if it was to load a library.
pub(crate) fn about_field(name: &str) -> Option<&'static str> {
    let name = name.to_ascii_lowercase();
    let is_library = name.contains("plugin")
        || name.contains("librar")
        || matches!(name.as_str(), "load" | "loads" | "dll" | "dylib" | "dylibs" | "extensions");
    is_library.then_some(NO_LIBRARY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_and_libraries_are_told_from_names() {
        for name in ["a/b", "..\\b", "/x", "evil.so", "E.DLL", "libx.so.6", "x.dylib", "mine.ron"] {
            assert!(looks_like_library(name), "{name}");
        }
        for name in ["", "so", "bull_nose", "grbl.v1", "gcode", "a.sob"] {
            assert!(!looks_like_library(name), "{name}");
        }
    }

    #[test]
    fn fields_that_would_load_something_are_known() {
        for name in ["plugin", "plugins", "Plugin_path", "library", "libraries", "load"] {
            assert_eq!(about_field(name), Some(NO_LIBRARY), "{name}");
        }
        for name in ["nodez", "layout", "lod", "params"] {
            assert_eq!(about_field(name), None, "{name}");
        }
    }
}

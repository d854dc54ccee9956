//! Where plugins are looked for: the user's own folder, and those named on the command line. Never the
//! current folder and never a recipe's, which may have come from anywhere.

use std::env;
use std::path::PathBuf;

/// The user's plugin folder on this system; `None` where there is no home.
///
/// `$XDG_DATA_HOME` or `~/.local/share` on Linux, `~/Library/Application Support` on macOS, `%APPDATA%`
/// on Windows, and in it `carvegraph/plugins`.
#[must_use]
pub fn user_folder() -> Option<PathBuf> {
    Some(data_home()?.join("carvegraph").join("plugins"))
}

/// A folder that a variable names; a relative one would depend on the current folder.
fn absolute(variable: &str) -> Option<PathBuf> {
    env::var_os(variable).map(PathBuf::from).filter(|path| path.is_absolute())
}

#[cfg(windows)]
fn data_home() -> Option<PathBuf> {
    absolute("APPDATA")
}

#[cfg(target_os = "macos")]
fn data_home() -> Option<PathBuf> {
    Some(absolute("HOME")?.join("Library").join("Application Support"))
}

#[cfg(not(any(windows, target_os = "macos")))]
fn data_home() -> Option<PathBuf> {
    absolute("XDG_DATA_HOME").or_else(|| Some(absolute("HOME")?.join(".local").join("share")))
}

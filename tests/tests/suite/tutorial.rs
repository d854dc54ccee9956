//! The tutorial on plugins, followed to the letter by somebody new, outside of the workspace.
//!
//! Its commands and files become one script, in their order. What they build is kept between runs of this
//! test, since it takes a minute.

use crate::bench::{Bench, CARVE, skipped, workspace};
use std::ffi::OsString;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The tutorial as a script: a `sh` block is what it is, a file is written where a comment names it.
fn script(text: &str) -> String {
    let mut script = String::from("set -eu\n");
    let mut file: Option<&str> = None;
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(name) = line.strip_prefix("<!-- file: ") {
            file = name.strip_suffix(" -->");
        } else if let Some(language) = line.strip_prefix("```") {
            let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
            let block = block.join("\n");
            match (file.take(), language) {
                (Some(name), _) => {
                    let _ = writeln!(script, "cat > {name} <<'END_OF_FILE'\n{block}\nEND_OF_FILE");
                }
                (None, "sh") => {
                    let _ = writeln!(script, "set -x\n{block}\n{{ set +x; }} 2>/dev/null");
                }
                (None, _) => {}
            }
        }
    }
    script
}

/// A folder of the user's that cargo and rustup must find although the home is another one.
fn kept(variable: &str, in_home: &str) -> OsString {
    std::env::var_os(variable).unwrap_or_else(|| {
        let home = std::env::var_os("HOME").unwrap_or_default();
        Path::new(&home).join(in_home).into()
    })
}

/// `PATH` with a folder before it that holds the command under its name.
fn path(bench: &Bench) -> OsString {
    let bin = bench.path("bin");
    std::fs::create_dir(&bin).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(CARVE, bin.join("carve")).unwrap();
    let old = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(bin).chain(std::env::split_paths(&old));
    std::env::join_paths(folders.collect::<Vec<PathBuf>>()).unwrap()
}

#[test]
fn the_tutorial_works_as_it_is_written() {
    if cfg!(not(target_os = "linux")) {
        return skipped("the tutorial: its commands are for Linux");
    }
    let text = std::fs::read_to_string(workspace().join("docs/plugins.md")).unwrap();
    let bench = Bench::new();
    let output = Command::new("bash")
        .arg("-c")
        .arg(script(&text))
        .current_dir(bench.path(""))
        .env("CARVEGRAPH", workspace())
        .env("PATH", path(&bench))
        .env("HOME", bench.path("home"))
        .env("XDG_DATA_HOME", bench.path("home/share"))
        .env("CARGO_HOME", kept("CARGO_HOME", ".cargo"))
        .env("RUSTUP_HOME", kept("RUSTUP_HOME", ".rustup"))
        // Crates that the workspace was built of are there, and no others are needed.
        .env("CARGO_NET_OFFLINE", "true")
        .env("CARGO_BUILD_BUILD_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join("tutorial"))
        .env_remove("CARGO_TARGET_DIR")
        .env("CARGO_INCREMENTAL", "0")
        .env("CARGO_PROFILE_DEV_OPT_LEVEL", "1")
        .env("CARGO_PROFILE_DEV_DEBUG", "0")
        .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{told}\n{said}");
    for program in ["my-dialect/out/medallion.cnc", "my-rust-dialect/out/medallion.nc"] {
        assert!(bench.text(program).lines().count() > 1000, "{program}");
    }
    let in_c = bench.files("my-c-dialect/out");
    assert!(in_c.values().any(|program| program.len() > 10_000), "{:?}", in_c.keys());
    assert!(said.contains("+ carve plugins doctor"), "{said}");
    assert!(told.contains("5 fine, 0 at fault") || told.contains("6 fine, 0 at fault"), "{told}");
}

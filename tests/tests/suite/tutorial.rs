//! The tutorial on plugins and the examples' own instructions, followed to the letter by somebody new,
//! outside of the workspace.
//!
//! Commands and files become one script, in their order. What they build is kept between runs of these
//! tests, since it takes a minute.

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
    link(Path::new(CARVE), &bin.join("carve"));
    let old = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(bin).chain(std::env::split_paths(&old));
    std::env::join_paths(folders.collect::<Vec<PathBuf>>()).unwrap()
}

#[cfg(unix)]
fn link(to: &Path, from: &Path) {
    std::os::unix::fs::symlink(to, from).unwrap();
}

#[cfg(not(unix))]
fn link(_: &Path, _: &Path) {}

/// Does what a text says, in a folder of the bench; answers what was printed, and what was complained of.
fn follow(bench: &Bench, text: &str, folder: &str) -> (String, String) {
    let output = Command::new("bash")
        .arg("-c")
        .arg(script(text))
        .current_dir(bench.path(folder))
        .env("CARVEGRAPH", workspace())
        .env("PATH", path(bench))
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
    let [out, err] = [output.stdout, output.stderr].map(|said| String::from_utf8(said).unwrap());
    assert!(output.status.success(), "{out}\n{err}");
    (out, err)
}

fn text_of(path: &str) -> String {
    std::fs::read_to_string(workspace().join(path)).unwrap()
}

/// Whether the commands, which are for Linux, can be followed here.
fn can_follow() -> bool {
    if cfg!(target_os = "linux") {
        return true;
    }
    skipped("the tutorial and the examples: their commands are for Linux");
    false
}

#[test]
fn the_tutorial_works_as_it_is_written() {
    if !can_follow() {
        return;
    }
    let bench = Bench::outside();
    let (out, err) = follow(&bench, &text_of("docs/plugins.md"), "");
    for program in ["my-dialect/out/medallion.cnc", "my-rust-dialect/out/medallion.nc"] {
        assert!(bench.text(program).lines().count() > 1000, "{program}");
    }
    let in_c = bench.files("my-c-dialect/out");
    assert!(in_c.values().any(|program| program.len() > 10_000), "{:?}", in_c.keys());
    assert!(err.contains("+ carve plugins doctor"), "{err}");
    assert!(out.contains("6 fine, 0 at fault"), "{out}");
}

/// Copies an example to where its paths to the repository hold. Only the sdk's own must be spelled out:
/// it takes its versions from the workspace that it lies in.
fn lay_out(bench: &Bench, example: &str) -> String {
    let folder = format!("plugins/examples/{example}");
    std::fs::create_dir_all(bench.path(&folder)).unwrap();
    link(&workspace().join("plugins/abi"), &bench.path("plugins/abi"));
    link(&workspace().join("graphs"), &bench.path("graphs"));
    copy(&workspace().join(&folder), &bench.path(&folder));
    let manifest = format!("{folder}/Cargo.toml");
    if bench.path(&manifest).is_file() {
        let sdk = workspace().join("plugins/sdk");
        let text = bench.text(&manifest).replace("../../sdk", sdk.to_str().unwrap());
        bench.write(&manifest, text);
    }
    folder
}

/// Copies what belongs to a project: not what was built of it.
fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let (name, path) = (entry.file_name(), entry.path());
        if path.is_file() && name != "Cargo.lock" {
            std::fs::copy(&path, to.join(&name)).unwrap();
        } else if path.is_dir() && name != "target" && name != "out" {
            copy(&path, &to.join(&name));
        }
    }
}

#[test]
fn the_examples_work_as_they_say() {
    if !can_follow() {
        return;
    }
    for example in ["cutter-rust", "dialect-rust", "node-rust", "dialect-c", "dialect-ron"] {
        let bench = Bench::outside();
        let folder = lay_out(&bench, example);
        follow(&bench, &text_of(&format!("{folder}/README.md")), &folder);
        let made = bench.files(&format!("{folder}/out"));
        assert!(made.values().any(|file| file.len() > 10_000), "{example}: {:?}", made.keys());
    }
}

//! A folder to work in, pictures to carve, and the command to carve them with.

use carvegraph_nodes::{Batch, Offers};
use image::{GrayImage, ImageBuffer, Luma};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The command under test.
pub(crate) const CARVE: &str = env!("CARGO_BIN_EXE_carve-under-test");

/// Settings that make a small job of any picture: a part of some 30 mm, and thumbnails for previews.
pub(crate) const QUICK: [&str; 10] = [
    "--set",
    "canvas_width=30",
    "--set",
    "preview.size=64",
    "--set",
    "preview_path.size=64",
    "--set",
    "inspection/carved.size=64",
    "--set",
    "inspection/map.size=64",
];

/// A folder that the command is called in; gone when the test is over.
pub(crate) struct Bench {
    folder: TempDir,
}

/// What came of a call.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap() }
    }

    /// One that lies outside of the workspace, which cargo would take a project in it to belong to.
    pub(crate) fn outside() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|fault| panic!("{name}: {fault}"))
    }

    pub(crate) fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).unwrap()
    }

    /// Saves a gray picture of 8 bits.
    pub(crate) fn picture(
        &self,
        name: &str,
        (width, height): (u32, u32),
        gray: fn(u32, u32) -> u8,
    ) {
        let picture = GrayImage::from_fn(width, height, |x, y| Luma([gray(x, y)]));
        picture.save(self.path(name)).unwrap();
    }

    /// Saves hills: smooth, with slopes every way, no symmetry, 16 bits.
    pub(crate) fn hills(&self, name: &str, (width, height): (u32, u32)) {
        let place = |i: u32, of: u32| f64::from(i) / f64::from(of.max(2) - 1);
        let picture = ImageBuffer::from_fn(width, height, |i, j| {
            let (x, y) = (place(i, width), place(j, height));
            let level = 0.5
                + 0.2 * (9.0 * x + 2.0 * y).sin()
                + 0.2 * (7.0 * y - 3.0 * x).cos()
                + 0.08 * (23.0 * x * y).sin();
            Luma([(level.clamp(0.0, 1.0) * 65535.0) as u16])
        });
        picture.save(self.path(name)).unwrap();
    }

    /// The command, to be called in this folder.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(CARVE);
        command.args(arguments).current_dir(self.folder.path()).stdin(Stdio::null());
        // Neither the caller's terminal nor the caller's settings may show in what is printed.
        command.env_remove("RUST_BACKTRACE").env("COLUMNS", "100").env("NO_COLOR", "1");
        // Nor may the plugins of whoever runs the tests.
        for home in ["HOME", "XDG_DATA_HOME", "APPDATA"] {
            command.env(home, self.path("home"));
        }
        command
    }

    pub(crate) fn carve(&self, arguments: &[&str]) -> Answer {
        let output = self.command(arguments).output().unwrap();
        Answer {
            status: output.status.code().unwrap_or(-1),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Calls the command, which must end within a limit.
    pub(crate) fn carve_within(&self, limit: Duration, arguments: &[&str]) -> Answer {
        let mut command = self.command(arguments);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let started = Instant::now();
        while child.try_wait().unwrap().is_none() {
            if started.elapsed() > limit {
                child.kill().unwrap();
                child.wait().unwrap();
                panic!("{arguments:?} takes more than {limit:?}");
            }
            sleep(Duration::from_millis(5));
        }
        let output = child.wait_with_output().unwrap();
        Answer {
            status: output.status.code().unwrap_or(-1),
            out: String::new(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs a recipe, which must succeed, and returns its report.
    pub(crate) fn run(&self, arguments: &[&str]) -> Report {
        let arguments = [&["run"], arguments, &["--report", "report.json"]].concat();
        let answer = self.carve(&arguments);
        assert_eq!(answer.status, 0, "{arguments:?}: {}", answer.err);
        self.report()
    }

    /// The report of the last run.
    pub(crate) fn report(&self) -> Report {
        Report(serde_json::from_slice(&self.read("report.json")).unwrap())
    }

    /// Names and contents of the files in a folder, hidden ones too; none if it is not there. Pages about runs
    /// are left out: they stand beside all that follows and hold how long it took (see `report.rs`).
    pub(crate) fn files(&self, folder: &str) -> BTreeMap<String, Vec<u8>> {
        let Ok(entries) = std::fs::read_dir(self.path(folder)) else { return BTreeMap::new() };
        let entry = |path: PathBuf| {
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            (name, std::fs::read(path).unwrap_or_default())
        };
        let files = entries.map(|file| entry(file.unwrap().path()));
        files.filter(|(name, _)| !name.ends_with(".html")).collect()
    }

    /// The names of all that lies in the folder that the command is called in.
    pub(crate) fn names(&self) -> Vec<String> {
        self.files("").into_keys().collect()
    }
}

/// The report of a run.
#[derive(Debug)]
pub(crate) struct Report(pub(crate) Value);

impl Report {
    pub(crate) fn status(&self, node: &str) -> &str {
        self.node(node)["status"].as_str().unwrap()
    }

    pub(crate) fn node(&self, node: &str) -> &Value {
        let found = &self.0["nodes"][node];
        assert!(found.is_object(), "the report has no node {node}: {:#}", self.0);
        found
    }

    /// A fact of a node's output.
    pub(crate) fn fact(&self, node: &str, port: &str, fact: &str) -> &Value {
        let found = &self.node(node)["outputs"][port]["facts"][fact];
        assert!(!found.is_null(), "no fact {node}.{port}.{fact}: {:#}", self.node(node));
        found
    }

    pub(crate) fn count(&self, node: &str, port: &str, fact: &str) -> u64 {
        self.fact(node, port, fact).as_u64().unwrap()
    }

    pub(crate) fn number(&self, node: &str, port: &str, fact: &str) -> f64 {
        self.fact(node, port, fact).as_f64().unwrap()
    }

    /// Every node with a given status, sorted.
    pub(crate) fn nodes_that(&self, status: &str) -> Vec<&str> {
        let nodes = self.0["nodes"].as_object().unwrap();
        nodes.keys().filter(|id| self.status(id) == status).map(String::as_str).collect()
    }
}

/// The root of the workspace.
pub(crate) fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// A file of the data folder (`../shared/data`, or where `CARVE_DATA` says), if it is there.
pub(crate) fn data(name: &str) -> Option<String> {
    let folder = std::env::var_os("CARVE_DATA").map(PathBuf::from);
    let path = folder.unwrap_or_else(|| workspace().join("../shared/data")).join(name);
    if !path.is_file() {
        skipped(&format!("no {}, it was not carved (CARVE_DATA names its folder)", path.display()));
        return None;
    }
    Some(path.display().to_string())
}

/// A recipe with a cutter of a stated size in it.
pub(crate) fn with_diameter(recipe: &str, diameter: &str) -> String {
    let tool = "(kind: \"cutter\"";
    let set = format!("{tool}, set: {{ \"shape\": \"ball\", \"diameter\": {diameter} }}");
    recipe.replacen(tool, &set, 1)
}

/// The text of a built-in recipe.
pub(crate) fn recipe_text(name: &str) -> String {
    std::fs::read_to_string(workspace().join(format!("graphs/{name}.ron"))).unwrap()
}

/// Says that something was not tested, past the harness, which hides what a passing test prints.
pub(crate) fn skipped(what: &str) {
    let line = format!("SKIPPED: {what}\n");
    std::io::stderr().write_all(line.as_bytes()).unwrap();
}

/// The cutters and dialects that `carve` links, as a library's user would offer them.
pub(crate) fn standard_offers() -> Offers {
    let mut offers = Offers::default();
    let (cutters, dialects) = (carvegraph_cutters::standard(), carvegraph_dialects::standard());
    offers.add(Batch { cutters, dialects, ..Batch::default() }, "test").unwrap();
    offers
}

//! Nodes that do next to nothing, and a workshop to try them in.

use carvegraph_core::diagnostic::{Diagnostic, Diagnostics};
use carvegraph_core::source::Source;
use carvegraph_core::{
    Cache, CatalogEntry, Catalogs, Choice, Conflict, Context, Facts, Graph, InputFile, Inputs,
    Library, Node, NodeError, NodeKind, NodeStatus, Origin, OutputName, Outputs, Params, Plan,
    PortType, Recipe, Registry, RunOptions, RunReport, Session, Setting,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use tempfile::TempDir;

/// What the toy nodes share with the test that runs them.
#[derive(Default)]
pub(crate) struct Lab {
    /// Values of type [`Token`] alive now, and the most at one time.
    pub(crate) alive: AtomicUsize,
    pub(crate) most: AtomicUsize,
    /// Nodes of the kind `slow` that have begun.
    pub(crate) begun: AtomicUsize,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Number(pub(crate) f64);

#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Words(pub(crate) String);

/// A value that is counted.
#[derive(Serialize, Deserialize)]
pub(crate) struct Token {
    #[serde(skip)]
    lab: Option<Arc<Lab>>,
}

impl Token {
    fn new(lab: &Arc<Lab>) -> Self {
        let alive = lab.alive.fetch_add(1, Ordering::SeqCst) + 1;
        lab.most.fetch_max(alive, Ordering::SeqCst);
        Self { lab: Some(Arc::clone(lab)) }
    }
}

impl Drop for Token {
    fn drop(&mut self) {
        if let Some(lab) = &self.lab {
            lab.alive.fetch_sub(1, Ordering::SeqCst);
        }
    }
}

fn lab<'a>(cx: &'a Context<'_>) -> &'a Arc<Lab> {
    cx.service().expect("the toy registry has a lab")
}

#[derive(Outputs)]
struct OneNumber {
    /// The number.
    number: Number,
}

#[derive(Outputs)]
pub(crate) struct OneText {
    /// The text.
    pub(crate) text: Words,
}

#[derive(Outputs)]
struct OneToken {
    /// The token.
    token: Token,
}

#[derive(Inputs)]
pub(crate) struct FromNumber<'a> {
    /// Any number.
    number: &'a Number,
}

#[derive(Inputs)]
struct MaybeNumber<'a> {
    /// Any number.
    number: Option<&'a Number>,
}

#[derive(Inputs)]
struct Two<'a> {
    /// A number.
    a: &'a Number,
    /// Another number.
    b: Option<&'a Number>,
}

#[derive(Inputs)]
struct Tokens<'a> {
    /// A token.
    a: &'a Token,
    /// Another token.
    b: Option<&'a Token>,
}

#[derive(Inputs)]
struct FromText<'a> {
    /// Any text.
    text: &'a Words,
}

/// How a toy is spelt.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Style {
    /// In one go.
    OneWay,
    /// To and fro.
    ToAndFro,
    /// Not at all.
    None,
}

/// Gives a number.
#[derive(Params)]
struct Constant {
    /// The number.
    #[param(default = 1.0)]
    value: f64,
}

impl Node for Constant {
    const KIND: &'static str = "number";
    type Inputs<'a> = ();
    type Outputs = OneNumber;

    fn run(&self, (): (), _: &Context<'_>) -> Result<OneNumber, NodeError> {
        Ok(OneNumber { number: Number(self.value) })
    }
}

/// Adds numbers.
#[derive(Params)]
struct Add {}

impl Node for Add {
    const KIND: &'static str = "add";
    type Inputs<'a> = Two<'a>;
    type Outputs = OneNumber;

    fn run(&self, inputs: Two<'_>, cx: &Context<'_>) -> Result<OneNumber, NodeError> {
        if inputs.b.is_none() {
            cx.note("only one number");
        }
        Ok(OneNumber { number: Number(inputs.a.0 + inputs.b.map_or(0.0, |b| b.0)) })
    }
}

/// Gives the number on, unless it is off.
#[derive(Params)]
struct Gate {
    /// Whether it is open.
    #[param(default = true)]
    open: bool,
}

impl Node for Gate {
    const KIND: &'static str = "gate";
    type Inputs<'a> = FromNumber<'a>;
    type Outputs = OneNumber;

    fn idle(&self) -> Option<&'static str> {
        (!self.open).then_some("it is shut")
    }

    fn run(&self, inputs: FromNumber<'_>, _: &Context<'_>) -> Result<OneNumber, NodeError> {
        Ok(OneNumber { number: Number(inputs.number.0) })
    }
}

#[derive(Outputs)]
struct Parts {
    /// Half of it.
    low: Number,
    /// Twice as much.
    high: Number,
    /// What was split.
    text: Words,
}

/// Takes a number apart.
#[derive(Params)]
struct Split {}

impl Node for Split {
    const KIND: &'static str = "split";
    type Inputs<'a> = FromNumber<'a>;
    type Outputs = Parts;

    fn run(&self, inputs: FromNumber<'_>, _: &Context<'_>) -> Result<Parts, NodeError> {
        let number = inputs.number.0;
        let text = Words(number.to_string());
        Ok(Parts { low: Number(number / 2.0), high: Number(number * 2.0), text })
    }
}

/// Fails in one way or another.
#[derive(Params)]
struct Fail {
    /// Which one.
    #[param(default = "failed")]
    how: String,
}

impl Node for Fail {
    const KIND: &'static str = "fail";
    type Inputs<'a> = MaybeNumber<'a>;
    type Outputs = OneNumber;

    fn check(&self) -> Result<(), Conflict> {
        match self.how.as_str() {
            "conflict" => Err(Conflict { param: "how", message: "it cannot be so".to_owned() }),
            _ => Ok(()),
        }
    }

    fn run(&self, _: MaybeNumber<'_>, _: &Context<'_>) -> Result<OneNumber, NodeError> {
        match self.how.as_str() {
            "panic" => panic!("out of cheese"),
            "refused" => Err(NodeError::refused("how", "this is absurd")),
            _ => Err(NodeError::failed("as it should")),
        }
    }
}

/// Takes its time.
#[derive(Params)]
struct Slow {
    /// How much.
    #[param(unit = "ms", default = 20, range = 0..=60_000)]
    time: u32,
}

impl Node for Slow {
    const KIND: &'static str = "slow";
    type Inputs<'a> = MaybeNumber<'a>;
    type Outputs = OneNumber;

    fn run(&self, inputs: MaybeNumber<'_>, cx: &Context<'_>) -> Result<OneNumber, NodeError> {
        let _ = inputs.number;
        lab(cx).begun.fetch_add(1, Ordering::SeqCst);
        let ticker = cx.ticker(self.time as usize);
        for _ in 0..self.time {
            std::thread::sleep(Duration::from_millis(1));
            if !ticker.tick(1) {
                return Err(NodeError::Cancelled);
            }
        }
        Ok(OneNumber { number: Number(f64::from(self.time)) })
    }
}

/// Adds up many numbers on all threads.
#[derive(Params)]
struct Busy {
    /// How many.
    #[param(default = 2000)]
    count: u32,
}

impl Node for Busy {
    const KIND: &'static str = "busy";
    type Inputs<'a> = MaybeNumber<'a>;
    type Outputs = OneNumber;

    fn run(&self, _: MaybeNumber<'_>, _: &Context<'_>) -> Result<OneNumber, NodeError> {
        let blocks = (0..self.count / 100).into_par_iter();
        let sum: u32 = blocks.map(|_| (0..100_u32).into_par_iter().map(|_| 1).sum::<u32>()).sum();
        Ok(OneNumber { number: Number(f64::from(sum)) })
    }
}

/// Makes a token, or passes it on as a new one.
#[derive(Params)]
struct Mint {}

impl Node for Mint {
    const KIND: &'static str = "mint";
    type Inputs<'a> = ();
    type Outputs = OneToken;

    fn run(&self, (): (), cx: &Context<'_>) -> Result<OneToken, NodeError> {
        Ok(OneToken { token: Token::new(lab(cx)) })
    }
}

/// Makes a token of tokens.
#[derive(Params)]
struct Melt {}

impl Node for Melt {
    const KIND: &'static str = "melt";
    type Inputs<'a> = Tokens<'a>;
    type Outputs = OneToken;

    fn run(&self, inputs: Tokens<'_>, cx: &Context<'_>) -> Result<OneToken, NodeError> {
        let _ = (inputs.a, inputs.b);
        Ok(OneToken { token: Token::new(lab(cx)) })
    }
}

/// Reads a file.
#[derive(Params)]
struct Load {
    /// A file that goes before it.
    #[param(default = None)]
    head: Option<InputFile>,
    /// The file.
    path: InputFile,
}

impl Node for Load {
    const KIND: &'static str = "load";
    type Inputs<'a> = ();
    type Outputs = OneText;

    fn run(&self, (): (), cx: &Context<'_>) -> Result<OneText, NodeError> {
        let mut text = String::new();
        for file in self.head.iter().chain([&self.path]) {
            text += &String::from_utf8_lossy(&cx.read(file)?);
        }
        Ok(OneText { text: Words(text) })
    }
}

/// Puts the name of the input before a text.
#[derive(Params)]
struct Sign {}

impl Node for Sign {
    const KIND: &'static str = "sign";
    const USES_PREFIX: bool = true;
    type Inputs<'a> = FromText<'a>;
    type Outputs = OneText;

    fn run(&self, inputs: FromText<'_>, cx: &Context<'_>) -> Result<OneText, NodeError> {
        Ok(OneText { text: Words(format!("{}: {}", cx.prefix(), inputs.text.0)) })
    }
}

#[derive(Inputs)]
struct Saved<'a> {
    /// A number.
    number: Option<&'a Number>,
    /// A text.
    text: Option<&'a Words>,
}

/// Saves what it gets.
#[derive(Params)]
struct Save {
    /// The file's name.
    #[param(default = "{prefix}")]
    name: OutputName,
    /// Its extension.
    #[param(default = "txt")]
    extension: String,
    /// How it is written.
    #[param(default = Style::OneWay)]
    style: Style,
    /// How many bytes more are written.
    #[param(default = 0)]
    padding: u32,
    /// What goes wrong.
    #[param(default = "")]
    trouble: String,
}

impl Node for Save {
    const KIND: &'static str = "save";
    type Inputs<'a> = Saved<'a>;
    type Outputs = OneText;

    fn idle(&self) -> Option<&'static str> {
        (self.style == Style::None).then_some("style is none")
    }

    fn run(&self, inputs: Saved<'_>, cx: &Context<'_>) -> Result<OneText, NodeError> {
        let text = match (inputs.number, inputs.text) {
            (Some(number), _) => number.0.to_string(),
            (None, Some(text)) => text.0.clone(),
            (None, None) => String::new(),
        };
        let mut file = cx.create(&self.name, &self.extension)?;
        file.write_all(text.as_bytes()).map_err(|fault| file.error(fault))?;
        let line = [b'x'; 1000];
        for _ in 0..self.padding / 1000 {
            file.write_all(&line).map_err(|fault| file.error(fault))?;
        }
        match self.trouble.as_str() {
            "half" => return Err(NodeError::failed("half-way")),
            "panic" => panic!("half-way"),
            _ => {}
        }
        let written = file.finish()?;
        if self.trouble == "late" {
            return Err(NodeError::failed("too late"));
        }
        Ok(OneText { text: Words(written.name) })
    }
}

/// Has a parameter of every kind.
#[derive(Params)]
struct Tool {
    /// How wide.
    #[param(unit = "mm", default = 6.0, range = 0.1..=50.0)]
    diameter: f64,
    /// How fast.
    #[param(unit = "mm/min", default = 600.0, range = f64::MIN_POSITIVE..=20_000.0)]
    feed: f64,
    /// How many pixels.
    #[param(unit = "px", default = 5, range = 1..=255, odd)]
    kernel: u32,
    /// On or off.
    #[param(default = false)]
    on: bool,
    /// What it is called.
    #[param(default = "tool")]
    title: String,
    /// How it goes.
    #[param(default = Style::ToAndFro)]
    style: Style,
    /// What it speaks.
    #[param(default = "grbl", catalog = "dialect")]
    dialect: String,
}

impl Node for Tool {
    const KIND: &'static str = "tool";
    type Inputs<'a> = ();
    type Outputs = OneText;

    fn run(&self, (): (), _: &Context<'_>) -> Result<OneText, NodeError> {
        let Self { diameter, feed, kernel, on, title, style, dialect } = self;
        let text = format!("{diameter} {feed} {kernel} {on} {title} {style:?} {dialect}");
        Ok(OneText { text: Words(text) })
    }
}

/// The kinds of all toys, sorted.
pub(crate) fn kinds() -> Vec<NodeKind> {
    vec![
        NodeKind::of::<Add>("toys"),
        NodeKind::of::<Busy>("toys"),
        NodeKind::of::<Fail>("toys"),
        NodeKind::of::<Gate>("toys"),
        NodeKind::of::<Load>("toys"),
        NodeKind::of::<Melt>("toys"),
        NodeKind::of::<Mint>("toys"),
        NodeKind::of::<Constant>("toys"),
        NodeKind::of::<Save>("toys"),
        NodeKind::of::<Sign>("toys"),
        NodeKind::of::<Slow>("toys"),
        NodeKind::of::<Split>("toys"),
        NodeKind::of::<Tool>("toys"),
    ]
}

fn no_facts<T>(_: &T) -> Facts {
    Facts::new()
}

pub(crate) fn types() -> Vec<PortType> {
    let facts = |number: &Number| Facts::from([("value", number.0.into())]);
    vec![
        PortType::of("number", "A number", facts, |_: &Number| 8),
        PortType::of("token", "A token", no_facts, |_: &Token| 8),
        PortType::of("words", "A text", no_facts, |words: &Words| words.0.len()),
    ]
}

pub(crate) fn catalogs(lab: &Arc<Lab>, grbl: &str) -> Catalogs {
    let entries = [CatalogEntry::new("fanuc", "1"), CatalogEntry::new("grbl", grbl)];
    Catalogs::default().with("dialect", entries, Arc::clone(lab))
}

/// Recipes that are part of the program, and their files.
pub(crate) const LIBRARY: Library = Library {
    recipes: &[(
        "built_in",
        r#"(format: 1, nodes: {"load": (kind: "load", set: {"path": "a.txt"})}, outputs: ["load"])"#,
    )],
    assets: &[("a.txt", b"part of the program")],
};

/// A folder, a registry, and what is done with them.
pub(crate) struct Shop {
    pub(crate) lab: Arc<Lab>,
    pub(crate) registry: Registry,
    folder: TempDir,
    pub(crate) threads: usize,
}

impl Shop {
    pub(crate) fn new() -> Self {
        let lab = Arc::new(Lab::default());
        let registry = Registry::new(kinds(), types(), catalogs(&lab, "1")).unwrap();
        Self { lab, registry, folder: TempDir::new().unwrap(), threads: 2 }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn out(&self) -> PathBuf {
        self.path("out")
    }

    pub(crate) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, contents).unwrap();
    }

    /// The contents of an output file.
    pub(crate) fn read(&self, name: &str) -> Option<String> {
        fs::read_to_string(self.out().join(name)).ok()
    }

    /// The names of all output files, temporary ones included; `None` without a folder.
    pub(crate) fn outputs(&self) -> Option<Vec<String>> {
        let files = fs::read_dir(self.out()).ok()?;
        let mut names: Vec<String> =
            files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        Some(names)
    }

    pub(crate) fn open(&self, text: &str) -> Result<Recipe, Diagnostics> {
        let origin = Origin::Folder(self.folder.path().to_owned());
        Recipe::read("toy", Source::new("toy.ron", text), origin)
    }

    pub(crate) fn graph_with(&self, text: &str, set: &[&str]) -> Result<Graph, Diagnostics> {
        let setting = |set: &&str| {
            let (name, value) = set.split_once('=').unwrap();
            let origin = Origin::Folder(self.path("current"));
            Setting { name: name.to_owned(), value: value.to_owned(), origin }
        };
        let settings: Vec<Setting> = set.iter().map(setting).collect();
        Graph::build(&self.open(text)?, &settings, &self.registry, &LIBRARY)
    }

    #[track_caller]
    pub(crate) fn graph(&self, text: &str) -> Graph {
        self.graph_with(text, &[]).unwrap_or_else(|faults| panic!("{faults}"))
    }

    pub(crate) fn run_plan(&self, plan: &Plan<'_>, cache: Option<&dyn Cache>) -> RunReport {
        let session = Session::new(&self.out());
        let options = RunOptions { threads: self.threads, cache, observer: &() };
        carvegraph_core::run(plan, &session, options)
    }

    #[track_caller]
    pub(crate) fn run_cached(&self, text: &str, cache: Option<&dyn Cache>) -> RunReport {
        let graph = self.graph(text);
        let plan = Plan::new(&graph, &[], &self.out(), cache, &Default::default()).unwrap();
        self.run_plan(&plan, cache)
    }

    #[track_caller]
    pub(crate) fn run(&self, text: &str) -> RunReport {
        self.run_cached(text, None)
    }
}

/// A recipe; its nodes begin on line 2.
pub(crate) fn recipe(nodes: &str, outputs: &str) -> String {
    format!("(format: 1, nodes: {{\n{nodes}\n}}, outputs: [{outputs}])")
}

/// Each fault as `line:column message; help`, without the file's name if that is `toy.ron`.
pub(crate) fn lines(faults: &Diagnostics) -> Vec<String> {
    let line = |fault: &&Diagnostic| {
        let place = fault.span.as_ref().map(ToString::to_string).unwrap_or_default();
        let help = fault.help.as_ref().map(|help| format!("; {help}")).unwrap_or_default();
        format!("{} {}{help}", place.trim_start_matches("toy.ron:"), fault.message)
    };
    faults.sorted().iter().map(line).collect()
}

/// The status and the reason of each node: "a ran, b failed: as it should".
pub(crate) fn told(report: &RunReport) -> String {
    let node = |(id, node): (&String, &carvegraph_core::NodeReport)| {
        let status = match node.status {
            NodeStatus::Ran => "ran",
            NodeStatus::Cached => "cached",
            NodeStatus::Failed => "failed",
            NodeStatus::Skipped => "skipped",
        };
        let reason = node.reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default();
        format!("{id} {status}{reason}")
    };
    report.nodes.iter().map(node).collect::<Vec<_>>().join(", ")
}

/// The value of a number that a node made.
pub(crate) fn value(report: &RunReport, node: &str) -> f64 {
    report.nodes[node].outputs["number"].facts["value"].as_f64().unwrap()
}

/// The names of the files that a run reports.
pub(crate) fn files(report: &RunReport) -> Vec<&str> {
    let name = |path| Path::new(path).file_name().and_then(|name| name.to_str()).unwrap();
    report.files.iter().map(|path| name(path.as_str())).collect()
}

//! Recipes use nodes of plugins like any others.

use super::super::crossing::CROSSINGS;
use super::*;
use crate::assemble::registry;
use crate::offers::{Batch, Offers};
use carvegraph_core::source::Source;
use carvegraph_core::{
    Graph, Library, NodeReport, Observer, Origin, Plan, Recipe, Registry, RunOptions, RunReport,
    RunStatus, Session,
};
use carvegraph_geometry::Profile;
use carvegraph_sdk::value as seen;
use carvegraph_sdk::value::PortValue;
use carvegraph_sdk::{
    Capabilities, CutterError, CutterShape, Dialect, DimensionSpec, Dimensions, PostError, Program,
};

/// The least that the registry's defaults ask for.
struct Ball;

impl CutterShape for Ball {
    fn name(&self) -> &str {
        "ball"
    }

    fn about(&self) -> &str {
        "A ball nose"
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        &[DimensionSpec::DIAMETER]
    }

    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        Ok(Profile::ball(dimensions.get("diameter")? / 2.0)?)
    }
}

/// Likewise.
struct Grbl;

impl Dialect for Grbl {
    fn name(&self) -> &str {
        "grbl"
    }

    fn about(&self) -> &str {
        "Nothing"
    }

    fn extension(&self) -> &str {
        "nc"
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { arcs: false, tool_change: false, path_tolerance: false }
    }

    fn post(&self, _: &Program<'_>, _: &mut dyn std::io::Write) -> Result<(), PostError> {
        Ok(())
    }
}

fn shop(extra: Vec<NodeKind>) -> Registry {
    let batch =
        Batch { cutters: vec![Box::new(Ball)], dialects: vec![Box::new(Grbl)], ..Batch::default() };
    let mut offers = Offers::default();
    offers.nodes = extra;
    offers.add(batch, "test").unwrap();
    registry(offers).unwrap()
}

/// Runs a recipe of these nodes, whose wanted outputs are `outputs`.
fn carve(registry: &Registry, nodes: &str, outputs: &str, cancelling: bool) -> RunReport {
    let text = format!("(format: 1, nodes: {{{nodes}}}, outputs: [{outputs}])");
    let folder = std::env::temp_dir();
    let origin = Origin::Folder(folder.clone());
    let recipe = Recipe::read("toy", Source::new("toy.ron", &text), origin).unwrap();
    let library = Library { recipes: &[], assets: &[] };
    let graph = Graph::build(&recipe, &[], registry, &library).unwrap();
    let plan = Plan::new(&graph, &[], &folder, None, &Default::default()).unwrap();
    let session = Session::new(&folder);
    let observer = Caller(cancelling.then(|| session.clone()));
    let options = RunOptions { threads: 2, cache: None, observer: &observer };
    carvegraph_core::run(&plan, &session, options)
}

/// Calls the run off when a node tells progress.
struct Caller(Option<Session>);

impl Observer for Caller {
    fn progressed(&self, _: &str, _: f64) {
        self.0.iter().for_each(|session| session.cancel.cancel());
    }
}

#[test]
fn every_type_of_the_registry_crosses() {
    let registry = shop(vec![]);
    // What is chosen by name, only counted for the report, only bounds a pattern, only becomes a program, or only comes of one
    // is the program's own business.
    let stays = [
        "defects",
        "deviation",
        "estimate",
        "job",
        "machining",
        "mask",
        "polygon",
        "setup",
        "simulation",
        "tool_sheet",
        "verification",
    ];
    let known = registry.types().iter().map(|known| known.name);
    let known: Vec<_> = known.filter(|name| !stays.contains(name)).collect();
    let crossing: Vec<_> = CROSSINGS.iter().map(|crossing| crossing.type_name).collect();
    assert_eq!((&crossing, seen::TYPES), (&known, known.as_slice()));
}

/// Has one parameter of each kind; its output tells what they are.
fn teller() -> NodeKind {
    let param = |name, kind| Param { name, about: "Something.", kind };
    let options =
        &[ParamOption { name: "up", about: "Up." }, ParamOption { name: "down", about: "Down." }];
    let length = Kind::Number { unit: "mm", default: 1.0, min: 0.0, max: 100.0 };
    let params = vec![
        param("length", length),
        param("share", Kind::Number { unit: "%", default: 0.5, min: 0.0, max: 1.0 }),
        param("count", Kind::Integer { unit: "px", default: 3, min: -5, max: 5 }),
        param("fast", Kind::Switch { default: false }),
        param("title", Kind::Text { default: "none" }),
        param("way", Kind::Choice { options, default: "up" }),
    ];
    let outputs = vec![port("said", "remark")];
    let inputs = vec![Port { optional: true, ..outputs[0] }];
    let node = Toy { name: "teller", params, inputs, outputs, run: tell };
    kind_of(Box::new(node), ORIGIN.to_owned()).unwrap()
}

fn tell(job: &Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault> {
    let (length, share) = (job.number("length")?, job.number("share")?);
    let (count, fast) = (job.integer("count")?, job.switch("fast")?);
    let (title, way) = (job.text("title")?, job.text("way")?);
    let before: Option<seen::Remark<'_>> = job.optional_input("said")?;
    let before = before.map_or(String::new(), |remark| format!("{} and ", remark.text));
    job.note("a note");
    job.warn("a warning");
    job.progress(0.5)?;
    let text = format!("{before}{length} {share} {count} {fast} {title} {way}");
    Ok(vec![seen::Remark { text: text.into() }.into_raw()])
}

#[test]
fn a_recipe_can_use_a_node_of_a_plugin() {
    let kind = teller();
    assert_eq!((kind.version, kind.origin.as_deref()), (7, Some(ORIGIN)));
    let nodes = r#"
        "a": (kind: "teller"),
        "b": (kind: "teller", from: {"said": "a"}, set: {"length": "1in", "share": "20%", "count": -5,
            "fast": true, "title": "x", "way": "down"}),
    "#;
    let report = carve(&shop(vec![kind]), nodes, r#""b""#, false);
    let said = &report.nodes["b"].outputs["said"];
    assert_eq!(said.facts["text"], "1 0.5 3 false none up and 25.4 0.2 -5 true x down");
    assert_eq!(notes(&report.nodes["b"]), ["a note", "a warning"]);
}

fn notes(report: &NodeReport) -> Vec<&str> {
    report.notes.iter().map(|note| note.text.as_str()).collect()
}

/// What becomes of a run that is called off as soon as this work tells progress.
fn called_off(run: fn(&Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault>) -> RunStatus {
    let outputs = vec![port("said", "remark")];
    let node = Toy { name: "long_work", params: vec![], inputs: vec![], outputs, run };
    let kind = kind_of(Box::new(node), ORIGIN.to_owned()).unwrap();
    carve(&shop(vec![kind]), r#""a": (kind: "long_work")"#, r#""a""#, true).status
}

#[test]
fn progress_answers_that_the_run_was_called_off() {
    let status = called_off(|job| {
        loop {
            job.progress(0.5)?;
        }
    });
    assert_eq!(status, RunStatus::Interrupted);
}

#[test]
fn a_parallel_loop_ends_when_the_run_is_called_off() {
    let status = called_off(|job| {
        // No machine counts that far: only being called off ends this.
        job.parallel_for(1 << 62, |_| drop(job.progress(0.5)))?;
        Ok(vec![])
    });
    assert_eq!(status, RunStatus::Interrupted);
}

//! Every kind of node is documented, has defaults that it would take, serves a recipe, and is
//! tested.

use crate::bench::{standard_offers, workspace};
use carvegraph_core::units::Dimension;
use carvegraph_core::{
    Catalogs, Graph, NO_FILE, Origin, ParamKind, ParamSpec, ParamValue, Registry,
};
use carvegraph_nodes::{Batch, Cutters, LIBRARY, Machines, Tools, registry};
use carvegraph_sdk::node::{Job, Node, NodeFault, Port};
use carvegraph_sdk::value::Raw;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Kinds whose work lies in a kernel or a plugin, and which add nothing to it that a test in their
/// own file could look at better than the tests named here.
const TESTED_ELSEWHERE: [(&str, &str); 3] = [
    ("load_gcode", "tests/tests/suite/verify.rs"),
    ("point_cloud", "geometry/src/stitch.rs"),
    ("save_gcode", "tests/tests/suite/relief.rs"),
];

fn standard() -> Registry {
    registry(standard_offers()).unwrap()
}

/// Every parameter of a kind, and of an entry that a kind may choose, with the name of both.
fn all_params(registry: &Registry) -> Vec<(String, &ParamSpec)> {
    let mut all = Vec::new();
    for kind in registry.kinds() {
        let entries = kind.choosers().flat_map(|(_, catalog)| registry.catalogs().entries(catalog));
        let brought = entries.flat_map(|entry| {
            entry.params.iter().map(|param| (format!("{}.{}", entry.name, param.name), param))
        });
        let own = kind.params.iter().map(|param| (format!("{}.{}", kind.name, param.name), param));
        all.extend(own.chain(brought));
    }
    all
}

/// All of a text that a user reads is a sentence or more.
#[track_caller]
fn assert_prose(what: &str, text: &str) {
    assert!(text.trim() == text && text.ends_with('.'), "{what}: no sentence: {text:?}");
    let first = text.chars().next().unwrap();
    assert!(!first.is_lowercase(), "{what}: begins small: {text:?}");
    assert!(!text.contains("  ") && !text.contains("TODO"), "{what}: {text:?}");
}

#[test]
fn everything_is_documented() {
    let registry = standard();
    for kind in registry.kinds() {
        assert_prose(kind.name, kind.about);
        assert!(kind.version >= 1);
        for port in kind.inputs.iter().chain(&kind.outputs) {
            assert_prose(&format!("{}.{}", kind.name, port.name), port.about);
        }
    }
    for (what, param) in all_params(&registry) {
        assert_prose(&what, &param.about);
        if let ParamKind::Choice(options) = &param.kind {
            assert!(options.len() > 1, "{what} leaves no choice");
            options.iter().for_each(|o| assert_prose(&format!("{what}={}", o.name), o.about));
        }
    }
    for port_type in registry.types() {
        assert!(!port_type.about.is_empty(), "{}", port_type.name);
    }
}

#[test]
fn names_are_words_of_recipes() {
    let fits = |name: &str| {
        !name.is_empty()
            && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
    };
    for kind in standard().kinds() {
        assert!(fits(kind.name), "{}", kind.name);
        let ports = kind.inputs.iter().chain(&kind.outputs).map(|port| port.name);
        for name in ports.chain(kind.params.iter().map(|param| param.name)) {
            assert!(fits(name), "{}.{name}", kind.name);
        }
        let distinct =
            |names: Vec<&str>| names.iter().collect::<BTreeSet<_>>().len() == names.len();
        assert!(distinct(kind.inputs.iter().map(|port| port.name).collect()), "{}", kind.name);
        assert!(distinct(kind.outputs.iter().map(|port| port.name).collect()), "{}", kind.name);
        assert!(distinct(kind.params.iter().map(|param| param.name).collect()), "{}", kind.name);
    }
}

#[test]
fn numbers_have_units_and_bounds() {
    for (what, param) in all_params(&standard()) {
        if let ParamKind::Number { dimension, min, max } = param.kind {
            assert!(min.is_finite() && max.is_finite() && min < max, "{what}: {min} to {max}");
            let is_share = (min, max) == (0.0, 1.0);
            assert!(dimension != Dimension::Plain || is_share, "{what} has no unit");
        }
        if let ParamKind::Integer { min, max, .. } = param.kind {
            assert!(min < max, "{what}: {min} to {max}");
        }
    }
}

fn in_catalog(catalogs: &Catalogs, catalog: &str, name: &str) -> bool {
    catalogs.names(catalog).any(|known| known == name)
}

#[test]
fn defaults_lie_within_their_range() {
    let registry = standard();
    for (what, param) in all_params(&registry) {
        let Some(default) = &param.default else {
            assert!(matches!(param.kind, ParamKind::InputFile { .. }), "{what} has no default");
            continue;
        };
        let fits = match (&param.kind, default) {
            (ParamKind::Number { min, max, .. }, ParamValue::Number(n)) => (min..=max).contains(&n),
            (ParamKind::Integer { min, max, odd, .. }, ParamValue::Integer(n)) => {
                (min..=max).contains(&n) && (!odd || n % 2 == 1)
            }
            (ParamKind::Choice(options), ParamValue::Text(word)) => {
                options.iter().any(|option| option.name == word)
            }
            (ParamKind::Catalog { catalog, .. }, ParamValue::Text(name)) => {
                in_catalog(registry.catalogs(), catalog, name)
            }
            (ParamKind::Switch, ParamValue::Switch(_))
            | (ParamKind::Text, ParamValue::Text(_))
            | (ParamKind::OutputName, ParamValue::Output(_)) => true,
            (ParamKind::InputFile { optional: true }, ParamValue::Text(none)) => none == NO_FILE,
            _ => false,
        };
        assert!(fits, "{what}: {default} is not {}", param.kind);
    }
}

#[test]
fn every_kind_serves_a_recipe() {
    let registry = standard();
    let mut used = BTreeSet::new();
    for (name, _) in LIBRARY.recipes {
        let recipe = LIBRARY.open(name, &Origin::BuiltIn).unwrap();
        let graph = Graph::build(&recipe, &[], &registry, &LIBRARY).unwrap();
        used.extend(graph.nodes.iter().map(|node| graph.kind(node).name));
    }
    for kind in registry.kinds() {
        assert!(used.contains(kind.name), "no recipe uses {}", kind.name);
    }
}

#[test]
fn every_recipe_of_the_folder_is_built_in_and_sound() {
    let registry = standard();
    let mut names: Vec<String> = std::fs::read_dir(workspace().join("graphs"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter_map(|name| Some(name.strip_suffix(".ron")?.to_owned()))
        .collect();
    names.sort();
    let built_in: Vec<&str> = LIBRARY.recipes.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, built_in);
    for name in built_in {
        let recipe = LIBRARY.open(name, &Origin::BuiltIn).unwrap();
        assert!(!recipe.title.is_empty(), "{name}");
        assert_prose(name, &recipe.about);
        assert!(recipe.params.iter().all(|param| !param.about.is_empty()), "{name}");
        if let Err(faults) = Graph::build(&recipe, &[], &registry, &LIBRARY) {
            panic!("{name}: {faults}");
        }
    }
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn every_kind_stands_in_a_file_of_its_own_and_is_tested() {
    let mut files = Vec::new();
    sources(&workspace().join("nodes/src"), &mut files);
    for kind in standard().kinds() {
        let line = format!("const KIND: &'static str = \"{}\";", kind.name);
        let defining: Vec<(&PathBuf, String)> = files
            .iter()
            .map(|path| (path, std::fs::read_to_string(path).unwrap()))
            .filter(|(_, text)| text.contains(&line))
            .collect();
        let [(path, text)] = &defining[..] else {
            panic!("{} is defined {} times", kind.name, defining.len())
        };
        assert_eq!(text.matches("const KIND:").count(), 1, "{} is not alone", path.display());
        // A node with a folder keeps its tests beside its parts.
        let beside = |path: &PathBuf| {
            path.ends_with("mod.rs")
                && files.iter().any(|other| {
                    other.starts_with(path.parent().unwrap())
                        && std::fs::read_to_string(other).unwrap().contains("#[test]")
                })
        };
        if text.contains("#[test]") || beside(path) {
            continue;
        }
        let elsewhere = TESTED_ELSEWHERE.iter().find(|(known, _)| *known == kind.name);
        let (_, tests) = elsewhere.unwrap_or_else(|| panic!("{} has no test", kind.name));
        let tests = std::fs::read_to_string(workspace().join(tests)).unwrap();
        assert!(tests.contains("#[test]"), "{}: its tests are gone", kind.name);
    }
}

/// A kind of node that makes nothing of nothing, as a plugin may bring it.
struct Foreign(&'static str);

impl Node for Foreign {
    fn name(&self) -> &str {
        self.0
    }

    fn about(&self) -> &str {
        "Makes a remark."
    }

    fn outputs(&self) -> &[Port] {
        &[Port { name: "remark", about: "A remark.", type_name: "remark", optional: false }]
    }

    fn run(&self, _: &Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault> {
        Ok(Vec::new())
    }
}

fn foreign(names: &[&'static str]) -> Batch {
    let node = |name: &&'static str| Box::new(Foreign(name)) as Box<dyn Node>;
    Batch { nodes: names.iter().map(node).collect(), ..Batch::default() }
}

#[test]
fn nodes_from_elsewhere_stand_in_their_place_among_the_standard_ones() {
    let mut offers = standard_offers();
    offers.add(foreign(&["zoom", "adjust"]), "acme 1.0").unwrap();
    let registry = registry(offers).unwrap();
    let names: Vec<&str> = registry.kinds().iter().map(|kind| kind.name).collect();
    assert_eq!((names[0], *names.last().unwrap()), ("adjust", "zoom"));
    assert_eq!(registry.kind("zoom").unwrap().origin.as_deref(), Some("acme 1.0"));
    assert!(registry.kind("cutter").unwrap().origin.is_none());
}

#[test]
fn nothing_is_offered_under_a_name_that_is_taken() {
    let mut offers = standard_offers();
    let mut refusal = |batch| offers.add(batch, "acme 1.0").unwrap_err().to_string();
    let taken =
        |what: &str, whose: &str| format!("it offers the {what}, which {whose} has already");
    assert_eq!(refusal(foreign(&["link"])), taken("node \"link\"", "carve"));
    assert_eq!(refusal(foreign(&["x", "x"])), taken("node \"x\"", "acme 1.0"));
    let cutters = Batch { cutters: carvegraph_cutters::standard(), ..Batch::default() };
    assert_eq!(refusal(cutters), taken("cutter \"ball\"", "test"));
    let dialects = Batch { dialects: carvegraph_dialects::standard(), ..Batch::default() };
    assert_eq!(refusal(dialects), taken("dialect \"fanuc\"", "test"));
    // All or nothing.
    assert_eq!(refusal(foreign(&["y", "link"])), taken("node \"link\"", "carve"));
    assert!(registry(offers).unwrap().kind("y").is_none());
}

#[test]
fn a_cutters_dimensions_are_fields_of_its_node() {
    let registry = standard();
    let ball = registry.catalogs().entry("cutter", "ball").unwrap();
    let diameter = ball.param("diameter").unwrap();
    assert_eq!(diameter.kind.to_string(), "number, 0.01 to 200 mm");
    assert_eq!(diameter.default, Some(ParamValue::Number(6.0)));
    assert_eq!(diameter.about, "Diameter of the cutting part.");
    assert_eq!(
        registry.kind("cutter").unwrap().choosers().collect::<Vec<_>>(),
        [("shape", "cutter")]
    );
}

/// A cache must not hand out what was made with another profile, library, dialect or shape.
#[test]
fn machines_and_tools_change_with_their_files_and_with_what_they_name() {
    let registry = standard();
    let version = |catalog: &str, name: &str| {
        registry.catalogs().entry(catalog, name).unwrap().version.clone()
    };
    for machine in Machines::built_in().0 {
        let dialect = version("dialect", &machine.dialect.unwrap());
        let expected = format!("{}, {dialect}", machine.version);
        assert_eq!(version("machine", &machine.name), expected);
    }
    for tool in Tools::built_in().0 {
        let expected = format!("{}, {}", tool.version, version("cutter", &tool.shape.text));
        assert_eq!(version("tool", &tool.name), expected);
    }
}

#[test]
fn the_built_in_tools_can_be_made() {
    let faults = Tools::built_in().faults(&Cutters(carvegraph_cutters::standard()));
    assert!(faults.is_empty(), "{faults}");
}

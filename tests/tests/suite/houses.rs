//! Who may know whom: dependencies go down only (`ARCHITECTURE.md`).

use crate::bench::workspace;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// For each crate the crates of the workspace that it may build on; those below come first. Its tests
/// and examples may use them too, and no others.
const MAY_KNOW: [(&str, &[&str]); 9] = [
    ("carvegraph-derive", &[]),
    ("carvegraph-core", &["carvegraph-derive"]),
    ("carvegraph-geometry", &[]),
    ("carvegraph-sdk", &["carvegraph-geometry"]),
    ("carvegraph-cutters", &["carvegraph-sdk", "carvegraph-geometry"]),
    ("carvegraph-dialects", &["carvegraph-sdk"]),
    ("carvegraph-nodes", &["carvegraph-core", "carvegraph-geometry", "carvegraph-sdk"]),
    (
        "carvegraph-cli",
        &["carvegraph-core", "carvegraph-cutters", "carvegraph-dialects", "carvegraph-nodes"],
    ),
    (
        "carvegraph-tests",
        &[
            "carvegraph-cli",
            "carvegraph-core",
            "carvegraph-cutters",
            "carvegraph-dialects",
            "carvegraph-geometry",
            "carvegraph-nodes",
        ],
    ),
];

/// Crates of others that a house must not need: it would know too much.
const MUST_NOT_NEED: [(&str, &[&str]); 4] = [
    ("carvegraph-core", &["clap", "glam", "image", "indicatif", "wide"]),
    ("carvegraph-geometry", &["clap", "image", "petgraph", "serde_json", "tempfile"]),
    ("carvegraph-sdk", &["clap", "image", "petgraph"]),
    ("carvegraph-nodes", &["clap", "indicatif", "petgraph", "tempfile"]),
];

/// Each crate of the workspace and the names of all that it depends on, for its tests too or only
/// when it is used.
fn dependencies(for_tests: bool) -> BTreeMap<String, BTreeSet<String>> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1", "--manifest-path"])
        .arg(workspace().join("Cargo.toml"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let name = |value: &Value| value["name"].as_str().unwrap().to_owned();
    let packages = metadata["packages"].as_array().unwrap();
    let needs = |package: &Value| {
        let needs = package["dependencies"].as_array().unwrap().iter();
        needs.filter(|need| for_tests || need["kind"] != "dev").map(name).collect()
    };
    packages.iter().map(|package| (name(package), needs(package))).collect()
}

#[test]
fn crates_know_only_those_below_them() {
    let dependencies = dependencies(true);
    for (name, needs) in &dependencies {
        let rule = MAY_KNOW.iter().find(|(known, _)| known == name);
        let (_, may) =
            rule.unwrap_or_else(|| panic!("{name} has no place yet: say what it may know"));
        let ours = needs.iter().filter(|need| dependencies.contains_key(*need));
        for need in ours {
            assert!(may.contains(&need.as_str()), "{name} must not know {need}");
        }
    }
    for (name, _) in MAY_KNOW {
        assert!(dependencies.contains_key(name), "there is no crate {name} any more");
    }
}

#[test]
fn the_rule_itself_has_no_cycle() {
    let mut settled: BTreeSet<&str> = BTreeSet::new();
    for (name, may) in MAY_KNOW {
        for below in may {
            assert!(settled.contains(below), "{name} stands before {below}, which it may know");
        }
        settled.insert(name);
    }
}

#[test]
fn crates_do_not_know_what_is_not_theirs() {
    let dependencies = dependencies(false);
    for (name, forbidden) in MUST_NOT_NEED {
        for need in forbidden {
            assert!(!dependencies[name].contains(*need), "{name} must not need {need}");
        }
    }
}

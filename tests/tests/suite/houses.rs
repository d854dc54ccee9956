//! Who may know whom: dependencies go down only (`ARCHITECTURE.md`).

use crate::bench::workspace;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// For each crate the crates of the workspace that it may build on; those below come first. Its tests
/// and examples may use them too, and no others but those of [`TESTS_MAY_KNOW`].
const MAY_KNOW: [(&str, &[&str]); 14] = [
    ("carvegraph-derive", &[]),
    ("carvegraph-core", &["carvegraph-derive"]),
    ("carvegraph-geometry", &[]),
    ("carvegraph-abi", &[]),
    ("carvegraph-sdk", &["carvegraph-abi", "carvegraph-geometry"]),
    ("carvegraph-host", &["carvegraph-abi", "carvegraph-core", "carvegraph-sdk"]),
    ("carvegraph-cutters", &["carvegraph-sdk"]),
    ("carvegraph-cutters-plugin", &["carvegraph-cutters", "carvegraph-sdk"]),
    ("carvegraph-dialects", &["carvegraph-core", "carvegraph-sdk"]),
    ("carvegraph-dialects-plugin", &["carvegraph-dialects", "carvegraph-sdk"]),
    ("carvegraph-misbehaving-plugin", &["carvegraph-sdk"]),
    ("carvegraph-nodes", &["carvegraph-core", "carvegraph-geometry", "carvegraph-sdk"]),
    (
        "carvegraph-cli",
        &[
            "carvegraph-core",
            "carvegraph-cutters",
            "carvegraph-dialects",
            "carvegraph-host",
            "carvegraph-nodes",
            "carvegraph-sdk",
        ],
    ),
    (
        "carvegraph-tests",
        &[
            "carvegraph-cli",
            "carvegraph-core",
            "carvegraph-cutters",
            "carvegraph-cutters-plugin",
            "carvegraph-dialects",
            "carvegraph-dialects-plugin",
            "carvegraph-geometry",
            "carvegraph-misbehaving-plugin",
            "carvegraph-nodes",
            "carvegraph-sdk",
        ],
    ),
];

/// What only the tests of a crate may know: those of the standard plugins load them as libraries too.
const TESTS_MAY_KNOW: [(&str, &[&str]); 2] = [
    (
        "carvegraph-cutters",
        &["carvegraph-cutters-plugin", "carvegraph-host", "carvegraph-geometry"],
    ),
    ("carvegraph-dialects", &["carvegraph-dialects-plugin", "carvegraph-host"]),
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

/// Complains of whoever needs a crate of ours that it may not know.
fn check(dependencies: &BTreeMap<String, BTreeSet<String>>, also: &[(&str, &[&str])]) {
    for (name, needs) in dependencies {
        let rule = MAY_KNOW.iter().find(|(known, _)| known == name);
        let (_, may) =
            rule.unwrap_or_else(|| panic!("{name} has no place yet: say what it may know"));
        let more = also.iter().find(|(known, _)| known == name).map_or(&[][..], |(_, more)| more);
        for need in needs.iter().filter(|need| dependencies.contains_key(*need)) {
            let known = may.iter().chain(more).any(|known| known == need);
            assert!(known, "{name} must not know {need}");
        }
    }
}

#[test]
fn crates_know_only_those_below_them() {
    check(&dependencies(false), &[]);
    let dependencies = dependencies(true);
    check(&dependencies, &TESTS_MAY_KNOW);
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

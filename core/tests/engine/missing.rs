//! Names that are known but not to be had, and names that look like a library.

use crate::toy::{Lab, Shop, catalogs, kinds, lines, recipe, types};
use carvegraph_core::{Missing, NO_LIBRARY, Registry};
use std::sync::Arc;

fn missing(name: &str) -> Missing {
    Missing {
        name: name.to_owned(),
        why: "plugin \"acme\" offers it but cannot be used: it is for another version".to_owned(),
        help: "carve plugins doctor tells more".to_owned(),
    }
}

fn shop() -> Shop {
    let mut shop = Shop::new();
    let catalogs = catalogs(&Arc::new(Lab::default()), "1");
    shop.registry = Registry::new(kinds(), types(), catalogs)
        .unwrap()
        .with_missing_kinds([missing("unsharp"), missing("number")])
        .with_missing_entries("dialect", [missing("mine"), missing("grbl")]);
    shop
}

#[track_caller]
fn check(nodes: &str, set: &[&str], expected: &[&str]) {
    match shop().graph_with(&recipe(nodes, r#""z""#), set) {
        Ok(_) => panic!("nothing is wrong with {nodes} {set:?}"),
        Err(faults) => assert_eq!(lines(&faults), expected, "{nodes} {set:?}"),
    }
}

const WHY: &str = "plugin \"acme\" offers it but cannot be used: it is for another version; carve plugins doctor tells more";

#[test]
fn a_name_that_is_missing_is_told_with_the_reason() {
    check(
        r#""z": (kind: "tool", set: {"dialect": "mine"})"#,
        &[],
        &[&format!(r#"2:38 node "z": dialect cannot be "mine": {WHY}"#)],
    );
    check(
        r#""z": (kind: "tool")"#,
        &["z.dialect=mine"],
        &[&format!(r#"--set:1:11 node "z": dialect cannot be "mine": {WHY}"#)],
    );
}

#[test]
fn a_kind_that_is_missing_is_told_with_the_reason() {
    check(
        r#""z": (kind: "unsharp", set: {"radius": 5}, from: {"image": "z"})"#,
        &[],
        &[&format!(r#"2:13 there is no kind of node called "unsharp": {WHY}"#)],
    );
}

#[test]
fn what_is_there_after_all_is_not_missing() {
    let text = recipe(r#""n": (kind: "number"), "z": (kind: "tool")"#, r#""z""#);
    assert!(shop().graph_with(&text, &["z.dialect=grbl"]).is_ok());
}

#[test]
fn other_names_are_told_as_ever() {
    check(
        r#""z": (kind: "tool", set: {"dialect": "minx"})"#,
        &[],
        &[r#"2:38 node "z": dialect cannot be "minx"; it is one of fanuc, grbl"#],
    );
}

#[test]
fn the_rule_about_libraries_is_said_in_these_words() {
    assert_eq!(
        NO_LIBRARY,
        "a recipe cannot name a library: plugins are loaded only from the plugin folders and --plugins"
    );
}

#[test]
fn a_recipe_cannot_name_a_library_as_a_kind_or_a_catalog_name() {
    let options = "it is one of fanuc, grbl";
    for name in ["./evil.so", "C:\\\\x\\\\evil.dll", "libevil.dylib", "mine.ron", "../dialects/x"] {
        let text = format!(r#""z": (kind: "tool", set: {{"dialect": "{name}"}})"#);
        let message = format!(r#"dialect cannot be "{name}"; {NO_LIBRARY}"#);
        check(&text, &[], &[&format!(r#"2:38 node "z": {message}; {options}"#)]);
        let text = format!(r#""z": (kind: "{name}")"#);
        let message = format!(r#"there is no kind of node called "{name}"; {NO_LIBRARY}"#);
        let help = r#"for another recipe write kind: "recipe", set: { "recipe": "name.ron" }"#;
        check(&text, &[], &[&format!("2:13 {message}; {help}")]);
    }
}

#[test]
fn a_recipe_has_no_field_that_loads_a_library() {
    for field in ["plugins", "plugin", "library", "libraries", "load"] {
        let text = format!(
            r#"(format: 1, {field}: ["evil.so"], nodes: {{"z": (kind: "number", {field}: "evil.so")}}, outputs: ["z"])"#
        );
        let faults = shop().open(&text).unwrap_err();
        let column = text.rfind(field).unwrap() + 1;
        assert_eq!(
            lines(&faults),
            [
                format!(r#"1:13 the recipe has no field "{field}"; {NO_LIBRARY}"#),
                format!(r#"1:{column} node "z" has no field "{field}"; {NO_LIBRARY}"#),
            ]
        );
    }
}

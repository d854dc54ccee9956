//! Files of our own format that are no recipes.

use crate::toy::{Shop, lines};
use carvegraph_core::Diagnostics;
use carvegraph_core::ron::{self, Form, Item, TextError};
use carvegraph_core::source::Source;
use carvegraph_core::units::Dimension;
use std::sync::Arc;

/// A toy with a field of every kind.
#[derive(Debug, PartialEq)]
struct Toy {
    name: String,
    size_mm: f64,
    wheels: Option<i64>,
    rolls: bool,
    colour: char,
    tags: Vec<String>,
    parts: Vec<(String, f64)>,
    owner: Option<String>,
}

fn toy(item: Item<'_>) -> Option<Toy> {
    let mut fields = item.fields(Some("Toy"))?;
    let name = fields.required("name").and_then(Item::text);
    let size = fields.required("size");
    let size_mm = size.and_then(|item| item.number(Dimension::Length, f64::MIN_POSITIVE..=100.0));
    let wheels = fields.optional("wheels").and_then(|item| item.integer(0..=8));
    let rolls = fields.optional("rolls").map_or(Some(false), Item::switch);
    let colours = [("red", 'r'), ("green", 'g')];
    let colour = fields.required("colour").and_then(|item| item.choice(&colours));
    let tags = fields.optional("tags").and_then(Item::names).unwrap_or_default();
    let parts = fields.optional("parts").and_then(Item::entries).unwrap_or_default();
    let weight = |item: Item<'_>| item.number(Dimension::Plain, 0.0..=f64::INFINITY);
    let parts = parts.into_iter().filter_map(|(name, item)| Some((name.text, weight(item)?)));
    let parts = parts.collect();
    let owner = fields.optional("owner").and_then(owner);
    fields.no_more();
    let tags = tags.into_iter().map(|tag| tag.text).collect();
    let (name, size_mm, rolls, colour) = (name?, size_mm?, rolls?, colour?);
    Some(Toy { name, size_mm, wheels, rolls, colour, tags, parts, owner })
}

fn owner(item: Item<'_>) -> Option<String> {
    let mut fields = item.called("the owner").fields(None)?;
    let name = fields.required("name").and_then(Item::text);
    fields.no_more();
    name
}

fn read(text: &str) -> Result<Toy, Diagnostics> {
    let value = ron::parse(&Arc::new(Source::new("toy.ron", text)))?;
    let form = Form::default();
    let toy = toy(form.item(&value, "the toy"));
    form.finish(toy)
}

#[test]
fn a_struct_is_read_with_all_its_fields() {
    let text = r#"Toy(name: "car", size: "2cm", wheels: 4, rolls: true, colour: "green",
tags: ["new", "fast"], parts: {"body": 1.5, "roof": 2}, owner: (name: "Ann"))"#;
    let parts = vec![("body".to_owned(), 1.5), ("roof".to_owned(), 2.0)];
    let expected = Toy {
        name: "car".into(),
        size_mm: 20.0,
        wheels: Some(4),
        rolls: true,
        colour: 'g',
        tags: vec!["new".into(), "fast".into()],
        parts,
        owner: Some("Ann".into()),
    };
    assert_eq!(read(text).unwrap(), expected);
    let bare = read(r#"(name: "ball", size: 5, colour: "red")"#).unwrap();
    assert_eq!((bare.size_mm, bare.wheels, bare.rolls, bare.tags.len()), (5.0, None, false, 0));
}

#[test]
fn every_fault_is_told_with_its_place() {
    let check = |text: &str, expected: &[&str]| {
        assert_eq!(lines(&read(text).unwrap_err()), expected, "{text}");
    };
    check(
        r#"Tyo(nmae: "car", size: 0, wheels: 9, rolls: "yes", colour: "gren",
 tags: ["new", 5], parts: {"body": -1, 5: 1}, owner: ())"#,
        &[
            r#"1:1 before the fields of the toy stands "Toy" or nothing, not "Tyo""#,
            r#"1:1 the toy lacks the field "name""#,
            r#"1:5 the toy has no field "nmae"; did you mean "name"?"#,
            "1:24 size must be more than 0 mm, not 0",
            "1:35 wheels must be between 0 and 8, not 9",
            "1:45 rolls must be true or false, not a text",
            r#"1:60 colour cannot be "gren"; did you mean "green"? It is one of red, green"#,
            r#"2:16 tags must be a text in double quotes, not a whole number; write "5""#,
            "2:36 body must be at least 0, not -1",
            r#"2:40 a key of parts must be a text in double quotes, not a whole number; write "5""#,
            r#"2:54 the owner lacks the field "name""#,
        ],
    );
    check(
        r#"(name: "car", size: "3deg", wheels: 1.5, colour: red, tags: "new", parts: [], owner: "Ann")"#,
        &[
            r#"1:21 size: "3deg" is an angle; a length is wanted: mm, cm, m, um, in, thou, ft"#,
            "1:37 wheels must be a whole number, not 1.5",
            r#"1:50 colour must be a text in double quotes, not a bare word; write "red""#,
            "1:61 tags must be a list [...], not a text",
            "1:75 parts must be a map {...}, not a list [...]",
            "1:86 the owner must be fields in (...), not a text",
        ],
    );
    check("5", &["1:1 the toy must be fields in (...), not a whole number"]);
    check("(", &["1:1 this `(` is never closed; `)` is missing before the end of the text"]);
}

#[test]
fn of_what_cannot_be_read_nothing_is_made() {
    let fault = Form::default().finish::<Toy>(None).unwrap_err();
    assert_eq!(lines(&fault), [" something is missing"]);
}

#[test]
fn files_are_read_with_their_limits() {
    let shop = Shop::new();
    shop.write("toy.ron", "(x: 1)");
    shop.write("bytes.ron", b"(x: \"\xff\")");
    shop.write("folder/x", "");
    shop.write("long.ron", "x".repeat(ron::MAX_TEXT_BYTES + 1));
    let read = |name: &str| ron::read_file(&shop.path(name), "a toy");
    let source = read("toy.ron").unwrap();
    assert_eq!(source.text(), "(x: 1)");
    assert_eq!(source.name(), shop.path("toy.ron").display().to_string());
    let path = |name: &str| shop.path(name).display().to_string();
    let no_file = TextError::NotFound { path: path("none.ron") };
    assert_eq!(read("none.ron").unwrap_err(), no_file);
    let refused = |name: &str, why: &str| {
        let expected = format!("cannot read {}: {why}", path(name));
        assert_eq!(read(name).unwrap_err().to_string(), expected);
    };
    refused("bytes.ron", "byte 5 is no UTF-8");
    refused("folder", "it is not a plain file");
    refused("long.ron", "it has 4194305 bytes; a toy has at most 4194304");
}

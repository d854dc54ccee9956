//! Every kind of value, every kind of slip, and the time it takes.

use std::time::{Duration, Instant};

use super::*;
use crate::diagnostic::Diagnostics;
use crate::source::Source;

fn read(text: impl Into<String>) -> Result<Value, Diagnostics> {
    parse(&Arc::new(Source::new("t.ron", text)))
}

/// A value without its places, in the notation of Rust.
fn outline(value: &Value) -> String {
    let all = |values: &[Value]| values.iter().map(outline).collect::<Vec<_>>().join(", ");
    let name = || value.name_for_tests();
    match &value.kind {
        ValueKind::Unit => "()".to_owned(),
        ValueKind::Bool(value) => value.to_string(),
        ValueKind::Integer(value) => value.to_string(),
        ValueKind::Number(value) => format!("{value:?}"),
        ValueKind::Char(value) => format!("{value:?}"),
        ValueKind::Text(value) => format!("{value:?}"),
        ValueKind::Word(value) => value.clone(),
        ValueKind::List(items) => format!("[{}]", all(items)),
        ValueKind::Tuple { items, .. } => format!("{}({})", name(), all(items)),
        ValueKind::Map(entries) => {
            let entry = |(key, value): &_| format!("{}: {}", outline(key), outline(value));
            format!("{{{}}}", entries.iter().map(entry).collect::<Vec<_>>().join(", "))
        }
        ValueKind::Struct { fields, .. } => {
            let field = |(name, value): &(Name, _)| format!("{}: {}", name.text, outline(value));
            let fields = fields.iter().map(field).collect::<Vec<_>>().join(", ");
            format!("{}({fields})", name())
        }
    }
}

impl Value {
    fn name_for_tests(&self) -> &str {
        match &self.kind {
            ValueKind::Struct { name, .. } | ValueKind::Tuple { name, .. } => {
                name.as_ref().map_or("", |name| &name.text)
            }
            _ => "",
        }
    }
}

#[track_caller]
fn check(text: &str, expected: &str) {
    match read(text) {
        Ok(value) => assert_eq!(outline(&value), expected, "{text}"),
        Err(faults) => panic!("{faults}"),
    }
}

/// Compares all the faults, each as `line:column message` and `; help` if any.
#[track_caller]
fn check_faults(text: &str, expected: &[&str]) {
    let faults = read(text).map(|value| outline(&value)).expect_err(text);
    let lines: Vec<_> = faults
        .sorted()
        .into_iter()
        .map(|fault| {
            let place = fault.span.as_ref().map(ToString::to_string).unwrap_or_default();
            let help = fault.help.as_ref().map(|help| format!("; {help}")).unwrap_or_default();
            format!("{} {}{help}", place.trim_start_matches("t.ron:"), fault.message)
        })
        .collect();
    assert_eq!(lines, expected, "{text}\n{faults}");
}

#[test]
fn every_kind_of_value_is_read() {
    check("()", "()");
    check(" true ", "true");
    check("[1, -2, +3, 1_000, 0x1f, -0o17, 0b101,]", "[1, -2, 3, 1000, 31, -15, 5]");
    check("-9223372036854775808", "-9223372036854775808");
    check(
        "[1.0, .5, 5., 1e3, -1.5E-2, 1_0.0, inf, -inf, NaN]",
        "[1.0, 0.5, 5.0, 1000.0, -0.015, 10.0, inf, -inf, NaN]",
    );
    check(r#""a\n\t\r\0\\\"\'\u{b5}\x41é""#, r#""a\n\t\r\0\\\"'µAé""#);
    check("\"a\nb\"", r#""a\nb""#);
    check(r###"[r"a\b", r#"a"b"#, r##"a"#b"##]"###, r###"["a\\b", "a\"b", "a\"#b"]"###);
    check(r"['a', 'é', '\n', '\'', '\u{b5}']", r"['a', 'é', '\n', '\'', 'µ']");
    check(r#"{"a": 1, 2: [], (): {}, 'c': ()}"#, r#"{"a": 1, 2: [], (): {}, 'c': ()}"#);
    check("Recipe(a: 1, größe: None, r: Some(2),)", "Recipe(a: 1, größe: None, r: Some(2))");
    check("[(1, 2), P(), Q (x), ball]", "[(1, 2), P(), Q(x), ball]");
    check("[true, (true: 1)]", "[true, (true: 1)]");
}

#[test]
fn comments_marks_and_attributes_are_skipped() {
    check("\u{feff}#![enable(implicit_some)]\r\n#![enable(x)] // c\r\n(a: 1)\r\n", "(a: 1)");
    check("/* a /* b */ \" */ [1 /**/, // ]\n 2] // end", "[1, 2]");
    check("(a /* : */ : /* x */ 1 // \"\n)", "(a: 1)");
}

#[test]
fn values_know_their_place() {
    let text = "Recipe(\n  a: {\"k\": [ 1.5 ]},\n)";
    let value = read(text).unwrap();
    assert_eq!(value.span.text(), text);
    let ValueKind::Struct { name: Some(name), fields } = &value.kind else { panic!() };
    let (field, map) = &fields[0];
    let ValueKind::Map(entries) = &map.kind else { panic!() };
    let spans = [&name.span, &field.span, &map.span, &entries[0].0.span, &entries[0].1.span];
    let places = spans.map(|span| format!("{span} {}", span.text()));
    let expected = ["1:1 Recipe", "2:3 a", "2:6 {\"k\": [ 1.5 ]}", "2:7 \"k\"", "2:12 [ 1.5 ]"];
    assert_eq!(places, expected.map(|place| format!("t.ron:{place}")));
}

#[test]
fn slips_are_named_at_their_place() {
    check_faults("", &["1:1 expected a value, found the end of the text"]);
    check_faults("(a: 1) x", &["1:8 expected the end of the text, found `x`"]);
    check_faults("(a: 1\n b: 2)", &["1:6 a `,` is missing here"]);
    check_faults("[\"a\" \"b\", \"c\"]", &["1:5 a `,` is missing here"]);
    check_faults("{\"a\": 1; \"b\": 2}", &["1:8 expected `,`, found `;`"]);
    check_faults("(a: 5 mm, b: 1)", &["1:7 expected `,` or `)`, found `mm`"]);
    check_faults(
        "(a 1, b \"x\", c: {\"d\" 2})",
        &["1:3 a `:` is missing here", "1:8 a `:` is missing here", "1:21 a `:` is missing here"],
    );
    check_faults(
        "(a = 1, b => 2)",
        &["1:4 expected `:`, found `=`", "1:11 expected `:`, found `=>`"],
    );
    check_faults(
        "{\"a\", \"b\"}",
        &[
            "1:5 expected `:` and a value, found `,`; a map is {key: value, ...}; a list is [value, ...]",
        ],
    );
    check_faults(
        "(a: , b: )",
        &["1:5 expected a value, found `,`", "1:10 expected a value, found `)`"],
    );
    check_faults("[1,,2]", &["1:4 expected a value, found `,`"]);
    check_faults("{a: 1}", &["1:2 a key of a map stands in quotes; write \"a\""]);
    check_faults("(\"a\": 1)", &["1:2 the name of a field stands without quotes; write a"]);
    check_faults("(a: 1, \"x\")", &["1:8 a name and a `:` are missing before this value"]);
    check_faults("(a: 'x y')", &["1:5 a text stands between double quotes; write \"x y\""]);
    check_faults("(a: 'x, b: 1)", &["1:5 this `'` is never closed"]);
    check_faults(
        "(a: “x”, b: 1)",
        &["1:5 expected a value, found `“`; a text stands between straight double quotes: \"...\""],
    );
    check_faults(
        "(a: @, b: \u{1b})",
        &["1:5 expected a value, found `@`", "1:11 expected a value, found `\\u{1b}`"],
    );
    check_faults("/* /* */ (", &["1:1 this comment is never closed"]);
    check_faults("#![x", &["1:1 this `#![` is never closed"]);
}

#[test]
fn bad_literals_are_named_at_their_place() {
    check_faults(
        "[5mm, 600mm/min, 20%, 15°]",
        &[
            "1:2 `5mm` is not a number; a number with a unit is a text: write \"5mm\"",
            "1:7 `600mm` is not a number; a number with a unit is a text: write \"600mm/min\"",
            "1:18 `20%` is not a number; a number with a unit is a text: write \"20%\"",
            "1:23 `15°` is not a number; a number with a unit is a text: write \"15°\"",
        ],
    );
    check_faults(
        "[1.2.3, 1u8, -, ., 0x, 0xg, 99999999999999999999]",
        &[
            "1:2 `1.2.3` is not a number",
            "1:9 `1u8` is not a number; a number with a unit is a text: write \"1u8\"",
            "1:14 `-` is not a number",
            "1:17 `.` is not a number",
            "1:20 `0x` is not a number",
            "1:24 `0xg` is not a number",
            "1:29 `99999999999999999999` is not a number; whole numbers have 64 bits; larger ones are written as 1e20",
        ],
    );
    check_faults(
        r#"["C:\pics\x.png", "\u{d800}", "\xZZ", "ok"]"#,
        &[
            "1:5 bad escape `\\p`; write \\\\ for a backslash; paths may use / instead",
            "1:20 bad escape `\\u`; write \\\\ for a backslash; paths may use / instead",
            "1:32 bad escape `\\x`; write \\\\ for a backslash; paths may use / instead",
        ],
    );
}

#[test]
fn lost_quotes_are_found() {
    check_faults("(a: \"x)", &["1:5 this text has no closing quote"]);
    check_faults("(a: r#\"x\")", &["1:5 this text has no closing quote"]);
    let text = "Recipe(\n \"n\": 1,\n a: (kind: \"x, set: { \"p\": 1 }),\n b: @,\n)";
    check_faults(
        text,
        &[
            "2:2 the name of a field stands without quotes; write n",
            "3:12 this text has no closing quote",
            "4:5 expected a value, found `@`",
        ],
    );
    check_faults(
        "(a: \"One, two.,\n b: \"x\",\n c: @)",
        &["1:5 this text has no closing quote", "3:5 expected a value, found `@`"],
    );
    check_faults(
        "{\"a: 1, \"b\": @}",
        &["1:2 this text has no closing quote", "1:14 expected a value, found `@`"],
    );
    check_faults(
        "(a: x\", b: \"y\", c: @)",
        &["1:5 `x` lacks its opening quote", "1:20 expected a value, found `@`"],
    );
    check_faults(
        "(a: x y z\", b: \"y\", c: @)",
        &["1:5 `x y z` lacks its opening quote", "1:24 expected a value, found `@`"],
    );
}

#[test]
fn lost_brackets_are_found() {
    check_faults(
        "(a: [1, 2",
        &["1:5 the `[` of a is never closed; `]` is missing before the end of the text"],
    );
    check_faults(
        "R(\n  a: {\n    \"x\": (k: 1),\n    \"y\": (k: 2,\n    \"z\": (k: @),\n  },\n)",
        &[
            "4:10 the `(` of \"y\" is never closed; `)` is missing before a text on line 5",
            "5:14 expected a value, found `@`",
        ],
    );
    check_faults(
        "R(\n  a: {\n    \"x\": 1,\n  b: [@],\n)",
        &[
            "2:6 the `{` of a is never closed; `}` is missing before `b` on line 4",
            "4:7 expected a value, found `@`",
        ],
    );
    check_faults(
        "{\n  \"x\": (k: 1, set: {\"a\": 1 ),\n  \"y\": @\n}",
        &[
            "2:20 the `{` of set is never closed; `}` is missing before the `)` on line 2",
            "3:8 expected a value, found `@`",
        ],
    );
    check_faults(
        "(a: [1, 2), b: @)",
        &["1:10 the `[` of a is closed by `)`, not `]`", "1:16 expected a value, found `@`"],
    );
    check_faults(
        "{\"x\": (s: {\"a\": 1)), \"y\": @}",
        &["1:18 the `{` of s is closed by `)`, not `}`", "1:27 expected a value, found `@`"],
    );
    check_faults(
        "{\"x\": (s: 1)), \"y\": @}",
        &["1:13 this `)` closes nothing", "1:21 expected a value, found `@`"],
    );
    check_faults("(a: 1))", &["1:7 expected the end of the text, found `)`"]);
    check_faults("[1, 2)", &["1:6 this `[` is closed by `)`, not `]`"]);
    check_faults(
        "([{1)",
        &["1:3 this `{` is never closed; `}` is missing before the `)` on line 1"],
    );
    check_faults(
        "(a: (b: 1, c: @)",
        &[
            "1:1 this `(` is never closed; `)` is missing before the end of the text",
            "1:15 expected a value, found `@`",
        ],
    );
}

/// Of all the recipes with one punctuation mark lost or doubled.
#[test]
fn one_slip_is_one_fault_nearly_always() {
    let (mut slips, mut pairs) = (0, 0);
    for (at, mark) in RECIPE.char_indices().filter(|(_, c)| "\"'()[]{}:".contains(*c)) {
        let (before, after) = (&RECIPE[..at], &RECIPE[at + 1..]);
        for text in [format!("{before}{after}"), format!("{before}{mark}{mark}{after}")] {
            let faults = read(text.as_str()).map(|_| text.clone()).unwrap_err();
            assert!(faults.len() <= 2, "{text}\n{faults}");
            slips += 1;
            pairs += usize::from(faults.len() == 2);
        }
    }
    assert!(pairs * 25 < slips, "{pairs} of {slips} slips make two faults");
}

#[test]
fn any_fragment_is_read_or_refused() {
    for (at, _) in RECIPE.char_indices() {
        // The first word alone is a value.
        assert!((1..=6).contains(&at) || read(&RECIPE[..at]).is_err());
        assert!(at <= 6 || read(&RECIPE[at..]).is_err());
    }
}

#[test]
fn limits_are_named() {
    let nested = |depth| "[".repeat(depth) + &"]".repeat(depth);
    assert!(read(nested(MAX_DEPTH)).is_ok());
    check_faults(&nested(MAX_DEPTH + 1), &["1:65 brackets nest deeper than 64 levels"]);
    assert!(read(" ".repeat(MAX_TEXT_BYTES - 2) + "()").is_ok());
    let expected = "1:1 the text has 4194305 bytes; 4194304 at most are read";
    check_faults(&" ".repeat(MAX_TEXT_BYTES + 1), &[expected]);
    let faults = read("[".to_owned() + &"@,".repeat(MAX_FAULTS * 2)).unwrap_err();
    assert_eq!(faults.len(), MAX_FAULTS + 1);
    let last = faults.sorted().pop().map(|fault| fault.message.as_str());
    assert_eq!(last, Some("reading stopped at 100 faults"));
}

/// Quadratic reading of any of these takes minutes.
#[test]
fn time_is_linear_in_the_text() {
    let pieces = r##"( [ { " ' r# r#" /* a( a: a= a:( "a":{ [] ) (} "" "x ""x "a"b "\" "\",
            a" a; 1, a, [( [1 1e - @ , 'a', /**/ \ é"##;
    let pieces = pieces.split_whitespace();
    for piece in pieces.chain([" ", "\n", "a ", "\"a\" ", "\"\\\",\n", "//\n", "a\n,", "\u{feff}"])
    {
        for start in ["", "[", "{", "(", &format!("(\n [\n{}", " ".repeat(1 << 18))] {
            quick(&format!("{start}{}", piece.repeat((1 << 18) / piece.len())));
        }
    }
    quick(&"(".repeat(MAX_TEXT_BYTES));
    quick(&"[\"\n".repeat(MAX_TEXT_BYTES / 3));
    quick(&format!("{{{}}}", "1:1,".repeat(MAX_TEXT_BYTES / 4 - 1)));
    let distinct =
        |quote| (0..300_000).map(|k| format!("{quote}k{k}{quote}:1,")).collect::<String>();
    quick(&format!("{{{}}}", distinct("\"")));
    quick(&format!("({})", distinct("")));
}

/// Reads and renders a text within ten seconds; alone on a machine it takes less than one.
#[track_caller]
fn quick(text: &str) {
    let start = Instant::now();
    let _ = read(text).map_err(|faults| faults.to_string());
    let took = start.elapsed();
    let beginning: String = text.chars().take(20).collect();
    assert!(took < Duration::from_secs(10), "{took:?} for {beginning:?}...");
}

const RECIPE: &str = r#"Recipe(
    format: 1,
    title: "Relief from a picture",
    about: "Luminance becomes height; ball-nose finish.",
    params: {
        "image": (sets: ["photo.path"], about: "Picture to carve"),
        "diameter": (sets: ["cutter.diameter", "b"], about: "Ball diameter"),
    },
    nodes: {
        "photo":  (kind: "load_image", set: { "path": "samples/medallion.png" }),
        "gray":   (kind: "grayscale", from: { "image": "photo" }),
        "smooth": (kind: "gaussian_blur", from: { "image": "gray" }, set: { "kernel": 5 }),
        "relief": (
            kind: "z_map",
            from: { "image": "smooth" },
            set: { "z_max": -5.0, "on": true },
        ),
    },
    outputs: ["save_gcode", "preview"],
)"#;

#[test]
fn duplicates_name_the_first() {
    check_faults(
        "{\"a\": 1,\n \"b\": 2,\n \"\\x61\": 3, \"b\": 4}",
        &[
            "3:2 duplicate key \"\\x61\"; the first is on line 1",
            "3:13 duplicate key \"b\"; the first is on line 2",
        ],
    );
    check_faults("(a: 1, b: (a: 1), a: 2)", &["1:19 duplicate field a; the first is on line 1"]);
    check_faults(
        "{1: 1, 0x1: 2, true: 1, true: 2}",
        &[
            "1:8 duplicate key 0x1; the first is on line 1",
            "1:25 duplicate key true; the first is on line 1",
        ],
    );
}

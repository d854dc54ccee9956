//! What is found in a recipe before anything runs.

use crate::toy::{LIBRARY, Shop, lines, recipe, told, value};
use carvegraph_core::{Graph, InputFile, Origin, Recipe, source::Source};
use std::time::{Duration, Instant};

#[track_caller]
fn check_set(shop: &Shop, text: &str, set: &[&str], expected: &[&str]) {
    match shop.graph_with(text, set) {
        Ok(_) => panic!("nothing is wrong with {text} {set:?}"),
        Err(faults) => assert_eq!(lines(&faults), expected, "{text} {set:?}"),
    }
}

#[track_caller]
fn check(nodes: &str, expected: &[&str]) {
    check_set(&Shop::new(), &recipe(nodes, r#""z""#), &[], expected);
}

/// Checks the faults of one parameter of the kind `tool`, in a recipe and on the command line.
#[track_caller]
fn check_param(field: &str, literal: &str, word: &str, expected: &str) {
    let nodes = format!(r#""z": (kind: "tool", set: {{"{field}": {literal}}})"#);
    let column = nodes.find(": {\"").unwrap() + field.len() + 8;
    check(&nodes, &[&format!(r#"2:{column} node "z": {expected}"#)]);
    let nodes = recipe(r#""z": (kind: "tool")"#, r#""z""#);
    let place = format!("--set:1:{}", field.len() + 4);
    let expected = format!(r#"{place} node "z": {expected}"#);
    check_set(&Shop::new(), &nodes, &[&format!("z.{field}={word}")], &[&expected]);
}

/// Checks what the kind `tool` makes of settings.
#[track_caller]
fn check_tool(set: &str, words: &[&str], expected: &str) {
    let text = recipe(&format!(r#""z": (kind: "tool", set: {{{set}}})"#), r#""z""#);
    let graph = Shop::new().graph_with(&text, words).unwrap_or_else(|faults| panic!("{faults}"));
    let values = ["diameter", "feed", "kernel", "on", "title", "style", "dialect"];
    let values = values.map(|name| graph.nodes[0].values.get(name).to_string());
    assert_eq!(values.join(" "), expected);
}

#[test]
fn parameters_have_their_defaults_units_and_words() {
    check_tool("", &[], "6 600 5 false tool to_and_fro grbl");
    check_tool(
        r#""diameter": "0.25in", "feed": "10mm/s", "kernel": 7.0, "on": true, "title": "5", "style": "one_way", "dialect": "fanuc""#,
        &[],
        "6.35 600 7 true 5 one_way fanuc",
    );
    check_tool(
        "",
        &["z.diameter=1cm", "z.kernel=9 px", "z.on=true", "z.title=a=b", "z.style=none"],
        "10 600 9 true a=b none grbl",
    );
    check_tool("", &["z.title=", "z.kernel=1", "z.kernel=3"], "6 600 3 false  to_and_fro grbl");
}

#[test]
fn values_out_of_range_are_refused() {
    check_param("diameter", "0", "0", "diameter must be between 0.1 and 50 mm, not 0");
    check_param("diameter", "\"1m\"", "1m", "diameter must be between 0.1 and 50 mm, not 1000");
    check_param("feed", "0.0", "0", "feed must be more than 0 mm/min, not 0");
    check_param("feed", "20001", "20001", "feed must be at most 20000 mm/min, not 20001");
    check_param("kernel", "257", "257", "kernel must be between 1 and 255 px, not 257");
    check_param("kernel", "-1", "-1", "kernel must be between 1 and 255 px, not -1");
    check_param("kernel", "4", "4", "kernel must be odd, not 4; take 3 or 5");
    check_param("kernel", "4.5", "4.5", "kernel must be a whole number, not 4.5");
}

#[test]
fn numbers_that_are_none_are_refused() {
    let infinite = "diameter: \"inf\" is not a finite number";
    check_param("diameter", "\"inf\"", "inf", infinite);
    check_param("diameter", "\"NaN\"", "NaN", "diameter: \"NaN\" is not a finite number");
    check_param("diameter", "\"1e999\"", "1e999", "diameter: \"1e999\" is not a finite number");
    let lengths = "a length is wanted: mm, cm, m, um, in, thou, ft";
    check_param("diameter", "\"\"", "", &format!("diameter: \"\" is not a number; {lengths}"));
    check_param(
        "diameter",
        "\"5mm/min\"",
        "5mm/min",
        &format!("diameter: \"5mm/min\" is a feed; {lengths}"),
    );
    let literal = |literal: &str, message: &str| {
        let nodes = format!(r#""z": (kind: "tool", set: {{"diameter": {literal}}})"#);
        check(&nodes, &[&format!(r#"2:39 node "z": {message}"#)]);
    };
    literal("inf", "diameter must be a finite number, not inf");
    literal("NaN", "diameter must be a finite number, not NaN");
    literal("true", "diameter must be a number, not true or false");
}

#[test]
fn words_that_are_none_are_refused() {
    check_param(
        "style",
        "\"oneway\"",
        "oneway",
        "style cannot be \"oneway\"; did you mean \"one_way\"? It is one of one_way, to_and_fro, none",
    );
    check_param(
        "dialect",
        "\"heidenhain\"",
        "heidenhain",
        "dialect cannot be \"heidenhain\"; it is one of fanuc, grbl",
    );
    let text = recipe(r#""z": (kind: "tool", set: {"on": "true"})"#, r#""z""#);
    let (literal, word) = ("2:33 node \"z\": on", "--set:1:6 node \"z\": on");
    check_set(&Shop::new(), &text, &[], &[&format!("{literal} must be true or false, not a text")]);
    let word = format!("{word} must be true or false, not \"yes\"");
    check_set(&Shop::new(), &text, &["z.on=yes"], &[&word]);
    let literal = |set: &str, message: &str| {
        check(&format!(r#""z": (kind: "tool", set: {{{set}}})"#), &[message]);
    };
    literal(
        "\"style\": none",
        r#"2:36 node "z": style must be a text in double quotes, not a bare word; write "none""#,
    );
    literal("\"on\": 1", r#"2:33 node "z": on must be true or false, not a whole number"#);
    literal(
        "\"title\": 5",
        r#"2:36 node "z": title must be a text in double quotes, not a whole number; write "5""#,
    );
}

#[test]
fn unknown_kinds_fields_and_ports_are_told_with_what_was_meant() {
    check(
        r#""a": (kind: "nmber"), "b": (kind: "number", set: {"valeu": 1}),
"z": (kind: "add", from: {"c": "b"})"#,
        &[
            r#"2:13 there is no kind of node called "nmber"; did you mean "number"?"#,
            r#"2:51 node "b" (number) has no parameter "valeu"; did you mean "value"?"#,
            r#"3:27 node "z" (add) has no input "c"; there is a, b"#,
        ],
    );
}

#[test]
fn sources_that_are_not_there_are_told() {
    check(
        r#""number": (kind: "number"), "s": (kind: "split", from: {"number": "nmber"}),
"t": (kind: "split", from: {"number": "number.low"}),
"z": (kind: "add")"#,
        &[
            r#"2:67 there is no node "nmber"; did you mean "number"?"#,
            r#"3:39 node "number" (number) has no output "low"; there is number"#,
            r#"4:1 node "z" (add) needs its input "a"; add from: { "a": "NODE" } with a node that gives a number"#,
        ],
    );
    let text = recipe(r#""a": (kind: "number")"#, r#""b", "a.low""#);
    check_set(
        &Shop::new(),
        &text,
        &[],
        &[
            r#"3:14 there is no node "b"; there is a"#,
            r#"3:19 node "a" (number) has no output "low"; there is number"#,
        ],
    );
}

#[test]
fn an_output_is_picked_by_its_type() {
    let shop = Shop::new();
    let nodes = |feed: &str| {
        recipe(
            &format!(
                r#""n": (kind: "number", set: {{"value": 8}}), "s": (kind: "split", from: {{"number": "n"}}),
"z": (kind: "save", from: {{{feed}}})"#
            ),
            r#""z""#,
        )
    };
    for (feed, saved) in
        [(r#""text": "s""#, "8"), (r#""number": "s.low""#, "4"), (r#""number": "s.high""#, "16")]
    {
        let report = shop.run(&nodes(feed));
        assert_eq!(told(&report), "n ran, s ran, z ran");
        assert_eq!(shop.read("toy.txt").as_deref(), Some(saved));
    }
    check_set(
        &shop,
        &nodes(r#""number": "s""#),
        &[],
        &[
            r#"3:38 input "number" of node "z" could read several outputs of "s"; name one as s.PORT: low (number), high (number)"#,
        ],
    );
    check_set(
        &shop,
        &nodes(r#""text": "n""#),
        &[],
        &[r#"3:36 input "text" of node "z" wants a words, but "n" gives number (number)"#],
    );
    check_set(
        &shop,
        &nodes(r#""text": "s.low""#),
        &[],
        &[r#"3:36 input "text" of node "z" wants a words, but "s.low" gives low (number)"#],
    );
}

#[test]
fn loops_are_named() {
    let add = |id: &str, from: &str| format!(r#""{id}": (kind: "add", from: {{"a": "{from}"}}),"#);
    let help = "take one of these wires out";
    let told = |nodes: &str, place: &str, names: &str| {
        let message = format!("these nodes wait for each other in a loop: {names}; {help}");
        check(nodes, &[&format!("{place} {message}")]);
    };
    told(&add("z", "z"), "2:1", "z -> z");
    told(&(add("a", "z") + "\n" + &add("z", "a")), "2:1", "a -> z -> a");
    // The node before the loop is no part of it, nor is the one behind.
    let nodes = add("z", "c") + &add("c", "b") + &add("b", "a") + "\n" + &add("a", "c");
    told(&nodes, "2:38", "c -> a -> b -> c");
    let long: String =
        (0..50).map(|at| add(&format!("n{at}"), &format!("n{}", (at + 1) % 50))).collect();
    let z = r#""z": (kind: "number")"#;
    told(
        &(long + z),
        "2:1",
        "n0 -> n49 -> n48 -> n47 -> n46 -> n45 -> n44 -> n43 -> n42 -> n41 -> n40 -> ... -> n0",
    );
    check(
        &(add("a", "a") + "\n" + &add("b", "b") + z),
        &[
            &format!("2:1 these nodes wait for each other in a loop: a -> a; {help}"),
            &format!("3:1 these nodes wait for each other in a loop: b -> b; {help}"),
        ],
    );
}

const KNOBS: &str = r#"(format: 1,
params: {"both": (sets: ["a.value", "b.value"]), "lost": (sets: ["c.value", "a.size", "a"])},
nodes: {"a": (kind: "number", set: {"value": 5}), "b": (kind: "number"),
"z": (kind: "add", from: {"a": "a", "b": "b"})}, outputs: ["z"])"#;

#[test]
fn a_knob_drives_fields_before_recipe_and_default() {
    let shop = Shop::new();
    let text = KNOBS.replace(r#", "lost": (sets: ["c.value", "a.size", "a"])"#, "");
    let sum = |set: &[&str]| {
        let graph = shop.graph_with(&text, set).unwrap_or_else(|faults| panic!("{faults}"));
        let values = graph.nodes.iter().take(2).map(|node| node.values.get("value").to_string());
        values.collect::<Vec<_>>().join(" ")
    };
    assert_eq!(sum(&[]), "5 1");
    assert_eq!(sum(&["both=7"]), "7 7");
    assert_eq!(sum(&["a.value=9"]), "9 1");
    assert_eq!(sum(&["both=7", "b.value=8"]), "7 8");
    assert_eq!(sum(&["b.value=8", "both=7"]), "7 7");
    assert_eq!(value(&shop.run(&text), "z"), 6.0);
}

#[test]
fn knobs_and_settings_of_what_is_not_there_are_told() {
    check_set(
        &Shop::new(),
        KNOBS,
        &[],
        &[
            r#"2:66 there is no node "c"; there is a, b, z"#,
            r#"2:77 node "a" (number) has no parameter "size"; there is value"#,
            r#"2:87 "a" names no field: write node.field"#,
        ],
    );
    let text = KNOBS.replace(r#", "lost": (sets: ["c.value", "a.size", "a"])"#, "");
    check_set(
        &Shop::new(),
        &text,
        &["bothe=1", "a.valeu=1", "zz.value=1", "z/a.value=1", "a.value=x", "both="],
        &[
            r#"--set:1:1 the recipe has no parameter "bothe"; did you mean "both"?"#,
            r#"--set:1:1 node "a" (number) has no parameter "valeu"; did you mean "value"?"#,
            r#"--set:1:1 there is no node "zz"; did you mean "z"?"#,
            r#"--set:1:1 there is no node "z/a"; there is a, b, z"#,
            r#"--set:1:6 node "a": value: "" is not a number; a plain number is wanted, without unit"#,
            r#"--set:1:6 node "b": value: "" is not a number; a plain number is wanted, without unit"#,
        ],
    );
}

#[test]
fn a_parameter_without_default_must_be_set() {
    check(r#""z": (kind: "load")"#, &[r#"2:1 node "z": parameter "path" must be set (The file.)"#]);
}

#[test]
fn parameters_that_contradict_each_other_are_told() {
    check(
        r#""z": (kind: "fail", set: {"how": "conflict"})"#,
        &[r#"2:34 node "z": it cannot be so"#],
    );
}

#[test]
fn paths_start_where_they_were_written() {
    let shop = Shop::new();
    shop.write("a.txt", "recipe");
    shop.write("current/a.txt", "command line");
    let text = recipe(r#""z": (kind: "load", set: {"path": "a.txt"})"#, r#""z""#);
    let path = |set: &[&str]| {
        let graph = shop.graph_with(&text, set).unwrap_or_else(|faults| panic!("{faults}"));
        graph.nodes[0].files().next().unwrap().path().to_owned()
    };
    assert_eq!(path(&[]), shop.path("a.txt"));
    assert_eq!(path(&["z.path=a.txt"]), shop.path("current/a.txt"));
    assert_eq!(path(&["z.path=../a.txt"]), shop.path("current/../a.txt"));
    let built_in = LIBRARY.open("built_in", &Origin::BuiltIn).unwrap();
    assert!(Graph::build(&built_in, &[], &shop.registry, &LIBRARY).is_ok());
}

#[test]
fn a_file_that_may_be_left_out_does_not_name_the_work() {
    let shop = Shop::new();
    shop.write("a.txt", "text");
    shop.write("current/head.txt", "head");
    let text = recipe(r#""z": (kind: "load", set: {"path": "a.txt"})"#, r#""z""#);
    for (set, files) in
        [(&[][..], &["a"][..]), (&["z.head=none"], &["a"]), (&["z.head=head.txt"], &["head", "a"])]
    {
        let graph = shop.graph_with(&text, set).unwrap_or_else(|faults| panic!("{faults}"));
        let node = &graph.nodes[0];
        assert_eq!(node.files().map(InputFile::stem).collect::<Vec<_>>(), files);
        assert_eq!(node.prefix, "a");
    }
    let missing = lines(&shop.graph_with(&text, &["z.head=none.txt"]).err().unwrap()).join("");
    assert!(missing.contains("there is no file"), "{missing}");
}

#[test]
fn files_are_looked_at_before_anything_runs() {
    let shop = Shop::new();
    shop.write("empty", "");
    shop.write("folder/file", "x");
    #[cfg(unix)]
    assert!(
        std::process::Command::new("mkfifo").arg(shop.path("pipe")).status().unwrap().success()
    );
    let text = |path: &str| {
        recipe(&format!(r#""z": (kind: "load", set: {{"path": {path:?}}})"#), r#""z""#)
    };
    let refused = |path: &str, message: &str| {
        let faults = shop.graph_with(&text(path), &[]).err().unwrap();
        let folder = format!("{}/", shop.path("").display()).replace("//", "/");
        let told = lines(&faults).join("\n").replace(&folder, "");
        assert_eq!(told, format!(r#"2:35 node "z": {message}"#));
    };
    let help =
        "a path in a recipe starts at the recipe's folder, one after --set at the current one";
    refused("", "path names no file");
    refused("empty", "empty is empty (0 bytes)");
    refused("folder", "folder is not a plain file");
    refused("missing", &format!("there is no file missing; {help}"));
    refused("folder/file/x", "cannot read folder/file/x: Not a directory (os error 20)");
    refused("\u{1b}[2J", &format!("there is no file \u{fffd}[2J; {help}"));
    #[cfg(unix)]
    refused("pipe", "pipe is not a plain file");
    let built_in = |path: &str| {
        let recipe =
            Recipe::read("toy", Source::new("toy.ron", text(path)), Origin::BuiltIn).unwrap();
        Graph::build(&recipe, &[], &shop.registry, &LIBRARY)
            .map(drop)
            .map_err(|f| lines(&f).join(""))
    };
    assert_eq!(built_in("a.txt"), Ok(()));
    // Not even one that is there on disk.
    assert!(built_in("/etc/passwd").unwrap_err().contains("there is no file /etc/passwd"));
}

#[test]
fn shut_gates_let_optional_readers_go_on_and_stop_others() {
    let nodes = |input: &str| {
        recipe(
            &format!(
                r#""n": (kind: "number"), "g": (kind: "gate", from: {{"number": "n"}}, set: {{"open": false}}),
"m": (kind: "number"), "z": (kind: "add", from: {{{input}}})"#
            ),
            r#""z""#,
        )
    };
    let shop = Shop::new();
    let report = shop.run(&nodes(r#""a": "m", "b": "g""#));
    let no = "no output needs it";
    assert_eq!(told(&report), format!("g skipped: {no}, m ran, n skipped: {no}, z ran"));
    assert_eq!(value(&report, "z"), 1.0);
    check_set(
        &shop,
        &nodes(r#""a": "g", "b": "m""#),
        &[],
        &[r#"3:24 port "a" of node "z" needs "g", which makes nothing: it is shut"#],
    );
}

#[test]
fn many_faults_are_told_fast() {
    let nodes: String = (0..10_000)
        .map(|at| {
            format!(
                "\"node-{at}\": (kind: \"add\", from: {{\"a\": \"nodes-{at}\", \"c\": \"x\"}}),\n"
            )
        })
        .collect();
    let shop = Shop::new();
    let start = Instant::now();
    let faults = shop.graph_with(&recipe(&nodes, "\"nodes-1\""), &[]).err().unwrap();
    let text = faults.to_string();
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
    assert_eq!(faults.len(), 20_001);
    assert!(text.ends_with("and 19951 more\n"), "{text}");
}

//! Output files: whole or not at all, and nowhere else.

use crate::toy::{Shop, files, recipe, told};
use carvegraph_core::{
    MemoryCache, NodeStatus, Origin, OutputName, Plan, RunOptions, RunStatus, Session,
};
use std::fs;
use std::path::PathBuf;

fn saver(id: &str, set: &str) -> String {
    format!(r#""{id}": (kind: "save", from: {{"number": "n"}}, set: {{{set}}}),"#)
}

fn savers(nodes: &str, outputs: &str) -> String {
    recipe(&format!(r#""n": (kind: "number", set: {{"value": 7}}), {nodes}"#), outputs)
}

#[test]
fn names_stay_in_the_output_folder() {
    let check = |name: &str, expected: &str| {
        let found = match OutputName::new(name) {
            Ok(_) => "fine".to_owned(),
            Err(fault) => fault.to_string(),
        };
        assert!(found.contains(expected), "{name:?}: {found}");
    };
    for name in ["part", "{prefix}", "a {prefix}_b", "Über-1.5(2)+", "a.b", &"x".repeat(100)] {
        check(name, "fine");
    }
    for name in ["..", ".", "a/b", "/etc/passwd", "../x", "a\\b", "C:x", "{prefix}/x", "a:b"] {
        check(name, "would leave the output folder");
    }
    let unfit = [
        "",
        " ",
        ".hidden",
        "x.",
        " x",
        "x ",
        "a\0b",
        "a\nb",
        "a*b",
        "a?b",
        "<a>",
        "a|b",
        "{x}",
        "$x",
        "\u{1b}[2J",
        "con",
        "NUL",
        "nul.tar",
        "com1",
        "LPT9.x",
        "{prefix}{prefix}",
    ];
    for name in unfit {
        check(name, "is no file name");
    }
    check(&"x".repeat(101), "is no file name");
    check(&"ü".repeat(51), "is no file name");
    for name in ["console", "com", "com12", "auxiliary"] {
        check(name, "fine");
    }
}

#[test]
fn prefixes_are_harmless() {
    let stem = |path: &str| Origin::Folder(PathBuf::new()).locate(path).stem();
    let check = |path: &str, expected: &str| assert_eq!(stem(path), expected, "{path:?}");
    check("a/photo.png", "photo");
    check("photo.tar.gz", "photo.tar");
    check("Größe 2.png", "Größe 2");
    check("a:b*c.png", "a_b_c");
    check("{prefix}.png", "_prefix_");
    check("\u{1b}[2J.png", "__2J");
    check(".png", "png");
    check("..x...png", "x");
    check(" x .png", "x");
    check("", "carve");
    check("..", "carve");
    check("/", "carve");
    check("NUL.png", "NUL_");
    check("aux", "aux_");
    assert_eq!(stem(&format!("{}.png", "ü".repeat(200))), "ü".repeat(50));
    // Whatever it was, a name can be made of it.
    for path in ["con.x", "a\0b", "...", " . ", "ü.ü.ü", "\u{202e}x"] {
        assert!(OutputName::new(&stem(path)).is_ok(), "{path:?}");
    }
}

#[test]
fn files_are_named_after_the_first_file_read() {
    let shop = Shop::new();
    shop.write("my photo.txt", "x");
    let nodes = r#""l": (kind: "load", set: {"path": "my photo.txt"}), "n": (kind: "number"),
"a": (kind: "save", from: {"text": "l"}), "b": (kind: "save", from: {"number": "n"}),
"c": (kind: "save", from: {"text": "l"}, set: {"name": "{prefix}-2", "extension": "nc"})"#;
    let report = shop.run(&recipe(nodes, r#""a", "b", "c""#));
    assert_eq!(files(&report), ["my photo.txt", "toy.txt", "my photo-2.nc"]);
    assert_eq!(shop.outputs().unwrap(), ["my photo-2.nc", "my photo.txt", "toy.txt"]);
}

#[test]
fn a_file_about_the_run_is_called_like_its_outputs_or_like_the_recipe() {
    let shop = Shop::new();
    shop.write("photo.txt", "x");
    let nodes = r#""l": (kind: "load", set: {"path": "photo.txt"}), "n": (kind: "number"),
"a": (kind: "save", from: {"text": "l"}), "b": (kind: "save", from: {"text": "l"}, set: {"name": "{prefix}-2"}),
"c": (kind: "save", from: {"number": "n"})"#;
    assert_eq!(shop.graph(&recipe(nodes, r#""a""#)).prefix(), "toy");
    let (alike, _) = nodes.split_once(",\n\"c\"").unwrap();
    assert_eq!(shop.graph(&recipe(alike, r#""a", "b""#)).prefix(), "photo");
}

#[test]
fn a_report_knows_the_contents_of_what_was_read_and_written_cached_or_not() {
    let shop = Shop::new();
    shop.write("photo.txt", "xyz");
    let nodes = r#""l": (kind: "load", set: {"path": "photo.txt"}),
"a": (kind: "save", from: {"text": "l"})"#;
    let cache = MemoryCache::new(1 << 20);
    let hash = |text: &[u8]| blake3::hash(text).to_hex().to_string();
    for _ in 0..2 {
        let report = shop.run_cached(&recipe(nodes, r#""a""#), Some(&cache));
        let [read] = &report.read[..] else { panic!("{:?}", report.read) };
        assert!(read.path.ends_with("photo.txt"), "{}", read.path);
        assert_eq!((read.bytes, &read.blake3), (3, &hash(b"xyz")));
        let [(node, file)] = &report.written[..] else { panic!("{:?}", report.written) };
        let text = shop.read("photo.txt").unwrap();
        assert_eq!((&node[..], &file.name[..]), ("a", "photo.txt"));
        assert_eq!((file.bytes, &file.blake3), (text.len() as u64, &hash(text.as_bytes())));
    }
}

#[test]
fn extensions_are_plain() {
    for extension in ["", "a/b", "..", "t.xt", "n c", "/../../x"] {
        let shop = Shop::new();
        let report =
            shop.run(&savers(&saver("s", &format!("\"extension\": {extension:?}")), r#""s""#));
        assert!(told(&report).contains("is no file name"), "{}", told(&report));
        assert_eq!(shop.outputs(), None);
    }
}

#[test]
fn a_file_appears_whole_or_not_at_all() {
    let big = "\"padding\": 3000000";
    for (trouble, reason) in [("half", "half-way"), ("late", "too late"), ("panic", "half-way")] {
        let shop = Shop::new();
        shop.write("out/old.txt", "old");
        let nodes = saver("good", big)
            + &saver("bad", &format!("{big}, \"name\": \"old\", \"trouble\": {trouble:?}"));
        let report = shop.run(&savers(&nodes, r#""good", "bad""#));
        assert_eq!(report.status, RunStatus::Failed);
        assert!(report.nodes["bad"].reason.as_ref().unwrap().contains(reason));
        assert_eq!(shop.outputs().unwrap(), ["old.txt", "toy.txt"]);
        assert_eq!(shop.read("old.txt").as_deref(), Some("old"));
        assert_eq!(shop.read("toy.txt").unwrap().len(), 3_000_001);
    }
}

#[test]
fn the_folder_is_made_and_taken_away_again_if_nothing_comes() {
    let shop = Shop::new();
    let deep = shop.path("deep/er/out");
    let run = |text: &str| {
        let graph = shop.graph(text);
        let plan = Plan::new(&graph, &[], &deep, None, &Default::default()).unwrap();
        let options = RunOptions { threads: 2, cache: None, observer: &() };
        carvegraph_core::run(&plan, &Session::new(&deep), options)
    };
    let failing = savers(&saver("s", "\"trouble\": \"half\""), r#""s""#);
    assert_eq!(run(&failing).status, RunStatus::Failed);
    assert!(!shop.path("deep").exists());
    assert_eq!(run(&savers(&saver("s", ""), r#""s""#)).status, RunStatus::Done);
    assert!(deep.join("toy.txt").exists());
    // One that was there before stays.
    fs::remove_file(deep.join("toy.txt")).unwrap();
    assert_eq!(run(&failing).status, RunStatus::Failed);
    assert!(deep.exists());
}

#[test]
fn of_two_nodes_with_one_name_the_first_has_it() {
    for (first, second) in [("part", "part"), ("Part", "pART"), ("Ü", "ü")] {
        for _ in 0..8 {
            let shop = Shop::new();
            // The first one takes longer, so that the second one is there before it mostly.
            let slow = r#""slow": (kind: "slow", set: {"time": 5}),
"s": (kind: "save", from: {"number": "slow"}, set: {"name": "FIRST"}),"#;
            let nodes = slow.replace("FIRST", first)
                + &saver("t", &format!("\"name\": {second:?}"))
                + &saver("u", "\"name\": \"other\"");
            let report = shop.run(&savers(&nodes, r#""s", "t", "u""#));
            assert_eq!(report.status, RunStatus::Failed);
            let message = report.nodes["t"].reason.as_ref().unwrap();
            assert!(message.ends_with(
                ".txt is already written by node \"s\": give one of them another file name"
            ));
            assert_eq!(report.nodes["t"].status, NodeStatus::Failed);
            assert_eq!(files(&report), [format!("{first}.txt"), "other.txt".to_owned()]);
            assert_eq!(shop.read(&format!("{first}.txt")).as_deref(), Some("5"));
        }
    }
}

#[test]
fn inputs_are_never_replaced() {
    let shop = Shop::new();
    shop.write("out/photo.txt", "precious");
    let nodes = r#""l": (kind: "load", set: {"path": "out/../out/photo.txt"}),
"s": (kind: "save", from: {"text": "l"})"#;
    let report = shop.run(&recipe(nodes, r#""s""#));
    assert!(
        told(&report).contains("photo.txt would take the place of a file that the recipe reads")
    );
    assert_eq!(shop.read("photo.txt").as_deref(), Some("precious"));
}

#[test]
fn files_replace_older_ones_but_not_folders() {
    let shop = Shop::new();
    shop.write("out/toy.txt", "old");
    let text = savers(&saver("s", ""), r#""s""#);
    assert_eq!(shop.run(&text).status, RunStatus::Done);
    assert_eq!(shop.read("toy.txt").as_deref(), Some("7"));

    let shop = Shop::new();
    shop.write("out/toy.txt/x", "a folder");
    let nodes = saver("a", "\"name\": \"other\"") + &saver("s", "");
    let report = shop.run(&savers(&nodes, r#""a", "s""#));
    assert_eq!(report.status, RunStatus::Failed);
    assert!(report.trouble.unwrap().ends_with("toy.txt: there is a folder of this name"));
    // All or nothing: the other one is not there either.
    assert_eq!(shop.outputs().unwrap(), ["toy.txt"]);
}

#[cfg(unix)]
#[test]
fn files_are_as_readable_as_any_others() {
    use std::os::unix::fs::PermissionsExt;
    let shop = Shop::new();
    shop.write("plain", "");
    shop.run(&savers(&saver("s", ""), r#""s""#));
    let mode = |path: PathBuf| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(shop.out().join("toy.txt")), mode(shop.path("plain")));
}

#[test]
fn a_folder_that_cannot_be_made_is_told() {
    let shop = Shop::new();
    shop.write("out", "a file");
    let report = shop.run(&savers(&saver("s", ""), r#""s""#));
    assert!(told(&report).contains("cannot write"), "{}", told(&report));
    assert_eq!(report.status, RunStatus::Failed);
}

#[test]
fn abandoning_takes_away_what_is_being_written() {
    let shop = Shop::new();
    let nodes = saver("s", "\"padding\": 2000000000");
    let graph = shop.graph(&savers(&nodes, r#""s""#));
    let plan = Plan::new(&graph, &[], &shop.out(), None, &Default::default()).unwrap();
    let session = Session::new(&shop.out());
    let stopper = session.clone();
    let out = shop.out();
    let stopping = std::thread::spawn(move || {
        let written = || fs::read_dir(&out).is_ok_and(|mut files| files.next().is_some());
        while !written() {
            std::thread::yield_now();
        }
        stopper.abandon();
        fs::read_dir(&out).map_or(0, Iterator::count)
    });
    let options = RunOptions { threads: 1, cache: None, observer: &() };
    let report = carvegraph_core::run(&plan, &session, options);
    assert_eq!(stopping.join().unwrap(), 0);
    assert_eq!(report.status, RunStatus::Interrupted);
    assert_eq!(shop.outputs(), None);
}

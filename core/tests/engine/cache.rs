//! What is kept from one run to the next.

use crate::toy::{Lab, Shop, catalogs, files, kinds, recipe, told, types, value};
use carvegraph_core::{Cache, DiskCache, MemoryCache, Plan, Registry, RunReport, RunStatus, Step};
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

const CHAIN: &str = r#""l": (kind: "load", set: {"path": "a.txt"}),
"n": (kind: "number", set: {"value": 2}), "m": (kind: "add", from: {"a": "n"}),
"s": (kind: "save", from: {"number": "m"}), "t": (kind: "save", from: {"text": "l"}, set: {"name": "copy"})"#;

fn chain() -> String {
    recipe(CHAIN, r#""s", "t""#)
}

fn shop() -> Shop {
    let shop = Shop::new();
    shop.write("a.txt", "alpha");
    shop
}

fn disk(shop: &Shop) -> DiskCache {
    DiskCache::open(&shop.path("cache"), 1 << 20).unwrap()
}

/// What a plan does about each node: "m keeps, n runs".
fn plan(shop: &Shop, text: &str, set: &[&str], cache: &dyn Cache) -> String {
    let graph = shop.graph_with(text, set).unwrap_or_else(|faults| panic!("{faults}"));
    let plan = Plan::new(&graph, &[], &shop.out(), Some(cache), &Default::default()).unwrap();
    let step = |step: &Option<Step>| match step {
        None => "off",
        Some(Step::Run) => "runs",
        Some(Step::Load { .. }) => "loads",
        Some(Step::Keep(_)) => "keeps",
        Some(Step::Rest(_)) => "rests",
    };
    let steps = graph.nodes.iter().zip(&plan.steps);
    steps.map(|(node, at)| format!("{} {}", node.id, step(at))).collect::<Vec<_>>().join(", ")
}

const ALL_KEPT: &str = "l keeps, n keeps, m keeps, s keeps, t keeps";

/// Does the same with both caches.
fn with_each(check: impl Fn(&Shop, &dyn Cache)) {
    let memory = shop();
    check(&memory, &MemoryCache::new(1 << 20));
    let on_disk = shop();
    check(&on_disk, &disk(&on_disk));
}

#[test]
fn a_second_run_does_nothing_again() {
    with_each(|shop, cache| {
        let first = shop.run_cached(&chain(), Some(cache));
        assert_eq!(told(&first), "l ran, m ran, n ran, s ran, t ran");
        let second = shop.run_cached(&chain(), Some(cache));
        assert_eq!(told(&second), "l cached, m cached, n cached, s cached, t cached");
        let what = |report: &RunReport| {
            let nodes = report.nodes.values();
            let notes: Vec<_> = nodes.clone().map(|node| node.notes.clone()).collect();
            let facts: Vec<_> = nodes.map(|node| node.outputs.clone()).collect();
            (report.files.clone(), notes, facts)
        };
        assert_eq!(what(&first), what(&second));
        assert_eq!(files(&second), ["toy.txt", "copy.txt"]);
    });
}

#[test]
fn what_changed_and_what_reads_it_runs_again() {
    with_each(|shop, cache| {
        shop.run_cached(&chain(), Some(cache));
        let check = |set: &[&str], expected: &str| {
            assert_eq!(plan(shop, &chain(), set, cache), expected, "{set:?}");
        };
        check(&[], ALL_KEPT);
        check(&["n.value=3"], "l keeps, n runs, m runs, s runs, t keeps");
        check(&["s.name=x"], "l keeps, n keeps, m loads, s runs, t keeps");
        // Written otherwise, but the same.
        check(&["n.value=2.0"], ALL_KEPT);
        shop.write("a.txt", "beta");
        check(&[], "l runs, n keeps, m keeps, s keeps, t runs");
        shop.write("a.txt", "alpha");
        check(&[], ALL_KEPT);
        // The file's name is another, not its contents: only what is named after it runs.
        shop.write("b.txt", "alpha");
        let path = format!("l.path={}", shop.path("b.txt").display());
        check(&[&path], ALL_KEPT);
        let named = CHAIN.replace("\"copy\"", "\"{prefix}\"");
        let text = recipe(&named, r#""s", "t""#);
        shop.run_cached(&text, Some(cache));
        assert_eq!(
            plan(shop, &text, &[&path], cache),
            "l loads, n keeps, m keeps, s keeps, t runs"
        );
    });
}

#[test]
fn a_node_that_uses_the_prefix_depends_on_it() {
    let shop = shop();
    shop.write("b.txt", "alpha");
    let cache = MemoryCache::new(1 << 20);
    let text = recipe(
        r#""l": (kind: "load", set: {"path": "a.txt"}), "g": (kind: "sign", from: {"text": "l"}),
"s": (kind: "save", from: {"text": "g"}, set: {"name": "x"})"#,
        r#""s""#,
    );
    shop.run_cached(&text, Some(&cache));
    assert_eq!(shop.read("x.txt").as_deref(), Some("a: alpha"));
    let text = text.replace("a.txt", "b.txt");
    assert_eq!(told(&shop.run_cached(&text, Some(&cache))), "g ran, l cached, s ran");
    assert_eq!(shop.read("x.txt").as_deref(), Some("b: alpha"));
}

#[test]
fn versions_of_nodes_and_catalogs_count() {
    let mut shop = shop();
    let cache = disk(&shop);
    let text = recipe(
        r#""a": (kind: "tool"), "b": (kind: "tool", set: {"dialect": "fanuc"})"#,
        r#""a", "b""#,
    );
    shop.run_cached(&text, Some(&cache));
    assert_eq!(plan(&shop, &text, &[], &cache), "a keeps, b keeps");
    shop.registry =
        Registry::new(kinds(), types(), catalogs(&Arc::new(Lab::default()), "2")).unwrap();
    assert_eq!(plan(&shop, &text, &[], &cache), "a runs, b keeps");
    let mut newer = kinds();
    newer.iter_mut().for_each(|kind| kind.version += 1);
    shop.registry = Registry::new(newer, types(), catalogs(&Arc::default(), "1")).unwrap();
    assert_eq!(plan(&shop, &text, &[], &cache), "a runs, b runs");
}

#[test]
fn a_loaded_node_lets_go_of_nothing() {
    with_each(|shop, cache| {
        let text = |extra: &str| {
            let nodes = format!(
                r#""n": (kind: "number", set: {{"value": 2}}), "m": (kind: "add", from: {{"a": "n"}}){extra}"#
            );
            recipe(&nodes, if extra.is_empty() { r#""m""# } else { r#""z""# })
        };
        shop.run_cached(&text(""), Some(cache));
        // Now both are loaded, and the one reads from the other.
        let wait =
            r#""w": (kind: "slow", set: {"time": 20}), "v": (kind: "add", from: {"a": "w"})"#;
        let z = r#""y": (kind: "add", from: {"a": "v", "b": "m"}), "z": (kind: "add", from: {"a": "y", "b": "n"})"#;
        let report = shop.run_cached(&text(&format!(", {wait}, {z}")), Some(cache));
        assert_eq!(told(&report), "m cached, n cached, v ran, w ran, y ran, z ran");
        assert_eq!(value(&report, "z"), 24.0);
    });
}

#[test]
fn facts_are_told_to_the_last_digit() {
    let shop = shop();
    let cache = disk(&shop);
    for value in
        ["0.1", "1e-7", "8.533333333333333", "-2.2250738585072014e-308", "123456789.12345678"]
    {
        let text =
            recipe(&format!(r#""n": (kind: "number", set: {{"value": {value}}})"#), r#""n""#);
        let first = shop.run_cached(&text, Some(&cache));
        let second = shop.run_cached(&text, Some(&cache));
        assert_eq!(told(&second), "n cached");
        assert_eq!(crate::toy::value(&first, "n"), crate::toy::value(&second, "n"));
    }
}

#[test]
fn a_lost_output_file_runs_its_saver_only() {
    with_each(|shop, cache| {
        shop.run_cached(&chain(), Some(cache));
        fs::remove_file(shop.out().join("toy.txt")).unwrap();
        let report = shop.run_cached(&chain(), Some(cache));
        assert_eq!(told(&report), "l cached, m cached, n cached, s ran, t cached");
        assert_eq!(shop.read("toy.txt").as_deref(), Some("2"));
        shop.write("out/copy.txt", "edited");
        let report = shop.run_cached(&chain(), Some(cache));
        assert_eq!(told(&report), "l cached, m cached, n cached, s cached, t ran");
        assert_eq!(shop.read("copy.txt").as_deref(), Some("alpha"));
        assert_eq!(files(&report), ["toy.txt", "copy.txt"]);
    });
}

#[test]
fn a_saver_that_others_read_saves_again_too() {
    with_each(|shop, cache| {
        let nodes = format!(
            r#"{CHAIN}, "u": (kind: "save", from: {{"text": "s"}}, set: {{"name": "name"}})"#
        );
        let text = recipe(&nodes, r#""u""#);
        shop.run_cached(&text, Some(cache));
        assert_eq!(shop.read("name.txt").as_deref(), Some("toy.txt"));
        fs::remove_file(shop.out().join("toy.txt")).unwrap();
        let kept = "l off, n keeps, m loads, s runs, u keeps, t off";
        assert_eq!(
            plan(shop, &text, &[], cache).replace(", t off, u keeps", ", u keeps, t off"),
            kept
        );
        shop.run_cached(&text, Some(cache));
        assert_eq!(shop.read("toy.txt").as_deref(), Some("2"));
        // Wanted itself and read by one that runs.
        fs::remove_file(shop.out().join("toy.txt")).unwrap();
        fs::remove_file(shop.out().join("name.txt")).unwrap();
        let report = shop.run_cached(&recipe(&nodes, r#""u", "s""#), Some(cache));
        assert_eq!(files(&report), ["toy.txt", "name.txt"]);
        assert_eq!(shop.outputs().unwrap(), ["name.txt", "toy.txt"]);
    });
}

#[test]
fn a_name_that_a_kept_file_has_is_taken() {
    with_each(|shop, cache| {
        shop.run_cached(&chain(), Some(cache));
        let nodes = format!(
            r#"{CHAIN}, "v": (kind: "save", from: {{"text": "l"}}, set: {{"name": "TOY"}})"#
        );
        let report = shop.run_cached(&recipe(&nodes, r#""s", "v""#), Some(cache));
        let message = "v failed: TOY.txt is already written by node \"s\"";
        assert!(told(&report).contains(message), "{}", told(&report));
        assert_eq!(shop.read("toy.txt").as_deref(), Some("2"));
    });
}

#[test]
fn failures_are_not_kept() {
    with_each(|shop, cache| {
        let text = recipe(r#""f": (kind: "fail"), "n": (kind: "number")"#, r#""f", "n""#);
        shop.run_cached(&text, Some(cache));
        let report = shop.run_cached(&text, Some(cache));
        assert_eq!(told(&report), "f failed: as it should, n cached");
        assert_eq!(report.status, RunStatus::Failed);
    });
}

#[test]
fn a_file_that_changes_during_a_run_fails_its_reader() {
    let shop = shop();
    let cache = MemoryCache::new(1 << 20);
    let graph = shop.graph(&chain());
    let plan = Plan::new(&graph, &[], &shop.out(), Some(&cache), &Default::default()).unwrap();
    shop.write("a.txt", "omega");
    let report = shop.run_plan(&plan, Some(&cache));
    assert!(told(&report).contains("a.txt was changed while the recipe ran"), "{}", told(&report));
    assert_eq!(
        told(&shop.run_cached(&chain(), Some(&cache))),
        "l ran, m cached, n cached, s cached, t ran"
    );
    assert_eq!(shop.read("copy.txt").as_deref(), Some("omega"));
}

/// The only entry on disk of a recipe with one node.
fn entry(shop: &Shop) -> PathBuf {
    let files = fs::read_dir(shop.path("cache")).unwrap();
    let mut paths = files.map(|file| file.unwrap().path());
    paths.find(|path| path.extension().is_some_and(|end| end == "entry")).unwrap()
}

#[test]
fn entries_that_are_not_as_written_are_made_again() {
    let text = recipe(r#""n": (kind: "number", set: {"value": 3})"#, r#""n""#);
    // A second node that reads the first one, so that its value is loaded.
    let reader = recipe(
        r#""n": (kind: "number", set: {"value": 3}), "z": (kind: "add", from: {"a": "n"})"#,
        r#""z""#,
    );
    let check = |spoil: &dyn Fn(&mut Vec<u8>)| {
        let shop = shop();
        let cache = disk(&shop);
        shop.run_cached(&text, Some(&cache));
        let path = entry(&shop);
        let mut bytes = fs::read(&path).unwrap();
        spoil(&mut bytes);
        fs::write(&path, bytes).unwrap();
        let report = shop.run_cached(&reader, Some(&cache));
        assert_eq!((told(&report).as_str(), value(&report, "z")), ("n ran, z ran", 3.0));
        assert_eq!(told(&shop.run_cached(&text, Some(&cache))), "n cached");
    };
    check(&|bytes| bytes.clear());
    check(&|bytes| bytes[0] ^= 1);
    check(&|bytes| bytes[9] ^= 0xff);
    check(&|bytes| bytes[15] = 0xff);
    check(&|bytes| bytes[40] ^= 1);
    check(&|bytes| *bytes = vec![0; 1000]);
    check(&|bytes| *bytes = b"CARVECA2".repeat(100));
    // Each byte of the tail: the value, its length, the hash.
    for back in 1..=48 {
        check(&|bytes| {
            let at = bytes.len() - back;
            bytes[at] ^= 1;
        });
    }
    for missing in [1, 32, 40, 48, 60, 100] {
        check(&|bytes| bytes.truncate(bytes.len() - missing));
    }
    check(&|bytes| bytes.push(0));
}

#[test]
fn an_entry_under_another_key_is_none() {
    let shop = shop();
    let cache = disk(&shop);
    let text = |value: u32| {
        let nodes = format!(
            r#""n": (kind: "number", set: {{"value": {value}}}), "z": (kind: "add", from: {{"a": "n"}})"#
        );
        recipe(&nodes, r#""n""#)
    };
    shop.run_cached(&text(1), Some(&cache));
    let one = entry(&shop);
    fs::rename(&one, shop.path("one")).unwrap();
    shop.run_cached(&text(2), Some(&cache));
    let two = entry(&shop);
    fs::rename(shop.path("one"), &two).unwrap();
    assert_eq!(
        told(&shop.run_cached(&text(2), Some(&cache))),
        "n ran, z skipped: no output needs it"
    );
}

#[test]
fn half_written_and_foreign_files_are_left_alone() {
    let shop = shop();
    let cache = DiskCache::open(&shop.path("cache"), 3000).unwrap();
    let foreign = ["diary.entry", "x.run", "song.part", "notes.txt", ".carve-new.part"];
    for name in foreign {
        shop.write(&format!("cache/{name}"), vec![0; 4000]);
    }
    shop.write("cache/folder.entry/x", "");
    shop.write("cache/.carve-old.part", vec![0; 4000]);
    let old = std::time::SystemTime::now() - std::time::Duration::from_secs(2 * 24 * 3600);
    let file = fs::File::options().write(true).open(shop.path("cache/.carve-old.part")).unwrap();
    file.set_modified(old).unwrap();
    for value in 0..20 {
        let text =
            recipe(&format!(r#""n": (kind: "number", set: {{"value": {value}}})"#), r#""n""#);
        assert_eq!(shop.run_cached(&text, Some(&cache)).status, RunStatus::Done);
    }
    for name in foreign {
        assert!(shop.path("cache").join(name).exists(), "{name}");
    }
    assert!(shop.path("cache/folder.entry/x").exists());
    assert!(!shop.path("cache/.carve-old.part").exists());
}

/// The bytes of the cache's own files.
fn held(shop: &Shop) -> u64 {
    let files = fs::read_dir(shop.path("cache")).unwrap();
    files.map(|file| file.unwrap().metadata().unwrap().len()).sum()
}

#[test]
fn caches_stay_within_their_bounds() {
    let text = |value: u32| {
        recipe(&format!(r#""n": (kind: "number", set: {{"value": {value}}})"#), r#""n""#)
    };
    let shop = shop();
    let cache = DiskCache::open(&shop.path("cache"), 5000).unwrap();
    for value in 0..50 {
        shop.run_cached(&text(value), Some(&cache));
        assert!(held(&shop) <= 5000);
    }
    assert!(held(&shop) > 2000, "{}", held(&shop));
    // Another one finds what is there.
    let cache = DiskCache::open(&shop.path("cache"), 3000).unwrap();
    shop.run_cached(&text(99), Some(&cache));
    assert!(held(&shop) <= 3000);

    let cache = MemoryCache::new(10_000);
    for value in 0..50 {
        shop.run_cached(&text(value), Some(&cache));
        assert!(cache.bytes() <= 10_000);
    }
    assert!(cache.bytes() > 7000);
    assert_eq!(told(&shop.run_cached(&text(49), Some(&cache))), "n cached");
}

#[test]
fn what_is_too_large_is_not_kept() {
    let shop = shop();
    shop.write("a.txt", "x".repeat(6000));
    let text = recipe(r#""l": (kind: "load", set: {"path": "a.txt"})"#, r#""l""#);
    let caches: [&dyn Cache; 2] =
        [&MemoryCache::new(5000), &DiskCache::open(&shop.path("cache"), 10_000).unwrap()];
    for cache in caches {
        shop.run_cached(&text, Some(cache));
        assert_eq!(told(&shop.run_cached(&text, Some(cache))), "l ran");
    }
}

#[test]
fn two_programs_may_share_a_folder() {
    let shop = shop();
    let (one, two) = (disk(&shop), disk(&shop));
    shop.run_cached(&chain(), Some(&one));
    assert_eq!(plan(&shop, &chain(), &[], &two), ALL_KEPT);
    fs::remove_dir_all(shop.path("cache")).unwrap();
    // A cache whose folder is gone keeps nothing, and nothing else happens.
    assert_eq!(shop.run_cached(&chain(), Some(&one)).status, RunStatus::Done);
}

#[test]
fn it_is_told_why_a_node_runs_again() {
    with_each(|shop, cache| {
        let explain = |set: &[&str], node: &str| {
            let graph = shop.graph_with(&chain(), set).unwrap();
            let plan =
                Plan::new(&graph, &[], &shop.out(), Some(cache), &Default::default()).unwrap();
            plan.explain(node, Some(cache)).unwrap().join("\n")
        };
        assert_eq!(explain(&[], "n"), "n runs\nn: no earlier run with this cache is known");
        shop.run_cached(&chain(), Some(cache));
        assert_eq!(explain(&[], "s"), "s is cached and nothing that runs reads it");
        assert_eq!(
            explain(&["n.value=3"], "s"),
            "s runs\ns: input number changed, since m did\nm runs\nm: input a changed, since n did\n\
             n runs\nn: parameter value was 2, is 3"
        );
        assert_eq!(explain(&["s.name=x"], "s"), "s runs\ns: parameter name was {prefix}, is x");
        assert_eq!(explain(&["s.name=x"], "m"), "m is read from the cache");
        fs::remove_file(shop.out().join("toy.txt")).unwrap();
        assert_eq!(
            explain(&[], "s"),
            "s runs\ns: nothing changed; its values or files are gone, damaged or were too large"
        );
        shop.write("a.txt", "beta");
        let hash = |text: &str| blake3::hash(text.as_bytes()).to_hex().to_string();
        assert_eq!(
            explain(&[], "l"),
            format!("l runs\nl: contents of path was {}, is {}", hash("alpha"), hash("beta"))
        );
    });
    let shop = shop();
    let graph = shop.graph(&chain());
    let plan = Plan::new(&graph, &[], &shop.out(), None, &Default::default()).unwrap();
    assert_eq!(plan.explain("n", None).unwrap(), ["n runs: there is no cache (--cache DIR)"]);
    assert!(plan.explain("nn", None).is_err());
}

#[test]
fn a_wire_to_another_node_is_told() {
    let shop = shop();
    let cache = MemoryCache::new(1 << 20);
    let text = |source: &str| {
        let nodes = format!(
            r#""n": (kind: "number"), "m": (kind: "number", set: {{"value": 2}}), "z": (kind: "add", from: {{"a": "{source}"}})"#
        );
        recipe(&nodes, r#""z", "m", "n""#)
    };
    shop.run_cached(&text("n"), Some(&cache));
    let graph = shop.graph(&text("m"));
    let plan = Plan::new(&graph, &[], &shop.out(), Some(&cache), &Default::default()).unwrap();
    assert_eq!(
        plan.explain("z", Some(&cache)).unwrap(),
        ["z runs", "z: input a is wired anew, to m"]
    );
}

#[test]
fn what_did_not_finish_is_not_remembered() {
    let shop = shop();
    let cache = MemoryCache::new(1 << 20);
    shop.run_cached(&chain(), Some(&cache));
    let before = cache.last_run("toy").unwrap();
    assert_eq!(before.keys().collect::<Vec<_>>(), ["l", "m", "n", "s", "t"]);
    let text =
        recipe(r#""l": (kind: "fail"), "n": (kind: "number", set: {"value": 4})"#, r#""l", "n""#);
    shop.run_cached(&text, Some(&cache));
    let after = cache.last_run("toy").unwrap();
    assert_eq!(after.keys().collect::<Vec<_>>(), ["l", "n"]);
    assert_eq!(after["l"], before["l"]);
    assert_eq!(after["n"]["parameter value"], "4");
}

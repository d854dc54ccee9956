//! Bad input, each with a clear error that names the place, the right exit status, and nothing
//! written: not a file, not the output folder, not a folder on the way to it.
//!
//! 2: the recipe or the call is wrong, or a parameter is absurd for the job. 1: a node failed, on a
//! file that cannot be what it says.

use crate::bench::{Bench, QUICK, recipe_text, with_diameter};
use std::time::Duration;

/// Calls `carve run`, which must fail with `status`, say all of `words` and write nothing.
#[track_caller]
fn assert_refused(bench: &Bench, arguments: &[&str], status: i32, words: &[&str]) {
    let before = bench.names();
    let answer = bench.carve(&[&["run", "--quiet", "--out", "new/out"], arguments].concat());
    for word in words {
        assert!(answer.err.contains(word), "{arguments:?} does not say {word:?}: {}", answer.err);
    }
    assert!(answer.err.starts_with("error: "), "{arguments:?}: {}", answer.err);
    assert!(!answer.err.contains("panicked"), "{arguments:?}: {}", answer.err);
    assert_eq!(answer.status, status, "{arguments:?}: {}", answer.err);
    assert_eq!(answer.out, "", "{arguments:?}");
    assert_eq!(bench.names(), before, "{arguments:?} left something");
}

#[test]
fn pictures_that_are_none() {
    let bench = Bench::new();
    bench.hills("hills.png", (60, 60));
    let whole = bench.read("hills.png");
    bench.write("truncated.png", &whole[..whole.len() / 2]);
    bench.write("head.png", &whole[..20]);
    bench.write("empty.png", "");
    bench.write("text.png", "To whom it may concern\n");
    let mut damaged = whole.clone();
    damaged[whole.len() / 2] ^= 0x55;
    bench.write("damaged.png", damaged);
    std::fs::create_dir(bench.path("folder.png")).unwrap();
    for (picture, status, word) in [
        ("missing.png", 2, "there is no file missing.png"),
        ("empty.png", 2, "empty.png is empty (0 bytes)"),
        ("folder.png", 2, "folder.png is not a plain file"),
        ("truncated.png", 1, "truncated.png is damaged or cut short"),
        ("head.png", 1, "head.png is damaged or cut short"),
        ("damaged.png", 1, "damaged.png is damaged or cut short"),
        ("text.png", 1, "text.png is no picture that can be read"),
    ] {
        let image = format!("image={picture}");
        // A wrong path is known before anything runs, and shown where it was written.
        let place = if status == 2 { "--> --set:1:7" } else { "node \"photo\" (load_image)" };
        let words = ["node \"photo\"", place, word];
        assert_refused(&bench, &["relief", "--set", &image], status, &words);
    }
}

#[test]
fn pictures_too_small_for_a_surface() {
    let bench = Bench::new();
    for size in [(1, 1), (1, 30), (30, 1)] {
        bench.picture("small.png", size, |x, y| (x + y) as u8);
        let size = format!("{} × {} px", size.0, size.1);
        let words = ["node \"relief\" (z_map)", &size, "it needs 2 × 2 px at least"];
        assert_refused(&bench, &["relief", "--set", "image=small.png"], 1, &words);
    }
}

#[test]
fn a_picture_of_one_gray_is_flat_and_warned_of() {
    let bench = Bench::new();
    bench.picture("even.png", (30, 30), |_, _| 77);
    let arguments = ["run", "relief", "--set", "image=even.png", "--report", "report.json"];
    let answer = bench.carve(&[&arguments[..], &QUICK].concat());
    assert_eq!(answer.status, 0, "{}", answer.err);
    let warning = "the picture is one even gray: the surface is flat, at z_min = 0 mm";
    assert!(answer.err.contains(&format!("warning: relief: {warning}\n")), "{}", answer.err);
    let report = bench.report();
    assert_eq!(report.node("relief")["notes"][0]["weight"], "warning");
    assert_eq!(report.node("relief")["notes"][0]["text"], warning);
    assert_eq!(report.number("relief", "surface", "z_max"), 0.0);
    assert!(!bench.text("out/even.nc").contains("NaN"));
}

#[test]
fn parameters_out_of_range() {
    let bench = Bench::new();
    bench.hills("hills.png", (20, 20));
    for (setting, words) in [
        ("diameter=0", "node \"tool\": diameter must be between 0.01 and 200 mm, not 0"),
        ("diameter=-6", "node \"tool\": diameter must be between 0.01 and 200 mm, not -6"),
        ("diameter=1e9", "node \"tool\": diameter must be between 0.01 and 200 mm"),
        ("diameter=NaN", "diameter: \"NaN\" is not a finite number"),
        ("diameter=1e999", "diameter: \"1e999\" is not a finite number"),
        ("stepover=0", "node \"passes\": stepover must be more than 0 mm, not 0"),
        ("stepover=-1", "node \"passes\": stepover must be more than 0 mm, not -1"),
        ("stepover=NaN", "stepover: \"NaN\" is not a finite number"),
        ("stepover=inf", "stepover: \"inf\" is not a finite number"),
        ("feed_step=-inf", "feed_step: \"-inf\" is not a finite number"),
        ("z_max=-1", "z_max (-1 mm) must be above z_min (0 mm)"),
        ("z_max=0", "z_max (0 mm) must be above z_min (0 mm)"),
        ("blur=4", "kernel must be odd, not 4"),
        ("blur=2.5", "kernel must be a whole number, not 2.5"),
        ("blur=0", "kernel must be between 1 and 255 px, not 0"),
        ("canvas_width=0", "canvas_width must be between 0.1 and 10000 mm, not 0"),
        ("feed=0", "feed must be between 1 and 100000 mm/min, not 0"),
        ("spindle=0", "spindle must be between 1 and 200000 rpm, not 0"),
        ("safe_z=-1", "safe_z must be between 0.1 and 500 mm, not -1"),
        ("tolerance=-1", "tolerance must be between 0 and 100 mm, not -1"),
        ("tool.diameter=0", "node \"tool\": diameter must be between 0.01 and 200 mm, not 0"),
    ] {
        let (name, value) = setting.split_once('=').unwrap();
        // The place: behind the sign of equality, and the setting quoted.
        let place = format!("--> --set:1:{}\n", name.len() + 2);
        let quoted = format!("1 | {setting}\n");
        let carets = format!("  | {:1$}{2}\n", "", name.len() + 1, "^".repeat(value.len()));
        let arguments = ["relief", "--set", "image=hills.png", "--set", setting];
        assert_refused(&bench, &arguments, 2, &[words, &place, &quoted, &carets]);
    }
}

#[test]
fn values_of_another_sort() {
    let bench = Bench::new();
    bench.hills("hills.png", (20, 20));
    for (setting, words) in [
        ("diamter=3", ["the recipe has no parameter \"diamter\"", "did you mean \"diameter\"?"]),
        ("tool.diamter=3", ["has no parameter \"diamter\"", "did you mean \"diameter\"?"]),
        ("tol.diameter=3", ["there is no node \"tol\"", "did you mean \"tool\"?"]),
        ("diameter=6furlong", ["unknown unit in \"6furlong\"", "a length is wanted: mm, cm"]),
        ("diameter=15deg", ["\"15deg\" is an angle", "a length is wanted: mm, cm"]),
        ("feed=1500rpm", ["\"1500rpm\" is a spindle speed", "a feed is wanted: mm/min"]),
        ("diameter=six", ["\"six\" is not a number", "a length is wanted"]),
        ("diameter=", ["\"\" is not a number", "a length is wanted"]),
        ("diameter=2,5", ["\"2,5\" is not a number", "a length is wanted"]),
        ("image=", ["node \"photo\"", "names no file"]),
        ("dialect=okuma", ["dialect cannot be \"okuma\"", "it is one of "]),
        ("cutter=bal", ["shape cannot be \"bal\"", "did you mean \"ball\"?"]),
        ("reduce=zband", ["method cannot be \"zband\"", "did you mean \"z_band\"?"]),
    ] {
        let arguments = ["relief", "--set", "image=hills.png", "--set", setting];
        let place = "--> --set:1:";
        assert_refused(&bench, &arguments, 2, &[words[0], words[1], place]);
    }
}

#[test]
fn more_points_than_a_machine_has_memory_for() {
    let bench = Bench::new();
    bench.hills("hills.png", (50, 50));
    // 50 px on 203 mm are 198.94 mm: 664 points on each of 1.9894e11 passes.
    let arguments = ["relief", "--set", "image=hills.png", "--set", "stepover=1e-9"];
    let words = ["node \"passes\" (raster)", "would make 1.321e14 points", "the limit is "];
    assert_refused(&bench, &arguments, 2, &words);
}

/// A change to the text of the standard recipe, and what must be said of it.
struct Slip {
    from: &'static str,
    to: &'static str,
    words: &'static [&'static str],
}

const fn slip(from: &'static str, to: &'static str, words: &'static [&'static str]) -> Slip {
    Slip { from, to, words }
}

const SLIPS: [Slip; 22] = [
    slip(
        "\"gaussian_blur\"",
        "\"gausian_blur\"",
        &["there is no kind of node called \"gausian_blur\"", "did you mean \"gaussian_blur\"?"],
    ),
    slip(
        "{ \"image\": \"gray\" }",
        "{ \"imagee\": \"gray\" }",
        &["node \"smooth\" (gaussian_blur) has no input \"imagee\"", "did you mean \"image\"?"],
    ),
    slip(
        "{ \"image\": \"gray\" }",
        "{ \"image\": \"gray.imagee\" }",
        &["node \"gray\" (grayscale) has no output \"imagee\"", "did you mean \"image\"?"],
    ),
    slip(
        "{ \"image\": \"gray\" }",
        "{ \"image\": \"grey\" }",
        &["there is no node \"grey\"", "did you mean \"gray\"?"],
    ),
    slip(
        "{ \"image\": \"gray\" }",
        "{ \"image\": \"photo\" }",
        &[
            "input \"image\" of node \"smooth\" wants a gray_image, but \"photo\" gives image (image)",
        ],
    ),
    slip(
        "from: { \"image\": \"gray\" }, ",
        "",
        &["node \"smooth\" (gaussian_blur) needs its input \"image\"", "gives a gray_image"],
    ),
    slip(
        "{ \"image\": \"gray\" }",
        "{ \"image\": \"smooth\" }",
        &["these nodes wait for each other in a loop", "smooth"],
    ),
    slip(
        "\"smooth\": (",
        "\"softer\": (kind: \"gaussian_blur\", from: { \"image\": \"softest\" }),\n\
         \"softest\": (kind: \"gaussian_blur\", from: { \"image\": \"softer\" }),\n\"smooth\": (",
        &["these nodes wait for each other in a loop: ", "softer -> softest", "take one of these"],
    ),
    slip(
        "\"points\": (kind",
        "\"gray\": (kind",
        &["duplicate key \"gray\"; the first is on line 40", "47 | "],
    ),
    slip("\"kernel\": 5", "\"kernel\": [5]", &["kernel must be a number, ", ", not a list"]),
    slip(
        "\"kernel\": 5",
        "\"kernel\": true",
        &["kernel must be a number, ", ", not true or false"],
    ),
    slip("\"kernel\": 5", "\"kernel\": \"five\"", &["\"five\" is not a number"]),
    slip("\"kernel\": 5", "\"kernel\": NaN", &["kernel must be a finite number, not NaN"]),
    slip(
        "\"xy_zero\": \"corner\"",
        "\"dialect\": 3",
        &["dialect must be a text", ", not a whole number"],
    ),
    slip("\"203mm\"", "\"203rpm\"", &["\"203rpm\" is a spindle speed; a length is wanted"]),
    slip("\"203mm\"", "\"203miles\"", &["unknown unit in \"203miles\""]),
    slip("format: 1,", "format: 999,", &["has format 999; this program reads formats up to 1"]),
    slip("format: 1,", "", &["lacks the field \"format\""]),
    slip("title:", "titel:", &["the recipe has no field \"titel\"", "did you mean \"title\"?"]),
    slip("kind: \"stitch\", ", "", &["node \"mesh\" lacks the field \"kind\""]),
    slip("[\"smooth.kernel\"]", "[\"smooth.kernl\"]", &["\"kernl\"", "did you mean \"kernel\"?"]),
    slip(
        "outputs: [\"save_gcode\"",
        "outputs: [\"save_gode\"",
        &["there is no node \"save_gode\"", "did you mean \"save_gcode\"?"],
    ),
];

/// The standard recipe beside a picture of its own.
fn bench_with_recipe(change: impl FnOnce(String) -> String) -> Bench {
    let bench = Bench::new();
    bench.hills("hills.png", (20, 20));
    bench.write(
        "mine.ron",
        change(recipe_text("relief").replace("samples/medallion.png", "hills.png")),
    );
    bench
}

#[test]
fn slips_in_recipes() {
    for Slip { from, to, words } in SLIPS {
        let bench = bench_with_recipe(|text| {
            assert!(text.contains(from), "{from:?} is no longer in the recipe");
            text.replacen(from, to, 1)
        });
        assert_refused(&bench, &["mine.ron"], 2, words);
        let answer = bench.carve(&["check", "mine.ron"]);
        assert_eq!(answer.status, 2);
        assert!(answer.err.contains("--> mine.ron:"), "no place: {}", answer.err);
    }
}

/// One slip, one error: a machinist should not have to tell a fault from what follows of it.
#[test]
fn one_slip_is_one_error() {
    for Slip { from, to, .. } in SLIPS {
        let bench = bench_with_recipe(|text| text.replacen(from, to, 1));
        let answer = bench.carve(&["check", "mine.ron"]);
        let errors = answer.err.lines().filter(|line| line.starts_with("error: ")).count();
        assert_eq!(errors, 1, "{from} -> {to}: {}", answer.err);
    }
}

#[test]
fn names_that_lead_out_of_the_output_folder() {
    for name in ["../x", "/tmp/x", "a/b", "C:\\\\x", "..", ".", "", ".hidden", "a\\u{0}b", "x\\ny"]
    {
        let bench = bench_with_recipe(|text| text.replace("{prefix}-path", name));
        assert_refused(
            &bench,
            &["mine.ron"],
            2,
            &["node \"preview_path\": name: ", "mine.ron:100:"],
        );
    }
}

#[test]
fn two_nodes_that_write_one_file() {
    // On a file system that does not tell capitals from small letters too.
    for name in ["{prefix}", "HILLS"] {
        let bench = bench_with_recipe(|text| text.replace("{prefix}-path", name));
        let answer = bench.carve(&[&["run", "mine.ron", "--quiet"][..], &QUICK].concat());
        assert_eq!(answer.status, 1, "{}", answer.err);
        assert!(answer.err.contains("is already written by node"), "{}", answer.err);
    }
}

#[test]
fn five_slips_are_five_errors_at_once() {
    let bench = bench_with_recipe(|text| {
        with_diameter(&text, "-6.0")
            .replace("\"gaussian_blur\"", "\"gausian_blur\"")
            .replace("\"pattern\": \"passes\"", "\"pattern\": \"pases\"")
            .replacen("\"203mm\"", "\"203rpm\"", 1)
            .replace("\"format\": \"binary\"", "\"formt\": \"binary\"")
    });
    let answer = bench.carve(&["run", "mine.ron"]);
    assert_eq!(answer.status, 2);
    let errors: Vec<&str> = answer.err.split("\n\n").collect();
    let text = bench.text("mine.ron");
    let slips = ["gausian_blur", "203rpm", "-6.0", "pases", "formt"];
    assert_eq!(errors.len(), slips.len(), "{}", answer.err);
    for (error, slip) in errors.iter().zip(slips) {
        // The place is where the slip begins: its line, its column, its line quoted.
        let at = text.find(slip).unwrap();
        let line = text[..at].lines().count();
        let start = text[..at].rfind('\n').unwrap() + 1;
        let quote = if text[..at].ends_with('"') { 1 } else { 0 };
        let column = text[start..at].chars().count() + 1 - quote;
        assert!(error.contains(&format!("--> mine.ron:{line}:{column}\n")), "{slip}: {error}");
        let quoted: String = text[start..].lines().next().unwrap().chars().take(90).collect();
        assert!(error.contains(&format!("{line} | {quoted}")), "{slip}: {error}");
    }
}

#[test]
fn recipes_that_are_none() {
    let bench = Bench::new();
    bench.write("empty.ron", "");
    bench.write("word.ron", "hello");
    bench.write("latin.ron", b"Recipe(format: 1, title: \"Caf\xe9\", nodes: {}, outputs: [])");
    bench.write("binary.ron", [0, 159, 146, 150, 255, 0, 13]);
    std::fs::create_dir(bench.path("folder.ron")).unwrap();
    for (recipe, words) in [
        ("empty.ron", "--> empty.ron:1:1"),
        ("word.ron", "--> word.ron:1:1"),
        ("latin.ron", "byte 29 is no UTF-8"),
        ("binary.ron", "is no UTF-8"),
        ("folder.ron", "it is not a plain file"),
        ("missing.ron", "there is no recipe \"missing.ron\""),
        ("releif", "did you mean \"relief\"?"),
    ] {
        assert_refused(&bench, &[recipe], 2, &[words]);
    }
}

#[test]
fn recipes_without_bound() {
    let bench = Bench::new();
    let text = recipe_text("relief");
    bench.write("long.ron", format!("{text}//{}", "x".repeat(10 << 20)));
    let nodes: String = (0..100_000).map(|k| format!("\"n{k}\":(kind:\"cutter\"),")).collect();
    bench.write("many.ron", format!("(format:1,nodes:{{{nodes}}},outputs:[\"n1\"])"));
    for (name, open, close) in [("list", "[", "]"), ("fields", "(a:", ")"), ("map", "{1:", "}")] {
        let (open, close) = (open.repeat(100_000), close.repeat(100_000));
        bench.write(&format!("{name}.ron"), format!("(format: 1, title: {open}1{close})"));
        bench.write(&format!("{name}-open.ron"), format!("(format: 1, title: {open}"));
    }
    assert_refused(&bench, &["long.ron"], 2, &["long.ron", "a recipe has at most 4194304"]);
    let words = ["many.ron:1:", "the recipe has 100000 nodes; the limit is 10000"];
    assert_refused(&bench, &["many.ron"], 2, &words);
    for name in ["list", "list-open", "fields", "fields-open", "map", "map-open"] {
        let words = ["brackets nest deeper than 64 levels", &format!("{name}.ron:1:")];
        assert_refused(&bench, &[&format!("{name}.ron")], 2, &words);
    }
}

/// A node that is a recipe again.
fn inner(id: &str, recipe: &str) -> String {
    format!("{id:?}: (kind: \"recipe\", set: {{ \"recipe\": {recipe:?} }})")
}

#[test]
fn a_recipe_that_uses_itself() {
    let bench = bench_with_recipe(|text| {
        text.replace(
            "\"points\": (kind",
            &format!("{},\n\"points\": (kind", inner("me", "mine.ron")),
        )
    });
    assert_refused(
        &bench,
        &["mine.ron"],
        2,
        &["use each other in a loop: mine -> mine", "mine.ron:47:"],
    );
    let answer = bench.carve(&["check", "mine.ron"]);
    assert_eq!(answer.err.matches("error: ").count(), 1, "said once: {}", answer.err);
}

/// Recipes of recipes grow by powers: ten of ten, sixteen deep, would be 10¹⁶.
#[test]
fn recipes_that_multiply() {
    let bench = Bench::new();
    let uses = |recipe: &str| {
        let nodes: Vec<String> = (0..10).map(|k| inner(&format!("n{k}"), recipe)).collect();
        format!("(format: 1, nodes: {{ {} }}, outputs: [\"n0\"])", nodes.join(", "))
    };
    bench.write("itself.ron", uses("itself.ron"));
    for k in 0..12 {
        bench.write(&format!("level{k}.ron"), uses(&format!("level{}.ron", k + 1)));
    }
    bench.write("level12.ron", "(format: 1, nodes: {\"a\": (kind: \"cutter\")}, outputs: [\"a\"])");
    // A wide one would be gigabytes of text.
    let leaf = format!(
        "(format: 1, nodes: {{\"a\": (kind: \"cutter\")}}, outputs: [\"a\"]) //{}",
        "x".repeat(3 << 20)
    );
    bench.write("leaf.ron", leaf);
    let nodes: Vec<String> = (0..2000).map(|k| inner(&format!("n{k}"), "leaf.ron")).collect();
    let wide = format!("(format: 1, nodes: {{ {} }}, outputs: [\"n0\"])", nodes.join(", "));
    bench.write("wide.ron", wide);

    for recipe in ["itself.ron", "level0.ron", "wide.ron"] {
        // It takes milliseconds; going through all of them would take years.
        let answer = bench.carve_within(Duration::from_secs(10), &["check", recipe]);
        assert_eq!(answer.status, 2, "{recipe}: {}", answer.err);
        let errors = answer.err.matches("error: ").count();
        assert!((1..=10).contains(&errors), "{recipe}: {errors} errors");
    }
}

#[test]
fn a_failing_node_takes_along_only_what_needs_it() {
    let bench = bench_with_recipe(|text| text);
    // The pictures can be drawn; the program cannot be written, grbl having no tool change.
    let arguments = ["run", "mine.ron", "--set", "post.tool=3", "--report", "report.json"];
    let answer = bench.carve(&[&arguments[..], &QUICK].concat());
    assert_eq!(answer.status, 1, "{}", answer.err);
    assert!(answer.err.contains("error: node \"post\" (post): "), "{}", answer.err);
    assert!(answer.err.contains("grbl has no tool change"), "{}", answer.err);
    let report = bench.report();
    assert_eq!(report.0["status"], "failed");
    assert_eq!(report.nodes_that("failed"), ["post"]);
    let inspection = [
        "ball",
        "carved",
        "deviation",
        "file",
        "map",
        "placed",
        "read",
        "shell",
        "simulate",
        "time",
        "verify",
    ];
    let inspection = inspection.map(|node| format!("inspection/{node}"));
    let skipped = inspection.iter().map(String::as_str);
    let skipped: Vec<&str> = skipped.chain(["save_gcode", "save_points", "summary"]).collect();
    assert_eq!(report.nodes_that("skipped"), skipped);
    let files: Vec<String> = bench.files("out").into_keys().collect();
    assert_eq!(files, ["hills-path.png", "hills.png", "hills.stl"]);
}

#[test]
fn places_that_cannot_be_written_to() {
    let bench = Bench::new();
    bench.hills("hills.png", (20, 20));
    bench.write("file", "mine");
    let arguments = ["run", "relief", "--set", "image=hills.png", "--out", "file"];
    let answer = bench.carve(&[&arguments[..], &QUICK].concat());
    assert_eq!(answer.status, 1, "{}", answer.err);
    assert!(answer.err.contains("cannot write file"), "{}", answer.err);
    assert_eq!(bench.text("file"), "mine");
}

#[test]
fn reports_are_written_where_they_can_be() {
    let bench = Bench::new();
    bench.hills("hills.png", (20, 20));
    bench.write("file", "mine");
    std::fs::create_dir(bench.path("folder")).unwrap();
    let run = |report: &str| {
        let arguments = ["run", "relief", "--set", "image=hills.png", "--only", "save_mesh"];
        bench.carve(&[&arguments[..], &["--report", report]].concat())
    };
    assert_eq!(run("new/folder/report.json").status, 0);
    assert_eq!(bench.files("new/folder").into_keys().collect::<Vec<_>>(), ["report.json"]);
    for report in ["file/report.json", "folder"] {
        let answer = run(report);
        assert_eq!(answer.status, 2, "{}", answer.err);
        let words = format!("error: cannot write the report {report}: ");
        assert!(answer.err.contains(&words), "{}", answer.err);
        // The mesh is there nevertheless, and is told of.
        assert_eq!(answer.out, "out/hills.stl\n");
    }
    assert_eq!(bench.names(), ["file", "folder", "hills.png", "new", "out"]);
}

#[test]
fn a_recipe_cannot_name_a_library() {
    let rule = "a recipe cannot name a library: plugins are loaded only from the plugin folders and \
                --plugins";
    for (was, is) in [
        ("\"z_zero\": \"top\"", "\"dialect\": \"./evil.so\""),
        ("(kind: \"cutter\")", "(kind: \"cutter\", set: { \"shape\": \"../evil.dylib\" })"),
        ("(kind: \"grayscale\"", "(kind: \"C:/evil.dll\""),
        ("    params: {", "    plugins: [\"evil.so\"],\n    params: {"),
        ("(kind: \"cutter\")", "(kind: \"cutter\", library: \"evil.so\")"),
    ] {
        let bench = bench_with_recipe(|text| {
            assert!(text.contains(was), "{was}");
            text.replacen(was, is, 1)
        });
        assert_refused(&bench, &["mine.ron"], 2, &["mine.ron:", "evil.", rule]);
    }
}

#[test]
fn dimensions_that_a_shape_lacks_are_told_with_those_it_has() {
    let bench = bench_with_recipe(|text| with_diameter(&text, "3"));
    let complaint = "node \"tool\" (cutter) has no parameter \"flutes\"";
    assert_refused(&bench, &["mine.ron", "--set", "tool.flutes=3"], 2, &[complaint]);
    let answer = bench.carve(&["check", "mine.ron", "--set", "tool.diameter=1in"]);
    assert_eq!(answer.status, 0, "{}", answer.err);
}

//! Recipes of one's own: knobs, units, paths, and recipes as nodes of others.

use crate::bench::{Bench, QUICK, recipe_text};
use crate::gcode;

/// Softens a picture and makes a surface of it, as a node of another recipe.
const SOFT_RELIEF: &str = r#"Recipe(
    format: 1,
    title: "Soft relief",
    about: "A picture becomes a soft surface.",
    inputs: { "picture": (feeds: ["gray.image"], about: "Picture to soften") },
    params: {
        "softness": (sets: ["first.kernel", "second.kernel"], about: "How soft"),
        "height": (sets: ["surface.z_max"], about: "How high"),
    },
    nodes: {
        "gray": (kind: "grayscale"),
        "first": (kind: "gaussian_blur", from: { "image": "gray" }),
        "second": (kind: "gaussian_blur", from: { "image": "first" }),
        "surface": (kind: "z_map", from: { "image": "second" }, set: { "canvas_width": "30mm" }),
    },
    outputs: ["surface"],
)"#;

/// Uses it.
const OUTER: &str = r#"Recipe(
    format: 1,
    params: {
        "image": (sets: ["photo.path"]),
        "height": (sets: ["soft.height"]),
    },
    nodes: {
        "photo": (kind: "load_image", set: { "path": "../hills.png" }),
        "soft": (
            kind: "recipe",
            from: { "picture": "photo" },
            set: { "recipe": "inner/soft.ron", "softness": 9, "height": "0.1in" },
        ),
        "preview": (kind: "preview", from: { "surface": "soft" }, set: { "size": 64 }),
    },
    outputs: ["preview"],
)"#;

fn bench_with_inner_recipe() -> Bench {
    let bench = Bench::new();
    bench.hills("hills.png", (50, 40));
    std::fs::create_dir_all(bench.path("mine/inner")).unwrap();
    bench.write("mine/inner/soft.ron", SOFT_RELIEF);
    bench.write("mine/outer.ron", OUTER);
    bench
}

#[test]
fn a_recipe_serves_as_a_node() {
    let bench = bench_with_inner_recipe();
    let report = bench.run(&["mine/outer.ron"]);
    assert_eq!(
        report.nodes_that("ran"),
        ["photo", "preview", "soft/first", "soft/gray", "soft/second", "soft/surface"]
    );
    assert_eq!(report.number("soft/surface", "surface", "z_max"), f64::from(2.54_f32));
    assert_eq!(bench.files("out").into_keys().collect::<Vec<_>>(), ["hills.png"]);
}

#[test]
fn knobs_reach_through_recipes() {
    let bench = bench_with_inner_recipe();
    let settings = ["mine/outer.ron", "--set", "height=3", "--set", "soft/second.kernel=1"];
    let report = bench.run(&settings);
    assert_eq!(report.number("soft/surface", "surface", "z_max"), 3.0);
    let answer = bench.carve(&["check", "mine/outer.ron", "--set", "soft/second.kernel=2"]);
    assert_eq!(answer.status, 2);
    assert!(answer.err.contains("node \"soft/second\": kernel must be odd"), "{}", answer.err);
}

#[test]
fn a_fault_in_an_inner_recipe_is_shown_there() {
    let bench = bench_with_inner_recipe();
    bench.write("mine/inner/soft.ron", SOFT_RELIEF.replace("30mm", "30deg"));
    let answer = bench.carve(&["check", "mine/outer.ron"]);
    assert_eq!(answer.status, 2);
    assert!(answer.err.contains("--> mine/inner/soft.ron:14:"), "{}", answer.err);
    assert_eq!(answer.err.matches("error: ").count(), 1, "{}", answer.err);

    bench.write("mine/outer.ron", OUTER.replace("\"softness\"", "\"softnes\""));
    bench.write("mine/inner/soft.ron", SOFT_RELIEF);
    let answer = bench.carve(&["check", "mine/outer.ron"]);
    assert_eq!(answer.status, 2);
    assert!(answer.err.contains("--> mine/outer.ron:12:"), "{}", answer.err);
    assert!(answer.err.contains("did you mean \"softness\"?"), "{}", answer.err);
}

#[test]
fn paths_start_where_they_are_written() {
    let bench = bench_with_inner_recipe();
    // In the recipe at the recipe's folder, behind --set at the current one.
    bench.run(&["mine/outer.ron", "--set", "image=hills.png"]);
    let answer = bench.carve(&["check", "mine/outer.ron", "--set", "image=../hills.png"]);
    assert_eq!(answer.status, 2, "{}", answer.err);
    bench.write("mine/outer.ron", OUTER.replace("../hills.png", "hills.png"));
    let answer = bench.carve(&["check", "mine/outer.ron"]);
    assert_eq!(answer.status, 2);
    assert!(answer.err.contains("there is no file mine/hills.png"), "{}", answer.err);
}

#[test]
fn a_built_in_recipe_can_be_saved_changed_and_run() {
    let bench = Bench::new();
    let saved = bench.carve(&["graphs", "relief", "--text"]);
    assert_eq!(saved.out, recipe_text("relief"));
    bench.hills("hills.png", (30, 30));
    bench.write("mine.ron", saved.out.replace("samples/medallion.png", "hills.png"));
    bench.run(&[&["mine.ron", "--out", "mine"][..], &QUICK].concat());
    let built_in = ["relief", "--set", "image=hills.png", "--out", "built-in"];
    bench.run(&[&built_in[..], &QUICK].concat());
    assert_eq!(bench.files("mine"), bench.files("built-in"));
}

#[test]
fn a_layout_is_kept_out_of_the_way_of_the_engine() {
    let bench = Bench::new();
    bench.hills("hills.png", (30, 30));
    let text = recipe_text("relief").replace("samples/medallion.png", "hills.png");
    let layout = "layout: { \"photo\": (x: 1.5, y: -2, tint: Some(\"red\")) },\n    outputs";
    bench.write("mine.ron", text.replacen("outputs", layout, 1));
    let answer = bench.carve(&["check", "mine.ron"]);
    assert_eq!((answer.status, answer.err.as_str()), (0, ""));
}

#[test]
fn lengths_in_any_unit_make_the_same_program() {
    let bench = Bench::new();
    bench.hills("hills.png", (40, 40));
    let programs =
        ["canvas_width=2in", "canvas_width=5.08 cm", "canvas_width=50.8", "canvas_width=2000thou"]
            .map(|canvas| {
                let only = ["--only", "save_gcode", "--set", "stepover=1"];
                bench.run(
                    &[&["relief", "--set", "image=hills.png", "--set", canvas], &only[..]].concat(),
                );
                bench.text("out/hills.nc")
            });
    assert!(programs.iter().all(|program| *program == programs[0]));
    let width = gcode::read(&programs[0]).moves.iter().filter_map(|m| m.to[0]).fold(0.0, f64::max);
    assert!(width > 49.0 && width < 50.8 * 39.0 / 40.0 + 0.001, "{width}");
}

#[test]
fn the_last_setting_of_a_name_counts() {
    let bench = Bench::new();
    bench.hills("hills.png", (30, 30));
    let settings = ["diameter=6", "diameter=0.25in", "tool.diameter=4", "diameter=8mm"];
    let set = settings.iter().flat_map(|setting| ["--set", setting]);
    let call = ["relief", "--only", "drop", "--set", "image=hills.png"].into_iter().chain(set);
    let report = bench.run(&call.collect::<Vec<_>>());
    assert_eq!(report.number("tool", "cutter", "diameter_mm"), 8.0);
}

/// Each pattern is a program and a picture; those that are bounded stay where they are told.
#[test]
fn the_patterns_keep_to_what_bounds_them() {
    let bench = Bench::new();
    let settings = ["stepover=2", "feed_step=1", "picture_size=64"];
    let set = settings.iter().flat_map(|setting| ["--set", setting]);
    let report = bench.run(&["patterns"].into_iter().chain(set).collect::<Vec<_>>());
    let patterns = [
        "bounded", "circles", "climb", "contour", "cross", "hilbert", "masked", "radial", "rings",
        "spiral",
    ];
    let files: Vec<String> = bench.files("out").into_keys().collect();
    for pattern in patterns {
        assert!(files.contains(&format!("medallion-{pattern}.nc")), "{files:?}");
        assert!(files.contains(&format!("medallion-{pattern}.png")), "{files:?}");
        assert!(report.count(pattern, "pattern", "passes") > 0, "{pattern}");
    }
    assert_eq!(files.len(), 2 * patterns.len());
    // Feeds only: rapids and plunges come from beside.
    let fed = |pattern: &str| -> Vec<[f64; 2]> {
        let program = gcode::read(&bench.text(&format!("out/medallion-{pattern}.nc")));
        let fed = program.moves.iter().filter(|m| m.motion == gcode::Motion::Feed);
        fed.map(|m| [m.point()[0], m.point()[1]]).collect()
    };
    // The sun of the mask reaches 54 mm from the middle of a plaque of 203, which is here 60 wide.
    let middle = 59.9 / 2.0;
    let reach =
        fed("masked").iter().map(|[x, y]| (x - middle).hypot(y - middle)).fold(0.0, f64::max);
    assert!((15.0..54.0 * 60.0 / 203.0 + 0.2).contains(&reach), "{reach}");
    // The rings stay 1.5 mm inside of a square on its corner, and of the one in it.
    for [x, y] in fed("rings") {
        let turned = [x + y - 60.0, x - y].map(|along| (along / 2.0_f64.sqrt()).abs());
        let beyond = |half: f64| turned.map(|along| along - half / 2.0_f64.sqrt());
        assert!(beyond(28.0).iter().all(|off| *off < -1.48), "{x} {y}");
        let [u, v] = beyond(10.0).map(|off| off.max(0.0));
        assert!(u.hypot(v) > 1.48, "{x} {y}");
    }
}

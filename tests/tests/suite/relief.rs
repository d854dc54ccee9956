//! `carve run relief` with nothing said: the bundled sample becomes a program.

use crate::bench::{Bench, QUICK};
use serde_json::Value;

/// The facts that the report promises for each type of value.
const FACTS: [(&str, &[&str]); 7] = [
    ("image", &["width", "height", "channels", "bits"]),
    ("height_field", &["columns", "rows", "pitch_mm", "width_mm", "height_mm", "z_min", "z_max"]),
    ("point_cloud", &["points"]),
    ("mesh", &["vertices", "triangles"]),
    ("toolpath", &["cl_points", "passes", "feed_length_mm", "rapid_length_mm", "time_s"]),
    ("gcode", &["lines", "bytes", "dialect"]),
    ("reduction", &["points_in", "points_out", "max_deviation_mm"]),
];

#[test]
fn the_sample_becomes_program_mesh_pictures_and_summary() {
    let bench = Bench::new();
    let report = bench.run(&["relief", "--out", "carved"]);
    let wanted = ["-carved.png", "-deviation.png", "-path.png", ".nc", ".png", ".stl", ".txt"];
    let wanted = wanted.map(|end| format!("medallion{end}"));
    let files = bench.files("carved");
    assert_eq!(files.keys().cloned().collect::<Vec<_>>(), wanted);
    assert_eq!(bench.names(), ["carved", "report.json"], "nothing beside the output folder");

    let lines = report.count("post", "program", "lines");
    let program = &files["medallion.nc"];
    assert_eq!(program.iter().filter(|byte| **byte == b'\n').count() as u64, lines);
    assert_eq!(program.len() as u64, report.count("post", "program", "bytes"));

    let triangles = report.count("mesh", "mesh", "triangles");
    let stl = &files["medallion.stl"];
    assert_eq!(u64::from(u32::from_le_bytes(stl[80..84].try_into().unwrap())), triangles);
    assert_eq!(stl.len() as u64, 84 + 50 * triangles);

    for name in ["medallion.png", "medallion-path.png", "medallion-carved.png"] {
        let picture = image::load_from_memory(&files[name]).unwrap();
        assert_eq!(picture.width().max(picture.height()), 1200, "{name}");
        let pixels = picture.to_rgb8();
        let first = pixels.get_pixel(0, 0);
        assert!(pixels.pixels().any(|pixel| pixel != first), "{name} is blank");
    }

    let summary = String::from_utf8(files["medallion.txt"].clone()).unwrap();
    for words in ["640 x 640 points", "ball, diameter 6 mm", "dialect grbl", "676 passes"] {
        assert!(summary.contains(words), "{words:?} in {summary}");
    }
    assert!(summary.contains(&format!("{lines} lines")), "{summary}");
}

#[test]
fn the_report_keeps_its_contract() {
    let bench = Bench::new();
    bench.hills("hills.png", (60, 50));
    let call = ["relief", "--set", "image=hills.png", "--threads", "2"];
    let report = bench.run(&[&call[..], &QUICK].concat());
    let top = report.0.as_object().unwrap();
    let keys: Vec<_> = top.keys().map(String::as_str).collect();
    let wanted = ["files", "nodes", "peak_rss_mb", "recipe", "status", "threads", "wall_s"];
    assert_eq!(keys, wanted);
    assert_eq!(report.0["recipe"], "relief");
    assert_eq!(report.0["status"], "done");
    assert_eq!(report.0["threads"], 2);
    assert!(report.0["wall_s"].as_f64().unwrap() > 0.0);
    assert!(report.0["peak_rss_mb"].is_null() || report.0["peak_rss_mb"].as_f64().unwrap() > 1.0);
    assert_eq!(
        report.0["files"],
        serde_json::json!([
            "out/hills.nc",
            "out/hills-deviation.png",
            "out/hills-carved.png",
            "out/hills.stl",
            "out/hills.png",
            "out/hills-path.png",
            "out/hills.txt"
        ])
    );
    let unused = ["inspection/ball", "inspection/file", "inspection/placed", "inspection/shell"];
    assert_eq!(report.nodes_that("skipped"), [&unused[..], &["save_points"]].concat());
    assert_eq!(report.nodes_that("ran").len(), 25);

    let mut seen = Vec::new();
    for (id, node) in report.0["nodes"].as_object().unwrap() {
        assert!(node["kind"].is_string() && node["wall_s"].is_number(), "{id}: {node}");
        for (port, output) in node["outputs"].as_object().unwrap() {
            let type_name = output["type"].as_str().unwrap();
            seen.push(type_name.to_owned());
            let Some((_, facts)) = FACTS.iter().find(|(known, _)| *known == type_name) else {
                continue;
            };
            for fact in *facts {
                assert!(output["facts"].get(fact).is_some(), "{id}.{port} lacks {fact}: {output}");
            }
        }
    }
    for (type_name, _) in FACTS {
        assert!(seen.iter().any(|seen| seen == type_name), "no {type_name} in the report");
    }
    // A path that was linked has a time; one that was not has none yet.
    assert!(report.number("link", "toolpath", "time_s") > 1.0);
    assert!(report.node("drop")["outputs"]["toolpath"]["facts"]["time_s"].is_null());
}

#[test]
fn facts_say_what_the_picture_and_the_surface_are() {
    let bench = Bench::new();
    bench.hills("hills.png", (60, 50));
    let report = bench.run(&[
        "relief",
        "--set",
        "image=hills.png",
        "--set",
        "canvas_width=120",
        "--only",
        "relief",
    ]);
    let image = |fact: &str| report.count("photo", "image", fact);
    assert_eq!(["width", "height", "channels", "bits"].map(image), [60, 50, 1, 16]);
    let surface = |fact: &str| report.number("relief", "surface", fact);
    // p = min(120/60, 203/50); the surface spans one pitch less than the canvas.
    assert_eq!(surface("pitch_mm"), 2.0);
    assert_eq!([surface("width_mm"), surface("height_mm")], [118.0, 98.0]);
    assert_eq!([surface("z_min"), surface("z_max")], [0.0, 5.0]);
}

#[test]
fn quiet_says_nothing() {
    let bench = Bench::new();
    bench.picture("even.png", (20, 20), |_, _| 77);
    // Not even the warning that the picture is one even gray.
    let call = ["run", "relief", "--set", "image=even.png", "--quiet"];
    let answer = bench.carve(&[&call[..], &QUICK].concat());
    assert_eq!((answer.status, answer.out.as_str(), answer.err.as_str()), (0, "", ""));
    assert_eq!(bench.files("out").len(), 7);
}

#[test]
fn a_pipe_gets_files_on_one_side_and_plain_lines_on_the_other() {
    let bench = Bench::new();
    bench.hills("hills.png", (40, 40));
    let call = ["run", "relief", "--set", "image=hills.png", "--out", "carved"];
    let report = ["--report", "report.json"];
    let answer = bench.carve(&[&call[..], &QUICK, &report].concat());
    assert_eq!(answer.status, 0, "{}", answer.err);
    let files: Vec<&str> = answer.out.lines().collect();
    assert_eq!(Value::from(files.clone()), bench.report().0["files"]);
    assert_eq!(files.len(), 7);
    for file in files {
        assert!(bench.path(file).is_file(), "{file}");
    }
    let plain = |c: char| c == '\n' || !c.is_control();
    assert!(answer.err.chars().all(plain), "{:?}", answer.err);
    for line in ["ran     photo (load_image) ", "ran     drop (drop_cutter) ", "note: drop: "] {
        assert!(answer.err.lines().any(|l| l.starts_with(line)), "{line:?} in {}", answer.err);
    }
    assert!(answer.err.lines().last().unwrap().starts_with("done in "), "{}", answer.err);
}

#[test]
fn only_makes_what_is_asked_for() {
    let bench = Bench::new();
    bench.hills("hills.png", (40, 40));
    let report = bench.run(&["relief", "--set", "image=hills.png", "--only", "save_mesh"]);
    assert_eq!(bench.files("out").into_keys().collect::<Vec<_>>(), ["hills.stl"]);
    assert_eq!(
        report.nodes_that("ran"),
        ["gray", "mesh", "photo", "points", "relief", "save_mesh", "smooth"]
    );
}

#[test]
fn points_are_saved_when_asked_for() {
    let bench = Bench::new();
    bench.hills("hills.png", (30, 20));
    let set = ["relief", "--set", "image=hills.png", "--only", "save_points", "--set"];
    bench.run(&[&set[..], &["save_points=xyz"]].concat());
    assert_eq!(bench.text("out/hills.xyz").lines().count(), 600);
    bench.run(&[&set[..], &["save_points=ply"]].concat());
    let ply = bench.read("out/hills.ply");
    let head = String::from_utf8_lossy(&ply[..120]);
    assert!(head.starts_with("ply\n") && head.contains("element vertex 600\n"), "{head}");
}

/// A picture's name becomes the name of files; one that a shell or a controller would take for
/// something else must not.
#[test]
fn files_are_named_after_the_picture() {
    let bench = Bench::new();
    let names = [("my cat.png", "my cat"), ("-rf.png", "-rf"), ("é(MSG,x).png", "é(MSG_x)")];
    for (at, (picture, prefix)) in names.into_iter().enumerate() {
        bench.hills(picture, (20, 20));
        let (image, out) = (format!("image={picture}"), format!("out{at}"));
        let call = ["relief", "--set", &image, "--only", "save_gcode", "--out", &out];
        bench.run(&[&call[..], &QUICK].concat());
        let files: Vec<String> = bench.files(&out).into_keys().collect();
        assert_eq!(files, [format!("{prefix}.nc")]);
    }
}

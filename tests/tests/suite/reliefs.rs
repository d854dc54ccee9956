//! Reliefs that are composed and flattened, and the solids that are printed of them.

use crate::bench::{Bench, Report};
use std::f64::consts::PI;

/// Settings that make a small job of the recipes here.
const SMALL: [&str; 6] =
    ["--set", "preview.size=64", "--set", "preview_path.size=64", "--set", "save_3mf=true"];

fn run(bench: &Bench, recipe: &str, settings: &[&str]) -> Report {
    let set = settings.iter().flat_map(|setting| ["--set", setting]);
    bench.run(&[recipe].into_iter().chain(SMALL).chain(set).collect::<Vec<_>>())
}

/// Reads a solid that was written, which must be without defect.
#[track_caller]
fn assert_watertight(bench: &Bench, file: &str) -> Report {
    let mesh = format!("mesh=out/{file}");
    let report = bench.run(&["mesh_finish", "--set", &mesh, "--only", "inspect"]);
    for defect in [
        "open_edges",
        "non_manifold_edges",
        "flipped_edges",
        "degenerate_triangles",
        "duplicate_triangles",
    ] {
        assert_eq!(report.count("inspect", "defects", defect), 0, "{file}: {defect}");
    }
    report
}

#[test]
fn a_bas_relief_has_its_depth_on_a_level_plate_and_a_watertight_solid() {
    let bench = Bench::new();
    let report = run(&bench, "bas_relief", &["pitch=0.5", "depth=4", "stepover=1", "width=60"]);
    let of = |node: &str, fact: &str| report.number(node, "surface", fact);
    assert_eq!((of("flat", "z_min"), of("flat", "z_max")), (0.0, 4.0));
    assert_eq!(of("relief", "width_mm"), of("flat", "width_mm") + 2.0 * 5.0);
    let files: Vec<String> = bench.files("out").into_keys().collect();
    let endings =
        ["-carved.png", "-deviation.png", "-path.png", ".3mf", ".nc", ".png", ".stl", ".txt"];
    assert_eq!(files, endings.map(|ending| format!("shell{ending}")));
    let triangles = ["shell.stl", "shell.3mf"]
        .map(|file| assert_watertight(&bench, file).count("placed", "mesh", "triangles"));
    assert_eq!(triangles, [report.count("solid", "mesh", "triangles"); 2]);
}

#[test]
fn a_lithophane_is_thin_where_the_picture_is_bright() {
    let bench = Bench::new();
    // Black on the left, white on the right.
    bench.picture("steps.png", (60, 40), |x, _| if x < 30 { 0 } else { 255 });
    let settings =
        ["image=steps.png", "longer_side=0", "blur=1", "canvas_width=30", "border_width=2"];
    let report = run(&bench, "lithophane", &settings);
    let of = |node: &str, fact: &str| report.number(node, "surface", fact);
    let range =
        |node: &str| [of(node, "z_min"), of(node, "z_max")].map(|z| (z * 1e4).round() / 1e4);
    assert_eq!((range("picture"), range("relief")), ([0.8, 3.0], [0.8, 4.0]));
    let solid = assert_watertight(&bench, "steps.3mf");
    // The back lies at 0, so heights are thicknesses.
    let size = solid.fact("placed", "bounds", "max_mm");
    assert_eq!(size[2], 4.0);
}

#[test]
fn a_plaque_is_put_together_of_its_parts() {
    let bench = Bench::new();
    let settings =
        ["tile=10", "columns=3", "rows=3", "at_x=5", "at_y=5", "canvas_width=20", "round=18"];
    let arguments: Vec<&str> = settings.iter().flat_map(|setting| ["--set", *setting]).collect();
    let report = bench.run(&[&["plaque", "--only", "relief"], &arguments[..]].concat());
    let of = |node: &str, fact: &str| report.number(node, "surface", fact);
    // Mirrored tiles share their borders.
    assert_eq!(of("ground", "columns"), 3.0 * (of("tile", "columns") - 1.0) + 1.0);
    assert_eq!((of("low", "z_min"), of("low", "z_max")), (0.0, 1.0));
    assert!(of("bent", "z_max") > of("carvable", "z_max") + 3.0);
    assert!(
        (of("relief", "width_mm") - of("bent", "width_mm") - 16.0).abs() < of("relief", "pitch_mm")
    );
}

#[test]
fn a_text_is_cut_in_to_its_depth_in_its_frame() {
    let bench = Bench::new();
    let settings =
        ["text=Ai\\nB", "pitch=0.2", "width=60", "size=8", "height=-1.5", "profile=flat"];
    let report = run(&bench, "text_plaque", &settings);
    let of = |node: &str, fact: &str| report.number(node, "surface", fact);
    assert_eq!((of("written", "z_min"), of("written", "z_max")), (-1.5, 0.0));
    assert_eq!((of("written", "width_mm"), of("relief", "width_mm")), (60.0, 66.0));
    // A line of 1.2 mm, 3 mm within the plate, around corners of 4 mm.
    let ring =
        |grown: f64| (54.0 - grown) * (44.0 - grown) - (4.0 - PI) * (4.0 - grown / 2.0).powi(2);
    let expected = (ring(0.0) - ring(2.4)) / 0.04;
    let found = report.number("frame", "mask", "selected_px");
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    assert_watertight(&bench, "text_plaque.stl");
}

#[test]
fn strokes_that_a_cutter_cannot_enter_are_told() {
    let bench = Bench::new();
    let settings = ["text=Carve", "width=40", "size=4", "profile=flat", "pitch=0.2"];
    let set = settings.iter().flat_map(|setting| ["--set", *setting]);
    let thick = ["text_plaque", "--only", "written", "--set", "cutter=flat", "--set", "diameter=3"];
    let answer = bench.carve(&["run"].into_iter().chain(thick).chain(set).collect::<Vec<_>>());
    assert_eq!(answer.status, 0, "{}", answer.err);
    assert!(answer.err.contains("the cutter needs 3.00 mm of room at 2 mm"), "{}", answer.err);
}

#[test]
fn a_drawing_is_carved_under_its_own_name() {
    let bench = Bench::new();
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 10 10'><circle r='5'/></svg>";
    bench.write("badge.svg", svg);
    let settings = [
        "drawing=badge.svg",
        "pitch=0.25",
        "width=40",
        "plate_height=30",
        "height=1",
        "stepover=0.5",
    ];
    let report = run(&bench, "drawing", &settings);
    assert_eq!(report.number("stamped", "surface", "z_max"), 1.0);
    // Fitted within 5 mm: a circle of 20 mm.
    let (found, expected) = (report.number("shapes", "mask", "selected_px"), PI * 100.0 * 16.0);
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    assert_watertight(&bench, "badge.stl");
}

#[test]
fn a_3mf_is_the_same_whatever_the_number_of_threads() {
    let bytes = ["1", "4"].map(|threads| {
        let bench = Bench::new();
        let settings = ["--set", "pitch=0.5", "--set", "save_3mf=true", "--only", "save_3mf"];
        bench.run(&[&["bas_relief", "--threads", threads], &settings[..]].concat());
        bench.read("out/shell.3mf")
    });
    assert!(bytes[0] == bytes[1]);
}

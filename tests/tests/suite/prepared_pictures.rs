//! Pictures prepared before they become heights: the recipes `photo` and `depth_map`.

use crate::bench::{Bench, QUICK, Report};
use crate::gcode;
use image::{ImageBuffer, Luma};
use std::collections::BTreeSet;

/// Runs a recipe as far as its surface; returns the surface's points, the upper left pixel's first.
fn points(bench: &Bench, recipe: &str, settings: &[&str]) -> Vec<[f64; 3]> {
    surface(bench, recipe, settings);
    let text = bench.text("out/picture.xyz");
    let point = |line: &str| -> Option<[f64; 3]> {
        let numbers: Option<Vec<f64>> = line.split(' ').map(|word| word.parse().ok()).collect();
        numbers?.try_into().ok()
    };
    let mut points: Vec<[f64; 3]> = text.lines().filter_map(point).collect();
    points.sort_by(|a, b| b[1].total_cmp(&a[1]).then(a[0].total_cmp(&b[0])));
    points
}

fn surface(bench: &Bench, recipe: &str, settings: &[&str]) -> Report {
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    let call = [recipe, "--only", "save_points", "--set", "save_points=xyz"].into_iter();
    let call = call.chain(["--set", "image=picture.png"]).chain(settings);
    bench.run(&call.collect::<Vec<_>>())
}

fn heights(bench: &Bench, recipe: &str, settings: &[&str]) -> Vec<f64> {
    points(bench, recipe, settings).into_iter().map(|[_, _, z]| z).collect()
}

/// The most that two surfaces are apart.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[track_caller]
fn assert_near(found: &[f64], wanted: &[f64]) {
    assert!(apart(found, wanted) < 2e-6, "{found:?} in place of {wanted:?}");
}

/// A picture of 16 bits in which every level occurs once.
fn ramp(bench: &Bench) {
    let picture = ImageBuffer::from_fn(256, 256, |x, y| Luma([(256 * y + x) as u16]));
    picture.save(bench.path("picture.png")).unwrap();
}

#[test]
fn a_depth_map_of_16_bits_keeps_its_levels() {
    let bench = Bench::new();
    ramp(&bench);
    for bits in ["slopes.bits=16", "slopes.bits=8"] {
        let heights = heights(&bench, "depth_map", &[bits]);
        assert_eq!(heights.len(), 65_536);
        let distinct: BTreeSet<i64> = heights.iter().map(|z| (z * 1e6).round() as i64).collect();
        assert!(distinct.len() >= 60_000, "{bits}: {}", distinct.len());
    }
}

#[test]
fn a_depth_map_of_8_bits_becomes_slopes() {
    let bench = Bench::new();
    // Treads of 10 pixels, a step high each.
    bench.picture("picture.png", (200, 6), |x, _| 100 + (x / 10) as u8);
    let stairs = heights(&bench, "depth_map", &["slopes.bits=16"]);
    let slope = heights(&bench, "depth_map", &["z_max=5mm"]);
    let steepest = |heights: &[f64]| {
        let row = &heights[..200];
        row.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
    };
    assert!(steepest(&stairs) > 0.25, "{}", steepest(&stairs));
    assert!(steepest(&slope) < 0.06, "{}", steepest(&slope));
}

#[test]
fn levels_and_sign_of_a_depth_map_move_heights() {
    let bench = Bench::new();
    bench.picture("picture.png", (5, 2), |x, _| [0, 51, 102, 204, 255][x as usize]);
    let row = |settings: &[&str]| heights(&bench, "depth_map", settings)[..5].to_vec();
    assert_near(&row(&[]), &[0.0, 1.0, 2.0, 4.0, 5.0]);
    assert_near(&row(&["inverted=true"]), &[5.0, 4.0, 3.0, 1.0, 0.0]);
    assert_near(&row(&["black=0.2", "white=0.8"]), &[0.0, 0.0, 5.0 / 3.0, 5.0, 5.0]);
    let root = |share: f64| 5.0 * share.sqrt();
    assert_near(&row(&["gamma=2"]), &[0.0, 0.2, 0.4, 0.8, 1.0].map(root));
}

#[test]
fn specks_of_a_depth_map_go() {
    let bench = Bench::new();
    bench.picture("picture.png", (20, 12), |x, y| if (x, y) == (7, 5) { 255 } else { 5 * x as u8 });
    let speck = |settings: &[&str]| heights(&bench, "depth_map", settings)[5 * 20 + 7];
    assert_eq!(speck(&[]), 5.0);
    assert!((1.5..2.2).contains(&speck(&["specks=3"])), "{}", speck(&["specks=3"]));
}

#[test]
fn a_photograph_is_cut_turned_and_brought_to_size() {
    let bench = Bench::new();
    bench.hills("picture.png", (80, 60));
    let frame = ["left=0.25", "right=0.25", "top=0.1", "turn=90deg", "pixels=27"];
    let report = surface(&bench, "photo", &frame);
    let size = |node: &str| ["width", "height"].map(|fact| report.count(node, "image", fact));
    assert_eq!(size("part"), [40, 54]);
    assert_eq!(size("turned"), [54, 40]);
    assert_eq!(size("sized"), [27, 20]);
    assert_eq!(report.count("relief", "surface", "columns"), 27);
}

/// Each knob does what it says, or is off; all others are off.
#[test]
fn every_knob_of_a_photograph_shows() {
    let bench = Bench::new();
    bench.hills("picture.png", (80, 60));
    let plain = ["pixels=0", "curve=0,0 1,1", "tiles=0", "edges=0", "fade=0", "blur=1", "smooth=3"];
    let with = |setting: &'static str| {
        let settings: Vec<&str> = plain.into_iter().chain([setting]).collect();
        heights(&bench, "photo", &settings)
    };
    let base = with("flip=none");
    let rows = || base.chunks_exact(80);
    let left_right: Vec<f64> = rows().flat_map(|row| row.iter().rev().copied()).collect();
    // The bilateral grid begins at another corner of the picture: it is 4 % of the range off at most.
    assert!(apart(&with("flip=left_right"), &left_right) < 0.2 && apart(&base, &left_right) > 1.0);
    let top_bottom: Vec<f64> = rows().rev().flatten().copied().collect();
    assert!(apart(&with("flip=top_bottom"), &top_bottom) < 0.2 && apart(&base, &top_bottom) > 1.0);
    for setting in ["smooth=9", "tiles=4", "curve=0,0 0.5,0.7 1,1", "edges=2", "fade=1", "blur=9"] {
        let moved = apart(&with(setting), &base);
        assert!(moved > 0.05, "{setting} moves heights by {moved} mm at most");
    }
}

#[test]
fn photographs_and_depth_maps_become_programs() {
    for recipe in ["photo", "depth_map"] {
        let bench = Bench::new();
        bench.hills("picture.png", (60, 50));
        let call = [recipe, "--set", "image=picture.png", "--set", "stepover=1"];
        let report = bench.run(&[&call[..], &QUICK].concat());
        assert_eq!(report.status("save_gcode"), "ran");
        let files: Vec<String> = bench.files("out").into_keys().collect();
        let wanted = ["-carved.png", "-deviation.png", "-path.png", ".nc", ".png", ".stl", ".txt"];
        assert_eq!(files, wanted.map(|ending| format!("picture{ending}")), "{recipe}");
        let program = gcode::read(&bench.text("out/picture.nc"));
        let deepest = program.moves.iter().filter_map(|m| m.to[2]).fold(0.0, f64::min);
        assert!((-5.0..-2.0).contains(&deepest), "{recipe}: {deepest}");
    }
}

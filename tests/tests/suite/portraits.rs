//! Portraits: masks drawn once and used again, hair that is no crater, a background that lies where it is
//! told (Sood 2015, section 3.2.7), and messages where a mask does not serve.
//!
//! The photograph lies outside of the repository, see `data`; without it its tests say so and pass.

use crate::bench::{Bench, Report, data};
use crate::drop_heights::values_of;
use carvegraph_geometry::HeightField;
use carvegraph_nodes::{GrayImage, Mask};
use image::{Luma, Rgb, RgbImage};
use std::sync::Arc;

/// Outlines in `astronaut.png`, in shares of its width and height: the person, her hair, and her brows
/// and eyes.
const PERSON: &str = "0.068,1 0.043,0.898 0.041,0.801 0.059,0.645 0.078,0.576 0.107,0.508 0.166,0.449 \
    0.225,0.406 0.223,0.367 0.244,0.332 0.283,0.303 0.332,0.29 0.359,0.291 0.357,0.283 0.354,0.256 \
    0.342,0.252 0.333,0.232 0.314,0.215 0.304,0.186 0.3,0.137 0.308,0.109 0.327,0.093 0.369,0.068 \
    0.373,0.059 0.391,0.047 0.42,0.037 0.454,0.03 0.493,0.039 0.527,0.057 0.559,0.076 0.578,0.107 \
    0.586,0.142 0.59,0.171 0.581,0.205 0.566,0.232 0.542,0.253 0.529,0.268 0.522,0.267 0.516,0.297 \
    0.503,0.324 0.5,0.342 0.547,0.371 0.58,0.42 0.594,0.459 0.645,0.498 0.674,0.547 0.695,0.605 \
    0.707,0.674 0.781,0.672 0.85,0.688 0.918,0.742 0.957,0.811 0.971,0.889 0.994,0.908 1,0.977 1,1";
const HAIR: &str = "0.3,0.137 0.308,0.109 0.327,0.093 0.369,0.068 0.373,0.059 0.391,0.047 0.42,0.037 \
    0.454,0.03 0.493,0.039 0.527,0.057 0.559,0.076 0.578,0.107 0.586,0.142 0.59,0.171 0.581,0.205 \
    0.566,0.232 0.542,0.253 0.529,0.249 0.531,0.215 0.527,0.181 0.505,0.171 0.479,0.162 0.42,0.157 \
    0.391,0.155 0.369,0.142 0.359,0.176 0.353,0.21 0.351,0.234 0.334,0.23 0.314,0.215 0.304,0.186";
const BROWS_AND_EYES: &str = "0.369,0.178 0.383,0.172 0.405,0.174 0.419,0.181 0.405,0.178 0.383,0.177; \
    0.466,0.183 0.483,0.178 0.505,0.18 0.518,0.187 0.505,0.186 0.483,0.183; \
    0.373,0.193 0.391,0.188 0.412,0.197 0.396,0.205; 0.461,0.2 0.479,0.194 0.505,0.201 0.483,0.209";

/// Settings as arguments.
fn set<'a>(settings: &[&'a str]) -> Vec<&'a str> {
    settings.iter().flat_map(|setting| ["--set", setting]).collect()
}

/// Draws and saves the masks of a picture in the bench's folder, as `picture-mask.png` and so on.
fn draw(bench: &Bench, person: &str, hair: &str, facial: &str) {
    let [person, hair, facial] = [("person", person), ("hair", hair), ("facial", facial)]
        .map(|(name, corners)| format!("{name}={corners}"));
    let settings =
        ["image=picture.png", "hair_seed=0,0", "hair_tolerance=1", &person, &hair, &facial];
    bench.run(&[&["portrait_masks", "--out", "."], &set(&settings)[..]].concat());
}

/// The settings that carve the picture with the masks drawn.
const DRAWN: [(&str, &str); 4] = [
    ("image", "picture.png"),
    ("portrait_mask", "picture-mask.png"),
    ("hair_mask", "picture-hair.png"),
    ("facial_mask", "picture-facial.png"),
];

/// A bench with the photograph and its masks, if the photograph is there.
fn astronaut() -> Option<Bench> {
    let path = data("astronaut.png")?;
    let bench = Bench::new();
    bench.write("picture.png", std::fs::read(path).unwrap());
    draw(&bench, PERSON, HAIR, BROWS_AND_EYES);
    Some(bench)
}

/// Which pixels a saved mask selects.
fn selected(bench: &Bench, name: &str) -> Vec<bool> {
    let mask = image::open(bench.path(name)).unwrap().into_luma8();
    assert!(mask.pixels().all(|pixel| [0, 255].contains(&pixel[0])), "{name} is not crisp");
    mask.pixels().map(|pixel| pixel[0] == 0).collect()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

#[test]
fn hair_is_raised_by_the_proportion_and_nothing_else_is_touched() {
    let Some(bench) = astronaut() else { return };
    let hair = selected(&bench, "picture-hair.png");
    let face = selected(&bench, "picture-mask.png");
    assert!(hair.iter().zip(&face).all(|(hair, person)| *person || !hair));
    for lift in ["0", "0.35", "1"] {
        let settings = [&DRAWN[..], &[("hair_lift", lift)]].concat();
        let seen = values_of(&bench, "portrait", &settings, "lift_hair");
        let before: Arc<GrayImage> = seen.of("gaussian_blur");
        let after: Arc<GrayImage> = seen.of("mask_lift");
        let shares: Arc<Mask> = seen.of("feather_mask");
        let lift: f64 = lift.parse().unwrap();
        let brightest = f64::from(before.values.iter().copied().fold(0.0, f32::max));
        let pixels = || before.values.iter().zip(&after.values).zip(&shares.values);
        for ((before, after), share) in pixels() {
            if *share == 0.0 {
                assert_eq!(before.to_bits(), after.to_bits());
            }
            let wanted =
                f64::from(*before) + f64::from(*share) * lift * (brightest - f64::from(*before));
            assert!((f64::from(*after) - wanted).abs() < 1e-6, "{before} became {after}");
        }
        // All of the hair is within the soft edge, most of it beyond.
        let whole = |at: &usize| hair[*at] && shares.values[*at] == 1.0;
        let inner: Vec<usize> = (0..hair.len()).filter(whole).collect();
        assert!(10 * inner.len() > 7 * hair.iter().filter(|is_hair| **is_hair).count());
        let level = |image: &GrayImage| mean(inner.iter().map(|at| f64::from(image.values[*at])));
        let (low, high) = (level(&before), level(&after));
        assert!((high - (low + lift * (brightest - low))).abs() < 1e-6, "{low} became {high}");
    }
}

#[test]
fn hair_of_the_default_lift_is_no_crater() {
    let Some(bench) = astronaut() else { return };
    let hair = selected(&bench, "picture-hair.png");
    let mean_mm = |lift: &str| {
        let settings = [&DRAWN[..], &[("hair_lift", lift)]].concat();
        let field: Arc<HeightField> =
            values_of(&bench, "portrait", &settings, "relief").of("portrait_map");
        mean(
            heights(&field).into_iter().zip(&hair).filter(|(_, is_hair)| **is_hair).map(|(z, _)| z),
        )
    };
    let as_is = mean_mm("0");
    let lifted = mean_mm("0.5");
    assert!(as_is < 2.2 && lifted > 3.2, "{as_is} mm became {lifted} mm of 5");
}

/// Heights of a field in the order of the picture's pixels.
fn heights(field: &HeightField) -> Vec<f64> {
    let rows = (0..field.rows()).rev().map(|row| field.row(row));
    rows.flatten().map(|z| f64::from(*z)).collect()
}

/// Least and greatest height of the pixels that are selected, and of the rest.
fn ranges(bench: &Bench, settings: &[(&str, &str)]) -> [[f64; 2]; 2] {
    let settings = [&DRAWN[..], &[("edge", "0")], settings].concat();
    let field: Arc<HeightField> =
        values_of(bench, "portrait", &settings, "relief").of("portrait_map");
    let person = selected(bench, "picture-mask.png");
    [true, false].map(|wanted| {
        let chosen = heights(&field).into_iter().zip(&person).filter(|(_, is)| **is == wanted);
        chosen.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (z, _)| {
            [low.min(z), high.max(z)]
        })
    })
}

#[test]
fn the_background_lies_where_it_is_told() {
    let Some(bench) = astronaut() else { return };
    assert_eq!(ranges(&bench, &[]), [[0.0, 5.0], [0.0, 0.0]]);
    assert_eq!(ranges(&bench, &[("z_min", "1")]), [[1.0, 5.0], [1.0, 1.0]]);
    let keep = ("background", "keep");
    assert_eq!(ranges(&bench, &[keep]), [[3.0, 5.0], [0.0, 3.0]]);
    assert_eq!(
        ranges(&bench, &[keep, ("background_z", "1.5"), ("z_max", "4")]),
        [[1.5, 4.0], [0.0, 1.5]]
    );
}

#[test]
fn the_astronaut_becomes_a_program() {
    let Some(bench) = astronaut() else { return };
    let settings = DRAWN.map(|(name, value)| format!("{name}={value}"));
    let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
    let report = bench.run(&[&["portrait"], &set(&settings)[..]].concat());
    let counts = [
        report.count("points", "points", "points"),
        report.count("mesh", "mesh", "triangles"),
        report.count("drop", "toolpath", "cl_points"),
    ];
    // A pitch of 203/512 mm: 511 of them, 0.3 mm apart.
    assert_eq!(counts, [512 * 512, 2 * 511 * 511, 676 * 676]);
    let notes = |node: &str| report.node(node)["notes"].as_array().map_or(0, Vec::len);
    for node in ["portrait_mask", "hair_mask", "facial_mask", "relief"] {
        assert_eq!(notes(node), 0, "{:#}", report.node(node));
    }
    let files: Vec<String> = bench.files("out").into_keys().collect();
    assert_eq!(
        files,
        ["-carved.png", "-deviation.png", "-path.png", ".nc", ".png", ".stl", ".txt"]
            .map(|end| format!("picture{end}"))
    );
}

/// A bench with a picture of hills and an oval person in it, with hair and a beard.
fn sitter(size: (u32, u32)) -> Bench {
    let bench = Bench::new();
    bench.hills("picture.png", size);
    draw(
        &bench,
        "0.2,1 0.3,0.3 0.5,0.1 0.7,0.3 0.8,1",
        "0.3,0.3 0.5,0.1 0.7,0.3",
        "0.4,0.6 0.6,0.6 0.5,0.7",
    );
    bench
}

/// Carves with the masks drawn up to a node.
fn carve(bench: &Bench, only: &str, settings: &[&str]) -> Report {
    let drawn = DRAWN.map(|(name, value)| format!("{name}={value}"));
    let drawn: Vec<&str> =
        drawn.iter().map(String::as_str).chain(settings.iter().copied()).collect();
    bench.run(&[&["portrait", "--only", only], &set(&drawn)[..]].concat())
}

/// Sizes of the source's portraits (Sood 2015, tables 3.1, 4.3 and 4.4; Sood and others 2018, tables 2
/// and 3): the plaque it prints is pixels by pitch.
#[test]
fn portraits_have_the_sizes_and_counts_of_the_source() {
    let sizes_mm = |report: &Report| {
        let pixels = |fact: &str| report.count("relief", "surface", fact) as f64;
        let pitch = report.number("relief", "surface", "pitch_mm");
        [pixels("columns") * pitch, pixels("rows") * pitch]
    };
    let bench = sitter((1104, 1392));
    for (background, z_max) in [("background=drop", "z_max=3"), ("background=keep", "z_max=5")] {
        let report = carve(&bench, "drop", &[background, z_max, "background_z=3", "edge=0"]);
        let [x, y] = sizes_mm(&report);
        assert!((x - 161.0).abs() < 0.05 && (y - 203.0).abs() < 1e-9, "{x} × {y}");
        assert_eq!(report.count("drop", "toolpath", "cl_points"), 363_549);
        assert_eq!(report.number("relief", "surface", "z_max"), z_max[6..].parse::<f64>().unwrap());
    }
    let report = carve(&bench, "mesh", &[]);
    assert_eq!(report.count("points", "points", "points"), 1_536_768);
    assert_eq!(report.count("mesh", "mesh", "triangles"), 3_068_546);

    let [x, y] = sizes_mm(&carve(&sitter((700, 855)), "relief", &[]));
    assert!((x - 166.2).abs() < 0.05 && (y - 203.0).abs() < 1e-9, "{x} × {y}");
}

#[test]
fn saved_masks_serve_again_and_can_be_painted() {
    let bench = sitter((60, 75));
    let points = |bench: &Bench| {
        carve(
            bench,
            "save_points",
            &["save_points=xyz", "edge=0", "grow=0", "feather=0", "blur=1"],
        );
        bench.text("out/picture.xyz")
    };
    let first = points(&bench);
    assert_eq!(points(&bench), first);
    // A dot painted into the hair's mask, in a place that is not the picture's brightest or darkest.
    let mut hair = image::open(bench.path("picture-hair.png")).unwrap().into_luma8();
    assert_eq!(hair[(30, 60)], Luma([255]));
    hair[(30, 60)] = Luma([0]);
    hair.save(bench.path("picture-hair.png")).unwrap();
    let painted = points(&bench);
    let changed: Vec<_> = first.lines().zip(painted.lines()).filter(|(a, b)| a != b).collect();
    assert_eq!(changed.len(), 1, "{changed:?}");
    let z = |line: &str| line.rsplit(' ').next().unwrap().parse::<f64>().unwrap();
    assert!(z(changed[0].1) > z(changed[0].0));
}

#[test]
fn who_has_neither_hair_nor_beard_needs_no_masks_of_them() {
    let bench = sitter((60, 75));
    draw(&bench, "0.2,1 0.3,0.3 0.5,0.1 0.7,0.3 0.8,1", "none", "none");
    for mask in ["picture-hair.png", "picture-facial.png"] {
        assert!(selected(&bench, mask).iter().all(|is| !is), "{mask}");
    }
    let program = |settings: &[&str]| {
        let report = carve(&bench, "save_gcode", settings);
        assert_eq!(report.node("facial_edge")["notes"].as_array().map_or(0, Vec::len), 0);
        bench.text("out/picture.nc")
    };
    let without = program(&["hair_mask=none", "facial_mask=none", "stepover=1"]);
    assert_eq!(without, program(&["hair_lift=0", "facial_lift=0", "stepover=1"]));
}

/// What is said when a portrait of the bench's picture is carved with a setting.
fn said(bench: &Bench, status: i32, setting: &str) -> String {
    let drawn = DRAWN.map(|(name, value)| format!("{name}={value}"));
    let settings: Vec<&str> = drawn.iter().map(String::as_str).chain([setting]).collect();
    let answer =
        bench.carve(&[&["run", "portrait", "--only", "relief"], &set(&settings)[..]].concat());
    assert_eq!(answer.status, status, "{setting}: {}", answer.err);
    answer.err
}

#[track_caller]
fn assert_said(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "{word:?} is not said: {text}");
    }
}

#[test]
fn masks_that_do_not_serve_are_told() {
    let bench = sitter((60, 75));
    let other = Bench::new();
    other.hills("picture.png", (40, 30));
    draw(&other, "0,0 1,0 1,1", "none", "none");
    bench.write("other.png", other.read("picture-mask.png"));
    let wrong = "other.png has 40 × 30 px and the picture 60 × 75 px: make the mask for this picture, \
                 pixel by pixel, or take none";
    for mask in ["portrait_mask", "hair_mask", "facial_mask"] {
        let text = said(&bench, 1, &format!("{mask}=other.png"));
        assert_said(&text, &[&format!("error: node \"{mask}\" (load_mask): "), wrong]);
    }
    // Left out: the sample's mask stands there.
    let answer =
        bench.carve(&["run", "portrait", "--only", "relief", "--set", "image=picture.png"]);
    assert_said(
        &answer.err,
        &["samples/portrait-facial.png has 400 × 500 px and the picture 60 × 75 px"],
    );

    let rainbow = |x, y| Rgb([(4 * x) as u8, (3 * y) as u8, 255 - (4 * x) as u8]);
    RgbImage::from_fn(60, 75, rainbow).save(bench.path("photo.png")).unwrap();
    let text = said(&bench, 1, "portrait_mask=photo.png");
    assert_said(
        &text,
        &["photo.png is a colour picture and no mask: paint what is meant black, all else white"],
    );
    bench.picture("gray.png", (60, 75), |x, y| (60 + x + y) as u8);
    let text = said(&bench, 0, "hair_mask=gray.png");
    assert_said(
        &text,
        &[
            "warning: hair_mask: ",
            "gray.png is gray for the most part: is it a photograph and no mask?",
        ],
    );
    bench.write("text.png", "no picture");
    assert_said(
        &said(&bench, 1, "hair_mask=text.png"),
        &["text.png is no picture that can be read"],
    );
    assert_said(&said(&bench, 2, "hair_mask=lost.png"), &["there is no file lost.png"]);
}

#[test]
fn masks_of_nothing_and_of_everything_are_told() {
    let bench = sitter((60, 75));
    bench.picture("white.png", (60, 75), |_, _| 255);
    bench.picture("black.png", (60, 75), |_, _| 0);
    let nobody = "error: node \"relief\" (portrait_map): the mask selects no portrait";
    assert_said(&said(&bench, 1, "portrait_mask=white.png"), &[nobody]);
    assert_said(&said(&bench, 1, "portrait_mask=none"), &[nobody]);
    let nothing =
        ["warning: hair_mask: ", "white.png selects nothing: there is nothing black in it"];
    assert_said(&said(&bench, 0, "hair_mask=white.png"), &nothing);
    let all =
        "warning: relief: the mask selects the whole picture: nothing lies behind the portrait";
    assert_said(&said(&bench, 0, "portrait_mask=black.png"), &[all]);
}

#[test]
fn polygons_that_are_none_are_told() {
    let bench = Bench::new();
    bench.hills("picture.png", (60, 75));
    let fault = |person: &str| {
        let person = format!("person={person}");
        let answer = bench.carve(&[&["check", "portrait_masks"], &set(&[&person])[..]].concat());
        assert_eq!(answer.status, 2, "{person}: {}", answer.err);
        answer.err
    };
    assert_said(
        &fault("0,0 1,1"),
        &["error: ", "node \"person\"", "loop 1 has 2 corners; the least is 3"],
    );
    assert_said(&fault("0,0 1,0 1,1; 0,0"), &["loop 2 has 1 corners; the least is 3"]);
    assert_said(&fault("0,0 NaN,0 1,1"), &["\"NaN,0\" is no corner: write it as 12.5,30"]);
    assert_said(&fault(""), &["loop 1 has 0 corners; the least is 3"]);
}

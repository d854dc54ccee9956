//! The numbers of the source, to the digit: points, triangles and cutter locations of its pictures
//! (Sood 2015; the table in `spec/pictures.md`), its sizes, and its rule for points or mesh.

use crate::bench::{Bench, Report};

/// Canvas of the source, in mm.
const CANVAS_MM: f64 = 203.0;

/// The cutter dropped over a picture of this size, and its mesh, with nothing else set.
fn dropped(size: (u32, u32)) -> Report {
    let bench = Bench::new();
    bench.hills("hills.png", size);
    bench.run(&["relief", "--set", "image=hills.png", "--only", "drop", "--only", "mesh"])
}

fn choice(report: &Report) -> &str {
    report.fact("drop", "choice", "text").as_str().unwrap()
}

#[track_caller]
fn assert_counts(size: (u32, u32), points: u64, triangles: u64, cl_points: u64) {
    let report = dropped(size);
    assert_eq!(report.count("points", "points", "points"), points);
    assert_eq!(report.count("mesh", "mesh", "triangles"), triangles);
    assert_eq!(report.count("drop", "toolpath", "cl_points"), cl_points);
    assert_eq!(report.count("passes", "pattern", "points"), cl_points);
    assert!(choice(&report).starts_with("dropped on the points: "), "{}", choice(&report));
}

#[test]
fn a_picture_of_480_by_480_has_the_counts_of_the_source() {
    assert_counts((480, 480), 230_400, 458_882, 456_976);
}

#[test]
fn a_picture_of_1104_by_1392_has_the_counts_of_the_source() {
    assert_counts((1104, 1392), 1_536_768, 3_068_546, 363_549);
}

#[test]
fn a_picture_of_1024_by_640_has_the_counts_of_the_source() {
    assert_counts((1024, 640), 655_360, 1_307_394, 286_371);
}

#[test]
fn a_picture_of_618_by_328_has_the_counts_of_the_source() {
    assert_counts((618, 328), 202_704, 403_518, 242_684);
}

#[test]
fn a_picture_of_119_by_119_is_coarse_and_takes_the_mesh() {
    let report = dropped((119, 119));
    assert_eq!(report.count("points", "points", "points"), 14_161);
    assert_eq!(report.count("mesh", "mesh", "triangles"), 27_848);
    // 203/119 = 1.706 mm of a radius of 3 mm.
    assert_eq!(
        choice(&report),
        "dropped on the mesh: their distance, 1.706 mm, is 56.9 % of the cutter's radius, more than \
         20 %"
    );
    assert_eq!(report.node("drop")["notes"][0]["text"], choice(&report));
}

#[test]
fn the_choice_turns_at_a_fifth_of_the_radius() {
    let bench = Bench::new();
    bench.hills("hills.png", (100, 100));
    // 0.2 · 3 mm is a pitch of 0.6 mm: a canvas of 60 mm over 100 pixels.
    for (canvas, on) in [("60", "points"), ("60.01", "mesh")] {
        let canvas = format!("canvas_width={canvas}");
        let set = ["relief", "--only", "drop", "--set", "image=hills.png", "--set"];
        let report = bench.run(&[&set[..], &[&canvas]].concat());
        let wanted = format!("dropped on the {on}: ");
        assert!(choice(&report).starts_with(&wanted), "{canvas}: {}", choice(&report));
    }
}

#[test]
fn the_user_may_force_either() {
    let bench = Bench::new();
    bench.hills("hills.png", (100, 100));
    for on in ["points", "mesh"] {
        let surface = format!("surface={on}");
        let set = ["relief", "--only", "drop", "--set", "image=hills.png", "--set"];
        let report = bench.run(&[&set[..], &[&surface]].concat());
        let wanted = format!("dropped on the {on}: as set; ");
        assert!(choice(&report).starts_with(&wanted), "{}", choice(&report));
    }
}

#[test]
fn pictures_take_the_sizes_that_the_source_prints() {
    // Picture in px, size of the carving in mm as printed, hence to half of its last digit.
    let printed = [
        ((618, 328), (203.0, 107.74), 0.005),
        ((900, 600), (203.0, 135.33), 0.005),
        ((1024, 640), (203.0, 126.88), 0.005),
        ((640, 480), (203.0, 152.25), 0.005),
        ((1104, 1392), (161.0, 203.0), 0.05),
        ((700, 855), (166.2, 203.0), 0.05),
    ];
    for (size, (width_mm, height_mm), half_digit) in printed {
        let bench = Bench::new();
        bench.picture("picture.png", size, |x, _| x as u8);
        let report = bench.run(&["relief", "--set", "image=picture.png", "--only", "relief"]);
        let surface = |fact: &str| report.number("relief", "surface", fact);
        let pitch_mm = surface("pitch_mm");
        let carved = (f64::from(size.0) * pitch_mm, f64::from(size.1) * pitch_mm);
        assert!((carved.0 - width_mm).abs() <= half_digit, "{size:?}: {carved:?}");
        assert!((carved.1 - height_mm).abs() <= half_digit, "{size:?}: {carved:?}");
        assert!((carved.0.max(carved.1) - CANVAS_MM).abs() < 1e-9, "{size:?}: {carved:?}");
        // The surface ends in the middle of the last pixel.
        assert!((surface("width_mm") - (carved.0 - pitch_mm)).abs() < 1e-9);
        assert!((surface("height_mm") - (carved.1 - pitch_mm)).abs() < 1e-9);
    }
}

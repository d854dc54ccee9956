//! What a program does to a machine: where it may go fast, where it cuts, how it begins and ends.

use crate::bench::{Bench, QUICK};
use crate::gcode::{Motion, Move, Program, read};

/// The coarsest step of a program in mm, hence half of it by how much a coordinate may be rounded.
const HALF_STEP_MM: f64 = 0.0005 + 1e-9;

/// Heights of the recipe, in mm.
const SAFE_MM: f64 = 5.0;
const RADIUS_MM: f64 = 3.0;

/// A job of about 2000 points, so that each test reads all of it.
const SMALL: [&str; 17] = {
    let [a, b, c, d, e, f, g, h, i, j] = QUICK;
    let steps = ["--set", "stepover=0.7", "--set", "feed_step=0.6"];
    let [k, l, m, n] = steps;
    ["relief", "--set", "image=hills.png", a, b, c, d, e, f, g, h, i, j, k, l, m, n]
};

/// Carves hills of 50 × 40 pixels, a part of 29.4 × 23.4 mm.
fn carve(settings: &[&str]) -> (Bench, Program) {
    let bench = Bench::new();
    bench.hills("hills.png", (50, 40));
    let set = settings.iter().flat_map(|setting| ["--set", setting]);
    bench.run(&SMALL.iter().copied().chain(set).collect::<Vec<_>>());
    let name =
        bench.files("out").into_keys().find(|name| name.ends_with("nc") || name.ends_with("ngc"));
    let program = read(&bench.text(&format!("out/{}", name.unwrap())));
    assert!(program.moves.len() > 500, "{} moves", program.moves.len());
    (bench, program)
}

/// What holds of every program, `top_mm` being the program's Z of the part's highest point.
fn assert_safe(program: &Program, top_mm: f64) {
    let safe_mm = top_mm + SAFE_MM;
    let first = &program.moves[0];
    assert_eq!(first.motion, Motion::Rapid, "{first}");
    assert!(!first.travels() && first.z() >= safe_mm - 1e-9, "the first motion raises Z: {first}");
    for one in &program.moves {
        match one.motion {
            Motion::Rapid => assert_rapid(one, safe_mm),
            Motion::Feed => {
                assert!(one.mm_per_min.is_some(), "no feed in force: {one}");
                assert!(one.spindle_on, "the spindle stands: {one}");
                assert!(one.from.iter().all(Option::is_some), "from nowhere: {one}");
            }
        }
    }
    let last = program.moves.last().unwrap();
    assert_eq!(last.motion, Motion::Rapid, "{last}");
    assert!(last.z() >= safe_mm - 1e-9, "the last motion raises Z: {last}");
    assert!(!program.spindle_left_on, "the spindle turns on");
}

fn assert_rapid(one: &Move, safe_mm: f64) {
    if one.travels() {
        let from_mm = one.from[2].unwrap_or_else(|| panic!("from an unknown height: {one}"));
        assert!(from_mm.min(one.z()) >= safe_mm - 1e-9, "a rapid below the safe height: {one}");
        assert_eq!(one.from[2], one.to[2], "a rapid on all axes at once: {one}");
    } else if let Some(from_mm) = one.from[2] {
        assert!(one.z() >= from_mm, "a rapid straight down: {one}");
    }
}

/// Where the cutter goes while it cuts, plunges included.
fn cuts(program: &Program) -> impl Iterator<Item = [f64; 3]> {
    program.moves.iter().filter(|one| one.motion == Motion::Feed).map(Move::point)
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

#[test]
fn a_program_is_safe() {
    let (_, program) = carve(&[]);
    assert_safe(&program, 0.0);
    assert!(!program.inches);
    assert_eq!(program.end, "M30");
    // On the mesh the tip stays between the part's bottom and its top.
    let (_, program) = carve(&["surface=mesh"]);
    let (low, high) = range(cuts(&program).map(|point| point[2]));
    assert!(low >= -5.0 - 0.02 - HALF_STEP_MM && high <= HALF_STEP_MM, "{low} to {high}");
}

#[test]
fn a_program_for_linuxcnc_is_safe() {
    let (bench, program) = carve(&["dialect=linuxcnc"]);
    assert_safe(&program, 0.0);
    assert_eq!(program.end, "M2");
    let text = bench.text("out/hills.ngc");
    assert!(text.contains("\nG64 P0.01 Q0.01\n"), "{}", &text[..400]);
}

#[test]
fn every_dialect_writes_a_program() {
    let bench = Bench::new();
    bench.hills("hills.png", (50, 40));
    for line in bench.carve(&["dialects"]).out.lines() {
        let mut words = line.split_whitespace();
        let (name, extension) = (words.next().unwrap(), words.next().unwrap());
        let dialect = format!("dialect={name}");
        let out = format!("out/{name}");
        let report = bench.run(
            &[&SMALL[..], &["--set", &dialect, "--only", "save_gcode", "--out", &out]].concat(),
        );
        assert_eq!(report.fact("post", "program", "dialect"), name);
        let files = bench.files(&out);
        assert_eq!(files.keys().collect::<Vec<_>>(), [&format!("hills{extension}")]);
        let text = String::from_utf8_lossy(&files[&format!("hills{extension}")]).to_lowercase();
        assert!(text.lines().count() > 500, "{name}");
        for word in ["nan", "inf"] {
            assert!(!text.contains(word), "{name}: {word}");
        }
    }
}

#[test]
fn plunges_go_slower_than_cuts() {
    let (_, program) = carve(&["feed=1200", "plunge=10mm/s"]);
    for one in program.moves.iter().filter(|one| one.motion == Motion::Feed) {
        let straight_down = !one.travels() && one.from[2].unwrap() == SAFE_MM;
        let wanted = if straight_down { 600.0 } else { 1200.0 };
        assert_eq!(one.mm_per_min, Some(wanted), "{one}");
    }
    let plunges = program.moves.iter().filter(|one| one.mm_per_min == Some(600.0));
    assert_eq!(plunges.count(), 1, "a zigzag stays on the surface from pass to pass");
}

#[test]
fn one_way_passes_are_lifted_over() {
    let (_, program) = carve(&["passes.style=one_way"]);
    assert_safe(&program, 0.0);
    let travels = program.moves.iter().filter(|one| one.motion == Motion::Rapid && one.travels());
    // 34 passes, floor(23.4 / 0.7) + 1: one way to the first and one to each of the others.
    assert_eq!(travels.count(), 34);
    for one in program.moves.iter().filter(|one| one.motion == Motion::Feed && one.travels()) {
        let (from, to) = (one.from.map(Option::unwrap), one.point());
        assert!(to[0] > from[0], "against the way: {one}");
        assert_eq!(to[1], from[1], "across: {one}");
    }
}

#[test]
fn passes_run_along_the_longer_side() {
    let bench = Bench::new();
    for (size, along, across) in [((50, 40), 0, 1), ((40, 50), 1, 0)] {
        bench.hills("hills.png", size);
        bench.run(&SMALL);
        let program = read(&bench.text("out/hills.nc"));
        let cuts: Vec<_> = program.moves.iter().filter(|m| m.motion == Motion::Feed).collect();
        let moved = |axis: usize| cuts.iter().filter(|m| m.from[axis] != m.to[axis]).count();
        assert!(moved(along) > 10 * moved(across), "{size:?}: {} {}", moved(along), moved(across));
    }
}

#[test]
fn bottom_and_corner_are_the_frame_of_the_saved_mesh() {
    let (bench, program) = carve(&[
        "z_zero=bottom",
        "xy_zero=corner",
        "surface=points",
        "reduce=none",
        "save_mesh=ascii",
        "z_min=1",
    ]);
    assert_safe(&program, 5.0);
    let vertices: Vec<[f64; 3]> = bench.text("out/hills.stl").lines().filter_map(vertex).collect();
    // Two triangles a cell.
    assert_eq!(vertices.len(), 49 * 39 * 6);
    // A ball rests on the points: each lies outside of it, and one of them on it.
    let rest = |[x, y, _]: [f64; 3]| {
        let touch = |q: &[f64; 3]| {
            let square = (q[0] - x).powi(2) + (q[1] - y).powi(2);
            (square <= RADIUS_MM.powi(2))
                .then(|| q[2] - RADIUS_MM + (RADIUS_MM.powi(2) - square).sqrt())
        };
        vertices.iter().filter_map(touch).fold(f64::NEG_INFINITY, f64::max)
    };
    let (bottom, top) = range(vertices.iter().map(|q| q[2]));
    assert_eq!((bottom, top), (1.0, 5.0));
    for point in cuts(&program).filter(|point| point[2] < top + SAFE_MM) {
        let wanted = rest(point);
        // X and Y are rounded too, on a slope of the ball or the part of less than 2.
        assert!((point[2] - wanted).abs() < 3.0 * HALF_STEP_MM, "{point:?}: {wanted}");
    }
}

fn vertex(line: &str) -> Option<[f64; 3]> {
    let words = line.trim().strip_prefix("vertex ")?;
    let lengths: Vec<f64> = words.split(' ').map(|word| word.parse().unwrap()).collect();
    lengths.try_into().ok()
}

#[test]
fn the_frames_differ_by_their_origins() {
    let (_, corner) = carve(&["z_zero=bottom"]);
    for (settings, shift) in [
        (["z_zero=top", "xy_zero=corner"], [0.0, 0.0, -5.0]),
        (["z_zero=bottom", "xy_zero=center"], [-14.7, -11.7, 0.0]),
        (["z_zero=top", "xy_zero=center"], [-14.7, -11.7, -5.0]),
    ] {
        let (_, program) = carve(&settings);
        assert_eq!(program.moves.len(), corner.moves.len());
        for (one, other) in program.moves.iter().zip(&corner.moves).skip(3) {
            let (one, other) = (one.point(), other.point());
            for axis in 0..3 {
                let off = one[axis] - other[axis] - shift[axis];
                assert!(off.abs() <= 2.0 * HALF_STEP_MM, "{settings:?}: {one:?} {other:?}");
            }
        }
    }
}

#[test]
fn a_program_in_inches_goes_to_the_same_places() {
    let (_, mm) = carve(&["reduce=none"]);
    let (_, inch) = carve(&["reduce=none", "post.units=inch"]);
    assert!(inch.inches);
    assert_safe(&inch, 0.0);
    // A block that moves nothing is left out, and the grid of inches is another one.
    let ends = |program: &Program| (program.moves.len(), range(cuts(program).map(|p| p[2])));
    let ((many, (low, high)), (few, (inch_low, inch_high))) = (ends(&mm), ends(&inch));
    assert!(many.abs_diff(few) <= many / 100, "{many} {few}");
    assert!((low - inch_low).abs() < 0.002 && (high - inch_high).abs() < 0.002);
    let (x, inch_x) = (range(cuts(&mm).map(|p| p[0])), range(cuts(&inch).map(|p| p[0])));
    assert!((x.1 - inch_x.1).abs() < 0.002 && x.1 > 29.0, "{x:?} {inch_x:?}");
    let fastest = |program: &Program| {
        program.moves.iter().filter_map(|one| one.mm_per_min).fold(0.0, f64::max)
    };
    assert!((fastest(&inch) - fastest(&mm)).abs() < 0.1, "the feed is an inch's too");
}

#[test]
fn an_angle_turns_the_passes_and_keeps_them_on_the_part() {
    let (_, program) = carve(&["passes.angle=30deg"]);
    assert_safe(&program, 0.0);
    let (x, y) = (range(cuts(&program).map(|p| p[0])), range(cuts(&program).map(|p| p[1])));
    assert!(x.0 >= -HALF_STEP_MM && x.1 <= 29.4 + HALF_STEP_MM, "{x:?}");
    assert!(y.0 >= -HALF_STEP_MM && y.1 <= 23.4 + HALF_STEP_MM, "{y:?}");
}

#[test]
fn reducing_keeps_the_ends_of_passes_and_its_tolerance() {
    for method in ["z_band", "chord"] {
        let bench = Bench::new();
        bench.hills("hills.png", (50, 40));
        let method = format!("reduce={method}");
        let report =
            bench.run(&[&SMALL[..], &["--set", &method, "--set", "tolerance=0.05"]].concat());
        let (before, after) = (
            report.count("reduce", "reduction", "points_in"),
            report.count("reduce", "reduction", "points_out"),
        );
        assert!(after < before && after >= 2 * report.count("reduce", "toolpath", "passes"));
        // The source's rule may double its band; the chord keeps the tolerance.
        let limit_mm = if method == "reduce=chord" { 0.05 } else { 0.1 };
        let deviation_mm = report.number("reduce", "reduction", "max_deviation_mm");
        assert!(deviation_mm > 0.0 && deviation_mm <= limit_mm + 1e-9, "{method}: {deviation_mm}");
    }
}

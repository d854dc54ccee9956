//! The programs of all dialects read alike, and what no machine should do is found.

use super::*;
use crate::check::follow::follows;
use crate::job::testing::{ball, flat};
use crate::values::ToolUse;
use carvegraph_geometry::{MoveKind, PathArc};

/// The small job of the dialects' own tests, in all dialects: arcs in all planes, helices, full circles
/// and, where they can, two tools.
macro_rules! golden {
    ($($dialect:literal $extension:literal),*) => {
        [$(
            ($dialect, include_str!(concat!("../../../../plugins/dialects/tests/golden/small.", $dialect, ".", $extension))),
            ($dialect, include_str!(concat!("../../../../plugins/dialects/tests/golden/small_inch.", $dialect, ".", $extension)))
        ),*]
    };
}

const GOLDEN: [(&str, &str); 24] = golden![
    "fanuc" "nc", "fluidnc" "nc", "grbl" "nc", "haas" "nc", "heidenhain" "h", "iso6983" "nc",
    "linuxcnc" "ngc", "mach3" "tap", "marlin" "gcode", "shopbot" "sbp", "siemens" "mpf",
    "uccnc" "nc"
];

fn read(text: &str, dialect: &str) -> Machining {
    let cutter = |number| ToolUse {
        number: Some(number),
        cutter: if number == 1 { ball(6.0) } else { flat(3.0) },
        operations: String::new(),
    };
    let program = ProgramText {
        name: String::new(),
        tools: vec![cutter(1), cutter(2)],
        text: text.as_bytes().to_vec(),
    };
    let (dialect, extension) = (dialect.to_owned(), "nc".to_owned());
    let code = Gcode { programs: vec![program], dialect, extension, zero: Some(DVec3::ZERO) };
    read_programs(&code, DVec3::ZERO, &ball(6.0), &[], &|| true).unwrap()
}

/// A program in mm with the spindle turning, 5 mm above X1 Y2.
fn told(body: &str) -> Machining {
    read(&format!("G21 G90\nM3 S9000\nG0 Z5\nX1 Y2\n{body}\nG0 Z5\nM5\nM30\n"), "grbl")
}

/// Line and text of what is wrong.
fn faults(machining: &Machining) -> Vec<(u32, &str)> {
    machining.faults.iter().map(|fault| (fault.line, fault.text.as_str())).collect()
}

#[track_caller]
fn finds(body: &str, line: u32, text: &str) {
    let machining = told(body);
    let found = faults(&machining);
    assert!(found.iter().any(|(at, what)| *at == line && what.contains(text)), "{body}: {found:?}");
}

fn tips(machining: &Machining) -> Vec<[f64; 3]> {
    machining.legs().map(|(_, moved)| moved.to.to_array()).collect()
}

/// Arcs become lines in some dialects, which stay within 0.01 mm; an inch has four decimals.
#[test]
fn all_dialects_make_the_same_moves() {
    let grbl = read(GOLDEN[4].1, "grbl");
    assert!(grbl.runs[0].motion.moves.iter().any(|m| matches!(m.kind, MoveKind::Arc { .. })));
    for (dialect, text) in GOLDEN {
        let read = read(text, dialect);
        assert_eq!(faults(&read), [], "{dialect}");
        let motions = |machining: &'_ Machining| -> Vec<Motion> {
            machining.runs.iter().map(|run| run.motion.clone()).collect()
        };
        let (meant, read_back) = (motions(&grbl), motions(&read));
        let worst = follows(meant.iter(), read_back.iter(), 0.025);
        assert!(worst.is_ok(), "{dialect}: {worst:?}");
        let dwell: f64 = read.runs.iter().map(|run| run.dwell_s).sum();
        assert!(dwell > 0.4 && dwell < 10.0, "{dialect} waits {dwell} s");
        let tools = !["grbl", "marlin"].contains(&dialect);
        let cutters: Vec<f64> =
            read.runs.iter().map(|run| 2.0 * run.cutter.profile.radius_mm()).collect();
        assert_eq!(cutters, if tools { vec![6.0, 3.0] } else { vec![6.0] }, "{dialect}");
    }
}

#[test]
fn feeds_are_in_mm_per_minute() {
    for (dialect, text) in GOLDEN {
        let read = read(text, dialect);
        let slowest = read.legs().map(|(_, m)| m.mm_per_min).fold(f64::INFINITY, f64::min);
        assert!((slowest - 200.0).abs() < 0.5, "{dialect}: {slowest}");
    }
}

#[test]
fn words_may_stand_close_and_comments_anywhere() {
    let read = told("N10g1z-1f300(down)X2;and across");
    assert_eq!(tips(&read), [[2.0, 2.0, -1.0], [2.0, 2.0, 5.0]]);
    assert_eq!(faults(&read), []);
}

#[test]
fn coordinates_may_count_from_where_the_tip_is() {
    let read = told("G91\nG1 Z-6 F300\nX2 Y-1\nG90");
    assert_eq!(tips(&read)[..2], [[1.0, 2.0, -1.0], [3.0, 1.0, -1.0]]);
}

#[test]
fn a_radius_means_the_short_arc_and_a_negative_one_the_long() {
    let arc = |radius: &str| {
        let read = told(&format!("G1 Z0 F300\nG2 X3 Y4 R{radius}"));
        let motion = &read.runs[0].motion;
        let (from, moved) = motion.legs().nth(1).unwrap();
        motion.arc(moved).unwrap().sweep_rad(from, moved.to).to_degrees()
    };
    assert!((arc("2") - 90.0).abs() < 1e-9 && (arc("-2") - 270.0).abs() < 1e-9);
}

#[test]
fn centers_may_be_absolute() {
    let read = told("G90.1\nG1 Z0 F300\nG3 X3 Y4 I1 J4");
    let motion = &read.runs[0].motion;
    let arc: &PathArc = &motion.arcs[0];
    assert_eq!((arc.center.x, arc.center.y), (1.0, 4.0));
    assert_eq!(faults(&read), []);
}

#[test]
fn machine_places_are_left_by_way_of_the_top() {
    let read = told("G1 Z-1 F300\nG53 G0 Z0\nX9 Y9\nZ1\nG1 Z-1");
    let [.., before, down, _] = &tips(&read)[..] else { panic!() };
    assert_eq!((*before, *down), ([9.0, 9.0, 1.0], [9.0, 9.0, -1.0]));
    assert!(tips(&read).contains(&[1.0, 2.0, 5.0]), "up before across: {:?}", tips(&read));
}

#[test]
fn what_no_machine_should_do_is_found() {
    finds("G1 Z-1", 5, "no feed is in force");
    finds("M5\nG1 Z-1 F300", 6, "spindle standing still");
    finds("G1 Z-1 F300\nG20\nX3", 6, "changes between millimetres and inches");
    finds("G1 Z-1 F0", 5, "its feed is 0");
    finds("G1 Z0 F300\nG2 X3 Y4 I2 J1", 6, "begins 2.236 mm from its centre");
    finds("G28\nG1 Z-1 F300", 6, "before it is known where the tip is");
    finds("M64\n", 5, "M64 is not known");
    finds("T7 M6\nM3", 5, "it puts in tool 7, and the job has 1 (ball");
    let lost_unit = read("G90\nM3 S9\nG0 Z5\nX1 Y1\nM30\n", "grbl");
    assert!(faults(&lost_unit)[0].1.contains("whether in mm or in inches"));
    let cut_off = read("G21 G90\nM3 S9\nG0 Z5\nX1 Y1\n", "grbl");
    assert_eq!(faults(&cut_off)[0].0, 4);
    assert!(faults(&cut_off)[0].1.contains("without an end of the program"));
}

#[test]
fn reading_ends_where_it_cannot_follow() {
    for (body, text) in [
        ("G1 X[1+2] F100", "\"X[1+2]\" is no word"),
        ("#1=5", "is no word"),
        ("G81 Z-3 R1 F100", "G81 is a canned cycle"),
        ("G92 X0", "G92 shifts or turns the zero"),
        ("M98 P100", "M98 calls another program"),
        ("G93", "another measure"),
        ("G6", "G6 is not known"),
        ("G1 X1 X2 F100", "X stands in it twice"),
        ("G1 A90 F100", "moves the axis A"),
        ("(open", "a comment is not closed"),
        ("G2 X50 R2 F100", "does not reach"),
        ("$H", "is no word"),
        ("G1 X1e5", "nor are exponents"),
    ] {
        finds(body, 5, text);
        finds(body, 5, "what comes after it is not read");
    }
}

#[test]
fn a_fault_that_repeats_is_told_a_few_times_only() {
    let body: String = (0..100).map(|k| format!("G1 X{k}.5 F100\n")).collect();
    let read = told(&format!("M5\n{body}"));
    assert_eq!(faults(&read).len(), 5);
}

#[test]
fn languages_are_told_apart_by_their_text() {
    for (dialect, text) in GOLDEN {
        let language = match dialect {
            "heidenhain" => Language::Heidenhain,
            "shopbot" => Language::ShopBot,
            _ => Language::WordAddress,
        };
        assert_eq!(Language::of(text), language, "{dialect}");
    }
    assert_eq!(Language::of("* 3\n* 4\n"), Language::Unknown);
    assert!(!read("* 3\n", "paper_tape").readable);
}

#[test]
fn nothing_that_is_read_makes_it_panic() {
    let mut seed = 5_u64;
    let mut random = |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize % below
    };
    for (dialect, text) in GOLDEN {
        for _ in 0..60 {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..1 + random(6) {
                let at = random(bytes.len());
                match random(3) {
                    0 => bytes[at] = random(256) as u8,
                    1 => drop(bytes.remove(at)),
                    _ => bytes.insert(at, b" .-XG0(;\n"[random(9)]),
                }
            }
            read(&String::from_utf8_lossy(&bytes), dialect);
        }
    }
}

#[test]
fn it_stops_when_told() {
    let program = ProgramText { name: String::new(), tools: vec![], text: b"G21\n".to_vec() };
    let code = Gcode {
        programs: vec![program],
        dialect: "grbl".into(),
        extension: "nc".into(),
        zero: None,
    };
    assert_eq!(read_programs(&code, DVec3::ZERO, &ball(6.0), &[], &|| false), None);
}

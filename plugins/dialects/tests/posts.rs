//! What must hold for every dialect, read back the way a controller would.

#![allow(clippy::unwrap_used, reason = "a failing helper fails its test")]

mod jobs;

use carvegraph_dialects::standard;
use carvegraph_sdk::{Arc, Command, Direction, Plane, PostError, Program, Units};
use jobs::reader::{read, rules};
use jobs::{Job, compare, dialect};
use std::io;

fn refusal(job: &Job) -> String {
    let messages: Vec<String> =
        standard().iter().map(|d| job.post(&**d).unwrap_err().to_string()).collect();
    assert!(messages.windows(2).all(|m| m[0] == m[1]), "{messages:?}");
    messages[0].clone()
}

fn blocks(job: &Job, name: &str) -> Vec<String> {
    let text = job.post(&*dialect(name)).unwrap();
    text.lines().map(str::to_owned).collect()
}

#[test]
fn dialects_are_sorted_and_documented() {
    let names: Vec<String> = standard().iter().map(|d| d.name().to_owned()).collect();
    assert_eq!(names, ["grbl", "linuxcnc"]);
    assert!(standard().iter().all(|d| !d.about().is_empty() && !d.extension().is_empty()));
}

#[test]
fn what_is_read_is_what_was_meant() {
    for dialect in standard() {
        for units in [Units::Mm, Units::Inch] {
            for mut job in [jobs::small(), jobs::long(units)] {
                job.units = units;
                let text = job.post(&*dialect).unwrap();
                let read = read(&text, &rules(dialect.name()));
                compare(&job.meant(), &read, units);
            }
        }
    }
}

#[test]
fn the_first_motion_raises_z() {
    for dialect in standard() {
        let text = Job::at(3.0, 4.0).post(&*dialect).unwrap();
        let motion: Vec<&str> = text.lines().filter(|l| l.contains(['X', 'Z'])).collect();
        assert_eq!(motion, ["G0 Z5.0", "X3.0 Y4.0"]);
    }
}

#[test]
fn rapids_rise_first_and_sink_last() {
    let mut job = Job::at(0.0, 0.0);
    job.rapid([1.0, 2.0, 9.0]);
    job.rapid([3.0, 4.0, 2.0]);
    job.rapid([3.0, 4.0, 2.0]);
    let lines = blocks(&job, "grbl");
    assert_eq!(lines[5..], ["Z9.0", "X1.0 Y2.0", "X3.0 Y4.0", "Z2.0", "M5", "M30"]);
}

#[test]
fn words_stand_only_where_they_change_something() {
    let mut job = Job::at(0.0, 0.0);
    job.feed([0.0, 0.0, -1.0], 100.0);
    job.feed([1.0, 0.0, -1.0], 600.0);
    job.feed([1.000_3, 0.0, -1.0], 700.0);
    job.feed([2.0, 0.0, -1.0], 600.0);
    job.rapid([2.0, 0.0, 5.0]);
    job.feed([2.0, 0.0, -1.0], 600.0);
    let lines = blocks(&job, "linuxcnc");
    let expected = ["G1 Z-1.0 F100.0", "X1.0 F600.0", "X2.0", "G0 Z5.0", "G1 Z-1.0", "M5", "M2"];
    assert_eq!(lines[5..], expected);
}

#[test]
fn the_head_says_what_the_controller_needs() {
    let job = Job::at(0.0, 0.0);
    assert_eq!(blocks(&job, "grbl")[..3], ["G17 G21 G90 G94", "M3 S12000", "G4 P3.0"]);
    let head = ["G17 G21 G40 G80 G90 G94 G91.1", "G64 P0.01 Q0.01", "M3 S12000"];
    assert_eq!(blocks(&job, "linuxcnc")[..3], head);
    let inches = Job { units: Units::Inch, ..job };
    assert_eq!(blocks(&inches, "grbl")[0], "G17 G20 G90 G94");
    assert_eq!(blocks(&inches, "linuxcnc")[1], "G64 P0.0003 Q0.0003");
}

#[test]
fn the_spindle_is_waited_for_when_it_starts_or_turns_around() {
    let spindle = |rpm, direction| Command::Spindle { rpm, direction };
    let commands = vec![
        spindle(1000.0, Direction::Clockwise),
        spindle(2000.4, Direction::Clockwise),
        spindle(2000.0, Direction::CounterClockwise),
        Command::SpindleStop,
    ];
    let job = Job { commands, ..Job::default() };
    let expected = ["M3 S1000", "G4 P3.0", "M3 S2000", "M4 S2000", "G4 P3.0", "M5", "M5", "M30"];
    assert_eq!(blocks(&job, "grbl")[1..], expected);
}

#[test]
fn no_text_gets_out_of_its_comment() {
    let hostile = [
        ")\nG0 Z-50",
        "a) G0 Z-50 (",
        "x\r\nM3 S99999\r\n",
        ";\u{0}!\u{18}?~\u{84}\u{85}\u{2028}",
        "LOGOPEN,/tmp/log",
        "py,import os",
        "MSG,$H",
        "((((nested))))",
        "%",
        "é∅漢字🔧 %x=[1+1]",
    ];
    for dialect in standard() {
        for text in hostile {
            for text in [text.to_owned(), format!("{}{text}", "word ".repeat(30)), text.repeat(500)]
            {
                let mut job = Job::at(0.0, 0.0);
                job.title = text.clone();
                job.remarks = vec![text.clone(); 3];
                job.comment(&text);
                let program = job.post(&*dialect).unwrap();
                let moves = read(&program, &rules(dialect.name()));
                compare(&job.meant(), &moves, Units::Mm);
                assert!(program.lines().count() < 40, "{program}");
            }
        }
    }
}

#[test]
fn grbl_refuses_a_tool_change() {
    let mut job = Job::at(0.0, 0.0);
    job.commands.push(Command::ToolChange { number: 2 });
    assert_eq!(
        job.post(&*dialect("grbl")).unwrap_err().to_string(),
        "command 2: grbl has no tool change (M6): write one program for each tool"
    );
    assert!(!dialect("grbl").capabilities().tool_change);
}

#[test]
fn after_a_tool_change_everything_is_said_again() {
    let mut job = Job::at(1.0, 2.0);
    job.feed([1.0, 2.0, -1.0], 100.0);
    job.rapid([1.0, 2.0, 5.0]);
    job.commands.push(Command::ToolChange { number: 7 });
    let change = job.commands.len();
    job.commands.push(Command::Spindle { rpm: 5000.0, direction: Direction::Clockwise });
    job.rapid([1.0, 2.0, 5.0]);
    job.feed([1.0, 2.0, -1.0], 100.0);
    let expected = ["M5", "T7 M6", "G43", "M3 S5000", "G0 Z5.0", "X1.0 Y2.0", "G1 Z-1.0 F100.0"];
    assert_eq!(blocks(&job, "linuxcnc")[7..14], expected);

    let mut still = job.clone();
    still.commands.remove(change);
    let error = still.post(&*dialect("linuxcnc")).unwrap_err().to_string();
    assert_eq!(
        error,
        "command 6 cuts with the spindle stopped by a tool change; start it again first"
    );
    for number in [0, 100_000] {
        job.commands[change - 1] = Command::ToolChange { number };
        let error = job.post(&*dialect("linuxcnc")).unwrap_err().to_string();
        let words = format!("command 4: there is no tool {number}; tools are numbered 1 to 99999");
        assert_eq!(error, words);
    }
}

#[test]
fn a_cut_from_nowhere_is_refused() {
    let mut job = Job::default();
    job.feed([0.0; 3], 100.0);
    assert_eq!(
        refusal(&job),
        "command 0 cuts before it is known where the tip is; begin the program, and go on after a \
         tool change, with a rapid to above the work"
    );
}

#[test]
fn numbers_that_are_none_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.1e6, -1e300] {
        for axis in 0..3 {
            let mut to = [0.0; 3];
            to[axis] = bad;
            let mut fed = Job::at(0.0, 0.0);
            fed.feed(to, 100.0);
            let name = ['X', 'Y', 'Z'][axis];
            let words = format!("command 2: {name} is {bad} mm; it must lie within ±1000000 mm");
            assert_eq!(refusal(&fed), words);
            let mut rapid = Job::at(0.0, 0.0);
            rapid.rapid(to);
            assert_eq!(refusal(&rapid), words);
        }
    }
}

#[test]
fn feeds_speeds_and_dwells_that_are_none_are_refused() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 0.000_4, 2e6] {
        let mut job = Job::at(0.0, 0.0);
        job.feed([0.0, 0.0, 1.0], bad);
        let words = format!(
            "command 2: a feed of {bad} mm/min cannot be written; give one above 0 and at most \
             1000000 mm/min"
        );
        assert_eq!(refusal(&job), words);
    }
    for bad in [0.0, 0.4, -1.0, f64::NAN, f64::INFINITY] {
        let mut job = Job::at(0.0, 0.0);
        job.commands.push(Command::Spindle { rpm: bad, direction: Direction::Clockwise });
        let words = format!(
            "command 2: a spindle speed of {bad} rpm cannot be written; give 1 to 5000000 rpm"
        );
        assert_eq!(refusal(&job), words);
    }
    for (bad, limit) in [(-1.0, 3276), (f64::NAN, 3276), (3277.0, 3276)] {
        let mut job = Job::at(0.0, 0.0);
        job.commands.push(Command::Dwell { seconds: bad });
        let words = format!("command 2: a dwell of {bad} s cannot be written; give 0 to {limit} s");
        assert_eq!(job.post(&*dialect("grbl")).unwrap_err().to_string(), words);
    }
}

#[test]
fn indices_outside_their_table_are_refused() {
    let mut job = Job::at(0.0, 0.0);
    job.commands.push(Command::Arc { arc: 3 });
    assert_eq!(refusal(&job), "command 2 refers to arc 3, but there are only 0");
    job.commands[2] = Command::Comment { text: 0 };
    assert_eq!(refusal(&job), "command 2 refers to text 0, but there are only 0");
}

fn arc(center: [f64; 3], to: [f64; 3]) -> Arc {
    Arc { plane: Plane::Xy, direction: Direction::CounterClockwise, center, to, mm_per_min: 100.0 }
}

#[test]
fn arcs_that_are_none_are_refused() {
    let with = |arc| {
        let mut job = Job::at(0.0, 0.0);
        job.arc(arc);
        refusal(&job)
    };
    assert_eq!(
        with(arc([1.0, 0.0, 5.0], [2.1, 0.0, 5.0])),
        "command 2: the arc starts 1 mm from its centre and ends 1.1 mm from it; the two may differ \
         by 0.001 mm"
    );
    assert_eq!(
        with(arc([20_000.0, 0.0, 5.0], [40_000.0, 0.0, 5.0])),
        "command 2: the arc's radius is 20000 mm; above 10000 mm use lines"
    );
    assert_eq!(
        with(arc([f64::NAN, 0.0, 5.0], [2.0, 0.0, 5.0])),
        "command 2: X is NaN mm; it must lie within ±1000000 mm"
    );
}

#[test]
fn arcs_too_small_to_write_become_lines_or_nothing() {
    let mut job = Job::at(0.0, 0.0);
    job.arc(arc([0.000_2, 0.0, 5.0], [0.000_4, 0.0, 5.0]));
    job.arc(arc([0.000_4, 1000.0, 5.0], [0.5, 1000.0 - (1e6_f64 - 0.249_6).sqrt(), 5.0]));
    job.arcs[1].to[1] = 1000.0 - (1e6_f64 - (0.5_f64 - 0.000_4).powi(2)).sqrt();
    let lines = blocks(&job, "grbl");
    assert_eq!(lines[5..], ["G1 X0.5 F100.0", "M5", "M30"]);
}

#[test]
fn full_circles_and_helices_stay_whole() {
    let mut job = Job::at(1.0, 0.0);
    job.feed([1.0, 0.0, 0.0], 100.0);
    job.arc(arc([0.0; 3], [1.0, 0.0, 0.0]));
    job.arc(arc([0.0; 3], [1.0, 0.0, -1.0]));
    let lines = blocks(&job, "grbl");
    let expected = ["G3 X1.0 Y0.0 I-1.0 J0.0", "X1.0 Y0.0 Z-1.0 I-1.0 J0.0"];
    assert_eq!(lines[6..8], expected);
}

#[test]
fn the_longest_block_fits() {
    let far = 999_999.999;
    let mut job = Job::at(-far, -far);
    job.feed([-far, -far, -far], 999_999.999);
    let mut long = arc([-far + 8_888.888, -far, -far], [-far, -far, far - 0.001]);
    long.mm_per_min = 999_999.998;
    job.arc(long);
    for dialect in standard() {
        read(&job.post(&*dialect).unwrap(), &rules(dialect.name()));
    }
}

#[test]
fn a_sink_can_cancel() {
    struct Full(usize);
    impl io::Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 += bytes.len();
            if self.0 > 100_000 { Err(io::Error::other("enough")) } else { Ok(bytes.len()) }
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let to = |k: usize| [k as f64, 0.0, 0.0];
    let mut commands = vec![Command::Rapid { to: to(0) }];
    commands.extend((1..100_000).map(|k| Command::Feed { to: to(k), mm_per_min: 1.0 }));
    let program = Program { commands: &commands, ..Program::default() };
    let mut sink = Full(0);
    let error = dialect("grbl").post(&program, &mut sink).unwrap_err();
    assert!(matches!(error, PostError::Io(_)));
    assert!(sink.0 < 200_000, "went on for {} bytes", sink.0);
}

#[test]
fn a_path_tolerance_must_be_a_length() {
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let program = Program { path_tolerance_mm: tolerance, ..Program::default() };
        let error = dialect("linuxcnc").post(&program, &mut io::sink()).unwrap_err();
        let words = format!("the path tolerance is {tolerance} mm; it must be above 0");
        assert_eq!(error.to_string(), words);
    }
    let program = Program { path_tolerance_mm: 1e-9, ..Program::default() };
    let mut out = Vec::new();
    dialect("linuxcnc").post(&program, &mut out).unwrap();
    let text = String::from_utf8(out).unwrap();
    assert!(text.contains("G64 P0.001 Q0.001"), "0 would mean any: {text}");
}

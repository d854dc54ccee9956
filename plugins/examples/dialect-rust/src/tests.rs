//! What the dialect writes, and what it refuses to.

use super::*;
use carvegraph_sdk::conformance::dialect::{Arcs, Reading, check};
use carvegraph_sdk::{Arc, Plane};

const ABOVE: Command = Command::Rapid { to: [10.0, 20.0, 5.0] };
const PLUNGE: Command = Command::Feed { to: [10.0, 20.0, -1.0], mm_per_min: 300.0 };

fn post(program: &Program<'_>) -> Result<String, String> {
    let mut out = Vec::new();
    Kestrel.post(program, &mut out).map_err(|fault| fault.to_string())?;
    Ok(String::from_utf8(out).unwrap())
}

/// The blocks of some commands without numbers, head and end.
fn blocks(commands: &[Command], arcs: &[Arc], units: Units) -> Result<Vec<String>, String> {
    let texts = &["first pass"];
    let text = post(&Program { commands, arcs, units, texts, ..Program::default() })?;
    let blocks: Vec<_> =
        text.lines().map(|line| line.trim_start_matches(|c| c != ' ').trim()).collect();
    Ok(blocks[2..blocks.len() - 3].iter().map(|&block| block.to_owned()).collect())
}

fn arc(plane: Plane, center: [f64; 3], to: [f64; 3]) -> Arc {
    Arc { plane, direction: Direction::CounterClockwise, center, to, mm_per_min: 600.0 }
}

/// All that carve expects of a dialect, read back the way the control would.
#[test]
fn it_keeps_its_promises() {
    let arcs = Arcs {
        xy_only: true,
        flat_only: true,
        sweep_limit_deg: 180.0,
        tolerance_mm: 0.01,
        least_radius_mm: 0.0,
        ..Arcs::default()
    };
    let reading = Reading {
        units: ["G71", "G70"],
        decimals: [4, 4],
        feed_steps: [0.000_1, 0.000_1],
        whole: "SP",
        dwell: ('P', 1000.0),
        comment: [";", ""],
        first: &["%"],
        last: &["%"],
        numbered: Some(('N', 10)),
        modal: false,
        arcs,
        ..Reading::default()
    };
    check(&Kestrel, &reading);
}

#[test]
fn a_program_reads_as_in_the_manual() {
    let commands = [
        Command::Spindle { direction: Direction::Clockwise, rpm: 12_000.0 },
        Command::Dwell { seconds: 2.5 },
        ABOVE,
        Command::Comment { text: 0 },
        PLUNGE,
        Command::Feed { to: [10.5, 20.0, -1.25], mm_per_min: 900.0 },
        Command::Feed { to: [11.0, 20.0, -1.25], mm_per_min: 900.0 },
        Command::Rapid { to: [0.0, 0.0, 5.0] },
    ];
    let (title, texts, remarks) = ("Medallion", &["first pass"], &["Ball 6 mm"]);
    let program = Program { title, remarks, texts, commands: &commands, ..Program::default() };
    let expected = "%\n; - MEDALLION\n; - BALL 6 MM\nN10 G71 G90 G94 G17\nN20 S12000 M03\n\
        N30 G04 P2500\nN40 G00 Z5.0000\nN50 G00 X10.0000 Y20.0000\n; - FIRST PASS\n\
        N60 G01 Z-1.0000 F300.0000\nN70 G01 X10.5000 Z-1.2500 F900.0000\nN80 G01 X11.0000\n\
        N90 G00 Z5.0000\nN100 G00 X0.0000 Y0.0000\nN110 M05\nN120 M30\n%\n";
    assert_eq!(post(&program).unwrap(), expected.replace('\n', "\r\n"));
}

#[test]
fn inches_are_inches() {
    let commands = [
        Command::Rapid { to: [25.4, -25.4, 12.7] },
        Command::Feed { to: [25.4, -25.4, 0.0], mm_per_min: 254.0 },
    ];
    let expected = ["G00 Z0.5000", "G00 X1.0000 Y-1.0000", "G01 Z0.0000 F10.0000"];
    assert_eq!(blocks(&commands, &[], Units::Inch).unwrap(), expected);
}

#[test]
fn rapids_go_up_first_and_down_last() {
    let commands =
        [ABOVE, Command::Rapid { to: [0.0, 20.0, 9.0] }, Command::Rapid { to: [0.0, 0.0, 1.0] }];
    let expected = ["G00 Z9.0000", "G00 X0.0000", "G00 Y0.0000", "G00 Z1.0000"];
    assert_eq!(blocks(&commands, &[], Units::Mm).unwrap()[2..], expected);
}

#[test]
fn a_circle_is_four_quarters() {
    let circle = arc(Plane::Xy, [12.0, 20.0, 0.0], [10.0, 20.0, -1.0]);
    let written = blocks(&[ABOVE, PLUNGE, Command::Arc { arc: 0 }], &[circle], Units::Mm).unwrap();
    let expected = [
        "G03 X12.0000 Y18.0000 I2.0000 J0.0000 F600.0000",
        "G03 X14.0000 Y20.0000 I0.0000 J2.0000",
        "G03 X12.0000 Y22.0000 I-2.0000 J0.0000",
        "G03 X10.0000 Y20.0000 I0.0000 J-2.0000",
    ];
    assert_eq!(written[3..], expected);
}

#[test]
fn other_arcs_are_chords_that_end_where_they_should() {
    let helix = arc(Plane::Xy, [12.0, 20.0, 0.0], [14.0, 20.0, -2.0]);
    let upright = arc(Plane::Zx, [11.0, 20.0, -1.0], [12.0, 20.0, -1.0]);
    for (arc, end) in [(helix, "X14.0000"), (upright, "X12.0000")] {
        let written = blocks(&[ABOVE, PLUNGE, Command::Arc { arc: 0 }], &[arc], Units::Mm).unwrap();
        assert!(
            written.len() > 20 && written.iter().all(|block| !block.contains('I')),
            "{written:?}"
        );
        assert!(written.last().unwrap().contains(end), "{written:?}");
    }
}

#[test]
fn no_text_leaves_its_comment() {
    let remarks = &["a\nG00 Z-50\r\n%", "é;M30\u{85}\u{2028}(x)", &"long ".repeat(40)];
    let text = post(&Program { title: "\n%", remarks, ..Program::default() }).unwrap();
    assert!(text.lines().skip(1).take(3).all(|line| line.starts_with("; - ") && line.len() <= 72));
    assert_eq!(text.lines().count(), 8);
}

#[test]
fn what_the_control_cannot_do_is_refused() {
    let refusal = |command: Command| blocks(&[ABOVE, command], &[], Units::Mm).unwrap_err();
    let feed = |x, mm_per_min| Command::Feed { to: [x, 0.0, 0.0], mm_per_min };
    let spindle = |direction, rpm| Command::Spindle { direction, rpm };
    assert!(refusal(Command::ToolChange { number: 1 }).contains("one program for each tool"));
    assert!(refusal(spindle(Direction::CounterClockwise, 9000.0)).contains("counter-clockwise"));
    assert!(refusal(spindle(Direction::Clockwise, 0.2)).contains("0.2 rpm"));
    assert!(refusal(Command::Dwell { seconds: 100.0 }).contains("99.999 s"));
    assert!(refusal(feed(f64::NAN, 600.0)).contains("X is NaN"));
    assert!(refusal(feed(1e9, 600.0)).contains("±10000 mm"));
    assert!(refusal(feed(1.0, 0.0)).contains("a feed of 0 mm/min"));
    assert!(refusal(Command::Comment { text: 9 }).contains("text 9"));
    assert!(refusal(Command::Arc { arc: 0 }).contains("arc 0"));
    assert!(blocks(&[PLUNGE], &[], Units::Mm).unwrap_err().contains("begin the program"));
}

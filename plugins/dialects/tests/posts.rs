//! What must hold for every dialect, read back the way a controller would.

#![allow(clippy::unwrap_used, reason = "a failing helper fails its test")]

mod jobs;

use carvegraph_sdk::conformance::dialect::{Job, check, check_job};
use carvegraph_sdk::{Arc, Command, Direction, Plane, Program, Stock, Units};
use jobs::{blocks, by_each_way, dialects, each, posted, reading};

fn refusal(job: &Job) -> String {
    let mut messages: Vec<String> = Vec::new();
    each(|dialect| messages.push(job.post(dialect).unwrap_err().to_string()));
    assert!(messages.windows(2).all(|m| m[0] == m[1]), "{messages:?}");
    messages[0].clone()
}

#[test]
fn dialects_are_sorted_and_documented() {
    let dialects = &dialects()[0].1;
    let names: Vec<&str> = dialects.iter().map(|d| d.name()).collect();
    let expected = [
        "fanuc",
        "fluidnc",
        "grbl",
        "haas",
        "heidenhain",
        "iso6983",
        "linuxcnc",
        "mach3",
        "marlin",
        "shopbot",
        "siemens",
        "uccnc",
    ];
    assert_eq!(names, expected);
    let extensions: Vec<&str> = dialects.iter().map(|d| d.extension()).collect();
    let expected = ["nc", "nc", "nc", "nc", "h", "nc", "ngc", "tap", "gcode", "sbp", "mpf", "nc"];
    assert_eq!(extensions, expected);
}

#[test]
fn every_dialect_fulfils_what_dialects_promise() {
    each(|dialect| check(dialect, &reading(dialect.name())));
}

#[test]
fn the_first_motion_raises_z() {
    each(|dialect| {
        let text = Job::at(3.0, 4.0).post(dialect).unwrap();
        let moves = |line: &&str| {
            let text = line.starts_with(['(', ';', '\''])
                || line.contains("CYCL")
                || line.contains("CALL");
            !text && ["X", "Y", "Z", "J"].iter().any(|word| line.contains(word))
        };
        let motion: Vec<&str> = text.lines().filter(moves).collect();
        let expected: &[&str] = match dialect.name() {
            "fanuc" => &["G91 G28 Z0.0", "G0 X3.0 Y4.0", "Z5.0", "G91 G28 Z0.0"],
            "haas" => &["G53 G0 Z0.0", "G0 X3.0", "Y4.0", "Z5.0", "G53 G0 Z0.0"],
            "heidenhain" => &["5 L Z+5 R0 FMAX M3", "6 L X+3 Y+4 R0 FMAX"],
            "shopbot" => &["JZ,5.0", "J2,3.0,4.0"],
            "marlin" => &["G0 Z5.0 F1500.0", "G0 X3.0 Y4.0"],
            "siemens" => &["N40 G0 Z5.0", "N50 X3.0 Y4.0"],
            _ => &["G0 Z5.0", "X3.0 Y4.0"],
        };
        assert_eq!(motion, expected, "{}", dialect.name());
    });
}

#[test]
fn every_program_has_its_frame() {
    let title = "Relief 1".to_owned();
    let job = Job { title, ..Job::at(0.0, 0.0) };
    each(|dialect| {
        let text = job.post(dialect).unwrap();
        let [first, last] = match dialect.name() {
            "fanuc" => ["%\nO4616\n(CARVEGRAPH RELIEF 1)\n", "\nM5\nG91 G28 Z0.0\nG90\nM30\n%\n"],
            "haas" => ["%\nO04616\n(CARVEGRAPH RELIEF 1)\n", "\nM5\nG53 G0 Z0.0\nM30\n%\n"],
            "heidenhain" => ["0 BEGIN PGM RELIEF_1 MM\n", "8 M5\n9 M30\n10 END PGM RELIEF_1 MM\n"],
            "siemens" => ["; %_N_RELIEF_1_MPF\n; Carvegraph: Relief 1\n", "N60 M5\nN70 M30\n"],
            "uccnc" => ["%RELIEF_1\n(Carvegraph: Relief 1)\n", "\nM5\nM30\n"],
            "shopbot" => ["'Carvegraph: Relief 1\n", "\nC7\nEND\nUNIT_ERROR:\nCN,91\nEND\n"],
            "marlin" => ["; Carvegraph: Relief 1\n", "\nM5\n"],
            "linuxcnc" => ["(Carvegraph: Relief 1)\n", "\nM5\nM2\n"],
            _ => ["(Carvegraph: Relief 1)\n", "\nM5\nM30\n"],
        };
        assert!(text.starts_with(first) && text.ends_with(last), "{text}");
    });
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
    let mach3 = ["(- zero Z without a tool length: G49 cancels it)"];
    assert_eq!(blocks(&job, "mach3")[..1], mach3);
    assert_eq!(blocks(&job, "mach3")[1..3], ["G17 G21 G40 G49 G80 G90 G91.1 G94", "G64"]);
    assert_eq!(blocks(&job, "fanuc")[3..7], ["G21", "G17 G40 G80 G90 G94", "G91 G28 Z0.0", "G90"]);
    assert_eq!(
        blocks(&job, "siemens")[1..3],
        ["N10 G17 G710 G40 G90 G94", "N20 CYCLE832(0.01,1,1)"]
    );
    assert_eq!(blocks(&job, "marlin")[2..4], ["G21", "G90"]);
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
fn what_a_controller_cannot_do_is_refused() {
    let mut job = Job::at(0.0, 0.0);
    job.commands.push(Command::ToolChange { number: 2 });
    let refuse = |name: &str, job: &Job| posted(job, name).unwrap_err();
    assert_eq!(
        refuse("grbl", &job),
        "command 2: grbl has no tool change (M6): write one program for each tool"
    );
    assert_eq!(
        refuse("marlin", &job),
        "command 2: marlin has no tool change, its T selects an extruder: write one program for \
         each tool"
    );
    let mut without = Vec::new();
    each(|dialect| {
        if !dialect.capabilities().tool_change {
            without.push(dialect.name().to_owned());
        }
    });
    without.dedup();
    assert_eq!(without[..2], ["grbl", "marlin"]);
    assert_eq!(without.len(), 2 * dialects().len());
    let direction = Direction::CounterClockwise;
    job.commands[2] = Command::Spindle { rpm: 1000.0, direction };
    assert_eq!(
        refuse("shopbot", &job),
        "command 2: shopbot cannot turn the spindle counter-clockwise (M4)"
    );
}

#[test]
fn tool_numbers_end_where_the_table_does() {
    let limits = [
        ("fanuc", 400),
        ("fluidnc", 255),
        ("haas", 200),
        ("heidenhain", 30_000),
        ("iso6983", 99),
        ("linuxcnc", 99_999),
        ("mach3", 255),
        ("shopbot", 99),
        ("siemens", 32_000),
        ("uccnc", 96),
    ];
    for (name, limit) in limits {
        let change =
            |number| Job { commands: vec![Command::ToolChange { number }], ..Job::default() };
        let text = posted(&change(limit), name).unwrap();
        let words = match name {
            "heidenhain" => format!(" TOOL CALL {limit} Z\n"),
            "shopbot" => format!("\n&Tool = {limit}\nC9\n"),
            "siemens" => format!(" T{limit}\nN50 M6\nN60 D1\n"),
            _ => format!("\nT{limit} M6\n"),
        };
        assert!(text.contains(&words), "{text}");
        for number in [0, limit + 1] {
            let error = posted(&change(number), name).unwrap_err();
            let words =
                format!("command 0: there is no tool {number}; tools are numbered 1 to {limit}");
            assert_eq!(error, words);
        }
    }
}

#[test]
fn dwells_are_in_the_controllers_units() {
    let job = Job { commands: vec![Command::Dwell { seconds: 1.25 }], ..Job::default() };
    each(|dialect| {
        let text = job.post(dialect).unwrap();
        let expected = match dialect.name() {
            "fanuc" | "haas" | "marlin" => "\nG4 P1250\n",
            "siemens" => " G4 F1.25\n",
            "heidenhain" => "4 CYCL DEF 9.0 DWELL TIME\n5 CYCL DEF 9.1 DWELL 1.25\n",
            "shopbot" => "\nPAUSE 1.25\n",
            _ => "\nG4 P1.25\n",
        };
        assert!(text.contains(expected), "{text}");
    });
}

#[test]
fn inch_programs_count_feeds_as_their_controller_does() {
    let mut job = Job::at(0.0, 0.0);
    job.feed([0.0, 0.0, -25.4], 254.0);
    job.units = Units::Inch;
    each(|dialect| {
        let text = check_job(dialect, &reading(dialect.name()), &job);
        let expected = match dialect.name() {
            // Tenths of an inch a minute.
            "heidenhain" => " L Z-1 F100\n",
            "shopbot" => "\nMS,0.1667,0.1667\nMZ,-1.0\n",
            "siemens" => " G1 Z-1.0 F10.0\n",
            _ => "\nG1 Z-1.0 F10.0\n",
        };
        assert!(text.contains(expected), "{text}");
        let units = match dialect.name() {
            "heidenhain" => "BEGIN PGM CARVEGRAPH INCH\n",
            "shopbot" => "IF %(25)=1 THEN GOTO UNIT_ERROR\n",
            "siemens" => "G700",
            "uccnc" => "(- in inches: so must be the profile, UCCNC ignores G20)",
            _ => "G20",
        };
        assert!(text.contains(units), "{text}");
    });
}

#[test]
fn the_blank_holds_the_stock_or_the_cuts() {
    let stock = Stock { min: [0.0, 0.0, -5.0], max: [203.0, 101.5, 0.0] };
    let post = |stock, commands: &[Command]| {
        let program = Program { stock, commands, ..Program::default() };
        by_each_way("heidenhain", |dialect| {
            let mut out = Vec::new();
            let posted = dialect.post(&program, &mut out);
            posted.map(|()| String::from_utf8(out).unwrap()).map_err(|e| e.to_string())
        })
    };
    let blank = |text: &str| {
        text.lines().filter_map(|l| l.split_once("BLK FORM ")).map(|l| l.1.to_owned()).collect()
    };
    let lines: Vec<String> = blank(&post(Some(stock), &[]).unwrap());
    assert_eq!(lines, ["0.1 Z X+0 Y+0 Z-5", "0.2 X+203 Y+101.5 Z+0"]);
    let job = [
        Command::Rapid { to: [9.0, 9.0, 9.0] },
        Command::Feed { to: [1.0, 2.0, -3.0], mm_per_min: 1.0 },
    ];
    let lines: Vec<String> = blank(&post(None, &job).unwrap_or_else(|e| panic!("{e}")));
    assert_eq!(lines, ["0.1 Z X+1 Y+2 Z-3", "0.2 X+2 Y+3 Z-2"]);
    assert!(!post(None, &[]).unwrap().contains("BLK"));
    for bad in [f64::NAN, f64::NEG_INFINITY, -5.1, 1e300] {
        let stock = Stock { max: [203.0, 101.5, bad], ..stock };
        let words = format!(
            "the stock reaches from [0.0, 0.0, -5.0] to [203.0, 101.5, {bad:?}] mm; give a finite \
             block, least corner first"
        );
        assert_eq!(post(Some(stock), &[]), Err(words));
    }
}

#[test]
fn wide_arcs_are_divided_where_they_must_be() {
    let mut job = Job::at(1.0, 0.0);
    job.feed([1.0, 0.0, 0.0], 100.0);
    job.arc(arc([0.0; 3], [1.0, 0.0, 0.0]));
    let expected = ["G3 X-1.0 Y0.0 I-1.0 J0.0", "X1.0 Y0.0 I1.0 J0.0"];
    assert_eq!(blocks(&job, "fanuc")[11..13], expected);
    assert_eq!(
        blocks(&job, "shopbot")[9..11],
        ["CG,,-1.0,0.0,-1.0,0.0,T,-1", "CG,,1.0,0.0,1.0,0.0,T,-1"]
    );
    assert_eq!(blocks(&job, "heidenhain")[10..12], ["10 CC X+0 Y+0", "11 C X+1 Y+0 DR+"]);
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
    let error = posted(&still, "linuxcnc").unwrap_err();
    assert_eq!(
        error,
        "command 6 cuts with the spindle stopped by a tool change; start it again first"
    );
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
        assert_eq!(posted(&job, "grbl").unwrap_err(), words);
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
fn a_path_tolerance_must_be_a_length() {
    let post =
        |name: &str, path_tolerance_mm| posted(&Job { path_tolerance_mm, ..Job::default() }, name);
    let told = [
        ("linuxcnc", "G64 P0.05 Q0.05\n"),
        ("haas", "G187 P3 E0.05\n"),
        ("siemens", "CYCLE832(0.05,1,1)\n"),
        ("heidenhain", "CYCL DEF 32.1 T0.05\n"),
    ];
    let able = dialects()[0].1.iter().filter(|d| d.capabilities().path_tolerance).count();
    assert_eq!(able, told.len());
    for (name, line) in told {
        assert!(post(name, 0.05).unwrap().contains(line), "{name}");
        for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
            let words = format!("the path tolerance is {tolerance} mm; it must be above 0");
            assert_eq!(post(name, tolerance), Err(words));
        }
        if name == "linuxcnc" {
            assert!(post(name, 0.0).is_err());
            let text = post(name, 1e-9).unwrap();
            assert!(text.contains("G64 P0.001 Q0.001"), "0 would mean any: {text}");
        } else {
            assert!(!post(name, 0.0).unwrap().contains(&line[..6]), "{name}");
        }
    }
}

//! Programs of one operation and of several, as a dialect that changes tools and one that does not get
//! them.

use super::*;
use crate::job::Operation;
use crate::job::testing::{ball, flat, job, operation, path};
use crate::output::zero::{XyZero, ZZero};
use crate::shop::{SetBy, SpindleRange, ToolChange};
use carvegraph_core::{Catalogs, with_context};
use carvegraph_geometry::{Contact, DVec3, Span, SpanKind};
use carvegraph_sdk::{Capabilities, Command, Direction};

fn post(z_zero: ZZero, xy_zero: XyZero) -> Post {
    Post {
        dialect: Yielding::left("plain".to_owned()),
        spindle: Yielding::left(9000.0),
        zero: Zero { z_zero, xy_zero },
        units: UnitSystem::Mm,
        tool: Yielding::left(0),
        name: "finish".to_owned(),
        split: Split::Auto,
        blend: 0.01,
        arcs: Yielding::left(true),
    }
}

fn top() -> Post {
    post(ZZero::Top, XyZero::Corner)
}

/// A dialect that writes down what it is told, a command a line.
struct Told {
    name: &'static str,
    tool_change: bool,
}

impl Dialect for Told {
    fn name(&self) -> &str {
        self.name
    }

    fn about(&self) -> &str {
        "For tests"
    }

    fn extension(&self) -> &str {
        "txt"
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { arcs: true, tool_change: self.tool_change, path_tolerance: false }
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn io::Write) -> Result<(), PostError> {
        writeln!(out, "title {}", program.title)?;
        program.remarks.iter().try_for_each(|remark| writeln!(out, "- {remark}"))?;
        for command in program.commands {
            match *command {
                Command::Comment { text } => {
                    writeln!(out, "comment {}", program.texts[text as usize])
                }
                Command::ToolChange { number } => writeln!(out, "tool {number}"),
                Command::Spindle { rpm, .. } => writeln!(out, "spindle {rpm}"),
                Command::Rapid { to: [x, _, z] } => writeln!(out, "rapid {x} {z}"),
                Command::Feed { to: [x, _, z], mm_per_min } => {
                    writeln!(out, "feed {x} {z} at {mm_per_min}")
                }
                other => writeln!(out, "{other:?}"),
            }?;
        }
        Ok(())
    }
}

const PART: Bounds = Bounds { min: DVec3::new(0.0, 0.0, -2.0), max: DVec3::new(10.0, 4.0, 0.0) };

/// What becomes of a 3 mm ball's path behind `before`.
fn posted(post: &Post, setup: Option<&Setup>, before: Option<&Job>) -> Result<Gcode, String> {
    let told = |name, tool_change| Box::new(Told { name, tool_change }) as Box<dyn Dialect>;
    let dialects = Dialects(vec![told("plain", false), told("able", true)]);
    let catalogs = Catalogs::default().with("dialect", [], dialects);
    let (path, cutter) = (path(2.0), ball(3.0));
    let inputs = Posting { toolpath: &path, part: &PART, cutter: &cutter, setup, before };
    let posted = with_context(&catalogs, |cx| post.run(inputs, cx));
    posted.map(|posted| posted.program).map_err(|fault| fault.to_string())
}

fn lines(program: &ProgramText) -> Vec<&str> {
    std::str::from_utf8(&program.text).unwrap().lines().collect()
}

fn able() -> Post {
    Post { dialect: Yielding::given("able".to_owned()), ..top() }
}

fn rough() -> Job {
    job([operation("rough", flat(6.0), None)])
}

#[test]
fn zero_is_where_the_user_says() {
    let part = Bounds { min: DVec3::new(0.0, 0.0, -1.0), max: DVec3::new(8.0, 6.0, 4.0) };
    let origin = |z, xy| post(z, xy).zero.of(&part);
    assert_eq!(origin(ZZero::Bottom, XyZero::Corner), DVec3::ZERO);
    assert_eq!(origin(ZZero::Top, XyZero::Corner), DVec3::new(0.0, 0.0, 4.0));
    assert_eq!(origin(ZZero::Top, XyZero::Center), DVec3::new(4.0, 3.0, 4.0));
}

#[test]
fn one_operation_is_a_program_as_it_is() {
    let code = posted(&top(), None, None).unwrap();
    assert_eq!((code.programs.len(), code.programs[0].name.as_str()), (1, ""));
    assert_eq!(
        lines(&code.programs[0]),
        [
            "title test",
            "- Cutter: ball, diameter 3 mm",
            "- Part: 10.000 x 4.000 x 2.000 mm",
            "- Z0: top of the part",
            "- X0 Y0: near left corner",
            "spindle 9000",
            "rapid 0 5",
            "feed 0 -2 at 300",
            "feed 0 -2 at 1000",
            "feed 10 -2 at 1000",
            "rapid 10 5",
        ]
    );
}

#[test]
fn a_program_that_changes_tools_names_them_and_changes_above_the_part() {
    let code = posted(&able(), None, Some(&rough())).unwrap();
    let [program] = &code.programs[..] else { panic!("{code:?}") };
    assert_eq!(
        lines(program),
        [
            "title test",
            "- Tool 1: flat, diameter 6 mm, for rough",
            "- Tool 2: ball, diameter 3 mm, for finish",
            "- Part: 10.000 x 4.000 x 2.000 mm",
            "- Z0: top of the part",
            "- X0 Y0: near left corner",
            "- The controller must know or measure the length of each tool",
            "comment rough",
            "tool 1",
            "spindle 9000",
            "rapid 0 5",
            "feed 0 -1 at 300",
            "feed 0 -1 at 1000",
            "feed 10 -1 at 1000",
            "rapid 10 5",
            "comment finish",
            "tool 2",
            "spindle 9000",
            "rapid 0 5",
            "feed 0 -2 at 300",
            "feed 0 -2 at 1000",
            "feed 10 -2 at 1000",
            "rapid 10 5",
        ]
    );
    let tools: Vec<_> =
        program.tools.iter().map(|tool| (tool.number, tool.cutter.name.as_str())).collect();
    assert_eq!(tools, [(Some(1), "flat"), (Some(2), "ball")]);
}

#[test]
fn a_program_for_each_tool_stands_alone() {
    let code = posted(&top(), None, Some(&rough())).unwrap();
    let names: Vec<&str> = code.programs.iter().map(|program| program.name.as_str()).collect();
    assert_eq!(names, ["1-rough", "2-finish"]);
    assert_eq!(
        lines(&code.programs[0]),
        [
            "title test-1-rough",
            "- Program 1 of 2: rough",
            "- Cutter: flat, diameter 6 mm",
            "- Part: 10.000 x 4.000 x 2.000 mm",
            "- Z0: top of the part",
            "- X0 Y0: near left corner",
            "- Set Z where no program cuts: it is set there for each cutter",
            "comment rough",
            "spindle 9000",
            "rapid 0 5",
            "feed 0 -1 at 300",
            "feed 0 -1 at 1000",
            "feed 10 -1 at 1000",
            "rapid 10 5",
        ]
    );
    let second = lines(&code.programs[1]);
    assert_eq!(
        second[..8],
        [
            "title test-2-finish",
            "- Program 2 of 2: finish",
            "- Cutter: ball, diameter 3 mm",
            "- Part: 10.000 x 4.000 x 2.000 mm",
            "- Z0: top of the part",
            "- X0 Y0: near left corner",
            "- Set Z anew with this cutter, where it was set for program 1",
            "comment finish",
        ]
    );
    assert_eq!(second[8..10], ["spindle 9000", "rapid 0 5"]);
}

#[test]
fn equal_cutters_go_on_without_a_change() {
    let before = job([
        Operation { name: "slow".into(), ..operation("a", ball(3.0), None) },
        operation("semi", ball(3.0), Some(0)),
    ]);
    let fast = Post { spindle: Yielding::given(8000.0), ..top() };
    let code = posted(&fast, None, Some(&before)).unwrap();
    let [program] = &code.programs[..] else { panic!("{code:?}") };
    let lines = lines(program);
    assert_eq!(lines[1..3], ["- Operations: slow, semi, finish", "- Cutter: ball, diameter 3 mm"]);
    let turns: Vec<_> = lines
        .iter()
        .filter(|line| line.starts_with("spindle") || line.starts_with("tool"))
        .collect();
    assert_eq!(turns, [&"spindle 9000", &"spindle 8000"]);
    assert_eq!(lines.iter().filter(|line| line.starts_with("comment")).count(), 3);
}

#[test]
fn an_operation_below_the_part_or_without_an_end_is_no_neighbour() {
    let mut low = operation("rough", flat(6.0), None);
    for tip in low.toolpath.tips.iter_mut().filter(|tip| tip.z > 0.0) {
        tip.z = -0.5;
    }
    let fault = posted(&able(), None, Some(&job([low]))).unwrap_err();
    assert!(fault.starts_with("the path of operation \"rough\" does not begin and end"), "{fault}");
}

fn mill(machine: Machine) -> Setup {
    Setup { machine: Machine { name: "mill".into(), ..machine }, ..Setup::default() }
}

#[test]
fn a_machine_looks_at_every_operation() {
    let spindle = SpindleRange { min_rpm: None, max_rpm: Some(8000.0), set_by: SetBy::Program };
    let machine = Machine { spindle: Some(spindle), ..Machine::default() };
    let mut fast = operation("rough", flat(6.0), None);
    fast.drive.spindle_yields = false;
    let fault = posted(&able(), Some(&mill(machine.clone())), Some(&job([fast]))).unwrap_err();
    let words = "machine \"mill\": operation \"rough\": the spindle is to turn at 9000 rpm and turns at \
                 most 8000 rpm";
    assert!(fault.starts_with(words), "{fault}");
    // Left at its default it yields.
    let code = posted(&able(), Some(&mill(machine)), Some(&rough())).unwrap();
    assert_eq!(lines(&code.programs[0]).iter().filter(|line| **line == "spindle 8000").count(), 2);
}

/// Each operation fits by itself, but not with one zero for both.
#[test]
fn operations_must_fit_the_machine_together() {
    let travel = [Some(crate::shop::Travel::Length(15.0)), None, None];
    let setup = mill(Machine { travel, ..Machine::default() });
    let mut far = operation("rough", flat(6.0), None);
    assert!(posted(&top(), Some(&setup), Some(&job([far.clone()]))).is_ok());
    far.toolpath.tips.iter_mut().for_each(|tip| tip.x += 8.0);
    let fault = posted(&top(), Some(&setup), Some(&job([far]))).unwrap_err();
    assert!(
        fault.starts_with("machine \"mill\": X needs 18 mm and the machine travels 15 mm"),
        "{fault}"
    );
}

#[test]
fn a_program_runs_on_one_machine() {
    let other =
        Setup { machine: Machine { name: "old".into(), ..Machine::default() }, ..Setup::default() };
    let before = job([Operation { setup: other.clone(), ..operation("rough", flat(6.0), None) }]);
    let fault = posted(&top(), Some(&mill(Machine::default())), Some(&before)).unwrap_err();
    assert_eq!(
        fault,
        "operation \"finish\" is set up for machine \"mill\" and operation \"rough\" for \"old\": a \
         program runs on one"
    );
    // Where only one says which, it is that one.
    let code = posted(&top(), None, Some(&before)).unwrap();
    assert!(lines(&code.programs[1]).contains(&"- Machine: old"));
}

#[test]
fn tools_materials_and_speeds_by_hand_are_told_for_each_operation() {
    let spindle = SpindleRange { min_rpm: None, max_rpm: None, set_by: SetBy::Hand };
    let mut setup = mill(Machine { spindle: Some(spindle), ..Machine::default() });
    (setup.tool, setup.material) = ("ball_3".into(), "oak".into());
    let code = posted(&top(), Some(&setup), None).unwrap();
    let told = ["- Machine: mill", "- Tool: ball_3", "- Material: oak"];
    assert_eq!(lines(&code.programs[0])[5..8], told);
    assert_eq!(lines(&code.programs[0])[8], "- Set the spindle to 9000 rpm by hand");
    let mut before = rough();
    let mut wide = Operation::clone(&before.operations[0]);
    (wide.setup.tool, wide.setup.material) = ("flat_6".into(), "oak".into());
    wide.drive.spindle_rpm = 6000.0;
    before.operations = vec![std::sync::Arc::new(wide)];
    let code = posted(&able(), Some(&setup), Some(&before)).unwrap();
    let all = lines(&code.programs[0]);
    let tools = [
        "- Tool 1: flat_6: flat, diameter 6 mm, for rough",
        "- Tool 2: ball_3: ball, diameter 3 mm, for finish",
    ];
    assert_eq!(all[1..3], tools);
    assert_eq!(
        all[7..11],
        [
            "- Machine: mill",
            "- Material: oak",
            "- Set the spindle to 6000 rpm by hand for rough",
            "- Set the spindle to 9000 rpm by hand for finish",
        ]
    );
}

#[test]
fn each_kind_of_move_has_its_speed() {
    let span = |at: usize, kind| Span { points: at..at + 1, kind, joined: at > 0 };
    let path = Toolpath {
        tips: vec![DVec3::Z, DVec3::ZERO, DVec3::X],
        contacts: vec![Contact::NONE; 3],
        spans: vec![span(0, SpanKind::Rapid), span(1, SpanKind::Plunge), span(2, SpanKind::Pass)],
        feeds: Some(carvegraph_geometry::Feeds {
            cut_mm_per_min: 1000.0,
            plunge_mm_per_min: 300.0,
            rapid_mm_per_min: 5000.0,
        }),
        arcs: Vec::new(),
    };
    let moves = |path: &Toolpath| {
        let (cutter, setup) = (ball(3.0), Setup::default());
        let drive = Drive { tool: None, spindle_rpm: 9000.0, spindle_yields: false };
        let steps = [Step { name: "x", toolpath: path, cutter: &cutter, setup: &setup, drive }];
        let changer = Changer { dialect: "plain", can_say: false, machine: &setup.machine };
        let division = Division::new(&steps, Split::Auto, &changer).unwrap();
        Sequence::new(&steps, &division, DVec3::ZERO, &setup.machine).map(|made| made.commands)
    };
    assert_eq!(
        moves(&path).unwrap(),
        [
            Command::Spindle { rpm: 9000.0, direction: Direction::Clockwise },
            Command::Rapid { to: [0.0, 0.0, 1.0] },
            Command::Feed { to: [0.0; 3], mm_per_min: 300.0 },
            Command::Feed { to: [1.0, 0.0, 0.0], mm_per_min: 1000.0 },
        ]
    );
    let loose = Toolpath { feeds: None, ..path };
    let fault = moves(&loose).unwrap_err();
    assert!(fault.to_string().contains("put a link node before this one"));
}

#[test]
fn a_dialect_that_is_not_there_is_named() {
    let nowhere = Post { dialect: Yielding::given("nowhere".to_owned()), ..top() };
    assert_eq!(posted(&nowhere, None, None).unwrap_err(), "there is no dialect \"nowhere\"");
}

/// The spindle's speed and the tool that a program begins with.
fn begins(post: &Post, setup: &Setup) -> (f64, Option<u32>) {
    let code = posted(post, Some(setup), None).unwrap();
    let lines = lines(&code.programs[0]);
    let value = |word: &str| lines.iter().find_map(|line| line.strip_prefix(word));
    (
        value("spindle ").unwrap().parse().unwrap(),
        value("tool ").map(|number| number.parse().unwrap()),
    )
}

#[test]
fn what_is_set_wins_over_the_tool_and_that_over_the_default() {
    let mut setup = Setup { number: Some(4), ..Setup::default() };
    assert_eq!(begins(&able(), &setup), (9000.0, None), "nobody said that it changes tools");
    setup.machine.tool_change = Some(ToolChange::Manual);
    setup.conditions.spindle_rpm = Some(7000.0);
    assert_eq!(begins(&able(), &setup), (7000.0, Some(4)));
    let (spindle, tool) = (Yielding::given(9000.0), Yielding::given(0));
    assert_eq!(begins(&Post { spindle, tool, ..able() }, &setup), (9000.0, None));
}

#[test]
fn the_default_speed_of_the_spindle_yields_to_what_the_machine_can_do() {
    let spindle = SpindleRange { min_rpm: None, max_rpm: Some(6000.0), set_by: SetBy::Hand };
    let machine = Machine { name: "slow".into(), spindle: Some(spindle), ..Machine::default() };
    let mut setup = Setup { machine, ..Setup::default() };
    assert_eq!(begins(&top(), &setup).0, 6000.0);
    let set = Post { spindle: Yielding::given(9000.0), ..top() };
    let fault = posted(&set, Some(&setup), None).unwrap_err();
    assert!(fault.contains("is to turn at 9000 rpm"), "it is refused, not changed: {fault}");
    setup.conditions.spindle_rpm = Some(7000.0);
    let fault = posted(&top(), Some(&setup), None).unwrap_err();
    assert!(
        fault.starts_with("machine \"slow\": the spindle is to turn at 7000 rpm"),
        "it is refused, not changed: {fault}"
    );
}

#[test]
fn a_dialect_that_the_machine_names_and_nobody_knows_is_shown_in_its_profile() {
    let machine = Machine {
        name: "mill".into(),
        dialect: Some("grbll".into()),
        dialect_place: "mill.ron:3:14".into(),
        ..Machine::default()
    };
    let setup = Setup { machine, ..Setup::default() };
    assert_eq!(
        posted(&top(), Some(&setup), None).unwrap_err(),
        "mill.ron:3:14: machine \"mill\" understands \"grbll\", and there is no such dialect (carve \
         dialects): correct it there, or set dialect"
    );
}

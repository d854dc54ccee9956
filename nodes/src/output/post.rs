//! A path becomes a program in a dialect.
//!
//! The program's frame follows from where the user sets the machine to zero: `z_zero: bottom,
//! xy_zero: corner` is the frame of the saved model; `top` and `center` shift it.
//!
//! A program that the machine of the setup cannot run is refused, with everything that keeps it from it.

use crate::services::Dialects;
use crate::shop::{Demands, Machine, NONE, Setup, ToolChange, short};
use crate::values::Gcode;
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params, Yielding};
use carvegraph_geometry::{Bounds, Cutter, DVec3, SpanKind, Toolpath};
use carvegraph_sdk::{Command, Direction, PostError, Program, Stock, Units};
use std::io;

/// Bytes that are taken between two looks at the cancel token.
const LOOK_BYTES: usize = 1 << 18;

/// Writes a path as a program that a machine can run. `carve dialects` lists the dialects. What is not set
/// here comes from the setup.
#[derive(Clone, Debug, Params)]
pub(crate) struct Post {
    /// What the controller understands.
    #[param(catalog = "dialect", default = "grbl")]
    pub(crate) dialect: Yielding<String>,
    /// Speed of the spindle.
    #[param(unit = "rpm", default = 12_000.0, range = 1.0..=200_000.0)]
    pub(crate) spindle: Yielding<f64>,
    /// Where Z is 0: at the top of the part or at its bottom.
    #[param(default = ZZero::Top)]
    pub(crate) z_zero: ZZero,
    /// Where X and Y are 0: at the near left corner of the part or above its middle.
    #[param(default = XyZero::Corner)]
    pub(crate) xy_zero: XyZero,
    /// Units of the program.
    #[param(default = UnitSystem::Mm)]
    pub(crate) units: UnitSystem,
    /// Number of the cutter in the controller's tool table; 0 takes the one that is in the spindle.
    #[param(default = 0, range = 0..=9999)]
    pub(crate) tool: Yielding<u32>,
    /// How far the controller may round corners off to keep its speed, where it can be told.
    #[param(unit = "mm", default = 0.01, range = 0.0001..=10.0)]
    pub(crate) blend: f64,
    /// Whether arcs may be written; if not, they become short lines.
    #[param(default = true)]
    pub(crate) arcs: Yielding<bool>,
}

/// Where Z is 0.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum ZZero {
    /// The part's highest point.
    Top,
    /// The part's own frame.
    Bottom,
}

/// Where X and Y are 0.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum XyZero {
    /// The near left corner of the part.
    Corner,
    /// The middle of the part.
    Center,
}

/// Units of a program.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum UnitSystem {
    /// Millimetres.
    Mm,
    /// Inches.
    Inch,
}

#[derive(Inputs)]
pub(crate) struct Job<'a> {
    /// The path with all its moves and speeds.
    toolpath: &'a Toolpath,
    /// The box that holds the part.
    part: &'a Bounds,
    /// The cutter, for the program's head.
    cutter: &'a Cutter,
    /// The machine, the tool and the material.
    setup: Option<&'a Setup>,
}

#[derive(Outputs)]
pub(crate) struct Posted {
    /// The program.
    program: Gcode,
}

impl Node for Post {
    const KIND: &'static str = "post";
    const USES_PREFIX: bool = true;
    type Inputs<'a> = Job<'a>;
    type Outputs = Posted;

    fn run(&self, inputs: Job<'_>, cx: &Context<'_>) -> Result<Posted, NodeError> {
        let none = Setup::default();
        let setup = inputs.setup.unwrap_or(&none);
        let machine = &setup.machine;
        let dialects: &Dialects = cx.service()?;
        let name = self.dialect.or(machine.dialect.clone());
        let dialect = dialects.find(&name).ok_or_else(|| self.no_dialect(&name, machine))?;
        if let Some(own) = machine.dialect.as_ref().filter(|own| **own != name) {
            cx.warn(format!("machine {:?} understands {own}, but {name} is set", machine.name));
        }
        let origin = self.origin(inputs.part);
        let mut commands = self.start(setup, cx);
        self.moves(inputs.toolpath, origin, &mut commands)?;
        check(machine, &commands, cx)?;
        let remarks = self.remarks(&inputs, setup, &commands);
        let remarks: Vec<&str> = remarks.iter().map(String::as_str).collect();
        let program = Program {
            title: cx.prefix(),
            remarks: &remarks,
            units: match self.units {
                UnitSystem::Mm => Units::Mm,
                UnitSystem::Inch => Units::Inch,
            },
            path_tolerance_mm: self.blend,
            lines_only: !self.arcs.or(machine.arcs),
            stock: Some(Stock {
                min: (inputs.part.min - origin).to_array(),
                max: (inputs.part.max - origin).to_array(),
            }),
            commands: &commands,
            ..Program::default()
        };
        // About 24 bytes a block.
        let text = Vec::with_capacity(commands.len() * 24);
        let mut sink = Sink { text, cx, looked: 0 };
        dialect.post(&program, &mut sink).map_err(|fault| match fault {
            PostError::Io(_) if cx.is_cancelled() => NodeError::Cancelled,
            fault => NodeError::Failed(format!("dialect {name:?}: {fault}")),
        })?;
        let extension = dialect.extension().to_owned();
        Ok(Posted { program: Gcode { text: sink.text, dialect: name, extension } })
    }
}

impl Post {
    /// The point of the part's frame that is the program's zero.
    fn origin(&self, part: &Bounds) -> DVec3 {
        let xy = match self.xy_zero {
            XyZero::Corner => DVec3::ZERO,
            XyZero::Center => part.center(),
        };
        let z = match self.z_zero {
            ZZero::Top => part.max.z,
            ZZero::Bottom => 0.0,
        };
        xy.with_z(z)
    }

    /// The fault that there is no dialect of that name; if the machine names it, it is shown there.
    fn no_dialect(&self, name: &str, machine: &Machine) -> NodeError {
        if self.dialect.is_set() || machine.is_none() {
            return NodeError::failed(format!("there is no dialect {name:?}"));
        }
        let Machine { name: of, dialect_place, .. } = machine;
        NodeError::refused(
            "dialect",
            format!(
                "{dialect_place}: machine {of:?} understands {name:?}, and there is no such dialect \
                 (carve dialects): correct it there, or set dialect"
            ),
        )
    }

    /// What comes before the first move: the tool, and the spindle.
    fn start(&self, setup: &Setup, cx: &Context<'_>) -> Vec<Command> {
        let machine = &setup.machine;
        let changes =
            matches!(machine.tool_change, Some(ToolChange::Manual | ToolChange::Automatic));
        let number = self.tool.or(setup.number.filter(|_| changes));
        let default = self.spindle.or(None);
        let rpm = match setup.conditions.spindle_rpm {
            None if !self.spindle.is_set() => machine.nearest_spindle_rpm(default),
            of_tool => self.spindle.or(of_tool),
        };
        if rpm != default && setup.conditions.spindle_rpm.is_none() {
            let name = &machine.name;
            cx.note(format!(
                "the spindle turns at {rpm} rpm: {default} is not what {name:?} can do"
            ));
        }
        let change = (number > 0).then_some(Command::ToolChange { number });
        let spindle = Command::Spindle { rpm, direction: Direction::Clockwise };
        change.into_iter().chain([spindle]).collect()
    }

    fn remarks(&self, inputs: &Job<'_>, setup: &Setup, commands: &[Command]) -> Vec<String> {
        let size = inputs.part.size();
        let cutter = inputs.cutter;
        let z_zero = match self.z_zero {
            ZZero::Top => "top of the part",
            ZZero::Bottom => "bottom: the frame of the saved model",
        };
        let xy_zero = match self.xy_zero {
            XyZero::Corner => "near left corner",
            XyZero::Center => "middle of the part",
        };
        let mut remarks = vec![
            format!("Cutter: {}, diameter {} mm", cutter.name, 2.0 * cutter.profile.radius_mm()),
            format!("Part: {:.3} x {:.3} x {:.3} mm", size.x, size.y, size.z),
            format!("Z0: {z_zero}"),
            format!("X0 Y0: {xy_zero}"),
        ];
        remarks.extend(setup_remarks(setup, commands));
        remarks
    }

    fn moves(
        &self,
        path: &Toolpath,
        origin: DVec3,
        commands: &mut Vec<Command>,
    ) -> Result<(), NodeError> {
        let Some(feeds) = path.feeds else {
            let message = "the path has no speeds and no approach: put a link node before this one";
            return Err(NodeError::failed(message));
        };
        commands.reserve(path.tips.len());
        for span in &path.spans {
            for tip in &path.tips[span.points.clone()] {
                let to = (*tip - origin).to_array();
                commands.push(match span.kind {
                    SpanKind::Rapid => Command::Rapid { to },
                    SpanKind::Plunge => Command::Feed { to, mm_per_min: feeds.plunge_mm_per_min },
                    SpanKind::Pass | SpanKind::Link => {
                        Command::Feed { to, mm_per_min: feeds.cut_mm_per_min }
                    }
                });
            }
        }
        Ok(())
    }
}

/// Holds a program against the machine: refuses what it cannot run, warns of feeds that it slows down.
fn check(machine: &Machine, commands: &[Command], cx: &Context<'_>) -> Result<(), NodeError> {
    let violations = machine.violations(&Demands::of(commands));
    if violations.is_empty() {
        machine.slowed(commands).into_iter().for_each(|slowed| cx.warn(slowed));
        return Ok(());
    }
    let param = violations.iter().find_map(|violation| violation.param).unwrap_or("setup");
    let told: Vec<String> = violations.into_iter().map(|violation| violation.message).collect();
    Err(NodeError::refused(param, format!("machine {:?}: {}", machine.name, told.join("; "))))
}

/// The setup in the program's head: nothing where nothing is chosen.
fn setup_remarks(setup: &Setup, commands: &[Command]) -> Vec<String> {
    let machine = &setup.machine;
    let line = |what: &str, name: &str| (name != NONE).then(|| format!("{what}: {name}"));
    let by_hand = commands.iter().find_map(|command| match command {
        Command::Spindle { rpm, .. } if machine.spindle_by_hand() => {
            Some(format!("Set the spindle to {} rpm by hand", short(*rpm)))
        }
        _ => None,
    });
    let lines = [
        line("Machine", &machine.name),
        line("Tool", &setup.tool),
        line("Material", &setup.material),
        by_hand,
    ];
    lines.into_iter().flatten().collect()
}

/// Where a dialect writes to; it refuses to take more when the run is called off.
struct Sink<'a> {
    text: Vec<u8>,
    cx: &'a Context<'a>,
    looked: usize,
}

impl io::Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.text.extend_from_slice(bytes);
        if self.text.len() >= self.looked + LOOK_BYTES {
            self.looked = self.text.len();
            if self.cx.is_cancelled() {
                return Err(io::Error::other("interrupted"));
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shop::{SetBy, SpindleRange};
    use crate::testing::run;
    use carvegraph_geometry::{Contact, Profile, Span};

    fn post(z_zero: ZZero, xy_zero: XyZero) -> Post {
        Post {
            dialect: Yielding::left("grbl".to_owned()),
            spindle: Yielding::left(9000.0),
            z_zero,
            xy_zero,
            units: UnitSystem::Mm,
            tool: Yielding::left(0),
            blend: 0.01,
            arcs: Yielding::left(true),
        }
    }

    #[test]
    fn zero_is_where_the_user_says() {
        let part = Bounds { min: DVec3::new(0.0, 0.0, -1.0), max: DVec3::new(8.0, 6.0, 4.0) };
        let origin = |z, xy| post(z, xy).origin(&part);
        assert_eq!(origin(ZZero::Bottom, XyZero::Corner), DVec3::ZERO);
        assert_eq!(origin(ZZero::Top, XyZero::Corner), DVec3::new(0.0, 0.0, 4.0));
        assert_eq!(origin(ZZero::Top, XyZero::Center), DVec3::new(4.0, 3.0, 4.0));
    }

    #[test]
    fn each_kind_of_move_has_its_speed() {
        let span = |at: usize, kind| Span { points: at..at + 1, kind, joined: at > 0 };
        let path = Toolpath {
            tips: vec![DVec3::Z, DVec3::ZERO, DVec3::X],
            contacts: vec![Contact::NONE; 3],
            spans: vec![
                span(0, SpanKind::Rapid),
                span(1, SpanKind::Plunge),
                span(2, SpanKind::Pass),
            ],
            feeds: Some(carvegraph_geometry::Feeds {
                cut_mm_per_min: 1000.0,
                plunge_mm_per_min: 300.0,
                rapid_mm_per_min: 5000.0,
            }),
        };
        let moves = |path: &Toolpath| {
            let mut commands = Vec::new();
            let post = post(ZZero::Bottom, XyZero::Corner);
            post.moves(path, DVec3::ZERO, &mut commands).map(|()| commands)
        };
        assert_eq!(
            moves(&path).unwrap(),
            [
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
        let cutter = Cutter { name: "ball".into(), profile: Profile::ball(3.0).unwrap() };
        let path = Toolpath { tips: vec![], contacts: vec![], spans: vec![], feeds: None };
        let part = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
        let job = Job { toolpath: &path, part: &part, cutter: &cutter, setup: None };
        // A context without catalogs: no dialects at all.
        let fault = run(|cx| post(ZZero::Top, XyZero::Corner).run(job, cx)).err();
        assert!(fault.is_some_and(|fault| fault.to_string().contains("Dialects")));
    }

    /// The spindle's speed and the tool that a program begins with.
    fn begins(post: &Post, setup: &Setup) -> (f64, Option<u32>) {
        match *run(|cx| post.start(setup, cx)) {
            [Command::ToolChange { number }, Command::Spindle { rpm, .. }] => (rpm, Some(number)),
            [Command::Spindle { rpm, .. }] => (rpm, None),
            ref other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_is_set_wins_over_the_tool_and_that_over_the_default() {
        let post = || post(ZZero::Top, XyZero::Corner);
        let mut setup = Setup { number: Some(4), ..Setup::default() };
        assert_eq!(begins(&post(), &setup), (9000.0, None), "nobody said that it changes tools");
        setup.machine.tool_change = Some(ToolChange::Manual);
        setup.conditions.spindle_rpm = Some(7000.0);
        assert_eq!(begins(&post(), &setup), (7000.0, Some(4)));
        let (spindle, tool) = (Yielding::given(9000.0), Yielding::given(0));
        assert_eq!(begins(&Post { spindle, tool, ..post() }, &setup), (9000.0, None));
    }

    #[test]
    fn the_default_speed_of_the_spindle_yields_to_what_the_machine_can_do() {
        let post = || post(ZZero::Top, XyZero::Corner);
        let spindle = SpindleRange { min_rpm: None, max_rpm: Some(6000.0), set_by: SetBy::Hand };
        let machine = Machine { name: "slow".into(), spindle: Some(spindle), ..Machine::default() };
        let mut setup = Setup { machine, ..Setup::default() };
        assert_eq!(begins(&post(), &setup).0, 6000.0);
        let set = Post { spindle: Yielding::given(9000.0), ..post() };
        assert_eq!(begins(&set, &setup).0, 9000.0, "it is refused, not changed");
        setup.conditions.spindle_rpm = Some(7000.0);
        assert_eq!(begins(&post(), &setup).0, 7000.0, "it is refused, not changed");
        let fault = run(|cx| check(&setup.machine, &post().start(&setup, cx), cx)).unwrap_err();
        let NodeError::Refused { param, message } = fault else { panic!("{fault}") };
        assert_eq!(param, "spindle");
        assert!(
            message.starts_with("machine \"slow\": the spindle is to turn at 7000 rpm"),
            "{message}"
        );
        assert_eq!(
            setup_remarks(&setup, &run(|cx| set.start(&setup, cx))),
            ["Machine: slow", "Set the spindle to 9000 rpm by hand"]
        );
        assert!(setup_remarks(&Setup::default(), &[]).is_empty());
    }

    #[test]
    fn a_dialect_that_the_machine_names_and_nobody_knows_is_shown_in_its_profile() {
        let machine = Machine {
            name: "mill".into(),
            dialect: Some("grbll".into()),
            dialect_place: "mill.ron:3:14".into(),
            ..Machine::default()
        };
        let post = post(ZZero::Top, XyZero::Corner);
        assert_eq!(
            post.no_dialect("grbll", &machine).to_string(),
            "mill.ron:3:14: machine \"mill\" understands \"grbll\", and there is no such dialect \
             (carve dialects): correct it there, or set dialect"
        );
    }
}

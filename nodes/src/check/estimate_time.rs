//! How long a machine takes for a program, with acceleration, corners and look-ahead.
//!
//! The kernel plans as GRBL does (`geometry/src/time`). What the machine's profile does not say is taken
//! from GRBL 1.1's `defaults.h`: of the belt-driven routers in it a Shapeoko 2 gathers 250 mm/s², a Shapeoko 3
//! 400, an X-Carve 500; 300 is on the careful side of their middle. The generic profile there (10 mm/s²) is
//! meant to be safe on anything and is slower than what anybody leaves it at; its junction deviation of
//! 0.01 mm is what boards are shipped with.
//!
//! Limits: the moves that a machine makes of its own to change a tool are within `tool_change`, and so is
//! spinning up. Homing and touching off are not counted.

use super::{Estimate, RunTimes};
use crate::job::described;
use crate::machining::{Machining, ToolRun};
use crate::shop::{Machine, Setup, ToolChange, short};
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params, Yielding};
use carvegraph_geometry::{Kinematics, TimeError, machining_time};

/// Tells how long a machine takes for a program, with the time that it needs to gather and to lose speed.
/// What is not set here comes from the machine of the setup.
#[derive(Clone, Debug, Params)]
pub(crate) struct EstimateTime {
    /// How fast each axis gathers speed.
    #[param(unit = "mm/s2", default = 300.0, range = 0.1..=100_000.0)]
    pub(crate) acceleration: Yielding<f64>,
    /// How far the controller thinks itself off a corner; more takes corners faster (GRBL's $11).
    #[param(unit = "mm", default = 0.01, range = 0.0001..=10.0)]
    pub(crate) junction_deviation: Yielding<f64>,
    /// Speed of rapids, of the fastest axis.
    #[param(unit = "mm/min", default = 5000.0, range = 1.0..=500_000.0)]
    pub(crate) rapid: Yielding<f64>,
    /// How many moves the controller plans at a time, the one that it makes included; GRBL's buffer of 16
    /// holds 15.
    #[param(default = 15, range = 1..=10_000)]
    pub(crate) look_ahead: u32,
    /// How many lines a second the controller takes, by cable and by computing; 0 takes any.
    #[param(default = 0, range = 0..=1_000_000)]
    pub(crate) lines_per_second: u32,
    /// How long a change of tools takes; a machine that changes them by itself takes 10 s if nothing is set.
    #[param(unit = "s", default = 60.0, range = 0.0..=86_400.0)]
    pub(crate) tool_change: Yielding<f64>,
}

#[derive(Inputs)]
pub(crate) struct Program<'a> {
    /// What the program makes the machine do.
    machining: &'a Machining,
    /// The machine, the tool and the material.
    setup: Option<&'a Setup>,
}

#[derive(Outputs)]
pub(crate) struct Estimated {
    /// How long it takes.
    estimate: Estimate,
}

/// 115,200 baud carry 11,520 bytes a second: some 400 lines of 25 to 30.
const LINES_PER_S_BY_CABLE: f64 = 400.0;

/// A changer's arm or carousel takes 3 to 10 s from chip to chip.
const AUTOMATIC_CHANGE_S: f64 = 10.0;

impl Node for EstimateTime {
    const KIND: &'static str = "estimate_time";
    type Inputs<'a> = Program<'a>;
    type Outputs = Estimated;

    fn run(&self, inputs: Program<'_>, cx: &Context<'_>) -> Result<Estimated, NodeError> {
        let none = Setup::default();
        let machine = &inputs.setup.unwrap_or(&none).machine;
        let kinematics = self.kinematics(machine);
        let runs = &inputs.machining.runs;
        let ticker = cx.ticker(runs.iter().map(|run| run.motion.moves.len()).sum());
        let tick = |moves| ticker.tick(moves);
        let time = |run: &ToolRun| match machining_time(&run.motion, &kinematics, &tick) {
            Ok(times) => {
                let cutter = described(&run.cutter);
                Ok(RunTimes { cutter, times, dwell_s: run.dwell_s })
            }
            Err(TimeError::Stopped) => Err(NodeError::Cancelled),
            Err(fault) => Err(NodeError::failed(fault)),
        };
        let runs = runs.iter().map(time).collect::<Result<Vec<_>, _>>()?;
        let changes = runs.len().saturating_sub(1) as f64;
        let by_itself = machine.tool_change == Some(ToolChange::Automatic);
        let change_s = self.tool_change.or(by_itself.then_some(AUTOMATIC_CHANGE_S));
        let machine = self.on(machine);
        let estimate = Estimate { runs, changing_s: changes * change_s, machine };
        self.note_pace(&estimate, cx);
        Ok(Estimated { estimate })
    }
}

impl EstimateTime {
    /// What a machine can do, as far as it or this node says so.
    fn kinematics(&self, machine: &Machine) -> Kinematics {
        let rapid = self.rapid.or(machine.rapid_mm_per_min);
        let feeds = machine.max_feed_mm_per_min;
        let fastest = feeds.iter().flatten().copied().fold(0.0, f64::max);
        let or_any = |feed: Option<f64>| feed.unwrap_or(f64::INFINITY);
        let lines_per_s = f64::from(self.lines_per_second);
        Kinematics {
            feed_mm_per_min: feeds.map(or_any),
            // A profile has one speed for rapids. Axes differ in them as they do in their feeds.
            rapid_mm_per_min: feeds.map(|feed| feed.map_or(rapid, |feed| rapid * feed / fastest)),
            acceleration_mm_per_s2: machine
                .acceleration_mm_per_s2
                .map(|acceleration| self.acceleration.or(acceleration)),
            junction_deviation_mm: self.junction_deviation.or(machine.junction_deviation_mm),
            look_ahead: self.look_ahead as usize,
            lines_per_s: if lines_per_s > 0.0 { lines_per_s } else { f64::INFINITY },
        }
    }

    /// "on shapeoko_3": the machine, and what is assumed of it.
    fn on(&self, machine: &Machine) -> String {
        let gathers = format!("gathers {} mm/s2", short(self.acceleration.or(None)));
        let says = machine.acceleration_mm_per_s2.iter().flatten().count();
        match (machine.is_none(), self.acceleration.is_set(), says) {
            (true, true, _) => format!("on a machine that {gathers}"),
            (true, false, _) => {
                format!("on a machine that {gathers}; choose yours with machine=...")
            }
            (false, true, _) => format!("on {}, if it {gathers}", machine.name),
            (false, false, 3) => format!("on {}", machine.name),
            (false, false, 0) => {
                format!("on {}, if it {gathers} (its profile does not say)", machine.name)
            }
            (false, false, _) => format!(
                "on {}, if each axis of which its profile does not say it {gathers}",
                machine.name
            ),
        }
    }

    /// Says where a program may want more lines than a controller gets.
    fn note_pace(&self, estimate: &Estimate, cx: &Context<'_>) {
        let most = estimate.most_lines_per_s();
        if self.lines_per_second == 0 && most > LINES_PER_S_BY_CABLE {
            cx.note(format!(
                "in places the program is used up at {most:.0} lines a second; a serial cable of 115,200 \
                 baud carries about {LINES_PER_S_BY_CABLE}: set lines_per_second to see what becomes of it, or \
                 take points out"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::{Cutter, DVec3, Motion, Move, MoveKind, Profile};

    fn left() -> EstimateTime {
        EstimateTime {
            acceleration: Yielding::left(300.0),
            junction_deviation: Yielding::left(0.01),
            rapid: Yielding::left(5000.0),
            look_ahead: 15,
            lines_per_second: 0,
            tool_change: Yielding::left(60.0),
        }
    }

    /// 100 mm over the part, 5 mm down, 60 mm along Y at 1200 mm/min.
    fn tool_run(dwell_s: f64) -> ToolRun {
        let moved = |to: [f64; 3], mm_per_min, kind| Move { to: to.into(), mm_per_min, kind };
        let moves = vec![
            moved([100.0, 0.0, 5.0], f64::INFINITY, MoveKind::Rapid),
            moved([100.0, 0.0, 0.0], 300.0, MoveKind::Line),
            moved([100.0, 60.0, 0.0], 1200.0, MoveKind::Line),
        ];
        let motion = Motion { start: DVec3::new(0.0, 0.0, 5.0), moves, arcs: vec![] };
        let profile = Profile::flat(3.0).unwrap();
        let cutter = Cutter { name: "flat".into(), profile };
        ToolRun { program: 0, cutter, motion, lines: vec![1, 2, 3], dwell_s }
    }

    fn estimate(node: &EstimateTime, tools: usize, machine: Machine) -> Estimate {
        let runs = (0..tools).map(|_| tool_run(2.0)).collect();
        let machining = Machining { runs, faults: vec![], readable: true };
        let setup = Setup { machine, ..Setup::default() };
        let program = Program { machining: &machining, setup: Some(&setup) };
        run(|cx| node.run(program, cx)).unwrap().estimate
    }

    fn shed() -> Machine {
        Machine {
            name: "shed".into(),
            max_feed_mm_per_min: [Some(3000.0), Some(600.0), Some(1000.0)],
            acceleration_mm_per_s2: [Some(400.0), Some(400.0), Some(50.0)],
            junction_deviation_mm: Some(0.02),
            rapid_mm_per_min: Some(6000.0),
            tool_change: Some(ToolChange::Automatic),
            ..Machine::default()
        }
    }

    #[test]
    fn a_long_move_takes_its_trapezoid_on_the_machine_of_the_setup() {
        let estimate = estimate(&left(), 1, shed());
        let times = estimate.runs[0].times;
        // 100 mm/s are gathered at 400 mm/s2 in 0.25 s; the corner behind it is a slow one.
        let alone = 0.25 + 100.0 / 100.0;
        assert!((times.rapid_s - alone).abs() < 0.02, "{times:?}");
        // Y feeds 10 mm/s and not 20.
        assert!((times.slow_axes_s - 3.0).abs() < 1e-9, "{times:?}");
        assert_eq!(estimate.runs[0].total_s(), times.total_s() + 2.0);
        assert_eq!((estimate.changing_s, estimate.machine.as_str()), (0.0, "on shed"));
    }

    #[test]
    fn what_is_set_wins_over_the_machine_and_that_over_the_defaults() {
        let rapid = Yielding::given(1500.0);
        let set = EstimateTime { acceleration: Yielding::given(900.0), rapid, ..left() };
        let set_on_shed = set.kinematics(&shed());
        assert_eq!(set_on_shed.acceleration_mm_per_s2, [900.0; 3]);
        assert_eq!(set_on_shed.rapid_mm_per_min, [1500.0, 300.0, 500.0]);
        let on_shed = left().kinematics(&shed());
        assert_eq!(on_shed.acceleration_mm_per_s2, [400.0, 400.0, 50.0]);
        assert_eq!(on_shed.rapid_mm_per_min, [6000.0, 1200.0, 2000.0]);
        assert_eq!(on_shed.junction_deviation_mm, 0.02);
        let on_none = left().kinematics(&Machine::default());
        assert_eq!(on_none.acceleration_mm_per_s2, [300.0; 3]);
        assert_eq!(on_none.rapid_mm_per_min, [5000.0; 3]);
        assert_eq!(on_none.feed_mm_per_min, [f64::INFINITY; 3]);
    }

    #[test]
    fn changing_tools_takes_time_between_them() {
        let changing =
            |node: &EstimateTime, tools, machine| estimate(node, tools, machine).changing_s;
        assert_eq!(changing(&left(), 3, Machine::default()), 120.0);
        assert_eq!(changing(&left(), 3, shed()), 20.0);
        let slow = EstimateTime { tool_change: Yielding::given(300.0), ..left() };
        assert_eq!(changing(&slow, 2, shed()), 300.0);
    }

    #[test]
    fn what_is_assumed_is_said() {
        let said =
            |acceleration, machine: Machine| EstimateTime { acceleration, ..left() }.on(&machine);
        let (set, unset) = (Yielding::given(450.5), Yielding::left(300.0));
        let none = Machine::default;
        assert_eq!(said(set.clone(), none()), "on a machine that gathers 450.5 mm/s2");
        let choose = "on a machine that gathers 300 mm/s2; choose yours with machine=...";
        assert_eq!(said(unset.clone(), none()), choose);
        assert_eq!(said(set, shed()), "on shed, if it gathers 450.5 mm/s2");
        assert_eq!(said(unset.clone(), shed()), "on shed");
        let silent = Machine { acceleration_mm_per_s2: [None; 3], ..shed() };
        let told = "on shed, if it gathers 300 mm/s2 (its profile does not say)";
        assert_eq!(said(unset, silent), told);
    }

    #[test]
    fn a_move_that_no_machine_can_make_is_an_error() {
        let mut bad = tool_run(0.0);
        bad.motion.moves[2].to.y = f64::NAN;
        let machining = Machining { runs: vec![bad], faults: vec![], readable: true };
        let program = Program { machining: &machining, setup: None };
        let fault = run(|cx| left().run(program, cx).map(|_| ())).unwrap_err().to_string();
        assert!(fault.contains("move 2 leads to (100, NaN, 0) mm at 1200 mm/min"), "{fault}");
    }
}

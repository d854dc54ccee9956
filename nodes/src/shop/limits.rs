//! What a program asks of a machine, held against what the machine can do.
//!
//! The extent is that of all moves, rapids and the safe height included. A program that cannot be run is
//! refused; a feed that is too fast is not, since controllers slow a move down to what its slowest axis
//! can do: of that the user is warned, with the speed that is left. For a move along the unit vector u the
//! limit of axis i leaves the speed limitᵢ / |uᵢ|. An arc reaches as far as it bulges, and has the
//! directions of chords that stay within [`ARC_TOLERANCE_MM`] of it.

use super::{AXES, Machine, ToolChange, Travel, short};
use carvegraph_geometry::{DVec3, PathArc};
use carvegraph_sdk::{Arc, Command};

/// Less cannot be written in a program: half of its last decimal, in mm.
const GRAIN_MM: f64 = 0.0005;

/// How close the chords are by which an arc's directions are told, in mm: what a controller's own are.
const ARC_TOLERANCE_MM: f64 = 0.002;

/// What a program, or an operation of it, asks of a machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Demands {
    /// Least coordinates of all moves, in the program's frame.
    min: DVec3,
    /// Greatest.
    max: DVec3,
    /// Speed of the spindle, in rpm.
    spindle_rpm: Option<f64>,
    /// Feed of cutting in mm/min, as far as the machine is concerned: for advice.
    feed_mm_per_min: f64,
    /// The tool that is to be changed to.
    tool: Option<u32>,
}

/// Why a machine cannot run a program.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Violation {
    /// The parameter of `post` that is to blame, if one is.
    pub(crate) param: Option<&'static str>,
    /// What is asked, what there is, by how much it is too much, and what to do.
    pub(crate) message: String,
}

impl Demands {
    /// To go so far: the least and the greatest coordinates in the program's frame.
    pub(crate) fn reaching(min: DVec3, max: DVec3) -> Self {
        Self { min, max, spindle_rpm: None, feed_mm_per_min: 0.0, tool: None }
    }

    /// What these commands ask; their arcs are among `arcs`.
    pub(crate) fn of(commands: &[Command], arcs: &[Arc]) -> Self {
        let mut demands = Self::reaching(DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut at: Option<DVec3> = None;
        for command in commands {
            match *command {
                Command::Rapid { to } => demands.reach(to),
                Command::Feed { to, mm_per_min } => {
                    demands.reach(to);
                    demands.feed_mm_per_min = demands.feed_mm_per_min.max(mm_per_min);
                }
                Command::Arc { arc } => {
                    let Some(arc) = arcs.get(arc as usize) else { continue };
                    if let Some(from) = at {
                        let around = curve(arc).bounds(from, arc.to.into());
                        demands.reach(around.min.into());
                        demands.reach(around.max.into());
                    }
                    demands.feed_mm_per_min = demands.feed_mm_per_min.max(arc.mm_per_min);
                }
                Command::Spindle { rpm, .. } => demands.spindle_rpm = Some(rpm),
                Command::ToolChange { number } => demands.tool = Some(number),
                _ => {}
            }
            at = end(command, arcs).or(at);
        }
        demands
    }

    fn reach(&mut self, to: [f64; 3]) {
        let to = DVec3::from_array(to);
        (self.min, self.max) = (self.min.min(to), self.max.max(to));
    }
}

/// Where a move ends.
fn end(command: &Command, arcs: &[Arc]) -> Option<DVec3> {
    match *command {
        Command::Rapid { to } | Command::Feed { to, .. } => Some(to.into()),
        Command::Arc { arc } => arcs.get(arc as usize).map(|arc| arc.to.into()),
        _ => None,
    }
}

fn curve(arc: &Arc) -> PathArc {
    PathArc { plane: arc.plane, direction: arc.direction, center: arc.center.into() }
}

impl Machine {
    /// The axes that do not go as far as a program.
    pub(crate) fn too_far(&self, demands: &Demands) -> Vec<Violation> {
        let travels = (0..3).flat_map(|axis| self.too_far_along(axis, demands));
        travels.map(|message| Violation { param: None, message }).collect()
    }

    /// What else keeps it from running a program: its spindle and its tools.
    pub(crate) fn not_driven(&self, demands: &Demands) -> Vec<Violation> {
        self.spindle_violation(demands).into_iter().chain(self.tool_violation(demands)).collect()
    }

    fn too_far_along(&self, axis: usize, demands: &Demands) -> Vec<String> {
        let (name, advice) = (AXES[axis], ADVICE[axis]);
        let (low, high) = (demands.min[axis], demands.max[axis]);
        let beyond = |place: f64, bound: f64, excess: f64| {
            format!(
                "{name} goes to {} mm and the machine reaches {} mm: {} mm too far ({advice}, or set zero elsewhere)",
                short(place),
                short(bound),
                short(excess)
            )
        };
        match self.travel[axis] {
            Some(Travel::Length(travel)) if high - low > travel + GRAIN_MM => vec![format!(
                "{name} needs {} mm and the machine travels {} mm: {} mm too much ({advice})",
                short(high - low),
                short(travel),
                short(high - low - travel)
            )],
            Some(Travel::Range { min, max }) => {
                let below = (low < min - GRAIN_MM).then(|| beyond(low, min, min - low));
                let above = (high > max + GRAIN_MM).then(|| beyond(high, max, high - max));
                below.into_iter().chain(above).collect()
            }
            _ => Vec::new(),
        }
    }

    fn spindle_violation(&self, demands: &Demands) -> Option<Violation> {
        let rpm = demands.spindle_rpm?;
        let near = self.nearest_spindle_rpm(rpm);
        let what = match near.total_cmp(&rpm) {
            std::cmp::Ordering::Equal => return None,
            std::cmp::Ordering::Less => {
                format!("at most {near} rpm: {} rpm too fast", short(rpm - near))
            }
            std::cmp::Ordering::Greater => {
                format!("at least {near} rpm: {} rpm too slow", short(near - rpm))
            }
        };
        let feed = (demands.feed_mm_per_min * near / rpm).floor();
        let message = format!(
            "the spindle is to turn at {} rpm and turns {what} (set spindle to {near} and, for the same chips, \
             feed to {feed})",
            short(rpm)
        );
        Some(Violation { param: Some("spindle"), message })
    }

    fn tool_violation(&self, demands: &Demands) -> Option<Violation> {
        let number = demands.tool.filter(|_| self.tool_change == Some(ToolChange::None))?;
        let message = format!(
            "the program changes to tool {number} and the machine changes none (set its number, tool, to 0 and \
             put it in by hand)"
        );
        Some(Violation { param: Some("tool"), message })
    }

    /// The feeds that it cannot reach, in words: which axis, and what is left of the feed.
    pub(crate) fn slowed(&self, commands: &[Command], arcs: &[Arc]) -> Vec<String> {
        let mut worst: Vec<Slowed> = Vec::new();
        let mut at: Option<DVec3> = None;
        for command in commands {
            let to = end(command, arcs);
            if let Some((from, to)) = at.zip(to) {
                match *command {
                    Command::Feed { mm_per_min, .. } => {
                        self.slow(to - from, mm_per_min, &mut worst)
                    }
                    Command::Arc { arc } => {
                        let arc = &arcs[arc as usize];
                        let mut from = from;
                        for to in curve(arc).chords(from, to, ARC_TOLERANCE_MM) {
                            self.slow(to - from, arc.mm_per_min, &mut worst);
                            from = to;
                        }
                    }
                    _ => {}
                }
            }
            at = to.or(at);
        }
        worst.iter().map(|slowed| slowed.told(self)).collect()
    }

    /// Holds one move against the feeds of all axes.
    fn slow(&self, along: DVec3, feed: f64, worst: &mut Vec<Slowed>) {
        let length = along.length();
        for axis in 0..3 {
            let Some(limit) = self.max_feed_mm_per_min[axis] else { continue };
            if length == 0.0 || feed * along[axis].abs() <= limit * length {
                continue;
            }
            let left = limit * length / along[axis].abs();
            match worst.iter_mut().find(|known| known.axis == axis && known.feed == feed) {
                Some(known) => known.left = known.left.min(left),
                None => worst.push(Slowed { axis, feed, left }),
            }
        }
    }
}

/// What to make smaller where an axis does not go far enough.
const ADVICE: [&str; 3] = [
    "make the part narrower: canvas_width",
    "make the part shorter: canvas_height",
    "make the part flatter or lower safe_z",
];

/// A feed that an axis cannot follow everywhere, in mm/min.
struct Slowed {
    axis: usize,
    feed: f64,
    /// The slowest that a move becomes.
    left: f64,
}

impl Slowed {
    fn told(&self, machine: &Machine) -> String {
        let limit = machine.max_feed_mm_per_min[self.axis].unwrap_or(f64::INFINITY);
        format!(
            "machine {:?}: {} feeds at most {} mm/min, so that {} mm/min become {:.0} mm/min in places",
            machine.name,
            AXES[self.axis],
            short(limit),
            short(self.feed),
            self.left
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shop::{SetBy, SpindleRange};
    use carvegraph_sdk::{Direction, Plane};

    fn job(spindle: f64, tool: Option<u32>) -> Vec<Command> {
        let start = tool.map(|number| Command::ToolChange { number });
        let moves = [
            Command::Spindle { rpm: spindle, direction: Direction::Clockwise },
            Command::Rapid { to: [0.0, 0.0, 5.0] },
            Command::Feed { to: [0.0, 0.0, -5.0], mm_per_min: 500.0 },
            Command::Feed { to: [203.2, 100.0, -5.0], mm_per_min: 1500.0 },
            Command::Rapid { to: [203.2, 100.0, 5.0] },
        ];
        start.into_iter().chain(moves).collect()
    }

    fn machine(travel: [f64; 3]) -> Machine {
        Machine {
            name: "small".into(),
            travel: travel.map(|length| Some(Travel::Length(length))),
            ..Machine::default()
        }
    }

    fn violations(machine: &Machine, job: &[Command]) -> Vec<String> {
        let demands = Demands::of(job, &[]);
        let violations = machine.too_far(&demands).into_iter().chain(machine.not_driven(&demands));
        violations.map(|violation| violation.message).collect()
    }

    #[test]
    fn each_axis_is_told_with_what_it_lacks() {
        let job = job(9000.0, None);
        assert!(violations(&machine([203.2, 100.0, 10.0]), &job).is_empty());
        assert_eq!(
            violations(&machine([180.0, 99.5, 9.999]), &job),
            [
                "X needs 203.2 mm and the machine travels 180 mm: 23.2 mm too much (make the part \
                 narrower: canvas_width)",
                "Y needs 100 mm and the machine travels 99.5 mm: 0.5 mm too much (make the part \
                 shorter: canvas_height)",
                "Z needs 10 mm and the machine travels 9.999 mm: 0.001 mm too much (make the part \
                 flatter or lower safe_z)",
            ]
        );
    }

    #[test]
    fn a_range_is_where_the_work_zero_puts_it() {
        let range = |min, max| Some(Travel::Range { min, max });
        let travel = [range(10.0, 200.0), range(0.0, 100.0), range(-50.0, 4.0)];
        let machine = Machine { travel, ..machine([1.0; 3]) };
        assert_eq!(
            violations(&machine, &job(9000.0, None)),
            [
                "X goes to 0 mm and the machine reaches 10 mm: 10 mm too far (make the part narrower: \
                 canvas_width, or set zero elsewhere)",
                "X goes to 203.2 mm and the machine reaches 200 mm: 3.2 mm too far (make the part \
                 narrower: canvas_width, or set zero elsewhere)",
                "Z goes to 5 mm and the machine reaches 4 mm: 1 mm too far (make the part flatter or \
                 lower safe_z, or set zero elsewhere)",
            ]
        );
    }

    #[test]
    fn spindles_are_too_fast_or_too_slow_by_so_much() {
        let (min_rpm, max_rpm) = (Some(12_000.0), Some(18_000.0));
        let spindle = Some(SpindleRange { min_rpm, max_rpm, set_by: SetBy::Program });
        let machine = Machine { spindle, ..machine([1000.0; 3]) };
        assert!(violations(&machine, &job(12_000.0, None)).is_empty());
        assert_eq!(
            violations(&machine, &job(24_000.0, None)),
            ["the spindle is to turn at 24000 rpm and turns at most 18000 rpm: 6000 rpm too fast \
              (set spindle to 18000 and, for the same chips, feed to 1125)"]
        );
        assert_eq!(
            violations(&machine, &job(10_000.0, None)),
            [
                "the spindle is to turn at 10000 rpm and turns at least 12000 rpm: 2000 rpm too slow \
              (set spindle to 12000 and, for the same chips, feed to 1800)"
            ]
        );
    }

    #[test]
    fn a_tool_that_nobody_changes_is_refused() {
        let changes = |tool_change| Machine { tool_change, ..machine([1000.0; 3]) };
        let job = job(9000.0, Some(3));
        for fine in [None, Some(ToolChange::Manual), Some(ToolChange::Automatic)] {
            assert!(violations(&changes(fine), &job).is_empty());
        }
        assert_eq!(
            violations(&changes(Some(ToolChange::None)), &job),
            [
                "the program changes to tool 3 and the machine changes none (set its number, tool, to 0 and \
                 put it in by hand)"
            ]
        );
    }

    #[test]
    fn nothing_is_asked_of_no_machine() {
        assert!(violations(&Machine::default(), &job(1e6, Some(9))).is_empty());
        assert!(Machine::default().slowed(&job(1e6, Some(9)), &[]).is_empty());
    }

    #[test]
    fn feeds_are_held_against_the_axis_that_they_go_along() {
        let limits = [Some(800.0), None, Some(300.0)];
        let machine = Machine { max_feed_mm_per_min: limits, ..machine([1000.0; 3]) };
        // Along (203.2, 100) X does 1345.9 of 1500 mm/min.
        assert_eq!(
            machine.slowed(&job(9000.0, None), &[]),
            [
                "machine \"small\": Z feeds at most 300 mm/min, so that 500 mm/min become 300 mm/min in \
                 places",
                "machine \"small\": X feeds at most 800 mm/min, so that 1500 mm/min become 892 mm/min \
                 in places",
            ]
        );
        let fast = Machine { max_feed_mm_per_min: [Some(1500.0); 3], ..machine };
        assert!(fast.slowed(&job(9000.0, None), &[]).is_empty());
    }

    #[test]
    fn an_arc_reaches_as_far_as_it_bulges_and_goes_all_ways() {
        let arc = Arc {
            plane: Plane::Zx,
            direction: Direction::Clockwise,
            center: [10.0, 0.0, 0.0],
            to: [20.0, 0.0, 0.0],
            mm_per_min: 1000.0,
        };
        let start = Command::Feed { to: [0.0; 3], mm_per_min: 100.0 };
        let job = [Command::Rapid { to: [0.0, 0.0, 5.0] }, start, Command::Arc { arc: 0 }];
        for (direction, low, high) in
            [(Direction::CounterClockwise, 0.0, 10.0), (Direction::Clockwise, -10.0, 5.0)]
        {
            let demands = Demands::of(&job, &[Arc { direction, ..arc }]);
            assert!((demands.min - DVec3::new(0.0, 0.0, low)).length() < 1e-9, "{demands:?}");
            assert!((demands.max - DVec3::new(20.0, 0.0, high)).length() < 1e-9, "{demands:?}");
            assert_eq!(demands.feed_mm_per_min, 1000.0);
        }
        let limits = [None, None, Some(300.0)];
        let slow = Machine { max_feed_mm_per_min: limits, ..machine([1000.0; 3]) };
        assert_eq!(
            slow.slowed(&job, &[arc]),
            [
                "machine \"small\": Z feeds at most 300 mm/min, so that 1000 mm/min become 300 mm/min in \
              places"
            ]
        );
    }
}

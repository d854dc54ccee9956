//! What a machine is to do, step by step, and whether it can.

use super::tools::Division;
use crate::job::Step;
use crate::shop::{Demands, Machine, Violation};
use carvegraph_core::{Context, NodeError};
use carvegraph_geometry::{DVec3, PathArc, SpanKind, Toolpath};
use carvegraph_sdk::{Arc, Command, Direction};
use std::ops::Range;

/// The commands of all steps, in order. The first of a run changes to its tool, if it has a number, and
/// starts the spindle, so that the commands of each run are whole by themselves.
#[derive(Debug, PartialEq)]
pub(super) struct Sequence {
    pub(super) commands: Vec<Command>,
    /// What comments refer to.
    pub(super) texts: Vec<String>,
    /// What arcs refer to.
    pub(super) arcs: Vec<Arc>,
    /// The commands of each step.
    of_steps: Vec<Range<usize>>,
}

impl Sequence {
    /// The commands of `steps`, as seen from `origin`. Where there are several, each begins with its
    /// name.
    pub(super) fn new(
        steps: &[Step<'_>],
        division: &Division,
        origin: DVec3,
        machine: &Machine,
    ) -> Result<Self, NodeError> {
        let mut sequence = Self {
            commands: Vec::new(),
            texts: Vec::new(),
            arcs: Vec::new(),
            of_steps: Vec::new(),
        };
        for run in &division.runs {
            let mut turning = None;
            for (k, step) in run.steps.clone().zip(&steps[run.steps.clone()]) {
                let start = sequence.commands.len();
                if steps.len() > 1 {
                    sequence.commands.push(Command::Comment { text: k as u32 });
                    sequence.texts.push(step.name.to_owned());
                }
                if let Some(number) = run.number.filter(|_| turning.is_none()) {
                    sequence.commands.push(Command::ToolChange { number });
                }
                let rpm = rpm(step, machine);
                if turning != Some(rpm) {
                    let direction = Direction::Clockwise;
                    sequence.commands.push(Command::Spindle { rpm, direction });
                    turning = Some(rpm);
                }
                sequence.move_along(step, origin)?;
                sequence.of_steps.push(start..sequence.commands.len());
            }
        }
        Ok(sequence)
    }

    /// The commands of some steps.
    pub(super) fn of(&self, steps: Range<usize>) -> &[Command] {
        let of_steps = &self.of_steps[steps];
        match (of_steps.first(), of_steps.last()) {
            (Some(first), Some(last)) => &self.commands[first.start..last.end],
            _ => &[],
        }
    }

    /// The moves of a step's path.
    fn move_along(&mut self, step: &Step<'_>, origin: DVec3) -> Result<(), NodeError> {
        step.check_speeds()?;
        let path: &Toolpath = step.toolpath;
        let Some(feeds) = path.feeds else { return Ok(()) };
        self.commands.reserve(path.tips.len());
        self.arcs.reserve(path.arcs.len());
        for span in &path.spans {
            let mm_per_min = match span.kind {
                SpanKind::Plunge => feeds.plunge_mm_per_min,
                _ => feeds.cut_mm_per_min,
            };
            let mut arcs = path.arcs_within(span).iter().peekable();
            for index in span.points.clone() {
                let to = (path.tips[index] - origin).to_array();
                self.commands.push(match arcs.next_if(|(end, _)| *end == index) {
                    Some((_, PathArc { plane, direction, center })) => {
                        let center = (*center - origin).to_array();
                        let (plane, direction) = (*plane, *direction);
                        self.arcs.push(Arc { plane, direction, center, to, mm_per_min });
                        Command::Arc { arc: (self.arcs.len() - 1) as u32 }
                    }
                    None if span.kind == SpanKind::Rapid => Command::Rapid { to },
                    None => Command::Feed { to, mm_per_min },
                });
            }
        }
        Ok(())
    }

    /// Holds all steps against the machine: refuses what it cannot run, warns of feeds that it slows
    /// down. The work zero is the same for all, so their moves must fit together.
    pub(super) fn check(
        &self,
        steps: &[Step<'_>],
        machine: &Machine,
        cx: &Context<'_>,
    ) -> Result<(), NodeError> {
        let mut violations = machine.too_far(&Demands::of(&self.commands, &self.arcs));
        for (k, step) in steps.iter().enumerate() {
            let own = machine.not_driven(&Demands::of(self.of(k..k + 1), &self.arcs));
            violations.extend(own.into_iter().map(|violation| named(violation, step, k, steps)));
        }
        if violations.is_empty() {
            let slowed = machine.slowed(&self.commands, &self.arcs);
            slowed.into_iter().for_each(|slowed| cx.warn(slowed));
            return Ok(());
        }
        let param = violations.iter().find_map(|violation| violation.param).unwrap_or("setup");
        let told: Vec<String> = violations.into_iter().map(|violation| violation.message).collect();
        Err(NodeError::refused(param, format!("machine {:?}: {}", machine.name, told.join("; "))))
    }
}

/// A violation with the operation that it is found in, where there are several. Parameters are those of
/// the last one's node.
fn named(violation: Violation, step: &Step<'_>, k: usize, steps: &[Step<'_>]) -> Violation {
    if steps.len() == 1 {
        return violation;
    }
    let param = violation.param.filter(|_| k + 1 == steps.len());
    let message = format!("operation {:?}: {}", step.name, violation.message);
    Violation { param, message }
}

/// The speed that the spindle turns at, in rpm.
pub(super) fn rpm(step: &Step<'_>, machine: &Machine) -> f64 {
    match step.drive.spindle_yields {
        true => machine.nearest_spindle_rpm(step.drive.spindle_rpm),
        false => step.drive.spindle_rpm,
    }
}

/// Tells where a default speed gave way.
pub(super) fn note_speeds(steps: &[Step<'_>], machine: &Machine, cx: &Context<'_>) {
    let mut told = Vec::new();
    for step in steps {
        let (rpm, default) = (rpm(step, machine), step.drive.spindle_rpm);
        if rpm != default && !told.contains(&default) {
            told.push(default);
            let name = &machine.name;
            cx.note(format!(
                "the spindle turns at {rpm} rpm: {default} is not what {name:?} can do"
            ));
        }
    }
}

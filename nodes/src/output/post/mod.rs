//! A path becomes a program in a dialect, and so do the operations that go before it.
//!
//! The program's frame follows from where the user sets the machine to zero: `z_zero: bottom,
//! xy_zero: corner` is the frame of the saved model; `top` and `center` shift it.
//!
//! Between operations the path of the one before has gone up to its safe height; then the tool is
//! changed where it is another one, the spindle started, and the next path comes from above
//! ([`commands`]). Where tools cannot be changed there is a program for each, whole by itself
//! ([`tools`]).
//!
//! A program that the machine of the setup cannot run is refused, with everything that keeps it from it.

mod commands;
mod head;
mod tools;

use crate::job::{Drive, Job, Step, check_name};
use crate::output::zero::Zero;
use crate::services::Dialects;
use crate::shop::{Machine, Setup};
use crate::values::{Gcode, ProgramText, ToolUse};
use carvegraph_core::{
    Choice, Conflict, Context, Inputs, Node, NodeError, Outputs, Params, Yielding,
};
use carvegraph_geometry::{Bounds, Cutter, Toolpath};
use carvegraph_sdk::{Dialect, PostError, Program, Stock, Units};
use commands::{Sequence, note_speeds};
use head::{Place, names, remarks};
use std::io;
use tools::{Changer, Division, Run, Split};

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
    #[param(shared)]
    pub(crate) zero: Zero,
    /// Units of the program.
    #[param(default = UnitSystem::Mm)]
    pub(crate) units: UnitSystem,
    /// Number of the cutter in the controller's tool table; 0 takes the one that is in the spindle or, in a
    /// program that changes tools, the next number that is free.
    #[param(default = 0, range = 0..=9999)]
    pub(crate) tool: Yielding<u32>,
    /// What its own operation is called where there are several: letters, digits, - and _.
    #[param(default = "finish")]
    pub(crate) name: String,
    /// How operations with several tools are divided into programs.
    #[param(default = Split::Auto)]
    pub(crate) split: Split,
    /// How far the controller may round corners off to keep its speed, where it can be told.
    #[param(unit = "mm", default = 0.01, range = 0.0001..=10.0)]
    pub(crate) blend: f64,
    /// Whether arcs may be written; if not, they become short lines.
    #[param(default = true)]
    pub(crate) arcs: Yielding<bool>,
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
pub(crate) struct Posting<'a> {
    /// The path with all its moves and speeds.
    toolpath: &'a Toolpath,
    /// The box that holds the part.
    part: &'a Bounds,
    /// The cutter, for the program's head.
    cutter: &'a Cutter,
    /// The machine, the tool and the material.
    setup: Option<&'a Setup>,
    /// Operations that go before the path.
    before: Option<&'a Job>,
}

#[derive(Outputs)]
pub(crate) struct Posted {
    /// The program, or one for each tool.
    program: Gcode,
}

impl Node for Post {
    const KIND: &'static str = "post";
    const VERSION: u32 = 2;
    const USES_PREFIX: bool = true;
    type Inputs<'a> = Posting<'a>;
    type Outputs = Posted;

    fn check(&self) -> Result<(), Conflict> {
        check_name(&self.name).map_err(|message| Conflict { param: "name", message })
    }

    fn run(&self, inputs: Posting<'_>, cx: &Context<'_>) -> Result<Posted, NodeError> {
        let none = Setup::default();
        let setup = inputs.setup.unwrap_or(&none);
        let own = Step {
            name: &self.name,
            toolpath: inputs.toolpath,
            cutter: inputs.cutter,
            setup,
            drive: Drive::new(&self.tool, &self.spindle, setup),
        };
        let steps: Vec<Step<'_>> =
            inputs.before.into_iter().flat_map(Job::steps).chain([own]).collect();
        let machine = machine_of(&steps)?;
        let dialects: &Dialects = cx.service()?;
        let name = self.dialect.or(machine.dialect.clone());
        let dialect = dialects.find(&name).ok_or_else(|| self.no_dialect(&name, machine))?;
        if let Some(own) = machine.dialect.as_ref().filter(|own| **own != name) {
            cx.warn(format!("machine {:?} understands {own}, but {name} is set", machine.name));
        }
        let can_say = dialect.capabilities().tool_change;
        let changer = Changer { dialect: &name, can_say, machine };
        let division = Division::new(&steps, self.split, &changer)?;
        let text = Text { post: self, part: inputs.part, steps: &steps, machine, division, cx };
        let programs = text.programs(dialect)?;
        let extension = dialect.extension().to_owned();
        let zero = Some(self.zero.of(inputs.part));
        Ok(Posted { program: Gcode { programs, dialect: name, extension, zero } })
    }
}

impl Post {
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
}

/// The machine that all operations are set up for; those without one take it as it is.
fn machine_of<'a>(steps: &[Step<'a>]) -> Result<&'a Machine, NodeError> {
    let mut set_up = steps.iter().rev().filter(|step| !step.setup.machine.is_none());
    let Some(first) = set_up.next() else {
        return steps
            .last()
            .map(|step| &step.setup.machine)
            .ok_or_else(|| NodeError::failed("nothing to post"));
    };
    let machine = &first.setup.machine;
    match set_up.find(|step| step.setup.machine != *machine) {
        None => Ok(machine),
        Some(other) => Err(NodeError::Failed(format!(
            "operation {:?} is set up for machine {:?} and operation {:?} for {:?}: a program runs on one",
            first.name, machine.name, other.name, other.setup.machine.name
        ))),
    }
}

/// Operations on their way to being text.
struct Text<'a> {
    post: &'a Post,
    part: &'a Bounds,
    steps: &'a [Step<'a>],
    machine: &'a Machine,
    division: Division,
    cx: &'a Context<'a>,
}

impl Text<'_> {
    fn programs(&self, dialect: &dyn Dialect) -> Result<Vec<ProgramText>, NodeError> {
        let Self { part, steps, machine, division, cx, .. } = self;
        if steps.len() > 1 {
            steps.iter().try_for_each(|step| step.check_ends(part.max.z))?;
        }
        let sequence = Sequence::new(steps, division, self.post.zero.of(part), machine)?;
        sequence.check(steps, machine, cx)?;
        note_speeds(steps, machine, cx);
        division.warnings(steps, machine).into_iter().for_each(|warning| cx.warn(warning));
        let programs = division.programs();
        let of = programs.len();
        let place = |(k, runs)| Place { number: k + 1, of, runs };
        let places = programs.into_iter().enumerate().map(place);
        places.map(|place| self.program(dialect, place, &sequence)).collect()
    }

    fn program(
        &self,
        dialect: &dyn Dialect,
        place: Place<'_>,
        sequence: &Sequence,
    ) -> Result<ProgramText, NodeError> {
        let Self { post, part, steps, machine, cx, .. } = self;
        let of_runs = place.runs[0].steps.start..place.runs[place.runs.len() - 1].steps.end;
        let commands = sequence.of(of_runs.clone());
        let name = match place.of {
            1 => String::new(),
            _ => format!("{}-{}", place.number, steps[of_runs.start].name),
        };
        let title = match name.as_str() {
            "" => cx.prefix().to_owned(),
            name => format!("{}-{name}", cx.prefix()),
        };
        let remarks = remarks(post, part, place, steps, machine);
        let remarks: Vec<&str> = remarks.iter().map(String::as_str).collect();
        let texts: Vec<&str> = sequence.texts.iter().map(String::as_str).collect();
        let origin = post.zero.of(part);
        let program = Program {
            title: &title,
            remarks: &remarks,
            units: match post.units {
                UnitSystem::Mm => Units::Mm,
                UnitSystem::Inch => Units::Inch,
            },
            path_tolerance_mm: post.blend,
            lines_only: !post.arcs.or(machine.arcs),
            stock: Some(Stock {
                min: (part.min - origin).to_array(),
                max: (part.max - origin).to_array(),
            }),
            commands,
            texts: &texts,
            arcs: &sequence.arcs,
        };
        // About 24 bytes a block.
        let text = Vec::with_capacity(commands.len() * 24);
        let mut sink = Sink { text, cx, looked: 0 };
        dialect.post(&program, &mut sink).map_err(|fault| match fault {
            PostError::Io(_) if cx.is_cancelled() => NodeError::Cancelled,
            fault => NodeError::Failed(format!("dialect {:?}: {fault}", dialect.name())),
        })?;
        let tools = place.runs.iter().map(|run| self.tool_use(run)).collect();
        Ok(ProgramText { name, tools, text: sink.text })
    }

    fn tool_use(&self, run: &Run) -> ToolUse {
        let steps = &self.steps[run.steps.clone()];
        let cutter = steps[0].cutter.clone();
        ToolUse { number: run.number, cutter, operations: names(steps) }
    }
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
mod tests;

//! What stands in the head of a program for its operator.

use super::Post;
use super::commands::rpm;
use super::tools::{Run, described_tool};
use crate::job::{Step, described};
use crate::output::zero::{XyZero, ZZero};
use crate::shop::{Machine, NONE, short};
use carvegraph_geometry::Bounds;

/// A program among those of a job.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    /// Which one, from 1.
    pub(super) number: usize,
    /// How many there are.
    pub(super) of: usize,
    /// What it holds.
    pub(super) runs: &'a [Run],
}

/// The remarks of one program.
pub(super) fn remarks(
    post: &Post,
    part: &Bounds,
    place: Place<'_>,
    steps: &[Step<'_>],
    machine: &Machine,
) -> Vec<String> {
    let size = part.size();
    let z_zero = match post.zero.z_zero {
        ZZero::Top => "top of the part",
        ZZero::Bottom => "bottom: the frame of the saved model",
    };
    let xy_zero = match post.zero.xy_zero {
        XyZero::Corner => "near left corner",
        XyZero::Center => "middle of the part",
    };
    let mut remarks = of_tools(place, steps);
    remarks.extend([
        format!("Part: {:.3} x {:.3} x {:.3} mm", size.x, size.y, size.z),
        format!("Z0: {z_zero}"),
        format!("X0 Y0: {xy_zero}"),
    ]);
    remarks.extend(of_change(place));
    remarks.extend(of_setup(&all(place, steps), place.runs.len() == 1, machine));
    remarks
}

/// The steps of a program.
fn all<'a, 's>(place: Place<'_>, steps: &'a [Step<'s>]) -> Vec<&'a Step<'s>> {
    place.runs.iter().flat_map(|run| &steps[run.steps.clone()]).collect()
}

/// The names of operations.
pub(super) fn names(steps: &[Step<'_>]) -> String {
    steps.iter().map(|step| step.name).collect::<Vec<_>>().join(", ")
}

/// Which program it is, and its tools.
fn of_tools(place: Place<'_>, steps: &[Step<'_>]) -> Vec<String> {
    let of = |run: &Run| &steps[run.steps.clone()];
    if let [run] = place.runs {
        let cutter = format!("Cutter: {}", described(of(run)[0].cutter));
        if steps.len() == 1 {
            return vec![cutter];
        }
        let program = match place.of {
            1 => format!("Operations: {}", names(of(run))),
            count => format!("Program {} of {count}: {}", place.number, names(of(run))),
        };
        return vec![program, cutter];
    }
    let line = |run: &Run| {
        let number = run.number.unwrap_or_default();
        format!("Tool {number}: {}, for {}", described_tool(&of(run)[0]), names(of(run)))
    };
    place.runs.iter().map(line).collect()
}

/// What a change of tools asks of the operator: cutters differ in length.
fn of_change(place: Place<'_>) -> Option<String> {
    match place {
        Place { runs: [_, _, ..], .. } => {
            Some("The controller must know or measure the length of each tool".to_owned())
        }
        Place { of: 1, .. } => None,
        Place { number: 1, .. } => {
            Some("Set Z where no program cuts: it is set there for each cutter".to_owned())
        }
        _ => Some("Set Z anew with this cutter, where it was set for program 1".to_owned()),
    }
}

/// The setup: nothing where nothing is chosen.
fn of_setup(steps: &[&Step<'_>], is_one_tool: bool, machine: &Machine) -> Vec<String> {
    let machine_line = (machine.name != NONE).then(|| format!("Machine: {}", machine.name));
    // Where there are several, each stands behind its number.
    let named = steps.iter().map(|step| &step.setup.tool).find(|name| *name != NONE);
    let tool = named.filter(|_| is_one_tool).map(|name| format!("Tool: {name}"));
    let mut materials: Vec<&str> = Vec::new();
    for material in steps.iter().map(|step| step.setup.material.as_str()) {
        if material != NONE && !materials.contains(&material) {
            materials.push(material);
        }
    }
    let material = (!materials.is_empty()).then(|| format!("Material: {}", materials.join(", ")));
    let lines = [machine_line, tool, material];
    lines.into_iter().flatten().chain(by_hand(steps, machine)).collect()
}

/// The speeds that the operator has to set.
fn by_hand(steps: &[&Step<'_>], machine: &Machine) -> Vec<String> {
    if !machine.spindle_by_hand() {
        return Vec::new();
    }
    let speed = |step: &Step<'_>| short(rpm(step, machine));
    let first = speed(steps[0]);
    if steps.iter().all(|step| speed(step) == first) {
        return vec![format!("Set the spindle to {first} rpm by hand")];
    }
    let line = |step: &&Step<'_>| {
        format!("Set the spindle to {} rpm by hand for {}", speed(step), step.name)
    };
    steps.iter().map(line).collect()
}

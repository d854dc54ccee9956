//! Which operations share a tool, which number each tool has, and whether all go into one program.
//!
//! Operations that follow each other with equal cutters are a *run*: nothing is changed between them.
//! A program of several runs calls each tool by a number: the one that was set, else that of the
//! tool's library, else that of an equal cutter in the job, else the next one that is free.

use crate::job::{Step, described};
use crate::shop::{Machine, NONE, ToolChange};
use carvegraph_core::{Choice, NodeError};
use std::ops::Range;

/// How operations with several tools are divided into programs.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Split {
    /// One program if the controller and the machine change tools, else one for each tool.
    Auto,
    /// One program for each tool, to be run one after the other.
    ByTool,
    /// One program that changes tools.
    One,
}

/// Operations that follow each other with one tool.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Run {
    /// Which of the steps.
    pub(super) steps: Range<usize>,
    /// The number that the tool is called by, if it is.
    pub(super) number: Option<u32>,
}

/// What is there to change tools.
pub(super) struct Changer<'a> {
    pub(super) dialect: &'a str,
    /// Whether the dialect can say it.
    pub(super) can_say: bool,
    pub(super) machine: &'a Machine,
}

impl Changer<'_> {
    /// Why tools cannot be changed within a program, if so.
    fn hindrance(&self) -> Option<String> {
        if !self.can_say {
            return Some(format!("{} has no tool change", self.dialect));
        }
        let none = self.machine.tool_change == Some(ToolChange::None);
        none.then(|| format!("machine {:?} changes no tools", self.machine.name))
    }
}

/// The runs of a job, and how they are divided.
#[derive(Debug, PartialEq)]
pub(super) struct Division {
    pub(super) runs: Vec<Run>,
    /// Whether one program holds all of them.
    pub(super) is_one: bool,
    /// Those whose numbers are only their place.
    counted: Vec<usize>,
}

impl Division {
    /// Divides a job.
    ///
    /// # Errors
    /// If one program is wanted where tools cannot be changed, or a number stands for two tools.
    pub(super) fn new(
        steps: &[Step<'_>],
        split: Split,
        changer: &Changer<'_>,
    ) -> Result<Self, NodeError> {
        let mut runs = runs(steps);
        let several = runs.len() > 1;
        let hindrance = changer.hindrance();
        if let (Split::One, Some(why)) = (split, hindrance.as_ref().filter(|_| several)) {
            let message = format!(
                "{} tools cannot be in one program: {why} (set split to by_tool for a program each)",
                runs.len()
            );
            return Err(NodeError::refused("split", message));
        }
        let is_one = !several || split != Split::ByTool && hindrance.is_none();
        let says_so =
            matches!(changer.machine.tool_change, Some(ToolChange::Manual | ToolChange::Automatic));
        let with_library = says_so || several && is_one;
        for run in &mut runs {
            run.number =
                steps[run.steps.clone()].iter().find_map(|step| wanted(step, with_library));
        }
        let counted = if several && is_one { count(steps, &mut runs) } else { Vec::new() };
        check_numbers(steps, &runs)?;
        if let Some(run) = runs.iter().find(|run| several && run.number.is_some())
            && !changer.can_say
        {
            let message = format!(
                "operation {:?} asks for tool {}, but {} has no tool change: set its tool to 0 and put it \
                 in by hand",
                steps[run.steps.start].name,
                run.number.unwrap_or_default(),
                changer.dialect
            );
            return Err(NodeError::refused("tool", message));
        }
        Ok(Self { runs, is_one, counted })
    }

    /// The runs of each program.
    pub(super) fn programs(&self) -> Vec<&[Run]> {
        if self.is_one { vec![&self.runs] } else { self.runs.chunks(1).collect() }
    }

    /// What to look at before a program that changes tools is run.
    pub(super) fn warnings(&self, steps: &[Step<'_>], machine: &Machine) -> Vec<String> {
        let mut warnings = Vec::new();
        if !self.is_one || self.runs.len() < 2 {
            return warnings;
        }
        if machine.tool_change.is_none() {
            let unknown = "nothing is known of the machine's tool change: be sure that it stops for it or \
                           makes it by itself, or set split to by_tool";
            warnings.push(unknown.to_owned());
        }
        let called = self.counted.iter().map(|k| {
            let Run { steps: of, number } = &self.runs[*k];
            format!("{} tool {}", described(steps[of.start].cutter), number.unwrap_or_default())
        });
        let called: Vec<String> = called.collect();
        if !called.is_empty() {
            let called = called.join(" and ");
            let order = "by their order the program calls";
            warnings.push(format!("{order} {called}: put them there or set tool"));
        }
        warnings
    }
}

/// Steps that follow each other with one tool, without numbers.
fn runs(steps: &[Step<'_>]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (k, step) in steps.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if steps[run.steps.clone()].iter().all(|s| is_same_tool(s, step)) => {
                run.steps.end = k + 1;
            }
            _ => runs.push(Run { steps: k..k + 1, number: None }),
        }
    }
    runs
}

/// The number that a step wants its tool to be called by.
fn wanted(step: &Step<'_>, with_library: bool) -> Option<u32> {
    match step.drive.tool {
        Some(number) => Some(number).filter(|number| *number > 0),
        None => step.setup.number.filter(|_| with_library),
    }
}

/// Whether two steps can be cut with one tool: of equal shape, and nothing tells them apart.
fn is_same_tool(a: &Step<'_>, b: &Step<'_>) -> bool {
    let name = |step: &Step<'_>| Some(step.setup.tool.clone()).filter(|name| name != NONE);
    a.cutter == b.cutter && fit(wanted(a, true), wanted(b, true)) && fit(name(a), name(b))
}

fn fit<T: PartialEq>(a: Option<T>, b: Option<T>) -> bool {
    a.is_none() || b.is_none() || a == b
}

/// Whether two runs can be cut with one tool.
fn share_tool(steps: &[Step<'_>], a: &Run, b: &Run) -> bool {
    let of = |run: &Run| &steps[run.steps.clone()];
    of(a).iter().all(|a| of(b).iter().all(|b| is_same_tool(a, b)))
}

/// Gives a number to every run that has none; answers to which tools it gave their place.
fn count(steps: &[Step<'_>], runs: &mut [Run]) -> Vec<usize> {
    let mut counted = Vec::new();
    for k in 0..runs.len() {
        if runs[k].number.is_some() {
            continue;
        }
        let same = |run: &&Run| run.number.is_some() && share_tool(steps, run, &runs[k]);
        let number = runs.iter().find(same).and_then(|run| run.number);
        runs[k].number = number.or_else(|| {
            counted.push(k);
            (1..).find(|number| runs.iter().all(|run| run.number != Some(*number)))
        });
    }
    counted
}

fn check_numbers(steps: &[Step<'_>], runs: &[Run]) -> Result<(), NodeError> {
    for (k, b) in runs.iter().enumerate() {
        let taken = |a: &&Run| a.number.is_some() && a.number == b.number;
        let other = runs[..k].iter().filter(taken).find(|a| !share_tool(steps, a, b));
        let (Some(a), Some(number)) = (other, b.number) else { continue };
        let [a, b] = [a, b].map(|run| &steps[run.steps.start]);
        let message = format!(
            "operations {:?} and {:?} both call for tool {number}, which cannot be {} and {}: give one of \
             them another tool number",
            a.name,
            b.name,
            described_tool(a),
            described_tool(b)
        );
        return Err(NodeError::refused("tool", message));
    }
    Ok(())
}

/// A step's tool in a remark: "flat_6: flat, diameter 6 mm".
pub(super) fn described_tool(step: &Step<'_>) -> String {
    match step.setup.tool.as_str() {
        NONE => described(step.cutter),
        name => format!("{name}: {}", described(step.cutter)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::testing::{ball, flat, job, operation};
    use crate::job::{Job, Operation};

    fn divided(job: &Job, split: Split, change: Option<ToolChange>) -> Result<Division, String> {
        let steps: Vec<Step<'_>> = job.steps().collect();
        let machine = Machine { name: "mill".into(), tool_change: change, ..Machine::default() };
        let changer = Changer { dialect: "iso", can_say: true, machine: &machine };
        Division::new(&steps, split, &changer).map_err(|fault| fault.to_string())
    }

    /// The number of each run of a job that is one program.
    fn numbers(operations: impl IntoIterator<Item = Operation>) -> Vec<u32> {
        let division = divided(&job(operations), Split::One, None).unwrap();
        division.runs.iter().map(|run| run.number.unwrap()).collect()
    }

    fn two() -> Job {
        job([operation("a", flat(6.0), None), operation("b", ball(3.0), None)])
    }

    #[test]
    fn equal_cutters_that_follow_each_other_are_one_run() {
        let all = [flat(6.0), flat(6.0), ball(3.0), ball(2.0), ball(2.0)];
        let all = job(all.map(|cutter| operation("a", cutter, None)));
        let division = divided(&all, Split::ByTool, None).unwrap();
        let steps: Vec<_> = division.runs.iter().map(|run| run.steps.clone()).collect();
        assert_eq!(steps, [0..2, 2..3, 3..5]);
        assert_eq!(division.programs().len(), 3);
    }

    #[test]
    fn one_tool_is_called_only_if_asked_for() {
        let one = |tool| job([operation("a", flat(6.0), None), operation("b", flat(6.0), tool)]);
        for split in [Split::Auto, Split::ByTool, Split::One] {
            let number = |tool| divided(&one(tool), split, None).unwrap().runs[0].number;
            assert_eq!((number(None), number(Some(0)), number(Some(7))), (None, None, Some(7)));
            assert!(divided(&one(None), split, Some(ToolChange::None)).unwrap().is_one);
        }
    }

    #[test]
    fn tools_without_a_number_take_the_next_one_that_is_free() {
        let op = |cutter, tool| operation("a", cutter, tool);
        assert_eq!(numbers([op(flat(6.0), None), op(ball(3.0), None)]), [1, 2]);
        assert_eq!(numbers([op(flat(6.0), None), op(ball(3.0), Some(1))]), [2, 1]);
        assert_eq!(numbers([op(flat(6.0), Some(0)), op(ball(3.0), Some(0))]), [1, 2]);
        // The same tool again has its number again, whichever says it.
        assert_eq!(
            numbers([op(flat(6.0), None), op(ball(3.0), None), op(flat(6.0), Some(2))]),
            [2, 1, 2]
        );
        assert_eq!(
            numbers([op(flat(6.0), None), op(ball(3.0), None), op(flat(6.0), None)]),
            [1, 2, 1]
        );
        // Two tools of equal shape may be meant, one of them blunt.
        assert_eq!(numbers([op(flat(6.0), Some(4)), op(flat(6.0), Some(5))]), [4, 5]);
    }

    #[test]
    fn numbers_of_a_library_count_where_tools_are_changed() {
        let of_library = |name: &str, cutter, number| {
            let mut operation = operation("a", cutter, None);
            (operation.setup.tool, operation.setup.number) = (name.into(), Some(number));
            operation
        };
        let both = || job([of_library("f", flat(6.0), 9), of_library("b", ball(3.0), 8)]);
        let numbers = |split, change| -> Vec<Option<u32>> {
            let division = divided(&both(), split, change).unwrap();
            division.runs.iter().map(|run| run.number).collect()
        };
        assert_eq!(numbers(Split::Auto, None), [Some(9), Some(8)]);
        assert_eq!(numbers(Split::ByTool, None), [None, None]);
        assert_eq!(numbers(Split::ByTool, Some(ToolChange::Manual)), [Some(9), Some(8)]);
        // Equal shapes of two names are two tools.
        let twice = job([of_library("f", flat(6.0), 9), of_library("g", flat(6.0), 9)]);
        assert_eq!(
            divided(&twice, Split::One, None).unwrap_err(),
            "operations \"a\" and \"a\" both call for tool 9, which cannot be f: flat, diameter 6 mm and \
             g: flat, diameter 6 mm: give one of them another tool number"
        );
    }

    #[test]
    fn one_number_is_not_two_tools() {
        let two = job([operation("a", flat(6.0), Some(3)), operation("b", ball(3.0), Some(3))]);
        assert_eq!(
            divided(&two, Split::Auto, None).unwrap_err(),
            "operations \"a\" and \"b\" both call for tool 3, which cannot be flat, diameter 6 mm and \
             ball, diameter 3 mm: give one of them another tool number"
        );
    }

    #[test]
    fn auto_divides_where_tools_cannot_be_changed() {
        let is_one = |split, change| divided(&two(), split, change).unwrap().is_one;
        for change in [None, Some(ToolChange::Manual), Some(ToolChange::Automatic)] {
            assert!(is_one(Split::Auto, change) && is_one(Split::One, change));
            assert!(!is_one(Split::ByTool, change));
        }
        assert!(!is_one(Split::Auto, Some(ToolChange::None)));
        assert_eq!(
            divided(&two(), Split::One, Some(ToolChange::None)).unwrap_err(),
            "2 tools cannot be in one program: machine \"mill\" changes no tools (set split to by_tool for \
             a program each)"
        );
    }

    #[test]
    fn a_controller_that_cannot_be_told_gets_a_program_for_each_tool() {
        let divided = |job: &Job, split| {
            let steps: Vec<Step<'_>> = job.steps().collect();
            let none = Machine::default();
            let changer = Changer { dialect: "grbl", can_say: false, machine: &none };
            Division::new(&steps, split, &changer).map_err(|fault| fault.to_string())
        };
        let division = divided(&two(), Split::Auto).unwrap();
        assert!(!division.is_one && division.runs.iter().all(|run| run.number.is_none()));
        assert_eq!(
            divided(&two(), Split::One).unwrap_err(),
            "2 tools cannot be in one program: grbl has no tool change (set split to by_tool for a program \
             each)"
        );
        let asked = job([operation("a", flat(6.0), Some(3)), operation("b", ball(3.0), None)]);
        assert_eq!(
            divided(&asked, Split::Auto).unwrap_err(),
            "operation \"a\" asks for tool 3, but grbl has no tool change: set its tool to 0 and put it in \
             by hand"
        );
    }

    #[test]
    fn what_a_change_depends_on_is_warned_of() {
        let two = two();
        let steps: Vec<Step<'_>> = two.steps().collect();
        let warned = |change| {
            let machine = Machine { tool_change: change, ..Machine::default() };
            let changer = Changer { dialect: "iso", can_say: true, machine: &machine };
            Division::new(&steps, Split::Auto, &changer).unwrap().warnings(&steps, &machine)
        };
        let order = "by their order the program calls flat, diameter 6 mm tool 1 and ball, diameter 3 mm \
                     tool 2: put them there or set tool";
        assert_eq!(warned(Some(ToolChange::Automatic)), [order]);
        assert_eq!(warned(None).len(), 2);
        assert!(warned(None)[0].starts_with("nothing is known of the machine's tool change"));
        assert!(warned(Some(ToolChange::None)).is_empty());
    }
}

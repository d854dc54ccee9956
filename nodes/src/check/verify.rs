//! Whether a program may be run: what its text makes the machine do, held against the part, the stock, the
//! machine and the path that was meant.
//!
//! The program itself passes through here, so that what is saved has been verified.

use super::follow::{Departure, follows};
use super::simulate::Simulated;
use crate::job::Job;
use crate::machining::{Machining, ToolRun};
use crate::shop::{Demands, Setup};
use crate::values::Gcode;
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Bounds, DVec3, Deviation, Extent, Motion, Toolpath};
use serde::{Deserialize, Serialize};

/// Faults that a message names; a program with more is as wrong with these.
const NAMED: usize = 12;

/// Holds a program against all that is known, and lets it pass only if nothing is wrong: its text (feeds,
/// spindle, units, arcs, its end), rapids through stock, gouges, what it leaves, the machine's travel, and
/// the path that it was made of.
#[derive(Clone, Debug, Params)]
pub(crate) struct Verify {
    /// How deep it may cut into the part, along the normal.
    #[param(unit = "mm", default = 0.1, range = 0.0..=1000.0)]
    pub(crate) gouge: f64,
    /// How much it may leave on the part, along the normal. What no cutter reaches counts too: give it where
    /// all of the part can be reached.
    #[param(unit = "mm", default = 1000.0, range = 0.0..=1000.0)]
    pub(crate) excess: f64,
    /// How far it may be from the path that was meant: rounding, and chords where arcs cannot be written.
    #[param(unit = "mm", default = 0.02, range = 0.0001..=10.0)]
    pub(crate) departure: f64,
    /// What comes of a fault.
    #[param(default = OnFault::Fail)]
    pub(crate) on_fault: OnFault,
}

/// What comes of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum OnFault {
    /// The program does not pass, and is not saved.
    Fail,
    /// It passes with a warning.
    Warn,
}

/// What was verified of a program, and what is wrong with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Verification {
    /// What was looked at, in words; nothing in a language that is not known.
    pub looked_at: Vec<String>,
    /// What is wrong, in words.
    pub faults: Vec<String>,
    /// How far the program is from the path that was meant, in mm, if it follows it.
    pub departure_mm: Option<f64>,
}

#[derive(Inputs)]
pub(crate) struct Held<'a> {
    /// The program.
    program: &'a Gcode,
    /// What the machine does when it runs it.
    machining: &'a Machining,
    /// What was found by simulating it.
    simulation: Option<&'a Simulated>,
    /// How far what it leaves lies from the part.
    deviation: Option<&'a Deviation>,
    /// The path that the program was made of.
    toolpath: Option<&'a Toolpath>,
    /// Operations that go before the path.
    before: Option<&'a Job>,
    /// The machine.
    setup: Option<&'a Setup>,
}

#[derive(Outputs)]
pub(crate) struct Passed {
    /// The program, if it passes.
    program: Gcode,
    /// What was verified.
    verification: Verification,
}

impl Node for Verify {
    const KIND: &'static str = "verify";
    type Inputs<'a> = Held<'a>;
    type Outputs = Passed;

    fn run(&self, inputs: Held<'_>, cx: &Context<'_>) -> Result<Passed, NodeError> {
        let mut findings = Findings::new(&inputs);
        if !inputs.machining.readable {
            cx.warn("the language of the program is not known: nothing of it was verified");
            let verification = findings.verification;
            return Ok(Passed { program: inputs.program.clone(), verification });
        }
        findings.text();
        findings.machine();
        findings.rapids();
        findings.surface(self.gouge, self.excess);
        findings.path(self.departure);
        let verification = findings.verification;
        if verification.faults.is_empty() {
            return Ok(Passed { program: inputs.program.clone(), verification });
        }
        let told = told(&verification.faults);
        match self.on_fault {
            OnFault::Fail => Err(NodeError::Failed(format!(
                "the program must not be run: {told} (set on_fault to warn if you know better)"
            ))),
            OnFault::Warn => {
                cx.warn(format!("the program may be wrong: {told}"));
                Ok(Passed { program: inputs.program.clone(), verification })
            }
        }
    }
}

/// The first faults, and how many there are besides.
fn told(faults: &[String]) -> String {
    let named = faults.iter().take(NAMED).cloned().collect::<Vec<_>>().join("; ");
    match faults.len().saturating_sub(NAMED) {
        0 => named,
        more => format!("{named}; and {more} more"),
    }
}

/// What was found so far.
struct Findings<'a> {
    held: &'a Held<'a>,
    verification: Verification,
}

impl<'a> Findings<'a> {
    fn new(held: &'a Held<'a>) -> Self {
        let verification =
            Verification { looked_at: Vec::new(), faults: Vec::new(), departure_mm: None };
        Self { held, verification }
    }

    fn look_at(&mut self, what: impl Into<String>) {
        self.verification.looked_at.push(what.into());
    }

    fn fault(&mut self, text: String) {
        self.verification.faults.push(text);
    }

    /// "line 12", with the program's name where there are several.
    fn line(&self, program: usize, line: u32) -> String {
        match &self.held.program.programs[..] {
            [_, _, ..] => {
                let name = self.held.program.programs.get(program).map_or("", |p| &p.name);
                format!("{name}, line {line}")
            }
            _ => format!("line {line}"),
        }
    }

    /// The line of a move, by the number of its run and its own.
    fn line_of(&self, run: usize, index: usize) -> String {
        let run: &ToolRun = &self.held.machining.runs[run];
        self.line(run.program, run.lines.get(index).copied().unwrap_or_default())
    }

    /// The line of a move, by its number among those of all runs.
    fn line_of_number(&self, number: usize) -> String {
        let mut left = number;
        for (run, tool) in self.held.machining.runs.iter().enumerate() {
            match left.checked_sub(tool.lines.len()) {
                Some(rest) => left = rest,
                None => return self.line_of(run, left),
            }
        }
        "its end".to_owned()
    }

    fn text(&mut self) {
        let Machining { faults, runs, .. } = self.held.machining;
        self.look_at("text: feeds, spindle, units, arcs, end");
        for fault in faults {
            let line = self.line(fault.program, fault.line);
            self.fault(format!("{line}: {}", fault.text));
        }
        let cuts = runs.iter().any(|run| !run.motion.moves.is_empty());
        if !cuts {
            self.fault("it does not move".to_owned());
        }
    }

    fn machine(&mut self) {
        let Some(setup) = self.held.setup.filter(|setup| !setup.machine.is_none()) else { return };
        let zero = self.held.program.zero.unwrap_or_default();
        let Bounds { min, max } = self.held.machining.bounds();
        let violations = setup.machine.too_far(&Demands::reaching(min - zero, max - zero));
        self.look_at(format!("travel of {}", setup.machine.name));
        for violation in violations {
            self.fault(violation.message);
        }
    }

    fn rapids(&mut self) {
        let Some(simulation) = self.held.simulation else { return };
        self.look_at("rapids through stock");
        for rapid in &simulation.rapids {
            let (line, DVec3 { x, y, z }) = (self.line_of(rapid.run, rapid.index), rapid.at);
            let depth_mm = rapid.depth_mm;
            self.fault(format!(
                "{line}: a rapid goes through {depth_mm:.3} mm of stock at X {x:.2} Y {y:.2} Z {z:.2} of the part"
            ));
        }
    }

    fn surface(&mut self, gouge_mm: f64, excess_mm: f64) {
        let counts = |deviation: &&Deviation| deviation.extent.nodes > 0;
        let Some(Deviation { extent, .. }) = self.held.deviation.filter(counts) else { return };
        let Extent { max_gouge_mm, gouge_at, max_excess_mm, excess_at, .. } = *extent;
        let at = |DVec3 { x, y, .. }: DVec3| format!("at X {x:.2} Y {y:.2} of the part");
        self.look_at(format!(
            "surface: {max_gouge_mm:.3} mm too deep at most, {max_excess_mm:.3} mm left at most"
        ));
        if max_gouge_mm > gouge_mm {
            let at = at(gouge_at);
            self.fault(format!(
                "it gouges the part by {max_gouge_mm:.3} mm {at}; gouge allows {gouge_mm}"
            ));
        }
        if max_excess_mm > excess_mm {
            let at = at(excess_at);
            self.fault(format!("it leaves {max_excess_mm:.3} mm {at}; excess allows {excess_mm}"));
        }
    }

    fn path(&mut self, tolerance_mm: f64) {
        let Some(path) = self.held.toolpath else { return };
        let before = self.held.before.into_iter().flat_map(Job::steps).map(|step| step.toolpath);
        let meant: Vec<Motion> = before.chain([path]).filter_map(Toolpath::motion).collect();
        let read = self.held.machining.runs.iter().map(|run| &run.motion);
        match follows(meant.iter(), read, tolerance_mm) {
            Ok(departure_mm) => {
                self.verification.departure_mm = Some(departure_mm);
                self.look_at(format!("path: followed within {departure_mm:.4} mm"));
            }
            Err(Departure { number, by_mm: Some(by_mm) }) => {
                let line = self.line_of_number(number);
                self.fault(format!("{line}: it leaves the path that was meant by {by_mm:.3} mm"));
            }
            Err(Departure { number, by_mm: None }) => {
                let line = self.line_of_number(number);
                self.fault(format!("{line}: from here on cuts are missing, or there are too many"));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::read::read_programs;
    use crate::job::testing::{ball, path};
    use crate::shop::{Machine, Travel};
    use crate::testing::run;

    const NODE: Verify =
        Verify { gouge: 0.1, excess: 1000.0, departure: 0.02, on_fault: OnFault::Fail };

    /// What a post makes of `path(1.0)`.
    const GOOD: &str = "G21 G90\nM3 S9000\nG0 Z5\nX0 Y0\nG1 Z-1 F300\nX10 F1000\nG0 Z5\nM5\nM30\n";

    fn verified(text: &str, node: &Verify, setup: Option<&Setup>) -> Result<Verification, String> {
        let code = Gcode::single(text.as_bytes().to_vec(), "grbl".into(), "nc".into());
        let code = Gcode { zero: Some(DVec3::ZERO), ..code };
        let machining = read_programs(&code, DVec3::ZERO, &ball(6.0), &[], &|| true).unwrap();
        let path = path(1.0);
        let held = Held {
            program: &code,
            machining: &machining,
            simulation: None,
            deviation: None,
            toolpath: Some(&path),
            before: None,
            setup,
        };
        let passed = run(|cx| node.run(held, cx)).map_err(|fault| fault.to_string())?;
        assert_eq!(passed.program, code);
        Ok(passed.verification)
    }

    #[track_caller]
    fn refused(text: &str, why: &str) {
        let fault = verified(text, &NODE, None).unwrap_err();
        assert!(fault.contains(why), "{fault}");
    }

    #[test]
    fn the_program_that_was_meant_passes() {
        let verification = verified(GOOD, &NODE, None).unwrap();
        assert_eq!(verification.faults, [""; 0]);
        assert_eq!(verification.departure_mm, Some(0.0));
    }

    #[test]
    fn a_changed_word_is_found_with_its_line() {
        refused(
            &GOOD.replace("Z-1", "Z-1.05"),
            "line 5: it leaves the path that was meant by 0.05",
        );
        // The way down is right as far as it goes.
        refused(&GOOD.replace("Z-1", "Z1"), "line 6: it leaves the path that was meant");
        refused(&GOOD.replace("X10", "X-10"), "line 6: it leaves the path that was meant by 10.");
        refused(&GOOD.replace("X10 F1000\n", ""), "leaves the path that was meant");
        refused(&GOOD.replace("M3 S9000\n", ""), "line 4: it cuts with the spindle standing still");
        refused(&GOOD.replace("M5\nM30\n", ""), "without an end");
        refused(&GOOD.replace("G1 Z-1 F300\nX10 F1000\n", ""), "cuts are missing");
        refused(&GOOD.replace("X10", "G20 X10"), "line 6: it changes between");
        refused("G21\nM3\nM30\n", "it does not move");
    }

    #[test]
    fn a_machine_that_is_too_small_is_found_by_what_the_text_says() {
        let travel = Some(Travel::Length(8.0));
        let machine = Machine { name: "tiny".into(), travel: [travel; 3], ..Machine::default() };
        let setup = Setup { machine, ..Setup::default() };
        let fault = verified(GOOD, &NODE, Some(&setup)).unwrap_err();
        assert!(fault.contains("X needs 10 mm and the machine travels 8 mm"), "{fault}");
        assert!(!fault.contains("Y needs"), "{fault}");
    }

    #[test]
    fn who_knows_better_is_warned_only() {
        let node = Verify { on_fault: OnFault::Warn, ..NODE };
        let verification = verified(&GOOD.replace("Z-1", "Z-2"), &node, None).unwrap();
        assert_eq!(verification.faults.len(), 1);
        assert_eq!(verification.departure_mm, None);
    }

    #[test]
    fn many_faults_are_named_up_to_a_dozen() {
        let faults: Vec<String> = (0..20).map(|k| k.to_string()).collect();
        assert!(told(&faults).ends_with("11; and 8 more"));
        assert_eq!(told(&faults[..2]), "0; 1");
    }
}

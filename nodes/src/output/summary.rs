//! What was made, in words.

use crate::check::{Estimate, Simulated, Verification};
use crate::job::{Job, described};
use crate::shop::{NONE, Setup};
use crate::values::{Gcode, ProgramText, Remark, ToolUse};
use carvegraph_core::{Context, Inputs, Node, NodeError, OutputName, Params};
use carvegraph_geometry::{
    Bounds, Cutter, Deviation, Extent, HeightField, Load, Reduction, SpanKind, Toolpath,
};
use std::io::Write;

/// Writes down what was made: sizes, cutter, path, program, and what to know before running it.
#[derive(Clone, Debug, Params)]
pub(crate) struct Summary {
    /// The file's name without its extension; {prefix} stands for the input's name.
    #[param(default = "{prefix}")]
    pub(crate) name: OutputName,
}

#[derive(Inputs)]
pub(crate) struct Made<'a> {
    /// The surface.
    surface: Option<&'a HeightField>,
    /// The box that holds the part.
    part: Option<&'a Bounds>,
    /// The cutter.
    cutter: Option<&'a Cutter>,
    /// The machine, the tool and the material.
    setup: Option<&'a Setup>,
    /// What the cutter was dropped on, and why.
    choice: Option<&'a Remark>,
    /// What taking points out did.
    reduction: Option<&'a Reduction>,
    /// Operations that go before the path.
    before: Option<&'a Job>,
    /// The path with all its moves.
    toolpath: Option<&'a Toolpath>,
    /// The program, or one for each tool.
    program: Option<&'a Gcode>,
    /// What was found by simulating it.
    simulation: Option<&'a Simulated>,
    /// How far what it leaves lies from the part.
    deviation: Option<&'a Deviation>,
    /// What was verified of it.
    verification: Option<&'a Verification>,
    /// How long the machine takes for all of it.
    estimate: Option<&'a Estimate>,
}

impl Node for Summary {
    const KIND: &'static str = "summary";
    const USES_PREFIX: bool = true;
    type Inputs<'a> = Made<'a>;
    type Outputs = ();

    fn run(&self, inputs: Made<'_>, cx: &Context<'_>) -> Result<(), NodeError> {
        let mut file = cx.create(&self.name, "txt")?;
        let text = summary(cx.prefix(), &inputs);
        file.write_all(text.as_bytes()).map_err(|fault| file.error(fault))?;
        file.finish()?;
        Ok(())
    }
}

fn summary(title: &str, made: &Made<'_>) -> String {
    let mut lines = vec![(String::new(), title.to_owned())];
    let mut say = |what: &str, text: String| lines.push((what.to_owned(), text));
    if let Some(field) = made.surface {
        let (columns, rows, pitch) = (field.columns(), field.rows(), field.pitch_mm());
        say("surface", format!("{columns} x {rows} points, {pitch:.4} mm apart"));
    }
    if let Some(part) = made.part {
        let (size, low, high) = (part.size(), part.min.z, part.max.z);
        say("part", format!("{:.3} x {:.3} mm, Z {low:.3} to {high:.3} mm", size.x, size.y));
    }
    if let Some(cutter) = made.cutter {
        say("cutter", described(cutter));
    }
    if let Some(setup) = made.setup {
        describe_setup(setup, &mut say);
    }
    if let Some(choice) = made.choice {
        say("drop", choice.text.clone());
    }
    if let Some(reduction) = made.reduction {
        say("reduction", describe_reduction(reduction));
    }
    if let Some(job) = made.before {
        describe_job(job, made.estimate.is_none(), &mut say);
    }
    if let Some(path) = made.toolpath {
        describe_path(path, made, &mut say);
    }
    if let Some(estimate) = made.estimate {
        describe_estimate(estimate, &mut say);
    }
    if let Some(program) = made.program {
        describe_program(program, &mut say);
    }
    describe_inspection(made, &mut say);
    let line = |(what, text): (String, String)| match what.as_str() {
        "" => format!("{text}\n"),
        _ => format!("{what:<11}{text}\n"),
    };
    lines.into_iter().map(line).collect()
}

/// The setup: nothing of it where nothing is chosen.
fn describe_setup(setup: &Setup, say: &mut impl FnMut(&str, String)) {
    let machine = &setup.machine;
    if setup.tool != NONE {
        let number = setup.number.map(|number| format!(", number {number}")).unwrap_or_default();
        say("tool", format!("{}{number}", setup.tool));
    }
    if setup.material != NONE {
        say("material", setup.material.clone());
    }
    if !machine.is_none() {
        say("machine", format!("{}: {}", machine.name, machine.about));
    }
    if machine.spindle_by_hand() {
        say("spindle", "set its speed by hand, to what the program says".to_owned());
    }
}

fn describe_reduction(reduction: &Reduction) -> String {
    let Reduction { points_in, points_out, max_above_mm, max_below_mm, .. } = reduction;
    format!(
        "{points_in} points in, {points_out} out; the path moved at most {max_above_mm:.4} mm up, \
         {max_below_mm:.4} mm down"
    )
}

/// What goes before the path, with the time that it takes if nobody knows better.
fn describe_job(job: &Job, with_time: bool, say: &mut impl FnMut(&str, String)) {
    for operation in &job.operations {
        let path = &operation.toolpath;
        let time = path.time_at_full_speed_s().filter(|_| with_time);
        let time = time.map(|seconds| format!(", {}", hours(seconds)));
        say(
            "before",
            format!(
                "{}: {}; {} points in {} passes{}",
                operation.name,
                described(&operation.cutter),
                path.cl_points(),
                path.passes(),
                time.unwrap_or_default()
            ),
        );
    }
}

fn describe_path(path: &Toolpath, made: &Made<'_>, say: &mut impl FnMut(&str, String)) {
    say("path", format!("{} points in {} passes", path.cl_points(), path.passes()));
    let fed = path.length_mm(|kind| kind != SpanKind::Rapid) / 1000.0;
    let rapid = path.length_mm(|kind| kind == SpanKind::Rapid) / 1000.0;
    say("length", format!("{fed:.2} m fed, {rapid:.2} m rapid"));
    if let Some(seconds) = path.time_at_full_speed_s().filter(|_| made.estimate.is_none()) {
        let time = hours(seconds);
        say("time", format!("{time} at full speed; accelerating takes a machine longer"));
    }
    let (lowest, _) = path.heights_mm();
    if let Some(part) = made.part.filter(|_| lowest.is_finite()) {
        let depth = format!("the tip goes {:.3} mm below the top", part.max.z - lowest);
        let advice = ": in a full block, rough it out first";
        say("depth", if made.before.is_some() { depth } else { depth + advice });
    }
}

/// How long the machine takes, what of that is not cutting at full speed, and how long each tool is in it.
fn describe_estimate(estimate: &Estimate, say: &mut impl FnMut(&str, String)) {
    say("time", format!("{} {}", hours(estimate.total_s()), estimate.machine));
    if let several @ [_, _, ..] = &estimate.runs[..] {
        for run in several {
            say("", format!("{:<11}{} with {}", "", hours(run.total_s()), run.cutter));
        }
    }
    let parts = [
        ("gathering and losing speed", estimate.sum(|run| run.times.accelerating_s)),
        ("waiting for lines", estimate.sum(|run| run.times.waiting_s)),
        ("changing tools", estimate.changing_s),
    ];
    let parts = parts.into_iter().filter(|(_, seconds)| *seconds >= WORTH_TELLING_S);
    let parts: Vec<_> = parts.map(|(what, s)| format!("{} {what}", hours(s))).collect();
    if !parts.is_empty() {
        say("of it", parts.join(", "));
    }
}

/// What takes less is not told apart: times are in whole minutes.
const WORTH_TELLING_S: f64 = 60.0;

fn hours(seconds: f64) -> String {
    let minutes = (seconds / 60.0).ceil() as u64;
    format!("{} h {:02} min", minutes / 60, minutes % 60)
}

/// What was seen of the program before it was saved.
fn describe_inspection(made: &Made<'_>, say: &mut impl FnMut(&str, String)) {
    if let Some(simulation) = made.simulation {
        simulation.loads.iter().filter_map(describe_load).for_each(|load| say("load", load));
    }
    if let Some(Deviation { extent, .. }) = made.deviation.filter(|it| it.extent.nodes > 0) {
        let Extent { max_gouge_mm, max_excess_mm, p99_excess_mm, .. } = extent;
        say(
            "surface",
            format!(
                "simulated: at most {max_gouge_mm:.3} mm too deep, {max_excess_mm:.3} mm left \
                 ({p99_excess_mm:.3} mm or less on 99 %)"
            ),
        );
    }
    if let Some(verification) = made.verification {
        let looked_at = verification.looked_at.join("; ");
        match &verification.faults[..] {
            [] if looked_at.is_empty() => {
                say("verified", "nothing: its language is not known".into())
            }
            [] => say("verified", looked_at),
            faults => faults.iter().for_each(|fault| say("WRONG", fault.clone())),
        }
    }
}

/// The most that a tool has to bear.
fn describe_load(load: &Load) -> Option<String> {
    let (step_down, removal) = (load.step_down?, load.removal?);
    Some(format!(
        "the cutter goes {:.2} mm deep into stock at most, and takes up to {:.2} cm3 a minute",
        step_down.depth_mm,
        removal.mm3_per_min / 1000.0
    ))
}

/// The programs, what each tool is for, and what to do between them: cutters differ in length.
fn describe_program(code: &Gcode, say: &mut impl FnMut(&str, String)) {
    let size = |lines: usize, bytes: usize| {
        format!("{lines} lines, {bytes} bytes, dialect {}", code.dialect)
    };
    if let [program] = &code.programs[..] {
        say("program", size(code.lines(), code.bytes()));
        return describe_tools(program, say);
    }
    for program in &code.programs {
        let tools = program.tools.iter().map(used).collect::<Vec<_>>().join("; ");
        let size = size(program.lines(), program.text.len());
        say("program", format!("{}: {tools}; {size}", program.name));
    }
    say(
        "between",
        "put in the next cutter and set Z anew with it, where it was set before and no program cuts; leave \
         X and Y (a machine that measures its tools sets Z itself)"
            .to_owned(),
    );
}

/// The tools of a program that changes them.
fn describe_tools(program: &ProgramText, say: &mut impl FnMut(&str, String)) {
    if program.tools.len() < 2 {
        return;
    }
    for tool in &program.tools {
        say(&format!("tool {}", tool.number.unwrap_or_default()), used(tool));
    }
    say("change", "the controller must know or measure the length of each tool".to_owned());
}

/// "ball, diameter 3 mm, for finish"
fn used(tool: &ToolUse) -> String {
    format!("{}, for {}", described(&tool.cutter), tool.operations)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::testing::{ball, flat};

    const NOTHING: Made<'_> = Made {
        surface: None,
        part: None,
        cutter: None,
        setup: None,
        choice: None,
        reduction: None,
        before: None,
        toolpath: None,
        program: None,
        simulation: None,
        deviation: None,
        verification: None,
        estimate: None,
    };

    #[test]
    fn it_tells_of_what_is_there_and_of_nothing_else() {
        assert_eq!(summary("mother", &NOTHING), "mother\n");
        let choice = Remark { text: "dropped on the mesh".into() };
        let reduction = Reduction {
            points_in: 9,
            points_out: 4,
            max_deviation_mm: 0.02,
            max_above_mm: 0.02,
            max_below_mm: 0.001,
        };
        let made = Made { choice: Some(&choice), reduction: Some(&reduction), ..NOTHING };
        assert_eq!(
            summary("mother", &made),
            "mother\n\
             drop       dropped on the mesh\n\
             reduction  9 points in, 4 out; the path moved at most 0.0200 mm up, 0.0010 mm down\n"
        );
    }

    #[test]
    fn the_setup_is_named_where_there_is_one() {
        let nothing = Setup::default();
        assert_eq!(summary("mother", &Made { setup: Some(&nothing), ..NOTHING }), "mother\n");
        let mut setup = Setup { tool: "ball_6".into(), number: Some(3), ..nothing };
        setup.material = "walnut".into();
        (setup.machine.name, setup.machine.about) = ("shed".into(), "In the shed".into());
        assert_eq!(
            summary("mother", &Made { setup: Some(&setup), ..NOTHING }),
            "mother\n\
             tool       ball_6, number 3\n\
             material   walnut\n\
             machine    shed: In the shed\n"
        );
    }

    fn program(name: &str, tools: &[(u32, &Cutter, &str)]) -> ProgramText {
        let used = |&(number, cutter, operations): &(u32, &Cutter, &str)| ToolUse {
            number: Some(number).filter(|number| *number > 0),
            cutter: cutter.clone(),
            operations: operations.into(),
        };
        let tools = tools.iter().map(used).collect();
        ProgramText { name: name.into(), tools, text: b"M5\nM30\n".to_vec() }
    }

    fn told(programs: Vec<ProgramText>) -> String {
        let (dialect, extension) = ("grbl".to_owned(), "nc".to_owned());
        let code = Gcode { programs, dialect, extension, zero: None };
        summary("mother", &Made { program: Some(&code), ..NOTHING })
    }

    #[test]
    fn several_programs_are_listed_with_their_tools_and_what_to_do_between_them() {
        let (flat, ball) = (&flat(6.0), &ball(3.0));
        let one = program("", &[(0, ball, "finish")]);
        assert_eq!(told(vec![one]), "mother\nprogram    2 lines, 7 bytes, dialect grbl\n");
        let rough = program("1-rough", &[(0, flat, "rough")]);
        let fine = program("2-finish", &[(0, ball, "semi, finish")]);
        assert_eq!(
            told(vec![rough, fine]),
            "mother\n\
             program    1-rough: flat, diameter 6 mm, for rough; 2 lines, 7 bytes, dialect grbl\n\
             program    2-finish: ball, diameter 3 mm, for semi, finish; 2 lines, 7 bytes, dialect grbl\n\
             between    put in the next cutter and set Z anew with it, where it was set before and no \
             program cuts; leave X and Y (a machine that measures its tools sets Z itself)\n"
        );
        let both = program("", &[(4, flat, "rough"), (1, ball, "finish")]);
        assert_eq!(
            told(vec![both]),
            "mother\n\
             program    2 lines, 7 bytes, dialect grbl\n\
             tool 4     flat, diameter 6 mm, for rough\n\
             tool 1     ball, diameter 3 mm, for finish\n\
             change     the controller must know or measure the length of each tool\n"
        );
    }

    #[test]
    fn what_goes_before_is_told_and_takes_the_place_of_the_advice_to_rough() {
        use crate::job::testing::{flat, job, operation, path};
        use carvegraph_geometry::DVec3;
        let path = path(1.0);
        let part = Bounds { min: DVec3::splat(-2.0), max: DVec3::ZERO };
        let alone = Made { part: Some(&part), toolpath: Some(&path), ..NOTHING };
        let advice = "the tip goes 1.000 mm below the top: in a full block, rough it out first\n";
        assert!(summary("mother", &alone).ends_with(advice));
        let rough = job([operation("rough", flat(6.0), None)]);
        let told = summary("mother", &Made { before: Some(&rough), ..alone });
        let line = "before     rough: flat, diameter 6 mm; 2 points in 1 passes, 0 h 01 min\n";
        assert!(told.contains(line), "{told}");
        assert!(told.ends_with("the tip goes 1.000 mm below the top\n"), "{told}");
    }

    #[test]
    fn the_machines_time_takes_the_place_of_that_at_full_speed() {
        use crate::check::RunTimes;
        use crate::job::testing::path;
        use carvegraph_geometry::Times;
        let path = path(1.0);
        let run = |cutter: &str, cutting_s, accelerating_s| {
            let times = Times { cutting_s, accelerating_s, rapid_s: 30.0, ..Times::default() };
            RunTimes { cutter: cutter.into(), times, dwell_s: 0.0 }
        };
        let machine = "on shed".to_owned();
        let one = Estimate { runs: vec![run("ball", 2400.0, 650.0)], changing_s: 0.0, machine };
        let told = |estimate: &Estimate| {
            let made = Made { toolpath: Some(&path), estimate: Some(estimate), ..NOTHING };
            let told = summary("mother", &made);
            assert!(!told.contains("full speed"), "{told}");
            told[told.find("time").unwrap()..].to_owned()
        };
        assert_eq!(
            told(&one),
            "time       0 h 41 min on shed\n\
             of it      0 h 11 min gathering and losing speed\n"
        );
        let runs = vec![run("flat", 600.0, 10.0), run("ball", 2400.0, 10.0)];
        let two = Estimate { runs, changing_s: 60.0, ..one };
        assert_eq!(
            told(&two),
            "time       0 h 52 min on shed\n           \
             0 h 11 min with flat\n           \
             0 h 41 min with ball\n\
             of it      0 h 01 min changing tools\n"
        );
    }
}

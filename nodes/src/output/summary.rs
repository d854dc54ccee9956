//! What was made, in words.

use crate::shop::{NONE, Setup};
use crate::values::{Gcode, Remark};
use carvegraph_core::{Context, Inputs, Node, NodeError, OutputName, Params};
use carvegraph_geometry::{Bounds, Cutter, HeightField, Reduction, SpanKind, Toolpath};
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
    /// The path with all its moves.
    toolpath: Option<&'a Toolpath>,
    /// The program.
    program: Option<&'a Gcode>,
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
        let diameter = 2.0 * cutter.profile.radius_mm();
        say("cutter", format!("{}, diameter {diameter} mm", cutter.name));
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
    if let Some(path) = made.toolpath {
        describe_path(path, made.part, &mut say);
    }
    if let Some(program) = made.program {
        let (lines, bytes) = (program.lines(), program.text.len());
        say("program", format!("{lines} lines, {bytes} bytes, dialect {}", program.dialect));
    }
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

fn describe_path(path: &Toolpath, part: Option<&Bounds>, say: &mut impl FnMut(&str, String)) {
    say("path", format!("{} points in {} passes", path.cl_points(), path.passes()));
    let fed = path.length_mm(|kind| kind != SpanKind::Rapid) / 1000.0;
    let rapid = path.length_mm(|kind| kind == SpanKind::Rapid) / 1000.0;
    say("length", format!("{fed:.2} m fed, {rapid:.2} m rapid"));
    if let Some(seconds) = path.time_at_full_speed_s() {
        let minutes = (seconds / 60.0).ceil() as u64;
        let time = format!("{} h {:02} min", minutes / 60, minutes % 60);
        say("time", format!("{time} at full speed; accelerating takes a machine longer"));
    }
    let lowest = path.tips.iter().map(|tip| tip.z).fold(f64::INFINITY, f64::min);
    if let Some(part) = part.filter(|_| lowest.is_finite()) {
        let depth = part.max.z - lowest;
        say(
            "depth",
            format!(
                "the tip goes {depth:.3} mm below the top: in a full block, rough it out first"
            ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOTHING: Made<'_> = Made {
        surface: None,
        part: None,
        cutter: None,
        setup: None,
        choice: None,
        reduction: None,
        toolpath: None,
        program: None,
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
}

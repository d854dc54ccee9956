//! The text of a program becomes moves again, as its controller would make them.

use super::read::read_programs;
use crate::machining::Machining;
use crate::values::Gcode;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::Cutter;

/// Reads a written program back, word for word, so that what is simulated, timed and verified is what the
/// machine will see. It reads word addresses (RS-274), Heidenhain's language and OpenSBP.
#[derive(Clone, Debug, Params)]
pub(crate) struct ReadGcode {
    /// Words that change nothing and need not be understood, blanks between them: "M64 M65".
    #[param(default = "")]
    pub(crate) ignore: String,
}

#[derive(Inputs)]
pub(crate) struct Written<'a> {
    /// The program, or one for each tool.
    program: &'a Gcode,
    /// The cutter that is in the spindle where the program does not know its tools.
    cutter: &'a Cutter,
}

#[derive(Outputs)]
pub(crate) struct Heard {
    /// What the machine does.
    machining: Machining,
}

impl Node for ReadGcode {
    const KIND: &'static str = "read_gcode";
    type Inputs<'a> = Written<'a>;
    type Outputs = Heard;

    fn run(&self, inputs: Written<'_>, cx: &Context<'_>) -> Result<Heard, NodeError> {
        let Written { program, cutter } = inputs;
        let zero = program.zero.ok_or_else(|| {
            NodeError::failed(
                "it is not known where the zero of this program lies: read the one that post or \
                 load_gcode gives, not what a plugin made of it",
            )
        })?;
        let ignored: Vec<String> = self.ignore.split_whitespace().map(str::to_owned).collect();
        let go_on = || !cx.is_cancelled();
        let machining = cx.completed(read_programs(program, zero, cutter, &ignored, &go_on))?;
        Ok(Heard { machining })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::testing::ball;
    use crate::testing::run;
    use carvegraph_geometry::DVec3;

    fn heard(text: &str, zero: Option<DVec3>, ignore: &str) -> Result<Machining, NodeError> {
        let code = Gcode::single(text.as_bytes().to_vec(), "grbl".into(), "nc".into());
        let code = Gcode { zero, ..code };
        let (node, cutter) = (ReadGcode { ignore: ignore.to_owned() }, ball(6.0));
        run(|cx| node.run(Written { program: &code, cutter: &cutter }, cx))
            .map(|heard| heard.machining)
    }

    const PROGRAM: &str =
        "G21 G90\nM3 S9000\nG0 Z5\nX1 Y2\nG1 Z-1 F300\nX4 F900\nM64\nG0 Z5\nM30\n";

    #[test]
    fn moves_are_in_the_frame_of_the_part() {
        let read = heard(PROGRAM, Some(DVec3::new(10.0, 20.0, 30.0)), "M64").unwrap();
        let tips: Vec<DVec3> = read.legs().map(|(_, moved)| moved.to).collect();
        let at = |x, z| DVec3::new(10.0 + x, 22.0, 30.0 + z);
        assert_eq!(tips, [at(1.0, -1.0), at(4.0, -1.0), at(4.0, 5.0)]);
        assert_eq!(read.runs[0].lines, [5, 6, 8]);
        assert_eq!(read.faults, []);
    }

    #[test]
    fn words_are_ignored_only_if_that_is_asked_for() {
        let read = heard(PROGRAM, Some(DVec3::ZERO), "").unwrap();
        let told: Vec<(u32, &str)> =
            read.faults.iter().map(|f| (f.line, f.text.as_str())).collect();
        assert_eq!(told, [(7, "M64 is not known")]);
    }

    #[test]
    fn a_program_without_a_known_zero_is_not_read() {
        let fault = heard(PROGRAM, None, "").unwrap_err().to_string();
        assert!(fault.contains("where the zero of this program lies"), "{fault}");
    }
}

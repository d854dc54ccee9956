//! A program saved to a file, or several to one each.

use crate::values::Gcode;
use carvegraph_core::{Context, Inputs, Node, NodeError, OutputName, Params};
use std::io::Write;

/// Saves a program under the extension that its controller wants. Where there is one for each tool, their
/// files are numbered in the order in which they are to be run, and all are saved or none.
#[derive(Clone, Debug, Params)]
pub(crate) struct SaveGcode {
    /// The file's name without its extension; {prefix} stands for the input's name.
    #[param(default = "{prefix}")]
    pub(crate) name: OutputName,
}

#[derive(Inputs)]
pub(crate) struct Program<'a> {
    /// The program.
    program: &'a Gcode,
}

impl Node for SaveGcode {
    const KIND: &'static str = "save_gcode";
    type Inputs<'a> = Program<'a>;
    type Outputs = ();

    fn run(&self, inputs: Program<'_>, cx: &Context<'_>) -> Result<(), NodeError> {
        let Gcode { programs, extension, .. } = inputs.program;
        for program in programs {
            let mut file = cx.create(&self.name_of(&program.name)?, extension)?;
            file.write_all(&program.text).map_err(|fault| file.error(fault))?;
            file.finish()?;
        }
        Ok(())
    }
}

impl SaveGcode {
    /// The name of the file of the program called `name`.
    fn name_of(&self, name: &str) -> Result<OutputName, NodeError> {
        match name {
            "" => Ok(self.name.clone()),
            name => {
                let pattern = format!("{}-{name}", self.name.pattern());
                OutputName::new(&pattern).map_err(NodeError::failed)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_apart_by_the_names_of_their_programs() {
        let node = SaveGcode { name: OutputName::new("{prefix}").unwrap() };
        let pattern = |name: &str| node.name_of(name).unwrap().pattern().to_owned();
        assert_eq!(
            (pattern("").as_str(), pattern("2-fine").as_str()),
            ("{prefix}", "{prefix}-2-fine")
        );
        assert!(
            node.name_of(&"a".repeat(200)).unwrap_err().to_string().contains("is no file name")
        );
    }
}

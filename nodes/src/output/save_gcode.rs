//! A program saved to a file.

use crate::values::Gcode;
use carvegraph_core::{Context, Inputs, Node, NodeError, OutputName, Params};
use std::io::Write;

/// Saves a program under the extension that its controller wants.
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
        let mut file = cx.create(&self.name, &inputs.program.extension)?;
        file.write_all(&inputs.program.text).map_err(|fault| file.error(fault))?;
        file.finish()?;
        Ok(())
    }
}

//! A program from a file, whoever wrote it.

use crate::output::zero::Zero;
use crate::values::{Gcode, ProgramText, ToolUse};
use carvegraph_core::{Context, InputFile, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Bounds, Cutter};

/// The largest program, in bytes: some ten million lines.
const MAX_BYTES: usize = 512 << 20;

/// Loads a program to look at it: edited by hand, written by another program, or found on an old disk.
/// Where its zero lies on the part is not written in it and must be said.
#[derive(Clone, Debug, Params)]
pub(crate) struct LoadGcode {
    /// The program's file.
    #[param()]
    pub(crate) path: InputFile,
    #[param(shared)]
    pub(crate) zero: Zero,
    /// The dialect that it is written in, which says in what unit it waits.
    #[param(catalog = "dialect", default = "grbl")]
    pub(crate) dialect: String,
}

#[derive(Inputs)]
pub(crate) struct Meant<'a> {
    /// The box that holds the part.
    part: &'a Bounds,
    /// The cutter that it is run with.
    cutter: &'a Cutter,
}

#[derive(Outputs)]
pub(crate) struct Loaded {
    /// The program.
    program: Gcode,
}

impl Node for LoadGcode {
    const KIND: &'static str = "load_gcode";
    type Inputs<'a> = Meant<'a>;
    type Outputs = Loaded;

    fn run(&self, inputs: Meant<'_>, cx: &Context<'_>) -> Result<Loaded, NodeError> {
        let text = cx.read(&self.path)?;
        if text.len() > MAX_BYTES {
            return Err(NodeError::Failed(format!(
                "{} holds {} bytes; a program may have {MAX_BYTES}",
                self.path,
                text.len()
            )));
        }
        if text.contains(&0) {
            return Err(NodeError::Failed(format!(
                "{} is no text, so it is no program",
                self.path
            )));
        }
        let extension = self.path.path().extension().map(|e| e.to_string_lossy().into_owned());
        let tool = ToolUse {
            number: None,
            cutter: inputs.cutter.clone(),
            operations: "the program".to_owned(),
        };
        let program =
            ProgramText { name: String::new(), tools: vec![tool], text: text.into_owned() };
        Ok(Loaded {
            program: Gcode {
                programs: vec![program],
                dialect: self.dialect.clone(),
                extension: extension.unwrap_or_else(|| "nc".to_owned()),
                zero: Some(self.zero.of(inputs.part)),
            },
        })
    }
}

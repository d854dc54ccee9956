//! An operation: a path with the cutter that cuts it, to go before others in a program.
//!
//! `post` makes the last operation of its own path, so that a job with one tool needs none of these.

use crate::job::{Drive, Job, Operation, Step, check_name};
use crate::shop::Setup;
use carvegraph_core::{Conflict, Context, Inputs, Node, NodeError, Outputs, Params, Yielding};
use carvegraph_geometry::{Cutter, Toolpath};
use std::sync::Arc;

/// Makes an operation of a path and a cutter, and puts it behind others. What is not set here comes from
/// the setup.
#[derive(Clone, Debug, Params)]
pub(crate) struct OperationNode {
    /// What it is called in programs and file names: letters, digits, - and _.
    #[param(default = "rough")]
    pub(crate) name: String,
    /// Speed of the spindle.
    #[param(unit = "rpm", default = 12_000.0, range = 1.0..=200_000.0)]
    pub(crate) spindle: Yielding<f64>,
    /// Number of the cutter in the controller's tool table; 0 takes the one that is in the spindle or, in a
    /// program that changes tools, the next number that is free.
    #[param(default = 0, range = 0..=9999)]
    pub(crate) tool: Yielding<u32>,
}

#[derive(Inputs)]
pub(crate) struct Cutting<'a> {
    /// The path with all its moves and speeds.
    toolpath: &'a Toolpath,
    /// The cutter.
    cutter: &'a Cutter,
    /// The machine, the tool and the material.
    setup: Option<&'a Setup>,
    /// Operations that go before this one.
    after: Option<&'a Job>,
}

#[derive(Outputs)]
pub(crate) struct Ordered {
    /// All operations so far.
    job: Job,
}

impl Node for OperationNode {
    const KIND: &'static str = "operation";
    type Inputs<'a> = Cutting<'a>;
    type Outputs = Ordered;

    fn check(&self) -> Result<(), Conflict> {
        check_name(&self.name).map_err(|message| Conflict { param: "name", message })
    }

    fn run(&self, inputs: Cutting<'_>, _: &Context<'_>) -> Result<Ordered, NodeError> {
        let Cutting { toolpath, cutter, .. } = inputs;
        let setup = inputs.setup.cloned().unwrap_or_default();
        let drive = Drive::new(&self.tool, &self.spindle, &setup);
        let name = &self.name;
        Step { name, toolpath, cutter, setup: &setup, drive }.check_speeds()?;
        let mut operations = inputs.after.map(|job| job.operations.clone()).unwrap_or_default();
        let (name, toolpath, cutter) = (name.clone(), toolpath.clone(), cutter.clone());
        operations.push(Arc::new(Operation { name, toolpath, cutter, setup, drive }));
        Ok(Ordered { job: Job { operations } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::testing::{ball, flat, path};
    use crate::testing::run;

    fn node(name: &str) -> OperationNode {
        let (spindle, tool) = (Yielding::left(9000.0), Yielding::given(4));
        OperationNode { name: name.into(), spindle, tool }
    }

    #[test]
    fn operations_stand_in_their_order_and_share_their_paths() {
        let path = path(1.0);
        let (wide, fine) = (flat(6.0), ball(3.0));
        let inputs = Cutting { toolpath: &path, cutter: &wide, setup: None, after: None };
        let first = run(|cx| node("rough").run(inputs, cx)).unwrap().job;
        let inputs = Cutting { toolpath: &path, cutter: &fine, setup: None, after: Some(&first) };
        let both = run(|cx| node("semi").run(inputs, cx)).unwrap().job;
        let names: Vec<&str> = both.operations.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["rough", "semi"]);
        assert!(Arc::ptr_eq(&first.operations[0], &both.operations[0]));
        assert_eq!(both.operations[1].cutter, fine);
        assert_eq!(both.operations[1].drive.tool, Some(4));
    }

    #[test]
    fn a_path_without_speeds_and_a_bad_name_are_told() {
        let loose = Toolpath { feeds: None, ..path(1.0) };
        let cutter = ball(3.0);
        let inputs = Cutting { toolpath: &loose, cutter: &cutter, setup: None, after: None };
        let fault = run(|cx| node("rough").run(inputs, cx)).err().unwrap();
        assert!(fault.to_string().contains("put a link node before this one"), "{fault}");
        assert_eq!(node("a/b").check().unwrap_err().param, "name");
    }
}

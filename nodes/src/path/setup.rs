//! What a job is set up with: the machine, the tool and the material.
//!
//! It stands between the cutter and the nodes that make moves and programs of it, not in them, so that
//! each choice is made once, and apart from the cutter, so that another machine or material leaves the
//! drop cutter's work as it is.

use crate::shop::{Conditions, Machines, NONE, Setup, ToolSheet};
use carvegraph_core::diagnostic::did_you_mean;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};

/// Chooses the machine and the material. What they say is used wherever nothing else is set.
#[derive(Clone, Debug, Params)]
pub(crate) struct SetupNode {
    /// The machine that is to run the program; of none nothing is known and nothing is checked.
    #[param(catalog = "machine", default = "none")]
    pub(crate) machine: String,
    /// What is cut: a material that the tool's library has speeds for.
    #[param(default = "none")]
    pub(crate) material: String,
}

#[derive(Inputs)]
pub(crate) struct Held<'a> {
    /// The tool, if it is one of a library.
    tool: Option<&'a ToolSheet>,
}

#[derive(Outputs)]
pub(crate) struct Ready {
    /// What the job is set up with.
    setup: Setup,
}

impl Node for SetupNode {
    const KIND: &'static str = "setup";
    type Inputs<'a> = Held<'a>;
    type Outputs = Ready;

    fn run(&self, inputs: Held<'_>, cx: &Context<'_>) -> Result<Ready, NodeError> {
        let machines: &Machines = cx.service()?;
        let machine = machines
            .find(&self.machine)
            .ok_or_else(|| NodeError::failed(format!("there is no machine {:?}", self.machine)))?;
        let tool = inputs.tool.cloned().unwrap_or_default();
        let conditions = self.conditions(&tool)?;
        if self.material == NONE && !tool.materials.is_empty() {
            let (tool, there) = (&tool.tool, materials(&tool));
            cx.note(format!("no material is set, so {tool} gives no speeds; it has {there}"));
        }
        let (material, number) = (self.material.clone(), tool.number);
        Ok(Ready { setup: Setup { machine, tool: tool.tool, number, material, conditions } })
    }
}

impl SetupNode {
    fn conditions(&self, tool: &ToolSheet) -> Result<Conditions, NodeError> {
        let material = &self.material;
        if material == NONE {
            return Ok(Conditions::default());
        }
        let refused = |message: String| Err(NodeError::refused("material", message));
        if tool.tool == NONE {
            return refused(format!(
                "material {material:?} says nothing without a tool, whose library has its speeds: set \
                 tool too (carve tools), or leave material at none"
            ));
        }
        let found = tool.materials.iter().find(|(known, _)| known == material);
        if let Some((_, conditions)) = found {
            return Ok(*conditions);
        }
        let names = tool.materials.iter().map(|(name, _)| name.as_str());
        let near = did_you_mean(material, names).map(|near| format!("did you mean {near:?}? "));
        refused(format!(
            "tool {:?} knows no material {material:?}; {}it has {}",
            tool.tool,
            near.unwrap_or_default(),
            materials(tool)
        ))
    }
}

/// "pine, walnut"
fn materials(tool: &ToolSheet) -> String {
    let names: Vec<&str> = tool.materials.iter().map(|(name, _)| name.as_str()).collect();
    if names.is_empty() { NONE.to_owned() } else { names.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shop::Machine;
    use carvegraph_core::{Catalogs, with_context};

    fn run(machine: &str, material: &str, tool: Option<&ToolSheet>) -> Result<Setup, String> {
        let mill = Machine { name: "mill".into(), ..Machine::default() };
        let catalogs = Catalogs::default().with("machine", [], Machines(vec![mill]));
        let node = SetupNode { machine: machine.into(), material: material.into() };
        let ready = with_context(&catalogs, |cx| node.run(Held { tool }, cx));
        ready.map(|ready| ready.setup).map_err(|fault| fault.to_string())
    }

    fn ball() -> ToolSheet {
        let speed = |feed| Conditions { feed_mm_per_min: Some(feed), ..Conditions::default() };
        let materials = vec![("pine".to_owned(), speed(900.0)), ("oak".to_owned(), speed(700.0))];
        ToolSheet { tool: "ball".into(), number: Some(4), materials }
    }

    #[test]
    fn nothing_chosen_is_nothing_known() {
        assert_eq!(run(NONE, NONE, None), Ok(Setup::default()));
        assert_eq!(run(NONE, NONE, Some(&ToolSheet::default())), Ok(Setup::default()));
    }

    #[test]
    fn the_tool_gives_the_speeds_of_the_material() {
        let setup = run("mill", "oak", Some(&ball())).unwrap();
        assert_eq!((setup.machine.name.as_str(), setup.tool.as_str()), ("mill", "ball"));
        assert_eq!((setup.number, setup.conditions.feed_mm_per_min), (Some(4), Some(700.0)));
        assert_eq!(run("mill", NONE, Some(&ball())).unwrap().conditions, Conditions::default());
    }

    #[test]
    fn what_there_is_not_is_told_with_what_there_is() {
        assert_eq!(
            run(NONE, "pinne", Some(&ball())),
            Err("tool \"ball\" knows no material \"pinne\"; did you mean \"pine\"? it has pine, oak"
                .into())
        );
        let fault = "material \"oak\" says nothing without a tool, whose library has its speeds: set \
                     tool too (carve tools), or leave material at none";
        assert_eq!(run(NONE, "oak", None), Err(fault.into()));
        assert_eq!(run(NONE, "oak", Some(&ToolSheet::default())), Err(fault.into()));
        assert_eq!(run("lathe", NONE, None), Err("there is no machine \"lathe\"".into()));
    }
}

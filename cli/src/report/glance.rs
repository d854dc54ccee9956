//! What somebody at the machine wants to know first: read off the facts of a run, wherever a recipe has
//! them.

use super::Run;
use super::words::{clean, fact, short, time};
use carvegraph_core::graph::GraphNode;
use carvegraph_core::report::{NodeStatus, PortReport};
use serde::Serialize;
use serde_json::Value as Json;

/// A name and what it is.
pub(super) type Line = (&'static str, String);

/// Kinds of node that say whether the program may be run.
const CHECKS: [&str; 1] = ["verify"];

/// Types of value that tell how near the carved part comes to the one aimed at.
const VERDICTS: [&str; 3] = ["verification", "verdict", "deviation"];

/// What looked at the program says of it.
#[derive(Serialize)]
pub(super) struct Verdict {
    node: String,
    /// What the box looks like: good, bad, or neither for a measurement that is held against nothing.
    look: &'static str,
    text: String,
    facts: Vec<(String, String)>,
}

/// What the recipe's checks found.
pub(super) fn verdicts(run: &Run<'_>) -> Vec<Verdict> {
    let verdict = |(id, node): (&String, &carvegraph_core::NodeReport)| {
        let is_check = CHECKS.contains(&node.kind);
        let has_verdict = |port: &&PortReport| VERDICTS.contains(&&port.type_name[..]);
        let facts = || node.outputs.values().filter(has_verdict).flat_map(|port| &port.facts);
        let fails = facts().any(|(name, value)| name == "passes" && *value == Json::Bool(false));
        let facts: Vec<_> = facts().map(|(name, value)| fact(name, value)).collect();
        let (look, text) = match node.status {
            NodeStatus::Ran | NodeStatus::Cached if fails => ("bad", "did not pass".to_owned()),
            NodeStatus::Ran | NodeStatus::Cached if is_check => ("good", "passed".to_owned()),
            NodeStatus::Ran | NodeStatus::Cached => ("", "measured".to_owned()),
            NodeStatus::Failed => ("bad", node.reason.clone().unwrap_or_default()),
            NodeStatus::Skipped if node.starved => ("bad", "could not be done".to_owned()),
            NodeStatus::Skipped => return None,
        };
        let is_told = is_check || !facts.is_empty();
        is_told.then(|| Verdict { node: clean(id), look, text: clean(&text), facts })
    };
    run.report.nodes.iter().filter_map(verdict).collect()
}

/// The part, the tools, the time, the program.
pub(super) fn glance(run: &Run<'_>) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut say = |what, text: Option<String>| lines.extend(text.map(|text| (what, text)));
    say("Part", wired_to(run, "part").and_then(part));
    for line in tools(run) {
        say("Cutter", Some(line));
    }
    for (what, name) in [("Machine", "machine"), ("Tool", "tool"), ("Material", "material")] {
        let values = of_type(run, "setup").filter_map(|port| text(port, name));
        say(what, values.filter(|name| *name != "none").last().map(str::to_owned));
    }
    say("Machining time", machining_time(run));
    say("Length", length(run));
    // A program that went through its inspection is told once.
    let mut programs: Vec<String> = of_type(run, "gcode").filter_map(program).collect();
    programs.dedup();
    programs.into_iter().for_each(|program| say("Program", Some(program)));
    lines
}

/// What comes out of ports of a type, in the order of the recipe.
fn of_type<'a>(run: &'a Run<'_>, name: &'a str) -> impl Iterator<Item = &'a PortReport> {
    let nodes = run.graph.nodes.iter().filter_map(|node| run.report.nodes.get(&node.id));
    nodes.flat_map(|node| node.outputs.values()).filter(move |port| port.type_name == name)
}

/// What is wired to the first input of a name.
fn wired_to<'a>(run: &'a Run<'_>, input: &str) -> Option<&'a PortReport> {
    run.graph.nodes.iter().find_map(|node| wired(run, node, input))
}

/// What is wired to an input of a node.
fn wired<'a>(run: &'a Run<'_>, node: &GraphNode, input: &str) -> Option<&'a PortReport> {
    let mut inputs = run.graph.kind(node).inputs.iter().zip(&node.inputs);
    let (_, wire) = inputs.find(|(spec, _)| spec.name == input)?;
    let wire = (*wire)?;
    let source = &run.graph.nodes[wire.node];
    let port = run.graph.kind(source).outputs.get(wire.port)?.name;
    run.report.nodes.get(&source.id)?.outputs.get(port)
}

/// What becomes the program: the path, and the job that goes before it, if any.
fn posted<'a>(run: &'a Run<'_>) -> Option<(&'a PortReport, Option<&'a PortReport>)> {
    run.graph.nodes.iter().find_map(|node| {
        let makes_gcode = run.graph.kind(node).outputs.iter().any(|port| port.name == "program");
        let path = wired(run, node, "toolpath").filter(|_| makes_gcode)?;
        Some((path, wired(run, node, "before")))
    })
}

fn number(port: &PortReport, name: &str) -> Option<f64> {
    port.facts.get(name)?.as_f64()
}

fn text<'a>(port: &'a PortReport, name: &str) -> Option<&'a str> {
    port.facts.get(name)?.as_str()
}

/// Its size, whether it is told as one or as two corners.
fn part(port: &PortReport) -> Option<String> {
    let corner = |name| -> Option<Vec<f64>> {
        port.facts.get(name)?.as_array()?.iter().map(Json::as_f64).collect()
    };
    let (width, height, low, high) = match (corner("min_mm"), corner("max_mm")) {
        (Some(min), Some(max)) if min.len() == 3 && max.len() == 3 => {
            (max[0] - min[0], max[1] - min[1], min[2], max[2])
        }
        _ => (
            number(port, "width_mm")?,
            number(port, "height_mm")?,
            number(port, "z_min")?,
            number(port, "z_max")?,
        ),
    };
    let [width, height, low, high] = [width, height, low, high].map(short);
    Some(format!("{width} × {height} mm, Z {low} to {high} mm"))
}

fn tools(run: &Run<'_>) -> Vec<String> {
    let mut tools = Vec::new();
    for port in of_type(run, "cutter") {
        let (Some(shape), Some(diameter)) = (text(port, "shape"), number(port, "diameter_mm"))
        else {
            continue;
        };
        let tool = format!("{shape}, diameter {} mm", short(diameter));
        if !tools.contains(&tool) {
            tools.push(tool);
        }
    }
    tools
}

/// The machine's own time where somebody told it, else the path's, which is too short.
fn machining_time(run: &Run<'_>) -> Option<String> {
    let estimate = of_type(run, "estimate").last();
    let told = estimate.and_then(|port| {
        let machine = text(port, "machine").unwrap_or_default();
        Some(format!("{} {machine}", time(number(port, "time_s")?)))
    });
    told.or_else(|| {
        let (path, before) = posted(run)?;
        let before_s = before.map_or(Some(0.0), |job| number(job, "time_s"))?;
        let time = time(number(path, "time_s")? + before_s);
        Some(format!("{time} at full speed; gathering and losing speed takes a machine longer"))
    })
}

/// Of a job the estimate alone knows it.
fn length(run: &Run<'_>) -> Option<String> {
    let alone = || posted(run).filter(|(_, before)| before.is_none()).map(|(path, _)| path);
    let port = of_type(run, "estimate").last().or_else(alone)?;
    let metres = |name| Some(short(number(port, name)? / 1000.0));
    Some(format!("{} m fed, {} m rapid", metres("feed_length_mm")?, metres("rapid_length_mm")?))
}

fn program(port: &PortReport) -> Option<String> {
    let lines = number(port, "lines")?;
    let programs = number(port, "programs").filter(|count| *count > 1.0);
    let parts = programs.map(|count| format!(" in {count} programs")).unwrap_or_default();
    Some(format!("{lines} lines{parts}, dialect {}", text(port, "dialect")?))
}

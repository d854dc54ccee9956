//! Terraces: a surface in steps of equal height, like a map glued from sheets of cork.
//!
//! A height h above the lowest point becomes step · (k + e), where k is the whole part of h/step and e
//! is 0 on a terrace and climbs to 1 over the last `riser` of the step. With a riser of 0 the walls
//! are upright, and as far as the grid and the cutter allow they are carved so.

use carvegraph_sdk::export::Offers;
use carvegraph_sdk::node::{Job, Node, NodeFault, Param, ParamKind, Port};
use carvegraph_sdk::value::{HeightField, PortValue, Raw};

carvegraph_sdk::export!(Offers::new().node(Terrace));

/// More terraces than a grid of heights can show.
const MOST_TERRACES: f32 = 10_000.0;

struct Terrace;

/// What `carve nodes terrace` shows, and what a recipe may set.
const PARAMS: &[Param] = &[
    Param {
        name: "step",
        about: "Height of a step",
        kind: ParamKind::Number { unit: "mm", default: 0.5, min: 0.001, max: 1000.0 },
    },
    Param {
        name: "riser",
        about: "Share of each step that is a slope; 0% makes upright walls",
        kind: ParamKind::Number { unit: "%", default: 0.1, min: 0.0, max: 1.0 },
    },
];

const SURFACE: Port =
    Port { name: "surface", about: "The surface", type_name: HeightField::TYPE, optional: false };

impl Node for Terrace {
    fn name(&self) -> &str {
        "terrace"
    }

    fn about(&self) -> &str {
        "Makes steps of equal height of a surface, like a map of cork sheets."
    }

    // Raise version() whenever the same inputs give other outputs: carve keeps what a node made.

    fn params(&self) -> &[Param] {
        PARAMS
    }

    fn inputs(&self) -> &[Port] {
        &[SURFACE]
    }

    fn outputs(&self) -> &[Port] {
        &[Port { about: "The surface in steps", ..SURFACE }]
    }

    fn run(&self, job: &Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault> {
        let step = job.number("step")? as f32;
        let riser = job.number("riser")? as f32;
        let surface: HeightField = job.input("surface")?;
        let [low, high] = range(&surface.heights);
        let count = ((high - low) / step).floor() + 1.0;
        if count > MOST_TERRACES {
            return Err(NodeFault::Failed(format!(
                "a step of {step} mm makes {count} terraces; give a step of at least {} mm",
                (high - low) / (MOST_TERRACES - 1.0)
            )));
        }
        if count < 2.0 {
            let height = high - low;
            job.warn(format!("the surface is {height} mm high, less than a step: it becomes flat"));
        }
        let mut heights = surface.heights.to_vec();
        // On all threads, a row each; ends early when the user interrupts.
        job.parallel_chunks(&mut heights, surface.columns, |_, row| {
            row.iter_mut().for_each(|height| *height = low + terraced(*height - low, step, riser));
        })?;
        job.note(format!("{count} terraces, {step} mm each"));
        Ok(vec![surface.with_heights(heights).into_raw()])
    }
}

/// The least and the greatest height.
fn range(heights: &[f32]) -> [f32; 2] {
    let start = [f32::INFINITY, f32::NEG_INFINITY];
    heights.iter().fold(start, |[low, high], h| [low.min(*h), high.max(*h)])
}

/// The height, in steps, of a point that is `height` above the lowest one.
fn terraced(height: f32, step: f32, riser: f32) -> f32 {
    let steps = height / step;
    let climbed = steps - steps.floor();
    let slope = if riser > 0.0 { ((climbed - (1.0 - riser)) / riser).max(0.0) } else { 0.0 };
    step * (steps.floor() + slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_sdk::node::Trial;

    /// A trial runs a node as carve does, and checks what it says of itself and what it makes.
    fn made(heights: &[f32], step: f64, riser: f64) -> Result<Vec<f32>, String> {
        let rows = heights.len() / 2;
        let surface = HeightField { columns: 2, rows, pitch_mm: 0.1, heights: heights.into() };
        let trial = Trial::of(&Terrace).set("step", step).set("riser", riser);
        let made = trial.input("surface", surface).run().map_err(|fault| fault.to_string())?;
        Ok(HeightField::from_raw(&made[0]).unwrap().heights.to_vec())
    }

    #[test]
    fn walls_are_upright_without_a_riser() {
        let heights = [0.0, 0.25, 0.5, 0.75, 1.25, 2.0];
        assert_eq!(made(&heights, 0.5, 0.0).unwrap(), [0.0, 0.0, 0.5, 0.5, 1.0, 2.0]);
    }

    #[test]
    fn a_riser_climbs_over_the_end_of_each_step() {
        let heights = [0.0, 0.5, 0.75, 0.875, 1.0, 1.5];
        assert_eq!(made(&heights, 1.0, 0.5).unwrap(), [0.0, 0.0, 0.5, 0.75, 1.0, 1.0]);
    }

    #[test]
    fn a_riser_of_the_whole_step_changes_nothing() {
        let heights = [0.0, 0.25, 0.5, 0.75];
        assert_eq!(made(&heights, 0.5, 1.0).unwrap(), heights);
    }

    #[test]
    fn steps_count_from_the_lowest_point() {
        assert_eq!(made(&[-3.0, -2.75, -2.5, -2.0], 0.5, 0.0).unwrap(), [-3.0, -3.0, -2.5, -2.0]);
    }

    #[test]
    fn too_many_terraces_are_refused() {
        let fault = made(&[0.0, 0.0, 0.0, 20.0], 0.001, 0.0).unwrap_err();
        assert!(fault.contains("give a step of at least 0.002"), "{fault}");
    }
}

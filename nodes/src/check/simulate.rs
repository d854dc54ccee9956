//! What a program leaves of the stock.
//!
//! The stock is a block: the box of the part, with what `margin` and `top` add to it. The grid starts at the
//! part's near left corner, as height fields do, so a margin only tells how far the pictures reach.

use crate::machining::Machining;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{
    Bounds, Cut, DVec3, FieldGrid, HeightField, Load, Profile, SimulateError, Stock, simulate,
};
use serde::{Deserialize, Serialize};

/// What comes of a resolution of 0: the radius of the finest cutter over this. A ball that goes d too deep
/// leaves a dimple of radius √(2 d R): of 0.55 mm for 0.05 mm and a radius of 3 mm. A node is at most 0.14 mm
/// from its middle then, where it is 0.047 mm deep.
const NODES_A_RADIUS: f64 = 15.0;

/// Nodes that are chosen at most by themselves; 2000 × 2000 take a second or less.
const CHOSEN_NODES: f64 = 4e6;

/// The finest resolution that is chosen by itself, in mm: a program has three decimals.
const FINEST_MM: f64 = 0.01;

/// Nodes at most: 16 bytes each.
const MOST_NODES: f64 = 2e8;

/// Cuts a block as a program says, move by move with the cutters' exact shapes: the surface that it leaves,
/// rapids that run through stock, and how much the cutters have to bear.
#[derive(Clone, Debug, Params)]
pub(crate) struct Simulate {
    /// Distance of the nodes of the stock; 0 chooses it by the finest cutter and the size of the part.
    #[param(unit = "mm", default = 0.0, range = 0.0..=100.0)]
    pub(crate) resolution: f64,
    /// How far the block reaches above the part.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1000.0)]
    pub(crate) top: f64,
}

/// What was found by simulating a program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Simulated {
    /// Distance of the nodes of the stock, in mm.
    pub resolution_mm: f64,
    /// Rapids that went through stock.
    pub rapids: Vec<RapidThrough>,
    /// What each tool has to bear, in the order of the program's runs.
    pub loads: Vec<Load>,
}

/// A rapid that went through stock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RapidThrough {
    /// Which of the program's runs.
    pub run: usize,
    /// Which of its moves.
    pub index: usize,
    /// Where it took away most, in mm.
    pub at: DVec3,
    /// How much it took away there, in mm.
    pub depth_mm: f64,
}

#[derive(Inputs)]
pub(crate) struct Program<'a> {
    /// What the program makes the machine do.
    machining: &'a Machining,
    /// The box that holds the part.
    part: &'a Bounds,
}

#[derive(Outputs)]
pub(crate) struct Machined {
    /// The surface that is left.
    surface: HeightField,
    /// What was found on the way.
    simulation: Simulated,
}

impl Node for Simulate {
    const KIND: &'static str = "simulate";
    type Inputs<'a> = Program<'a>;
    type Outputs = Machined;

    fn run(&self, inputs: Program<'_>, cx: &Context<'_>) -> Result<Machined, NodeError> {
        let Program { machining, part } = inputs;
        let resolution_mm = self.resolution_over(part, machining)?;
        let grid = FieldGrid::over(*part, resolution_mm);
        let stock = Stock { corner: part.min.truncate(), grid, top_mm: part.max.z + self.top };
        let cuts: Vec<Cut<'_>> = machining
            .runs
            .iter()
            .map(|run| Cut { motion: &run.motion, profile: &run.cutter.profile })
            .collect();
        let ticker = cx.ticker(cuts.iter().map(|cut| cut.motion.moves.len()).sum());
        let tick = |moves| ticker.tick(moves);
        let simulation = simulate(&stock, &cuts, &tick).map_err(|fault| match fault {
            SimulateError::Stopped => NodeError::Cancelled,
            fault => NodeError::failed(fault),
        })?;
        let rapids = simulation.rapids.into_iter().map(|rapid| RapidThrough {
            run: rapid.cut,
            index: rapid.index,
            at: rapid.at,
            depth_mm: rapid.depth_mm,
        });
        let found = Simulated { resolution_mm, rapids: rapids.collect(), loads: simulation.loads };
        Ok(Machined { surface: simulation.surface, simulation: found })
    }
}

impl Simulate {
    /// The distance of nodes, in mm.
    fn resolution_over(&self, part: &Bounds, machining: &Machining) -> Result<f64, NodeError> {
        let size = part.size();
        let area = size.x * size.y;
        if self.resolution > 0.0 {
            let nodes = area / (self.resolution * self.resolution);
            if nodes > MOST_NODES {
                return Err(NodeError::refused(
                    "resolution",
                    format!(
                        "{} mm make {nodes:.0} nodes of a part of {:.1} x {:.1} mm; {MOST_NODES:.0} are allowed",
                        self.resolution, size.x, size.y
                    ),
                ));
            }
            return Ok(self.resolution);
        }
        let radii = machining.runs.iter().map(|run| Profile::radius_mm(&run.cutter.profile));
        let finest = radii.fold(f64::INFINITY, f64::min);
        let wanted = (finest / NODES_A_RADIUS).max(FINEST_MM);
        // Two nodes each way at least, or it is no surface.
        let widest = size.x.min(size.y) / 2.0;
        let resolution = wanted.max((area / CHOSEN_NODES).sqrt());
        Ok(if widest > 0.0 { resolution.min(widest) } else { resolution })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::testing::{ball, path};
    use crate::machining::ToolRun;
    use crate::testing::run;

    /// A pass of 10 mm along x, 1 mm deep into a part of 10 × 8 × 4 mm with its top at 0.
    fn simulated(node: &Simulate) -> Result<Machined, NodeError> {
        let motion = path(1.0).motion().unwrap();
        let lines = vec![1; motion.moves.len()];
        let run_of = ToolRun { program: 0, cutter: ball(4.0), motion, lines, dwell_s: 0.0 };
        let machining = Machining { runs: vec![run_of], faults: Vec::new(), readable: true };
        let part = Bounds { min: DVec3::new(0.0, 0.0, -4.0), max: DVec3::new(10.0, 8.0, 0.0) };
        run(|cx| node.run(Program { machining: &machining, part: &part }, cx))
    }

    #[test]
    fn a_pass_leaves_a_groove() {
        let made = simulated(&Simulate { resolution: 0.5, top: 0.0 }).unwrap();
        let left = |i, j| made.surface.height(i, j);
        assert_eq!((made.surface.columns(), made.surface.rows()), (21, 17));
        assert_eq!(left(4, 0), -1.0);
        // A millimetre beside the pass a ball of radius 2 is 2 - √3 higher.
        assert!((left(4, 2) - (-1.0 + 2.0 - 3_f64.sqrt())).abs() < 1e-6);
        assert_eq!(left(4, 10), 0.0);
        assert_eq!(made.simulation.rapids, []);
        assert!((made.simulation.loads[0].step_down.unwrap().depth_mm - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_block_that_is_higher_is_cut_deeper() {
        let made = simulated(&Simulate { resolution: 0.5, top: 2.0 }).unwrap();
        assert_eq!(made.surface.height(4, 10), 2.0);
        assert!((made.simulation.loads[0].step_down.unwrap().depth_mm - 3.0).abs() < 1e-6);
        // The path travels 5 mm above the part, in a block that is 6 mm higher.
        let made = simulated(&Simulate { resolution: 0.5, top: 6.0 }).unwrap();
        assert!(!made.simulation.rapids.is_empty());
    }

    #[test]
    fn the_resolution_follows_the_cutter_within_limits() {
        assert_eq!(
            simulated(&Simulate { resolution: 0.0, top: 0.0 }).unwrap().simulation.resolution_mm,
            2.0 / 15.0
        );
        let fault = simulated(&Simulate { resolution: 1e-4, top: 0.0 }).map(|_| ()).unwrap_err();
        assert!(fault.to_string().contains("nodes of a part of 10.0 x 8.0 mm"), "{fault}");
    }
}

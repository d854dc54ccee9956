//! What a machine does when it runs a program: the moves that its text says, tool by tool.

use carvegraph_geometry::{Bounds, Cutter, DVec3, Motion, Move};
use serde::{Deserialize, Serialize};

/// All that the programs of a job make a machine do, in the order in which they are run, in the part's
/// frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machining {
    /// The moves, a new run where the tool is changed; never none.
    pub runs: Vec<ToolRun>,
    /// What the text asks for that no machine should do, in the order of its lines.
    pub faults: Vec<TextFault>,
    /// Whether the language of all programs is known. If not there are no moves, and nothing is wrong.
    pub readable: bool,
}

/// The moves that one tool makes before the next one is put in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToolRun {
    /// Which of the job's programs says so, from 0.
    pub program: usize,
    /// The cutter.
    pub cutter: Cutter,
    /// Its moves. The first leads from above the place where it ends.
    pub motion: Motion,
    /// The line, from 1, that says each move; as long as the motion's moves.
    pub lines: Vec<u32>,
    /// Waits, in seconds, all together.
    pub dwell_s: f64,
}

/// Something wrong in a program's text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TextFault {
    /// Which of the job's programs, from 0.
    pub program: usize,
    /// The line, from 1.
    pub line: u32,
    /// What is wrong, in words.
    pub text: String,
}

impl Machining {
    /// All moves, each with the point that it comes from.
    pub fn legs(&self) -> impl Iterator<Item = (DVec3, &Move)> {
        self.runs.iter().flat_map(|run| run.motion.legs())
    }

    /// The box that just holds all places that a tip comes to, arcs included to a micrometre.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
        let mut reach = |tip: DVec3| {
            (bounds.min, bounds.max) = (bounds.min.min(tip), bounds.max.max(tip));
        };
        for run in &self.runs {
            for (from, moved) in run.motion.legs() {
                match run.motion.arc(moved) {
                    Some(arc) => arc.chords(from, moved.to, 1e-3).for_each(&mut reach),
                    None => reach(moved.to),
                }
            }
        }
        bounds
    }
}

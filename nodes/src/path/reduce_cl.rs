//! Fewer points for the same path.
//!
//! *Z band* is the rule of Sood 2015, section 4.4: along a pass, points as high as the last one
//! kept, within the tolerance, go. *Chord* keeps the fewest points such that the straight lines
//! between them stay within the tolerance of the points that go.

use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Reduction, Toolpath, reduce_chord, reduce_z_band};

/// Takes points out of a path that are not needed to follow it. Never across the end of a pass.
#[derive(Clone, Debug, Params)]
pub(crate) struct ReduceCl {
    /// Which points go.
    #[param(default = Method::ZBand)]
    pub(crate) method: Method,
    /// How far a point that goes may lie from where it was: z_band may double it, chord keeps it.
    #[param(unit = "mm", default = 0.01, range = 0.0..=100.0)]
    pub(crate) tolerance: f64,
    /// How far chord may run below a point that goes, into the part.
    #[param(unit = "mm", default = 0.0, range = 0.0..=100.0)]
    pub(crate) gouge: f64,
}

/// Which points of a path go.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Method {
    /// Those as high as the last one kept.
    ZBand,
    /// Those near the straight line between two that stay.
    Chord,
    /// None.
    None,
}

#[derive(Inputs)]
pub(crate) struct Full<'a> {
    /// The path with all its points.
    toolpath: &'a Toolpath,
}

#[derive(Outputs)]
pub(crate) struct Reduced {
    /// The path with those that stay.
    toolpath: Toolpath,
    /// How many went, and how far the path moved.
    reduction: Reduction,
}

impl Node for ReduceCl {
    const KIND: &'static str = "reduce_cl";
    type Inputs<'a> = Full<'a>;
    type Outputs = Reduced;

    fn run(&self, inputs: Full<'_>, cx: &Context<'_>) -> Result<Reduced, NodeError> {
        let path = inputs.toolpath;
        let ticker = cx.ticker(path.tips.len());
        let tick = |count| ticker.tick(count);
        let (toolpath, reduction) = cx.completed(match self.method {
            Method::ZBand => reduce_z_band(path, self.tolerance, &tick),
            Method::Chord => reduce_chord(path, self.tolerance, self.gouge, &tick),
            // A tolerance below 0 leaves every point, and counts them.
            Method::None => reduce_z_band(path, -1.0, &tick),
        })?;
        Ok(Reduced { toolpath, reduction })
    }
}

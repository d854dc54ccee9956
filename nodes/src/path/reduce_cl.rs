//! Fewer points for the same path.
//!
//! *Z band* is the rule of Sood 2015, section 4.4: along a pass, points as high as the last one
//! kept, within the tolerance, go. *Chord* keeps the fewest points such that the straight lines
//! between them stay within the tolerance of the points that go. *Arcs* puts arcs in besides, where the
//! path lies in a plane that machines turn in: along X, along Y or level.

use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Reduction, Toolpath, fit_arcs, reduce_chord, reduce_z_band};

/// Takes points out of a path that are not needed to follow it. Never across the end of a pass.
#[derive(Clone, Debug, Params)]
pub(crate) struct ReduceCl {
    /// Which points go.
    #[param(default = Method::ZBand)]
    pub(crate) method: Method,
    /// How far a point that goes may lie from where it was: z_band may double it, chord and arcs keep it.
    #[param(unit = "mm", default = 0.01, range = 0.0..=100.0)]
    pub(crate) tolerance: f64,
    /// How far chord and arcs may run below what goes, into the part.
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
    /// Those near the line or the arc between two that stay.
    Arcs,
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
    const VERSION: u32 = 2;
    type Inputs<'a> = Full<'a>;
    type Outputs = Reduced;

    fn run(&self, inputs: Full<'_>, cx: &Context<'_>) -> Result<Reduced, NodeError> {
        let path = inputs.toolpath;
        let ticker = cx.ticker(path.tips.len());
        let tick = |count| ticker.tick(count);
        let (toolpath, reduction) = cx.completed(match self.method {
            Method::ZBand => reduce_z_band(path, self.tolerance, &tick),
            Method::Chord => reduce_chord(path, self.tolerance, self.gouge, &tick),
            Method::Arcs => fit_arcs(path, self.tolerance, self.gouge, &tick),
            // A tolerance below 0 leaves every point, and counts them.
            Method::None => reduce_z_band(path, -1.0, &tick),
        })?;
        Ok(Reduced { toolpath, reduction })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::{Contact, DVec3, Span, SpanKind};

    /// One pass over these heights, 1 mm apart.
    fn reduce(method: Method, tolerance: f64, heights: &[f64]) -> (Vec<f64>, Reduction) {
        let tip = |(i, z): (usize, &f64)| DVec3::new(i as f64, 0.0, *z);
        let path = Toolpath {
            tips: heights.iter().enumerate().map(tip).collect(),
            contacts: vec![Contact::NONE; heights.len()],
            spans: vec![Span { points: 0..heights.len(), kind: SpanKind::Pass, joined: false }],
            ..Toolpath::default()
        };
        let node = ReduceCl { method, tolerance, gouge: 0.0 };
        let reduced = run(|cx| node.run(Full { toolpath: &path }, cx)).unwrap();
        (reduced.toolpath.tips.iter().map(|tip| tip.z).collect(), reduced.reduction)
    }

    const RAMP: [f64; 5] = [0.0, 1.0, 2.0, 3.0, 3.0];

    #[test]
    fn none_keeps_every_point_and_counts_them() {
        let (heights, reduction) = reduce(Method::None, 10.0, &[1.0; 5]);
        assert_eq!(heights, [1.0; 5]);
        assert_eq!((reduction.points_in, reduction.points_out), (5, 5));
    }

    #[test]
    fn z_band_merges_equal_heights_and_chord_straight_lines() {
        assert_eq!(reduce(Method::ZBand, 0.0, &[1.0; 5]).0, [1.0; 2]);
        assert_eq!(reduce(Method::ZBand, 0.0, &RAMP).0, RAMP);
        assert_eq!(reduce(Method::Chord, 0.0, &RAMP).0, [0.0, 3.0, 3.0]);
    }

    #[test]
    fn arcs_bend_over_a_round_hill() {
        let hill: Vec<f64> = (-20..=20).map(|x| (900.0 - f64::from(x * x)).sqrt()).collect();
        let (heights, reduction) = reduce(Method::Arcs, 0.02, &hill);
        assert_eq!(heights, [hill[0], hill[40]]);
        assert!(reduction.max_above_mm <= 0.020_001 && reduction.max_below_mm < 1e-8);
        assert!(reduce(Method::Chord, 0.02, &hill).0.len() > 20);
    }
}

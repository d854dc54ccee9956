//! The moves between passes, and the speeds.

use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Bounds, Feeds, Toolpath, link_passes};

/// Adds approach, plunges, retracts and the travel between passes, and sets the speeds. Passes that
/// follow each other along the surface stay on it.
#[derive(Clone, Debug, Params)]
pub(crate) struct Link {
    /// Height above the top of the part at which the cutter may travel anywhere.
    #[param(unit = "mm", default = 5.0, range = 0.1..=500.0)]
    pub(crate) safe_z: f64,
    /// Speed of cutting.
    #[param(unit = "mm/min", default = 1500.0, range = 1.0..=100_000.0)]
    pub(crate) feed: f64,
    /// Speed of going down into the stock.
    #[param(unit = "mm/min", default = 500.0, range = 1.0..=100_000.0)]
    pub(crate) plunge: f64,
    /// Speed of the machine's rapids, for the estimate of time only.
    #[param(unit = "mm/min", default = 5000.0, range = 1.0..=500_000.0)]
    pub(crate) rapid: f64,
}

#[derive(Inputs)]
pub(crate) struct Loose<'a> {
    /// The passes.
    toolpath: &'a Toolpath,
    /// The box that holds the part.
    part: &'a Bounds,
}

#[derive(Outputs)]
pub(crate) struct Linked {
    /// The path with all its moves.
    toolpath: Toolpath,
}

impl Node for Link {
    const KIND: &'static str = "link";
    type Inputs<'a> = Loose<'a>;
    type Outputs = Linked;

    fn run(&self, inputs: Loose<'_>, _: &Context<'_>) -> Result<Linked, NodeError> {
        let feeds = Feeds {
            cut_mm_per_min: self.feed,
            plunge_mm_per_min: self.plunge,
            rapid_mm_per_min: self.rapid,
        };
        let safe_z_mm = inputs.part.max.z + self.safe_z;
        let toolpath = link_passes(inputs.toolpath, safe_z_mm, feeds).map_err(NodeError::failed)?;
        Ok(Linked { toolpath })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::{Contact, DVec3, Span, SpanKind};

    #[test]
    fn the_safe_height_counts_from_the_top_of_the_part() {
        let path = Toolpath {
            tips: vec![DVec3::new(0.0, 0.0, 1.0), DVec3::new(4.0, 0.0, 2.0)],
            contacts: vec![Contact::NONE; 2],
            spans: vec![Span { points: 0..2, kind: SpanKind::Pass, joined: false }],
            feeds: None,
        };
        let part = Bounds { min: DVec3::ZERO, max: DVec3::new(4.0, 4.0, 7.0) };
        let node = Link { safe_z: 5.0, feed: 1000.0, plunge: 300.0, rapid: 5000.0 };
        let linked =
            run(|cx| node.run(Loose { toolpath: &path, part: &part }, cx)).unwrap().toolpath;
        let (first, last) = (linked.tips[0], linked.tips[linked.tips.len() - 1]);
        assert_eq!((first, last), (DVec3::new(0.0, 0.0, 12.0), DVec3::new(4.0, 0.0, 12.0)));
        assert_eq!(linked.feeds.unwrap().plunge_mm_per_min, 300.0);
        assert_eq!(linked.cl_points(), 2);
    }
}

//! The moves between passes, and the speeds.

use crate::shop::Setup;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params, Yielding};
use carvegraph_geometry::{Bounds, Feeds, Toolpath, link_passes};

/// Adds approach, plunges, retracts and the travel between passes, and sets the speeds. Passes that
/// follow each other along the surface stay on it. What is not set here comes from the setup.
#[derive(Clone, Debug, Params)]
pub(crate) struct Link {
    /// Height above the top of the part at which the cutter may travel anywhere.
    #[param(unit = "mm", default = 5.0, range = 0.1..=500.0)]
    pub(crate) safe_z: Yielding<f64>,
    /// Speed of cutting.
    #[param(unit = "mm/min", default = 1500.0, range = 1.0..=100_000.0)]
    pub(crate) feed: Yielding<f64>,
    /// Speed of going down into the stock.
    #[param(unit = "mm/min", default = 500.0, range = 1.0..=100_000.0)]
    pub(crate) plunge: Yielding<f64>,
    /// Speed of the machine's rapids, for the estimate of time only.
    #[param(unit = "mm/min", default = 5000.0, range = 1.0..=500_000.0)]
    pub(crate) rapid: Yielding<f64>,
}

#[derive(Inputs)]
pub(crate) struct Loose<'a> {
    /// The passes.
    toolpath: &'a Toolpath,
    /// The box that holds the part.
    part: &'a Bounds,
    /// The machine, the tool and the material.
    setup: Option<&'a Setup>,
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
        let none = Setup::default();
        let Setup { machine, conditions, .. } = inputs.setup.unwrap_or(&none);
        let feeds = Feeds {
            cut_mm_per_min: self.feed.or(conditions.feed_mm_per_min),
            plunge_mm_per_min: self.plunge.or(conditions.plunge_mm_per_min),
            rapid_mm_per_min: self.rapid.or(machine.rapid_mm_per_min),
        };
        let safe_z_mm = inputs.part.max.z + self.safe_z.or(machine.safe_z_mm);
        let toolpath = link_passes(inputs.toolpath, safe_z_mm, feeds).map_err(NodeError::failed)?;
        Ok(Linked { toolpath })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shop::{Conditions, Machine};
    use crate::testing::run;
    use carvegraph_geometry::{Contact, DVec3, Span, SpanKind};

    /// Links a pass below the top of a part, which lies at 7 mm.
    fn linked(node: &Link, setup: Option<&Setup>) -> Toolpath {
        let path = Toolpath {
            tips: vec![DVec3::new(0.0, 0.0, 1.0), DVec3::new(4.0, 0.0, 2.0)],
            contacts: vec![Contact::NONE; 2],
            spans: vec![Span { points: 0..2, kind: SpanKind::Pass, joined: false }],
            ..Toolpath::default()
        };
        let part = Bounds { min: DVec3::ZERO, max: DVec3::new(4.0, 4.0, 7.0) };
        run(|cx| node.run(Loose { toolpath: &path, part: &part, setup }, cx)).unwrap().toolpath
    }

    fn left() -> Link {
        Link {
            safe_z: Yielding::left(5.0),
            feed: Yielding::left(1000.0),
            plunge: Yielding::left(300.0),
            rapid: Yielding::left(5000.0),
        }
    }

    #[test]
    fn the_safe_height_counts_from_the_top_of_the_part() {
        let linked = linked(&left(), None);
        let (first, last) = (linked.tips[0], linked.tips[linked.tips.len() - 1]);
        assert_eq!((first, last), (DVec3::new(0.0, 0.0, 12.0), DVec3::new(4.0, 0.0, 12.0)));
        assert_eq!(linked.feeds.unwrap().plunge_mm_per_min, 300.0);
        assert_eq!(linked.cl_points(), 2);
    }

    #[test]
    fn what_is_set_wins_over_tool_and_machine_and_these_over_the_defaults() {
        let mut setup = Setup::default();
        setup.conditions = Conditions { feed_mm_per_min: Some(800.0), ..setup.conditions };
        let (rapid_mm_per_min, safe_z_mm) = (Some(9000.0), Some(2.0));
        setup.machine = Machine { rapid_mm_per_min, safe_z_mm, ..setup.machine };
        let yielded = linked(&left(), Some(&setup));
        let feeds = |path: &Toolpath| {
            let feeds = path.feeds.unwrap();
            [feeds.cut_mm_per_min, feeds.plunge_mm_per_min, feeds.rapid_mm_per_min]
        };
        assert_eq!((feeds(&yielded), yielded.tips[0].z), ([800.0, 300.0, 9000.0], 9.0));
        let (feed, rapid) = (Yielding::given(1000.0), Yielding::given(100.0));
        let set = Link { feed, rapid, safe_z: Yielding::given(1.0), ..left() };
        let set = linked(&set, Some(&setup));
        assert_eq!((feeds(&set), set.tips[0].z), ([1000.0, 300.0, 100.0], 8.0));
    }
}

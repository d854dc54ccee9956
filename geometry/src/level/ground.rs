//! Tips on a grid.

use super::{LEVEL_SLACK_MM, Outline, refine};
use crate::trace::{Crossing, trace};
use crate::{Bounds, Contact, DropCutter, Pattern, PatternSpan, Tick};
use glam::DVec2;

/// The tips of a cutter on a grid over an area, and the drop cutter between them.
#[derive(Debug)]
pub(super) struct Ground<'a> {
    cutter: DropCutter<'a>,
    min: DVec2,
    max: DVec2,
    /// Nodes along x and y; the outermost lie on the border of the area.
    nodes: [usize; 2],
    floor_z_mm: f64,
    /// Row by row from the least y.
    tips: Vec<f64>,
}

impl<'a> Ground<'a> {
    /// Number of nodes of the grid of [`Self::new`].
    pub(super) fn count(area: &Bounds, pitch_mm: f64) -> f64 {
        let size = area.size().truncate() / pitch_mm;
        (size.x.ceil() + 1.0) * (size.y.ceil() + 1.0)
    }

    /// Drops the cutter on a grid over the XY rectangle of `area`, its nodes no more than `pitch_mm`
    /// apart. Where nothing is under the cutter the tip is at the floor. `None` if `tick` stopped it.
    ///
    /// Memory grows with [`Self::count`]: look at it first.
    pub(super) fn new(
        cutter: DropCutter<'a>,
        area: &Bounds,
        pitch_mm: f64,
        floor_z_mm: f64,
        tick: Tick,
    ) -> Option<Self> {
        let (min, max) = (area.min.truncate(), area.max.truncate());
        let nodes = ((max - min) / pitch_mm).to_array().map(|n| n.ceil() as usize + 1);
        let mut ground = Self { cutter, min, max, nodes, floor_z_mm, tips: Vec::new() };
        let [columns, rows] = nodes;
        let places = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j]));
        ground.tips = ground.drop(places.map(|node| ground.place(node)).collect(), tick)?.0;
        Some(ground)
    }

    /// The distance between nodes, the greater of both ways, in mm.
    pub(super) fn pitch_mm(&self) -> f64 {
        let [columns, rows] = self.nodes.map(|n| (n - 1).max(1) as f64);
        ((self.max - self.min) / DVec2::new(columns, rows)).max_element()
    }

    pub(super) fn place(&self, [i, j]: [usize; 2]) -> DVec2 {
        let share = |k: usize, n: usize| if n > 1 { k as f64 / (n - 1) as f64 } else { 0.0 };
        let share = DVec2::new(share(i, self.nodes[0]), share(j, self.nodes[1]));
        self.min + (self.max - self.min) * share
    }

    /// Whether the tip may be at the height z at a node.
    pub(super) fn is_free(&self, [i, j]: [usize; 2], z: f64) -> bool {
        self.tips[j * self.nodes[0] + i] <= z + LEVEL_SLACK_MM
    }

    /// The lowest tip, in mm.
    pub(super) fn lowest_mm(&self) -> f64 {
        self.tips.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Height and contact of the tip at some places.
    pub(super) fn drop(&self, places: Vec<DVec2>, tick: Tick) -> Option<(Vec<f64>, Vec<Contact>)> {
        if places.is_empty() {
            return Some(Default::default());
        }
        let spans = vec![PatternSpan { points: 0..places.len(), link: false, joined: false }];
        let path = self.cutter.path(&Pattern { points: places, spans }, self.floor_z_mm, tick)?;
        Some((path.tips.iter().map(|tip| tip.z).collect(), path.contacts))
    }

    /// Whether the tip may be at the height z, at some places of the area. Beyond it, it may not.
    pub(super) fn are_free(&self, places: &[DVec2], z: f64) -> Option<Vec<bool>> {
        let inside = |at: &DVec2| at.cmpge(self.min).all() && at.cmple(self.max).all();
        // The work is some thousands of places, between which the caller ticks.
        let (tips, _) = self.drop(places.to_vec(), &|_| true)?;
        let free = places.iter().zip(tips);
        Some(free.map(|(at, tip)| inside(at) && tip <= z + LEVEL_SLACK_MM).collect())
    }

    /// The outlines of what is free at the height z, true to `tolerance_mm` in plan. `None` if `tick`
    /// stopped it.
    pub(super) fn outlines(&self, z: f64, tolerance_mm: f64, tick: Tick) -> Option<Vec<Outline>> {
        // Where squares leave a choice, free places are kept apart.
        let traced =
            trace(self.nodes, |node| self.is_free(node, z), |_| true, &|_| tick(0)).ok()?;
        let to_the_left = |mut crossings: Vec<Crossing>| {
            crossings.reverse();
            crossings
        };
        let traced: Vec<Vec<Crossing>> = traced.into_iter().map(to_the_left).collect();
        refine::refine(self, &traced, z, tolerance_mm, tick)
    }
}

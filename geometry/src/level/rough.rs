//! Roughing in levels: takes the stock away down to an allowance, level by level.

use super::{LevelError, Levels, Milling, Outline};
use crate::pattern::{Layer, along};
use crate::{
    ContourParallel, Layout, Pace, Pattern, Polygon, Profile, Raster, RasterStyle, Region, Start,
    Surface, Tick, Toolpath, Turn,
};
use glam::DVec2;

/// How a level is cleared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoughStyle {
    /// Along its outlines, from within.
    Offset,
    /// In parallel passes along x, and then around the outlines.
    Zigzag,
}

/// Roughing in levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rough<'a> {
    /// Where, how high and how exact.
    pub levels: Levels<'a>,
    /// Distance between neighbouring passes, in mm, positive.
    pub stepover_mm: f64,
    /// How a level is cleared.
    pub style: RoughStyle,
    /// On which side of the cutter the material is, in passes along outlines.
    pub milling: Milling,
}

impl Rough<'_> {
    /// The passes, from the highest level to the lowest.
    ///
    /// `tick` counts levels, of which [`Levels::count`] tells twice the number.
    ///
    /// # Errors
    /// If the cutter cannot be dropped, there are too many levels or nodes, or `tick` stopped it.
    pub fn path(
        &self,
        surface: Surface<'_>,
        profile: &Profile,
        tick: Tick,
    ) -> Result<Toolpath, LevelError> {
        let pace = Pace { stepover_mm: self.stepover_mm, feed_step_mm: self.levels.pitch_mm };
        let plan = |_: &[Outline], region: &Region| match self.style {
            RoughStyle::Offset => self.offset(pace, region),
            RoughStyle::Zigzag => self.zigzag(pace, region),
        };
        self.levels.path(surface, profile, true, plan, tick)
    }

    /// From within, what is still to be cut lies outside: to the right, if passed counter-clockwise.
    fn offset(&self, pace: Pace, region: &Region) -> Pattern {
        let turn = match self.milling {
            Milling::Climb => Turn::CounterClockwise,
            Milling::Conventional => Turn::Clockwise,
        };
        ContourParallel { pace, start: Start::Middle, turn }.pattern(region)
    }

    fn zigzag(&self, pace: Pace, region: &Region) -> Pattern {
        let Pace { stepover_mm, feed_step_mm } = pace;
        let style = RasterStyle::Zigzag;
        let mut pattern = Layout::pattern(
            &Raster { stepover_mm, feed_step_mm, direction_rad: 0.0, style },
            region,
        );
        let mut layer = match Layer::new(region, pace) {
            Ok(layer) => layer,
            Err(pattern) => return pattern,
        };
        let outlines = region.polygon();
        for outline in outlines.iter().flat_map(Polygon::loops) {
            // What is free lies to the left.
            let mut around: Vec<DVec2> = outline.iter().chain(outline.first()).copied().collect();
            if self.milling == Milling::Conventional {
                around.reverse();
            }
            layer.add_whole(along(&around, feed_step_mm).collect());
        }
        pattern.append(layer.into_pattern(false));
        pattern
    }
}

//! Passes as lines that a cutter was dropped along.
//!
//! Planners think in places (f, a): f along the feed, a across. In plan that is (x, y) where passes run along
//! x, (y, x) where they run along y.

use super::sweep::Sweep;
use super::{Finish, ScallopError};
use crate::{
    Contact, DropCutter, DropError, Pattern, PatternSpan, RasterStyle, Span, SpanKind, Tick,
    Toolpath,
};
use glam::{DVec2, DVec3, Vec3Swizzles};
use std::ops::Range;

/// The path is off by no more than this share of the scallop, whatever the tolerance: else what chords leave
/// in hollows, which has its peak anywhere between probes, would count beside what stands between passes.
const CHORD_SHARE: f64 = 0.1;

/// A cutter over the surface, ready to be dropped.
pub(super) struct Bench<'a> {
    pub(super) finish: &'a Finish<'a>,
    pub(super) sweep: Sweep<'a>,
    pub(super) tick: Tick<'a>,
    /// The step that is right on level ground, in mm.
    pub(super) flat_mm: f64,
    cutter: DropCutter<'a>,
    /// Whether f is y.
    along_y: bool,
}

/// A pass: cutter locations in the order of f, points where the path bends included.
#[derive(Clone, Debug, Default)]
pub(super) struct Line {
    /// Tips as (f, a, z).
    pub(super) tips: Vec<DVec3>,
    contacts: Vec<Contact>,
}

impl<'a> Bench<'a> {
    pub(super) fn new(finish: &'a Finish<'a>, tick: Tick<'a>) -> Result<Self, ScallopError> {
        finish.check()?;
        let stop = &|_| tick(0);
        let cutter = DropCutter::new(finish.surface, finish.profile, finish.allowance_mm, stop)?;
        let sweep = Sweep::new(finish.profile);
        let (flat_mm, along_y) = (finish.flat_step_mm(), finish.along_y);
        Ok(Self { finish, sweep, tick, flat_mm, cutter, along_y })
    }

    /// Feed and across change places.
    pub(super) fn turned(self) -> Self {
        Self { along_y: !self.along_y, ..self }
    }

    /// A place in plan as (f, a), or the other way round.
    pub(super) fn turn(&self, v: DVec3) -> DVec3 {
        if self.along_y { v.yxz() } else { v }
    }

    /// Where the tip may be along the feed, and across.
    pub(super) fn extent(&self) -> [Range<f64>; 2] {
        let (min, max) = (self.turn(self.finish.area.min), self.turn(self.finish.area.max));
        [min.x..max.x, min.y..max.y]
    }

    /// Drops the cutter at places (f, a). Tips and contacts are as (f, a, z).
    pub(super) fn drop_at(&self, places: &[DVec2]) -> Result<Toolpath, ScallopError> {
        let points = places.iter().map(|place| self.turn(place.extend(0.0)).truncate()).collect();
        let spans = vec![PatternSpan { points: 0..places.len(), link: false, joined: false }];
        let pattern = Pattern { points, spans };
        let path = self.cutter.path(&pattern, self.finish.floor_mm, &|_| (self.tick)(0));
        Ok(self.turned_path(path.ok_or(DropError::Stopped)?))
    }

    fn turned_path(&self, mut path: Toolpath) -> Toolpath {
        if self.along_y {
            path.tips.iter_mut().for_each(|tip| *tip = tip.yxz());
            path.contacts.iter_mut().for_each(|contact| contact.point = contact.point.yxz());
        }
        path
    }

    /// A pass through places (f, a).
    pub(super) fn line(&self, places: &[DVec2]) -> Result<Line, ScallopError> {
        let path = self.bent(self.drop_at(places)?)?;
        Ok(Line { tips: path.tips, contacts: path.contacts })
    }

    /// Puts points in where the path bends, and keeps it above the floor.
    fn bent(&self, mut path: Toolpath) -> Result<Toolpath, ScallopError> {
        let Finish { floor_mm, chord_tolerance_mm, most_points, scallop_mm, .. } = *self.finish;
        let chord_tolerance_mm = chord_tolerance_mm.min(CHORD_SHARE * scallop_mm);
        path.raise(floor_mm);
        if chord_tolerance_mm == 0.0 {
            return Ok(path);
        }
        let path = self.turned_path(path);
        let stop = &|_| (self.tick)(0);
        let bent = self.cutter.bend(&path, floor_mm, chord_tolerance_mm, most_points, stop)?;
        Ok(self.turned_path(bent))
    }

    /// The passes as a path, in order across, each cut into runs.
    ///
    /// # Errors
    /// If it has too many points, or the tick says stop.
    pub(super) fn path(&self, passes: Vec<Line>) -> Result<Toolpath, ScallopError> {
        let style = self.finish.style;
        // Across the feed the next pass lies to the left of it where f is x, to the right where f is y.
        let backward = match style {
            RasterStyle::Zigzag | RasterStyle::OneWay => false,
            RasterStyle::Climb => !self.along_y,
            RasterStyle::Conventional => self.along_y,
        };
        let zigzag = style == RasterStyle::Zigzag;
        let reach = 2.0 * self.flat_mm;
        let mut path = Toolpath::default();
        for (k, mut line) in passes.into_iter().enumerate() {
            if backward || zigzag && k % 2 == 1 {
                line.tips.reverse();
                line.contacts.reverse();
            }
            let last = path.tips.last().map(|tip| tip.truncate());
            let near =
                last.filter(|last| zigzag && last.distance(line.tips[0].truncate()) <= reach);
            if let Some(from) = near {
                self.add_link(&mut path, from, line.tips[0].truncate())?;
            }
            add(&mut path, line.tips, line.contacts, SpanKind::Pass, near.is_some());
            if path.tips.len() > self.finish.most_points {
                return Err(ScallopError::TooManyPoints(self.finish.most_points));
            }
        }
        Ok(self.turned_path(self.bent(path)?))
    }

    /// The way from a pass to the next, on the surface.
    fn add_link(&self, path: &mut Toolpath, from: DVec2, to: DVec2) -> Result<(), ScallopError> {
        let middle = self.drop_at(&[from.midpoint(to)])?;
        add(path, middle.tips, middle.contacts, SpanKind::Link, true);
        Ok(())
    }
}

fn add(
    path: &mut Toolpath,
    tips: Vec<DVec3>,
    contacts: Vec<Contact>,
    kind: SpanKind,
    joined: bool,
) {
    let start = path.tips.len();
    path.tips.extend(tips);
    path.contacts.extend(contacts);
    path.spans.push(Span { points: start..path.tips.len(), kind, joined });
}

impl Line {
    /// Where it is across at a feed position; at its ends beyond them.
    pub(super) fn across_at(&self, f: f64) -> f64 {
        let next = self.tips.partition_point(|tip| tip.x <= f);
        let [from, to] =
            [next.saturating_sub(1), next.min(self.tips.len() - 1)].map(|k| self.tips[k]);
        let share = if to.x > from.x { (f - from.x) / (to.x - from.x) } else { 0.0 };
        from.y + share.clamp(0.0, 1.0) * (to.y - from.y)
    }

    /// The moves that have some part between two feed positions.
    pub(super) fn moves(&self, f: Range<f64>) -> impl Iterator<Item = (DVec3, DVec3)> {
        let first = self.tips.partition_point(|tip| tip.x < f.start).saturating_sub(1);
        let after = self.tips.partition_point(|tip| tip.x <= f.end) + 1;
        let part = &self.tips[first..after.min(self.tips.len())];
        // A line of one point is a move to itself.
        let alone = (part.len() == 1).then(|| (part[0], part[0]));
        part.windows(2).map(|pair| (pair[0], pair[1])).chain(alone)
    }

    /// The part between two feed positions, made of whole moves; `None` if there is none.
    pub(super) fn part(&self, f: Range<f64>) -> Option<Self> {
        let first = self.tips.partition_point(|tip| tip.x < f.start).saturating_sub(1);
        let after = (self.tips.partition_point(|tip| tip.x <= f.end) + 1).min(self.tips.len());
        (first < after).then(|| Self {
            tips: self.tips[first..after].to_vec(),
            contacts: self.contacts[first..after].to_vec(),
        })
    }
}

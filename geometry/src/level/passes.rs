//! Passes at levels: planned in the plane, dropped, entered.

use super::ground::Ground;
use super::{Outline, heights};
use crate::{
    Bounds, Contact, DropCutter, DropError, Pattern, PatternSpan, Polygon, PolygonError, Profile,
    Region, Span, SpanKind, Surface, Tick, Toolpath,
};
use glam::{DVec2, DVec3};

/// Most nodes of the grid: 8 bytes each, and a drop.
const MAX_NODES: f64 = 1e8;

/// Most levels; more is a mistake in the depth of a pass.
const MAX_LEVELS: f64 = 10_000.0;

/// A way down goes around at most this often; beyond, it is steeper than asked for.
const MAX_TURNS: f64 = 200.0;

/// Why there are no passes at levels.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum LevelError {
    /// The cutter cannot be dropped.
    #[error(transparent)]
    Drop(#[from] DropError),
    /// The surface holds nothing.
    #[error("there is nothing in the surface")]
    Empty,
    /// An outline has too many corners.
    #[error("at z {z_mm} mm {fault}: use a coarser grid")]
    Outline {
        /// The level.
        z_mm: f64,
        /// What is wrong.
        fault: PolygonError,
    },
    /// A number that leads to too much work.
    #[error("{what} {value} mm would make {count:.3e} {things}; the limit is {limit:.0e}")]
    TooMany {
        /// Of which length.
        what: &'static str,
        /// What was given, in mm.
        value: f64,
        /// What it makes.
        things: &'static str,
        /// How many.
        count: f64,
        /// How many there may be.
        limit: f64,
    },
}

/// How the cutter gets down to a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entry {
    /// Along the pass, back and forth, at an angle in radians.
    Ramp(f64),
    /// Around a circle where there is room for one, else along the pass, at an angle in radians.
    Helix(f64),
    /// Straight down: for cutters that cut at their centre.
    Plunge,
}

/// What passes at levels have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels<'a> {
    /// Where the tip may go, in plan.
    pub area: Bounds,
    /// What of it the passes are laid over; all of it if there is none.
    pub boundary: Option<&'a Polygon>,
    /// Top of the stock, in mm.
    pub top_mm: f64,
    /// No level is below it, in mm; the tip is there where nothing lies under the cutter.
    pub floor_mm: f64,
    /// Greatest distance between levels, in mm, positive.
    pub step_mm: f64,
    /// What is left on the surface, in mm, not negative.
    pub allowance_mm: f64,
    /// Distance between nodes of the grid, and between points along a pass, in mm, positive.
    pub pitch_mm: f64,
    /// How far outlines may lie off in plan, in mm, positive: that much more may be left.
    pub tolerance_mm: f64,
    /// How the cutter gets down.
    pub entry: Entry,
}

/// A level with its passes in plan.
pub(super) struct Level {
    z: f64,
    /// Where the way down begins.
    from_z: f64,
    region: Region,
    pattern: Pattern,
}

impl Levels<'_> {
    /// Plans each level with `plan`, which is told the outlines and the region they and the boundary
    /// bound, from the top down, and makes a path of the passes. Between passes that do not follow each other it is not
    /// joined; it has no speeds. The passes that clear all of a level (`clears`) make way for the next one.
    ///
    /// `tick` counts levels twice: planned and dropped.
    pub(super) fn path(
        &self,
        surface: Surface<'_>,
        profile: &Profile,
        clears: bool,
        plan: impl Fn(&[Outline], &Region) -> Pattern,
        tick: Tick,
    ) -> Result<Toolpath, LevelError> {
        let planned = self.plan(surface, profile, plan, tick)?;
        let radius = profile.radius_mm();
        let chains: Vec<Chain> = planned
            .iter()
            .flat_map(|level| {
                let free_z = if clears { level.from_z } else { self.top_mm };
                chains(level, self.entry, radius, free_z)
            })
            .collect();
        let cutter = DropCutter::new(surface, profile, self.allowance_mm, tick)?;
        let places: Vec<DVec2> = chains.iter().flat_map(Chain::places).collect();
        let spans = vec![PatternSpan { points: 0..places.len(), link: false, joined: false }];
        let pattern = Pattern { points: places, spans };
        // Levels stand for points here: the caller counts these.
        let dropped = cutter.path(&pattern, self.floor_mm, &|_| tick(0));
        let dropped = dropped.ok_or(DropError::Stopped)?;
        let mut path = Toolpath::default();
        let mut at = 0;
        for chain in &chains {
            let count = chain.places().count();
            let found = at..at + count;
            chain.add(
                &dropped.tips[found.clone()],
                &dropped.contacts[found],
                self.entry,
                &mut path,
            );
            at += count;
        }
        tick(planned.len());
        Ok(path)
    }

    fn plan(
        &self,
        surface: Surface<'_>,
        profile: &Profile,
        plan: impl Fn(&[Outline], &Region) -> Pattern,
        tick: Tick,
    ) -> Result<Vec<Level>, LevelError> {
        let nodes = Ground::count(&self.area, self.pitch_mm);
        within("a grid of", self.pitch_mm, "nodes", nodes, MAX_NODES)?;
        let depth = (self.top_mm - self.floor_mm) / self.step_mm;
        within("a depth per pass of", self.step_mm, "levels", depth, MAX_LEVELS)?;
        let apart = self.allowance_mm + self.tolerance_mm;
        let cutter = DropCutter::new(surface, profile, apart, tick)?;
        let still = |_| tick(0);
        let ground = Ground::new(cutter, &self.area, self.pitch_mm, self.floor_mm, &still);
        let ground = ground.ok_or(DropError::Stopped)?;
        let bottom = ground.lowest_mm().max(self.floor_mm);
        let mut planned = Vec::new();
        let mut from_z = self.top_mm;
        for z in heights(self.top_mm, bottom, self.step_mm) {
            let outlines = ground.outlines(z, self.tolerance_mm, tick).ok_or(DropError::Stopped)?;
            if let Some(region) = region(&self.area, self.boundary, &outlines, z)? {
                let pattern = plan(&outlines, &region);
                planned.push(Level { z, from_z, region, pattern });
            }
            from_z = z;
            if !tick(1) {
                return Err(DropError::Stopped.into());
            }
        }
        Ok(planned)
    }

    /// How many levels there are at most.
    #[must_use]
    pub fn count(&self) -> usize {
        ((self.top_mm - self.floor_mm) / self.step_mm).clamp(0.0, MAX_LEVELS).ceil() as usize
    }
}

fn within(
    what: &'static str,
    value: f64,
    things: &'static str,
    count: f64,
    limit: f64,
) -> Result<(), LevelError> {
    // NaN is not within.
    if count <= limit {
        Ok(())
    } else {
        Err(LevelError::TooMany { what, value, things, count, limit })
    }
}

/// What outlines bound within the boundary; nothing if there are none, or beside it.
fn region(
    area: &Bounds,
    boundary: Option<&Polygon>,
    outlines: &[Outline],
    z_mm: f64,
) -> Result<Option<Region>, LevelError> {
    if outlines.is_empty() {
        return Ok(None);
    }
    let places = |outline: &Outline| outline.corners.iter().map(|corner| corner.at).collect();
    let polygon = Polygon::new(outlines.iter().map(places).collect());
    let polygon = polygon.map_err(|fault| LevelError::Outline { z_mm, fault })?;
    let polygon = match boundary {
        Some(boundary) => polygon.and(boundary),
        None => Some(polygon),
    };
    let region = |polygon| Region::new(area).and_then(|region| region.within(polygon));
    Ok(polygon.and_then(region))
}

/// Passes that follow each other along the surface.
struct Chain<'a> {
    z: f64,
    from_z: f64,
    /// Down to here nothing is in the way of the cutter.
    free_z: f64,
    /// A closed way from the first place of the passes back to it, along which the cutter gets down.
    way_down: Vec<DVec2>,
    pattern: &'a Pattern,
    spans: &'a [PatternSpan],
}

fn chains(
    level: &Level,
    entry: Entry,
    radius: f64,
    free_z: f64,
) -> impl Iterator<Item = Chain<'_>> {
    let Level { z, from_z, ref region, ref pattern } = *level;
    pattern.spans.chunk_by(|_, next| next.joined).map(move |spans| {
        let points = spans[0].points.start..spans[spans.len() - 1].points.end;
        let points = &pattern.points[points];
        let way_down = match entry {
            Entry::Plunge => vec![points[0]],
            Entry::Ramp(_) => there_and_back(points, 4.0 * radius),
            Entry::Helix(_) => circle(points, region, radius)
                .unwrap_or_else(|| there_and_back(points, 4.0 * radius)),
        };
        Chain { z, from_z, free_z, way_down, pattern, spans }
    })
}

/// Along points for some length, and back.
fn there_and_back(points: &[DVec2], length_mm: f64) -> Vec<DVec2> {
    let mut length = 0.0;
    let steps = points.windows(2).take_while(|pair| {
        let goes_on = length < length_mm;
        length += pair[0].distance(pair[1]);
        goes_on
    });
    let last = steps.count();
    points[..=last].iter().chain(points[..last].iter().rev()).copied().collect()
}

/// A circle through the first of some points that lies in the region, to the left or the right of the
/// way the points go, as large as there is room for.
fn circle(points: &[DVec2], region: &Region, radius: f64) -> Option<Vec<DVec2>> {
    /// Chords of the circle. They stay within it.
    const CHORDS: usize = 36;
    let first = points[0];
    let way = (points.get(1)? - first).try_normalize()?;
    // Wider than the cutter is thick, and a core would be left; much less, and it drills.
    [0.9, 0.7, 0.5, 0.35, 0.25].into_iter().find_map(|share| {
        [way.perp(), -way.perp()].into_iter().find_map(|side| {
            let center = first + side * (share * radius);
            let turn = |k: usize| {
                let angle = k as f64 / CHORDS as f64 * std::f64::consts::TAU;
                center + DVec2::from_angle(angle).rotate(first - center)
            };
            let mut around: Vec<DVec2> = (0..CHORDS).map(turn).collect();
            around.push(first);
            let held = around.windows(2).all(|pair| region.holds(pair[0], pair[1]));
            held.then_some(around)
        })
    })
}

impl Chain<'_> {
    fn places(&self) -> impl Iterator<Item = DVec2> {
        let spans = self.spans.iter().flat_map(|span| &self.pattern.points[span.points.clone()]);
        self.way_down.iter().chain(spans).copied()
    }

    /// Adds the way down and the passes to a path, given what the cutter found at [`Self::places`].
    fn add(&self, tips: &[DVec3], contacts: &[Contact], entry: Entry, path: &mut Toolpath) {
        let (around, tips) = tips.split_at(self.way_down.len());
        let start = path.tips.len();
        path.tips.extend(self.descent(around, entry));
        path.contacts.resize(path.tips.len(), Contact::NONE);
        let end = path.tips.len();
        path.spans.push(Span { points: start..end, kind: SpanKind::Plunge, joined: false });
        let contacts = &contacts[self.way_down.len()..];
        let first = self.spans[0].points.start;
        for span in self.spans {
            let found = span.points.start - first..span.points.end - first;
            let start = path.tips.len();
            for (tip, contact) in tips[found.clone()].iter().zip(&contacts[found]) {
                // Held up, or free at the level.
                let touches = tip.z > self.z;
                path.tips.push(tip.with_z(tip.z.max(self.z)));
                path.contacts.push(if touches { *contact } else { Contact::NONE });
            }
            let kind = if span.link { SpanKind::Link } else { SpanKind::Pass };
            path.spans.push(Span { points: start..path.tips.len(), kind, joined: true });
        }
    }

    /// From the air, around the way down, to the level; never lower than the tips found there.
    fn descent(&self, around: &[DVec3], entry: Entry) -> Vec<DVec3> {
        let first = around[0];
        let length: f64 = around.windows(2).map(|pair| plan_distance(pair[0], pair[1])).sum();
        let depth = self.from_z - self.z;
        let mut descent = vec![first.with_z(self.from_z)];
        if let Entry::Ramp(slope) | Entry::Helix(slope) = entry
            && length > 0.0
        {
            let turns = (depth / slope.tan() / length).ceil().clamp(1.0, MAX_TURNS);
            let fall = depth / (turns * length);
            let mut z = self.from_z;
            for _ in 0..turns as usize {
                for pair in around.windows(2) {
                    z -= fall * plan_distance(pair[0], pair[1]);
                    descent.push(pair[1].with_z(z));
                }
            }
        }
        descent.push(first.with_z(self.z));
        let least = std::iter::once(first).chain(around[1..].iter().copied().cycle());
        for (tip, least) in descent.iter_mut().zip(least) {
            tip.z = tip.z.max(least.z);
        }
        if self.free_z > self.from_z {
            descent.insert(0, first.with_z(self.free_z));
        }
        without_needless(&descent)
    }
}

/// Without points that lie on the line between those around them.
fn without_needless(points: &[DVec3]) -> Vec<DVec3> {
    /// Far below what a machine resolves.
    const ON_LINE_MM: f64 = 1e-6;
    let mut kept: Vec<DVec3> = Vec::new();
    for (k, point) in points.iter().enumerate() {
        if let (Some(before), Some(after)) = (kept.last(), points.get(k + 1)) {
            let (way, whole) = (point - before, after - before);
            let share = way.dot(whole) / whole.length_squared();
            // NaN, where both ends are one, is not on it.
            let on_it = (0.0..=1.0).contains(&share);
            if on_it && way.distance(whole * share) <= ON_LINE_MM {
                continue;
            }
        }
        kept.push(*point);
    }
    kept
}

fn plan_distance(a: DVec3, b: DVec3) -> f64 {
    a.truncate().distance(b.truncate())
}

//! From crossings to an outline that is true to a tolerance.
//!
//! Places are tested for all outlines of a height together: the drop cutter works on many at once.
//!
//! A chord of an outline holds if its quarters and its middle are free and the outline does not bulge
//! away from it there by more than the tolerance. If not, the place of the outline beside its middle
//! becomes a corner.

use super::ground::Ground;
use super::{Corner, Outline};
use crate::Tick;
use crate::trace::Crossing;
use glam::DVec2;

/// Chords are divided at most this often: into a 256th of the grid's pitch.
const ROUNDS: usize = 8;

/// An outline is looked for this far beside a chord, in pitches.
const BESIDE: [f64; 3] = [0.25, 0.5, 1.0];

pub(super) fn refine(
    ground: &Ground<'_>,
    traced: &[Vec<Crossing>],
    z: f64,
    tolerance_mm: f64,
    tick: Tick,
) -> Option<Vec<Outline>> {
    let search = Search { ground, z, tolerance_mm };
    let crossings: Vec<Crossing> = traced.iter().flatten().copied().collect();
    let mut corners = search.corners(&crossings)?.into_iter();
    let mut lines: Vec<Line> =
        traced.iter().map(|line| Line::new(corners.by_ref().take(line.len()))).collect();
    for _ in 0..ROUNDS {
        tick(0).then_some(())?;
        let open: Vec<[Corner; 2]> = lines.iter().flat_map(Line::open).collect();
        if open.is_empty() {
            break;
        }
        let mut found = search.between(&open)?.into_iter();
        lines.iter_mut().for_each(|line| line.divide(&mut found));
    }
    let outlines = lines.into_iter().map(Line::into_outline);
    Some(outlines.filter(|outline| outline.corners.len() > 2).collect())
}

/// An outline in the making: corners, and whether the chord from each to the next still is to be
/// looked at.
struct Line {
    corners: Vec<(Corner, bool)>,
}

impl Line {
    fn new(corners: impl Iterator<Item = Corner>) -> Self {
        let mut corners: Vec<(Corner, bool)> = corners.map(|corner| (corner, true)).collect();
        // At the corners of the area two crossings are one.
        corners.dedup_by_key(|(corner, _)| corner.at);
        while corners.len() > 1 && corners[0].0.at == corners[corners.len() - 1].0.at {
            corners.pop();
        }
        let count = corners.len();
        for k in 0..count {
            // Along the border it is straight.
            corners[k].1 = !(corners[k].0.border && corners[(k + 1) % count].0.border);
        }
        Self { corners }
    }

    fn chords(&self) -> impl Iterator<Item = ([Corner; 2], bool)> {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|((a, open), (b, _))| ([*a, *b], *open))
    }

    fn open(&self) -> impl Iterator<Item = [Corner; 2]> {
        self.chords().filter(|(_, open)| *open).map(|(chord, _)| chord)
    }

    /// Puts the next of the corners found into each chord that is open, or closes it.
    fn divide(&mut self, found: &mut impl Iterator<Item = Option<DVec2>>) {
        let mut divided = Vec::with_capacity(self.corners.len());
        for &(corner, open) in &self.corners {
            let between = if open { found.next().flatten() } else { None };
            divided.push((corner, between.is_some()));
            divided.extend(between.map(|at| (Corner { at, border: false }, true)));
        }
        self.corners = divided;
    }

    /// Without corners that lie on a line along the border.
    fn into_outline(self) -> Outline {
        let corners: Vec<Corner> = self.corners.into_iter().map(|(corner, _)| corner).collect();
        let count = corners.len();
        let needless = |k: usize| {
            let [a, b, c] = [(k + count - 1) % count, k, (k + 1) % count].map(|k| corners[k]);
            let straight = (b.at - a.at).perp_dot(c.at - b.at) == 0.0;
            a.border && b.border && c.border && straight
        };
        Outline { corners: (0..count).filter(|k| !needless(*k)).map(|k| corners[k]).collect() }
    }
}

struct Search<'a> {
    ground: &'a Ground<'a>,
    z: f64,
    tolerance_mm: f64,
}

impl Search<'_> {
    fn free(&self, places: &[DVec2]) -> Option<Vec<bool>> {
        self.ground.are_free(places, self.z)
    }

    /// Halves ways from a free place to one that is not until they are shorter than the tolerance;
    /// the free ends.
    fn halve(&self, mut ways: Vec<[DVec2; 2]>) -> Option<Vec<DVec2>> {
        let longest = ways.iter().map(|[a, b]| a.distance(*b)).fold(0.0, f64::max);
        let halvings = (longest / self.tolerance_mm).log2().ceil().clamp(0.0, 40.0) as usize;
        for _ in 0..halvings {
            let middles: Vec<DVec2> = ways.iter().map(|[a, b]| a.midpoint(*b)).collect();
            for ((way, middle), free) in ways.iter_mut().zip(&middles).zip(self.free(&middles)?) {
                way[usize::from(!free)] = *middle;
            }
        }
        Some(ways.into_iter().map(|[free, _]| free).collect())
    }

    fn corners(&self, crossings: &[Crossing]) -> Option<Vec<Corner>> {
        let ways = crossings.iter().map(|crossing| {
            let free = self.ground.place(crossing.inside);
            [free, crossing.outside.map_or(free, |node| self.ground.place(node))]
        });
        let at = self.halve(ways.collect())?;
        let corner = |(crossing, at): (&Crossing, DVec2)| {
            let border = crossing.outside.is_none();
            Corner { at, border }
        };
        Some(crossings.iter().zip(at).map(corner).collect())
    }

    /// For each chord that does not hold, the place where it is to be divided.
    fn between(&self, chords: &[[Corner; 2]]) -> Option<Vec<Option<DVec2>>> {
        let step_mm = self.ground.pitch_mm();
        let probes: Vec<DVec2> = chords
            .iter()
            .flat_map(|[a, b]| {
                let middle = a.at.midpoint(b.at);
                let bulged = middle + away(a.at, b.at) * self.tolerance_mm;
                [middle, a.at.lerp(b.at, 0.25), a.at.lerp(b.at, 0.75), bulged]
            })
            .collect();
        let free = self.free(&probes)?;
        let mut found = vec![None; chords.len()];
        // Which chords are to be divided, from where, and towards where.
        let mut sought: Vec<(usize, DVec2, DVec2)> = Vec::new();
        for (k, [a, b]) in chords.iter().enumerate() {
            let [middle, first, last, bulged] = [0, 1, 2, 3].map(|probe| free[4 * k + probe]);
            if a.at.distance(b.at) <= 2.0 * self.tolerance_mm {
                continue;
            }
            let (at, away) = (probes[4 * k], away(a.at, b.at) * step_mm);
            match (middle, first && last, bulged) {
                (true, true, false) => {}
                (true, true, true) => sought.push((k, at, away)),
                (true, false, _) => found[k] = Some(at),
                (false, _, _) => sought.push((k, at, -away)),
            }
        }
        let mut ways = Vec::new();
        let mut of = Vec::new();
        for beside in BESIDE {
            let places: Vec<DVec2> =
                sought.iter().map(|(_, at, away)| at + *away * beside).collect();
            let free = self.free(&places)?;
            let mut still = Vec::new();
            for ((sought, place), free) in sought.into_iter().zip(places).zip(free) {
                let (k, at, away) = sought;
                let outward = away.dot(away_of(chords[k])) > 0.0;
                match (outward, free) {
                    (true, false) => ways.push([at, place]),
                    (false, true) => ways.push([place, at]),
                    _ => {
                        still.push(sought);
                        continue;
                    }
                }
                of.push(k);
            }
            sought = still;
        }
        for (k, at) in of.into_iter().zip(self.halve(ways)?) {
            found[k] = Some(at);
        }
        Some(found)
    }
}

/// The direction from a chord away from what is free.
fn away(a: DVec2, b: DVec2) -> DVec2 {
    -(b - a).perp().normalize_or_zero()
}

fn away_of([a, b]: [Corner; 2]) -> DVec2 {
    away(a.at, b.at)
}

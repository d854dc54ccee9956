//! Passes parallel to the outlines of a region, each a stepover s inside the last.
//!
//! The first runs along the outlines and around the holes, each further one s inside ([`offset`] of
//! the last by -s), while there is room. Rings fall apart where the region is narrow; each part is
//! finished before the next. Where the inside of a ring holds no further one, or this one does not come
//! near a sharp corner of it, passes along the middle line are added ([`super::remnant`]).
//!
//! A ring whose two sides would run less than s/8 from each other is left out for its middle line too.
//!
//! So every place of the region is within s/2 of a pass, but in corners: where the outer ring turns by
//! an angle of α inside, it is up to s/(1 + sin(α/2)), for a right angle 0.59 s, and corners sharper
//! than 84° have a pass along their middle. Hence no place is more than 0.6 s off, and 0.64 s next to a
//! ring that was left out; chords and the corners that are taken out of rings add 0.01 s.
//!
//! Limits: where a ring is thinner than that in a part only, it is passed on both sides there.
//!
//! Around holes passes go the other way round than along outlines, so that the side on which material
//! still stands is the same for all.
//!
//! [`offset`]: crate::offset

use super::even::{along, parts};
use super::layer::MERGE_MM;
use super::remnant::remnants;
use super::{Layer, Layout, Pace, Pattern, Region, Start, Turn};
use crate::Polygon;
use crate::polygon::{nearest_on, offset_clean};
use glam::DVec2;
use rayon::prelude::*;

/// How far a ring may lie off the exact one, as a share of the stepover. What is left between passes
/// goes with the square of their distance: half a percent of it is one percent of that.
pub(super) const RING_SHARE: f64 = 0.005;

/// A ring that is nowhere deeper than that, as a share of the stepover, is left out.
pub(super) const THIN_SHARE: f64 = 1.0 / 16.0;

/// Rings parallel to the outlines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourParallel {
    /// Distances between rings and between points.
    pub pace: Pace,
    /// Which ring comes first.
    pub start: Start,
    /// Which way round outlines are passed; holes are passed the other way.
    pub turn: Turn,
}

impl Layout for ContourParallel {
    fn count(&self, region: &Region) -> f64 {
        if !self.pace.is_sound() {
            return f64::INFINITY;
        }
        let Pace { stepover_mm, feed_step_mm } = self.pace;
        let outlines = region.outlines();
        let edges = outlines.iter().flat_map(|corners| corners.windows(2));
        let border_mm: f64 = edges.map(|edge| edge[0].distance(edge[1])).sum();
        let corners: usize = outlines.iter().map(Vec::len).sum();
        // A band as wide as the stepover beside every pass fills the region. Rings of an intricate
        // region have corners of their own, some a stepover.
        let size = region.size();
        let length_mm = border_mm + size.x * size.y / stepover_mm;
        parts(length_mm, feed_step_mm.min(stepover_mm)) + corners as f64
    }

    fn pattern(&self, region: &Region) -> Pattern {
        let mut layer = match Layer::new(region, self.pace) {
            Ok(layer) => layer,
            Err(pattern) => return pattern,
        };
        let rings = rings(region, self.pace.stepover_mm);
        let middle_lines: Vec<Vec<Vec<Vec<DVec2>>>> =
            rings.par_iter().map(|ring| remnants(&ring.polygon, self.pace.stepover_mm)).collect();
        for (ring, k) in in_order(&rings) {
            layer.add_whole(self.passed(self.closed(&rings[ring].polygon.loops()[k])));
            for line in &middle_lines[ring][k] {
                layer.add_whole(self.passed(line.clone()));
            }
        }
        layer.into_pattern(self.start == Start::Middle)
    }
}

impl ContourParallel {
    /// A loop as a line that ends where it begins, in the direction wanted.
    fn closed(&self, corners: &[DVec2]) -> Vec<DVec2> {
        let far = |corner: &&DVec2| corner.distance(corners[0]) > MERGE_MM;
        let last = corners.iter().rposition(|corner| far(&corner)).unwrap_or(0);
        let mut closed: Vec<DVec2> = corners[..=last].to_vec();
        closed.push(corners[0]);
        // Drawn from outside; from the middle passes are passed backwards.
        if (self.turn == Turn::Clockwise) != (self.start == Start::Middle) {
            closed.reverse();
        }
        closed
    }

    /// The points of a pass.
    fn passed(&self, mut line: Vec<DVec2>) -> Vec<DVec2> {
        line.dedup_by(|next, corner| next.distance(*corner) <= MERGE_MM);
        along(&line, self.pace.feed_step_mm).collect()
    }
}

/// A clean connected polygon within the last ring.
struct Ring {
    polygon: Polygon,
    /// The ring around it and, for each of its loops, which one of that ring it is beside.
    outer: Option<(usize, Vec<usize>)>,
}

/// The rings of a region, each after the one around it.
fn rings(region: &Region, stepover_mm: f64) -> Vec<Ring> {
    let tolerance_mm = RING_SHARE * stepover_mm;
    let mut rings: Vec<Ring> = Vec::new();
    let whole = region.polygon().map_or_else(Vec::new, Polygon::split);
    let mut open: Vec<(Option<usize>, Polygon)> =
        whole.into_iter().rev().map(|part| (None, part)).collect();
    while let Some((outer, mut polygon)) = open.pop() {
        let outer = outer.map(|outer| (outer, begin_beside(&mut polygon, &rings[outer].polygon)));
        let inner = offset_clean(polygon.clone(), -stepover_mm, tolerance_mm);
        let mut inner = inner.map_or_else(Vec::new, Polygon::split);
        inner.retain(|ring| !is_thin(ring, stepover_mm));
        let here = rings.len();
        rings.push(Ring { polygon, outer });
        open.extend(inner.into_iter().rev().map(|part| (Some(here), part)));
    }
    rings
}

/// Loops as ring and number in it: after each those beside it, and theirs, before any other. So an
/// outline is followed to the middle, and then a hole, not both in turn.
fn in_order(rings: &[Ring]) -> Vec<(usize, usize)> {
    let mut inner: Vec<Vec<Vec<(usize, usize)>>> =
        rings.iter().map(|ring| vec![Vec::new(); ring.polygon.loops().len()]).collect();
    let mut open = Vec::new();
    for (number, ring) in rings.iter().enumerate().rev() {
        for k in (0..ring.polygon.loops().len()).rev() {
            match &ring.outer {
                Some((outer, beside)) => inner[*outer][beside[k]].push((number, k)),
                None => open.push((number, k)),
            }
        }
    }
    let mut order = Vec::new();
    while let Some((ring, k)) = open.pop() {
        order.push((ring, k));
        open.append(&mut inner[ring][k]);
    }
    order
}

/// Whether no place in a ring is deep.
fn is_thin(ring: &Polygon, stepover_mm: f64) -> bool {
    let depth_mm = THIN_SHARE * stepover_mm;
    let length_mm: f64 = ring.edges().map(|[a, b]| a.distance(b)).sum();
    // What has more area than a band along all of its length is that deep somewhere.
    ring.area_mm2() < depth_mm * length_mm
        && offset_clean(ring.clone(), -depth_mm, RING_SHARE * stepover_mm).is_none()
}

/// Lets each loop of a ring begin near where one of the ring around it begins, and so ends: the cutter
/// goes from ring to ring by the shortest way. Which ones those are.
fn begin_beside(ring: &mut Polygon, outer: &Polygon) -> Vec<usize> {
    let nearest = |from: DVec2, places: &[DVec2]| {
        let off = |k: &usize| from.distance_squared(places[*k]);
        (0..places.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
    };
    let beside: Vec<usize> =
        ring.loops().iter().map(|corners| loop_beside(corners, outer)).collect();
    let mut starts = beside.iter().map(|k| outer.loops()[*k][0]);
    ring.begin_loops(|corners| starts.next().map_or(0, |start| nearest(start, corners)));
    beside
}

/// The loop of a ring that comes nearest to one of its corners: that of which these corners, a stepover
/// inside, are a part.
fn loop_beside(corners: &[DVec2], outer: &Polygon) -> usize {
    let off = |others: &Vec<DVec2>| {
        let next = others.iter().cycle().skip(1);
        let off = others.iter().zip(next).map(|(a, b)| nearest_on(corners[0], *a, *b).0);
        off.map(|at| at.distance_squared(corners[0])).fold(f64::INFINITY, f64::min)
    };
    match outer.loops() {
        [_] => 0,
        loops => {
            (0..loops.len()).min_by(|a, b| off(&loops[*a]).total_cmp(&off(&loops[*b]))).unwrap_or(0)
        }
    }
}

//! Where passes may run: a rectangle and, if there is one, the inside of a boundary in it.
//!
//! Inside is what an odd number of loops surround (even-odd rule); the border itself belongs to the
//! region. A straight line is cut where it crosses an edge; of the parts in between, those whose
//! middle is inside are kept. Edges are sorted into bands of y, so that a short line meets few.

use crate::{Bounds, Polygon};
use glam::DVec2;
use std::ops::RangeInclusive;

/// A place this close to an edge, in mm, is on it. Coordinates of 10 m are exact to 2e-12 mm, and
/// no program tells 1e-7 mm apart.
const EDGE_SLACK_MM: f64 = 1e-9;

/// More bands serve no outline, and each takes 24 bytes.
const MAX_BANDS: usize = 4096;

/// Where passes may run.
#[derive(Clone, Debug)]
pub struct Region {
    /// The box that holds it.
    bounds: Bounds,
    boundary: Option<Boundary>,
}

#[derive(Clone, Debug)]
struct Boundary {
    polygon: Polygon,
    /// The area's rectangle before it was cut down to the polygon's.
    area: (DVec2, DVec2),
    edges: Bands,
}

impl Region {
    /// All of the XY rectangle of `area`; `None` if a corner is not finite or lies before the other.
    #[must_use]
    pub fn new(area: &Bounds) -> Option<Self> {
        let (min, max) = (area.min.truncate(), area.max.truncate());
        let sound = (max - min).is_finite() && min.is_finite() && min.cmple(max).all();
        sound.then_some(Self { bounds: *area, boundary: None })
    }

    /// What of it lies inside `polygon`; `None` if their boxes do not meet.
    #[must_use]
    pub fn within(self, polygon: Polygon) -> Option<Self> {
        let area = (self.min(), self.max());
        let (least, most) = polygon.extent();
        let (min, max) = (area.0.max(least), area.1.min(most));
        let bounds =
            Bounds { min: min.extend(self.bounds.min.z), max: max.extend(self.bounds.max.z) };
        let edges = Bands::new(&polygon);
        let boundary = Some(Boundary { polygon, area, edges });
        min.cmple(max).all().then_some(Self { bounds, boundary })
    }

    /// The box that holds the region.
    #[must_use]
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Whether it is less than its box.
    #[must_use]
    pub fn has_boundary(&self) -> bool {
        self.boundary.is_some()
    }

    pub(crate) fn min(&self) -> DVec2 {
        self.bounds.min.truncate()
    }

    pub(crate) fn max(&self) -> DVec2 {
        self.bounds.max.truncate()
    }

    pub(crate) fn size(&self) -> DVec2 {
        self.max() - self.min()
    }

    pub(crate) fn center(&self) -> DVec2 {
        self.bounds.center().truncate()
    }

    /// From the middle to a corner of the box, in mm.
    pub(crate) fn reach_mm(&self) -> f64 {
        self.size().length() / 2.0
    }

    /// Whether a place is in it; its border is.
    #[must_use]
    pub fn contains(&self, place: DVec2) -> bool {
        let in_box = place.cmpge(self.min() - EDGE_SLACK_MM).all()
            && place.cmple(self.max() + EDGE_SLACK_MM).all();
        in_box && self.boundary.as_ref().is_none_or(|boundary| boundary.edges.contain(place))
    }

    /// The parts of the line from `a` to `b` in it, as shares of its length, in order, apart.
    pub(crate) fn inside(&self, a: DVec2, b: DVec2) -> Vec<(f64, f64)> {
        // Points along the border may lie beside it by a rounding.
        let (min, max) = (self.min() - EDGE_SLACK_MM, self.max() + EDGE_SLACK_MM);
        let Some(part) = clip(a, b, min, max) else { return Vec::new() };
        match &self.boundary {
            None => vec![part],
            Some(boundary) => boundary.edges.inside(a, b, part),
        }
    }

    /// Whether all of the line from `a` to `b` is in it.
    pub(crate) fn holds(&self, a: DVec2, b: DVec2) -> bool {
        let slack = EDGE_SLACK_MM / a.distance(b).max(EDGE_SLACK_MM);
        let inside: f64 = self.inside(a, b).iter().map(|(from, to)| to - from).sum();
        inside >= 1.0 - 2.0 * slack
    }

    /// Its inside as a polygon: clean, but for the rectangle, which begins at its least corner. `None`
    /// if it has no inside.
    pub(crate) fn polygon(&self) -> Option<Polygon> {
        let Some(Boundary { polygon, area, .. }) = &self.boundary else {
            return Polygon::rectangle(self.min(), self.max()).ok();
        };
        polygon.and(&Polygon::rectangle(area.0, area.1).ok()?)
    }

    /// The lines that bound it, as corners; closed lines end where they begin. Where an edge of the
    /// polygon lies on the rectangle, it is told once.
    pub(crate) fn outlines(&self) -> Vec<Vec<DVec2>> {
        let Some(Boundary { polygon, area, edges }) = &self.boundary else {
            return vec![rectangle(self.min(), self.max())];
        };
        let loops = polygon.loops().iter().map(|corners| {
            let mut closed = corners.clone();
            closed.extend(corners.first());
            closed
        });
        let sides = rectangle(area.0, area.1);
        let sides = sides.windows(2).flat_map(|side| {
            let [a, b] = [side[0], side[1]];
            edges
                .inside(a, b, (0.0, 1.0))
                .into_iter()
                .map(move |(from, to)| [a.lerp(b, from), a.lerp(b, to)])
        });
        let free = sides.filter(|[a, b]| a != b && !edges.is_on_edge(a.midpoint(*b)));
        loops.chain(free.map(Vec::from)).collect()
    }
}

/// A rectangle's corners, counter-clockwise from the least, which stands at both ends.
pub(crate) fn rectangle(min: DVec2, max: DVec2) -> Vec<DVec2> {
    vec![min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y), min]
}

/// The part of a line in a rectangle (Liang and Barsky 1984), as shares of its length.
fn clip(a: DVec2, b: DVec2, min: DVec2, max: DVec2) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (from, along) = (a[axis], b[axis] - a[axis]);
        if along == 0.0 {
            if from < min[axis] || from > max[axis] {
                return None;
            }
            continue;
        }
        let (s, t) = ((min[axis] - from) / along, (max[axis] - from) / along);
        enter = enter.max(s.min(t));
        leave = leave.min(s.max(t));
    }
    (enter <= leave).then_some((enter, leave))
}

/// Edges by the bands of y that they touch.
#[derive(Clone, Debug)]
struct Bands {
    bottom: f64,
    per_mm: f64,
    bands: Vec<Vec<[DVec2; 2]>>,
}

impl Bands {
    fn new(polygon: &Polygon) -> Self {
        let (least, most) = polygon.extent();
        let count = polygon.edges().count().clamp(1, MAX_BANDS);
        let height = most.y - least.y;
        let per_mm = if height > 0.0 { count as f64 / height } else { 0.0 };
        let mut sorted = Self { bottom: least.y, per_mm, bands: vec![Vec::new(); count] };
        for edge in polygon.edges() {
            for band in sorted.touched(edge[0].y, edge[1].y) {
                sorted.bands[band].push(edge);
            }
        }
        sorted
    }

    fn band(&self, y: f64) -> usize {
        (((y - self.bottom) * self.per_mm).max(0.0) as usize).min(self.bands.len() - 1)
    }

    /// The bands between two heights, a little more rather than less.
    fn touched(&self, y: f64, other: f64) -> RangeInclusive<usize> {
        self.band(y.min(other) - EDGE_SLACK_MM)..=self.band(y.max(other) + EDGE_SLACK_MM)
    }

    fn near(&self, y: f64, other: f64) -> impl Iterator<Item = &[DVec2; 2]> {
        self.bands[self.touched(y, other)].iter().flatten()
    }

    /// Even-odd, by the crossings of a ray towards +X; the lower end of an edge belongs to it, the
    /// upper one does not, so that a corner counts once.
    fn contain(&self, place: DVec2) -> bool {
        let crossings = self.bands[self.band(place.y)].iter().filter(|[a, b]| {
            let across = (a.y <= place.y) != (b.y <= place.y);
            across && place.x < a.x + (place.y - a.y) / (b.y - a.y) * (b.x - a.x)
        });
        crossings.count() % 2 == 1 || self.is_on_edge(place)
    }

    fn is_on_edge(&self, place: DVec2) -> bool {
        self.near(place.y, place.y).any(|[a, b]| {
            let along = *b - *a;
            let share = (place - *a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
            place.distance(*a + along * share.clamp(0.0, 1.0)) <= EDGE_SLACK_MM
        })
    }

    /// The shares of the line from `a` to `b`, of those from `from` to `to`, that are inside.
    fn inside(&self, a: DVec2, b: DVec2, (from, to): (f64, f64)) -> Vec<(f64, f64)> {
        let (start, end) = (a.lerp(b, from), a.lerp(b, to));
        if start == end {
            return if self.contain(start) { vec![(from, to)] } else { Vec::new() };
        }
        let mut cuts: Vec<f64> =
            self.near(start.y, end.y).flat_map(|edge| crossing(a, b, edge)).collect();
        cuts.retain(|t| *t > from && *t < to);
        cuts.extend([from, to]);
        cuts.sort_by(f64::total_cmp);
        let mut parts: Vec<(f64, f64)> = Vec::new();
        for pair in cuts.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            if from == to || !self.contain(a.lerp(b, f64::midpoint(from, to))) {
                continue;
            }
            match parts.last_mut() {
                Some(last) if last.1 == from => last.1 = to,
                _ => parts.push((from, to)),
            }
        }
        parts
    }
}

/// Where the line from `a` to `b` may change sides at an edge, as shares of its length: where it
/// crosses it, or at both ends of an edge that lies along it.
fn crossing(a: DVec2, b: DVec2, [p, q]: &[DVec2; 2]) -> Vec<f64> {
    let (line, edge) = (b - a, *q - *p);
    let square = line.length_squared();
    let ends = || vec![(*p - a).dot(line) / square, (*q - a).dot(line) / square];
    let across = line.perp_dot(edge);
    if across.abs() <= 1e-12 * line.length() * edge.length() {
        return ends();
    }
    let share = (*p - a).perp_dot(line) / across;
    let slack = EDGE_SLACK_MM / edge.length();
    if (-slack..=1.0 + slack).contains(&share) {
        vec![(*p - a).perp_dot(edge) / across]
    } else {
        Vec::new()
    }
}

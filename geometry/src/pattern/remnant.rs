//! What rings leave: passes along the middle line (medial axis) of a ring, where the next ring inside
//! it is missing or far.
//!
//! The middle line is where the largest disc that touches the ring and lies inside it touches it twice
//! or more. Such discs are found from one side: for a place p of the ring and the normal n that points
//! inside, the radius is the largest r for which nothing of the ring lies in the disc about p + r·n.
//! It is shrunk until that is so: a place q in it leaves r = |q - p|² / 2n·(q - p) at most (Ma, Bae and
//! Choi, "3D medial axis point approximation using nearest neighbors and the normal field", The Visual
//! Computer 28(1), 2012). Only radii between s/2 and about s matter (s the stepover): nearer places are reached
//! from the ring, and from s on there is the next ring. And only discs which the ring touches from
//! different sides, at angles of 96° or more: then a place p deeper than s/2 whose disc is not passed
//! through lies below a stretch of middle line along which depth grows by cos 48° a mm or faster, up to a
//! pass, and so within s/(1 + sin 42°) < 0.6 s of that.
//!
//! Places are tried in order along the ring, so that the centres come as lines. A line would come from
//! both of its sides; it is kept from the side that comes first. Stretches of the ring that do not bend
//! much and have nothing near are passed over: most of a large ring.

use super::contour::{RING_SHARE, THIN_SHARE};
use crate::Polygon;
use crate::polygon::{nearest_on, simplify_line};
use glam::DVec2;
use std::collections::HashMap;
use std::ops::Range;

/// Places that are tried, to the stepover.
const TRIES_PER_STEPOVER: f64 = 4.0;

/// In stepovers, how far the next ring may be and be missing still: it is if it would be thin, and its
/// corners are not exact.
const REACH: f64 = 1.0 + THIN_SHARE + 2.0 * RING_SHARE;

/// What is touched with so much slack, as a share of the stepover, is touched: chords of a circle touch
/// the disc within it all around.
const TOUCH: f64 = 4.0 * RING_SHARE;

/// Length of the stretches of a ring that are tried or passed over as a whole, in stepovers. Between a
/// place and another one on its disc, two stepovers off, the ring is no longer than 2/cos 42° if it bends
/// by less than 84° in between: on either side of a stretch as much again covers that.
const STRETCH: f64 = 8.0;

/// A ring that bends no more touches no disc at places 96° apart or more.
const MOST_BEND_RAD: f64 = 84.0 / 180.0 * std::f64::consts::PI;

/// Two distances of which one is so much less, as a share, are equal.
const ROUNDING: f64 = 1e-9;

/// How often the way to where a line ends is halved: to a thousandth of the distance of two tries.
const HALVINGS: usize = 10;

/// The cosine of the least angle, 96°, at which a disc is touched on different sides.
const APART: f64 = -0.104_528_463_267_653_47;

/// Middle lines that have to be passed besides the loops of a ring and the ring a stepover inside it, by
/// the loops that they are found from.
pub(super) fn remnants(ring: &Polygon, stepover_mm: f64) -> Vec<Vec<Vec<DVec2>>> {
    let walls = Walls::new(ring, stepover_mm);
    let mut first = 0;
    let of_loop = |corners: &Vec<DVec2>| {
        let edges = first..first + corners.len();
        first = edges.end;
        let stations = walls.stations(edges);
        let busy = walls.busy(&stations).into_iter();
        let lines = busy.flat_map(|stretch| walls.middle_lines(&stations[stretch]));
        lines.map(|line| simplify_line(&line, RING_SHARE * stepover_mm)).collect()
    };
    ring.loops().iter().map(of_loop).collect()
}

/// A place of the ring from which the inside is looked at.
#[derive(Clone, Copy)]
struct Station {
    place: DVec2,
    /// Points inside.
    normal: DVec2,
    /// How far along the ring, in edges.
    along: f64,
}

/// The edges of a ring.
struct Walls {
    edges: Vec<[DVec2; 2]>,
    /// The edge that follows each of them in its loop.
    next: Vec<u32>,
    stepover_mm: f64,
    /// As wide as the stepover, to look for what a disc touches.
    near: Squares,
    /// As wide as a stretch.
    wide: Squares,
}

/// Edges by the squares that they touch.
struct Squares {
    width_mm: f64,
    edges: HashMap<[i64; 2], Vec<u32>>,
}

impl Squares {
    fn new(edges: &[[DVec2; 2]], width_mm: f64) -> Self {
        let mut squares = Self { width_mm, edges: HashMap::new() };
        for (k, [a, b]) in edges.iter().enumerate() {
            // Pieces no longer than a square is wide touch four squares at most.
            let pieces = (a.distance(*b) / width_mm).ceil().max(1.0);
            let mut from = *a;
            for piece in 1..=pieces as usize {
                let to = a.lerp(*b, piece as f64 / pieces);
                for square in squares.between(from.min(to), from.max(to)) {
                    let here = squares.edges.entry(square).or_default();
                    if here.last() != Some(&(k as u32)) {
                        here.push(k as u32);
                    }
                }
                from = to;
            }
        }
        squares
    }

    fn between(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = [i64; 2]> + use<> {
        let [low, high] = [low, high].map(|place| (place / self.width_mm).floor());
        let columns = low.x as i64..=high.x as i64;
        columns.flat_map(move |x| (low.y as i64..=high.y as i64).map(move |y| [x, y]))
    }

    /// The edges that may meet a rectangle, some more than once.
    fn meeting(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = u32> {
        self.between(low, high).filter_map(|square| self.edges.get(&square)).flatten().copied()
    }
}

impl Walls {
    fn new(ring: &Polygon, stepover_mm: f64) -> Self {
        let edges: Vec<[DVec2; 2]> = ring.edges().collect();
        let mut next: Vec<u32> = (1..=edges.len() as u32).collect();
        let mut first = 0;
        for corners in ring.loops() {
            next[first + corners.len() - 1] = first as u32;
            first += corners.len();
        }
        let near = Squares::new(&edges, stepover_mm);
        let wide = Squares::new(&edges, STRETCH * stepover_mm);
        Self { edges, next, stepover_mm, near, wide }
    }

    /// The places of edges nearest to another place, no farther than `radius`: place, distance, and how
    /// far along the ring.
    fn near(&self, place: DVec2, radius: f64) -> impl Iterator<Item = (DVec2, f64, f64)> {
        self.near.meeting(place - radius, place + radius).filter_map(move |k| {
            let [a, b] = self.edges[k as usize];
            let (at, share) = nearest_on(place, a, b);
            let distance = at.distance(place);
            // The end of an edge is the beginning of the next.
            let along = f64::from(if share < 1.0 { k } else { self.next[k as usize] });
            let along = if share < 1.0 { along + share } else { along };
            (distance <= radius).then_some((at, distance, along))
        })
    }

    /// The stretches of stations of a loop that have to be tried, neighbours in one.
    fn busy(&self, stations: &[Station]) -> Vec<Range<usize>> {
        let mut busy: Vec<Range<usize>> = Vec::new();
        let mut from = 0;
        while from < stations.len() {
            let to = from + self.reach(stations[from..].iter());
            if !self.is_quiet(stations, from..to) {
                match busy.last_mut() {
                    Some(last) if last.end == from => last.end = to,
                    _ => busy.push(from..to),
                }
            }
            from = to;
        }
        busy
    }

    /// How many stations, from the first of some, lie on a stretch.
    fn reach<'a>(&self, stations: impl Iterator<Item = &'a Station>) -> usize {
        let (mut gone_mm, mut last) = (0.0, None);
        let gone = |station: &Station| {
            gone_mm += last.map_or(0.0, |last: DVec2| last.distance(station.place));
            last = Some(station.place);
            gone_mm
        };
        stations.map(gone).take_while(|gone| *gone <= STRETCH * self.stepover_mm).count()
    }

    /// Whether no disc of a stretch can be touched on different sides. On the stretch and its
    /// surroundings the ring bends by less than the angle wanted, so that these alone do not touch a disc
    /// so; and of all else nothing comes near.
    fn is_quiet(&self, stations: &[Station], stretch: Range<usize>) -> bool {
        let count = stations.len();
        let round = |from: usize| stations[from..].iter().chain(&stations[..from]);
        let after = self.reach(round(stretch.end % count));
        let before = self.reach(round(stretch.start).rev());
        let own_count = before + stretch.len() + after;
        if own_count >= count {
            return false;
        }
        let own = round((stretch.start + count - before) % count).take(own_count);
        let mut edges: Vec<u32> = own.clone().map(|station| station.along as u32).collect();
        edges.dedup();
        edges.sort_unstable();
        let turns = own.clone().zip(own.skip(1)).map(|(a, b)| a.normal.angle_to(b.normal).abs());
        if turns.sum::<f64>() > MOST_BEND_RAD {
            return false;
        }
        let places = stations[stretch].iter().map(|station| station.place);
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = places.fold(start, |(low, high), p| (low.min(p), high.max(p)));
        let reach_mm = 2.0 * (REACH + TOUCH) * self.stepover_mm;
        let (low, high) = (low - reach_mm, high + reach_mm);
        self.wide.meeting(low, high).all(|k| {
            let [a, b] = self.edges[k as usize];
            let is_far = a.max(b).cmplt(low).any() || a.min(b).cmpgt(high).any();
            is_far || edges.binary_search(&k).is_ok()
        })
    }

    /// Places along a loop, which `edges` make up, and around its inner corners.
    fn stations(&self, edges: Range<usize>) -> Vec<Station> {
        let step_mm = self.stepover_mm / TRIES_PER_STEPOVER;
        let mut stations: Vec<Station> = Vec::new();
        for k in edges.clone() {
            let [a, b] = self.edges[k];
            let normal = (b - a).perp().normalize_or_zero();
            let before = self.edges[if k == edges.start { edges.end - 1 } else { k - 1 }];
            let last = (before[1] - before[0]).perp().normalize_or_zero();
            // Where the ring turns away from its inside, the normals between belong to the corner.
            let turn = last.angle_to(normal);
            if turn < 0.0 {
                let parts = (-turn * TRIES_PER_STEPOVER).ceil();
                stations.extend((0..=parts as usize).map(|i| {
                    let normal = DVec2::from_angle(turn * i as f64 / parts).rotate(last);
                    Station { place: a, normal, along: k as f64 }
                }));
            }
            let parts = (a.distance(b) / step_mm).ceil().max(1.0);
            let shares = if parts == 1.0 { vec![0.5] } else { even_shares(parts) };
            stations.extend(shares.into_iter().map(|share| Station {
                place: a.lerp(b, share),
                normal,
                along: k as f64 + share,
            }));
        }
        stations
    }

    /// The lines that the discs of stations have their centres on.
    fn middle_lines(&self, stations: &[Station]) -> Vec<Vec<DVec2>> {
        let centers: Vec<Option<DVec2>> =
            stations.iter().map(|station| self.center(station)).collect();
        let mut lines: Vec<Vec<DVec2>> = vec![Vec::new()];
        for (k, center) in centers.iter().enumerate() {
            let held_before = k > 0 && centers[k - 1].is_some();
            match center {
                Some(center) => {
                    if k > 0 && !held_before {
                        let end = self.end_between(&stations[k], &stations[k - 1]);
                        self.lengthen(&mut lines, end);
                    }
                    self.lengthen(&mut lines, Some(*center));
                }
                None if held_before => {
                    let end = self.end_between(&stations[k - 1], &stations[k]);
                    self.lengthen(&mut lines, end);
                    lines.push(Vec::new());
                }
                None => {}
            }
        }
        lines.retain(|line| !line.is_empty());
        lines
    }

    /// Goes on to a centre, in a new line if it is far: what lies between two that are near lies in their
    /// discs.
    fn lengthen(&self, lines: &mut Vec<Vec<DVec2>>, center: Option<DVec2>) {
        let Some(center) = center else { return };
        match lines.last_mut() {
            Some(line) if line.last().is_none_or(|p| p.distance(center) < self.stepover_mm) => {
                line.push(center);
            }
            _ => lines.push(vec![center]),
        }
    }

    /// The last centre on the way from a station that has one to a neighbour that has none, if the way
    /// is straight.
    fn end_between(&self, held: &Station, lost: &Station) -> Option<DVec2> {
        if held.place != lost.place && held.normal != lost.normal {
            return None;
        }
        let (mut held, mut lost, mut end) = (*held, *lost, None);
        for _ in 0..HALVINGS {
            let middle = Station {
                place: held.place.midpoint(lost.place),
                normal: (held.normal + lost.normal).normalize_or_zero(),
                along: f64::midpoint(held.along, lost.along),
            };
            match self.center(&middle) {
                Some(center) => (held, end) = (middle, Some(center)),
                None => lost = middle,
            }
        }
        end
    }

    /// The centre of the largest disc that touches a station, if it has to be passed through and is not
    /// found from another place that it touches.
    fn center(&self, Station { place, normal, along }: &Station) -> Option<DVec2> {
        let mut radius = REACH * self.stepover_mm;
        let mut is_free = true;
        loop {
            let center = place + normal * radius;
            let nearest = self.near(center, radius).min_by(|a, b| a.1.total_cmp(&b.1));
            let (touched, distance, _) = nearest?;
            if distance >= radius * (1.0 - ROUNDING) {
                break;
            }
            is_free = false;
            let way = touched - place;
            let smaller = way.length_squared() / (2.0 * normal.dot(way));
            // Not so for a place that rounding has put behind its own edge.
            if !(smaller < radius && smaller > self.stepover_mm / 2.0) {
                return None;
            }
            radius = smaller;
        }
        let center = place + normal * radius;
        let cosine = |at: DVec2| (at - center).normalize_or_zero().dot(-*normal);
        let touched = self.near(center, radius + TOUCH * self.stepover_mm);
        let (across, other) = touched
            .map(|(at, _, along)| (cosine(at), along))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)))?;
        (!is_free && across <= APART && *along < other).then_some(center)
    }
}

/// Shares of a whole from 0 to 1, equally far apart.
fn even_shares(parts: f64) -> Vec<f64> {
    (0..=parts as usize).map(|k| k as f64 / parts).collect()
}

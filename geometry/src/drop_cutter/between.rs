//! Points between the cutter locations, where the path of the drop cutter bends.
//!
//! From one location to the next the cutter runs straight, though what it rides over need not: at the
//! edge of a wall a straight move cuts off what lies under it. So the middle of each move is dropped
//! too. Where it lies farther than half of a tolerance from the move it becomes a location, and both
//! parts are tried.
//!
//! A path that bends once within a move is off by no more than twice what it is off at the middle,
//! hence the half. One that bends twice may cross the move there. So where the contact leaps along a move,
//! for the cutter goes from one thing that it touches to another, the quarters are tried as well.
//!
//! The distance is taken in space, not in height. A cutter at a place of the path is then no farther
//! than the tolerance from one that touches, and cuts no deeper than that: along a wall the path falls
//! by any height within the tolerance of the edge. What can still hide between the quarters is small: on
//! soups of triangles, scans and parts the tests allow one and a half tolerances, and a few places in half
//! a million need more than one.

use super::{DropCutter, DropError};
use crate::{Contact, ContactKind, Pattern, PatternSpan, Tick, Toolpath};
use glam::DVec3;

/// Moves that are tried in one go: what is kept of them is small beside the path, and all threads have
/// work.
const AT_ONCE: usize = 1 << 16;

/// How far a move may be off where it is tried, as a share of the tolerance.
const OFF_WHERE_TRIED: f64 = 0.5;

/// A contact that moves farther than this many times the way of the cutter leaps. Rolling over what is
/// hollow it moves farther than the cutter, but not by much unless the hollow is nearly as narrow.
const LEAP: f64 = 2.0;

/// A cutter location.
#[derive(Clone, Copy)]
struct Location {
    tip: DVec3,
    contact: Contact,
}

/// A straight piece of a move.
struct Piece {
    /// The point of the path that the move leads to.
    to: usize,
    /// Which part of the move, as shares of its length.
    part: [f64; 2],
    /// Its ends.
    ends: [Location; 2],
}

impl Piece {
    fn parted(&self, share: f64, at: Location) -> [Self; 2] {
        let Self { to, part: [low, high], ends: [from, end] } = *self;
        let place = self.place(share);
        [
            Self { to, part: [low, place], ends: [from, at] },
            Self { to, part: [place, high], ends: [at, end] },
        ]
    }

    /// Where a share of it is, as a share of the move.
    fn place(&self, share: f64) -> f64 {
        self.part[0] + share * (self.part[1] - self.part[0])
    }

    /// Its length in plan, in mm.
    fn way_mm(&self) -> f64 {
        let [from, end] = self.ends;
        from.tip.truncate().distance(end.tip.truncate())
    }

    fn leaps(&self) -> bool {
        let [from, end] = self.ends.map(|end| end.contact);
        match (from.kind, end.kind) {
            (ContactKind::None, ContactKind::None) => false,
            (ContactKind::None, _) | (_, ContactKind::None) => true,
            _ => from.point.distance(end.point) > LEAP * self.way_mm(),
        }
    }

    /// How far a tip is from it, in mm.
    fn off_mm(&self, tip: DVec3) -> f64 {
        let [from, end] = self.ends;
        let way = (end.tip - from.tip).normalize_or(DVec3::Z);
        (tip - from.tip).reject_from_normalized(way).length()
    }
}

/// A location that is put in.
struct Between {
    /// The point of the path that it comes before, and how far along the move to it.
    place: (usize, f64),
    location: Location,
}

impl DropCutter<'_> {
    /// Adds cutter locations to a path of this cutter, so that no move is farther than
    /// `tolerance_mm` from the path that the cutter would take. Like the path's, they are not below
    /// `floor_z_mm`.
    ///
    /// `tick` counts points of the path.
    ///
    /// # Errors
    /// If `tick` stopped the work, and where the path would get more than `most` points.
    pub fn bend(
        &self,
        path: &Toolpath,
        floor_z_mm: f64,
        tolerance_mm: f64,
        most: usize,
        tick: Tick,
    ) -> Result<Toolpath, DropError> {
        let mut between = Vec::new();
        let moves: Vec<usize> = path.moves().collect();
        let location = |k: usize| Location { tip: path.tips[k], contact: path.contacts[k] };
        for moves in moves.chunks(AT_ONCE) {
            let whole = |&to: &usize| Piece {
                to,
                part: [0.0, 1.0],
                ends: [location(to - 1), location(to)],
            };
            let mut pieces: Vec<Piece> = moves.iter().map(whole).collect();
            while !pieces.is_empty() {
                // No place of such a piece is farther from its lower end.
                pieces.retain(|piece| piece.way_mm() > tolerance_mm);
                let mut parts = Vec::new();
                for shares in [&[0.5][..], &[0.25, 0.75]] {
                    let found = self.tried(&pieces, shares, floor_z_mm, &|_| tick(0))?;
                    let mut found = found.chunks_exact(shares.len());
                    pieces.retain(|piece| {
                        let found = found.next().unwrap_or_default();
                        let off_mm = |k: &usize| piece.off_mm(found[*k].tip);
                        let farthest =
                            (0..shares.len()).max_by(|a, b| off_mm(a).total_cmp(&off_mm(b)));
                        let far = farthest.filter(|k| off_mm(k) > OFF_WHERE_TRIED * tolerance_mm);
                        if let Some(k) = far {
                            let place = (piece.to, piece.place(shares[k]));
                            between.push(Between { place, location: found[k] });
                            parts.extend(piece.parted(shares[k], found[k]));
                        }
                        far.is_none() && piece.leaps()
                    });
                }
                pieces = parts;
                if path.tips.len() + between.len() > most {
                    return Err(DropError::TooManyBends(most));
                }
            }
            if !tick(moves.len()) {
                return Err(DropError::Stopped);
            }
        }
        between.sort_unstable_by(|a, b| a.place.partial_cmp(&b.place).expect("shares are numbers"));
        Ok(path.with(&between))
    }

    /// The cutter at shares of each piece.
    fn tried(
        &self,
        pieces: &[Piece],
        shares: &[f64],
        floor_z_mm: f64,
        tick: Tick,
    ) -> Result<Vec<Location>, DropError> {
        let places = |piece: &Piece| {
            let [from, end] = piece.ends.map(|end| end.tip.truncate());
            shares.iter().map(move |&share| from.lerp(end, share))
        };
        let points: Vec<_> = pieces.iter().flat_map(places).collect();
        let spans = vec![PatternSpan { points: 0..points.len(), link: false, joined: false }];
        let path = self.path(&Pattern { points, spans }, floor_z_mm, tick);
        let mut path = path.ok_or(DropError::Stopped)?;
        path.raise(floor_z_mm);
        let locations = path.tips.into_iter().zip(path.contacts);
        Ok(locations.map(|(tip, contact)| Location { tip, contact }).collect())
    }
}

impl Toolpath {
    /// The points that straight moves lead to, in order.
    fn moves(&self) -> impl Iterator<Item = usize> {
        self.spans.iter().flat_map(|span| {
            let alone = !span.joined || span.points.start == 0;
            span.points.start + usize::from(alone)..span.points.end
        })
    }

    /// The same path with more points, which are in the order of their places.
    fn with(&self, between: &[Between]) -> Self {
        let count = self.tips.len() + between.len();
        let mut path = Self {
            tips: Vec::with_capacity(count),
            contacts: Vec::with_capacity(count),
            spans: Vec::with_capacity(self.spans.len()),
            feeds: self.feeds,
            arcs: Vec::new(),
        };
        let mut between = between.iter().peekable();
        for span in &self.spans {
            let start = path.tips.len();
            for point in span.points.clone() {
                while let Some(new) = between.next_if(|new| new.place.0 == point) {
                    path.tips.push(new.location.tip);
                    path.contacts.push(new.location.contact);
                }
                path.tips.push(self.tips[point]);
                path.contacts.push(self.contacts[point]);
            }
            path.spans.push(crate::Span { points: start..path.tips.len(), ..span.clone() });
        }
        path
    }
}

//! Strokes become passes: cut to the region, put in order, linked.
//!
//! Pieces are taken in the order they were drawn. Whenever the next of them begins too far from
//! where the cutter is to be reached along the surface, the nearest end of any piece left, within
//! the same reach, is taken first, backwards if it is the far end; only if there is none the cutter
//! is lifted over to the next in order. So rings that a rectangle cuts into four corners are
//! finished corner by corner, there and back, with a lift for each corner instead of each arc.

use super::even::{along, between};
use super::{Pace, Pattern, PatternSpan, Region};
use glam::DVec2;
use std::collections::HashMap;

/// Points closer than this, in mm, are one: no program tells them apart.
pub(super) const MERGE_MM: f64 = 1e-6;

/// A link is at most this many stepovers long. A lift costs some centimetres at low speed, so short
/// ways along the border are better, but they cut nothing. Ten reach from arc to arc along the side
/// of a rectangle as soon as a few turns are cut by it.
const REACH_STEPOVERS: f64 = 10.0;

/// A line before it is cut.
pub(crate) enum Stroke<T> {
    /// From its first point to its last.
    Open(T),
    /// The last point is the first.
    Closed(T),
}

/// Passes in the making.
pub(crate) struct Layer<'a> {
    region: &'a Region,
    pace: Pace,
    pieces: Vec<Vec<DVec2>>,
}

impl<'a> Layer<'a> {
    /// No passes yet. A region without width is a line or a point: it is passed over once, and
    /// there is no layer.
    pub(crate) fn new(region: &'a Region, pace: Pace) -> Result<Self, Pattern> {
        let mut layer = Self { region, pace, pieces: Vec::new() };
        if !pace.is_sound() {
            return Err(Pattern::EMPTY);
        }
        if region.size().min_element() > 0.0 {
            return Ok(layer);
        }
        let ends = [region.min(), region.max()];
        layer.add(Stroke::Open(along(&ends, pace.feed_step_mm)));
        Err(layer.in_order())
    }

    /// Adds what of a stroke lies in the region.
    pub(crate) fn add(&mut self, stroke: Stroke<impl Iterator<Item = DVec2>>) {
        let first = self.pieces.len();
        match stroke {
            Stroke::Open(points) => self.cut(points),
            Stroke::Closed(points) => {
                let (start, end) = self.cut_ends(points);
                self.close(first, start, end);
            }
        }
    }

    /// Adds passes around the region.
    pub(crate) fn add_border(&mut self) {
        for corners in self.region.outlines() {
            let points: Vec<DVec2> = along(&corners, self.pace.feed_step_mm).collect();
            if corners.first() == corners.last() {
                self.add(Stroke::Closed(points.into_iter()));
            } else {
                self.add(Stroke::Open(points.into_iter()));
            }
        }
    }

    /// Adds a pass that is known to lie in the region.
    pub(crate) fn add_whole(&mut self, points: Vec<DVec2>) {
        self.pieces.push(points);
    }

    fn cut(&mut self, points: impl Iterator<Item = DVec2>) {
        self.cut_ends(points);
    }

    /// Cuts a stroke and tells its ends.
    fn cut_ends(&mut self, mut points: impl Iterator<Item = DVec2>) -> (DVec2, DVec2) {
        let Some(start) = points.next() else { return Default::default() };
        let (mut from, first, mut alone) = (start, self.pieces.len(), true);
        let mut open = false;
        for to in points {
            alone &= to == start;
            open = self.cut_step(from, to, open);
            from = to;
        }
        if alone && self.region.contains(start) {
            self.pieces.truncate(first);
            self.pieces.push(vec![self.kept(start)]);
            return (start, from);
        }
        // What only brushes the border is no pass.
        let cut = self.pieces.split_off(first);
        self.pieces.extend(cut.into_iter().filter(|piece| piece.len() > 1));
        (start, from)
    }

    /// Adds the inside of a line to the piece that is `open`, or to new ones. Whether one is open
    /// at its end.
    fn cut_step(&mut self, from: DVec2, to: DVec2, mut open: bool) -> bool {
        let mut end = 0.0;
        for (enter, leave) in self.region.inside(from, to) {
            if !(open && enter == 0.0) {
                self.pieces.push(vec![self.kept(from.lerp(to, enter))]);
            }
            let (leaves, place) = (leave < 1.0, from.lerp(to, leave));
            let place = self.kept(if leaves { place } else { to });
            if let Some(piece) = self.pieces.last_mut()
                && piece.last().is_some_and(|last| last.distance(place) > MERGE_MM)
            {
                piece.push(place);
            }
            (open, end) = (!leaves, leave);
        }
        open && end == 1.0
    }

    /// A place on the border, which rounding may have put beside the box.
    fn kept(&self, place: DVec2) -> DVec2 {
        place.clamp(self.region.min(), self.region.max())
    }

    /// Puts the two pieces together that a closed stroke's start cut apart.
    fn close(&mut self, first: usize, start: DVec2, end: DVec2) {
        let last = self.pieces.len().wrapping_sub(1);
        let apart = self.pieces.len() > first + 1
            && start.distance(end) <= MERGE_MM
            && self.pieces[first][0] == self.kept(start)
            && self.pieces[last].last() == Some(&self.kept(end));
        if apart && let Some(mut whole) = self.pieces.pop() {
            whole.extend_from_slice(&self.pieces[first][1..]);
            self.pieces[first] = whole;
        }
    }

    /// The passes, in the order drawn or from the last to the first.
    pub(crate) fn into_pattern(mut self, reversed: bool) -> Pattern {
        if reversed {
            self.pieces.reverse();
            self.pieces.iter_mut().for_each(|piece| piece.reverse());
        }
        self.in_order()
    }

    /// The passes in the order drawn, with a lift between all of them.
    pub(crate) fn into_lifted(self) -> Pattern {
        let mut pattern = Pattern::EMPTY;
        for piece in self.pieces {
            push(&mut pattern, piece.into_iter(), false, false);
        }
        pattern
    }

    fn in_order(mut self) -> Pattern {
        let reach_mm = REACH_STEPOVERS * self.pace.stepover_mm;
        let mut ends = Ends::new(&self.pieces, reach_mm);
        let mut pattern = Pattern::EMPTY;
        let mut next = 0;
        while next < self.pieces.len() {
            if self.pieces[next].is_empty() {
                next += 1;
                continue;
            }
            let (index, entry) = self.choose(pattern.points.last().copied(), next, &ends);
            ends.take(index, &self.pieces[index]);
            let piece = turned(std::mem::take(&mut self.pieces[index]), entry.unwrap_or(0));
            append(&mut pattern, piece, entry.is_some(), self.pace.feed_step_mm);
        }
        pattern
    }

    /// Which piece follows, `next` or one that ends near by, and at which of its points it is
    /// entered along the surface, if it is.
    fn choose(&self, at: Option<DVec2>, next: usize, ends: &Ends) -> (usize, Option<usize>) {
        let Some(at) = at else { return (next, None) };
        let within =
            |place: DVec2| place.distance(at) <= ends.reach_mm && self.region.holds(at, place);
        let piece = &self.pieces[next];
        let entry = nearest_entry(piece, at);
        if within(piece[entry]) {
            return (next, Some(entry));
        }
        match ends.near(at, within) {
            Some((index, place)) if self.pieces[index][0] == place => (index, Some(0)),
            Some((index, _)) => (index, Some(self.pieces[index].len() - 1)),
            None => (next, None),
        }
    }
}

fn is_closed(piece: &[DVec2]) -> bool {
    piece.len() > 2 && piece.first() == piece.last()
}

/// The nearest point at which a piece may be entered: any of a closed one, an end of an open one.
fn nearest_entry(piece: &[DVec2], at: DVec2) -> usize {
    let distance = |k: &usize| piece[*k].distance_squared(at);
    let step = if is_closed(piece) { 1 } else { (piece.len() - 1).max(1) };
    (0..piece.len()).step_by(step).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// A piece as it is entered at one of its points: for an open one that is an end.
fn turned(mut piece: Vec<DVec2>, entry: usize) -> Vec<DVec2> {
    if is_closed(&piece) {
        piece.pop();
        let points = piece.len();
        piece.rotate_left(entry % points);
        piece.extend(piece.first().copied());
    } else if entry > 0 {
        piece.reverse();
    }
    piece
}

/// Appends a pass, and the link to it if it is joined. Where it begins at the very point the last
/// one ended at, that point stands once.
fn append(pattern: &mut Pattern, piece: Vec<DVec2>, joined: bool, feed_step_mm: f64) {
    let mut piece = &piece[..];
    if let (true, Some(&at)) = (joined, pattern.points.last()) {
        if piece[0].distance(at) <= MERGE_MM {
            piece = &piece[1..];
        } else {
            push(pattern, between(at, piece[0], feed_step_mm), true, true);
        }
    }
    push(pattern, piece.iter().copied(), false, joined);
}

/// Appends a span, if it has any points.
pub(crate) fn push(
    pattern: &mut Pattern,
    points: impl Iterator<Item = DVec2>,
    link: bool,
    joined: bool,
) {
    let start = pattern.points.len();
    pattern.points.extend(points);
    let points = start..pattern.points.len();
    if !points.is_empty() {
        pattern.spans.push(PatternSpan { points, link, joined });
    }
}

/// The ends of pieces, in squares as wide as the reach, so that nine of them hold all within it.
struct Ends {
    reach_mm: f64,
    squares: HashMap<[i64; 2], Vec<(DVec2, usize)>>,
}

impl Ends {
    fn new(pieces: &[Vec<DVec2>], reach_mm: f64) -> Self {
        let mut ends = Self { reach_mm, squares: HashMap::new() };
        for (index, piece) in pieces.iter().enumerate() {
            for place in piece.first().into_iter().chain(piece.last()) {
                let square = ends.square(*place);
                ends.squares.entry(square).or_default().push((*place, index));
            }
        }
        ends
    }

    fn square(&self, place: DVec2) -> [i64; 2] {
        let square = (place / self.reach_mm).floor();
        [square.x as i64, square.y as i64]
    }

    /// The nearest end that serves, and whose it is; of equals the one drawn first.
    fn near(&self, at: DVec2, serves: impl Fn(DVec2) -> bool) -> Option<(usize, DVec2)> {
        let [x, y] = self.square(at);
        let squares = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| [x, y]));
        let ends = squares.filter_map(|square| self.squares.get(&square)).flatten();
        let mut ends: Vec<(f64, usize, DVec2)> =
            ends.map(|(place, index)| (place.distance(at), *index, *place)).collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        ends.into_iter()
            .find(|(_, _, place)| serves(*place))
            .map(|(_, index, place)| (index, place))
    }

    fn take(&mut self, index: usize, piece: &[DVec2]) {
        for place in piece.first().into_iter().chain(piece.last()) {
            let square = self.square(*place);
            if let Some(ends) = self.squares.get_mut(&square) {
                ends.retain(|(_, other)| *other != index);
            }
        }
    }
}

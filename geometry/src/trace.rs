//! The outlines of what is brighter than a level in a picture (marching squares).
//!
//! [`trace`] tells between which nodes outlines pass, [`trace_level`] where, in a picture:
//! between the middles of neighbouring pixels brightness is taken to change evenly, so outlines run at
//! fractions of a pixel. Each square of four pixels holds up to two pieces of outline; where two bright
//! pixels face two dark ones across it, the mean of the four says which pair is joined (Nielson and
//! Hamann, "The asymptotic decider", Visualization 1991, with the mean in place of the saddle's value).
//! Beyond the border all is dark, from the outermost pixels' middles on: what is open there is closed
//! along the border.
//!
//! A piece leads from the side through which one comes into the bright part, walking around the square,
//! to a side through which one leaves it. The neighbour walks along that side the other way, so its piece
//! begins there: pieces are followed from end to beginning until they come back.

use crate::Tick;
use glam::DVec2;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// More pieces make no outline that anybody drew: noise has one for every other pixel. They take 8
/// bytes each, and as much again when they are sorted.
const MAX_PIECES: usize = 20_000_000;

/// Why there are no outlines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TraceError {
    /// The tick said so.
    #[error("it was told to stop")]
    Stopped,
    /// There is more outline than can be followed.
    #[error("the outline has more than {MAX_PIECES} corners")]
    TooLong,
}

/// Loops around what is brighter than `level`, as corners in pixels: x to the right and y down, from the
/// middle of the first pixel of the first row. Each outline and each hole is a loop; what lies between is
/// told by the even-odd rule. None if all is dark.
///
/// `values` are rows of `columns` pixels, from the top; `tick` is told of rows.
///
/// # Errors
/// If the tick says stop, or the outlines are longer than the limit.
pub fn trace_level(
    columns: usize,
    values: &[f32],
    level: f32,
    tick: Tick<'_>,
) -> Result<Vec<Vec<DVec2>>, TraceError> {
    let value = |[x, y]: [usize; 2]| values[y * columns + x];
    let size = [columns, values.len() / columns.max(1)];
    // Beyond the border there is as much as at the level.
    let apart = |corners: [Option<[usize; 2]>; 4]| {
        corners.map(|corner| corner.map_or(level, value)).iter().sum::<f32>() / 4.0 <= level
    };
    let traced = trace(size, |pixel| value(pixel) > level, apart, tick)?;
    let place = |[x, y]: [usize; 2]| DVec2::new(x as f64, y as f64);
    let corner = |crossing: &Crossing| {
        let Crossing { inside, outside: Some(outside) } = *crossing else {
            return place(crossing.inside);
        };
        // The same arithmetic from both sides.
        let (a, b) = (inside.min(outside), inside.max(outside));
        let [p, q, level] = [value(a), value(b), level].map(f64::from);
        place(a).lerp(place(b), ((level - p) / (q - p)).clamp(0.0, 1.0))
    };
    let loops = traced.iter().map(|crossings| {
        let mut corners: Vec<DVec2> = crossings.iter().map(corner).collect();
        corners.dedup();
        if corners.last() == corners.first() {
            corners.pop();
        }
        corners
    });
    Ok(loops.filter(|corners| corners.len() > 2).collect())
}

/// Where an outline passes between two nodes of a grid that are neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crossing {
    /// The node inside of it.
    pub(crate) inside: [usize; 2],
    /// The node outside; `None` where it would lie beyond the border.
    pub(crate) outside: Option<[usize; 2]>,
}

/// The outlines of the nodes of a grid of some columns and rows that are inside, each once around. With
/// rows downward what is inside lies to the left, with rows upward to the right. `apart` says of the
/// corners of a square, of which two opposite ones are inside, whether these are not joined.
///
/// # Errors
/// As [`trace_level`].
pub(crate) fn trace(
    [columns, rows]: [usize; 2],
    is_inside: impl Fn([usize; 2]) -> bool + Sync,
    apart: impl Fn([Option<[usize; 2]>; 4]) -> bool + Sync,
    tick: Tick<'_>,
) -> Result<Vec<Vec<Crossing>>, TraceError> {
    if columns == 0 || rows == 0 {
        return Ok(Vec::new());
    }
    let frame = Frame { columns, rows };
    let count = AtomicUsize::new(0);
    let pieces: Result<Vec<Vec<[u32; 2]>>, TraceError> = (0..=rows)
        .into_par_iter()
        .map(|row| {
            let pieces = frame.pieces(row, &is_inside, &apart);
            let before = count.fetch_add(pieces.len(), Ordering::Relaxed);
            if before + pieces.len() > MAX_PIECES {
                return Err(TraceError::TooLong);
            }
            if tick(1) { Ok(pieces) } else { Err(TraceError::Stopped) }
        })
        .collect();
    let mut pieces = pieces?.concat();
    pieces.par_sort_unstable();
    Ok(frame.followed(&pieces, &is_inside))
}

/// A grid within a frame of nodes that are outside.
struct Frame {
    columns: usize,
    rows: usize,
}

/// The corners of a square in the order of a walk around it.
const CORNERS: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// Its sides in that order, each as the place of its end of lower numbers, and whether it leads from row
/// to row.
const SIDES: [([usize; 2], bool); 4] =
    [([0, 0], false), ([1, 0], true), ([0, 1], false), ([0, 0], true)];

impl Frame {
    /// The node at a column and row of the framed grid; `None` in the frame.
    fn node(&self, column: usize, row: usize) -> Option<[usize; 2]> {
        let node = [column.wrapping_sub(1), row.wrapping_sub(1)];
        (node[0] < self.columns && node[1] < self.rows).then_some(node)
    }

    /// The pieces of outline in a row of squares.
    fn pieces(
        &self,
        row: usize,
        is_inside: impl Fn([usize; 2]) -> bool,
        apart: impl Fn([Option<[usize; 2]>; 4]) -> bool,
    ) -> Vec<[u32; 2]> {
        let mut pieces = Vec::new();
        for column in 0..=self.columns {
            let corners = CORNERS.map(|[x, y]| self.node(column + x, row + y));
            let inside = corners.map(|corner| corner.is_some_and(&is_inside));
            if inside == [true; 4] || inside == [false; 4] {
                continue;
            }
            let comes = |side: usize| !inside[side] && inside[(side + 1) % 4];
            let leaves = |side: usize| inside[side] && !inside[(side + 1) % 4];
            // Around each corner inside by itself, or around each one outside.
            let apart = apart(corners);
            for from in (0..4).filter(|side| comes(*side)) {
                let turn = |k: usize| if apart { (from + k) % 4 } else { (from + 4 - k) % 4 };
                if let Some(to) = (1..4).map(turn).find(|side| leaves(*side)) {
                    pieces.push([from, to].map(|side| self.side(column, row, side)));
                }
            }
        }
        pieces
    }

    /// The number of a side of a square.
    fn side(&self, column: usize, row: usize, side: usize) -> u32 {
        let ([x, y], upright) = SIDES[side];
        let place = (row + y) * (self.columns + 2) + column + x;
        // Grids have less than 2³¹ nodes.
        (2 * place + usize::from(upright)) as u32
    }

    /// What an outline passes between on a side.
    fn crossing(&self, side: u32, is_inside: impl Fn([usize; 2]) -> bool) -> Option<Crossing> {
        let (place, upright) = (side as usize / 2, side % 2 == 1);
        let (column, row) = (place % (self.columns + 2), place / (self.columns + 2));
        let one = self.node(column, row);
        let other = if upright { self.node(column, row + 1) } else { self.node(column + 1, row) };
        let (inside, outside) =
            if one.is_some_and(is_inside) { (one, other) } else { (other, one) };
        inside.map(|inside| Crossing { inside, outside })
    }

    /// Loops of pieces that are sorted by their beginnings.
    fn followed(
        &self,
        pieces: &[[u32; 2]],
        is_inside: impl Fn([usize; 2]) -> bool,
    ) -> Vec<Vec<Crossing>> {
        let mut is_open = vec![true; pieces.len()];
        let mut loops = Vec::new();
        for first in 0..pieces.len() {
            let (mut crossings, mut at) = (Vec::new(), first);
            while is_open[at] {
                is_open[at] = false;
                crossings.extend(self.crossing(pieces[at][0], &is_inside));
                // Every side that is left through is come through on its other side.
                let end = pieces[at][1];
                at = pieces.binary_search_by_key(&end, |piece| piece[0]).unwrap_or(first);
            }
            if !crossings.is_empty() {
                loops.push(crossings);
            }
        }
        loops
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Polygon;

    fn traced(columns: usize, values: &[f32]) -> Vec<Vec<DVec2>> {
        trace_level(columns, values, 0.5, &|_| true).unwrap()
    }

    fn area(loops: &[Vec<DVec2>]) -> f64 {
        let clean = Polygon::new(loops.to_vec()).unwrap().clean();
        clean.map_or(0.0, |clean| clean.area_mm2())
    }

    /// Whether an odd number of loops surround a place.
    fn contains(loops: &[Vec<DVec2>], place: DVec2) -> bool {
        let sides = loops.iter().flat_map(|c| c.iter().zip(c.iter().cycle().skip(1)));
        let crossed = sides.filter(|(a, b)| {
            (a.y <= place.y) != (b.y <= place.y)
                && place.x < a.x + (place.y - a.y) / (b.y - a.y) * (b.x - a.x)
        });
        crossed.count() % 2 == 1
    }

    #[test]
    fn a_bright_pixel_is_a_diamond_and_a_dark_one_a_hole() {
        let mut values = [0.0; 25];
        values[12] = 1.0;
        let diamond = traced(5, &values);
        assert_eq!(diamond.len(), 1);
        let mut corners: Vec<[f64; 2]> = diamond[0].iter().map(DVec2::to_array).collect();
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(corners, [[1.5, 2.0], [2.0, 1.5], [2.0, 2.5], [2.5, 2.0]]);
        let negative = values.map(|value| 1.0 - value);
        let holed = traced(5, &negative);
        assert_eq!(holed.len(), 2);
        assert_eq!(area(&holed), 16.0 - 0.5);
    }

    #[test]
    fn brightness_between_pixels_says_where_the_line_runs() {
        // Level 0.5 lies a quarter of the way from 0.4 to 0.8.
        let ramp = [0.0, 0.4, 0.8, 1.0].repeat(3);
        let loops = traced(4, &ramp);
        assert_eq!(loops.len(), 1);
        let left = loops[0].iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
        assert!((left - 1.25).abs() < 1e-7, "{left}");
        assert!((area(&loops) - 2.0 * 1.75).abs() < 1e-6);
    }

    #[test]
    fn all_is_the_rectangle_and_nothing_is_none() {
        let all = traced(4, &[1.0; 12]);
        assert_eq!((all.len(), area(&all)), (1, 3.0 * 2.0));
        assert!(traced(4, &[0.5; 12]).is_empty());
        assert!(traced(0, &[]).is_empty());
    }

    #[test]
    fn a_disc_is_as_large_as_it_was_drawn_and_closed_along_the_border() {
        let size = 101;
        let disc = |center: DVec2| {
            let pixel = |k: usize| DVec2::new((k % size) as f64, (k / size) as f64);
            let value = |k| (0.5 + 30.0 - pixel(k).distance(center)) as f32;
            traced(size, &(0..size * size).map(value).collect::<Vec<_>>())
        };
        let exact = std::f64::consts::PI * 900.0;
        let whole = disc(DVec2::splat(50.0));
        assert!((area(&whole) / exact - 1.0).abs() < 1e-3);
        for corner in &whole[0] {
            assert!((corner.distance(DVec2::splat(50.0)) - 30.0).abs() < 0.02);
        }
        let half = disc(DVec2::new(0.0, 50.0));
        assert!((area(&half) / exact - 0.5).abs() < 1e-3);
    }

    #[test]
    fn every_pixel_of_noise_lies_on_its_side() {
        let mut rng = fastrand::Rng::with_seed(3);
        for (columns, rows) in [(2, 2), (1, 7), (9, 1), (23, 17), (40, 31)] {
            let values: Vec<f32> = (0..columns * rows).map(|_| rng.f32()).collect();
            let loops = traced(columns, &values);
            for (k, value) in values.iter().enumerate() {
                let (x, y) = (k % columns, k / columns);
                // On the border a bright pixel is on the outline.
                let inner = x > 0 && y > 0 && x + 1 < columns && y + 1 < rows;
                if inner {
                    let place = DVec2::new(x as f64, y as f64);
                    assert_eq!(contains(&loops, place), *value > 0.5, "{x} {y} of {columns}");
                }
            }
        }
    }

    #[test]
    fn it_stops_when_told() {
        let stopped = trace_level(3, &[1.0; 9], 0.5, &|_| false);
        assert_eq!(stopped, Err(TraceError::Stopped));
    }
}

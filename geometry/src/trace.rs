//! The outlines of what is brighter than a level in a picture (marching squares).
//!
//! Between the middles of neighbouring pixels brightness is taken to change evenly, so outlines run at
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
    let picture = Picture { columns, rows: values.len() / columns.max(1), values, level };
    if picture.columns == 0 || picture.rows == 0 {
        return Ok(Vec::new());
    }
    let count = AtomicUsize::new(0);
    let rows: Result<Vec<Vec<[u32; 2]>>, TraceError> = (0..=picture.rows)
        .into_par_iter()
        .map(|row| {
            let pieces = picture.pieces(row);
            let before = count.fetch_add(pieces.len(), Ordering::Relaxed);
            if before + pieces.len() > MAX_PIECES {
                return Err(TraceError::TooLong);
            }
            if tick(1) { Ok(pieces) } else { Err(TraceError::Stopped) }
        })
        .collect();
    let mut pieces = rows?.concat();
    pieces.par_sort_unstable();
    Ok(picture.followed(&pieces))
}

/// A picture within a frame of dark pixels, which is where its outermost pixels are.
struct Picture<'a> {
    columns: usize,
    rows: usize,
    values: &'a [f32],
    level: f32,
}

/// The sides of a square in the order of a walk around it: from its first corner (left, top) to the
/// right, down, to the left, up. Each as the place of its left or upper end, and whether it is upright.
const SIDES: [([usize; 2], bool); 4] =
    [([0, 0], false), ([1, 0], true), ([0, 1], false), ([0, 0], true)];

impl Picture<'_> {
    /// The value at a column and row of the framed picture; `None` in the frame.
    fn value(&self, column: usize, row: usize) -> Option<f32> {
        let (x, y) = (column.wrapping_sub(1), row.wrapping_sub(1));
        (x < self.columns && y < self.rows).then(|| self.values[y * self.columns + x])
    }

    fn is_bright(&self, column: usize, row: usize) -> bool {
        self.value(column, row).is_some_and(|value| value > self.level)
    }

    /// The pieces of outline in a row of squares.
    fn pieces(&self, row: usize) -> Vec<[u32; 2]> {
        let mut pieces = Vec::new();
        for column in 0..=self.columns {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| (column + x, row + y));
            let bright = corners.map(|(x, y)| self.is_bright(x, y));
            if bright == [true; 4] || bright == [false; 4] {
                continue;
            }
            let comes = |side: usize| !bright[side] && bright[(side + 1) % 4];
            let leaves = |side: usize| bright[side] && !bright[(side + 1) % 4];
            let mean =
                corners.map(|(x, y)| self.value(x, y).unwrap_or(self.level)).iter().sum::<f32>()
                    / 4.0;
            // Around each bright corner by itself, or around each dark one.
            let apart = mean <= self.level;
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
        // Pictures have less than 2³¹ pixels.
        (2 * place + usize::from(upright)) as u32
    }

    /// Where the outline crosses a side.
    fn crossing(&self, side: u32) -> DVec2 {
        let (place, upright) = (side as usize / 2, side % 2 == 1);
        let (column, row) = (place % (self.columns + 2), place / (self.columns + 2));
        let other = if upright { (column, row + 1) } else { (column + 1, row) };
        let middle = |(column, row): (usize, usize)| DVec2::new(column as f64, row as f64) - 1.0;
        let (a, b) = (middle((column, row)), middle(other));
        match (self.value(column, row), self.value(other.0, other.1)) {
            (Some(p), Some(q)) => {
                let [p, q, level] = [p, q, self.level].map(f64::from);
                a.lerp(b, ((level - p) / (q - p)).clamp(0.0, 1.0))
            }
            (Some(_), None) => a,
            (None, _) => b,
        }
    }

    /// Loops of pieces that are sorted by their beginnings.
    fn followed(&self, pieces: &[[u32; 2]]) -> Vec<Vec<DVec2>> {
        let mut is_open = vec![true; pieces.len()];
        let mut loops = Vec::new();
        for first in 0..pieces.len() {
            let (mut corners, mut at) = (Vec::new(), first);
            while is_open[at] {
                is_open[at] = false;
                let corner = self.crossing(pieces[at][0]);
                if corners.last() != Some(&corner) {
                    corners.push(corner);
                }
                // Every side that is left through is come through on its other side.
                let end = pieces[at][1];
                at = pieces.binary_search_by_key(&end, |piece| piece[0]).unwrap_or(first);
            }
            if corners.last() == corners.first() {
                corners.pop();
            }
            if corners.len() > 2 {
                loops.push(corners);
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

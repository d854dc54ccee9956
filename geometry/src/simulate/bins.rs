//! Which strokes reach which tiles: lists in the order of time, one after the other in one vector.

use super::stroke::Stroke;
use super::tile::Frame;
use glam::DVec2;

/// The strokes of a batch by tile.
pub(super) struct Bins {
    /// Where the list of each tile begins, and after it that of the next.
    starts: Vec<usize>,
    /// Numbers of strokes in the batch.
    strokes: Vec<u32>,
}

impl Bins {
    /// Sorts strokes of a cutter of the given radius in mm.
    pub(super) fn new(frame: &Frame, batch: &[Stroke], radius: f64) -> Self {
        let mut starts = vec![0; frame.tiles() + 1];
        for stroke in batch {
            reached(frame, stroke, radius, |tile| starts[tile + 1] += 1);
        }
        for tile in 1..starts.len() {
            starts[tile] += starts[tile - 1];
        }
        let mut ends = starts.clone();
        let mut strokes = vec![0; starts.last().copied().unwrap_or(0)];
        for (k, stroke) in batch.iter().enumerate() {
            reached(frame, stroke, radius, |tile| {
                strokes[ends[tile]] = k as u32;
                ends[tile] += 1;
            });
        }
        Self { starts, strokes }
    }

    /// The strokes that reach a tile.
    pub(super) fn of_tile(&self, tile: usize) -> &[u32] {
        &self.strokes[self.starts[tile]..self.starts[tile + 1]]
    }
}

/// Calls `each` for all tiles in which a cutter can reach nodes, and for some beside them.
fn reached(frame: &Frame, stroke: &Stroke, radius: f64, mut each: impl FnMut(usize)) {
    let (a, b) = (stroke.from - frame.corner, stroke.to() - frame.corner);
    let reach = radius + frame.slack();
    let Some([first, last]) = frame.tile_rows(a.y.min(b.y) - reach, a.y.max(b.y) + reach) else {
        return;
    };
    for row in first..=last {
        // The part of the stroke that lies beside this row of tiles.
        let [low, high] = frame.extent_of_tile_row(row);
        let [p, q] = [low - reach, high + reach].map(|y| at_height(a, b, y));
        let (from, to) = (p.min(q), p.max(q));
        if let Some([first, last]) = frame.tile_columns(from - reach, to + reach) {
            (first..=last).for_each(|column| each(row * frame.tile_columns_in_all() + column));
        }
    }
}

/// The x of a stroke at a y, or of the end that is nearest.
fn at_height(a: DVec2, b: DVec2, y: f64) -> f64 {
    let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
    if y <= low.y {
        return low.x;
    }
    if y >= high.y {
        return high.x;
    }
    low.x + (y - low.y) / (high.y - low.y) * (high.x - low.x)
}

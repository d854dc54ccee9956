//! One line that fills a region and never goes far in one direction.
//!
//! The box is divided into equal cells no larger than the pitch, and a Hilbert curve for any number
//! of columns and rows goes through their middles (Červený, *gilbert*, 2018: a block is split into
//! "up, right, down", long ones into two, with halves kept even). Columns and rows are even numbers,
//! so that every step goes to a neighbouring cell.
//!
//! Limits: where four cells meet that no step joins, the curve passes by at √½ of the pitch, not at
//! half of it; corners of the box lie as far off.

use super::even::{along, parts};
use super::{Layer, Layout, Pace, Pattern, Region, Stroke};
use glam::DVec2;

/// A space-filling curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hilbert {
    /// The pitch of the curve (largest distance between neighbouring lines), and the distance
    /// between points.
    pub pace: Pace,
}

impl Layout for Hilbert {
    fn count(&self, region: &Region) -> f64 {
        if !self.pace.is_sound() {
            return f64::INFINITY;
        }
        let [columns, rows] = self.cells(region);
        columns * rows * parts(self.pace.stepover_mm, self.pace.feed_step_mm)
    }

    fn pattern(&self, region: &Region) -> Pattern {
        let mut layer = match Layer::new(region, self.pace) {
            Ok(layer) => layer,
            Err(pattern) => return pattern,
        };
        let cells = self.cells(region);
        let pitch = region.size() / DVec2::from(cells);
        let middles: Vec<DVec2> =
            visited(cells).into_iter().map(|cell| region.min() + (cell + 0.5) * pitch).collect();
        layer.add(Stroke::Open(along(&middles, self.pace.feed_step_mm)));
        layer.into_pattern(false)
    }
}

impl Hilbert {
    /// Columns and rows: even numbers, or one where a single one does.
    fn cells(&self, region: &Region) -> [f64; 2] {
        let even = |length_mm: f64| match parts(length_mm, self.pace.stepover_mm) {
            count if count <= 1.0 => 1.0,
            count => 2.0 * (count / 2.0).ceil(),
        };
        region.size().to_array().map(even)
    }
}

/// The cells of a grid in the order of the curve, which begins in the first one, as column and row.
fn visited([columns, rows]: [f64; 2]) -> Vec<DVec2> {
    let mut cells = Vec::with_capacity((columns * rows) as usize);
    let sides = [DVec2::new(columns, 0.0), DVec2::new(0.0, rows)];
    let [along, across] = if columns >= rows { sides } else { [sides[1], sides[0]] };
    fill(DVec2::ZERO, along, across, &mut cells);
    cells
}

/// Goes through the block that `along` and `across` span from `first`, and ends at its other
/// corner along. All are whole numbers, which are exact.
fn fill(first: DVec2, along: DVec2, across: DVec2, cells: &mut Vec<DVec2>) {
    let (length, width) = (along.length(), across.length());
    if width == 1.0 || length == 1.0 {
        let (side, count) = if width == 1.0 { (along, length) } else { (across, width) };
        cells.extend((0..count as usize).map(|k| first + side / count * k as f64));
        return;
    }
    if 2.0 * length > 3.0 * width {
        let half = even_half(along);
        fill(first, half, across, cells);
        fill(first + half, along - half, across, cells);
        return;
    }
    let (up, right) = (even_half(across), (along / 2.0).trunc());
    fill(first, up, right, cells);
    fill(first + up, along, across - up, cells);
    let last = first + (along - along / length) + (up - across / width);
    fill(last, -up, right - along, cells);
}

/// About half of a side, an even number of cells unless it is shorter than three.
fn even_half(side: DVec2) -> DVec2 {
    let (half, length) = ((side / 2.0).trunc(), side.length());
    let odd = half.length() % 2.0 == 1.0 && length > 2.0;
    if odd { half + side / length } else { half }
}

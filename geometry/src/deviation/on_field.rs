//! The triangles of a field: a pyramid of least and greatest heights over blocks of its cells.
//!
//! A block of the lowest level has 4 × 4 cells, one of the next 2 × 2 of these, and so on.

use super::Ground;
use super::closest::{distance2, to_box2};
use crate::HeightField;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Cells along a side of a lowest block.
const CELLS: usize = 4;

/// So many cells are looked at sooner than the way down the pyramid is gone.
const FEW_CELLS: usize = 9;

/// A level of the pyramid.
struct Level {
    columns: usize,
    rows: usize,
    /// Cells along a side of a block.
    cells: usize,
    /// Least and greatest height of each block.
    heights: Vec<[f32; 2]>,
}

/// A field to search.
pub(super) struct OnField<'a> {
    field: &'a HeightField,
    /// Where the first node stands.
    origin: DVec3,
    levels: Vec<Level>,
}

fn join([a, b]: [f32; 2], [c, d]: [f32; 2]) -> [f32; 2] {
    [a.min(c), b.max(d)]
}

const NOTHING: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

impl<'a> OnField<'a> {
    pub(super) fn new(field: &'a HeightField, origin: DVec2) -> Self {
        let mut levels = vec![lowest(field)];
        while let Some(last) = levels.last().filter(|last| last.heights.len() > 1) {
            let next = above(last);
            levels.push(next);
        }
        Self { field, origin: origin.extend(0.0), levels }
    }

    /// Corners of the two triangles of a cell, from the field's first node.
    fn triangles(&self, i: usize, j: usize) -> [[DVec3; 3]; 2] {
        let [a, b, c, d] =
            [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| self.field.point(i, j));
        [[a, b, c], [a, c, d]]
    }

    /// Looks at a cell.
    fn look(&self, cell: [usize; 2], point: DVec3, best: &mut (f64, [usize; 2])) {
        for corners in self.triangles(cell[0], cell[1]) {
            let found = distance2(point, corners);
            if found < best.0 {
                *best = (found, cell);
            }
        }
    }

    /// Looks at all cells that are not beyond the best in plan, if they are few.
    fn look_around(&self, point: DVec3, best: &mut (f64, [usize; 2])) -> bool {
        let (reach, pitch) = (best.0.sqrt(), self.field.pitch_mm());
        let range = |v: f64, nodes: usize| {
            let cell = |v: f64| (v / pitch).floor().clamp(0.0, (nodes - 2) as f64) as usize;
            cell(v - reach)..=cell(v + reach)
        };
        let (columns, rows) =
            (range(point.x, self.field.columns()), range(point.y, self.field.rows()));
        let cells = (columns.end() - columns.start() + 1) * (rows.end() - rows.start() + 1);
        if cells > FEW_CELLS {
            return false;
        }
        rows.for_each(|j| columns.clone().for_each(|i| self.look([i, j], point, best)));
        true
    }

    /// The squared distance of a block.
    fn block2(&self, level: &Level, [i, j]: [usize; 2], point: DVec3) -> f64 {
        let [low, high] = level.heights[j * level.columns + i];
        let side = level.cells as f64 * self.field.pitch_mm();
        let near = DVec3::new(i as f64 * side, j as f64 * side, f64::from(low));
        let far = (near.truncate() + DVec2::splat(side)).extend(f64::from(high));
        to_box2(point, near, far)
    }

    fn descend(
        &self,
        level: usize,
        [i, j]: [usize; 2],
        point: DVec3,
        best: &mut (f64, [usize; 2]),
    ) {
        if level == 0 {
            let (columns, rows) = (self.field.columns() - 1, self.field.rows() - 1);
            for j in j * CELLS..((j + 1) * CELLS).min(rows) {
                for i in i * CELLS..((i + 1) * CELLS).min(columns) {
                    self.look([i, j], point, best);
                }
            }
            return;
        }
        let below = &self.levels[level - 1];
        let mut children = [(f64::INFINITY, [0; 2]); 4];
        for (k, child) in children.iter_mut().enumerate() {
            let block = [2 * i + k % 2, 2 * j + k / 2];
            if block[0] < below.columns && block[1] < below.rows {
                *child = (self.block2(below, block, point), block);
            }
        }
        children.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (near2, block) in children {
            if near2 >= best.0 {
                return;
            }
            self.descend(level - 1, block, point, best);
        }
    }
}

fn lowest(field: &HeightField) -> Level {
    let columns = (field.columns() - 1).div_ceil(CELLS);
    let rows = (field.rows() - 1).div_ceil(CELLS);
    let block = |k: usize| {
        let (i, j) = (k % columns * CELLS, k / columns * CELLS);
        let mut range = NOTHING;
        for j in j..=(j + CELLS).min(field.rows() - 1) {
            let last = (i + CELLS).min(field.columns() - 1);
            field.row(j)[i..=last].iter().for_each(|z| range = join(range, [*z; 2]));
        }
        range
    };
    let heights = (0..columns * rows).into_par_iter().map(block).collect();
    Level { columns, rows, cells: CELLS, heights }
}

fn above(last: &Level) -> Level {
    let (columns, rows) = (last.columns.div_ceil(2), last.rows.div_ceil(2));
    let block = |k: usize| {
        let (i, j) = (2 * (k % columns), 2 * (k / columns));
        let mut range = NOTHING;
        for j in j..(j + 2).min(last.rows) {
            for i in i..(i + 2).min(last.columns) {
                range = join(range, last.heights[j * last.columns + i]);
            }
        }
        range
    };
    let heights = (0..columns * rows).map(block).collect();
    Level { columns, rows, cells: 2 * last.cells, heights }
}

impl Ground for OnField<'_> {
    /// A cell.
    type Hint = Option<[usize; 2]>;

    fn extent(&self) -> [DVec2; 2] {
        let bounds = self.field.bounds();
        [bounds.min, bounds.max].map(|corner| (corner + self.origin).truncate())
    }

    fn under(&self, _: [usize; 2], place: DVec2) -> Option<(f64, Option<f64>)> {
        let at = (place - self.origin.truncate()) / self.field.pitch_mm();
        // Beyond the border by rounding is on it.
        let cell = |v: f64, nodes: usize| v.floor().clamp(0.0, (nodes - 2) as f64);
        let (i, j) = (cell(at.x, self.field.columns()), cell(at.y, self.field.rows()));
        let within = (at - DVec2::new(i, j)).clamp(DVec2::ZERO, DVec2::ONE);
        let z = |di: usize, dj: usize| self.field.height(i as usize + di, j as usize + dj);
        let (a, c) = (z(0, 0), z(1, 1));
        let slope = if within.x >= within.y {
            DVec2::new(z(1, 0) - a, c - z(1, 0))
        } else {
            DVec2::new(c - z(0, 1), z(0, 1) - a)
        };
        let steep = (slope / self.field.pitch_mm()).length_squared();
        Some((a + slope.dot(within), Some(1.0 / (1.0 + steep).sqrt())))
    }

    fn nearest2(&self, point: DVec3, within2: f64, hint: &mut Self::Hint) -> f64 {
        let point = point - self.origin;
        let mut best = (within2, hint.unwrap_or_default());
        if let Some(cell) = *hint {
            self.look(cell, point, &mut best);
        }
        if self.look_around(point, &mut best) {
            *hint = Some(best.1);
            return best.0;
        }
        let top = self.levels.len() - 1;
        if self.block2(&self.levels[top], [0, 0], point) < best.0 {
            self.descend(top, [0, 0], point, &mut best);
        }
        *hint = Some(best.1);
        best.0
    }
}

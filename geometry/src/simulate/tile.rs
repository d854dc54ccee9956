//! The stock in tiles that fit a processor's cache, and these in blocks that are left out or swept as one.
//!
//! A tile has 8 × 8 blocks of 8 × 8 nodes, block by block, row by row. Nodes beyond the grid lie so low
//! that nothing reaches them.

use super::load::Shaved;
use super::stroke::Stroke;
use super::sweep::{Seen, Sweep};
use super::{SimulateError, Stock};
use crate::{HeightField, HeightFieldError, Tick};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use wide::f32x8;

/// Nodes along a side of a block, and blocks along a side of a tile: as many as are computed at once.
const LANES: usize = 8;

/// Nodes along a side of a tile.
const SIDE: usize = LANES * LANES;

/// Vectors in a tile.
const VECTORS: usize = SIDE * LANES;

/// Height of what is not there.
const NOTHING: f32 = f32::MIN;

/// Gauges allow for this much of rounding, relative to the lengths that they compare: some ten roundings of
/// 6e-8.
const ROUNDING: f64 = 1e-6;

/// A node lowered by less, in mm, is not said to be cut: rounding to `f32` alone lowers by as much.
const CHIP_MM: f32 = 1e-3;

/// Strokes between two looks at the cancel token: a fraction of a millisecond.
const STROKES_A_LOOK: usize = 1024;

/// Where the nodes are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// The first node.
    pub(super) corner: DVec2,
    pitch: f64,
    columns: usize,
    rows: usize,
}

impl Frame {
    /// Tiles in all.
    pub(super) fn tiles(&self) -> usize {
        self.tile_columns_in_all() * self.rows.div_ceil(SIDE)
    }

    /// Tiles in a row.
    pub(super) fn tile_columns_in_all(&self) -> usize {
        self.columns.div_ceil(SIDE)
    }

    /// A length in mm that does not matter beside the pitch, but more than what rounding takes.
    pub(super) fn slack(&self) -> f64 {
        self.pitch / LANES as f64
    }

    /// First and last row of tiles between two lengths from the corner, in mm.
    pub(super) fn tile_rows(&self, low: f64, high: f64) -> Option<[usize; 2]> {
        self.between(low, high, self.rows)
    }

    /// First and last column of tiles between two lengths from the corner, in mm.
    pub(super) fn tile_columns(&self, low: f64, high: f64) -> Option<[usize; 2]> {
        self.between(low, high, self.columns)
    }

    fn between(&self, low: f64, high: f64, nodes: usize) -> Option<[usize; 2]> {
        let side = self.pitch * SIDE as f64;
        let (first, last) = ((low / side).floor().max(0.0), (high / side).floor());
        let end = nodes.div_ceil(SIDE);
        (last >= 0.0 && first < end as f64).then(|| [first as usize, (last as usize).min(end - 1)])
    }

    /// From the first to the last y of a row of tiles, in mm from the corner.
    pub(super) fn extent_of_tile_row(&self, row: usize) -> [f64; 2] {
        [row * SIDE, row * SIDE + SIDE - 1].map(|j| j as f64 * self.pitch)
    }

    /// Column and row of a tile's first node.
    fn first_of(&self, tile: usize) -> [usize; 2] {
        [tile % self.tile_columns_in_all() * SIDE, tile / self.tile_columns_in_all() * SIDE]
    }

    fn place(&self, [i, j]: [usize; 2]) -> DVec2 {
        self.corner + DVec2::new(i as f64, j as f64) * self.pitch
    }
}

/// The stock.
pub(super) struct Tiles {
    pub(super) frame: Frame,
    heights: Vec<f32x8>,
    /// The greatest height of each block, a row of blocks of a tile in a vector.
    tops: Vec<f32x8>,
}

impl Tiles {
    /// A whole block.
    pub(super) fn new(stock: &Stock) -> Result<Self, SimulateError> {
        let (grid, corner) = (stock.grid, stock.corner);
        let (columns, rows) = (grid.columns, grid.rows);
        let bad = |fault| Err(SimulateError::BadStock(fault));
        if columns < 2 || rows < 2 {
            return bad(HeightFieldError::TooSmall { columns, rows });
        }
        if !(grid.pitch_mm.is_finite() && grid.pitch_mm > 0.0) {
            return bad(HeightFieldError::BadPitch(grid.pitch_mm));
        }
        let far = corner.abs().max_element().max(stock.top_mm.abs());
        if far.is_nan() || far > super::FARTHEST_MM {
            let value = stock.top_mm as f32;
            return bad(HeightFieldError::NotFinite { column: 0, row: 0, value });
        }
        let frame = Frame { corner, pitch: grid.pitch_mm, columns, rows };
        let Some(vectors) = columns.checked_mul(rows).map(|_| frame.tiles() * VECTORS) else {
            return bad(HeightFieldError::WrongLength { given: usize::MAX, columns, rows });
        };
        let mut tiles = Self {
            frame,
            heights: vec![f32x8::splat(NOTHING); vectors],
            tops: vec![f32x8::splat(NOTHING); vectors / SIDE],
        };
        let top = stock.top_mm as f32;
        tiles.tiles_mut().enumerate().for_each(|(index, tile)| tile.fill(&frame, index, top));
        Ok(tiles)
    }

    /// All tiles, row by row.
    pub(super) fn tiles_mut(&mut self) -> impl IndexedParallelIterator<Item = Tile<'_>> {
        let heights = self.heights.par_chunks_exact_mut(VECTORS);
        let tops = self.tops.par_chunks_exact_mut(LANES);
        heights.zip(tops).map(|(heights, tops)| Tile { heights, tops })
    }

    /// The heights as a field.
    pub(super) fn surface(self) -> Result<HeightField, HeightFieldError> {
        let Frame { columns, rows, pitch, .. } = self.frame;
        let mut heights = vec![0.0; columns * rows];
        let across = self.frame.tile_columns_in_all();
        heights.par_chunks_exact_mut(columns).enumerate().for_each(|(j, row)| {
            for (k, eight) in row.chunks_mut(LANES).enumerate() {
                let tile = j / SIDE * across + k / LANES;
                let block = j % SIDE / LANES * LANES + k % LANES;
                let vector = self.heights[tile * VECTORS + block * LANES + j % LANES].to_array();
                eight.copy_from_slice(&vector[..eight.len()]);
            }
        });
        HeightField::new(columns, rows, pitch, heights)
    }
}

/// A tile of the stock.
pub(super) struct Tile<'a> {
    heights: &'a mut [f32x8],
    tops: &'a mut [f32x8],
}

/// 0, 1, … 7.
fn lanes() -> f32x8 {
    f32x8::from([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
}

impl Tile<'_> {
    /// Makes the nodes that belong to the grid as high as the top.
    fn fill(self, frame: &Frame, index: usize, top: f32) {
        let [i, j] = frame.first_of(index);
        for (k, heights) in self.heights.iter_mut().enumerate() {
            let (block, row) = (k / LANES, k % LANES);
            let (i, j) = (i + block % LANES * LANES, j + block / LANES * LANES + row);
            let inside = frame.columns.saturating_sub(i) as f32;
            if j < frame.rows && inside > 0.0 {
                let within = lanes().simd_lt(f32x8::splat(inside));
                *heights = within.bitselect(f32x8::splat(top), f32x8::splat(NOTHING));
                if row == 0 {
                    set_lane(&mut self.tops[block / LANES], block % LANES, top);
                }
            }
        }
    }

    /// Takes away what strokes of a cutter sweep. `None` if cancelled.
    pub(super) fn shave<'s, S: Sweep>(
        self,
        frame: &Frame,
        index: usize,
        strokes: impl Iterator<Item = &'s Stroke>,
        cutter: &S,
        tick: Tick,
    ) -> Option<Shaved> {
        let first = frame.first_of(index);
        let mut work = Work {
            frame,
            first,
            place: frame.place(first),
            cutter,
            tile: self,
            shaved: Shaved::default(),
        };
        for (k, stroke) in strokes.enumerate() {
            work.shave(stroke);
            if k % STROKES_A_LOOK == 0 {
                tick(0).then_some(())?;
            }
        }
        Some(work.shaved)
    }
}

fn set_lane(vector: &mut f32x8, lane: usize, value: f32) {
    vector.as_mut_array()[lane] = value;
}

/// The work on a tile.
struct Work<'a, S> {
    frame: &'a Frame,
    /// Column and row of the tile's first node.
    first: [usize; 2],
    /// Where that stands.
    place: DVec2,
    cutter: &'a S,
    tile: Tile<'a>,
    shaved: Shaved,
}

/// What a stroke took from a block.
struct Chip {
    top: f32,
    /// Sum of the depths that nodes were lowered by.
    removed: f32,
    /// What counts most in each column, and of each node, see [`Rows::sweep`].
    most: f32x8,
    each: [f32x8; LANES],
}

impl<S: Sweep> Work<'_, S> {
    fn shave(&mut self, stroke: &Stroke) {
        let lead = self.cutter.lead(stroke.slope);
        let mut removed = 0.0;
        for row in self.block_rows(stroke) {
            let mut hits = self.hits(stroke, row);
            while hits != 0 {
                let column = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                removed += self.shave_block(stroke, lead, [column, row]);
            }
        }
        self.shaved.take(stroke.index, removed * self.frame.pitch * self.frame.pitch);
    }

    /// Rows of blocks that a stroke may reach.
    fn block_rows(&self, stroke: &Stroke) -> std::ops::Range<usize> {
        let (a, b) = (stroke.from.y - self.place.y, stroke.to().y - self.place.y);
        let reach = self.cutter.radius() + self.frame.slack();
        let per_row = 1.0 / (LANES as f64 * self.frame.pitch);
        let row = |y: f64| (y * per_row).clamp(-1.0, LANES as f64);
        let (first, last) = (row(a.min(b) - reach).floor(), row(a.max(b) + reach).floor());
        first.max(0.0) as usize..((last + 1.0).max(0.0) as usize).min(LANES)
    }

    /// Which blocks of a row a stroke may lower, as bits.
    #[inline]
    fn hits(&self, stroke: &Stroke, row: usize) -> u32 {
        let pitch = self.frame.pitch;
        let half = (LANES - 1) as f64 / 2.0;
        // Middle of the row's first block, seen from the stroke's begin.
        let middle = DVec2::new(half, half + (row * LANES) as f64) * pitch;
        let seen = self.place + middle - stroke.from;
        let (s, d) = (stroke.way.dot(seen), stroke.way.perp_dot(seen));
        let near = s.clamp(0.0, stroke.length);
        let splat = |v: f64| f32x8::splat(v as f32);
        let run = lanes() * splat(LANES as f64 * pitch);
        let s = splat(s - near) + run * splat(stroke.way.x);
        let d = splat(d) - run * splat(stroke.way.y);
        let ends = [-near, stroke.length - near].map(splat);
        let within = |t: f32x8| t.fast_max(ends[0]).fast_min(ends[1]);
        let beyond = s - within(s);
        // From the middle to the corner of a block, and all that rounding may take.
        let scale = self.cutter.radius() + SIDE as f64 * pitch;
        let corner = half * pitch * std::f64::consts::SQRT_2 + ROUNDING * scale;
        let away = ((beyond * beyond + d * d).sqrt() - splat(corner)).fast_max(f32x8::ZERO);
        let reach = (self.cutter.radius() + corner).copysign(stroke.slope);
        let height = splat(stroke.z + stroke.slope * near);
        let low = height + splat(stroke.slope) * within(s - splat(reach));
        let climb = stroke.slope.abs() * stroke.length;
        let slack = splat(ROUNDING * (1.0 + stroke.z.abs() + climb));
        let rise = self.tile.tops[row] - low + slack;
        (away * away).simd_lt(self.cutter.reach2(rise)).to_bitmask()
    }

    /// Lowers the nodes of a block; the sum of what they were lowered by, in mm.
    #[inline]
    fn shave_block(&mut self, stroke: &Stroke, lead: S::Lead, [column, row]: [usize; 2]) -> f64 {
        let (way, reach) = (stroke.way * self.frame.pitch, (LANES - 1) as f64);
        let first = DVec2::new(column as f64, row as f64) * (LANES as f64 * self.frame.pitch);
        let seen = self.place + first - stroke.from;
        let (s, d) = (stroke.way.dot(seen), stroke.way.perp_dot(seen));
        // First and last s of the block.
        let low = s + reach * (way.x.min(0.0) + way.y.min(0.0));
        let high = s + reach * (way.x.max(0.0) + way.y.max(0.0));
        let beyond = self.cutter.end_counts_beyond(lead);
        let stamps = high < -beyond || low > stroke.length + beyond;
        // The place from which the stroke is told: near the block's middle, so that numbers are small.
        let near = ((low + high) / 2.0).clamp(0.0, stroke.length);
        let splat = |v: f64| f32x8::splat(v as f32);
        let told = Seen {
            ends: [-near, stroke.length - near].map(splat),
            z: splat(stroke.z + stroke.slope * near),
            slope: splat(stroke.slope),
        };
        let rows = Rows {
            s: splat(s - near) + lanes() * splat(way.x),
            d: splat(d) - lanes() * splat(way.y),
            step_s: splat(way.y),
            step_d: splat(way.x),
        };
        let at = (row * LANES + column) * LANES;
        let heights: &mut [f32x8; LANES] =
            (&mut self.tile.heights[at..at + LANES]).try_into().expect("a block has eight rows");
        // No place of the block is deeper below its top than the stroke's lower end.
        let lowest = stroke.z.min(stroke.z + stroke.slope * stroke.length);
        let depth = self.tile.tops[row].as_array()[column] - lowest as f32;
        let counts = stroke.rapid || self.shaved.wants(stroke, depth * (1.0 + f32::EPSILON));
        let chip = match (stamps, counts) {
            _ if stroke.rapid => rows.sweep(heights, &told, deep_of_rapid, |s, d, now| {
                self.cutter.leave(lead, &told, s, d, now)
            }),
            (false, true) => rows.sweep(heights, &told, deep_of_feed, |s, d, now| {
                self.cutter.leave(lead, &told, s, d, now)
            }),
            (false, false) => rows.sweep(
                heights,
                &told,
                |_, _, _, _| f32x8::ZERO,
                |s, d, now| self.cutter.leave(lead, &told, s, d, now),
            ),
            (true, true) => rows.sweep(heights, &told, deep_of_feed, |s, d, now| {
                self.cutter.stamp(told.z, s * s + d * d, now)
            }),
            (true, false) => rows.sweep(
                heights,
                &told,
                |_, _, _, _| f32x8::ZERO,
                |s, d, now| self.cutter.stamp(told.z, s * s + d * d, now),
            ),
        };
        let Some(chip) = chip else { return 0.0 };
        set_lane(&mut self.tile.tops[row], column, chip.top);
        let most = chip.most.to_array().into_iter().fold(0.0, f32::max);
        if self.shaved.wants(stroke, most) {
            let all = chip.each.map(f32x8::to_array);
            let node = (0..LANES * LANES).find(|k| all[k / LANES][k % LANES] == most).unwrap_or(0);
            let left = self.tile.heights[at + node / LANES].to_array()[node % LANES];
            let i = self.first[0] + column * LANES + node % LANES;
            let j = self.first[1] + row * LANES + node / LANES;
            let place: DVec3 = self.frame.place([i, j]).extend(f64::from(left));
            self.shaved.note(stroke, most, place);
        }
        f64::from(chip.removed)
    }
}

/// What counts of a node cut by a feed: the height of the stock above the tip.
#[inline(always)]
fn deep_of_feed(seen: &Seen, s: f32x8, now: f32x8, lowered: f32x8) -> f32x8 {
    let deep = now - seen.tip(seen.within(s));
    lowered.simd_gt(f32x8::splat(CHIP_MM)).bitselect(deep, f32x8::ZERO)
}

/// What counts of a node cut by a rapid: how much it was lowered.
#[inline(always)]
fn deep_of_rapid(_: &Seen, _: f32x8, _: f32x8, lowered: f32x8) -> f32x8 {
    lowered.simd_gt(f32x8::splat(CHIP_MM)).bitselect(lowered, f32x8::ZERO)
}

/// Where the nodes of a block lie: those of the first row, and from a row to the next.
struct Rows {
    s: f32x8,
    d: f32x8,
    step_s: f32x8,
    step_d: f32x8,
}

impl Rows {
    /// Lowers the heights of a block; `None` if nothing is taken away. `leave` says what is left of heights
    /// at s and d, `deep` what counts of them.
    #[inline(always)]
    fn sweep(
        &self,
        heights: &mut [f32x8; LANES],
        seen: &Seen,
        deep: impl Fn(&Seen, f32x8, f32x8, f32x8) -> f32x8,
        leave: impl Fn(f32x8, f32x8, f32x8) -> f32x8,
    ) -> Option<Chip> {
        let (mut s, mut d) = (self.s, self.d);
        let mut top = f32x8::splat(NOTHING);
        let (mut removed, mut most) = (f32x8::ZERO, f32x8::ZERO);
        let mut each = [f32x8::ZERO; LANES];
        for (heights, each) in heights.iter_mut().zip(&mut each) {
            let now = *heights;
            let left = leave(s, d, now);
            let lowered = now - left;
            *heights = left;
            top = top.fast_max(left);
            removed += lowered;
            *each = deep(seen, s, now, lowered);
            most = most.fast_max(*each);
            s += self.step_s;
            d += self.step_d;
        }
        let top = top.to_array().into_iter().fold(NOTHING, f32::max);
        let removed = removed.reduce_add();
        (removed > 0.0).then_some(Chip { top, removed, most, each })
    }
}

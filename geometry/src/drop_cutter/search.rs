//! Branch and bound over a field: which nodes can matter to one cutter location.
//!
//! From the blocks under the cutter's shadow down to single nodes, whatever a [`Probe`] can show to
//! stay clear of the cutter at the best height found so far is left out. The bounds are computed
//! four at a time in f32 on lengths relative to the cutter's radius R, rounded to the safe side;
//! heights that count are computed by the probe in f64.
//!
//! | symbol | meaning |
//! |---|---|
//! | q | pitch / R |
//! | d² | squared distance in plan between the axis and the nearest node of a block, / R² |
//! | rise | greatest height of the block, raised by its [`Bulge`] if it has one, − height of the tip, / R |

use super::best::Best;
use super::bulge::Bulge;
use super::pyramid::{FACTOR, Pyramid};
use crate::{HeightField, Tick};
use glam::DVec2;
use wide::f32x4;

/// Relative allowance for f32: distances are lowered by this share of R and of the block's size,
/// rises are raised by this share. Each is the result of at most five roundings of 6e-8.
const ROUNDING: f32 = 1e-6;

/// The search starts at the lowest level at which the shadow is at most this many blocks wide.
/// Found by trial: with fewer, more useless children are looked at; with more, more blocks.
const TOP_BLOCKS: f64 = 5.0;

/// What is asked of the nodes and blocks in the shadow of a cutter.
pub(super) trait Probe {
    /// How far beyond the shadow blocks are looked at, / R.
    fn reach(&self) -> f64;

    /// Which of four blocks can matter, as bits: `x` and `y`, not negative, are the least distances
    /// of their nodes from the axis, / R, `rise` as in the module's table, all on the safe side.
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32;

    /// Drops the cutter on what belongs to node (i, j).
    fn visit(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best);

    /// Drops the cutter on some of what belongs to node (i, j), for a first height.
    #[inline]
    fn glance(&self, ground: &Ground, at: DVec2, i: usize, j: usize, best: &mut Best) {
        self.visit(ground, at, i, j, best);
    }
}

/// A field made ready for cutters of one radius.
pub(super) struct Ground<'a> {
    pub(super) heights: &'a [f32],
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) pitch: f64,
    /// 1 / pitch.
    pub(super) per_pitch: f64,
    pyramid: Pyramid,
    /// What the nodes of each block of level 1 are raised by, in mm; empty if they are not.
    bulges: Vec<f32>,
    radius: f64,
    /// 1 / R, raised.
    per_radius: f32,
    start_level: usize,
    /// One for each level up to the start.
    scales: Vec<Scale>,
}

impl<'a> Ground<'a> {
    /// Builds the index, with nodes raised by their bulges if these are asked for. `None` if cancelled.
    pub(super) fn new(
        field: &'a HeightField,
        radius: f64,
        bulge: Option<&Bulge>,
        tick: Tick,
    ) -> Option<Self> {
        let bulges = bulge.map_or(Some(Vec::new()), |bulge| bulge.of_blocks(field, tick))?;
        let pyramid = Pyramid::build(field, &bulges, tick)?;
        let mut start_level = 1;
        let mut side = FACTOR as f64 * field.pitch_mm();
        while 2.0 * radius > TOP_BLOCKS * side && start_level < pyramid.top() {
            start_level += 1;
            side *= FACTOR as f64;
        }
        Some(Self {
            heights: field.heights(),
            columns: field.columns(),
            rows: field.rows(),
            pitch: field.pitch_mm(),
            per_pitch: 1.0 / field.pitch_mm(),
            pyramid,
            bulges,
            radius,
            per_radius: (1.0 / radius) as f32 * (1.0 + ROUNDING),
            start_level,
            scales: (0..=start_level).map(|l| Scale::new(field.pitch_mm() / radius, l)).collect(),
        })
    }

    /// What the nodes of block (i, j) of level 1 are raised by, / R.
    #[inline]
    fn bulge(&self, i: usize, j: usize) -> f32 {
        let block = j * self.pyramid.level(1).columns + i;
        self.bulges.get(block).map_or(0.0, |bulge| bulge * self.per_radius)
    }

    /// Height of node (i, j), in mm.
    #[inline]
    pub(super) fn height(&self, i: usize, j: usize) -> f64 {
        f64::from(self.heights[j * self.columns + i])
    }

    /// The node nearest to a place.
    #[inline]
    pub(super) fn nearest(&self, at: DVec2) -> (usize, usize) {
        // The cast of a negative number is 0.
        let along = |x: f64, count: usize| ((x * self.per_pitch + 0.5) as usize).min(count - 1);
        (along(at.x, self.columns), along(at.y, self.rows))
    }

    /// Visits all nodes that can raise `best` for a cutter at `at`.
    #[inline]
    pub(super) fn search<P: Probe>(&self, probe: &P, at: DVec2, best: &mut Best) {
        let level = self.start_level;
        let scale = &self.scales[level];
        let blocks = self.pyramid.level(level);
        let walk = Walk { ground: self, probe, at, axis: at / self.radius };
        let reach = 1.0 + probe.reach() + f64::from(ROUNDING) * scale.side;
        let Some((i0, i1)) = blocks_within(walk.axis.x, reach, scale.side, blocks.columns) else {
            return;
        };
        let Some((j0, j1)) = blocks_within(walk.axis.y, reach, scale.side, blocks.rows) else {
            return;
        };
        for i in (i0..=i1).step_by(FACTOR) {
            for j in (j0..=j1).step_by(2 * FACTOR) {
                walk.search_blocks(scale, level, (i, j), (j1 - j + 1).min(2 * FACTOR), best);
            }
        }
    }

    /// The heights of nodes (i, j) to (i + 3, j), −∞ for those beyond the border.
    #[inline]
    fn four(&self, i: usize, j: usize) -> f32x4 {
        let start = j * self.columns + i;
        if i + FACTOR <= self.columns
            && let Some(four) = self.heights[start..].first_chunk()
        {
            return f32x4::from(*four);
        }
        let mut four = [f32::NEG_INFINITY; FACTOR];
        let row = &self.heights[start..(j + 1) * self.columns];
        for (to, from) in four.iter_mut().zip(row) {
            *to = *from;
        }
        f32x4::from(four)
    }
}

/// First and last of `count` blocks that overlap the range from `middle - reach` to
/// `middle + reach`.
#[inline]
fn blocks_within(middle: f64, reach: f64, side: f64, count: usize) -> Option<(usize, usize)> {
    let (from, to) = ((middle - reach) / side, (middle + reach) / side);
    // Casts cut off toward 0, and what is less to 0.
    let overlaps = to >= 0.0 && from < count as f64;
    overlaps.then(|| (from as usize, (to as usize).min(count - 1)))
}

/// Lengths at one level, / R.
struct Scale {
    /// Distance between neighbouring blocks.
    side: f64,
    /// Distance between the first and the last node of a block.
    spread: f32,
    /// What distances are lowered by.
    rounding: f32,
}

impl Scale {
    fn new(pitch: f64, level: usize) -> Self {
        let nodes = FACTOR.pow(level as u32) as f64;
        let side = nodes * pitch;
        let rounding = ROUNDING * (1.0 + FACTOR as f32 * side as f32);
        Self { side, spread: ((nodes - 1.0) * pitch) as f32, rounding }
    }
}

struct Walk<'a, P> {
    ground: &'a Ground<'a>,
    probe: &'a P,
    /// Place of the axis, in mm.
    at: DVec2,
    /// The same, / R.
    axis: DVec2,
}

impl<P: Probe> Walk<'_, P> {
    /// Distance along y from the axis to the blocks of row `j`.
    #[inline]
    fn row_distance(&self, scale: &Scale, j: usize) -> f32x4 {
        let low = (j as f64 * scale.side - self.axis.y) as f32;
        least_distance(f32x4::splat(low), scale)
    }

    /// How far heights are above the tip, / R.
    #[inline]
    fn rise(&self, heights: f32x4, best: &Best) -> f32x4 {
        (heights - f32x4::splat(best.low)) * f32x4::splat(self.ground.per_radius)
    }

    /// Which of the blocks from `i` on can matter.
    #[inline]
    fn test(&self, scale: &Scale, y: f32x4, i: usize, rise: f32x4) -> u32 {
        let first = (i as f64 * scale.side - self.axis.x) as f32;
        let side = scale.side as f32;
        let low = f32x4::splat(first) + f32x4::from([0.0, side, 2.0 * side, 3.0 * side]);
        let x = least_distance(low, scale);
        self.probe.may_touch(x, y, rise)
    }

    /// Looks at four columns and up to eight rows of blocks at the start level.
    #[inline]
    fn search_blocks(
        &self,
        scale: &Scale,
        level: usize,
        (i, j): (usize, usize),
        rows: usize,
        best: &mut Best,
    ) {
        // All tests first, without a branch between them.
        let blocks = self.ground.pyramid.level(level);
        let mut hits = 0_u32;
        for row in 0..rows {
            let y = self.row_distance(scale, j + row);
            let rise = self.rise(blocks.four(i, j + row), best);
            hits |= self.test(scale, y, i, rise) << (row * FACTOR);
        }
        while hits != 0 {
            let k = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            self.descend(level - 1, i + k % FACTOR, j + k / FACTOR, best);
        }
    }

    /// Looks at the children, at `level`, of a block of the level above.
    fn descend(&self, level: usize, i: usize, j: usize, best: &mut Best) {
        let scale = &self.ground.scales[level];
        if level == 0 {
            return self.descend_to_nodes(scale, i * FACTOR, j * FACTOR, best);
        }
        let blocks = self.ground.pyramid.level(level);
        let i = i * FACTOR;
        for j in j * FACTOR..(j * FACTOR + FACTOR).min(blocks.rows) {
            let y = self.row_distance(scale, j);
            let rise = self.rise(blocks.four(i, j), best);
            let mut hits = self.test(scale, y, i, rise);
            while hits != 0 {
                let k = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                self.descend(level - 1, i + k, j, best);
            }
        }
    }

    #[inline]
    fn descend_to_nodes(&self, scale: &Scale, i: usize, j: usize, best: &mut Best) {
        // All tests first, without a branch between them.
        let bulge = f32x4::splat(self.ground.bulge(i / FACTOR, j / FACTOR));
        let mut hits = 0_u32;
        for row in 0..FACTOR.min(self.ground.rows - j) {
            let y = self.row_distance(scale, j + row);
            let rise = self.rise(self.ground.four(i, j + row), best) + bulge;
            hits |= self.test(scale, y, i, rise) << (row * FACTOR);
        }
        while hits != 0 {
            let k = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            self.probe.visit(self.ground, self.at, i + k % FACTOR, j + k / FACTOR, best);
        }
    }
}

/// Least distance from the axis of nodes that begin at `low`, on the safe side.
#[inline]
fn least_distance(low: f32x4, scale: &Scale) -> f32x4 {
    let beyond = low.fast_max(-low - f32x4::splat(scale.spread));
    (beyond - f32x4::splat(scale.rounding)).fast_max(f32x4::ZERO)
}

//! Branch and bound over things that lie anywhere: which triangles or points can matter to one
//! cutter location.
//!
//! # Method
//! The things are put in an order in which neighbours lie near each other in space: the whole is
//! halved across the longest way between its middles, and so are the halves, down to fours (a
//! k-d tree by medians: Bentley 1975, here of boxes). The halves are cut at whole blocks of a power
//! of four, so that the tree needs no pointers: four neighbours have one parent, whose number is
//! theirs over four. The cut across z separates the underside of a solid from its top, and the search
//! then passes the former by.
//!
//! Of each box only its extent in plan and what is above it are kept, four boxes side by side: the
//! bottom does not matter to a cutter that comes from above. Above it are a level top and a tilted
//! *lid*, a plane below which all of it lies. On a slope a box of width w has w·slope of air below its
//! top, and some √(R·slope/w) boxes around the contact could not be told apart by it; under a lid
//! there is only what the surface curves within the box.
//!
//! Lengths are relative to the cutter's radius R and the middle of the whole, in f32 rounded to the
//! safe side. A box that a [`LidGauge`] shows to stay clear of the cutter at the best height found so
//! far is left out, and of the four with one parent the one that comes nearest is looked at first.
//!
//! # Limits
//! * 43 bytes of index a thing; 20 bytes more while it is built. At most 2³² things.
//! * Things that are much larger than their neighbours make the boxes above them large.

use super::best::Best;
use super::lids::{LidGauge, Lids};
use crate::Tick;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use wide::f32x4;

/// Children of a box.
const FACTOR: usize = 4;

/// Relative allowance for f32: more than the few roundings of 6e-8 between what is stored and what a
/// gauge compares.
const ROUNDING: f32 = 1e-6;

/// Fewer things than this are put in order by one thread: a task costs some microseconds.
const WORTH_A_TASK: usize = 4096;

/// Lids are not steeper than this: beyond, a top is as good, and rounding grows with the slope.
const STEEPEST_LID: f64 = 4.0;

/// Corners of a thing in mm, finite: three, some of them equal if it has fewer.
pub(super) type Corners = [DVec3; 3];

/// From the corner of a box with the least coordinates to the one with the greatest, in mm.
type Extent = [DVec3; 2];

/// Four boxes, / R from the middle.
#[derive(Clone, Copy)]
struct Four {
    x: [f32x4; 2],
    y: [f32x4; 2],
    top: f32x4,
    /// Height of the lid amid the box.
    lid: f32x4,
    slope: [f32x4; 2],
}

/// A box, as in [`Four`].
#[derive(Clone, Copy)]
struct Lidded {
    x: [f32; 2],
    y: [f32; 2],
    top: f32,
    lid: f32,
    slope: [f32; 2],
}

/// The middle of a thing, by which it is put in order.
#[derive(Clone, Copy)]
struct Seed {
    middle: [f32; 3],
    item: u32,
}

/// What no cutter can touch. The sides are finite, so that no difference is NaN.
const NOTHING: Lidded = Lidded {
    x: [f32::MAX, f32::MIN],
    y: [f32::MAX, f32::MIN],
    top: f32::NEG_INFINITY,
    lid: f32::NEG_INFINITY,
    slope: [0.0; 2],
};

/// Things in order, and boxes above them, for cutters of one radius.
pub(super) struct Boxes {
    /// The boxes of the things first, fours of siblings; the last level is a single four.
    levels: Vec<Vec<Four>>,
    middle: DVec3,
    per_radius: f64,
}

impl Boxes {
    /// Builds the index of `count` things, and tells their order: thing k of the index is the
    /// `order[k]`th of the caller's. `None` if cancelled.
    pub(super) fn build(
        count: usize,
        corners: impl Fn(usize) -> Corners + Sync,
        radius: f64,
        tick: Tick,
    ) -> Option<(Self, Vec<u32>)> {
        let extent = |k: usize| extent(&corners(k));
        let whole = (0..count).into_par_iter().map(extent).reduce_with(join);
        let [low, high] = whole.unwrap_or([DVec3::ZERO; 2]);
        let frame = Frame { middle: low / 2.0 + high / 2.0, per_radius: 1.0 / radius };
        let seed = |k: usize| {
            let [low, high] = extent(k);
            let middle = (low / 2.0 + high / 2.0 - frame.middle) * frame.per_radius;
            Seed { middle: middle.to_array().map(|v| v as f32), item: k as u32 }
        };
        let mut seeds: Vec<Seed> = (0..count).into_par_iter().map(seed).collect();
        put_in_order(&mut seeds, tick)?;
        let four = |seeds: &[Seed]| {
            Four::of(seeds.iter().map(|seed| frame.lidded(&corners(seed.item as usize))))
        };
        let mut things: Vec<Four> = seeds.par_chunks(FACTOR).map(four).collect();
        if things.is_empty() {
            things.push(Four::of(std::iter::empty()));
        }
        let mut levels = vec![things];
        let order = seeds.into_par_iter().map(|seed| seed.item).collect();
        while let Some(last) = levels.last().filter(|last| last.len() > 1) {
            let four = |fours: &[Four]| Four::of(fours.iter().map(Four::around));
            levels.push(last.par_chunks(FACTOR).map(four).collect());
            tick(0).then_some(())?;
        }
        Some((Self { levels, middle: frame.middle, per_radius: frame.per_radius }, order))
    }

    /// Calls `visit` for all things that can raise `best` for a cutter at `at`.
    #[inline]
    pub(super) fn search(
        &self,
        gauge: &impl LidGauge,
        at: DVec2,
        best: &mut Best,
        visit: &impl Fn(usize, &mut Best),
    ) {
        let walk = Walk { boxes: self, gauge, axis: self.axis(at), visit };
        walk.descend(self.levels.len() - 1, 0, best);
    }

    /// Something high and near a place, for a first height; `None` if nothing is near.
    pub(super) fn likely(&self, at: DVec2) -> Option<usize> {
        let axis = self.axis(at);
        let mut k = 0;
        for level in self.levels.iter().rev() {
            let (x, y) = (axis.x.distance(level[k].x), axis.y.distance(level[k].y));
            let d2 = x * x + y * y;
            // What a ball of radius 1 would be raised by, nearly.
            let likely = (level[k].top - d2 * f32x4::splat(0.5)).to_array();
            let d2 = d2.to_array();
            let near = (0..FACTOR).filter(|&lane| d2[lane] < 1.0);
            k = k * FACTOR + near.max_by(|&a, &b| likely[a].total_cmp(&likely[b]))?;
        }
        Some(k)
    }

    fn axis(&self, at: DVec2) -> Axis {
        let at = (at - self.middle.truncate()) * self.per_radius;
        Axis { x: Along::new(at.x), y: Along::new(at.y) }
    }
}

fn join([low, high]: Extent, [other_low, other_high]: Extent) -> Extent {
    [low.min(other_low), high.max(other_high)]
}

/// A number in f32, not above itself; finite or −∞.
fn below(v: f64) -> f32 {
    let near = v as f32;
    if f64::from(near) > v { near.next_down() } else { near }
}

/// A number in f32, not below itself; finite or +∞.
fn above(v: f64) -> f32 {
    -below(-v)
}

struct Frame {
    middle: DVec3,
    per_radius: f64,
}

impl Frame {
    /// The box of a thing, with a lid as steep as its plane.
    fn lidded(&self, corners: &Corners) -> Lidded {
        let seen = corners.map(|corner| (corner - self.middle) * self.per_radius);
        let [low, high] = extent(&seen);
        let (x, y) = ([below(low.x), above(high.x)], [below(low.y), above(high.y)]);
        let (slope, amid) = (slope_of_lid(&seen), amid(x, y));
        let lid = seen.map(|corner| corner.z + slope.dot(amid - corner.truncate()));
        let lid = above(lid.into_iter().fold(f64::NEG_INFINITY, f64::max));
        Lidded { x, y, top: above(high.z), lid, slope: slope.to_array().map(|v| v as f32) }
    }
}

fn extent([a, b, c]: &Corners) -> Extent {
    [a.min(*b).min(*c), a.max(*b).max(*c)]
}

/// The slope of a triangle's plane, or of a lid that is not too steep.
fn slope_of_lid([a, b, c]: &Corners) -> DVec2 {
    let normal = (b - a).cross(c - a);
    let slope = normal.truncate() / -normal.z;
    if slope.is_finite() { in_f32(slope.clamp_length_max(STEEPEST_LID)) } else { DVec2::ZERO }
}

/// What is left in f32: a lid is computed from the slope that is stored.
fn in_f32(slope: DVec2) -> DVec2 {
    DVec2::new(f64::from(slope.x as f32), f64::from(slope.y as f32))
}

/// The middle of a rectangle, as the search computes it.
fn amid(x: [f32; 2], y: [f32; 2]) -> DVec2 {
    let [x, y] = [x, y].map(|[low, high]| low * 0.5 + high * 0.5);
    DVec2::new(f64::from(x), f64::from(y))
}

impl Lidded {
    fn amid(&self) -> DVec2 {
        amid(self.x, self.y)
    }

    /// From the middle to the sides.
    fn half(&self) -> DVec2 {
        let [x, y] = [self.x, self.y].map(|[low, high]| f64::from(high) - f64::from(low));
        DVec2::new(x, y) * f64::from(0.5 + ROUNDING)
    }

    fn slope(&self) -> DVec2 {
        DVec2::new(f64::from(self.slope[0]), f64::from(self.slope[1]))
    }

    /// The box around boxes. Its lid has their mean slope, weighted by their area in plan.
    fn around(boxes: [Self; FACTOR]) -> Self {
        let boxes = boxes.into_iter().filter(|one| one.top > f32::NEG_INFINITY);
        let (mut all, mut slope, mut area) = (NOTHING, DVec2::ZERO, 0.0);
        for one in boxes.clone() {
            let join = |[a, b]: [f32; 2], [c, d]: [f32; 2]| [a.min(c), b.max(d)];
            (all.x, all.y) = (join(all.x, one.x), join(all.y, one.y));
            all.top = all.top.max(one.top);
            let share = one.half().x * one.half().y;
            (slope, area) = (slope + one.slope() * share, area + share);
        }
        let mean = slope / area;
        // Points have no area.
        let slope = if mean.is_finite() { in_f32(mean) } else { DVec2::ZERO };
        for one in boxes {
            let differs = (one.slope() - slope).abs().dot(one.half());
            let lid = f64::from(one.lid) + slope.dot(all.amid() - one.amid()) + differs;
            all.lid = all.lid.max(above(lid));
        }
        all.slope = slope.to_array().map(|v| v as f32);
        all
    }
}

impl Four {
    /// Up to four boxes.
    fn of(boxes: impl Iterator<Item = Lidded>) -> Self {
        let mut four = [NOTHING; FACTOR];
        for (to, from) in four.iter_mut().zip(boxes) {
            *to = from;
        }
        let lanes = |value: fn(&Lidded) -> f32| f32x4::from([0, 1, 2, 3].map(|k| value(&four[k])));
        Self {
            x: [lanes(|b| b.x[0]), lanes(|b| b.x[1])],
            y: [lanes(|b| b.y[0]), lanes(|b| b.y[1])],
            top: lanes(|b| b.top),
            lid: lanes(|b| b.lid),
            slope: [lanes(|b| b.slope[0]), lanes(|b| b.slope[1])],
        }
    }

    /// The box around all.
    fn around(&self) -> Lidded {
        let lane = |v: f32x4, k: usize| v.to_array()[k];
        let pair = |[a, b]: [f32x4; 2], k: usize| [lane(a, k), lane(b, k)];
        Lidded::around([0, 1, 2, 3].map(|k| Lidded {
            x: pair(self.x, k),
            y: pair(self.y, k),
            top: lane(self.top, k),
            lid: lane(self.lid, k),
            slope: pair(self.slope, k),
        }))
    }
}

/// Puts seeds in the order of the tree. `None` if cancelled.
fn put_in_order(seeds: &mut [Seed], tick: Tick) -> Option<()> {
    if seeds.len() <= FACTOR {
        return Some(());
    }
    let (axis, block) = (longest_way(seeds), FACTOR.pow((seeds.len() - 1).ilog(FACTOR)));
    let half = seeds.len().div_ceil(block).div_ceil(2) * block;
    let along = |a: &Seed, b: &Seed| a.middle[axis].total_cmp(&b.middle[axis]);
    // Ties by number, so that the order does not depend on how the standard library selects.
    seeds.select_nth_unstable_by(half, |a, b| along(a, b).then(a.item.cmp(&b.item)));
    let (low, high) = seeds.split_at_mut(half);
    if low.len() + high.len() < WORTH_A_TASK {
        put_in_order(low, tick)?;
        return put_in_order(high, tick);
    }
    tick(0).then_some(())?;
    let (low, high) = rayon::join(|| put_in_order(low, tick), || put_in_order(high, tick));
    low.and(high)
}

/// The axis along which the middles lie farthest apart.
fn longest_way(seeds: &[Seed]) -> usize {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for seed in seeds {
        for k in 0..3 {
            low[k] = low[k].min(seed.middle[k]);
            high[k] = high[k].max(seed.middle[k]);
        }
    }
    let way = |k: usize| high[k] - low[k];
    let longer = |a: usize, b: usize| if way(b) > way(a) { b } else { a };
    longer(longer(0, 1), 2)
}

/// Place of a cutter's axis, / R from the middle.
struct Axis {
    x: Along,
    y: Along,
}

/// One coordinate of the axis.
struct Along {
    /// Rounded down and up.
    around: [f32x4; 2],
    /// Rounded, and what that takes away.
    parts: [f32x4; 2],
}

impl Along {
    fn new(v: f64) -> Self {
        let near = v as f32;
        let parts = [near, (v - f64::from(near)) as f32];
        Self { around: [below(v), above(v)].map(f32x4::splat), parts: parts.map(f32x4::splat) }
    }

    /// Least distances of boxes from the axis, on the safe side.
    #[inline]
    fn distance(&self, [low, high]: [f32x4; 2]) -> f32x4 {
        let [down, up] = self.around;
        let beyond = (low - up).fast_max(down - high);
        beyond.fast_max(f32x4::ZERO) * f32x4::splat(1.0 - ROUNDING)
    }

    /// Middles of boxes, from the axis.
    #[inline]
    fn middle(&self, [low, high]: [f32x4; 2]) -> f32x4 {
        let half = f32x4::splat(0.5);
        ((low * half + high * half) - self.parts[0]) - self.parts[1]
    }
}

struct Walk<'a, G, V> {
    boxes: &'a Boxes,
    gauge: &'a G,
    axis: Axis,
    visit: &'a V,
}

impl<G: LidGauge, V: Fn(usize, &mut Best)> Walk<'_, G, V> {
    /// Looks at the fours with one parent, what is likeliest to touch first.
    fn descend(&self, level: usize, k: usize, best: &mut Best) {
        let before = best.tip;
        let (mut hits, clearance) = self.test(&self.boxes.levels[level][k], best);
        while hits != 0 {
            let lane = least(hits, &clearance);
            hits &= !(1 << lane);
            if clearance[lane] >= -self.raised(before, best.tip) {
                // So it is with those that are left.
                return;
            }
            let child = k * FACTOR + lane;
            if level == 0 {
                (self.visit)(child, best);
            } else {
                self.descend(level - 1, child, best);
            }
        }
    }

    /// How much higher a tip is than another, / R and rounded down; 0 if there was none before.
    #[inline]
    fn raised(&self, before: f64, tip: f64) -> f32 {
        let raised = ((tip - before) * self.boxes.per_radius) as f32 * (1.0 - ROUNDING);
        if before.is_finite() { raised } else { 0.0 }
    }

    /// Which of four boxes can matter, and how far they stay clear at least.
    #[inline]
    fn test(&self, four: &Four, best: &Best) -> (u32, [f32; FACTOR]) {
        let (x, y) = (self.axis.x.distance(four.x), self.axis.y.distance(four.y));
        let tip = (best.tip - self.boxes.middle.z) * self.boxes.per_radius;
        // Finite, so that −∞, which stands for no box, is below it.
        let low = f32x4::splat(below(tip).max(f32::MIN));
        let rise = (four.top - low) * f32x4::splat(1.0 + ROUNDING);
        let hits = self.gauge.may_touch(x, y, rise);
        if hits == 0 {
            return (0, [0.0; FACTOR]);
        }
        let half = |[low, high]: [f32x4; 2]| (high - low) * f32x4::splat(0.5 + ROUNDING);
        let lids = Lids {
            x: self.axis.x.middle(four.x),
            y: self.axis.y.middle(four.y),
            half_x: half(four.x),
            half_y: half(four.y),
            rise: four.lid - low,
            slope_x: four.slope[0],
            slope_y: four.slope[1],
        };
        let clearance = self.gauge.clearance(&lids);
        (hits & !clearance.simd_ge(f32x4::ZERO).to_bitmask(), clearance.to_array())
    }
}

/// The lane with the least value of those in `hits`, which are not none.
#[inline]
fn least(hits: u32, values: &[f32; FACTOR]) -> usize {
    let first = hits.trailing_zeros() as usize;
    let mut rest = hits & (hits - 1);
    let mut least = first;
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize;
        rest &= rest - 1;
        if values[lane] < values[least] {
            least = lane;
        }
    }
    least
}

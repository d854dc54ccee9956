//! How far the triangles of a field's mesh may bulge up to a ball between their nodes.
//!
//! Where a ball touches a triangle or an edge it has a slope g, and so its axis is r = g/√(1 + g²) away
//! (lengths / R). Some node of what is touched is within w = q/√2 of the contact, the radius of the
//! circle about a triangle, and since h″ rises with r its clearance is at most
//!
//! bulge(r) = h(r + w) − h(r) − w·h′(r).
//!
//! On an edge g lies between the slopes of the triangles beside it, and the bulge rises with r. So the
//! steepest triangle around a node tells how much the node must be raised for its gauge to see all that
//! is touched around it. One number serves a block of nodes.
//!
//! That holds for contacts up to `far` from the axis. At any other the ball has risen by `least_rise`: the
//! highest node of what is touched rises by more, and is no farther from the contact than a pitch along
//! either axis. Beyond the border there is nothing that an edge's slope would lie below: it counts as
//! upright.
//!
//! # Limits
//! For corners of bull noses it does not pay: their slope grows without bound within a few pitches, so
//! that nearly all triangles are of the second kind. Other shapes are gauged by their highest nodes.

use super::gauge::{BallGauge, Gauge, Nearer, ROUND_UP};
use super::pyramid::{FACTOR, greater};
use crate::{HeightField, Tick};
use rayon::prelude::*;
use wide::f32x4;

/// `far`, as a share of 1 − w, toward which the slope of the bulge grows without bound. Found by trial;
/// 0.8 to 0.95 take within 5 % of each other.
const FAR: f64 = 0.9;

/// With a greater w, half of R, few contacts are within `far`.
const GREATEST_W: f64 = 0.5;

/// Added to bulges, / R: far more than what rounding takes from heights near the cutter.
const ROUNDING: f64 = 1e-6;

/// Bulges towards a ball on meshes of one pitch. Lengths are relative to R, unless said otherwise.
pub(super) struct Bulge {
    /// R in mm.
    radius: f64,
    pitch: f64,
    w: f64,
    far: f64,
}

impl Bulge {
    /// For a ball and a pitch in mm; `None` if the ball is too small for this to be of use.
    pub(super) fn new(radius: f64, pitch_mm: f64) -> Option<Self> {
        let pitch = pitch_mm / radius;
        let w = pitch * std::f64::consts::FRAC_1_SQRT_2 * ROUND_UP;
        (w < GREATEST_W).then_some(Self { radius, pitch, w, far: (1.0 - w) * FAR })
    }

    /// What tells whether raised nodes can matter.
    pub(super) fn gauge(&self) -> BulgeGauge {
        BulgeGauge {
            least_rise: (height(self.far) / ROUND_UP) as f32,
            pitch: (self.pitch * ROUND_UP) as f32,
        }
    }

    /// The bulge of each block of [`FACTOR`]² nodes in mm, row by row. `None` if cancelled.
    pub(super) fn of_blocks(&self, field: &HeightField, tick: Tick) -> Option<Vec<f32>> {
        let columns = field.columns().div_ceil(FACTOR);
        let mut bulges = vec![0.0; columns * field.rows().div_ceil(FACTOR)];
        let per_pitch2 = field.pitch_mm().powi(-2);
        bulges.par_chunks_mut(columns).enumerate().try_for_each_init(
            Vec::new,
            |steepest, (block_row, bulges)| {
                steepest_of_columns(field, block_row, steepest);
                for (bulge, cells) in
                    bulges.iter_mut().zip(steepest.windows(FACTOR + 1).step_by(FACTOR))
                {
                    let rise2 = cells.iter().copied().fold(0.0, greater);
                    *bulge = (self.at_slope2(f64::from(rise2) * per_pitch2) * self.radius) as f32;
                }
                tick(0).then_some(())
            },
        )?;
        Some(bulges)
    }

    /// The bulge where triangles have squared slopes up to this.
    fn at_slope2(&self, slope2: f64) -> f64 {
        // Of an upright one: far.
        let r = (1.0 / (1.0 + 1.0 / (slope2 * ROUND_UP))).sqrt().min(self.far);
        let slope = r / (1.0 - r * r).sqrt();
        (height(r + self.w) - height(r) - self.w * slope) * ROUND_UP + ROUNDING
    }
}

/// h of a ball.
fn height(r: f64) -> f64 {
    1.0 - (1.0 - r * r).sqrt()
}

/// The greatest squared rise over a pitch of the triangles around a row of blocks, in each column of
/// cells: first that before the field, last that behind the last block.
fn steepest_of_columns(field: &HeightField, block_row: usize, steepest: &mut Vec<f32>) {
    let (cells, last) = (field.columns() - 1, field.rows() - 1);
    let (from, to) = (block_row * FACTOR, (block_row + 1) * FACTOR);
    let at_border = from == 0 || to > last;
    steepest.clear();
    steepest.resize(field.columns().next_multiple_of(FACTOR) + 1, f32::INFINITY);
    if at_border {
        return;
    }
    let inside = &mut steepest[1..=cells];
    inside.fill(0.0);
    for j in from - 1..to {
        let (near, far) = (field.row(j), field.row(j + 1));
        let corners = near.windows(2).zip(far.windows(2));
        for (steepest, (near, far)) in inside.iter_mut().zip(corners) {
            let rise2 = |x: f32, y: f32| x * x + y * y;
            let right = rise2(near[1] - near[0], far[1] - near[1]);
            let left = rise2(far[1] - far[0], far[0] - near[0]);
            *steepest = greater(*steepest, greater(right, left));
        }
    }
}

/// A ball nose against nodes that were raised by their bulges.
pub(super) struct BulgeGauge {
    least_rise: f32,
    pitch: f32,
}

impl Gauge for BulgeGauge {
    #[inline]
    fn may_touch(&self, x: f32x4, y: f32x4, rise: f32x4) -> u32 {
        let high = rise.simd_gt(f32x4::splat(self.least_rise));
        Nearer { by: high & f32x4::splat(self.pitch), gauge: BallGauge }.may_touch(x, y, rise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    const Q: f64 = 0.14;

    #[test]
    fn a_node_of_a_touched_triangle_is_within_the_bulge() {
        let bulge = Bulge::new(1.0, Q).unwrap();
        let corners = [DVec2::ZERO, DVec2::new(Q, 0.0), DVec2::new(Q, Q)];
        let mut random = fastrand::Rng::with_seed(11);
        let (mut most, mut count) = (0.0_f64, 0);
        while count < 20_000 {
            let [a, b] = [random.f64(), random.f64()];
            let place = DVec2::new(a.max(b), a.min(b)) * Q;
            let out = DVec2::from_angle(random.f64() * 7.0) * random.f64() * bulge.far;
            let slope = out / (1.0 - out.length_squared()).sqrt();
            let clearance = |corner: DVec2| {
                let way = corner - place;
                height((out + way).length()) - height(out.length()) - slope.dot(way)
            };
            let least = corners.map(clearance).into_iter().fold(f64::INFINITY, f64::min);
            let bound = bulge.at_slope2(slope.length_squared());
            assert!(least <= bound, "{out} {place}: {least} {bound}");
            most = most.max(least / bound);
            count += 1;
        }
        assert!(most > 0.8, "the bound is {most} of what is needed");
    }

    #[test]
    fn a_block_has_the_bulge_of_the_steepest_triangle_around() {
        let (columns, rows) = (23, 18);
        let mut random = fastrand::Rng::with_seed(12);
        let heights = (0..columns * rows).map(|_| random.f32() * 0.3).collect();
        let field = HeightField::new(columns, rows, 0.4, heights).unwrap();
        let bulge = Bulge::new(3.0, 0.4).unwrap();
        let bulges = bulge.of_blocks(&field, &|_| true).unwrap();
        let z = |i: usize, j: usize| f64::from(field.row(j)[i]);
        let slope2 = |i: usize, j: usize| {
            let of = |x: f64, y: f64| (x * x + y * y) / (0.4 * 0.4);
            let right = of(z(i + 1, j) - z(i, j), z(i + 1, j + 1) - z(i + 1, j));
            right.max(of(z(i + 1, j + 1) - z(i, j + 1), z(i, j + 1) - z(i, j)))
        };
        assert_eq!(bulges.len(), 6 * 5);
        for (k, &found) in bulges.iter().enumerate() {
            let (i, j) = (k % 6 * 4, k / 6 * 4);
            let at_border = i == 0 || j == 0 || i + 4 >= columns || j + 4 >= rows;
            let cells = (0..25).map(|c| (i + c % 5, j + c / 5));
            let steepest = if at_border {
                f64::INFINITY
            } else {
                cells.map(|(i, j)| slope2(i - 1, j - 1)).fold(0.0, f64::max)
            };
            let expected = bulge.at_slope2(steepest) * 3.0;
            assert!((f64::from(found) - expected).abs() < 1e-6, "{i} {j}: {found} {expected}");
        }
    }
}

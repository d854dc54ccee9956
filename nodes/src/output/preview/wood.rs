//! The colour of a board of walnut, by place.
//!
//! The tree's rings are cones about a pith that runs below the board, a little askew to it and bent
//! by slow noise. What shows is the section of these cones with the carved surface, so the figure
//! arches along the board and runs around whatever stands up, as it does on a real carving. Fibres
//! and pores are noise drawn out along the grain. All of it is a function of the place alone.
//!
//! Lengths are in shares of the board's longest side, so that boards of every size look alike.

use super::color::{Linear, linear, mix, smooth_step, unit_hash};
use super::resample::Raster;

/// Rings across the longest side: about 3 mm each on a plaque of 200 mm.
const RINGS: f32 = 76.0;
/// How far below the board's face the pith runs at the middle of its length.
const PITH_DEPTH: f32 = 0.34;
/// How far the pith runs beside the middle: a figure that is not quite even looks grown.
const PITH_ASIDE: f32 = 0.3;
/// How much deeper the pith lies for each step along the grain: this makes the arches.
const PITH_TILT: f32 = 0.16;

/// How much the figure follows the relief, whose heights are already exaggerated: more, and the rings
/// pass for steps in the surface.
const FOLLOW: f32 = 0.3;

/// Colours of walnut under an oil finish, and how its pith bends.
pub(super) struct Wood {
    early: Linear,
    late: Linear,
    pore: Linear,
    bend: Raster,
}

/// Steps of the table of bends along the longest side; its noise has no more than nine waves there.
const BEND_STEPS: usize = 128;

impl Wood {
    /// Walnut.
    pub(super) fn walnut() -> Self {
        let side = BEND_STEPS + 1;
        let place = |i: usize| i as f32 / BEND_STEPS as f32 - 0.5;
        let bend = |(along, across): (f32, f32)| {
            0.05 * noise(along * 1.7, across * 1.1, 1) + 0.012 * noise(along * 6.0, across * 9.0, 2)
        };
        let values = (0..side * side).map(|i| bend((place(i % side), place(i / side)))).collect();
        Self {
            early: linear([160, 116, 81]),
            late: linear([134, 94, 63]),
            pore: linear([82, 57, 39]),
            bend: Raster { width: side, height: side, values },
        }
    }

    /// Colour at `along` the grain and `across` it (-1/2 … 1/2), `z` above the face. `fine` (0 … 1)
    /// is how much of fibres and pores a pixel can show.
    pub(super) fn color(&self, along: f32, across: f32, z: f32, fine: f32) -> Linear {
        let step = |place: f32| (place + 0.5) * BEND_STEPS as f32;
        let bend = self.bend.between(step(along), step(across));
        let depth = PITH_DEPTH + PITH_TILT * along + FOLLOW * z;
        let aside = across - PITH_ASIDE;
        let ring = ((aside * aside + depth * depth).sqrt() + bend) * RINGS;
        // Wood darkens slowly towards the end of the year and starts afresh in spring.
        let (year, age) = split(ring);
        let late = 1.2 * age * age * (1.0 - smooth_step(0.7, 1.0, age));
        let dry = 0.86 + 0.58 * unit_hash(year, 0, 3);
        let fibre = noise(along * 22.0, across * 500.0, 4);
        let body = late * dry + 0.34 * fine * (fibre - 0.5);
        let color = mix(self.early, self.late, body.clamp(0.0, 1.0));
        mix(color, self.pore, 0.26 * fine * smooth_step(0.68, 0.94, fibre))
    }
}

/// Smooth noise from 0 to 1 with one random value a unit square.
fn noise(x: f32, y: f32, seed: u32) -> f32 {
    let ((i, x), (j, y)) = (split(x), split(y));
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (tx, ty) = (ease(x), ease(y));
    let at = |di: u32, dj: u32| unit_hash(i.wrapping_add(di), j.wrapping_add(dj), seed);
    let low = at(0, 0) + (at(1, 0) - at(0, 0)) * tx;
    let high = at(0, 1) + (at(1, 1) - at(0, 1)) * tx;
    low + (high - low) * ty
}

/// The whole number at or below `value`, wrapped to unsigned, and what is left. Several times faster
/// than `floor`, which is a call into the mathematical library on the plainest x86-64.
fn split(value: f32) -> (u32, f32) {
    let whole = value as i32 - i32::from(value < 0.0);
    (whole as u32, value - whole as f32)
}

//! How much of a light each point of a relief sees.
//!
//! For a direction of the compass that goes by whole pixels, such as (1, 0), (1, 1) or (2, 1), the
//! pixels fall into chains that do not touch each other. Along a chain the highest elevation seen
//! looking back is found with the upper convex hull of the points already passed, kept as a stack:
//! every point is pushed once and popped at most once, so the time is linear in the pixels however
//! far a shadow falls (V. Timonen, J. Westerholm, "Scalable Height Field Self-Shadowing",
//! Eurographics 2010, section 4).
//!
//! Limits: beyond the raster nothing stands, and a light is seen along one line, so a light that
//! should cast soft shadows is the sum of several directions.

use super::color::smooth_step;
use super::resample::Raster;
use carvegraph_geometry::Tick;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// A step along a chain, in pixels: x to the right, y down the picture.
type Step = (isize, isize);

/// Chains taken by one task: enough work to hide the cost of starting it.
const CHAINS_PER_TASK: usize = 64;

/// Units of work of [`sunlight`] and [`skylight`] together: one a direction.
pub(super) const LIGHT_WORK: usize = SUN.len() + SKY.len();

/// Directions of the window, from the upper left, and the share of its light that each gives.
const SUN: [(Step, f32); 3] = [((-1, -1), 0.4), ((-2, -1), 0.3), ((-1, -2), 0.3)];
/// Tangents of the elevations between which the window goes from hidden to seen: 27° to 45°.
const SUN_EDGE: (f32, f32) = (0.5, 1.0);
/// Eight directions, none of which edges in pictures often follow, so no star shows around a peak.
const SKY: [Step; 8] = [(2, 1), (1, 2), (-1, 2), (-2, 1), (-2, -1), (-1, -2), (1, -2), (2, -1)];

/// The share of the window's light that reaches each pixel.
pub(super) fn sunlight(relief: &Raster, tick: Tick<'_>) -> Option<Vec<f32>> {
    let mut light = Light::none(relief.values.len());
    for (towards, share) in SUN {
        light.add(relief, towards, |slope| {
            share * (1.0 - smooth_step(SUN_EDGE.0, SUN_EDGE.1, slope))
        });
        tick(1).then_some(())?;
    }
    Some(light.into_values())
}

/// The share of the sky that each pixel sees, computed at half the resolution: it varies slowly.
pub(super) fn skylight(relief: &Raster, tick: Tick<'_>) -> Option<Raster> {
    let half = relief.halved();
    let mut light = Light::none(half.values.len());
    for towards in SKY {
        // The part of a half circle of sky that stands above the horizon, seen as 1 - sin.
        light.add(&half, towards, |slope| {
            (1.0 - slope / (1.0 + slope * slope).sqrt()) / SKY.len() as f32
        });
        tick(1).then_some(())?;
    }
    Some(Raster { values: light.into_values(), ..half })
}

/// Sums over directions of the light that each pixel sees.
///
/// In one direction every pixel lies on exactly one chain and is written once, and directions
/// follow one another: the sums do not depend on the number of threads. The atomics only let
/// several chains share the buffer.
struct Light(Vec<AtomicU32>);

impl Light {
    /// No light yet on `pixels` pixels.
    fn none(pixels: usize) -> Self {
        Self((0..pixels).map(|_| AtomicU32::new(0)).collect())
    }

    /// The light on each pixel.
    fn into_values(self) -> Vec<f32> {
        self.0.into_iter().map(|bits| f32::from_bits(bits.into_inner())).collect()
    }

    /// Adds what comes from `towards`: `seen` turns the tangent of the elevation of the horizon
    /// that way (at least 0) into an amount of light. Heights are in pixels.
    fn add(&mut self, relief: &Raster, towards: Step, seen: impl Fn(f32) -> f32 + Sync) {
        let starts = chain_starts(relief.width, relief.height, towards);
        starts.par_chunks(CHAINS_PER_TASK).for_each_init(Vec::new, |hull, chains| {
            for &start in chains {
                self.add_chain(relief, start, towards, hull, &seen);
            }
        });
    }

    fn add_chain(
        &self,
        relief: &Raster,
        start: (usize, usize),
        towards: Step,
        hull: &mut Vec<(f32, f32)>,
        seen: &impl Fn(f32) -> f32,
    ) {
        hull.clear();
        let (mut x, mut y) = (start.0 as isize, start.1 as isize);
        let pace = (towards.0 as f32).hypot(towards.1 as f32);
        let mut gone = 0.0;
        while (0..relief.width as isize).contains(&x) && (0..relief.height as isize).contains(&y) {
            let pixel = y as usize * relief.width + x as usize;
            let z = relief.values[pixel];
            let light = seen(horizon(hull, gone, z).max(0.0));
            let sum = f32::from_bits(self.0[pixel].load(Relaxed)) + light;
            self.0[pixel].store(sum.to_bits(), Relaxed);
            hull.push((gone, z));
            gone += pace;
            x -= towards.0;
            y -= towards.1;
        }
    }
}

/// The steepest slope from (`gone`, `z`) back to the points of `hull`; drops those that no later
/// point can see as its horizon.
fn horizon(hull: &mut Vec<(f32, f32)>, gone: f32, z: f32) -> f32 {
    let slope_to = |point: &(f32, f32)| (point.1 - z) / (gone - point.0);
    let Some(top) = hull.last() else { return 0.0 };
    let mut slope = slope_to(top);
    while hull.len() > 1 {
        let below = slope_to(&hull[hull.len() - 2]);
        if below < slope {
            break;
        }
        hull.pop();
        slope = below;
    }
    slope
}

/// The pixels with no neighbour one step `towards` the light: there the chains begin.
fn chain_starts(width: usize, height: usize, towards: Step) -> Vec<(usize, usize)> {
    let band = |step: isize, len: usize| match step.unsigned_abs().min(len) {
        n if step < 0 => 0..n,
        n => len - n..len,
    };
    let (columns, rows) = (band(towards.0, width), band(towards.1, height));
    let in_rows = rows.clone().flat_map(|y| (0..width).map(move |x| (x, y)));
    let in_columns = (0..height)
        .filter(|y| !rows.contains(y))
        .flat_map(|y| columns.clone().map(move |x| (x, y)));
    in_rows.chain(in_columns).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heights that look random.
    fn relief(width: usize, height: usize) -> Raster {
        let values = (0..width * height).map(|i| ((i * 7919) % 101) as f32 / 10.0).collect();
        Raster { width, height, values }
    }

    /// The steepest slope towards the light, point by point.
    fn brute_force(relief: &Raster, x: usize, y: usize, towards: Step) -> f32 {
        let pace = (towards.0 as f32).hypot(towards.1 as f32);
        let mut steepest: f32 = 0.0;
        for k in 1.. {
            let (qx, qy) = (x as isize + k * towards.0, y as isize + k * towards.1);
            let inside = (0..relief.width as isize).contains(&qx)
                && (0..relief.height as isize).contains(&qy);
            if !inside {
                break;
            }
            let rise = relief.at(qx as usize, qy as usize) - relief.at(x, y);
            steepest = steepest.max(rise / (k as f32 * pace));
        }
        steepest
    }

    #[test]
    fn horizons_match_brute_force() {
        for (width, height) in [(23, 17), (1, 9), (40, 2), (1, 1)] {
            let relief = relief(width, height);
            for towards in [(1, 0), (0, -1), (-1, -1), (-2, -1), (1, 2), (2, -1)] {
                let mut light = Light::none(width * height);
                light.add(&relief, towards, |slope| slope);
                for (i, found) in light.into_values().into_iter().enumerate() {
                    let expected = brute_force(&relief, i % width, i / width, towards);
                    assert!((found - expected).abs() < 1e-4, "{towards:?} {i}: {found} {expected}");
                }
            }
        }
    }
}

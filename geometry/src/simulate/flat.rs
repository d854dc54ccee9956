//! A flat end mill, swept: over a node the height of the tip at the lowest place of the stroke that is no
//! farther than R.

use super::sweep::{Seen, Sweep};
use wide::f32x8;

/// A flat end mill.
pub(super) struct Flat {
    radius_mm: f64,
    radius2: f32x8,
}

impl Flat {
    /// Of a radius in mm.
    pub(super) fn new(radius_mm: f64) -> Self {
        Self { radius_mm, radius2: f32x8::splat((radius_mm * radius_mm) as f32) }
    }
}

impl Sweep for Flat {
    /// 1 uphill, −1 downhill.
    type Lead = f32x8;

    fn radius(&self) -> f64 {
        self.radius_mm
    }

    fn lead(&self, slope: f64) -> f32x8 {
        f32x8::splat(if slope > 0.0 { 1.0 } else { -1.0 })
    }

    #[inline(always)]
    fn reach2(&self, rise: f32x8) -> f32x8 {
        let all = self.radius2 * f32x8::splat(1.0 + f32::EPSILON);
        rise.simd_gt(f32x8::ZERO).bitselect(all, f32x8::ZERO)
    }

    #[inline(always)]
    fn leave(&self, lead: f32x8, seen: &Seen, s: f32x8, d: f32x8, now: f32x8) -> f32x8 {
        let rho2 = self.radius2 - d * d;
        let rho = rho2.fast_max(f32x8::ZERO).sqrt();
        let nearest = s - seen.within(s);
        let left = seen.tip(seen.within(s - rho * lead));
        (rho2 - nearest * nearest).simd_ge(f32x8::ZERO).bitselect(left.fast_min(now), now)
    }
}

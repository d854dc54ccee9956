//! A ball nose, swept: a cylinder and two spheres.
//!
//! With ρ = √(R² − d²) the surface over a node is lowest where
//!
//! ```text
//! t = s − ρ·m/√(1 + m²),   z + m·t + R − √(ρ² − (s − t)²)
//! ```
//!
//! which is the cylinder. It is convex in t, so beyond an end of the stroke the end's sphere is lowest.

use super::sweep::{Seen, Sweep};
use wide::f32x8;

/// A ball nose.
pub(super) struct Ball {
    radius_mm: f64,
    radius: f32x8,
    radius2: f32x8,
}

impl Ball {
    /// Of a radius in mm.
    pub(super) fn new(radius_mm: f64) -> Self {
        Self {
            radius_mm,
            radius: f32x8::splat(radius_mm as f32),
            radius2: f32x8::splat((radius_mm * radius_mm) as f32),
        }
    }
}

impl Sweep for Ball {
    /// m/√(1 + m²).
    type Lead = f32x8;

    fn radius(&self) -> f64 {
        self.radius_mm
    }

    fn lead(&self, slope: f64) -> f32x8 {
        f32x8::splat((slope / (1.0 + slope * slope).sqrt()) as f32)
    }

    #[inline(always)]
    fn reach2(&self, rise: f32x8) -> f32x8 {
        let t = rise.fast_min(self.radius);
        let reach2 = t * (self.radius + self.radius - t);
        // Nothing is reached by what does not rise, not even the tip.
        t.simd_gt(f32x8::ZERO).bitselect(reach2, f32x8::ZERO)
    }

    fn end_counts_beyond(&self, lead: f32x8) -> f64 {
        self.radius_mm * f64::from(lead.to_array()[0].abs())
    }

    #[inline(always)]
    fn stamp(&self, z: f32x8, r2: f32x8, now: f32x8) -> f32x8 {
        let inside = self.radius2 - r2;
        let left = z + (self.radius - inside.fast_max(f32x8::ZERO).sqrt());
        inside.simd_ge(f32x8::ZERO).bitselect(left.fast_min(now), now)
    }

    #[inline(always)]
    fn leave(&self, lead: f32x8, seen: &Seen, s: f32x8, d: f32x8, now: f32x8) -> f32x8 {
        let rho2 = self.radius2 - d * d;
        let rho = rho2.fast_max(f32x8::ZERO).sqrt();
        let t = seen.within(s - rho * lead);
        let away = s - t;
        let inside = rho2 - away * away;
        let left = seen.tip(t) + (self.radius - inside.fast_max(f32x8::ZERO).sqrt());
        inside.simd_ge(f32x8::ZERO).bitselect(left.fast_min(now), now)
    }
}

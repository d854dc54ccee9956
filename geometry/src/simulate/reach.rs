//! How far from its axis a cutter reaches up to a height, from a table.

use crate::Profile;
use wide::f32x8;

/// Enough that a bin is far smaller than the rises that matter near the tip.
const BINS: usize = 256;

/// Raises what the table says, for the rounding of the lookup.
const ROUND_UP: f64 = 1.0 + 1e-5;

/// The table of one cutter.
pub(super) struct Reach {
    /// 1 / h(R), or 0 where h(R) is.
    per_height: f32,
    /// Squared distance reached by all rises of a bin, in mm²; bin k begins at h(R)·(k / BINS)².
    reach2: Vec<f32>,
    /// R², rounded up.
    all: f32,
}

impl Reach {
    /// Of a profile.
    pub(super) fn new(profile: &Profile) -> Self {
        let radius = profile.radius_mm();
        let full = profile.height(radius);
        let reached = |k: usize| {
            let rise = full * ((k + 1) as f64 / BINS as f64).powi(2) * ROUND_UP;
            (greatest_radius(profile, rise).powi(2) * ROUND_UP) as f32
        };
        Self {
            per_height: if full > 0.0 { (1.0 / full) as f32 } else { 0.0 },
            reach2: (0..BINS).map(reached).collect(),
            all: (radius * radius * ROUND_UP) as f32,
        }
    }

    /// See [`super::sweep::Sweep::reach2`].
    #[inline]
    pub(super) fn reach2(&self, rise: f32x8) -> f32x8 {
        let share = (rise * f32x8::splat(self.per_height)).fast_max(f32x8::ZERO).sqrt();
        let bins = (share * f32x8::splat(BINS as f32)).to_array();
        let reach = |bin: f32| self.reach2.get(bin as usize).copied().unwrap_or(self.all);
        rise.simd_gt(f32x8::ZERO).bitselect(f32x8::from(bins.map(reach)), f32x8::ZERO)
    }
}

/// The greatest r in mm with h(r) ≤ `rise`, rounded up.
fn greatest_radius(profile: &Profile, rise: f64) -> f64 {
    let (mut low, mut high) = (0.0, profile.radius_mm());
    if profile.height(high) <= rise {
        return high;
    }
    // 60 halvings go from R to the last bit of it.
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if profile.height(middle) <= rise { low = middle } else { high = middle }
    }
    high
}

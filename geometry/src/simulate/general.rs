//! Any profile, swept: the drop cutter's kernels on the stroke upside down, node by node.

use super::sweep::{Seen, Sweep};
use crate::Profile;
use crate::drop_cutter::Swept;
use wide::f32x8;

/// Enough that a bin is far smaller than the rises that matter near the tip.
const BINS: usize = 256;

/// Raises what the table says, for the rounding of the lookup.
const ROUND_UP: f64 = 1.0 + 1e-5;

/// A cutter of any shape.
pub(super) struct General {
    shape: Swept,
    radius_mm: f64,
    /// 1 / h(R), or 0 where h(R) is.
    per_height: f32,
    /// Squared distance reached by all rises of a bin, in mm²; bin k begins at h(R)·(k / BINS)².
    reach2: Vec<f32>,
}

impl General {
    /// Of a profile.
    pub(super) fn new(profile: &Profile) -> Self {
        let radius_mm = profile.radius_mm();
        let full = profile.height(radius_mm);
        let reached = |k: usize| {
            let rise = full * ((k + 1) as f64 / BINS as f64).powi(2) * ROUND_UP;
            greatest_radius(profile, rise).powi(2) * ROUND_UP
        };
        let per_height = if full > 0.0 { (1.0 / full) as f32 } else { 0.0 };
        let reach2 = (0..BINS).map(|k| reached(k) as f32).collect();
        Self { shape: Swept::new(profile), radius_mm, per_height, reach2 }
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

impl Sweep for General {
    type Lead = ();

    fn radius(&self) -> f64 {
        self.radius_mm
    }

    fn lead(&self, _: f64) {}

    #[inline]
    fn reach2(&self, rise: f32x8) -> f32x8 {
        let share = (rise * f32x8::splat(self.per_height)).fast_max(f32x8::ZERO).sqrt();
        let bins = (share * f32x8::splat(BINS as f32)).to_array();
        let all = (self.radius_mm * self.radius_mm * ROUND_UP) as f32;
        let reach = |bin: f32| self.reach2.get(bin as usize).copied().unwrap_or(all);
        rise.simd_gt(f32x8::ZERO).bitselect(f32x8::from(bins.map(reach)), f32x8::ZERO)
    }

    fn leave(&self, (): (), seen: &Seen, s: f32x8, d: f32x8, now: f32x8) -> f32x8 {
        let (s, d, mut left) = (s.to_array(), d.to_array(), now.to_array());
        let [from, to] = seen.ends.map(|t| f64::from(t.to_array()[0]));
        let (z, slope) = (f64::from(seen.z.to_array()[0]), f64::from(seen.slope.to_array()[0]));
        for k in 0..8 {
            let (s, d) = (f64::from(s[k]), f64::from(d[k]));
            // What lies farther off than R does not matter.
            let (from, to) = (from.max(s - self.radius_mm), to.min(s + self.radius_mm));
            if from <= to && d.abs() <= self.radius_mm {
                let ends = [from, to].map(|t| (t - s, z + slope * t));
                left[k] = left[k].min(self.shape.height(d, ends) as f32);
            }
        }
        f32x8::from(left)
    }
}

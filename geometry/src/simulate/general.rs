//! Any profile, swept: the drop cutter's kernels on the stroke upside down, node by node.

use super::reach::Reach;
use super::sweep::{Seen, Sweep};
use crate::Profile;
use crate::drop_cutter::Swept;
use wide::f32x8;

/// A cutter of any shape.
pub(super) struct General {
    shape: Swept,
    radius_mm: f64,
    reach: Reach,
}

impl General {
    /// Of a profile.
    pub(super) fn new(profile: &Profile) -> Self {
        Self {
            shape: Swept::new(profile),
            radius_mm: profile.radius_mm(),
            reach: Reach::new(profile),
        }
    }
}

impl Sweep for General {
    type Lead = ();

    fn radius(&self) -> f64 {
        self.radius_mm
    }

    fn lead(&self, _: f64) {}

    #[inline]
    fn reach2(&self, rise: f32x8) -> f32x8 {
        self.reach.reach2(rise)
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

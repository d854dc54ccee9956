//! What a cutter leaves along a stroke, eight nodes at a time.
//!
//! | symbol | meaning |
//! |---|---|
//! | s | way of a node along the stroke, from a place nearby, mm |
//! | d | distance of the node from the stroke's line in plan, signed, mm |
//! | t | way of the tip along the stroke, from the same place, mm |
//! | z, m | height of the tip at t = 0, mm, and its rise per mm |

use wide::f32x8;

/// A stroke, seen from a place nearby. All lanes are equal.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    /// First and last t.
    pub(super) ends: [f32x8; 2],
    /// z.
    pub(super) z: f32x8,
    /// m.
    pub(super) slope: f32x8,
}

impl Seen {
    /// Of some t the nearest of the stroke.
    #[inline(always)]
    pub(super) fn within(&self, t: f32x8) -> f32x8 {
        t.fast_max(self.ends[0]).fast_min(self.ends[1])
    }

    /// Height of the tip at t.
    #[inline(always)]
    pub(super) fn tip(&self, t: f32x8) -> f32x8 {
        self.z + self.slope * t
    }
}

/// A cutter that is swept along strokes.
pub(super) trait Sweep: Sync {
    /// What is computed once a stroke.
    type Lead: Copy;

    /// R in mm.
    fn radius(&self) -> f64;

    /// Of a stroke's slope.
    fn lead(&self, slope: f64) -> Self::Lead;

    /// The squared distances from the tip, in mm², beyond which the cutter is higher above its tip than
    /// some heights; not more than a little too great, never too small.
    fn reach2(&self, rise: f32x8) -> f32x8;

    /// How far beyond an end of the stroke, in mm along it, that end alone counts, for [`Self::stamp`];
    /// infinite if the cutter knows no stamp.
    fn end_counts_beyond(&self, _: Self::Lead) -> f64 {
        f64::INFINITY
    }

    /// What a tip at a height leaves of the heights `now` of nodes at squared distances `r2` from it.
    #[inline(always)]
    fn stamp(&self, _z: f32x8, _r2: f32x8, now: f32x8) -> f32x8 {
        now
    }

    /// What is left of the heights `now` of nodes.
    fn leave(&self, lead: Self::Lead, seen: &Seen, s: f32x8, d: f32x8, now: f32x8) -> f32x8;
}

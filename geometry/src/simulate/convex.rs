//! A convex profile of a few lines and arcs, swept: bull noses, cones, tapered balls.
//!
//! Over a node z + m·t + h(r), r² = d² + (s - t)², is convex in t. So it is lowest at an end of the stroke
//! if its slope m - h′(r)·(s - t)/r says so there, and else where that slope changes its sign, which is
//! found by halving. It is compared without quotients, h′ being rise / run of the profile at r:
//! m·r·run < rise·(s - t).
//!
//! An arc of radius ρ about (r_c, h_c) is told as h_c - ρ + x²/(ρ + √(ρ² - x²)), x = r - r_c, which loses
//! nothing where ρ is large.

use super::reach::Reach;
use super::sweep::{Seen, Sweep};
use crate::Profile;
use crate::profile::Segment;
use wide::f32x8;

/// More pieces are computed for each node in vain; node by node is faster then.
const MOST_PIECES: usize = 6;

/// Halvings: from the cutter's width to a millionth of it. The height depends on the square of what is left,
/// and at a corner of the profile on that itself.
const HALVINGS: usize = 21;

/// Slopes may differ by this much and still be those of one tangent: shapes are written with some ten digits.
const TANGENT: f64 = 1e-9;

/// The slope is looked at so far beyond t, in mm: on the axis of a pointed cutter it has two.
const ONWARD_MM: f32 = 1e-6;

/// A piece of the profile, that goes on outward without end.
enum Piece {
    /// From `r0`, `h0` on.
    Line {
        r0: f32x8,
        h0: f32x8,
        slope: f32x8,
    },
    Arc {
        r0: f32x8,
        r_center: f32x8,
        rho: f32x8,
        rho2: f32x8,
        lowest: f32x8,
    },
}

/// A convex cutter.
pub(super) struct Convex {
    radius_mm: f64,
    radius2: f32x8,
    pieces: Vec<Piece>,
    reach: Reach,
}

impl Convex {
    /// Of a profile; `None` if it is not convex or has many pieces.
    pub(super) fn new(profile: &Profile) -> Option<Self> {
        let (mut pieces, mut last, mut end) = (Vec::new(), 0.0, 0.0);
        for (from, segment) in profile.pieces().filter(|(from, s)| s.to()[0] > from[0]) {
            let [begin, slope] = slopes(from, segment);
            // A shoulder lies between, or it turns back.
            if from[1] > end || begin < last - TANGENT {
                return None;
            }
            (last, end) = (slope, segment.to()[1]);
            pieces.push(Piece::new(from, segment));
        }
        let radius_mm = profile.radius_mm();
        let radius2 = f32x8::splat((radius_mm * radius_mm) as f32);
        let reach = Reach::new(profile);
        (pieces.len() <= MOST_PIECES).then_some(Self { radius_mm, radius2, pieces, reach })
    }

    #[inline(always)]
    fn height(&self, r: f32x8) -> f32x8 {
        let mut height = f32x8::ZERO;
        for piece in &self.pieces {
            height = r.simd_ge(piece.begin()).bitselect(piece.height(r), height);
        }
        height
    }

    /// Rise and run of the profile at r.
    #[inline(always)]
    fn way(&self, r: f32x8) -> [f32x8; 2] {
        let mut way = [f32x8::ZERO, f32x8::ONE];
        for piece in &self.pieces {
            let [rise, run] = piece.way(r);
            let beyond = r.simd_ge(piece.begin());
            way = [beyond.bitselect(rise, way[0]), beyond.bitselect(run, way[1])];
        }
        way
    }

    /// Where the tip should be farther along the stroke than t, so that the height over the node becomes
    /// less. `away` is s - t.
    #[inline(always)]
    fn falls(&self, slope: f32x8, away: f32x8, d2: f32x8) -> f32x8 {
        let away = away - f32x8::splat(ONWARD_MM);
        let r = (d2 + away * away).sqrt();
        let [rise, run] = self.way(r);
        (slope * r * run).simd_lt(rise * away)
    }
}

/// Slopes at both ends.
fn slopes(from: [f64; 2], segment: &Segment) -> [f64; 2] {
    match *segment {
        Segment::Line { to } => [(to[1] - from[1]) / (to[0] - from[0]); 2],
        Segment::Arc { to, center } => {
            [from, to].map(|p| (p[0] - center[0]) / (center[1] - p[1]).max(0.0))
        }
    }
}

impl Piece {
    fn new(from: [f64; 2], segment: &Segment) -> Self {
        let splat = |v: f64| f32x8::splat(v as f32);
        let r0 = splat(from[0]);
        match *segment {
            Segment::Line { .. } => {
                Self::Line { r0, h0: splat(from[1]), slope: splat(slopes(from, segment)[0]) }
            }
            Segment::Arc { center, .. } => {
                let rho = (from[0] - center[0]).hypot(from[1] - center[1]);
                Self::Arc {
                    r0,
                    r_center: splat(center[0]),
                    rho: splat(rho),
                    rho2: splat(rho * rho),
                    lowest: splat(center[1] - rho),
                }
            }
        }
    }

    #[inline(always)]
    fn begin(&self) -> f32x8 {
        match *self {
            Self::Line { r0, .. } | Self::Arc { r0, .. } => r0,
        }
    }

    #[inline(always)]
    fn height(&self, r: f32x8) -> f32x8 {
        match *self {
            Self::Line { r0, h0, slope } => h0 + (r - r0) * slope,
            Self::Arc { r_center, rho, rho2, lowest, .. } => {
                let x = r - r_center;
                let x2 = x * x;
                lowest + x2 / (rho + (rho2 - x2).fast_max(f32x8::ZERO).sqrt())
            }
        }
    }

    #[inline(always)]
    fn way(&self, r: f32x8) -> [f32x8; 2] {
        match *self {
            Self::Line { slope, .. } => [slope, f32x8::ONE],
            Self::Arc { r_center, rho2, .. } => {
                let x = r - r_center;
                [x, (rho2 - x * x).fast_max(f32x8::ZERO).sqrt()]
            }
        }
    }
}

impl Sweep for Convex {
    type Lead = ();

    fn radius(&self) -> f64 {
        self.radius_mm
    }

    fn lead(&self, _: f64) {}

    #[inline]
    fn reach2(&self, rise: f32x8) -> f32x8 {
        self.reach.reach2(rise)
    }

    #[inline(always)]
    fn leave(&self, (): (), seen: &Seen, s: f32x8, d: f32x8, now: f32x8) -> f32x8 {
        let d2 = d * d;
        // Only where the cutter reaches the node does the profile say anything.
        let half = (self.radius2 - d2).fast_max(f32x8::ZERO).sqrt();
        let (mut from, mut to) = (seen.within(s - half), seen.within(s + half));
        let reached = s - seen.within(s);
        let nearest2 = d2 + reached * reached;
        // No place of the stroke is lower, and none nearer.
        let least = seen.tip(from).fast_min(seen.tip(to)) + self.height(nearest2.sqrt());
        let hit = nearest2.simd_le(self.radius2) & least.simd_lt(now);
        if !hit.any() {
            return now;
        }
        let on = self.falls(seen.slope, s - from, d2);
        to = on.bitselect(to, from);
        let back = !self.falls(seen.slope, s - to, d2);
        from = back.bitselect(from, to);
        if (hit & from.simd_lt(to)).any() {
            for _ in 0..HALVINGS {
                let middle = (from + to) * f32x8::HALF;
                let on = self.falls(seen.slope, s - middle, d2);
                (from, to) = (on.bitselect(middle, from), on.bitselect(to, middle));
            }
        }
        let away = s - from;
        let r = (d2 + away * away).fast_min(self.radius2).sqrt();
        let left = seen.tip(from) + self.height(r);
        hit.bitselect(left.fast_min(now), now)
    }
}

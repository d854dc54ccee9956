//! An edge as it rises, and where a run of a profile touches it.
//!
//! Along the edge z = z₀ + m·s, with m ≥ 0 and s the way from the foot of the perpendicular from the
//! axis, which is d away; r² = d² + s². The tip z − h(r) has the slope m − k·s/r, k that of the run,
//! and so is greatest at s ≥ 0. If that is beyond an end of the edge, the end is touched, which is
//! tested by itself.
//!
//! # Arcs
//! About the axis the edge's line meets a sphere: s = m·√(ρ² − d²)/√(1 + m²). For any other, told by
//! the slope t of the arc at r, t·c − m with c = s/r = √(1 − d²/r²) rises with t, and its root is found
//! by Newton's method within a bracket. The arc lies above its tangent at any t, which turned about
//! the axis is a cone, and on a cone the edge cannot lie with the tip higher than
//!
//! u(t) = z₀ − h(t) + t·r(t) − d·√(t² − m²),  t ≥ m.
//!
//! So most edges that are not touched are given up at the first step, and what is found has a bound
//! for its error.

use super::edge::Edge;
use super::general::{Curve, Piece};

/// Steps of Newton's method: it takes 2 to 5. The rest is for brackets that start at the upright end
/// of an arc.
const MAX_STEPS: usize = 60;

/// The tip on an arc is found this exactly, relative to the arc's radius: a thousandth of what is
/// promised of the best cutters.
const EXACT: f64 = 1e-12;

/// The angle of an arc, in rad, below which another step changes nothing: the tip depends on the
/// square of it.
const SMALL_TURN: f64 = 1e-8;

/// The part of an edge with s ≥ 0 under a cutter.
pub(super) struct Rising {
    /// First and last s, in mm.
    s: [f64; 2],
    /// Their r, in mm.
    pub(super) r: [f64; 2],
    /// Whether the part ends at the cutter's rim, not with the edge.
    to_rim: bool,
    /// d², in mm².
    away2: f64,
    /// z₀, in mm.
    foot_z: f64,
    /// m.
    slope: f64,
}

impl Rising {
    /// `None` if nothing of it is under the cutter.
    #[inline]
    pub(super) fn new(edge: &Edge, radius: f64) -> Option<Self> {
        let inside = radius * radius - edge.away2;
        let [a, b] = if edge.slope < 0.0 { [-edge.s[1], -edge.s[0]] } else { edge.s };
        let from = a.max(0.0);
        if inside < 0.0 || b < 0.0 || from * from > inside {
            return None;
        }
        let (to_rim, r) = (b * b >= inside, |s: f64| (edge.away2 + s * s).sqrt());
        let (to, r_to) = if to_rim { (inside.sqrt(), radius) } else { (b, r(b)) };
        Some(Self {
            s: [from, to],
            r: [r(from), r_to],
            to_rim,
            away2: edge.away2,
            foot_z: edge.foot_z,
            slope: edge.slope.abs(),
        })
    }

    /// The s at which the edge is `r` from the axis; 0 if it is nowhere that near.
    #[inline]
    fn s_at(&self, r: f64) -> f64 {
        (r * r - self.away2).max(0.0).sqrt()
    }

    /// Height of the edge at `s`, in mm.
    #[inline]
    pub(super) fn height(&self, s: f64) -> f64 {
        self.foot_z + self.slope * s
    }

    /// Whether the tip still rises at `s`, r from the axis, on a piece.
    #[inline]
    fn rises_on(&self, piece: &Piece, s: f64, r: f64) -> bool {
        let (rise, run) = piece.way(r);
        // On the axis the way along the edge is the way outward.
        let (s, r) = if r > 0.0 { (s, r) } else { (1.0, 1.0) };
        self.slope * r * run > rise * s
    }

    /// Whether the tip still rises where the part is `r` from the axis and the profile has a slope.
    #[inline]
    fn rises_at(&self, r: f64, slope: f64) -> bool {
        // The squares of m·r > k·s.
        let (m2, k2, r2) = (self.slope * self.slope, slope * slope, r * r);
        k2 <= m2 || (k2 - m2) * r2 < k2 * self.away2
    }

    /// Calls `each` for all (s, h) where `pieces`, of which the first holds the start, touch inside of
    /// this part; those may be left out at which the tip is not above `tip`.
    #[inline]
    pub(super) fn touches(
        &self,
        pieces: &[Piece],
        convex: bool,
        tip: f64,
        mut each: impl FnMut(f64, f64),
    ) {
        let ([from, to], [r_from, r_to]) = (self.s, self.r);
        let Some(inner) = pieces.first() else { return };
        // At a corner the outer piece.
        let at_end = pieces.len() > 1 && inner.r1 <= r_from;
        let pieces = &pieces[usize::from(at_end)..];
        let mut rises = self.rises_on(&pieces[0], from, r_from);
        if !rises && from == 0.0 {
            each(0.0, pieces[0].height(r_from));
        }
        for (k, piece) in pieces.iter().enumerate() {
            if convex && !rises {
                return;
            }
            let ends = r_to <= piece.r1 || k + 1 == pieces.len();
            let still = if ends && !self.to_rim {
                self.rises_on(piece, to, r_to)
            } else {
                self.rises_at(piece.r1, piece.slopes[1])
            };
            if rises && !still {
                let begin = if k == 0 { from } else { self.s_at(piece.r0) };
                let end = if ends { to } else { self.s_at(piece.r1) };
                if let Some((s, h)) = self.touch_piece(piece, [begin, end], tip) {
                    each(s, h);
                }
            }
            if ends {
                if still && self.to_rim {
                    each(to, piece.h1);
                }
                return;
            }
            let next = &pieces[k + 1];
            rises = self.rises_at(next.r0, next.slopes[0]);
            if still && (piece.wall || !rises) {
                each(self.s_at(piece.r1), piece.h1);
            }
        }
    }

    /// Where (s, h) a piece touches on which the tip is highest between two places.
    #[inline]
    fn touch_piece(&self, piece: &Piece, [from, to]: [f64; 2], tip: f64) -> Option<(f64, f64)> {
        let at = |s: f64| {
            let s = s.clamp(from, to);
            (s, piece.height((self.away2 + s * s).sqrt()))
        };
        match piece.curve {
            Curve::Line { slope } => {
                let share = self.slope / slope;
                Some(at((self.away2 / (1.0 - share * share)).sqrt() * share))
            }
            Curve::Arc { r_center: 0.0, rho, .. } => {
                let flat = (rho * rho - self.away2) / (1.0 + self.slope * self.slope);
                Some(at(self.slope * flat.max(0.0).sqrt()))
            }
            Curve::Arc { r_center, h_center, rho } => {
                self.touch_arc([r_center, h_center, rho], piece, [from, to], tip).map(at)
            }
        }
    }

    /// The s of the highest tip on an arc.
    fn touch_arc(
        &self,
        [r_center, h_center, rho]: [f64; 3],
        piece: &Piece,
        [from, to]: [f64; 2],
        tip: f64,
    ) -> Option<f64> {
        let r = |s: f64| (self.away2 + s * s).sqrt();
        // Slopes around the root; computed if the first guess does not decide.
        let mut bracket = None;
        let amid = f64::midpoint(from, to).max(f64::MIN_POSITIVE);
        let (mut t, mut s) = (self.slope * r(amid) / amid, amid);
        for _ in 0..MAX_STEPS {
            let steep = (1.0 + t * t).sqrt();
            let cos = 1.0 / steep;
            let (r_t, h_t) = (r_center + rho * t * cos, h_center - rho * cos);
            let above = (t * t - self.slope * self.slope).max(0.0) * self.away2;
            let bound = self.foot_z - h_t + (t * r_t - above.sqrt());
            if bound <= tip {
                return None;
            }
            let [low, high] = bracket
                .get_or_insert_with(|| [piece.slope(r(from)).max(self.slope), piece.slope(r(to))]);
            if t < *low || t > *high {
                // The first guess, off the piece. Its bound was one nevertheless.
                t = amid_of([*low, *high]);
                continue;
            }
            s = self.s_at(r_t);
            let c = s / r_t;
            let wanting = t * c - self.slope;
            let turns = c + t * self.away2 * rho * (cos * cos * cos) / (r_t * r_t * s);
            let step = wanting / turns;
            if wanting > 0.0 {
                *high = t
            } else {
                *low = t
            }
            let small = turns.is_finite() && step.abs() <= SMALL_TURN * steep * steep;
            if small || bound - (self.height(s) - h_t) <= EXACT * rho {
                break;
            }
            let next = t - step;
            t = if next > *low && next < *high { next } else { amid_of([*low, *high]) };
        }
        Some(s)
    }
}

/// A slope between two; the second may be infinite.
fn amid_of([low, high]: [f64; 2]) -> f64 {
    if high.is_finite() { f64::midpoint(low, high) } else { 2.0 * low + 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Segment;
    use glam::DVec3;

    #[test]
    fn the_highest_tip_on_an_arc_is_found() {
        let mut random = fastrand::Rng::with_seed(5);
        for _ in 0..2000 {
            let (flat, corner) = (random.f64() * 2.0, 0.01 + random.f64());
            let radius = flat + corner;
            let arc = Segment::Arc { to: [radius, corner], center: [flat, corner] };
            let piece = Piece::new([flat, 0.0], &arc);
            // Beyond the flat, so that the arc has the start.
            let away = flat + random.f64() * corner;
            let rise = [0.1, 1.0, 10.0, 1e4][random.usize(..4)] * random.f64();
            let [a, b] = [-9.0, 9.0].map(|x: f64| DVec3::new(x, away, x * rise));
            let edge = Edge::between(a, b).unwrap();
            let rising = Rising::new(&edge, radius).unwrap();
            let tip_at = |s: f64| rising.height(s) - piece.height((away * away + s * s).sqrt());
            let mut found = f64::NEG_INFINITY;
            rising.touches(std::slice::from_ref(&piece), true, f64::NEG_INFINITY, |s, h| {
                let tip = rising.height(s) - h;
                assert!((tip - tip_at(s)).abs() < 1e-9);
                found = found.max(tip);
            });
            let from = rising.s_at(flat);
            let places = (0..=1000).map(|k| from + (rising.s[1] - from) * f64::from(k) / 1000.0);
            let greatest = places.map(tip_at).fold(f64::NEG_INFINITY, f64::max);
            assert!(found >= greatest - 1e-9, "{found} {greatest}");
        }
    }
}

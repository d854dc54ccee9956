//! Any profile of lines and arcs.
//!
//! The tip over a triangle or edge is the greatest of z − h(r) over its places. On each piece of the
//! profile that is either at one of the piece's ends, or where the slope of the piece equals that
//! of the surface:
//!
//! | surface | line of slope k | arc of radius ρ about (r_c, h_c) |
//! |---|---|---|
//! | plane of slope g, r uphill | — | r = r_c + ρ·g/√(1 + g²) |
//! | edge of slope m at distance d, r² = d² + s² | s = r·m/k, r = d/√(1 − (m/k)²) | solved: (r − r_c)·s/r = m·√(ρ² − (r − r_c)²) |
//!
//! Cones, tapers, corner and nose radii and form tools of any kind are made of these. Along an edge
//! z − h is concave on each arc, on the side where the edge rises, so its slope has one root there,
//! which is bracketed and found by false position (Illinois rule). Piece ends cost no exactness: a
//! contact there is one, whether the profile's corner is convex or concave.

use super::best::{Best, Place};
use super::edge::Edge;
use super::shape::{Facet, Shape};
use crate::ContactKind;
use crate::profile::{Profile, Segment};
use glam::DVec2;

/// Steps of false position: it gains some half of the digits each two steps, so a dozen do; the
/// rest is for brackets that start at the upright end of an arc.
const MAX_STEPS: usize = 60;

/// The solved place is this exact, relative to R. The tip is exact to the square of it.
const PLACE_EXACT: f64 = 1e-12;

/// Pieces whose slopes differ by less are meant to join without a corner. What can be lost by this
/// is a share of R.
const TANGENT: f64 = 1e-9;

/// A piece that is not upright, from r0 to r1.
struct Piece {
    r0: f64,
    h0: f64,
    r1: f64,
    curve: Curve,
}

enum Curve {
    Line { slope: f64 },
    Arc { r_center: f64, h_center: f64, rho: f64 },
}

/// A cutter of any shape.
pub(super) struct General {
    radius: f64,
    pieces: Vec<Piece>,
    /// Ends (r, h) of pieces, r > 0; at a shoulder its foot.
    ends: Vec<(f64, f64)>,
    /// Whether h is convex.
    convex: bool,
}

impl Piece {
    fn slope(&self, r: f64) -> f64 {
        match self.curve {
            Curve::Line { slope } => slope,
            Curve::Arc { r_center, rho, .. } => {
                let out = r - r_center;
                out / (rho * rho - out * out).max(0.0).sqrt()
            }
        }
    }

    fn height(&self, r: f64) -> f64 {
        match self.curve {
            Curve::Line { slope } => self.h0 + (r - self.r0) * slope,
            Curve::Arc { r_center, h_center, rho } => {
                let out = r - r_center;
                (h_center - (rho * rho - out * out).max(0.0).sqrt()).max(self.h0)
            }
        }
    }
}

/// Whether the slopes of pieces rise from one to the next, without a shoulder between.
fn is_convex(pieces: &[Piece], ends: &[(f64, f64)]) -> bool {
    pieces.windows(2).zip(ends).all(|(pair, &(r, h))| {
        let (before, after) = (pair[0].slope(r), pair[1].slope(r));
        pair[1].h0 <= h && before <= after + TANGENT
    })
}

impl General {
    pub(super) fn new(profile: &Profile) -> Self {
        let mut pieces = Vec::new();
        let mut ends = Vec::new();
        for (from, segment) in profile.pieces() {
            let to = segment.to();
            if to[0] <= from[0] {
                continue;
            }
            let curve = match *segment {
                Segment::Line { .. } => {
                    Curve::Line { slope: (to[1] - from[1]) / (to[0] - from[0]) }
                }
                Segment::Arc { center, .. } => Curve::Arc {
                    r_center: center[0],
                    h_center: center[1],
                    rho: (from[0] - center[0]).hypot(from[1] - center[1]),
                },
            };
            pieces.push(Piece { r0: from[0], h0: from[1], r1: to[0], curve });
            ends.push((to[0], to[1]));
        }
        let convex = is_convex(&pieces, &ends);
        Self { radius: profile.radius_mm(), pieces, ends, convex }
    }

    fn height_at(&self, r: f64) -> f64 {
        let piece = self.pieces.iter().find(|piece| r <= piece.r1);
        piece.map_or(f64::INFINITY, |piece| piece.height(r))
    }

    /// All (r, h) at which a plane of the given slope can be touched.
    fn touches_of_plane(&self, slope: f64, mut each: impl FnMut(f64, f64)) {
        each(0.0, 0.0);
        for (piece, &(r1, h1)) in self.pieces.iter().zip(&self.ends) {
            each(r1, h1);
            if let Curve::Arc { r_center, h_center, rho } = piece.curve {
                let steep = (1.0 + slope * slope).sqrt();
                let r = r_center + rho * slope / steep;
                if r > piece.r0 && r < r1 {
                    each(r, h_center - rho / steep);
                }
            }
        }
    }
}

impl Shape for General {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn height(&self, r2: f64) -> f64 {
        self.height_at(r2.sqrt())
    }

    fn slope(&self, r2: f64) -> Option<f64> {
        let r = r2.sqrt();
        let piece = self.pieces.iter().filter(|_| self.convex).find(|piece| r <= piece.r1)?;
        Some(piece.slope(r)).filter(|slope| slope.is_finite())
    }

    fn drop_on_triangle(&self, triangle: &impl Facet, at: DVec2, best: &mut Best) -> f64 {
        let (gradient, level) = (triangle.slope(), triangle.height_at_axis());
        let slope = gradient.length();
        let uphill = if slope > 0.0 { gradient / slope } else { DVec2::ZERO };
        let mut greatest = f64::NEG_INFINITY;
        self.touches_of_plane(slope, |r, h| {
            let tip = level + (slope * r - h);
            greatest = greatest.max(tip);
            let place = uphill * r;
            if tip > best.tip && triangle.holds(place) {
                let (tip, point) = (triangle.tip(tip, place, h), || triangle.point(at, place));
                best.raise(tip, ContactKind::Facet, triangle.place(), point);
            }
        });
        greatest
    }

    fn drop_on_edge(&self, edge: &Edge, at: DVec2, node: Place, best: &mut Best) {
        if edge.away2 > self.radius * self.radius {
            return;
        }
        let mut touch = |s: f64, h: f64| {
            let tip = edge.foot_z + edge.slope * s - h;
            if tip > best.tip && edge.holds(s) {
                best.raise(tip, ContactKind::Edge, node, || edge.point(at, s));
            }
            best.tip
        };
        touch(0.0, self.height_at(edge.away2.sqrt()));
        for (piece, &(r1, h1)) in self.pieces.iter().zip(&self.ends) {
            let s1 = (r1 * r1 - edge.away2).sqrt();
            if s1.is_nan() {
                continue;
            }
            touch(s1, h1);
            let tip = touch(-s1, h1);
            if let Some(s) = piece.touch_of_edge(edge, s1, tip) {
                let r = (edge.away2 + s * s).sqrt().clamp(piece.r0, r1);
                touch(s, piece.height(r));
            }
        }
    }
}

impl Piece {
    /// Where between its ends a piece has the slope of an edge, if that can be above `tip`; `s1` is
    /// the s of its outer end.
    fn touch_of_edge(&self, edge: &Edge, s1: f64, tip: f64) -> Option<f64> {
        let away = edge.away2.sqrt();
        match self.curve {
            Curve::Line { slope } => {
                let share = edge.slope / slope;
                let r = away / (1.0 - share * share).sqrt();
                // NaN, where the edge is steeper than the line, fails both.
                (r > self.r0 && r < self.r1).then_some(r * share)
            }
            Curve::Arc { r_center, rho, .. } => {
                let s0 = (self.r0 * self.r0 - edge.away2).max(0.0).sqrt();
                let slope = edge.slope.abs();
                // Only where the edge is: its ends are vertices, tested by themselves.
                let [a, b] = edge.s.map(|s| s * 1.0_f64.copysign(edge.slope));
                let (s0, s1) = (s0.max(a.min(b)), s1.min(a.max(b)));
                let lowest = self.height((edge.away2 + s0 * s0).sqrt());
                if s0 >= s1 || edge.foot_z + slope * s1 - lowest <= tip {
                    return None;
                }
                // Falls from positive to negative where z − h is greatest. Right on the axis the
                // way along the edge is the way outward.
                let balance = |s: f64| {
                    let r = (edge.away2 + s * s).sqrt();
                    let (out, outward) = (r - r_center, if r > 0.0 { s / r } else { 1.0 });
                    slope * (rho * rho - out * out).max(0.0).sqrt() - out * outward
                };
                root(balance, s0, s1, PLACE_EXACT * self.r1).map(|s| s.copysign(edge.slope))
            }
        }
    }
}

/// The root of a function that is positive at `low` and negative at `high`; `None` if it is not.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64, exact: f64) -> Option<f64> {
    let (mut at_low, mut at_high) = (f(low), f(high));
    if !(at_low > 0.0 && at_high < 0.0) {
        return None;
    }
    let mut same_side = 0;
    for _ in 0..MAX_STEPS {
        if high - low <= exact {
            break;
        }
        let mut middle = low + (high - low) * (at_low / (at_low - at_high));
        if !(middle > low && middle < high) {
            middle = low + (high - low) / 2.0;
        }
        let value = f(middle);
        if value > 0.0 {
            (low, at_low) = (middle, value);
            // The Illinois rule: an end that stays put twice counts half.
            at_high *= if same_side > 0 { 0.5 } else { 1.0 };
            same_side = 1;
        } else if value < 0.0 {
            (high, at_high) = (middle, value);
            at_low *= if same_side < 0 { 0.5 } else { 1.0 };
            same_side = -1;
        } else {
            return Some(middle);
        }
    }
    Some(low + (high - low) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_is_found() {
        let found = root(|x| 2.0 - x * x, 0.0, 2.0, 1e-14).unwrap();
        assert!((found - std::f64::consts::SQRT_2).abs() < 1e-13);
        assert!(root(|x| 3.0 + x, 0.0, 2.0, 1e-14).is_none());
        // Upright at the far end, as at the rim of an arc.
        let found =
            root(|x: f64| (1.0 - x * x).max(0.0).sqrt() - 1e3 * x, 0.0, 1.0, 1e-14).unwrap();
        assert!((found - 1.0 / 1.000_001e6_f64.sqrt()).abs() < 1e-13);
    }

    #[test]
    fn heights_are_those_of_the_profile() {
        let bull = Profile::bull_nose(3.0, 1.0).unwrap();
        let general = General::new(&bull);
        for k in 0..=300 {
            let r = f64::from(k) * 0.01;
            assert!((general.height_at(r) - bull.height(r)).abs() < 1e-15);
        }
        assert_eq!(general.height_at(3.001), f64::INFINITY);
    }
}

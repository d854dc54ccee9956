//! Any profile of lines and arcs.
//!
//! The tip over a triangle or edge is the greatest of z − h(r) over its places. Over each piece of the
//! profile z − h is concave, so what is greatest is found by comparing slopes from piece to piece: at
//! a corner or an end of the profile, at the foot of a shoulder, or where a piece has the slope of the
//! surface:
//!
//! | surface | on a line of slope k | on an arc of radius ρ about (r_c, h_c) |
//! |---|---|---|
//! | plane of slope g, r uphill | at an end | r = r_c + ρ·g/√(1 + g²) |
//! | edge of slope m ([`Rising`]) | r = d/√(1 − (m/k)²) | solved, see [`super::rising`] |
//!
//! If that place is not on the triangle or edge, its border or ends are touched, which are tested by
//! themselves. A profile that is convex as a whole has one such place, any other may have several.

use super::best::{Best, Place};
use super::edge::Edge;
use super::facet::Facet;
use super::layer::Layer;
use super::rising::Rising;
use super::shape::{STEEPEST_SUPPORT, Shape};
use crate::ContactKind;
use crate::profile::{Profile, Segment};
use glam::DVec2;

/// Pieces whose slopes differ by less are meant to join without a corner. What can be lost by this
/// is a share of R.
const TANGENT: f64 = 1e-9;

/// A piece that is not upright, from (r0, h0) to (r1, h1); at a shoulder h1 is its foot, h0 its top.
pub(super) struct Piece {
    pub(super) r0: f64,
    pub(super) h0: f64,
    pub(super) r1: f64,
    pub(super) h1: f64,
    pub(super) curve: Curve,
    /// Slopes at its ends.
    pub(super) slopes: [f64; 2],
    /// Whether it stands upright behind its end: a shoulder, or the rim.
    pub(super) wall: bool,
}

pub(super) enum Curve {
    Line { slope: f64 },
    Arc { r_center: f64, h_center: f64, rho: f64 },
}

/// A cutter of any shape.
pub(super) struct General {
    radius: f64,
    pieces: Vec<Piece>,
    /// Whether h is convex.
    convex: bool,
    /// The steepest support of a convex one.
    steepest: (f64, f64),
    layers: Vec<Layer>,
}

impl Piece {
    pub(super) fn new(from: [f64; 2], segment: &Segment) -> Self {
        let ([r0, h0], [r1, h1]) = (from, segment.to());
        let curve = match *segment {
            Segment::Line { .. } => Curve::Line { slope: (h1 - h0) / (r1 - r0) },
            Segment::Arc { center: [r_center, h_center], .. } => {
                Curve::Arc { r_center, h_center, rho: (r0 - r_center).hypot(h0 - h_center) }
            }
        };
        let piece = Self { r0, h0, r1, h1, curve, slopes: [0.0; 2], wall: true };
        Self { slopes: [piece.slope(r0), piece.slope(r1)], ..piece }
    }

    #[inline]
    pub(super) fn slope(&self, r: f64) -> f64 {
        let (rise, run) = self.way(r);
        rise / run
    }

    /// Rise and run of the slope at r.
    #[inline]
    pub(super) fn way(&self, r: f64) -> (f64, f64) {
        match self.curve {
            Curve::Line { slope } => (slope, 1.0),
            Curve::Arc { r_center, rho, .. } => {
                let out = r - r_center;
                (out, (rho * rho - out * out).max(0.0).sqrt())
            }
        }
    }

    #[inline]
    pub(super) fn height(&self, r: f64) -> f64 {
        match self.curve {
            Curve::Line { slope } => self.h0 + (r - self.r0) * slope,
            Curve::Arc { r_center, h_center, rho } => {
                let out = r - r_center;
                (h_center - (rho * rho - out * out).max(0.0).sqrt()).max(self.h0)
            }
        }
    }

    /// Where (r, h) inside of it a plane touches.
    #[inline]
    fn touch_of_plane(&self, slope: f64) -> Option<(f64, f64)> {
        match self.curve {
            Curve::Arc { r_center, h_center, rho }
                if slope > self.slopes[0] && slope < self.slopes[1] =>
            {
                let steep = (1.0 + slope * slope).sqrt();
                Some((r_center + rho * slope / steep, h_center - rho / steep))
            }
            _ => None,
        }
    }
}

impl General {
    pub(super) fn new(profile: &Profile) -> Self {
        let outward = profile.pieces().filter(|(from, segment)| segment.to()[0] > from[0]);
        let mut pieces: Vec<_> = outward.map(|(from, segment)| Piece::new(from, segment)).collect();
        let mut convex = true;
        for k in 1..pieces.len() {
            pieces[k - 1].wall = pieces[k].h0 > pieces[k - 1].h1;
            let rises = pieces[k - 1].slopes[1] <= pieces[k].slopes[0] + TANGENT;
            convex &= rises && !pieces[k - 1].wall;
        }
        let (radius, layers) = (profile.radius_mm(), Layer::of(&pieces, TANGENT));
        let mut general = Self { radius, pieces, convex, steepest: (0.0, 0.0), layers };
        let mut touch = (0.0, 0.0);
        general.touches_of_plane(STEEPEST_SUPPORT, |r, h| touch = (r, h));
        general.steepest = (touch.1 - STEEPEST_SUPPORT * touch.0, STEEPEST_SUPPORT);
        general
    }

    /// The pieces that reach beyond r, or to it: the first is that at r, where two meet the inner one.
    #[inline]
    fn pieces_from(&self, r: f64) -> &[Piece] {
        // Most shapes have a few, drawings hundreds.
        let before = if self.pieces.len() < 8 {
            self.pieces.iter().take_while(|piece| piece.r1 < r).count()
        } else {
            self.pieces.partition_point(|piece| piece.r1 < r)
        };
        &self.pieces[before..]
    }

    #[inline]
    fn height_at(&self, r: f64) -> f64 {
        self.pieces_from(r).first().map_or(f64::INFINITY, |piece| piece.height(r))
    }

    /// All (r, h) at which a plane of slope g ≥ 0 can be touched.
    #[inline]
    fn touches_of_plane(&self, slope: f64, mut each: impl FnMut(f64, f64)) {
        let mut rises = slope > self.pieces[0].slopes[0];
        if !rises {
            each(0.0, 0.0);
        }
        for (k, piece) in self.pieces.iter().enumerate() {
            if self.convex && !rises {
                return;
            }
            if let Some((r, h)) = piece.touch_of_plane(slope) {
                each(r, h);
            }
            rises = slope >= piece.slopes[1];
            let follows = self.pieces.get(k + 1).filter(|_| !piece.wall);
            let goes_on = follows.is_some_and(|next| slope > next.slopes[0]);
            if rises && !goes_on {
                each(piece.r1, piece.h1);
            }
            rises = goes_on || piece.wall;
        }
    }

    /// The least of h − slope·r from `near` to `far`.
    fn least_above(&self, near: f64, far: f64, slope: f64) -> f64 {
        let above = |r: f64| self.height_at(r) - slope * r;
        let mut least = above(near).min(above(far.min(self.radius)));
        for piece in self.pieces_from(near).iter().take_while(|piece| piece.r0 <= far) {
            if piece.r1 <= far {
                least = least.min(piece.h1 - slope * piece.r1);
            }
            let inside = piece.touch_of_plane(slope).filter(|&(r, _)| r >= near && r <= far);
            least = inside.map_or(least, |(r, h)| least.min(h - slope * r));
        }
        least
    }
}

impl Shape for General {
    #[inline]
    fn radius(&self) -> f64 {
        self.radius
    }

    #[inline]
    fn height(&self, r2: f64) -> f64 {
        self.height_at(r2.sqrt())
    }

    #[inline]
    fn support(&self, r: f64, wide: f64, slope: f64) -> (f64, f64) {
        let slope = slope.clamp(0.0, STEEPEST_SUPPORT);
        if !self.convex {
            return (self.least_above((r - wide).max(0.0), r + wide, slope), slope);
        }
        // Beyond the rim it may lean as it likes, but no less than inside of it.
        let inside = self.pieces_from(r).first().map(|piece| (r, piece.height(r), piece.slope(r)));
        let (r, h, slope) = inside.unwrap_or_else(|| {
            let last = &self.pieces[self.pieces.len() - 1];
            (last.r1, last.h1, last.slopes[1].max(slope))
        });
        if slope > STEEPEST_SUPPORT { self.steepest } else { (h - slope * r, slope) }
    }

    fn tangent_of_hull(&self, r: f64) -> (f64, f64) {
        if self.convex {
            return self.support(r, 0.0, 0.0);
        }
        // The steepest slope of which the plane touches no farther out; by halving its angle, to some
        // 1e-6.
        let touch = |slope: f64| {
            let mut touch = (f64::INFINITY, 0.0);
            self.touches_of_plane(slope, |r, h| {
                touch = if h - slope * r < touch.0 { (h - slope * r, r) } else { touch };
            });
            touch
        };
        let (mut low, mut high) = (0.0, STEEPEST_SUPPORT.atan());
        for _ in 0..20 {
            let angle = f64::midpoint(low, high);
            if touch(angle.tan()).1 <= r { low = angle } else { high = angle }
        }
        (touch(low.tan()).0, low.tan())
    }

    #[inline]
    fn tangent(&self, r2: f64) -> Option<(f64, f64)> {
        let r = r2.sqrt();
        let piece = self.pieces_from(r).first().filter(|_| self.convex)?;
        let slope = piece.slope(r);
        // On the axis level is a tangent of every convex shape.
        let climb = if r > 0.0 { slope / r } else { 0.0 };
        (slope <= STEEPEST_SUPPORT).then(|| (piece.height(r), climb))
    }

    #[inline]
    fn layers(&self) -> usize {
        self.layers.len()
    }

    #[inline(always)]
    fn touch_planes(&self, layer: usize, slope2: &[f64; 6]) -> [[f64; 6]; 2] {
        self.layers[layer].touch_planes(slope2)
    }

    #[inline]
    fn drop_on_triangle(&self, triangle: &Facet, at: DVec2, best: &mut Best) -> f64 {
        let (gradient, level) = (triangle.slope(), triangle.height_at_axis());
        let slope = gradient.length();
        let mut greatest = f64::NEG_INFINITY;
        self.touches_of_plane(slope, |r, h| {
            let tip = level + (slope * r - h);
            greatest = greatest.max(tip);
            if tip <= best.tip {
                return;
            }
            let place = if slope > 0.0 { gradient * (r / slope) } else { DVec2::ZERO };
            if triangle.holds(place) {
                let (tip, point) = (triangle.tip(place, h), || triangle.point(at, place));
                best.raise(tip, ContactKind::Facet, triangle.place(), point);
            }
        });
        greatest
    }

    #[inline]
    fn drop_on_edge(&self, edge: &Edge, at: DVec2, node: Place, best: &mut Best) {
        let Some(rising) = Rising::new(edge, self.radius) else { return };
        rising.touches(self.pieces_from(rising.r[0]), self.convex, best.tip, |s, h| {
            let tip = rising.height(s) - h;
            let s = s.copysign(edge.slope);
            best.raise(tip, ContactKind::Edge, node, || edge.point(at, s));
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    fn line(r: f64, h: f64) -> Segment {
        Segment::Line { to: [r, h] }
    }

    /// A groove, a shoulder and a rounded rim.
    fn form() -> Profile {
        let arc = Segment::Arc { to: [5.0, 7.0], center: [4.0, 7.0] };
        let chain =
            [line(1.0, 0.0), line(2.0, 1.0), line(3.0, 1.5), line(3.0, 6.0), line(4.0, 6.0), arc];
        Profile::new(chain.to_vec()).unwrap()
    }

    #[test]
    fn what_is_greatest_on_a_plane_is_among_the_touches() {
        let general = General::new(&form());
        for slope in [0.0, 0.1, 0.5, 0.7, 1.0, 1.2, 3.0, 50.0] {
            let mut greatest = f64::NEG_INFINITY;
            general.touches_of_plane(slope, |r, h| {
                assert!((general.height_at(r) - h).abs() < 1e-12, "{r} {h}");
                greatest = greatest.max(slope * r - h);
            });
            let all = (0..=50_000).map(|k| f64::from(k) * 1e-4);
            let truth = all.map(|r| slope * r - general.height_at(r)).fold(f64::MIN, f64::max);
            assert!(greatest >= truth && greatest < truth + 1e-6, "{slope} {greatest} {truth}");
            let raised = |layer| general.touch_planes(layer, &[slope * slope; 6])[1][3];
            let raised = (0..general.layers()).map(raised).fold(f64::MIN, f64::max);
            assert!((raised - greatest).abs() < 1e-14, "{slope} {raised} {greatest}");
        }
    }

    #[test]
    fn supports_lie_below_and_touch() {
        let bull = Profile::bull_nose(3.0, 1.0).unwrap();
        let nose = Segment::Arc { to: [0.8, 0.4], center: [0.0, 1.0] };
        let taper = Profile::new(vec![nose, line(3.0, 0.4 + 2.2 * 0.8 / 0.6)]).unwrap();
        let mut random = fastrand::Rng::with_seed(9);
        for profile in [form(), bull, taper] {
            let general = General::new(&profile);
            for _ in 0..500 {
                let (r, wide) = (random.f64() * 6.0, random.f64());
                let (a, b) = general.support(r, wide, random.f64() * 3.0 - 1.0);
                let rs = (-400..=400).map(|k| (r + wide * f64::from(k) / 400.0).max(0.0));
                let above = rs.map(|r| profile.height(r) - (a + b * r));
                let least = above.fold(f64::INFINITY, f64::min);
                // That beyond the rim may touch at the rim, if that is not too far.
                let touches = least < 0.02 || r + wide > profile.radius_mm();
                assert!(least >= -1e-12 && touches, "{r} {wide} {least}");
            }
        }
    }
}

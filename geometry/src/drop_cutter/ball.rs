//! The ball nose: closed forms.
//!
//! | contact | tip |
//! |---|---|
//! | vertex at distance r | z − R + √(R² − r²) |
//! | facet z = z₀ + a·x + b·y about the axis | z₀ + R·(√(1 + a² + b²) − 1) |
//! | edge at distance d, z = z₀ + m·s about its foot | z₀ + √(R² − d²)·√(1 + m²) − R |
//!
//! The facet is touched R·(a, b)/√(1 + a² + b²) from the axis, the edge √(R² − d²)·m/√(1 + m²) from
//! its foot; if that is outside, the contact is not on it.

use super::best::{Best, Place};
use super::edge::Edge;
use super::facet::Facet;
use super::shape::Shape;
use crate::ContactKind;
use glam::DVec2;

/// The tangent there, / R, is as steep as a support may be: 16 / √(1 + 16²).
const TANGENT_WITHIN: f64 = 0.998_052_578;

/// A ball nose of radius R in mm.
pub(super) struct Ball {
    pub(super) radius: f64,
}

impl Shape for Ball {
    #[inline]
    fn radius(&self) -> f64 {
        self.radius
    }

    #[inline]
    fn height(&self, r2: f64) -> f64 {
        let inside = self.radius * self.radius - r2;
        if inside >= 0.0 { self.radius - inside.sqrt() } else { f64::INFINITY }
    }

    #[inline]
    fn support(&self, r: f64, _: f64, _: f64) -> (f64, f64) {
        let r = r.min(self.radius * TANGENT_WITHIN);
        let root = (self.radius * self.radius - r * r).sqrt();
        let slope = r / root;
        (self.radius - root - slope * r, slope)
    }

    fn tangent_of_hull(&self, r: f64) -> (f64, f64) {
        self.support(r, 0.0, 0.0)
    }

    #[inline]
    fn tangent(&self, r2: f64) -> Option<(f64, f64)> {
        let inside = self.radius * self.radius - r2;
        let root = inside.sqrt();
        let near = self.radius * TANGENT_WITHIN;
        (r2 < near * near).then(|| (self.radius - root, 1.0 / root))
    }

    #[inline(always)]
    fn touch_planes(&self, _: usize, slope2: &[f64; 6]) -> [[f64; 6]; 2] {
        let mut touch = [[0.0; 6]; 2];
        for k in 0..6 {
            let steep = (1.0 + slope2[k]).sqrt();
            (touch[0][k], touch[1][k]) = (self.radius / steep, self.radius * (steep - 1.0));
        }
        touch
    }

    #[inline]
    fn drop_on_triangle(&self, triangle: &Facet, at: DVec2, best: &mut Best) -> f64 {
        let slope = triangle.slope();
        let steep = (1.0 + slope.length_squared()).sqrt();
        let tip = triangle.height_at_axis() + self.radius * (steep - 1.0);
        if tip > best.tip {
            let place = slope * (self.radius / steep);
            if triangle.holds(place) {
                let h = self.radius * (1.0 - 1.0 / steep);
                let (tip, point) = (triangle.tip(place, h), || triangle.point(at, place));
                best.raise(tip, ContactKind::Facet, triangle.place(), point);
            }
        }
        tip
    }

    #[inline]
    fn drop_on_edge(&self, edge: &Edge, at: DVec2, node: Place, best: &mut Best) {
        let inside = self.radius * self.radius - edge.away2;
        if inside <= 0.0 {
            return;
        }
        let (rho, steep) = (inside.sqrt(), (1.0 + edge.slope * edge.slope).sqrt());
        let s = rho * edge.slope / steep;
        if edge.holds(s) {
            let tip = edge.foot_z + (rho * steep - self.radius);
            best.raise(tip, ContactKind::Edge, node, || edge.point(at, s));
        }
    }
}

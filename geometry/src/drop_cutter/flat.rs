//! The flat end mill: the highest point of the surface within R of the axis.
//!
//! That is a vertex, or lies on the rim of the disc: on a facet straight uphill from the axis, on an
//! edge where it leaves the disc.

use super::best::{Best, Place};
use super::edge::Edge;
use super::facet::Facet;
use super::shape::{STEEPEST_SUPPORT, Shape};
use crate::ContactKind;
use glam::DVec2;

/// A flat end mill of radius R in mm.
pub(super) struct Flat {
    pub(super) radius: f64,
}

impl Shape for Flat {
    #[inline]
    fn radius(&self) -> f64 {
        self.radius
    }

    #[inline]
    fn height(&self, r2: f64) -> f64 {
        if r2 <= self.radius * self.radius { 0.0 } else { f64::INFINITY }
    }

    #[inline]
    fn support(&self, r: f64, _: f64, slope: f64) -> (f64, f64) {
        // Beyond the rim it may lean as it likes.
        let slope = if r > self.radius { slope.clamp(0.0, STEEPEST_SUPPORT) } else { 0.0 };
        (-slope * self.radius, slope)
    }

    fn tangent_of_hull(&self, r: f64) -> (f64, f64) {
        self.support(r, 0.0, 0.0)
    }

    #[inline]
    fn tangent(&self, r2: f64) -> Option<(f64, f64)> {
        (r2 <= self.radius * self.radius).then_some((0.0, 0.0))
    }

    #[inline(always)]
    fn touch_planes(&self, _: usize, slope2: &[f64; 6]) -> [[f64; 6]; 2] {
        let mut touch = [[0.0; 6]; 2];
        for k in 0..6 {
            let slope = slope2[k].sqrt();
            // On a level plane every place is as good; this gives the axis.
            touch[0][k] = self.radius / slope.max(f64::MIN_POSITIVE.sqrt());
            touch[1][k] = self.radius * slope;
        }
        touch
    }

    #[inline]
    fn drop_on_triangle(&self, triangle: &Facet, at: DVec2, best: &mut Best) -> f64 {
        let slope = triangle.slope();
        let steep = slope.length();
        let tip = triangle.height_at_axis() + self.radius * steep;
        if tip > best.tip {
            // On a level facet every point is as high; the axis is the one to ask for.
            let uphill = if steep > 0.0 { slope / steep } else { DVec2::ZERO };
            let place = uphill * self.radius;
            if triangle.holds(place) {
                let (tip, point) = (triangle.tip(place, 0.0), || triangle.point(at, place));
                best.raise(tip, ContactKind::Facet, triangle.place(), point);
            }
        }
        tip
    }

    #[inline]
    fn drop_on_edge(&self, edge: &Edge, at: DVec2, node: Place, best: &mut Best) {
        let inside = self.radius * self.radius - edge.away2;
        if inside < 0.0 {
            return;
        }
        let s = inside.sqrt().copysign(edge.slope);
        if edge.holds(s) {
            let tip = edge.foot_z + edge.slope * s;
            best.raise(tip, ContactKind::Edge, node, || edge.point(at, s));
        }
    }
}

//! Union, intersection and difference of polygons.
//!
//! The work is done by the crate `i_overlay`: corners are put on a grid of integers (here of 64 bits,
//! so that it is about as fine as the numbers themselves), edges are split where they cross, and the
//! sides of each piece are counted. That is exact on the grid, so there is no input on which it loses
//! its way. Against the exact result corners move by some 10⁻¹² of the polygon's size.

use super::{Polygon, PolygonError};
use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::overlay::FloatOverlay;
use i_overlay::float::simplify::SimplifyShape;

/// A loop as the crate takes it.
pub(super) type Contour = Vec<[f64; 2]>;

/// An outline and the holes in it.
pub(super) type Shape = Vec<Contour>;

/// What loops leave inside, by how often they go around a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filling {
    /// What an odd number of loops surround.
    EvenOdd,
    /// What loops go around more often one way than the other: those of one sense may overlap.
    NonZero,
}

impl Polygon {
    /// What loops leave inside, clean; `None` if nothing.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn filled(loops: Vec<Vec<DVec2>>, filling: Filling) -> Result<Option<Self>, PolygonError> {
        let rule = match filling {
            Filling::EvenOdd => FillRule::EvenOdd,
            Filling::NonZero => FillRule::NonZero,
        };
        let loops = Self::new(loops)?;
        Ok(polygon(contours(&loops).simplify_shape_as::<i64>(rule)))
    }

    /// What lies inside of both; `None` if nothing does.
    #[must_use]
    pub fn and(&self, other: &Self) -> Option<Self> {
        self.overlaid(other, OverlayRule::Intersect)
    }

    /// What lies inside of either; `None` if nothing does, as when all loops are lines.
    #[must_use]
    pub fn or(&self, other: &Self) -> Option<Self> {
        self.overlaid(other, OverlayRule::Union)
    }

    /// What lies inside of this and outside of the other; `None` if nothing does.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Option<Self> {
        self.overlaid(other, OverlayRule::Difference)
    }

    /// The same inside with loops that do not cross: outlines counter-clockwise, holes clockwise.
    /// `None` if there is no inside.
    #[must_use]
    pub fn clean(&self) -> Option<Self> {
        polygon(shapes(self))
    }

    /// Its connected parts, each clean: one outline with its holes. Parts may touch in corners.
    #[must_use]
    pub fn parts(&self) -> Vec<Self> {
        shapes(self).into_iter().filter_map(|shape| polygon(vec![shape])).collect()
    }

    /// The parts of a polygon that is clean, outlines before their holes.
    pub(crate) fn split(self) -> Vec<Self> {
        match self.loops.len() {
            1 => vec![self],
            _ => self.parts(),
        }
    }

    fn overlaid(&self, other: &Self, rule: OverlayRule) -> Option<Self> {
        let (subject, clip) = (contours(self), contours(other));
        let mut overlay = FloatOverlay::<[f64; 2], i64>::from_subj_and_clip(&subject, &clip);
        polygon(overlay.overlay(rule, FillRule::EvenOdd))
    }
}

fn contours(polygon: &Polygon) -> Shape {
    polygon.loops.iter().map(|corners| corners.iter().map(DVec2::to_array).collect()).collect()
}

/// The parts of a polygon, outlines counter-clockwise, holes clockwise.
pub(super) fn shapes(polygon: &Polygon) -> Vec<Shape> {
    contours(polygon).simplify_shape_as::<i64>(FillRule::EvenOdd)
}

/// The polygon of some parts. It may have more corners than [`Polygon::new`] takes.
pub(super) fn polygon(shapes: Vec<Shape>) -> Option<Polygon> {
    let corners = |contour: Contour| contour.into_iter().map(DVec2::from_array).collect();
    let loops: Vec<Vec<DVec2>> = shapes.into_iter().flatten().map(corners).collect();
    (!loops.is_empty()).then_some(Polygon { loops })
}

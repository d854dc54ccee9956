//! The highest contact found so far at one cutter location.

use super::shape::Shape;
use crate::{Contact, ContactKind};
use glam::{DVec2, DVec3};

/// Where an index has what was touched: a node (i, j) of a field, or an item of a list and 0.
pub(super) type Place = (usize, usize);

/// A height of the tip that is known to be touched. Of equal heights the first found stays: the
/// order of the search is fixed, so the contact is the same on every run.
pub(super) struct Best {
    /// Height of the tip, in mm; −∞ before the first contact.
    pub(super) tip: f64,
    /// The same, rounded down; finite, so that −∞, which stands for no block, is below it.
    pub(super) low: f32,
    pub(super) contact: Contact,
    /// Where it was found.
    pub(super) node: Place,
    /// Nodes around which all was tested, each at its [`place_of`].
    done: [(usize, usize); 16],
    /// The cutter's tangent plane at the contact, and the tip it was made for.
    tangent: (Plane, f64),
}

/// Height in mm above the axis, and slope.
type Plane = (f64, DVec2);

/// Stands for no plane: all is above it.
const NO_PLANE: Plane = (f64::NEG_INFINITY, DVec2::ZERO);

/// What is above the tangent plane by less, in mm, is not looked at: a hundredth of the exactness
/// promised, for what is touched lies in the plane but for rounding.
const NOT_WORTH: f64 = 1e-11;

impl Best {
    pub(super) const NONE: Self = Self {
        tip: f64::NEG_INFINITY,
        low: f32::MIN,
        contact: Contact::NONE,
        node: (0, 0),
        done: [(usize::MAX, usize::MAX); 16],
        tangent: (NO_PLANE, f64::NEG_INFINITY),
    };

    /// A plane that no cutter at the height reached comes below: its tangent at the contact if its shape
    /// is convex. What lies under it cannot raise the tip, and that is all of what is around a contact
    /// with a ridge or a top.
    #[inline]
    pub(super) fn tangent(&mut self, shape: &impl Shape, at: DVec2) -> Plane {
        if self.tangent.1 != self.tip {
            let out = self.contact.point.truncate() - at;
            let plane = shape.tangent(out.length_squared()).map_or(NO_PLANE, |(h, climb)| {
                (self.tip + NOT_WORTH + h - climb * out.length_squared(), out * climb)
            });
            self.tangent = (plane, self.tip);
        }
        self.tangent.0
    }

    /// Remembers that all around a node was tested. A later node may take its place.
    #[inline]
    pub(super) fn mark_done(&mut self, node: (usize, usize)) {
        self.done[place_of(node)] = node;
    }

    /// Whether all around a node is known to have been tested.
    #[inline]
    pub(super) fn is_done(&self, node: (usize, usize)) -> bool {
        self.done[place_of(node)] == node
    }

    /// Takes over a contact if it is higher.
    #[inline]
    pub(super) fn raise(
        &mut self,
        tip: f64,
        kind: ContactKind,
        node: Place,
        point: impl FnOnce() -> DVec3,
    ) {
        if tip > self.tip {
            self.tip = tip;
            let near = tip as f32;
            let low = if f64::from(near) > tip { near.next_down() } else { near };
            self.low = low.max(f32::MIN);
            self.contact = Contact { point: point(), kind };
            self.node = node;
        }
    }
}

/// Nodes within four of each other have places of their own.
#[inline]
fn place_of(node: (usize, usize)) -> usize {
    node.0 % 4 + node.1 % 4 * 4
}

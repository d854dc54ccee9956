//! The highest contact found so far at one cutter location.

use super::cell::AROUND;
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
    /// Nodes around which all was tested.
    pub(super) done: Done,
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
        done: Done { corner: (0, 0), nodes: 0 },
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

/// Nodes of a window of [`WINDOW`]² nodes. One beyond it begins a new window.
pub(super) struct Done {
    /// First node of the window.
    corner: Place,
    /// Bit [`WINDOW`]·j + i stands for node (i, j) of the window.
    nodes: u64,
}

/// As many rows and columns as a `u64` has bits for.
const WINDOW: usize = 8;

impl Done {
    /// Column and row in the window; what lies before it is far behind it.
    #[inline]
    fn in_window(&self, (i, j): Place) -> (usize, usize) {
        (i.wrapping_sub(self.corner.0), j.wrapping_sub(self.corner.1))
    }

    /// Adds a node.
    #[inline]
    pub(super) fn mark(&mut self, node: Place) {
        let (i, j) = self.in_window(node);
        if self.nodes != 0 && i < WINDOW && j < WINDOW {
            self.nodes |= 1 << (WINDOW * j + i);
        } else {
            let half = WINDOW / 2;
            self.corner = (node.0.wrapping_sub(half), node.1.wrapping_sub(half));
            self.nodes = 1 << (WINDOW * half + half);
        }
    }

    /// Whether a node is known to be among them.
    #[inline]
    pub(super) fn has(&self, node: Place) -> bool {
        let (i, j) = self.in_window(node);
        i < WINDOW && j < WINDOW && self.nodes >> (WINDOW * j + i) & 1 != 0
    }

    /// Bits of the edges around a node of which the other ends are known to be among them. Of nodes at
    /// the window's border that is not told.
    #[inline]
    pub(super) fn ends_around(&self, node: Place) -> u32 {
        let (i, j) = self.in_window(node);
        let inside = 1..WINDOW - 1;
        if !inside.contains(&i) || !inside.contains(&j) {
            return 0;
        }
        // From the node before on the row before.
        let around = self.nodes >> (WINDOW * (j - 1) + (i - 1));
        let mut edges = 0;
        for (k, (di, dj)) in AROUND.into_iter().enumerate() {
            let bit = WINDOW * (dj + 1) as usize + (di + 1) as usize;
            edges |= ((around >> bit) as u32 & 1) << k;
        }
        edges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_marked_nodes_are_done() {
        let mut random = fastrand::Rng::with_seed(3);
        for _ in 0..200 {
            let mut best = Best::NONE;
            let mut marked = Vec::new();
            for _ in 0..12 {
                let node = (random.usize(0..12), random.usize(0..12));
                best.done.mark(node);
                marked.push(node);
                assert!(best.done.has(node));
                for (i, j) in (0..144).map(|k| (k % 12, k / 12)) {
                    assert!(!best.done.has((i, j)) || marked.contains(&(i, j)));
                    let ends = best.done.ends_around((i, j));
                    for (k, (di, dj)) in AROUND.into_iter().enumerate() {
                        let end = (i.wrapping_add_signed(di), j.wrapping_add_signed(dj));
                        assert!(ends >> k & 1 == 0 || best.done.has(end));
                    }
                }
            }
        }
    }

    #[test]
    fn the_ends_of_edges_are_found() {
        let mut done = Best::NONE.done;
        done.mark((20, 30));
        for (k, (di, dj)) in AROUND.into_iter().enumerate() {
            let node = (20_usize.wrapping_add_signed(-di), 30_usize.wrapping_add_signed(-dj));
            assert_eq!(done.ends_around(node), 1 << k);
        }
    }
}

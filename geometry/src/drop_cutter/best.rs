//! The highest contact found so far at one cutter location.

use crate::{Contact, ContactKind};
use glam::DVec3;

/// A height of the tip that is known to be touched. Of equal heights the first found stays: the
/// order of the search is fixed, so the contact is the same on every run.
pub(super) struct Best {
    /// Height of the tip, in mm; −∞ before the first contact.
    pub(super) tip: f64,
    /// The same, rounded down; finite, so that −∞, which stands for no block, is below it.
    pub(super) low: f32,
    pub(super) contact: Contact,
    /// The node whose visit found it.
    pub(super) node: (usize, usize),
    /// The cells of triangles tested, at places found by [`Self::is_new`].
    tested: [(usize, usize); 16],
}

impl Best {
    pub(super) const NONE: Self = Self {
        tip: f64::NEG_INFINITY,
        low: f32::MIN,
        contact: Contact::NONE,
        node: (0, 0),
        tested: [(usize::MAX, usize::MAX); 16],
    };

    /// Whether a triangle, told by its cell and which half of it, is not known to have been tested;
    /// from now on it is. Neighbours have places of their own, so that few are tested again.
    #[inline]
    pub(super) fn is_new(&mut self, cell: (usize, usize), upper: bool) -> bool {
        let half = usize::from(upper);
        let place = (cell.0 % 4) * 2 + half + (cell.1 % 2) * 8;
        let before = std::mem::replace(&mut self.tested[place], cell);
        before != cell
    }

    /// Takes over a contact if it is higher.
    #[inline]
    pub(super) fn raise(
        &mut self,
        tip: f64,
        kind: ContactKind,
        node: (usize, usize),
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

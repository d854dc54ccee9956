//! What a plugin offers, made once and kept for good.

use super::Offer;
use super::guard::{self, Fault};
use crate::node::Node;
use crate::{CutterShape, Dialect};
use carvegraph_abi::{self as abi, Status, status};
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

/// Plain data with pointers to what lives for good and never changes.
pub(super) struct Constant<T>(pub(super) T);

// SAFETY: only made of texts and lists that are never freed or written again.
unsafe impl<T> Send for Constant<T> {}
// SAFETY: likewise.
unsafe impl<T> Sync for Constant<T> {}

/// One thing, and whether it panicked. `I` is its description for the host.
pub(super) struct Item<T: ?Sized, I> {
    pub(super) thing: Box<T>,
    pub(super) info: OnceLock<Constant<I>>,
    poisoned: AtomicBool,
}

/// All that a plugin offers.
pub struct Shelf {
    pub(super) cutters: Vec<Item<dyn CutterShape, abi::CutterInfo>>,
    pub(super) dialects: Vec<Item<dyn Dialect, abi::DialectInfo>>,
    pub(super) nodes: Vec<Item<dyn Node, abi::NodeInfo>>,
}

fn items<T: ?Sized, I>(things: Vec<Box<T>>) -> Vec<Item<T, I>> {
    let item = |thing| Item { thing, info: OnceLock::new(), poisoned: AtomicBool::new(false) };
    things.into_iter().map(item).collect()
}

fn shelf<P: Offer>() -> &'static Shelf {
    P::shelf().get_or_init(|| {
        let offers = P::offers();
        Shelf {
            cutters: items(offers.cutters),
            dialects: items(offers.dialects),
            nodes: items(offers.nodes),
        }
    })
}

/// The number of things on one board of the shelf; one if making them panics, so that a call of it tells.
pub(super) fn count<P: Offer, T: 'static>(
    board: impl Fn(&'static Shelf) -> &'static Vec<T>,
) -> u32 {
    guard::run(|| board(shelf::<P>()).len() as u32).unwrap_or(1)
}

/// Calls `work` with one thing, guarded.
pub(super) fn with<P: Offer, T: ?Sized + 'static, I: 'static>(
    board: impl Fn(&'static Shelf) -> &'static Vec<Item<T, I>>,
    index: u32,
    fault: Fault,
    work: impl FnOnce(&'static Item<T, I>) -> Status,
) -> Status {
    let mut found = None;
    let looked = guard::once(fault, || {
        found = board(shelf::<P>()).get(index as usize);
        status::OK
    });
    match found {
        Some(item) => guard::call(&item.poisoned, fault, || work(item)),
        None if looked == status::OK => status::NO_SUCH,
        None => looked,
    }
}

/// A list that is kept for good.
pub(super) fn kept<T>(list: impl IntoIterator<Item = T>) -> &'static [T] {
    Vec::leak(list.into_iter().collect())
}

/// A text that is kept for good.
pub(super) fn kept_text(text: &str) -> abi::Text {
    super::lent(String::leak(text.to_owned()))
}

//! What a node's context does for a node of a plugin.

use carvegraph_core::{Context, Ticker};
use carvegraph_sdk::node::Services;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Parts that the work is counted in: ten for each percent that a user sees.
const PARTS: usize = 1000;

/// Services over a context.
pub(super) struct OfContext<'a> {
    cx: &'a Context<'a>,
    ticker: Ticker<'a>,
    /// Parts that are done.
    done: AtomicUsize,
}

impl<'a> OfContext<'a> {
    pub(super) fn new(cx: &'a Context<'_>) -> Self {
        Self { cx, ticker: cx.ticker(PARTS), done: AtomicUsize::new(0) }
    }
}

impl Services for OfContext<'_> {
    fn note(&self, text: &str) {
        self.cx.note(text);
    }

    fn warn(&self, text: &str) {
        self.cx.warn(text);
    }

    /// Progress never goes back; NaN counts as none.
    fn progress(&self, share: f64) -> bool {
        let done = (share.clamp(0.0, 1.0) * PARTS as f64) as usize;
        let before = self.done.fetch_max(done, Ordering::Relaxed);
        self.ticker.tick(done.saturating_sub(before))
    }

    fn parallel_for(&self, count: usize, body: &(dyn Fn(usize) + Sync)) -> bool {
        let go_on = |index| {
            let goes_on = !self.cx.is_cancelled();
            if goes_on {
                body(index);
            }
            goes_on.then_some(())
        };
        (0..count).into_par_iter().try_for_each(go_on).is_some()
    }
}

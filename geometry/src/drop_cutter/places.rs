//! The loop over the places of a pattern: one for every kind of surface.

use super::best::{Best, Place};
use crate::{Contact, Pattern, PatternSpan, Span, SpanKind, Tick, Toolpath};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Places handled in one go by one thread. Within them each search starts from the contact before,
/// so the number is fixed, not a matter of threads; and few enough to be told to stop in time.
const CHUNK: usize = 64;

/// A surface with its index, for one cutter.
pub(super) trait Ready: Sync + Send {
    /// Lowers the cutter at each point of `pattern`. `None` if `tick` stopped the work.
    fn path(&self, pattern: &Pattern, floor_z_mm: f64, tick: Tick) -> Option<Toolpath>;
}

/// Calls `drop` at each point of `pattern` and makes a path of what it finds; `floor_z_mm` where
/// that is nothing. `drop` is told the place before and what was touched there, if anything was.
///
/// `tick` counts points. `None` if it stopped the work.
#[inline]
pub(super) fn drop_at_places(
    pattern: &Pattern,
    floor_z_mm: f64,
    tick: Tick,
    drop: impl Fn(DVec2, Option<(DVec2, Place)>, &mut Best) + Sync,
) -> Option<Toolpath> {
    let places = &pattern.points;
    let mut tips = vec![DVec3::ZERO; places.len()];
    let mut contacts = vec![Contact::NONE; places.len()];
    let results = tips.par_chunks_mut(CHUNK).zip(contacts.par_chunks_mut(CHUNK));
    places.par_chunks(CHUNK).zip(results).try_for_each(|(places, (tips, contacts))| {
        let mut known: Option<(DVec2, Place)> = None;
        for ((&at, tip), contact) in places.iter().zip(tips).zip(contacts) {
            let mut best = Best::NONE;
            drop(at, known, &mut best);
            let touched = best.tip > f64::NEG_INFINITY;
            known = touched.then_some((at, best.node));
            *tip = at.extend(if touched { best.tip } else { floor_z_mm });
            *contact = best.contact;
        }
        tick(places.len()).then_some(())
    })?;
    let spans = pattern.spans.iter().map(span_of).collect();
    Some(Toolpath { tips, contacts, spans, feeds: None })
}

fn span_of(span: &PatternSpan) -> Span {
    let kind = if span.link { SpanKind::Link } else { SpanKind::Pass };
    Span { points: span.points.clone(), kind, joined: span.joined }
}

//! The loop over the places of a pattern: one for every kind of surface.

use super::best::{Best, Place};
use crate::{Contact, Pattern, PatternSpan, Span, SpanKind, Tick, Toolpath};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Places handled in one go by one thread. Within them each search starts from the contact before,
/// so the number is fixed, not a matter of threads; and few enough to be told to stop in time.
const CHUNK: usize = 64;

/// Side of a tile in places: the passes of a tile that lie a place apart share what they look at.
const TILE: f64 = 64.0;

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
    let results = tips.chunks_mut(CHUNK).zip(contacts.chunks_mut(CHUNK));
    let mut chunks: Vec<_> = places.chunks(CHUNK).zip(results).collect();
    // Neighbours in plan one after the other, so that the index they need is still in the cache.
    chunks.sort_by_cached_key(|(places, _)| tile_of(places));
    chunks.into_par_iter().try_for_each(|(places, (tips, contacts))| {
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
    Some(Toolpath { tips, contacts, spans, ..Toolpath::default() })
}

/// A square of the plan, as wide as a chunk is long, that holds the middle of the chunk: its row and
/// column.
fn tile_of(places: &[DVec2]) -> (i64, i64) {
    let (from, to) = (places[0], places[places.len() - 1]);
    let side = TILE * from.distance(places[1.min(places.len() - 1)]).max(f64::MIN_POSITIVE);
    let tile = (from.midpoint(to) / side).floor();
    // A cast cuts off what is beyond its range.
    (tile.y as i64, tile.x as i64)
}

fn span_of(span: &PatternSpan) -> Span {
    let kind = if span.link { SpanKind::Link } else { SpanKind::Pass };
    Span { points: span.points.clone(), kind, joined: span.joined }
}

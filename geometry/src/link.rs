//! Makes the moves of a path whole: lifts over, travels and plunges between passes that are not
//! joined, a start from above and an end above.
//!
//! Added before the first pass and wherever a span is not joined to the one before: a rapid
//! straight up to the safe height, a rapid across at that height, a plunge down to the first tip of
//! the pass. The plunge ends on the very point the pass begins with, so the passes keep all their
//! points and their count.
//!
//! A path may have plunges of its own, ways down to a level. Where one is not joined to what comes
//! before it begins at a place that the cutter reaches through the air: the rapid goes on to a
//! millimetre above it.

use crate::{Contact, Feeds, Span, SpanKind, Toolpath};
use glam::DVec3;

/// A rapid ends so far above a place that is known to be free, in mm: more than a stock is uneven or a
/// tool is measured wrong, and less than a second's feed.
const APPROACH_MM: f64 = 1.0;

/// Why a path can't be linked.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum LinkError {
    /// There is no point to go to.
    #[error("the tool path is empty: there is nothing to cut")]
    Empty,
    /// It has rapids already.
    #[error("the tool path has rapids already")]
    AlreadyLinked,
    /// A rapid would cross stock.
    #[error(
        "the safe height {safe_z_mm} mm is not above the highest point of the path, {highest_mm} mm: \
         raise it"
    )]
    SafeHeightTooLow {
        /// The safe height given, in mm.
        safe_z_mm: f64,
        /// The highest place of the tip, in mm.
        highest_mm: f64,
    },
    /// A speed that is not one.
    #[error("the {what} must be a positive speed, not {value} mm/min")]
    BadFeed {
        /// Which speed.
        what: &'static str,
        /// What was given, in mm/min.
        value: f64,
    },
}

/// Adds the rapids and plunges that `path` needs, and its speeds. `safe_z_mm` is the height of the
/// tip, in the path's own frame, at which rapids may go anywhere.
///
/// All spans of the result but the first are joined.
///
/// # Errors
/// If the path is empty or has rapids already, the safe height is below the highest tip, or a
/// speed is not positive.
pub fn link_passes(path: &Toolpath, safe_z_mm: f64, feeds: Feeds) -> Result<Toolpath, LinkError> {
    check(path, safe_z_mm, feeds)?;
    let room = path.tips.len() + 3 * path.spans.len() + 1;
    let mut linked = Toolpath {
        tips: Vec::with_capacity(room),
        contacts: Vec::with_capacity(room),
        spans: Vec::with_capacity(3 * path.spans.len() + 1),
        feeds: Some(feeds),
        arcs: Vec::with_capacity(path.arcs.len()),
    };
    let above = |tip: DVec3| tip.with_z(safe_z_mm);
    for span in path.spans.iter().filter(|span| !span.points.is_empty()) {
        let first = path.tips[span.points.start];
        let last = linked.tips.last().copied();
        if last.is_none() || !span.joined {
            let mut travel: Vec<DVec3> = last.map(above).into_iter().collect();
            travel.push(above(first));
            let near = first.z + APPROACH_MM;
            if span.kind == SpanKind::Plunge && near < safe_z_mm {
                travel.push(first.with_z(near));
            }
            linked.add_free(SpanKind::Rapid, &travel);
            linked.add_free(SpanKind::Plunge, &[first]);
        }
        let tips = &path.tips[span.points.clone()];
        let start = linked.tips.len();
        let arcs = path.arcs_within(span).iter();
        linked.arcs.extend(arcs.map(|(end, arc)| (end - span.points.start + start, *arc)));
        linked.add(span.kind, tips, path.contacts[span.points.clone()].iter().copied());
    }
    if let Some(last) = linked.tips.last().copied() {
        linked.add_free(SpanKind::Rapid, &[above(last)]);
    }
    Ok(linked)
}

impl Toolpath {
    /// Appends a span of moves that touch nothing.
    fn add_free(&mut self, kind: SpanKind, tips: &[DVec3]) {
        self.add(kind, tips, tips.iter().map(|_| Contact::NONE));
    }

    fn add(&mut self, kind: SpanKind, tips: &[DVec3], contacts: impl Iterator<Item = Contact>) {
        let start = self.tips.len();
        self.tips.extend_from_slice(tips);
        self.contacts.extend(contacts);
        let joined = !self.spans.is_empty();
        self.spans.push(Span { points: start..self.tips.len(), kind, joined });
    }
}

fn check(path: &Toolpath, safe_z_mm: f64, feeds: Feeds) -> Result<(), LinkError> {
    if path.tips.is_empty() || path.spans.is_empty() {
        return Err(LinkError::Empty);
    }
    if path.spans.iter().any(|s| s.kind == SpanKind::Rapid) {
        return Err(LinkError::AlreadyLinked);
    }
    let speeds = [
        ("feed", feeds.cut_mm_per_min),
        ("plunge feed", feeds.plunge_mm_per_min),
        ("rapid speed", feeds.rapid_mm_per_min),
    ];
    for (what, value) in speeds {
        if !(value.is_finite() && value > 0.0) {
            return Err(LinkError::BadFeed { what, value });
        }
    }
    let (_, highest_mm) = path.heights_mm();
    if !(safe_z_mm.is_finite() && safe_z_mm >= highest_mm) {
        return Err(LinkError::SafeHeightTooLow { safe_z_mm, highest_mm });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Direction, PathArc, Plane};

    const FEEDS: Feeds =
        Feeds { cut_mm_per_min: 600.0, plunge_mm_per_min: 200.0, rapid_mm_per_min: 3000.0 };

    fn two_passes(joined: bool) -> Toolpath {
        let tips: Vec<_> = [(0.0, 0.0, 1.0), (1.0, 0.0, 2.0), (1.0, 1.0, 0.5), (0.0, 1.0, 1.5)]
            .map(|(x, y, z)| DVec3::new(x, y, z))
            .into();
        let span = |points, joined| Span { points, kind: SpanKind::Pass, joined };
        let contacts = vec![Contact::NONE; tips.len()];
        let spans = vec![span(0..2, false), span(2..4, joined)];
        Toolpath { tips, contacts, spans, ..Toolpath::default() }
    }

    fn kinds(path: &Toolpath) -> Vec<(SpanKind, usize)> {
        path.spans.iter().map(|s| (s.kind, s.points.len())).collect()
    }

    #[test]
    fn joined_passes_are_entered_once() {
        use SpanKind::{Pass, Plunge, Rapid};
        let linked = link_passes(&two_passes(true), 5.0, FEEDS).unwrap();
        assert_eq!(kinds(&linked), [(Rapid, 1), (Plunge, 1), (Pass, 2), (Pass, 2), (Rapid, 1)]);
        assert_eq!(linked.tips[0], DVec3::new(0.0, 0.0, 5.0));
        assert_eq!(linked.tips[1], linked.tips[2]);
        assert_eq!(linked.tips.last(), Some(&DVec3::new(0.0, 1.0, 5.0)));
        assert_eq!((linked.cl_points(), linked.passes()), (4, 2));
        assert_eq!(linked.feeds, Some(FEEDS));
    }

    #[test]
    fn passes_apart_are_lifted_over() {
        use SpanKind::{Pass, Plunge, Rapid};
        let linked = link_passes(&two_passes(false), 2.0, FEEDS).unwrap();
        let expected =
            [(Rapid, 1), (Plunge, 1), (Pass, 2), (Rapid, 2), (Plunge, 1), (Pass, 2), (Rapid, 1)];
        assert_eq!(kinds(&linked), expected);
        assert_eq!(linked.tips[4], DVec3::new(1.0, 0.0, 2.0));
        assert_eq!(linked.tips[5], DVec3::new(1.0, 1.0, 2.0));
        assert_eq!(linked.cl_points(), 4);
    }

    #[test]
    fn a_way_down_of_the_path_begins_in_the_air() {
        use SpanKind::{Pass, Plunge, Rapid};
        let mut path = two_passes(true);
        path.spans[0].kind = Plunge;
        let linked = link_passes(&path, 5.0, FEEDS).unwrap();
        assert_eq!(kinds(&linked), [(Rapid, 2), (Plunge, 1), (Plunge, 2), (Pass, 2), (Rapid, 1)]);
        let heights: Vec<f64> = linked.tips.iter().map(|tip| tip.z).collect();
        assert_eq!(heights[..4], [5.0, 2.0, 1.0, 1.0]);
        // Not above the safe height.
        let low = link_passes(&path, 2.0, FEEDS).unwrap();
        assert_eq!(kinds(&low)[0], (Rapid, 1));
    }

    #[test]
    fn all_spans_but_the_first_are_joined_without_gaps() {
        let linked = link_passes(&two_passes(false), 2.0, FEEDS).unwrap();
        let mut end = 0;
        for (k, span) in linked.spans.iter().enumerate() {
            assert_eq!((span.joined, span.points.start), (k > 0, end));
            end = span.points.end;
        }
        assert_eq!((end, linked.contacts.len()), (linked.tips.len(), linked.tips.len()));
    }

    #[test]
    fn arcs_go_with_their_moves_and_bulge_below_the_safe_height() {
        let half_turn = |direction| {
            let mut path = two_passes(false);
            path.tips[..2].copy_from_slice(&[DVec3::Z * 4.0, DVec3::new(1.0, 0.0, 4.0)]);
            let center = DVec3::new(0.5, 0.0, 4.0);
            path.arcs = vec![(1, PathArc { plane: Plane::Zx, direction, center })];
            path
        };
        let valley = half_turn(Direction::Clockwise);
        let linked = link_passes(&valley, 4.2, FEEDS).unwrap();
        assert_eq!(linked.arcs, [(3, valley.arcs[0].1)]);
        assert_eq!(linked.tips[2..4], valley.tips[..2]);
        let too_low = LinkError::SafeHeightTooLow { safe_z_mm: 4.2, highest_mm: 4.5 };
        assert_eq!(link_passes(&half_turn(Direction::CounterClockwise), 4.2, FEEDS), Err(too_low));
    }

    #[test]
    fn unsafe_requests_are_refused() {
        let path = two_passes(true);
        let low = link_passes(&path, 1.9, FEEDS).unwrap_err();
        assert_eq!(
            low.to_string(),
            "the safe height 1.9 mm is not above the highest point of the path, 2 mm: raise it"
        );
        assert!(link_passes(&path, f64::NAN, FEEDS).is_err());
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let feeds = Feeds { plunge_mm_per_min: value, ..FEEDS };
            let error = link_passes(&path, 5.0, feeds).unwrap_err();
            assert!(matches!(error, LinkError::BadFeed { what: "plunge feed", .. }));
        }
        let empty = Toolpath::default();
        assert_eq!(link_passes(&empty, 5.0, FEEDS), Err(LinkError::Empty));
        let linked = link_passes(&path, 5.0, FEEDS).unwrap();
        assert_eq!(link_passes(&linked, 5.0, FEEDS), Err(LinkError::AlreadyLinked));
    }
}

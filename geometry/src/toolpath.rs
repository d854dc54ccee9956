//! A path of the cutter's tip.
//!
//! A path is a list of cutter locations cut into spans. All moves of a span are of one kind: a pass
//! or a link is fed along the surface, a plunge is fed down, a rapid is not fed at all. The first
//! point of a span is reached from the last point of the span before by the span's own kind of
//! move; the very first point of a path is where it begins.

use crate::{Motion, Move, MoveKind, PathArc};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::ops::Range;

/// What a cutter touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ContactKind {
    /// Nothing: the tip is at the floor height, or the move is not a cutting one.
    None,
    /// The inside of a facet.
    Facet,
    /// An edge.
    Edge,
    /// A vertex or a point.
    Vertex,
}

/// Where a cutter touches the surface (CC).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// The contact point in mm; meaningless where `kind` is `None`.
    pub point: DVec3,
    /// What is touched there.
    pub kind: ContactKind,
}

impl Contact {
    /// No contact at all.
    pub const NONE: Self = Self { point: DVec3::ZERO, kind: ContactKind::None };
}

/// How the tip moves along a span.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SpanKind {
    /// Cuts along the surface.
    Pass,
    /// Feeds along the surface from one pass to the next.
    Link,
    /// Feeds down into the stock. One that is not joined to the span before begins in the air.
    Plunge,
    /// Travels without cutting.
    Rapid,
}

/// A run of moves of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Span {
    /// Indices of its points; never empty.
    pub points: Range<usize>,
    /// How its points are reached.
    pub kind: SpanKind,
    /// Whether its first point follows from the last point of the span before. A path straight
    /// from the drop cutter has spans that do not (the cutter must be lifted over); a path that
    /// went through [`crate::link_passes`] has none but the first.
    pub joined: bool,
}

/// Speeds of a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feeds {
    /// Speed of passes and links, in mm/min.
    pub cut_mm_per_min: f64,
    /// Speed of plunges, in mm/min.
    pub plunge_mm_per_min: f64,
    /// Speed of rapids, for estimates only, in mm/min.
    pub rapid_mm_per_min: f64,
}

/// A path of the cutter's tip, three-axis, tool axis +Z.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Toolpath {
    /// Positions of the tip (CL) in mm, in the order they are visited.
    pub tips: Vec<DVec3>,
    /// What the cutter touches at each tip; as long as `tips`.
    pub contacts: Vec<Contact>,
    /// The runs the path is made of, in order, without gaps.
    pub spans: Vec<Span>,
    /// Speeds, once they are known.
    pub feeds: Option<Feeds>,
    /// Moves that are arcs, by the index of the tip at which they end, in order; all others are straight.
    /// An arc never leads from one span to the next.
    pub arcs: Vec<(usize, PathArc)>,
}

impl Toolpath {
    /// Cutter locations on passes: links, plunges and rapids do not count.
    #[must_use]
    pub fn cl_points(&self) -> usize {
        self.spans.iter().filter(|s| s.kind == SpanKind::Pass).map(|s| s.points.len()).sum()
    }

    /// Number of passes.
    #[must_use]
    pub fn passes(&self) -> usize {
        self.spans.iter().filter(|s| s.kind == SpanKind::Pass).count()
    }

    /// Raises the tips that are below a height; they touch nothing there.
    pub fn raise(&mut self, floor_z_mm: f64) {
        for (tip, contact) in self.tips.iter_mut().zip(&mut self.contacts) {
            if tip.z < floor_z_mm {
                (tip.z, *contact) = (floor_z_mm, Contact::NONE);
            }
        }
    }

    /// Length in mm of all moves made with the kinds of span for which `wanted` says yes.
    #[must_use]
    pub fn length_mm(&self, wanted: impl Fn(SpanKind) -> bool) -> f64 {
        let mut length = 0.0;
        for span in self.spans.iter().filter(|s| wanted(s.kind)) {
            let first = if span.joined && span.points.start > 0 {
                span.points.start - 1
            } else {
                span.points.start
            };
            length += self.tips[first..span.points.end]
                .windows(2)
                .map(|pair| pair[0].distance(pair[1]))
                .sum::<f64>();
            for (end, arc) in self.arcs_within(span) {
                let (from, to) = (self.tips[end - 1], self.tips[*end]);
                length += arc.length_mm(from, to) - from.distance(to);
            }
        }
        length
    }

    /// The lowest and the highest place of the tip, on arcs too, in mm; endless and inverted if there is
    /// none.
    #[must_use]
    pub fn heights_mm(&self) -> (f64, f64) {
        let ends = self.tips.iter().map(|tip| (tip.z, tip.z));
        let bulges = self.arcs.iter().map(|(end, arc)| {
            let around = arc.bounds(self.tips[end - 1], self.tips[*end]);
            (around.min.z, around.max.z)
        });
        let none = (f64::INFINITY, f64::NEG_INFINITY);
        ends.chain(bulges).fold(none, |(low, high), (z, top)| (low.min(z), high.max(top)))
    }

    /// The arcs of a span, with the indices of the tips at which they end.
    pub fn arcs_within(&self, span: &Span) -> &[(usize, PathArc)] {
        let before = |index: usize| self.arcs.partition_point(|(end, _)| *end < index);
        &self.arcs[before(span.points.start)..before(span.points.end)]
    }

    /// The path without arcs: chords that stay within `tolerance_mm` of them. What is touched along a
    /// chord is not known.
    #[must_use]
    pub fn flattened(&self, tolerance_mm: f64) -> Cow<'_, Self> {
        if self.arcs.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut flat = Self { feeds: self.feeds, ..Self::default() };
        for span in &self.spans {
            let start = flat.tips.len();
            let mut arcs = self.arcs_within(span).iter().peekable();
            for index in span.points.clone() {
                if let Some((end, arc)) = arcs.next_if(|(end, _)| *end == index) {
                    let chords = arc.chords(self.tips[end - 1], self.tips[*end], tolerance_mm);
                    flat.tips.extend(chords);
                    flat.tips.pop();
                }
                flat.tips.push(self.tips[index]);
                flat.contacts.resize(flat.tips.len() - 1, Contact::NONE);
                flat.contacts.push(self.contacts[index]);
            }
            flat.spans.push(Span { points: start..flat.tips.len(), ..span.clone() });
        }
        Cow::Owned(flat)
    }

    /// The moves of a path that went through [`crate::link_passes`], from its first tip on. `None` until
    /// it has feeds.
    #[must_use]
    pub fn motion(&self) -> Option<Motion> {
        let feeds = self.feeds?;
        let start = *self.tips.first()?;
        let mut motion = Motion { start, moves: Vec::with_capacity(self.tips.len()), arcs: vec![] };
        for span in &self.spans {
            let mut arcs = self.arcs_within(span).iter().peekable();
            for index in span.points.clone() {
                let kind = match arcs.next_if(|(end, _)| *end == index) {
                    Some((_, arc)) => {
                        motion.arcs.push(*arc);
                        MoveKind::Arc { arc: motion.arcs.len() as u32 - 1 }
                    }
                    None if span.kind == SpanKind::Rapid => MoveKind::Rapid,
                    None => MoveKind::Line,
                };
                let mm_per_min = match span.kind {
                    SpanKind::Pass | SpanKind::Link => feeds.cut_mm_per_min,
                    SpanKind::Plunge => feeds.plunge_mm_per_min,
                    SpanKind::Rapid => feeds.rapid_mm_per_min,
                };
                motion.moves.push(Move { to: self.tips[index], mm_per_min, kind });
            }
        }
        Some(motion)
    }

    /// Length ÷ speed over all moves, in seconds; a machine that must accelerate takes longer.
    /// `None` until the path has feeds.
    #[must_use]
    pub fn time_at_full_speed_s(&self) -> Option<f64> {
        let feeds = self.feeds?;
        let minutes = self.length_mm(|k| matches!(k, SpanKind::Pass | SpanKind::Link))
            / feeds.cut_mm_per_min
            + self.length_mm(|k| k == SpanKind::Plunge) / feeds.plunge_mm_per_min
            + self.length_mm(|k| k == SpanKind::Rapid) / feeds.rapid_mm_per_min;
        Some(minutes * 60.0)
    }
}

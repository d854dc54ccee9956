//! Drops a cutter on a height field at all places of a pattern.

use super::around_node::AroundNode;
use super::ball::Ball;
use super::best::Best;
use super::flat::Flat;
use super::gauge::{BallGauge, BulgeGauge, FlatGauge, Gauge, Nearer, TableGauge};
use super::general::General;
use super::probes::{Peaks, Vertices};
use super::search::{Ground, Probe};
use super::shape::Shape;
use crate::{
    Contact, HeightField, Pattern, PatternSpan, Profile, Segment, Span, SpanKind, Tick, Toolpath,
};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What of a height field a cutter is dropped on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Against {
    /// The nodes alone: the vertex test. Right where they stand much denser than the cutter is
    /// wide; else the cutter dips between them.
    Points,
    /// The two triangles of each cell: facets, edges and vertices.
    Mesh,
}

/// Places handled in one go by one thread. Within them each search starts from the contact before,
/// so the number is fixed, not a matter of threads; and few enough to be told to stop in time.
const CHUNK: usize = 64;

/// Lowers a cutter on a field at each point of `pattern`, and keeps what it touches there.
///
/// The pattern's passes and links become spans of the path, `joined` as they are. Where nothing of
/// the field is under the cutter the tip is at `floor_z_mm`. The result is the same whatever the
/// number of threads.
///
/// `tick` counts points of the pattern; it is also called, with 0, while the index is built. `None`
/// if it stopped the work.
#[must_use]
pub fn drop_on_height_field(
    field: &HeightField,
    against: Against,
    profile: &Profile,
    pattern: &Pattern,
    floor_z_mm: f64,
    tick: Tick,
) -> Option<Toolpath> {
    let ground = Ground::new(field, profile.radius_mm(), tick)?;
    let job = Job { ground: &ground, pattern, floor_z_mm, tick };
    match ShapeKind::of(profile) {
        ShapeKind::Ball => job.drop_ball(&Ball { radius: profile.radius_mm() }, against),
        ShapeKind::Flat => {
            let flat = Flat { radius: profile.radius_mm() };
            job.drop_shape(&flat, FlatGauge, against)
        }
        ShapeKind::General => {
            let general = General::new(profile);
            let gauge = TableGauge::new(&general, profile.height(profile.radius_mm()));
            job.drop_shape(&general, gauge, against)
        }
    }
}

/// Shapes with kernels of their own.
enum ShapeKind {
    Ball,
    Flat,
    General,
}

impl ShapeKind {
    /// Upright segments after the last that goes outward touch nothing that its end does not.
    fn of(profile: &Profile) -> Self {
        let radius = profile.radius_mm();
        let outward = profile.pieces().filter(|(from, segment)| segment.to()[0] > from[0]);
        let mut outward = outward.map(|(_, segment)| *segment);
        match (outward.next(), outward.next()) {
            (Some(Segment::Arc { to, center }), None)
                if to == [radius; 2] && center == [0.0, radius] =>
            {
                Self::Ball
            }
            (Some(Segment::Line { to }), None) if to[1] == 0.0 => Self::Flat,
            _ => Self::General,
        }
    }
}

struct Job<'a> {
    ground: &'a Ground<'a>,
    pattern: &'a Pattern,
    floor_z_mm: f64,
    tick: Tick<'a>,
}

impl Job<'_> {
    /// Pitch / R.
    fn pitch(&self, shape: &impl Shape) -> f64 {
        self.ground.pitch / shape.radius()
    }

    fn drop_shape<S: Shape>(
        &self,
        shape: &S,
        gauge: impl Gauge,
        against: Against,
    ) -> Option<Toolpath> {
        match against {
            Against::Points => self.run(&Vertices { shape, gauge }),
            Against::Mesh => {
                let pitch = self.pitch(shape);
                let by = (pitch * (1.0 + 1e-6)) as f32;
                self.run(&Peaks { shape, gauge: Nearer { by, gauge }, pitch })
            }
        }
    }

    fn drop_ball(&self, ball: &Ball, against: Against) -> Option<Toolpath> {
        let pitch = self.pitch(ball);
        match BulgeGauge::new(pitch).filter(|_| against == Against::Mesh) {
            Some(gauge) => self.run(&AroundNode { ball, gauge, pitch }),
            None => self.drop_shape(ball, BallGauge, against),
        }
    }

    /// Searches with `probe` at each place.
    fn run<P: Probe + Sync>(&self, probe: &P) -> Option<Toolpath> {
        let places = &self.pattern.points;
        let mut tips = vec![DVec3::ZERO; places.len()];
        let mut contacts = vec![Contact::NONE; places.len()];
        let results = tips.par_chunks_mut(CHUNK).zip(contacts.par_chunks_mut(CHUNK));
        places.par_chunks(CHUNK).zip(results).try_for_each(|(places, (tips, contacts))| {
            let mut known: Option<(DVec2, (usize, usize))> = None;
            for ((&at, tip), contact) in places.iter().zip(tips).zip(contacts) {
                let mut best = Best::NONE;
                self.start(probe, at, known, &mut best);
                self.ground.search(probe, at, &mut best);
                let touched = best.tip > f64::NEG_INFINITY;
                known = touched.then_some((at, best.node));
                *tip = at.extend(if touched { best.tip } else { self.floor_z_mm });
                *contact = best.contact;
            }
            (self.tick)(places.len()).then_some(())
        })?;
        let spans = self.pattern.spans.iter().map(span_of).collect();
        Some(Toolpath { tips, contacts, spans, feeds: None })
    }

    /// Visits nodes that are likely near the contact: the one at the place before, the one as far
    /// along as the cutter has moved since; or else the one under the axis.
    #[inline]
    fn start<P: Probe>(
        &self,
        probe: &P,
        at: DVec2,
        known: Option<(DVec2, (usize, usize))>,
        best: &mut Best,
    ) {
        let ground = self.ground;
        let Some((before, (i, j))) = known else {
            let (i, j) = ground.nearest(at);
            return probe.glance(ground, at, i, j, best);
        };
        probe.glance(ground, at, i, j, best);
        let moved = DVec2::new(i as f64, j as f64) * ground.pitch + (at - before);
        let (next_i, next_j) = ground.nearest(moved);
        if (next_i, next_j) != (i, j) {
            probe.glance(ground, at, next_i, next_j, best);
        }
    }
}

fn span_of(span: &PatternSpan) -> Span {
    let kind = if span.link { SpanKind::Link } else { SpanKind::Pass };
    Span { points: span.points.clone(), kind, joined: span.joined }
}

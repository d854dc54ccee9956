//! Drops a cutter on a height field at all places of a pattern.

use super::around_node::AroundNode;
use super::ball::Ball;
use super::best::{Best, Place};
use super::flat::Flat;
use super::gauge::{BallGauge, BulgeGauge, FlatGauge, Gauge, Nearer, TableGauge};
use super::general::General;
use super::places::drop_at_places;
use super::probes::{Peaks, Vertices};
use super::search::{Ground, Probe};
use super::shape::{Shape, ShapeKind};
use crate::{HeightField, Pattern, Profile, Tick, Toolpath};
use glam::DVec2;
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
        drop_at_places(self.pattern, self.floor_z_mm, self.tick, |at, known, best| {
            self.start(probe, at, known, best);
            self.ground.search(probe, at, best);
        })
    }

    /// Visits nodes that are likely near the contact: the one at the place before, the one as far
    /// along as the cutter has moved since; or else the one under the axis.
    #[inline]
    fn start<P: Probe>(
        &self,
        probe: &P,
        at: DVec2,
        known: Option<(DVec2, Place)>,
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

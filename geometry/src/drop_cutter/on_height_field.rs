//! Drops a cutter on a height field at all places of a pattern.

use super::around_node::AroundNode;
use super::ball::Ball;
use super::best::{Best, Place};
use super::bulge::Bulge;
use super::flat::Flat;
use super::gauge::{BallGauge, FlatGauge, Gauge, Nearer, TableGauge};
use super::general::General;
use super::places::{Ready, drop_at_places};
use super::probes::Vertices;
use super::search::{Ground, Probe};
use super::shape::{Shape, ShapeKind};
use crate::{HeightField, Pattern, Profile, Tick, Toolpath};
use glam::DVec2;
use serde::{Deserialize, Serialize};
use wide::f32x4;

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
    ready(field, against, profile, tick)?.path(pattern, floor_z_mm, tick)
}

/// A field with its index, for one cutter. `None` if `tick` stopped the work.
pub(super) fn ready<'a>(
    field: &'a HeightField,
    against: Against,
    profile: &Profile,
    tick: Tick,
) -> Option<Box<dyn Ready + 'a>> {
    let (radius, kind) = (profile.radius_mm(), ShapeKind::of(profile));
    let bulge = match kind {
        ShapeKind::Ball if against == Against::Mesh => Bulge::new(radius, field.pitch_mm()),
        _ => None,
    };
    let ground = Ground::new(field, radius, bulge.as_ref(), tick)?;
    Some(match kind {
        ShapeKind::Ball => {
            let ball = Ball { radius };
            match bulge {
                Some(bulge) => {
                    let pitch = ground.pitch / radius;
                    on(ground, AroundNode { shape: ball, gauge: bulge.gauge(), pitch })
                }
                None => with_shape(ground, ball, BallGauge, against),
            }
        }
        ShapeKind::Flat => with_shape(ground, Flat { radius }, FlatGauge, against),
        ShapeKind::General => {
            let general = General::new(profile);
            let gauge = TableGauge::new(&general, profile.height(radius));
            with_shape(ground, general, gauge, against)
        }
    })
}

fn with_shape<'a>(
    ground: Ground<'a>,
    shape: impl Shape + 'a,
    gauge: impl Gauge + 'a,
    against: Against,
) -> Box<dyn Ready + 'a> {
    match against {
        Against::Points => on(ground, Vertices { shape, gauge }),
        Against::Mesh => {
            let pitch = ground.pitch / shape.radius();
            let by = f32x4::splat((pitch * (1.0 + 1e-6)) as f32);
            on(ground, AroundNode { shape, gauge: Nearer { by, gauge }, pitch })
        }
    }
}

fn on<'a>(ground: Ground<'a>, probe: impl Probe + Sync + Send + 'a) -> Box<dyn Ready + 'a> {
    Box::new(OnField { ground, probe })
}

struct OnField<'a, P> {
    ground: Ground<'a>,
    probe: P,
}

impl<P: Probe + Sync + Send> Ready for OnField<'_, P> {
    fn path(&self, pattern: &Pattern, floor_z_mm: f64, tick: Tick) -> Option<Toolpath> {
        drop_at_places(pattern, floor_z_mm, tick, |at, known, best| {
            self.start(at, known, best);
            self.ground.search(&self.probe, at, best);
        })
    }
}

impl<P: Probe> OnField<'_, P> {
    /// Visits a node that is likely near the contact: that at the place before or the one as far along as
    /// the cutter has moved since, whichever is touched at the higher tip; or else the one under the axis.
    #[inline]
    fn start(&self, at: DVec2, known: Option<(DVec2, Place)>, best: &mut Best) {
        let Self { ground, probe } = self;
        let Some((before, (i, j))) = known else {
            let (i, j) = ground.nearest(at);
            return probe.visit(ground, at, i, j, best);
        };
        probe.glance(ground, at, i, j, best);
        let moved = DVec2::new(i as f64, j as f64) * ground.pitch + (at - before);
        let (next_i, next_j) = ground.nearest(moved);
        if (next_i, next_j) != (i, j) {
            probe.glance(ground, at, next_i, next_j, best);
        }
        let (i, j) = best.node;
        probe.visit(ground, at, i, j, best);
    }
}

//! Drops a cutter on triangles or points that lie anywhere.

use super::ball::Ball;
use super::best::{Best, Place};
use super::boxes::Boxes;
use super::facet::drop_on_triangle;
use super::flat::Flat;
use super::gauge::{BallGauge, FlatGauge};
use super::general::General;
use super::lids::{LidGauge, TangentGauge};
use super::places::{Ready, drop_at_places};
use super::shape::{Shape, ShapeKind};
use crate::{ContactKind, Mesh, Pattern, PointCloud, Profile, ProfileError, Tick, Toolpath};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Why a cutter cannot be dropped on a mesh or points.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum DropError {
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} has vertex {vertex}, but there are only {vertices}")]
    NoSuchVertex {
        /// The triangle, counted from 0.
        triangle: usize,
        /// The vertex it names, counted from 0.
        vertex: u32,
        /// Vertices in all.
        vertices: usize,
    },
    /// A NaN or an infinity.
    #[error("point {point} is at {at}: every coordinate must be finite")]
    NotFinite {
        /// The point or vertex, counted from 0.
        point: usize,
        /// Where it lies, in mm.
        at: DVec3,
    },
    /// More than the index can count.
    #[error("{0} triangles or points are more than the {max} that can be indexed", max = u32::MAX)]
    TooMany(usize),
    /// A path that follows all bends of the surface would be too long.
    #[error("more than {0} points would be needed where the path bends")]
    TooManyBends(usize),
    /// An allowance that is not one.
    #[error(transparent)]
    BadAllowance(#[from] ProfileError),
    /// The tick answered no.
    #[error("stopped")]
    Stopped,
}

/// Lowers a cutter on a mesh at each point of `pattern`, and keeps what it touches there: facets,
/// edges and vertices of all triangles, whichever way they face, of overhangs the highest.
///
/// Path, floor and `tick` are as those of [`crate::drop_on_height_field`]. On a mesh without
/// triangles all tips are at the floor.
///
/// # Errors
/// If a vertex is not finite or does not exist, there are too many triangles, or `tick` stopped the
/// work.
pub fn drop_on_mesh(
    mesh: &Mesh,
    profile: &Profile,
    pattern: &Pattern,
    floor_z_mm: f64,
    tick: Tick,
) -> Result<Toolpath, DropError> {
    ready_mesh(mesh, profile, tick)?.path(pattern, floor_z_mm, tick).ok_or(DropError::Stopped)
}

/// A mesh with its index, for one cutter.
pub(super) fn ready_mesh(
    mesh: &Mesh,
    profile: &Profile,
    tick: Tick,
) -> Result<Box<dyn Ready>, DropError> {
    check_points(&mesh.vertices)?;
    check_triangles(mesh)?;
    let radius = profile.radius_mm();
    let built = Boxes::build(mesh.triangles.len(), |t| mesh.corners(t), radius, tick);
    let (boxes, order) = built.ok_or(DropError::Stopped)?;
    let triangles = order.into_par_iter().map(|t| mesh.triangles[t as usize]).collect();
    Ok(with_shape(boxes, Triangles::in_order(&mesh.vertices, triangles), profile))
}

/// Lowers a cutter on points at each point of `pattern`: the vertex test alone. It is right where
/// the points stand much denser than the cutter is wide; else the cutter dips between them.
///
/// Path, floor and `tick` are as those of [`crate::drop_on_height_field`]. Without points all tips
/// are at the floor.
///
/// # Errors
/// If a point is not finite, there are too many, or `tick` stopped the work.
pub fn drop_on_points(
    cloud: &PointCloud,
    profile: &Profile,
    pattern: &Pattern,
    floor_z_mm: f64,
    tick: Tick,
) -> Result<Toolpath, DropError> {
    ready_points(cloud, profile, tick)?.path(pattern, floor_z_mm, tick).ok_or(DropError::Stopped)
}

/// Points with their index, for one cutter.
pub(super) fn ready_points(
    cloud: &PointCloud,
    profile: &Profile,
    tick: Tick,
) -> Result<Box<dyn Ready>, DropError> {
    check_points(&cloud.points)?;
    let points = &cloud.points;
    let built = Boxes::build(points.len(), |k| [points[k]; 3], profile.radius_mm(), tick);
    let (boxes, order) = built.ok_or(DropError::Stopped)?;
    let points = order.into_par_iter().map(|k| points[k as usize]).collect();
    Ok(with_shape(boxes, Points(points), profile))
}

fn check_points(points: &[DVec3]) -> Result<(), DropError> {
    let bad = points.par_iter().position_first(|point| !point.is_finite());
    let bad = bad.map(|point| DropError::NotFinite { point, at: points[point] });
    bad.map_or_else(|| check_count(points.len()), Err)
}

fn check_triangles(mesh: &Mesh) -> Result<(), DropError> {
    let vertices = mesh.vertices.len();
    let missing = |corners: &[u32; 3]| corners.iter().copied().find(|&v| v as usize >= vertices);
    let bad = mesh.triangles.par_iter().position_first(|corners| missing(corners).is_some());
    match bad.and_then(|t| Some((t, missing(&mesh.triangles[t])?))) {
        Some((triangle, vertex)) => Err(DropError::NoSuchVertex { triangle, vertex, vertices }),
        None => check_count(mesh.triangles.len()),
    }
}

fn check_count(count: usize) -> Result<(), DropError> {
    if u32::try_from(count).is_ok() { Ok(()) } else { Err(DropError::TooMany(count)) }
}

/// What is touched: things by their number in the index.
trait Things: Sync + Send {
    fn drop(&self, shape: &impl Shape, item: usize, at: DVec2, best: &mut Best);
}

/// In the order of the index, so that what is looked at together lies together.
struct Triangles {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Triangles {
    /// Puts the vertices in the order in which the triangles name them.
    fn in_order(vertices: &[DVec3], mut triangles: Vec<[u32; 3]>) -> Self {
        const NOT_YET: u32 = u32::MAX;
        let mut places = vec![NOT_YET; vertices.len()];
        let mut named = Vec::with_capacity(vertices.len());
        for vertex in triangles.as_flattened_mut() {
            let place = &mut places[*vertex as usize];
            if *place == NOT_YET {
                *place = named.len() as u32;
                named.push(vertices[*vertex as usize]);
            }
            *vertex = *place;
        }
        Self { vertices: named, triangles }
    }
}

impl Things for Triangles {
    #[inline]
    fn drop(&self, shape: &impl Shape, item: usize, at: DVec2, best: &mut Best) {
        let corners = self.triangles[item].map(|v| self.vertices[v as usize]);
        drop_on_triangle(shape, corners, item, at, best);
    }
}

struct Points(Vec<DVec3>);

impl Things for Points {
    #[inline]
    fn drop(&self, shape: &impl Shape, item: usize, at: DVec2, best: &mut Best) {
        let point = self.0[item];
        let tip = point.z - shape.height((point.truncate() - at).length_squared());
        best.raise(tip, ContactKind::Vertex, (item, 0), || point);
    }
}

fn with_shape(boxes: Boxes, surface: impl Things + 'static, profile: &Profile) -> Box<dyn Ready> {
    let radius = profile.radius_mm();
    match ShapeKind::of(profile) {
        ShapeKind::Ball => {
            Box::new(OnThings { boxes, surface, shape: Ball { radius }, gauge: BallGauge })
        }
        ShapeKind::Flat => {
            Box::new(OnThings { boxes, surface, shape: Flat { radius }, gauge: FlatGauge })
        }
        ShapeKind::General => {
            let shape = General::new(profile);
            let gauge = TangentGauge::new(&shape, profile.height(radius));
            Box::new(OnThings { boxes, surface, shape, gauge })
        }
    }
}

struct OnThings<S, H, G> {
    boxes: Boxes,
    surface: S,
    shape: H,
    gauge: G,
}

impl<S: Things, H: Shape, G: LidGauge> Ready for OnThings<S, H, G> {
    fn path(&self, pattern: &Pattern, floor_z_mm: f64, tick: Tick) -> Option<Toolpath> {
        drop_at_places(pattern, floor_z_mm, tick, |at, known, best| {
            if let Some(item) = self.first(at, known) {
                self.surface.drop(&self.shape, item, at, best);
            }
            self.boxes.search(&self.gauge, at, best, &|item, best: &mut Best| {
                self.surface.drop(&self.shape, item, at, best);
            });
        })
    }
}

impl<S, H, G> OnThings<S, H, G> {
    /// What is likely near the contact: what was touched at the place before, or else what is high
    /// and near.
    #[inline]
    fn first(&self, at: DVec2, known: Option<(DVec2, Place)>) -> Option<usize> {
        known.map_or_else(|| self.boxes.likely(at), |(_, (item, _))| Some(item))
    }
}

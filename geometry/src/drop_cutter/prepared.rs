//! A cutter above a surface, ready to be lowered again and again.

use super::places::Ready;
use super::{Against, DropError, on_height_field, on_mesh};
use crate::{Bounds, HeightField, Mesh, Pattern, PointCloud, Profile, Tick, Toolpath};
use rayon::prelude::*;
use std::fmt;

/// Any surface that a cutter can be dropped on.
#[derive(Clone, Copy, Debug)]
pub enum Surface<'a> {
    /// A field, and what of it counts.
    Field(&'a HeightField, Against),
    /// Triangles that lie anywhere.
    Mesh(&'a Mesh),
    /// Points that lie anywhere.
    Points(&'a PointCloud),
}

impl Surface<'_> {
    /// The box that holds it; `None` if there is nothing in it.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Self::Field(field, _) => Some(field.bounds()),
            Self::Mesh(mesh) => mesh.bounds(),
            Self::Points(cloud) => cloud.bounds(),
        }
    }
}

/// A surface with an index for one cutter, which takes most of the time of a short pattern to build.
pub struct DropCutter<'a> {
    ready: Box<dyn Ready + 'a>,
    /// From the tip that is dropped to the cutter's own.
    lift_mm: f64,
}

impl fmt::Debug for DropCutter<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DropCutter").finish_non_exhaustive()
    }
}

impl<'a> DropCutter<'a> {
    /// Builds the index for a cutter that is to leave `allowance_mm` on the surface: no point of it
    /// comes closer (see [`Profile::grown`]).
    ///
    /// # Errors
    /// As [`crate::drop_on_mesh`], and if the allowance is negative or not finite.
    pub fn new(
        surface: Surface<'a>,
        profile: &Profile,
        allowance_mm: f64,
        tick: Tick,
    ) -> Result<Self, DropError> {
        let grown = profile.grown(allowance_mm)?;
        let ready = match surface {
            Surface::Field(field, against) => {
                on_height_field::ready(field, against, &grown, tick).ok_or(DropError::Stopped)?
            }
            Surface::Mesh(mesh) => on_mesh::ready_mesh(mesh, &grown, tick)?,
            Surface::Points(cloud) => on_mesh::ready_points(cloud, &grown, tick)?,
        };
        Ok(Self { ready, lift_mm: allowance_mm })
    }

    /// Lowers the cutter at each point of `pattern`, as [`crate::drop_on_height_field`] does; the tips
    /// are the cutter's own. `None` if `tick` stopped the work.
    #[must_use]
    pub fn path(&self, pattern: &Pattern, floor_z_mm: f64, tick: Tick) -> Option<Toolpath> {
        let mut path = self.ready.path(pattern, floor_z_mm - self.lift_mm, tick)?;
        if self.lift_mm > 0.0 {
            path.tips.par_iter_mut().for_each(|tip| tip.z += self.lift_mm);
        }
        Some(path)
    }
}

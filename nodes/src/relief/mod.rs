//! Reliefs composed: surfaces of heights put together, bounded, bent, framed, stamped,
//! repeated and flattened.

mod bas_relief;
mod border;
mod clamp_field;
mod combine_fields;
mod dome;
mod limit_slope;
mod plate;
mod scale_field;
mod stamp;
mod tile_field;

pub(crate) use bas_relief::BasReliefNode;
pub(crate) use border::Border;
pub(crate) use clamp_field::ClampField;
pub(crate) use combine_fields::CombineFields;
pub(crate) use dome::Dome;
pub(crate) use limit_slope::LimitSlope;
pub(crate) use plate::Plate;
pub(crate) use scale_field::ScaleField;
pub(crate) use stamp::Stamp;
pub(crate) use tile_field::TileField;

use crate::picture::MAX_PIXELS;
use carvegraph_core::{Conflict, Context, Inputs, NodeError, Outputs, Yielding};
use carvegraph_geometry::{Bounds, HeightField};
use rayon::prelude::*;

#[derive(Inputs)]
pub(crate) struct Before<'a> {
    /// The surface.
    surface: &'a HeightField,
}

#[derive(Outputs)]
pub(crate) struct After {
    /// The surface that became of it; its near left corner is the origin.
    surface: HeightField,
    /// The box that holds it.
    bounds: Bounds,
}

impl After {
    /// From heights over a grid of the pitch of `like`.
    fn of(
        heights: Vec<f32>,
        [columns, rows]: [usize; 2],
        like: &HeightField,
    ) -> Result<Self, NodeError> {
        let surface = HeightField::new(columns, rows, like.pitch_mm(), heights);
        let surface = surface.map_err(NodeError::failed)?;
        let bounds = surface.bounds();
        Ok(Self { surface, bounds })
    }

    /// A surface of `size`, of the pitch of `like`, whose node (column, row) has the height that
    /// `height` gives, in mm.
    fn by_nodes(
        size: [usize; 2],
        like: &HeightField,
        cx: &Context<'_>,
        height: impl Fn(usize, usize) -> f64 + Sync,
    ) -> Result<Self, NodeError> {
        let [columns, rows] = size;
        let ticker = cx.ticker(rows);
        let mut heights = vec![0.0; columns * rows];
        let done = heights.par_chunks_exact_mut(columns).enumerate().try_for_each(|(j, row)| {
            row.iter_mut().enumerate().for_each(|(i, z)| *z = height(i, j) as f32);
            ticker.tick(1).then_some(())
        });
        cx.completed(done)?;
        Self::of(heights, size, like)
    }
}

/// Nodes along x and y.
fn size(field: &HeightField) -> [usize; 2] {
    [field.columns(), field.rows()]
}

/// Complains of limits that leave nothing between them.
fn check_range(z_min: &Yielding<f64>, z_max: &Yielding<f64>) -> Result<(), Conflict> {
    let (low, high) = (z_min.or(Some(f64::NEG_INFINITY)), z_max.or(Some(f64::INFINITY)));
    if low < high {
        return Ok(());
    }
    let message = format!("z_max ({high} mm) must be above z_min ({low} mm)");
    Err(Conflict { param: "z_max", message })
}

/// Refuses surfaces that are larger than any picture may be, by the parameter that makes them so.
fn check_size([columns, rows]: [usize; 2], param: &'static str) -> Result<(), NodeError> {
    if columns.saturating_mul(rows) as u64 <= MAX_PIXELS {
        return Ok(());
    }
    let message =
        format!("it makes a surface of {columns} × {rows} nodes; the limit is {MAX_PIXELS}");
    Err(NodeError::refused(param, message))
}

#[cfg(test)]
mod testing {
    use super::{After, Before};
    use crate::testing::run;
    use carvegraph_core::Node;
    use carvegraph_geometry::HeightField;

    /// A surface of nodes half a millimetre apart, from its rows, nearest first.
    pub(super) fn field<const N: usize>(rows: &[[f32; N]]) -> HeightField {
        HeightField::new(N, rows.len(), 0.5, rows.concat()).unwrap()
    }

    /// What a node makes of a surface.
    pub(super) fn shaped<N>(node: &N, surface: &HeightField) -> Result<HeightField, String>
    where
        N: for<'a> Node<Inputs<'a> = Before<'a>, Outputs = After>,
    {
        let after = run(|cx| node.run(Before { surface }, cx));
        after.map(|after| after.surface).map_err(|fault| fault.to_string())
    }
}

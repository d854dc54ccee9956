//! A picture made row by row, in parallel, in a way that can be called off.

use crate::values::GrayImage;
use carvegraph_core::{Context, NodeError};
use rayon::prelude::*;

/// The picture of that size whose rows `fill` makes, each from its number. A row starts as zeros.
pub(super) fn by_rows(
    (width, height): (usize, usize),
    cx: &Context<'_>,
    fill: impl Fn(usize, &mut [f32]) + Sync,
) -> Result<GrayImage, NodeError> {
    let ticker = cx.ticker(height);
    let mut values = vec![0.0; width * height];
    let done = values.par_chunks_exact_mut(width).enumerate().try_for_each(|(y, row)| {
        fill(y, row);
        ticker.tick(1).then_some(())
    });
    cx.completed(done)?;
    Ok(GrayImage { width, height, values })
}

/// The picture with `change` done to every pixel.
pub(super) fn by_pixels(
    image: &GrayImage,
    cx: &Context<'_>,
    change: impl Fn(f32) -> f32 + Sync,
) -> Result<GrayImage, NodeError> {
    by_rows((image.width, image.height), cx, |y, row| {
        let source = &image.values[y * image.width..];
        row.iter_mut().zip(source).for_each(|(value, source)| *value = change(*source));
    })
}

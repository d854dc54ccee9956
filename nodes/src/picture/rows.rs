//! Pictures made row by row, in parallel, in a way that can be called off; and what is done to whole
//! rows at once, in forms that compilers turn into vector instructions.

use crate::values::GrayImage;
use carvegraph_core::{Context, NodeError};
use rayon::prelude::*;

/// Pixels that are worked on at once. They fill half of the vector registers of any machine.
pub(super) const LANES: usize = 32;

/// The picture of that size whose rows `fill` makes, each from its number. A row starts as zeros.
pub(super) fn by_rows(
    size: (usize, usize),
    cx: &Context<'_>,
    fill: impl Fn(usize, &mut [f32]) + Sync,
) -> Result<GrayImage, NodeError> {
    by_bands(size, 1, cx, fill)
}

/// The picture of that size whose bands of `rows` rows `fill` makes, each from the number of its
/// first row; the last band may be lower. A band starts as zeros.
pub(super) fn by_bands(
    (width, height): (usize, usize),
    rows: usize,
    cx: &Context<'_>,
    fill: impl Fn(usize, &mut [f32]) + Sync,
) -> Result<GrayImage, NodeError> {
    let ticker = cx.ticker(height);
    let mut values = vec![0.0; width * height];
    let bands = values.par_chunks_mut(rows * width).enumerate();
    let done = bands.try_for_each(|(k, band)| {
        fill(k * rows, band);
        ticker.tick(band.len() / width).then_some(())
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

/// The darkest and the brightest gray of a picture.
pub(super) fn range(image: &GrayImage) -> (f32, f32) {
    let of_row = |row: &[f32]| {
        let (blocks, rest) = row.as_chunks::<LANES>();
        let (mut dark, mut bright) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
        for block in blocks {
            for (k, value) in block.iter().enumerate() {
                dark[k] = darker(dark[k], *value);
                bright[k] = brighter(bright[k], *value);
            }
        }
        let dark = rest.iter().chain(&dark).copied().fold(f32::INFINITY, darker);
        (dark, rest.iter().chain(&bright).copied().fold(f32::NEG_INFINITY, brighter))
    };
    let wider = |a: (f32, f32), b: (f32, f32)| (darker(a.0, b.0), brighter(a.1, b.1));
    let rows = image.values.par_chunks(image.width);
    rows.map(of_row).reduce(|| (f32::INFINITY, f32::NEG_INFINITY), wider)
}

/// The lesser of two numbers. A single instruction, unlike `f32::min`, which minds what is no number.
pub(super) fn darker(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two numbers.
pub(super) fn brighter(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Sets `out` to the sum of `lines`, each times its weight. Lines may be longer than `out`.
pub(super) fn weighted_sum(lines: &[&[f32]], weights: &[f32], out: &mut [f32]) {
    let (blocks, rest) = out.as_chunks_mut::<LANES>();
    let done = blocks.len() * LANES;
    for (block, sums) in blocks.iter_mut().enumerate() {
        *sums = [0.0; LANES];
        for (line, weight) in lines.iter().zip(weights) {
            let line = &line[block * LANES..][..LANES];
            sums.iter_mut().zip(line).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    for (k, sum) in rest.iter_mut().enumerate() {
        *sum = lines.iter().zip(weights).fold(0.0, |sum, (l, weight)| sum + weight * l[done + k]);
    }
}

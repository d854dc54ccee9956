//! Heights of a field, sampled at the pixels of a picture.
//!
//! Each axis is treated on its own: a pixel is a weighted sum of nodes along x of weighted sums of
//! nodes along y. Where there are fewer nodes than pixels, the weights are those of a bicubic
//! spline (D. P. Mitchell, A. N. Netravali, "Reconstruction Filters in Computer Graphics",
//! SIGGRAPH 1988, eq. 8, with B = C = 1/3), so slopes are continuous and no facets show. Where there
//! are more, a pixel is the mean of the nodes it covers, a node at its edge counting by the share
//! that is covered.
//!
//! Limits: the spline smooths a little (a single raised node keeps 8/9 of its height each way) and
//! may overshoot a step by about 4 % of it. This is a picture, not a surface to be cut.

use carvegraph_geometry::{HeightField, Tick};
use rayon::prelude::*;
use std::ops::Range;

/// Work units, and parallel parts, of [`resample`] and of every other step that goes row by row:
/// enough to keep many threads busy and to notice a cancellation within a few milliseconds.
pub(super) const BANDS: usize = 32;

/// A grid of values, one a pixel, row 0 on top.
pub(super) struct Raster {
    /// Pixels along x.
    pub(super) width: usize,
    /// Pixels along y.
    pub(super) height: usize,
    /// Row by row from the top, x fastest.
    pub(super) values: Vec<f32>,
}

impl Raster {
    /// The value of a pixel.
    pub(super) fn at(&self, x: usize, y: usize) -> f32 {
        self.values[y * self.width + x]
    }

    /// The value between pixels, linear each way; beyond the outermost pixels, theirs.
    pub(super) fn between(&self, x: f32, y: f32) -> f32 {
        let (x, y) =
            (x.clamp(0.0, (self.width - 1) as f32), y.clamp(0.0, (self.height - 1) as f32));
        let (x0, y0) = (x as usize, y as usize);
        let (x1, y1) = ((x0 + 1).min(self.width - 1), (y0 + 1).min(self.height - 1));
        let (tx, ty) = (x - x0 as f32, y - y0 as f32);
        let upper = self.at(x0, y0) + (self.at(x1, y0) - self.at(x0, y0)) * tx;
        let lower = self.at(x0, y1) + (self.at(x1, y1) - self.at(x0, y1)) * tx;
        upper + (lower - upper) * ty
    }

    /// The unit normal at a pixel of a relief in pixels: right, up the picture and towards the eye.
    /// Slopes are taken over three by three pixels (Sobel's weights), so single pixels don't glitter.
    pub(super) fn normal(&self, x: usize, y: usize) -> [f32; 3] {
        let (x0, x1) = (x.saturating_sub(1), (x + 1).min(self.width - 1));
        let (y0, y1) = (y.saturating_sub(1), (y + 1).min(self.height - 1));
        let column = |x: usize| self.at(x, y0) + 2.0 * self.at(x, y) + self.at(x, y1);
        let row = |y: usize| self.at(x0, y) + 2.0 * self.at(x, y) + self.at(x1, y);
        let slope_x = (column(x1) - column(x0)) / 8.0;
        let slope_up = (row(y0) - row(y1)) / 8.0;
        let length = (slope_x * slope_x + slope_up * slope_up + 1.0).sqrt();
        [-slope_x / length, -slope_up / length, 1.0 / length]
    }

    /// Means of two by two pixels, with heights in pixels of the new size.
    pub(super) fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut values = vec![0.0; width * height];
        values.par_chunks_exact_mut(width).enumerate().for_each(|(y, row)| {
            let (y0, y1) = (2 * y, (2 * y + 1).min(self.height - 1));
            for (x, value) in row.iter_mut().enumerate() {
                let (x0, x1) = (2 * x, (2 * x + 1).min(self.width - 1));
                *value =
                    (self.at(x0, y0) + self.at(x1, y0) + self.at(x0, y1) + self.at(x1, y1)) / 8.0;
            }
        });
        Self { width, height, values }
    }
}

/// Where the nodes of one axis stand among the pixels of a picture.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    /// Pixels that the nodes span, from the first node to the last.
    pub(super) span_px: usize,
    /// Pixels added before and after, which repeat the outermost node.
    pub(super) border_px: usize,
}

impl Axis {
    /// Pixels in all.
    pub(super) fn len_px(self) -> usize {
        self.span_px + 2 * self.border_px
    }
}

/// The heights of `field` above its lowest at the pixels of `x` by `y`, multiplied by `scale`. Takes
/// [`BANDS`] units of work; `None` if stopped.
pub(super) fn resample(
    field: &HeightField,
    x: Axis,
    y: Axis,
    scale: f32,
    tick: Tick<'_>,
) -> Option<Raster> {
    let (width, height) = (x.len_px(), y.len_px());
    let across = Taps::new(field.columns(), x);
    let along = Taps::new(field.rows(), y);
    let z_min = field.bounds().min.z as f32;
    let mut values = vec![0.0; width * height];
    bands(&mut values, width, height).into_par_iter().try_for_each(|(rows, band)| {
        let mut line = vec![0.0; field.columns()];
        for (row, pixels) in rows.zip(band.chunks_exact_mut(width)) {
            // Row 0 of the picture is the far edge, the last row of the field.
            let (first, weights) = along.of(height - 1 - row);
            line.fill(0.0);
            for (j, weight) in weights.iter().enumerate() {
                add_row(field.row(first + j), z_min, weight * scale, &mut line);
            }
            across.apply(&line, pixels);
        }
        tick(1).then_some(())
    })?;
    Some(Raster { width, height, values })
}

/// Cuts a raster of `height` rows into exactly [`BANDS`] runs of whole rows; some may be empty.
pub(super) fn bands<T>(
    mut values: &mut [T],
    width: usize,
    height: usize,
) -> Vec<(Range<usize>, &mut [T])> {
    let mut parts = Vec::with_capacity(BANDS);
    for band in 0..BANDS {
        let rows = height * band / BANDS..height * (band + 1) / BANDS;
        let (part, rest) = values.split_at_mut(rows.len() * width);
        parts.push((rows, part));
        values = rest;
    }
    parts
}

/// Adds `factor` times the heights above `z_min` to `line`.
fn add_row(heights: &[f32], z_min: f32, factor: f32, line: &mut [f32]) {
    for (sum, z) in line.iter_mut().zip(heights) {
        *sum += factor * (z - z_min);
    }
}

/// For each pixel along an axis, the first node that counts and the weights from there on.
struct Taps {
    first: Vec<usize>,
    ends: Vec<usize>,
    weights: Vec<f32>,
}

impl Taps {
    fn new(nodes: usize, axis: Axis) -> Self {
        let len = axis.len_px();
        let mut taps = Self { first: Vec::with_capacity(len), ends: vec![0], weights: Vec::new() };
        let nodes_per_px = (nodes - 1) as f64 / axis.span_px as f64;
        for pixel in 0..len {
            let place = (pixel as f64 + 0.5 - axis.border_px as f64) * nodes_per_px;
            let place = place.clamp(0.0, (nodes - 1) as f64);
            if nodes_per_px <= 1.0 {
                taps.push_cubic(place, nodes);
            } else {
                taps.push_mean(place, nodes_per_px, nodes);
            }
            taps.ends.push(taps.weights.len());
        }
        taps
    }

    fn of(&self, pixel: usize) -> (usize, &[f32]) {
        (self.first[pixel], &self.weights[self.ends[pixel]..self.ends[pixel + 1]])
    }

    fn apply(&self, line: &[f32], pixels: &mut [f32]) {
        for (pixel, value) in pixels.iter_mut().enumerate() {
            let (first, weights) = self.of(pixel);
            *value = dot(&line[first..][..weights.len()], weights);
        }
    }

    /// Four weights of the spline; beyond the ends the outermost node is repeated.
    fn push_cubic(&mut self, place: f64, nodes: usize) {
        let base = place.floor() as isize;
        let inside = |i: isize| i.clamp(0, nodes as isize - 1) as usize;
        let first = inside(base - 1);
        let start = self.weights.len();
        self.first.push(first);
        self.weights.resize(start + inside(base + 2) - first + 1, 0.0);
        for i in base - 1..=base + 2 {
            self.weights[start + inside(i) - first] += mitchell((place - i as f64).abs()) as f32;
        }
    }

    /// Weights of the mean over `width` nodes about `place`; node i owns i - 1/2 to i + 1/2.
    fn push_mean(&mut self, place: f64, width: f64, nodes: usize) {
        let low = (place - width / 2.0).max(-0.5);
        let high = (place + width / 2.0).min(nodes as f64 - 0.5);
        let first = (low + 0.5).floor() as usize;
        let last = ((high + 0.5).ceil() as usize).clamp(first + 1, nodes) - 1;
        self.first.push(first);
        for i in first..=last {
            let covered = (i as f64 + 0.5).min(high) - (i as f64 - 0.5).max(low);
            self.weights.push((covered.max(0.0) / (high - low)) as f32);
        }
    }
}

/// Σ a·b in four interleaved sums, which the compiler can keep in one register.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0.0; 4];
    let (a4, a_rest) = a.as_chunks::<4>();
    let (b4, b_rest) = b.as_chunks::<4>();
    for (a, b) in a4.iter().zip(b4) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f32 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// Mitchell and Netravali's spline (eq. 8) at distance `d` ≥ 0, for B = C = 1/3.
fn mitchell(d: f64) -> f64 {
    if d < 1.0 {
        (7.0 * d * d * d - 12.0 * d * d + 16.0 / 3.0) / 6.0
    } else if d < 2.0 {
        (-7.0 / 3.0 * d * d * d + 12.0 * d * d - 20.0 * d + 32.0 / 3.0) / 6.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(field: &HeightField, width: usize, height: usize) -> Raster {
        let axis = |span_px| Axis { span_px, border_px: 0 };
        resample(field, axis(width), axis(height), 1.0, &|_| true).unwrap()
    }

    /// A plane that rises by 1 along x and by 2 along y for each node.
    fn plane(columns: usize, rows: usize) -> HeightField {
        let heights = (0..columns * rows).map(|k| (k % columns + 2 * (k / columns)) as f32);
        HeightField::new(columns, rows, 1.0, heights.collect()).unwrap()
    }

    #[test]
    fn a_plane_stays_a_plane_when_enlarged_and_when_reduced() {
        for (columns, rows, width, height) in [(20, 10, 76, 36), (101, 61, 25, 15)] {
            let raster = picture(&plane(columns, rows), width, height);
            let (nx, ny) = ((columns - 1) as f32 / width as f32, (rows - 1) as f32 / height as f32);
            // The outermost nodes are repeated, so the margin bends.
            for (x, y) in (8..width - 8).flat_map(|x| (6..height - 6).map(move |y| (x, y))) {
                let up = (height - 1 - y) as f32;
                let expected = (x as f32 + 0.5) * nx + 2.0 * (up + 0.5) * ny;
                assert!((raster.at(x, y) - expected).abs() < 1e-3, "{x} {y}");
            }
        }
    }

    #[test]
    fn row_0_of_the_field_is_the_bottom_of_the_picture() {
        let raster = picture(&plane(4, 4), 12, 12);
        assert!(raster.at(6, 11) < raster.at(6, 0));
    }

    #[test]
    fn weights_add_to_one() {
        for (nodes, span_px, border_px) in
            [(2, 9, 3), (5000, 7, 0), (5000, 1, 1), (640, 639, 4), (3, 2, 0)]
        {
            let axis = Axis { span_px, border_px };
            let taps = Taps::new(nodes, axis);
            for pixel in 0..axis.len_px() {
                let (first, weights) = taps.of(pixel);
                assert!(first + weights.len() <= nodes);
                assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-4, "{nodes} {pixel}");
            }
        }
    }
}

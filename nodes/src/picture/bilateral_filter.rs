//! Smoothing that keeps edges.
//!
//! J. Chen, S. Paris, F. Durand, *Real-time Edge-Aware Image Processing with the Bilateral Grid*,
//! SIGGRAPH 2007: pixels are counted into a coarse grid over place and brightness, the grid is blurred
//! along its three axes by 1 4 6 4 1, and each pixel takes from it the mean that it finds at its place
//! and brightness, interpolated between cells. The cell's side is what the kernel's standard deviation
//! is measured by, so the work does not depend on it. It is an approximation of the bilateral filter:
//! the Gaussians are those of the small kernel (σ = 1 cell), widened by the counting and the lookup to
//! √1.25 cells, which is why cells are σ / √1.25. Where a smooth part meets a step it is off by up to 4 % of
//! the picture's range.

use super::rows::{by_rows, range, weighted_sum};
use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;

/// σ in cells: variances of 1 of the kernel, 1/12 of the counting and 1/6 of the lookup add up to 5/4.
const SIGMA_CELLS: f64 = 1.118_033_988_749_895;
/// Cells beyond what pixels reach, so that the kernel never leaves the grid.
const MARGIN: usize = 2;
/// A grid of more cells than this (8 bytes each, twice) is refused.
const MAX_CELLS: usize = 100_000_000;
const KERNEL: [f32; 5] = [0.0625, 0.25, 0.375, 0.25, 0.0625];

/// Smooths surfaces and leaves the steps between them.
#[derive(Clone, Debug, Params)]
pub(crate) struct BilateralFilter {
    /// How far it smooths (standard deviation).
    #[param(unit = "px", default = 8.0, range = 3.0..=1000.0)]
    pub(crate) reach: f64,
    /// Steps much larger than this stay (standard deviation), as a share of the picture's range; 1
    /// and more smooths them too.
    #[param(unit = "%", default = 0.1, range = 0.01..=1.0)]
    pub(crate) step: f64,
}

#[derive(Inputs)]
pub(crate) struct Rough<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Smooth {
    /// The smoothed picture.
    image: GrayImage,
}

/// The sum of what was counted into a cell, and how many.
type Cell = [f32; 2];

impl Node for BilateralFilter {
    const KIND: &'static str = "bilateral_filter";
    const VERSION: u32 = 2;
    type Inputs<'a> = Rough<'a>;
    type Outputs = Smooth;

    fn run(&self, inputs: Rough<'_>, cx: &Context<'_>) -> Result<Smooth, NodeError> {
        let image = inputs.image;
        let (dark, bright) = range(image);
        if dark == bright {
            return Ok(Smooth { image: image.clone() });
        }
        let frame = Frame::new(image, self, dark, bright)?;
        let counted = frame.count(image, dark);
        if cx.is_cancelled() {
            return Err(NodeError::Cancelled);
        }
        let cells = frame.blur(counted);
        let across: Vec<Place> = (0..image.width).map(|x| Place::of(frame.place(x))).collect();
        let image = by_rows((image.width, image.height), cx, |y, row| {
            let down = Place::of(frame.place(y));
            let source = &image.values[y * image.width..];
            for ((value, source), across) in row.iter_mut().zip(source).zip(&across) {
                // Less the darkest gray, for the sake of the last digits.
                let gray = Place::of(frame.layer(source - dark));
                *value = frame.look_up(&cells, [&down, across, &gray]) + dark;
            }
        })?;
        Ok(Smooth { image })
    }
}

/// A place between two cells along an axis: the first of them, and how far it lies after that.
struct Place {
    first: usize,
    share: f32,
}

impl Place {
    fn of(place: f32) -> Self {
        let first = place as u32;
        Self { first: first as usize, share: place - first as f32 }
    }
}

/// How pixels lie in the grid: row by row, in each place by place, in each gray by gray.
struct Frame {
    columns: usize,
    rows: usize,
    layers: usize,
    side_px: f32,
    side_gray: f32,
}

impl Frame {
    fn new(
        image: &GrayImage,
        node: &BilateralFilter,
        dark: f32,
        bright: f32,
    ) -> Result<Self, NodeError> {
        let range = f64::from(bright) - f64::from(dark);
        let (side_px, side_gray) = (node.reach / SIGMA_CELLS, node.step * range / SIGMA_CELLS);
        let cells = |length: f64| length.ceil() as usize + 2 * MARGIN + 1;
        let columns = cells(image.width as f64 / side_px);
        let rows = cells(image.height as f64 / side_px);
        let layers = cells(range / side_gray);
        let count = columns * rows * layers;
        if count > MAX_CELLS {
            let message = format!(
                "reach {} px and step {} need a grid of {count} cells; the limit is {MAX_CELLS}: \
                 make either larger",
                node.reach, node.step
            );
            return Err(NodeError::Refused { param: "reach", message });
        }
        Ok(Self { columns, rows, layers, side_px: side_px as f32, side_gray: side_gray as f32 })
    }

    /// The place of a pixel along one side of the grid.
    fn place(&self, pixel: usize) -> f32 {
        pixel as f32 / self.side_px + MARGIN as f32
    }

    fn layer(&self, above_dark: f32) -> f32 {
        above_dark / self.side_gray + MARGIN as f32
    }

    /// Every pixel counted into the cell nearest to it.
    fn count(&self, image: &GrayImage, dark: f32) -> Vec<Cell> {
        let row_cells = self.columns * self.layers;
        let nearest = |place: f32| (place + 0.5) as u32 as usize;
        // The pixel rows whose nearest cells are a row of the grid follow each other.
        let grid_rows: Vec<usize> = (0..image.height).map(|y| nearest(self.place(y))).collect();
        let first = |row: usize| grid_rows.partition_point(|grid_row| *grid_row < row);
        let starts: Vec<usize> = (0..=self.rows).map(first).collect();
        let columns: Vec<usize> =
            (0..image.width).map(|x| nearest(self.place(x)) * self.layers).collect();
        let mut cells = vec![[0.0; 2]; self.rows * row_cells];
        cells.par_chunks_exact_mut(row_cells).enumerate().for_each(|(row, cells)| {
            for y in starts[row]..starts[row + 1] {
                let line = &image.values[y * image.width..];
                for (value, column) in line.iter().zip(&columns) {
                    let gray = value - dark;
                    let cell = &mut cells[column + nearest(self.layer(gray))];
                    cell[0] += gray;
                    cell[1] += 1.0;
                }
            }
        });
        cells
    }

    /// The grid blurred along all of its axes.
    fn blur(&self, mut cells: Vec<Cell>) -> Vec<Cell> {
        let row_cells = self.columns * self.layers;
        cells.par_chunks_exact_mut(row_cells).for_each(|row| {
            // The first and last cells of each line hold nothing, so that nothing of a line comes into
            // the next one.
            for stride in [1, self.layers] {
                let margin = vec![0.0; 2 * MARGIN * stride];
                let padded = [&margin, row.as_flattened(), &margin].concat();
                let lines: Vec<&[f32]> =
                    (0..KERNEL.len()).map(|k| &padded[2 * k * stride..]).collect();
                weighted_sum(&lines, &KERNEL, row.as_flattened_mut());
            }
        });
        let mut blurred = vec![[0.0; 2]; cells.len()];
        blurred.par_chunks_exact_mut(row_cells).enumerate().for_each(|(row, out)| {
            let rows = row.saturating_sub(MARGIN)..self.rows.min(row + MARGIN + 1);
            let lines: Vec<&[f32]> =
                rows.clone().map(|from| cells[from * row_cells..].as_flattened()).collect();
            let weights: Vec<f32> = rows.map(|from| KERNEL[from + MARGIN - row]).collect();
            weighted_sum(&lines, &weights, out.as_flattened_mut());
        });
        blurred
    }

    /// The mean at a pixel's place and gray, from the eight cells around it.
    fn look_up(&self, cells: &[Cell], [down, across, gray]: [&Place; 3]) -> f32 {
        let at = (down.first * self.columns + across.first) * self.layers + gray.first;
        let mut sums = [0.0; 4];
        for (row, weight) in [(0, 1.0 - down.share), (self.columns, down.share)] {
            for (column, weight) in [(0, weight * (1.0 - across.share)), (1, weight * across.share)]
            {
                let two = cells[at + (row + column) * self.layers..][..2].as_flattened();
                sums.iter_mut().zip(two).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        let [sum, count] = [0, 1].map(|k| sums[k] + gray.share * (sums[k + 2] - sums[k]));
        // The pixel itself was counted within half a cell of its place, so the count is not 0.
        sum / count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn smooth(reach: f64, step: f64, image: &GrayImage) -> Vec<f32> {
        let node = BilateralFilter { reach, step };
        run(|cx| node.run(Rough { image }, cx)).unwrap().image.values
    }

    #[test]
    fn noise_goes_and_a_step_stays() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut noisy = |k: usize| {
            let level: f32 = if k % 80 < 40 { 0.2 } else { 0.8 };
            level + 0.04 * (random.f32() - 0.5)
        };
        let values: Vec<f32> = (0..80 * 60).map(&mut noisy).collect();
        let smoothed = smooth(6.0, 0.15, &GrayImage { width: 80, height: 60, values });
        for (k, value) in smoothed.iter().enumerate() {
            let level = if k % 80 < 40 { 0.2 } else { 0.8 };
            assert!((value - level).abs() < 0.008, "{k}: {value}");
        }
    }

    #[test]
    fn it_is_near_the_bilateral_filter_itself() {
        let (width, height, reach, step) = (48, 40, 4.0, 0.2);
        let at = |x: usize, y: usize| {
            0.5 + 0.25 * (0.2 * x as f64).sin() + if x + y > 44 { 0.25 } else { 0.0 }
        };
        let values: Vec<f32> =
            (0..width * height).map(|k| at(k % width, k / width) as f32).collect();
        let bright = values.iter().copied().fold(0.0, f32::max);
        let dark = values.iter().copied().fold(1.0, f32::min);
        let sigma = step * f64::from(bright - dark);
        let found = smooth(reach, step, &GrayImage { width, height, values: values.clone() });
        let mut worst: f64 = 0.0;
        for y in 12..height - 12 {
            for x in 12..width - 12 {
                let middle = f64::from(values[y * width + x]);
                let (mut sum, mut weights) = (0.0, 0.0);
                for v in 0..height {
                    for u in 0..width {
                        let value = f64::from(values[v * width + u]);
                        let far =
                            (u.abs_diff(x).pow(2) + v.abs_diff(y).pow(2)) as f64 / reach.powi(2);
                        let off = ((value - middle) / sigma).powi(2);
                        let weight = (-(far + off) / 2.0).exp();
                        sum += weight * value;
                        weights += weight;
                    }
                }
                worst = worst.max((f64::from(found[y * width + x]) - sum / weights).abs());
            }
        }
        assert!(worst < 0.04 * f64::from(bright - dark), "{worst}");
    }

    #[test]
    fn even_gray_and_small_pictures_pass() {
        let even = GrayImage { width: 5, height: 3, values: vec![0.3; 15] };
        assert_eq!(smooth(8.0, 0.1, &even), even.values);
        let line = GrayImage { width: 1, height: 4, values: vec![0.0, 0.0, 1.0, 1.0] };
        let smoothed = smooth(3.0, 0.1, &line);
        assert!(smoothed.iter().zip(&line.values).all(|(a, b)| (a - b).abs() < 0.01));
    }

    #[test]
    fn a_grid_beyond_reason_is_refused() {
        let image = GrayImage {
            width: 4000,
            height: 4000,
            values: (0..16_000_000).map(|k| k as f32).collect(),
        };
        let node = BilateralFilter { reach: 3.0, step: 0.01 };
        let message = run(|cx| node.run(Rough { image: &image }, cx)).err().unwrap().to_string();
        assert!(message.contains("the limit is 100000000"), "{message}");
    }
}

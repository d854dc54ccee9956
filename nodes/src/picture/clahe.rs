//! Local contrast: contrast-limited adaptive histogram equalisation.
//!
//! K. Zuiderveld, *Contrast Limited Adaptive Histogram Equalization*, Graphics Gems IV, 1994, with
//! what OpenCV's `createCLAHE` documents and does: the picture is divided into tiles (first mirrored
//! beyond its right and lower border to a multiple of them); of each, a histogram of 256 levels is
//! cut off at `clip_limit` times its mean count, at one at least, and what is cut off is spread over
//! all levels, the remainder over evenly spaced ones; the sums of it are a curve from level to level;
//! each pixel takes the curves of the four nearest tiles, weighted by nearness.
//!
//! Unlike OpenCV's, curves are interpolated between levels and nothing is rounded: a picture of 16
//! bits keeps its levels, and one of 8 bits gets what OpenCV gives before it rounds. Where one side only
//! is a multiple of the tiles, OpenCV makes tiles a pixel longer along that one too; these are not. Gray
//! outside of 0 … 1 is held to it, with a warning.

use super::gaussian_blur::reflect;
use super::rows::by_rows;
use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;
use std::array::from_fn;

/// Levels of a histogram.
const LEVELS: usize = 256;

/// Brings out detail in dark and bright parts alike, tile by tile.
#[derive(Clone, Debug, Params)]
pub(crate) struct Clahe {
    /// How steep a tile's curve may get, in times the mean count of a level; more is more contrast.
    #[param(unit = "%", default = 2.0, range = 1.0..=256.0)]
    pub(crate) clip_limit: f64,
    /// Tiles along each side; 0 leaves the picture as it is.
    #[param(default = 8, range = 0..=64)]
    pub(crate) tiles: u32,
}

#[derive(Inputs)]
pub(crate) struct Dull<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Vivid {
    /// The picture with its contrast brought out, 0 to 1.
    image: GrayImage,
}

impl Node for Clahe {
    const KIND: &'static str = "clahe";
    const VERSION: u32 = 2;
    type Inputs<'a> = Dull<'a>;
    type Outputs = Vivid;

    fn run(&self, inputs: Dull<'_>, cx: &Context<'_>) -> Result<Vivid, NodeError> {
        let image = inputs.image;
        if self.tiles == 0 {
            return Ok(Vivid { image: image.clone() });
        }
        if image.values.par_iter().any(|value| !(0.0..=1.0).contains(value)) {
            cx.warn("gray beyond black and white is held to them: bring it between them by levels");
        }
        let tiles = self.tiles as usize;
        let tile = (image.width.div_ceil(tiles), image.height.div_ceil(tiles));
        let curves: Vec<Curve> = (0..tiles * tiles)
            .into_par_iter()
            .map(|k| self.curve(image, (k % tiles * tile.0, k / tiles * tile.1), tile))
            .collect();
        let across: Vec<Between> =
            (0..image.width).map(|x| Between::tiles(x, tile.0, tiles)).collect();
        let image = by_rows((image.width, image.height), cx, |y, row| {
            let down = Between::tiles(y, tile.1, tiles);
            let [above, below] = [down.first, down.second].map(|k| &curves[k * tiles..][..tiles]);
            let mixed: Vec<Curve> =
                above.iter().zip(below).map(|(above, below)| down.curve(above, below)).collect();
            let source = &image.values[y * image.width..];
            for ((value, source), across) in row.iter_mut().zip(source).zip(&across) {
                let place = Place::of(*source);
                let [first, second] = [across.first, across.second].map(|k| mixed[k].at(&place));
                *value = across.mix(first, second);
            }
        })?;
        Ok(Vivid { image })
    }
}

impl Clahe {
    /// That of the tile whose first pixel is at `left`, `top`.
    fn curve(&self, image: &GrayImage, (left, top): (usize, usize), tile: (usize, usize)) -> Curve {
        let mut counts = [0u32; LEVELS];
        let columns: Vec<usize> =
            (left..left + tile.0).map(|x| reflect(x, 0, image.width)).collect();
        for y in top..top + tile.1 {
            let row = &image.values[reflect(y, 0, image.height) * image.width..];
            for x in &columns {
                let level = row[*x].clamp(0.0, 1.0) * (LEVELS - 1) as f32;
                counts[(level + 0.5) as usize] += 1;
            }
        }
        let area = (tile.0 * tile.1) as f64;
        let limit = ((self.clip_limit * area / LEVELS as f64) as u32).max(1);
        clip(&mut counts, limit);
        let mut sum = 0;
        Curve(counts.map(|count| {
            sum += count;
            (f64::from(sum) / area) as f32
        }))
    }
}

/// Cuts counts off at `limit` and spreads what is cut off.
fn clip(counts: &mut [u32; LEVELS], limit: u32) {
    let cut: u32 = counts.iter().map(|count| count.saturating_sub(limit)).sum();
    let share = cut / LEVELS as u32;
    let rest = cut as usize % LEVELS;
    counts.iter_mut().for_each(|count| *count = (*count).min(limit) + share);
    let step = (LEVELS / rest.max(1)).max(1);
    counts.iter_mut().step_by(step).take(rest).for_each(|count| *count += 1);
}

/// The gray that each level becomes.
struct Curve([f32; LEVELS]);

impl Curve {
    fn at(&self, place: &Place) -> f32 {
        let [below, above] = [0, 1].map(|k| self.0[place.below + k]);
        below + place.share * (above - below)
    }
}

/// The level below a gray that is not the last, and how far after it the gray lies.
struct Place {
    below: usize,
    share: f32,
}

impl Place {
    fn of(value: f32) -> Self {
        let level = value.clamp(0.0, 1.0) * (LEVELS - 1) as f32;
        let below = (level as usize).min(LEVELS - 2);
        Self { below, share: level - below as f32 }
    }
}

/// Two neighbouring tiles, and how near a pixel is to the second of them.
struct Between {
    first: usize,
    second: usize,
    share: f32,
}

impl Between {
    fn tiles(pixel: usize, tile: usize, tiles: usize) -> Self {
        // As OpenCV, from the pixel's upper left corner.
        let place = pixel as f64 / tile as f64 - 0.5;
        let below = place.floor();
        let hold = |tile: f64| tile.clamp(0.0, (tiles - 1) as f64) as usize;
        Self { first: hold(below), second: hold(below + 1.0), share: (place - below) as f32 }
    }

    fn mix(&self, first: f32, second: f32) -> f32 {
        first + self.share * (second - first)
    }

    fn curve(&self, first: &Curve, second: &Curve) -> Curve {
        Curve(from_fn(|level| self.mix(first.0[level], second.0[level])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn clahe(clip_limit: f64, tiles: u32, width: usize, values: &[f32]) -> Vec<f32> {
        let image = GrayImage { width, height: values.len() / width, values: values.to_vec() };
        run(|cx| Clahe { clip_limit, tiles }.run(Dull { image: &image }, cx)).unwrap().image.values
    }

    #[test]
    fn one_tile_without_limit_is_equalisation() {
        // Of four levels, a quarter, a half, three quarters and all of the pixels are no brighter.
        let levels = [10.0, 20.0, 30.0, 250.0].map(|level| level / 255.0);
        let values: Vec<f32> = (0..64).map(|k| levels[k % 4]).collect();
        let out = clahe(256.0, 1, 8, &values);
        for (k, value) in out.iter().enumerate() {
            assert!((value - [0.25, 0.5, 0.75, 1.0][k % 4]).abs() < 1e-6);
        }
    }

    #[test]
    fn what_is_cut_off_is_spread_as_opencv_does() {
        let mut counts = [0; LEVELS];
        (counts[0], counts[100]) = (300, 10);
        clip(&mut counts, 40);
        // 260 are cut off: one for each level, and four more, 64 levels apart.
        assert_eq!((counts[0], counts[100], counts[1]), (40 + 1 + 1, 11, 1));
        assert_eq!([64, 128, 192, 255].map(|level| counts[level]), [2, 2, 2, 1]);
        assert_eq!(counts.iter().sum::<u32>(), 310);
    }

    #[test]
    fn pictures_of_8_bits_become_those_of_opencv() {
        // Rows of cv2.createCLAHE(clip_limit, (tiles, tiles)) of OpenCV 5.0.0, which rounds the curves and
        // the result to whole levels: 1 level in all.
        type Row = (usize, &'static [u8]);
        let cases: [(usize, usize, f64, u32, &[Row]); 3] = [
            (
                21,
                17,
                3.0,
                4,
                &[
                    (
                        0,
                        &[
                            17, 34, 51, 68, 65, 65, 56, 49, 52, 60, 65, 59, 56, 49, 44, 51, 61, 68,
                            64, 71, 72,
                        ],
                    ),
                    (
                        8,
                        &[
                            39, 90, 116, 151, 196, 206, 223, 64, 110, 126, 155, 184, 199, 224, 70,
                            122, 133, 149, 188, 201, 210,
                        ],
                    ),
                    (
                        16,
                        &[
                            60, 118, 175, 222, 110, 161, 201, 86, 139, 180, 223, 116, 162, 206, 93,
                            144, 188, 220, 121, 170, 203,
                        ],
                    ),
                ],
            ),
            (
                24,
                18,
                2.0,
                2,
                &[
                    (
                        0,
                        &[
                            5, 9, 14, 21, 26, 33, 40, 44, 45, 47, 50, 50, 51, 50, 50, 49, 50, 48,
                            52, 57, 66, 71, 78, 85,
                        ],
                    ),
                    (
                        9,
                        &[
                            26, 68, 118, 164, 68, 118, 164, 64, 107, 147, 183, 89, 130, 170, 72,
                            113, 156, 192, 96, 148, 190, 96, 148, 190,
                        ],
                    ),
                ],
            ),
            (
                15,
                1,
                4.0,
                2,
                &[(0, &[32, 64, 96, 128, 159, 171, 175, 171, 160, 156, 160, 171, 191, 223, 255])],
            ),
        ];
        for (width, height, clip_limit, tiles, rows) in cases {
            let level = |x: usize, y: usize| (3 * x + 2 * y + x * y % 7 * 9) % 256;
            let values: Vec<f32> =
                (0..width * height).map(|k| level(k % width, k / width) as f32 / 255.0).collect();
            let out = clahe(clip_limit, tiles, width, &values);
            for (y, wanted) in rows {
                let found = &out[y * width..][..width];
                let off = |(found, wanted): (&f32, &u8)| (255.0 * found - f32::from(*wanted)).abs();
                let most = found.iter().zip(*wanted).map(off).fold(0.0, f32::max);
                assert!(most <= 1.0, "{width} × {height}, row {y}: {most} levels");
            }
        }
    }

    #[test]
    fn the_lowest_limit_leaves_an_even_picture_nearly_as_it_is() {
        // 256 × 256 px of every level alike: the curve is that of an even spread.
        let values: Vec<f32> = (0..65536).map(|k| (k % 256) as f32 / 255.0).collect();
        let out = clahe(1.0, 1, 256, &values);
        let near = out.iter().zip(&values).all(|(a, b)| (a - b).abs() < 1.5 / 255.0);
        assert!(near);
    }

    #[test]
    fn sixteen_bits_stay_apart_and_sizes_need_not_divide() {
        let values: Vec<f32> = (0..1001 * 3).map(|k| (k % 1001) as f32 / 1000.0).collect();
        let out = clahe(4.0, 1, 1001, &values);
        assert!(out[..1001].windows(2).all(|pair| pair[1] > pair[0]));
        for (width, height) in [(1, 1), (1, 13), (13, 1), (9, 11)] {
            let out = clahe(2.0, 8, width, &vec![0.5; width * height]);
            assert!(out.iter().all(|value| (0.0..=1.0).contains(value)), "{width} × {height}");
        }
        assert_eq!(clahe(2.0, 0, 2, &[0.1, 7.0]), [0.1, 7.0]);
    }
}

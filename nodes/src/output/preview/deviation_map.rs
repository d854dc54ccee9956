//! A map of deviations: what lies above the target in orange, what lies below in purple, white where it is
//! as it should be, gray where nothing counts.
//!
//! Orange and purple are told apart by people of all kinds of colour vision and, being dark at their ends, on
//! paper (C. Brewer's scale PuOr, colorbrewer2.org). A pixel shows the node of its own that is off most, so
//! that a single dimple is not lost in a small picture.

use super::color::{Linear, encode, linear, mix};
use super::legend::{self, Entry};
use super::strokes::{Band, Ink, Place};
use carvegraph_geometry::Deviation;
use image::{Rgb, RgbImage};

/// Below this many pixels there is no room for a legend.
const MIN_LEGEND_PX: usize = 480;

const EXACT: [u8; 3] = [0xf7, 0xf7, 0xf7];
const EXCESS: [[u8; 3]; 2] = [[0xfd, 0xb8, 0x63], [0xb3, 0x58, 0x06]];
const GOUGE: [[u8; 3]; 2] = [[0xb2, 0xab, 0xd2], [0x54, 0x27, 0x88]];
const NOTHING: [u8; 3] = [0xc4, 0xc4, 0xc4];
const PAPER: [u8; 3] = [0xff, 0xff, 0xff];
const TEXT: [u8; 3] = [0x22, 0x22, 0x22];

/// Draws a map whose colours end at `range_mm`; its longer side is `longest_px`.
pub(crate) fn draw_deviation(deviation: &Deviation, range_mm: f64, longest_px: u32) -> RgbImage {
    let grid = deviation.grid;
    let per_node = f64::from(longest_px) / grid.columns.max(grid.rows) as f64;
    let pixels = |nodes: usize| ((nodes as f64 * per_node).round() as usize).max(1);
    let (width, map_height) = (pixels(grid.columns), pixels(grid.rows));
    let unit = (width as f32 / 1000.0).max(0.6);
    let foot = if width >= MIN_LEGEND_PX { (legend::HEIGHT_UNITS * unit) as usize } else { 0 };
    let mut colors = vec![linear(PAPER); width * (map_height + foot)];
    for (y, row) in colors.chunks_exact_mut(width).take(map_height).enumerate() {
        let rows = covered(map_height - 1 - y, map_height, grid.rows);
        for (x, color) in row.iter_mut().enumerate() {
            let columns = covered(x, width, grid.columns);
            let nodes = rows.clone().flat_map(|j| {
                deviation.distances_mm[j * grid.columns..][columns.clone()].iter().copied()
            });
            let worst =
                nodes.fold(
                    f32::NAN,
                    |worst, v| {
                        if v.is_nan() || v.abs() <= worst.abs() { worst } else { v }
                    },
                );
            *color = color_of(f64::from(worst) / range_mm);
        }
    }
    if foot > 0 {
        let band = Band { width, rows: 0..map_height + foot };
        for ink in scale(width as f32, map_height as f32, unit, range_mm) {
            band.lay_ink(&ink, &mut colors);
        }
    }
    RgbImage::from_fn(width as u32, (map_height + foot) as u32, |x, y| {
        Rgb(encode(colors[y as usize * width + x as usize], x as usize, y as usize))
    })
}

/// The nodes that a pixel shows: those it covers, at least one.
fn covered(pixel: usize, pixels: usize, nodes: usize) -> std::ops::Range<usize> {
    let first = pixel * nodes / pixels;
    first..((pixel + 1) * nodes / pixels).max(first + 1).min(nodes)
}

/// The colour of a share of the range, −1 to 1.
fn color_of(share: f64) -> Linear {
    if share.is_nan() {
        return linear(NOTHING);
    }
    let [half, full] = if share > 0.0 { EXCESS } else { GOUGE }.map(linear);
    let share = share.abs().min(1.0) as f32;
    if share < 0.5 {
        mix(linear(EXACT), half, 2.0 * share)
    } else {
        mix(half, full, 2.0 * share - 1.0)
    }
}

fn mark(place: Place, unit: f32, color: [u8; 3], inks: &mut Vec<Ink>) {
    inks.push(Ink { ends: [place; 2], half_width: 6.0 * unit, color: linear(color), opacity: 1.0 });
}

/// The bar of colours with its figures, and what the ends mean.
fn scale(width: f32, top: f32, unit: f32, range_mm: f64) -> Vec<Ink> {
    let margin = 28.0 * unit;
    let entries = [
        Entry { name: "gouge", draw: |at, unit, inks| mark(at, unit, GOUGE[1], inks) },
        Entry { name: "excess", draw: |at, unit, inks| mark(at, unit, EXCESS[1], inks) },
    ];
    let (threads, inks) = legend::draw(
        (margin, width - margin, top),
        unit,
        Some((-range_mm, range_mm)),
        &entries,
        linear(TEXT),
    );
    let bar = threads.into_iter().map(|thread| Ink {
        ends: thread.ends,
        half_width: thread.half_width,
        color: color_of(2.0 * f64::from(thread.tone) - 1.0),
        opacity: 1.0,
    });
    bar.chain(inks).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_geometry::{DVec2, HeightField, Target, deviation};

    fn map(heights: impl Fn(usize) -> f32, size: u32) -> RgbImage {
        let field = |heights| HeightField::new(40, 20, 1.0, heights).unwrap();
        let machined = field((0..800).map(heights).collect());
        let target = field(vec![0.0; 800]);
        let target = Target::Field(&target, DVec2::ZERO);
        let found = deviation(&machined, DVec2::ZERO, target, 2.0, &|_| true).unwrap();
        draw_deviation(&found, 0.1, size)
    }

    fn near(is: [u8; 3], should: [u8; 3]) -> bool {
        is.iter().zip(should).all(|(a, b)| a.abs_diff(b) <= 2)
    }

    #[test]
    fn excess_is_orange_gouge_purple_and_the_border_gray() {
        // Above on the left, below on the right, exact in the far rows.
        let heights = |k: usize| match (k % 40, k / 40) {
            (_, 15..) => 0.0,
            (0..20, _) => 0.2,
            _ => -0.2,
        };
        let map = map(heights, 80);
        assert_eq!((map.width(), map.height()), (80, 40));
        assert!(near(map.get_pixel(20, 30).0, EXCESS[1]));
        assert!(near(map.get_pixel(60, 30).0, GOUGE[1]));
        assert!(near(map.get_pixel(40, 6).0, EXACT));
        assert!(near(map.get_pixel(0, 20).0, NOTHING));
    }

    #[test]
    fn a_single_dimple_shows_in_a_small_picture() {
        let map = map(|k| if k == 10 * 40 + 13 { -0.3 } else { 0.0 }, 10);
        let purple = map.pixels().filter(|pixel| near(pixel.0, GOUGE[1])).count();
        assert_eq!(purple, 1);
    }

    #[test]
    fn a_large_picture_has_a_legend_below() {
        let map = map(|_| 0.0, 1000);
        assert_eq!((map.width(), map.height()), (1000, 574));
        let dark = map.enumerate_pixels().filter(|(_, y, pixel)| *y > 505 && pixel.0[1] < 90);
        assert!(dark.count() > 200);
    }
}

//! How much of each pixel a polygon covers, exactly.
//!
//! An edge from a to b adds to each row that it crosses the signed height h of its part there, for all
//! pixels to its right, and to the pixels that it passes through the share of h that lies to its right.
//! Summed along a row from the left this is the area to the left of upward edges less that to the left
//! of downward ones: of a clean polygon, what lies inside. (The accumulation buffer of font
//! rasterizers; Levien, *Inside the fastest font renderer in the world*, 2016.) Time: linear in the
//! pixels and in the rows that edges cross.

use super::Polygon;
use crate::Tick;
use glam::DVec2;
use rayon::prelude::*;

/// Rows that are summed in one go: few enough for a core's cache, many enough that few edges are
/// looked at twice.
const BAND_ROWS: usize = 32;

/// Sums of covered shares are off by some 10⁻¹³; what is less is nothing.
const LEAST: f64 = 1e-9;

impl Polygon {
    /// The share of each pixel, 0 to 1, that a *clean* polygon covers. Pixel (x, y) is the square from
    /// there to (x + 1, y + 1); row by row from y = 0, x fastest. `None` if `tick` stopped it, which
    /// counts rows.
    #[must_use]
    pub fn coverage(&self, width: usize, height: usize, tick: Tick<'_>) -> Option<Vec<f32>> {
        let edges: Vec<[DVec2; 2]> = self.edges().filter(|[a, b]| a.y != b.y).collect();
        let mut shares = vec![0.0; width * height];
        shares.par_chunks_mut(BAND_ROWS * width).enumerate().try_for_each(|(band, shares)| {
            let rows = shares.len() / width;
            let top = (band * BAND_ROWS) as f64;
            let meets =
                |[a, b]: &&[DVec2; 2]| a.y.min(b.y) < top + rows as f64 && a.y.max(b.y) > top;
            // One more a row, for what lies right of the last pixel.
            let mut sums = vec![0.0; rows * (width + 1)];
            for edge in edges.iter().filter(meets) {
                let edge = edge.map(|corner| corner - DVec2::new(0.0, top));
                add_edge(edge, rows, width, &mut sums);
            }
            for (row, sums) in shares.chunks_exact_mut(width).zip(sums.chunks_exact(width + 1)) {
                let mut covered: f64 = 0.0;
                for (share, sum) in row.iter_mut().zip(sums) {
                    covered += sum;
                    *share = if covered < LEAST { 0.0 } else { covered.min(1.0) as f32 };
                }
            }
            tick(rows).then_some(())
        })?;
        Some(shares)
    }
}

/// Adds an edge to the sums of some rows from y = 0.
fn add_edge([a, b]: [DVec2; 2], rows: usize, width: usize, sums: &mut [f64]) {
    // A clean polygon has its inside to the left: down the edge counts.
    let (low, high, sense) = if a.y < b.y { (a, b, -1.0) } else { (b, a, 1.0) };
    let x_at = |y: f64| low.x + (y - low.y) / (high.y - low.y) * (high.x - low.x);
    let (from, to) = (low.y.max(0.0), high.y.min(rows as f64));
    for row in from as usize..(to.ceil() as usize).min(rows) {
        let (y0, y1) = (from.max(row as f64), to.min((row + 1) as f64));
        let (x0, x1) = (x_at(y0), x_at(y1));
        let row = &mut sums[row * (width + 1)..][..=width];
        add_part([x0.min(x1), x0.max(x1)], sense * (y1 - y0), row);
    }
}

/// Adds the part of an edge within a row: it spans `height` of it and x from `left` to `right`.
fn add_part([left, right]: [f64; 2], height: f64, row: &mut [f64]) {
    let part = |from: f64, to: f64| {
        if right > left { height * (to - from) / (right - left) } else { height }
    };
    if left < 0.0 {
        row[0] += part(left, right.min(0.0));
        if right <= 0.0 {
            return;
        }
    }
    // A cast holds what is beyond in; what lies right of the last pixel counts for none.
    let (first, width) = (left as usize, row.len() - 1);
    let end = (right.ceil() as usize).max(first + 1).min(width);
    for pixel in first..end {
        let (x, next) = (pixel as f64, (pixel + 1) as f64);
        let (from, to) = (left.max(x), right.min(next));
        let (height, to_the_right) = (part(from, to), next - 0.5 * (from + to));
        row[pixel] += height * to_the_right;
        row[pixel + 1] += height * (1.0 - to_the_right);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polygon::nasty;
    use std::f64::consts::TAU;

    fn covered(polygon: &Polygon, width: usize, height: usize) -> Vec<f32> {
        polygon.clean().unwrap().coverage(width, height, &|_| true).unwrap()
    }

    fn sum(shares: &[f32]) -> f64 {
        shares.iter().map(|share| f64::from(*share)).sum()
    }

    #[test]
    fn a_rectangle_covers_its_share_of_every_pixel() {
        let corners = (DVec2::new(0.5, 0.25), DVec2::new(2.25, 2.0));
        let rectangle = Polygon::rectangle(corners.0, corners.1).unwrap();
        #[rustfmt::skip]
        let expected = [
            0.375, 0.75, 0.1875,
            0.5,   1.0,  0.25,
            0.0,   0.0,  0.0,
        ];
        assert_eq!(covered(&rectangle, 3, 3), expected);
    }

    #[test]
    fn shares_sum_up_to_the_area() {
        let disk: Vec<DVec2> = (0..500)
            .map(|k| DVec2::new(40.3, 50.7) + 31.9 * DVec2::from_angle(f64::from(k) * TAU / 500.0))
            .collect();
        let disk = Polygon::new(vec![disk]).unwrap();
        assert!((sum(&covered(&disk, 80, 90)) - disk.area_mm2()).abs() < 1e-2);
        let mut random = fastrand::Rng::with_seed(11);
        for kind in (0..6).cycle().take(60) {
            let polygon = nasty(&mut random, kind);
            let Some(clean) = polygon.clean() else { continue };
            let (min, max) = clean.extent();
            let fit = |p: &DVec2| (*p - min) / (max - min).max_element() * 50.0 + 3.3;
            let moved = clean.loops().iter().map(|corners| corners.iter().map(fit).collect());
            let moved = Polygon::new(moved.collect()).unwrap();
            let area = moved.clean().unwrap().area_mm2();
            assert!((sum(&covered(&moved, 60, 60)) - area).abs() < 1e-3 * area.max(1.0), "{kind}");
        }
    }

    #[test]
    fn what_lies_beyond_the_border_is_cut_off() {
        let corner = |x: f64, y: f64| DVec2::new(x, y);
        let wide = Polygon::rectangle(corner(-1e6, -1e6), corner(1e6, 1e6)).unwrap();
        assert_eq!(covered(&wide, 3, 2), [1.0; 6]);
        // A diamond about the middle of a corner, and one whose edges cross the picture aslant.
        let diamond = |at: DVec2, r: f64| {
            let corners = [corner(r, 0.0), corner(0.0, r), corner(-r, 0.0), corner(0.0, -r)];
            Polygon::new(vec![corners.map(|p| at + p).to_vec()]).unwrap()
        };
        assert!((sum(&covered(&diamond(DVec2::ZERO, 4.0), 10, 10)) - 8.0).abs() < 1e-5);
        assert!((sum(&covered(&diamond(corner(10.0, 5.0), 4.0), 10, 10)) - 16.0).abs() < 1e-5);
        let large = covered(&diamond(corner(5.0, 5.0), 8.0), 10, 10);
        assert!((sum(&large) - (100.0 - 4.0 * 2.0)).abs() < 1e-5, "{}", sum(&large));
    }
}

//! How far every pixel is from a mask's edge, to about a tenth of a pixel.
//!
//! A pixel of share a that is neither in nor out, or that is in beside one that is out, holds a piece
//! of the edge: that of the half-plane which covers the share a of its square and whose normal n is the
//! direction in which shares grow (Sobel). From the corner that the half-plane enters last, the edge
//! is √(2·n₁·n₂·a) away while it cuts off a triangle, then a·n₂ + n₁/2, with n₁ ≤ n₂ the absolute
//! components of n and a ≤ 1/2 (S. Gustavson, R. Strand, *Anti-aliased Euclidean distance transform*,
//! Pattern Recognition Letters 32, 2011). Pieces are a diagonal long; each pixel learns the nearest one
//! from its neighbours in two passes there and back (P.-E. Danielsson, *Euclidean Distance Mapping*,
//! Computer Graphics and Image Processing 14, 1980), which compare distances from the pieces themselves.

use super::SELECTED;
use crate::values::Mask;
use carvegraph_geometry::DVec2;

/// Marks a pixel that knows no piece yet.
const NONE: u32 = u32::MAX;

/// Half the length of a piece, in pixels: that of the diagonal, so that pieces leave no gap.
const HALF_PIECE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A piece of the edge, in pixels.
struct Piece {
    middle: DVec2,
    /// Of length 1, inwards; 0 where shares grow to no side, as on a line a pixel wide.
    normal: DVec2,
}

impl Piece {
    fn distance(&self, from: DVec2) -> f64 {
        let away = from - self.middle;
        if self.normal == DVec2::ZERO {
            return away.length();
        }
        let beside = (away.perp_dot(self.normal).abs() - HALF_PIECE).max(0.0);
        away.dot(self.normal).hypot(beside)
    }
}

/// The distance of each pixel's middle from the mask's edge in pixels, positive inside; infinite if there
/// is no edge. `tick` is called twice a row; `None` if it says stop.
pub(crate) fn from_edge(mask: &Mask, tick: impl Fn() -> bool) -> Option<Vec<f32>> {
    let (width, height) = (mask.width, mask.height);
    let count = mask.values.len();
    let mut known = Known {
        width,
        pieces: Vec::new(),
        nearest: vec![NONE; count],
        away: vec![f32::INFINITY; count],
    };
    (0..count).filter(|at| has_edge(mask, *at)).for_each(|at| known.begin(at, piece(mask, at)));
    for y in 0..height {
        known.learn_row(y, y.checked_sub(1));
        tick().then_some(())?;
    }
    for y in (0..height).rev() {
        known.learn_row(y, Some(y + 1).filter(|below| *below < height));
        tick().then_some(())?;
    }
    let mut distances = known.away;
    for (distance, share) in distances.iter_mut().zip(&mask.values) {
        *distance = if *share >= SELECTED { *distance } else { -*distance };
    }
    Some(distances)
}

fn has_edge(mask: &Mask, at: usize) -> bool {
    let share = mask.values[at];
    let (x, y) = (at % mask.width, at / mask.width);
    let is_out = |x: usize, y: usize| {
        x < mask.width && y < mask.height && mask.values[y * mask.width + x] <= 0.0
    };
    let beside = [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)];
    share > 0.0 && (share < 1.0 || beside.into_iter().any(|(x, y)| is_out(x, y)))
}

fn piece(mask: &Mask, at: usize) -> Piece {
    let (x, y) = (at % mask.width, at / mask.width);
    // Beyond the border shares go on as they are on it.
    let share = |dx: usize, dy: usize| {
        let (x, y) = ((x + dx).saturating_sub(1), (y + dy).saturating_sub(1));
        f64::from(mask.values[y.min(mask.height - 1) * mask.width + x.min(mask.width - 1)])
    };
    let weighed = |a: f64, b: f64, c: f64| a + 2.0 * b + c;
    let column = |dx: usize| weighed(share(dx, 0), share(dx, 1), share(dx, 2));
    let row = |dy: usize| weighed(share(0, dy), share(1, dy), share(2, dy));
    let normal = DVec2::new(column(2) - column(0), row(2) - row(0)).normalize_or_zero();
    let inwards = inwards(share(1, 1), normal);
    Piece { middle: middle(mask.width, at) - inwards * normal, normal }
}

/// How far the middle of a pixel lies within a half-plane that covers that share of it.
fn inwards(share: f64, normal: DVec2) -> f64 {
    let (least, most) = (normal.abs().min_element(), normal.abs().max_element());
    let lesser = share.min(1.0 - share);
    let triangle = 2.0 * most * lesser < least;
    let from_corner =
        if triangle { (2.0 * least * most * lesser).sqrt() } else { lesser * most + 0.5 * least };
    let outwards = 0.5 * (least + most) - from_corner;
    if share < 0.5 { -outwards } else { outwards }
}

fn middle(width: usize, at: usize) -> DVec2 {
    DVec2::new((at % width) as f64, (at / width) as f64)
}

/// The nearest piece that each pixel knows of.
struct Known {
    width: usize,
    pieces: Vec<Piece>,
    nearest: Vec<u32>,
    /// How far it is, in pixels.
    away: Vec<f32>,
}

impl Known {
    /// Notes the piece of a pixel that has one.
    fn begin(&mut self, at: usize, piece: Piece) {
        self.nearest[at] = self.pieces.len() as u32;
        self.away[at] = piece.distance(middle(self.width, at)) as f32;
        self.pieces.push(piece);
    }

    /// Lets a row learn from one beside it, then from left to right and back.
    fn learn_row(&mut self, y: usize, beside: Option<usize>) {
        let (width, first) = (self.width, y * self.width);
        if let Some(beside) = beside {
            for x in 0..width {
                for from in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                    self.learn(first + x, beside * width + from);
                }
            }
        }
        (1..width).for_each(|x| self.learn(first + x, first + x - 1));
        (1..width).rev().for_each(|x| self.learn(first + x - 1, first + x));
    }

    fn learn(&mut self, at: usize, from: usize) {
        let other = self.nearest[from];
        if other == self.nearest[at] || other == NONE {
            return;
        }
        let away = self.pieces[other as usize].distance(middle(self.width, at)) as f32;
        if away < self.away[at] {
            (self.nearest[at], self.away[at]) = (other, away);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_geometry::Polygon;

    fn distances(mask: &Mask) -> Vec<f32> {
        from_edge(mask, || true).unwrap()
    }

    fn covered(corners: Vec<DVec2>, size: usize) -> Mask {
        let outline = Polygon::new(vec![corners]).unwrap().clean().unwrap();
        let values = outline.coverage(size, size, &|_| true).unwrap();
        Mask { width: size, height: size, values }
    }

    #[test]
    fn distances_from_a_disk_are_those_of_its_circle() {
        let (middle, radius) = (DVec2::new(50.3, 49.1), 30.7);
        let corner = |k: u32| middle + radius * DVec2::from_angle(f64::from(k) * 0.01);
        let mask = covered((0..628).map(corner).collect(), 100);
        for (at, found) in distances(&mask).iter().enumerate() {
            let place = DVec2::new((at % 100) as f64 + 0.5, (at / 100) as f64 + 0.5);
            let expected = radius - (place - middle).length();
            assert!((f64::from(*found) - expected).abs() < 0.15, "{place} {found} {expected}");
        }
    }

    #[test]
    fn slanted_walls_are_planes() {
        // A half-plane whose edge rises 3 in 10: distances are those from a line.
        let corners = [(0.0, 20.0), (100.0, 50.0), (100.0, 300.0), (0.0, 300.0)];
        let mask = covered(corners.map(|(x, y)| DVec2::new(x, y)).to_vec(), 100);
        let normal = DVec2::new(-0.3, 1.0).normalize();
        for (at, found) in distances(&mask).iter().enumerate() {
            let place = DVec2::new((at % 100) as f64 + 0.5, (at / 100) as f64 + 0.5);
            let expected = (place - DVec2::new(0.0, 20.0)).dot(normal);
            // The nearest place of the edge must lie on the picture.
            let foot = place - expected * normal;
            if (2.0..98.0).contains(&foot.x) {
                assert!((f64::from(*found) - expected).abs() < 0.15, "{place} {found} {expected}");
            }
        }
    }

    #[test]
    fn a_crisp_edge_lies_between_its_pixels() {
        let values = [0.0, 0.0, 1.0, 1.0, 1.0].repeat(3);
        let mask = Mask { width: 5, height: 3, values };
        assert_eq!(distances(&mask)[5..10], [-1.5, -0.5, 0.5, 1.5, 2.5]);
    }

    #[test]
    fn a_dot_is_an_edge_all_around() {
        let mut values = vec![0.0; 49];
        values[24] = 1.0;
        let found = distances(&Mask { width: 7, height: 7, values });
        assert_eq!((found[24], found[22], found[8]), (0.0, -2.0, -8.0_f32.sqrt()));
    }

    #[test]
    fn without_an_edge_it_is_infinitely_far() {
        let flat = |share: f32| distances(&Mask { width: 2, height: 2, values: vec![share; 4] });
        assert_eq!((flat(0.0), flat(1.0)), (vec![f32::NEG_INFINITY; 4], vec![f32::INFINITY; 4]));
        let mask = Mask { width: 1, height: 1, values: vec![1.0] };
        assert!(from_edge(&mask, || false).is_none());
    }
}

//! A mask drawn with polygons.
//!
//! A pixel is selected if its middle lies inside: on a line through the middles of a row, between
//! the first and the second crossing of the outlines, the third and the fourth, and so on. That is
//! the even-odd rule, over all loops together: where two polygons overlap, and where one crosses
//! itself, what is surrounded twice is left out. An edge belongs to the pixels to the right of it
//! and below it, so that polygons which share an edge share no pixel. The mask's edge is crisp;
//! `feather_mask` softens it.

use crate::path::read_corners;
use crate::values::{GrayImage, Mask};
use carvegraph_core::{Choice, Conflict, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{DVec2, Polygon};
use rayon::prelude::*;

/// Selects what polygons surround; a loop within another is a hole.
#[derive(Clone, Debug, Params)]
pub(crate) struct PolygonMask {
    /// Corners as x,y with blanks between them; loops with a semicolon between them. 0,0 is the
    /// picture's upper left corner; y counts downwards. The word none selects nothing.
    #[param(default = "0.25,0.25 0.75,0.25 0.75,0.75 0.25,0.75")]
    pub(crate) corners: String,
    /// What the corners count in.
    #[param(default = Counting::Shares)]
    pub(crate) counting: Counting,
}

/// Stands for corners where nothing is to be selected.
const NOTHING: &str = "none";

/// What corners count in.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Counting {
    /// Shares of the picture's width and height: 1,1 is its lower right corner.
    Shares,
    /// Pixels: the middle of the first pixel is 0.5,0.5.
    Pixels,
}

#[derive(Inputs)]
pub(crate) struct Canvas<'a> {
    /// The picture that the mask is for; only its size counts.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Drawn {
    /// What is surrounded.
    mask: Mask,
}

impl Node for PolygonMask {
    const KIND: &'static str = "polygon_mask";
    type Inputs<'a> = Canvas<'a>;
    type Outputs = Drawn;

    fn check(&self) -> Result<(), Conflict> {
        self.polygon().map(|_| ()).map_err(|message| Conflict { param: "corners", message })
    }

    fn run(&self, inputs: Canvas<'_>, cx: &Context<'_>) -> Result<Drawn, NodeError> {
        let (width, height) = (inputs.image.width, inputs.image.height);
        let Some(polygon) = self.polygon().map_err(NodeError::failed)? else {
            return Ok(Drawn { mask: Mask::nothing(width, height) });
        };
        let scale = match self.counting {
            Counting::Shares => DVec2::new(width as f64, height as f64),
            Counting::Pixels => DVec2::ONE,
        };
        let edges = edges(&polygon, scale);
        let ticker = cx.ticker(height);
        let mut values = vec![0.0; width * height];
        values
            .par_chunks_exact_mut(width)
            .enumerate()
            .try_for_each(|(y, row)| {
                fill_row(&edges, y as f64 + 0.5, row);
                ticker.tick(1).then_some(())
            })
            .ok_or(NodeError::Cancelled)?;
        if values.iter().all(|value| *value == 0.0) {
            cx.warn("the polygons hold no pixel's middle: the mask selects nothing");
        }
        Ok(Drawn { mask: Mask { width, height, values } })
    }
}

impl PolygonMask {
    /// What the corners surround, if anything is to be selected.
    fn polygon(&self) -> Result<Option<Polygon>, String> {
        match self.corners.trim() {
            NOTHING => Ok(None),
            corners => read_corners(corners).map(Some),
        }
    }
}

/// Every edge of every loop, in pixels.
fn edges(polygon: &Polygon, scale: DVec2) -> Vec<(DVec2, DVec2)> {
    let around = |corners: &Vec<DVec2>| {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| (*a * scale, *b * scale)).collect::<Vec<_>>()
    };
    polygon.loops().iter().flat_map(around).collect()
}

fn fill_row(edges: &[(DVec2, DVec2)], y: f64, row: &mut [f32]) {
    let crosses = |(a, b): &&(DVec2, DVec2)| (a.y <= y) != (b.y <= y);
    let place = |(a, b): &(DVec2, DVec2)| a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
    let mut crossings: Vec<f64> = edges.iter().filter(crosses).map(place).collect();
    crossings.sort_by(f64::total_cmp);
    // The first pixel whose middle is not left of the crossing; a cast holds what is beyond in.
    let first = |x: f64| ((x - 0.5).ceil() as usize).min(row.len());
    let spans: Vec<_> =
        crossings.chunks_exact(2).map(|pair| first(pair[0])..first(pair[1])).collect();
    spans.into_iter().for_each(|span| row[span].fill(1.0));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn draw(corners: &str, counting: Counting, (width, height): (usize, usize)) -> Vec<f32> {
        let image = GrayImage { width, height, values: vec![0.0; width * height] };
        let node = PolygonMask { corners: corners.to_owned(), counting };
        node.check().unwrap();
        run(|cx| node.run(Canvas { image: &image }, cx)).unwrap().mask.values
    }

    fn count(values: &[f32]) -> usize {
        values.iter().filter(|value| **value == 1.0).count()
    }

    #[test]
    fn a_square_of_whole_pixels_selects_them() {
        let mask = draw("1,1 4,1 4,3 1,3", Counting::Pixels, (5, 4));
        #[rustfmt::skip]
        let expected = [
            0., 0., 0., 0., 0.,
            0., 1., 1., 1., 0.,
            0., 1., 1., 1., 0.,
            0., 0., 0., 0., 0.,
        ];
        assert_eq!(mask, expected);
        assert_eq!(draw("0.2,0.25 0.8,0.25 0.8,0.75 0.2,0.75", Counting::Shares, (5, 4)), expected);
    }

    #[test]
    fn what_is_surrounded_twice_is_left_out() {
        let ring = draw("0,0 9,0 9,9 0,9; 3,3 6,3 6,6 3,6", Counting::Pixels, (9, 9));
        assert_eq!(count(&ring), 81 - 9);
        // A star of five points: its middle is surrounded twice.
        let star = draw("0.5,0 0.8,0.95 0.02,0.36 0.98,0.36 0.2,0.95", Counting::Shares, (99, 99));
        assert_eq!(star[50 * 99 + 49], 0.0);
        assert_eq!(star[12 * 99 + 49], 1.0);
    }

    #[test]
    fn neighbours_share_no_pixel_and_leave_no_gap() {
        let size = (31, 23);
        let left = draw("-5,-5 13.5,-5 20,30 -5,30", Counting::Pixels, size);
        let right = draw("13.5,-5 50,-5 50,30 20,30", Counting::Pixels, size);
        assert!(left.iter().zip(&right).all(|(a, b)| a + b == 1.0));
    }

    #[test]
    fn a_disk_has_the_area_of_its_polygon() {
        let corner = |k: usize| {
            let (sin, cos) = (k as f64 * std::f64::consts::TAU / 60.0).sin_cos();
            format!("{},{}", 100.0 + 80.0 * cos, 100.0 + 80.0 * sin)
        };
        let corners: Vec<String> = (0..60).map(corner).collect();
        let area = 0.5 * 60.0 * 80.0f64.powi(2) * (std::f64::consts::TAU / 60.0).sin();
        let found = count(&draw(&corners.join(" "), Counting::Pixels, (200, 200))) as f64;
        assert!((found - area).abs() < 0.002 * area, "{found} of {area}");
    }

    #[test]
    fn what_lies_outside_of_the_picture_is_cut_off() {
        assert_eq!(draw("-1e9,-1e9 1e9,-1e9 1e9,1e9 -1e9,1e9", Counting::Pixels, (1, 3)), [1.0; 3]);
        assert_eq!(draw("5,0 9,0 9,9", Counting::Pixels, (3, 1)), [0.0; 3]);
    }

    /// Whether a place lies inside by the even-odd rule, along a column in place of a row and by signs
    /// of areas in place of crossings.
    fn is_inside(loops: &[Vec<[f64; 2]>], [x, y]: [f64; 2]) -> bool {
        let crosses = |[ax, ay]: [f64; 2], [bx, by]: [f64; 2]| {
            let area = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
            (ax < x && bx > x && area > 0.0) || (bx < x && ax > x && area < 0.0)
        };
        let edges = |corners: &[[f64; 2]]| {
            let next = corners.iter().cycle().skip(1);
            corners.iter().zip(next).filter(|(a, b)| crosses(**a, **b)).count()
        };
        loops.iter().map(|corners| edges(corners)).sum::<usize>() % 2 == 1
    }

    #[test]
    fn polygons_that_cross_are_filled_as_an_oracle_says() {
        let mut random = fastrand::Rng::with_seed(11);
        for (width, height) in [(1, 1), (1, 23), (23, 1), (17, 31), (64, 5)] {
            for _ in 0..60 {
                let mut corner =
                    || [width, height].map(|side| (random.f64() * 1.6 - 0.3) * side as f64);
                let loops: Vec<Vec<[f64; 2]>> =
                    (3..6).map(|count| (0..count).map(|_| corner()).collect()).collect();
                let text = |corners: &Vec<[f64; 2]>| {
                    let texts = corners.iter().map(|[x, y]| format!("{x},{y}"));
                    texts.collect::<Vec<_>>().join(" ")
                };
                let corners = loops.iter().map(text).collect::<Vec<_>>().join("; ");
                let expected: Vec<f32> = (0..width * height)
                    .map(|at| [(at % width) as f64 + 0.5, (at / width) as f64 + 0.5])
                    .map(|middle| if is_inside(&loops, middle) { 1.0 } else { 0.0 })
                    .collect();
                assert_eq!(
                    draw(&corners, Counting::Pixels, (width, height)),
                    expected,
                    "{corners}"
                );
            }
        }
    }

    #[test]
    fn none_selects_nothing() {
        assert_eq!(draw(" none ", Counting::Shares, (3, 2)), [0.0; 6]);
    }

    #[test]
    fn what_is_no_polygon_is_told() {
        let fault = |corners: &str| {
            let node = PolygonMask { corners: corners.to_owned(), counting: Counting::Shares };
            node.check().unwrap_err().message
        };
        assert_eq!(fault("0,0 1,1"), "loop 1 has 2 corners; the least is 3");
        assert_eq!(fault("0,0 1,0 0,1; 0.5,0.5"), "loop 2 has 1 corners; the least is 3");
        assert_eq!(fault("0,0 1,NaN 0,1"), "\"1,NaN\" is no corner: write it as 12.5,30");
        assert_eq!(fault(""), "loop 1 has 0 corners; the least is 3");
    }
}

//! Brightness changed along a curve through given points.
//!
//! Between two points the curve is a cubic Hermite polynomial; its slopes are those of F. Fritsch and
//! J. Butland, *A Method for Constructing Local Monotone Piecewise Cubic Interpolants*, SIAM J. Sci.
//! Stat. Comput. 5 (1984): at an inner point the weighted harmonic mean of the slopes of the chords
//! on both sides, or 0 where these differ in sign; at the ends that of the chord. So the curve rises
//! where the points rise and never swings beyond them. Outside of the points it is level.

use super::rows::by_pixels;
use crate::path::read_corner;
use crate::values::GrayImage;
use carvegraph_core::{Conflict, Context, Inputs, Node, NodeError, Outputs, Params};

/// Changes brightness along a smooth curve through points.
#[derive(Clone, Debug, Params)]
pub(crate) struct Curves {
    /// Points as before,after with blanks between them, 0 for black and 1 for white; before rises
    /// from point to point.
    #[param(default = "0,0 1,1")]
    pub(crate) points: String,
}

#[derive(Inputs)]
pub(crate) struct Before<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct After {
    /// The picture along the curve.
    image: GrayImage,
}

impl Node for Curves {
    const KIND: &'static str = "curves";
    const VERSION: u32 = 2;
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn check(&self) -> Result<(), Conflict> {
        let curve = Curve::read(&self.points);
        curve.map(|_| ()).map_err(|message| Conflict { param: "points", message })
    }

    fn run(&self, inputs: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let curve = Curve::read(&self.points).map_err(NodeError::failed)?;
        let image = by_pixels(inputs.image, cx, |value| curve.at(f64::from(value)) as f32)?;
        Ok(After { image })
    }
}

/// A curve, piece by piece.
#[derive(Debug)]
struct Curve {
    /// Where it is level: below the first of these and above the second.
    ends: [f64; 2],
    pieces: Vec<Piece>,
}

/// What a curve is from `start` on: a polynomial in the distance from there, constant first.
#[derive(Clone, Copy, Debug)]
struct Piece {
    start: f64,
    factors: [f64; 4],
}

impl Curve {
    fn read(text: &str) -> Result<Self, String> {
        let points = text.split_whitespace().map(read_corner).collect::<Result<Vec<_>, _>>()?;
        if points.len() < 2 {
            return Err(format!("a curve needs two points at least, and has {}", points.len()));
        }
        let chord = |k: usize| (points[k + 1] - points[k]).to_array();
        if let Some(k) = (0..points.len() - 1).find(|k| chord(*k)[0] <= 0.0) {
            let (a, b) = (points[k], points[k + 1]);
            return Err(format!("{},{} must lie right of {},{}", b.x, b.y, a.x, a.y));
        }
        let last = points.len() - 1;
        let slope = |k: usize| chord(k)[1] / chord(k)[0];
        let slope_at = |k: usize| match k {
            0 => slope(0),
            k if k == last => slope(last - 1),
            k if slope(k - 1) * slope(k) <= 0.0 => 0.0,
            k => {
                let (before, after) = (chord(k - 1)[0], chord(k)[0]);
                let (heavy, light) = (2.0 * after + before, after + 2.0 * before);
                (heavy + light) / (heavy / slope(k - 1) + light / slope(k))
            }
        };
        let piece = |k: usize| {
            let (width, chord) = (chord(k)[0], slope(k));
            let (begins, ends) = (slope_at(k), slope_at(k + 1));
            let square = (3.0 * chord - 2.0 * begins - ends) / width;
            let cube = (begins + ends - 2.0 * chord) / (width * width);
            Piece { start: points[k].x, factors: [points[k].y, begins, square, cube] }
        };
        let ends = [points[0].x, points[last].x];
        Ok(Self { ends, pieces: (0..last).map(piece).collect() })
    }

    fn at(&self, x: f64) -> f64 {
        let x = x.clamp(self.ends[0], self.ends[1]);
        // Curves have few pieces; counting takes no branch.
        let before = self.pieces[1..].iter().filter(|piece| piece.start <= x).count();
        let Piece { start, factors: [a, b, c, d] } = self.pieces[before];
        let past = x - start;
        a + past * (b + past * (c + past * d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn curve(points: &str, values: &[f32]) -> Vec<f32> {
        let image = GrayImage { width: values.len(), height: 1, values: values.to_vec() };
        let node = Curves { points: points.to_owned() };
        node.check().unwrap();
        run(|cx| node.run(Before { image: &image }, cx)).unwrap().image.values
    }

    #[test]
    fn points_in_a_line_are_a_line_and_beyond_them_it_is_level() {
        let out = curve("0,0 0.25,0.25 1,1", &[-1.0, 0.0, 0.1, 0.25, 0.7, 1.0, 2.0]);
        let expected = [0.0, 0.0, 0.1, 0.25, 0.7, 1.0, 1.0];
        assert!(out.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{out:?}");
    }

    #[test]
    fn the_curve_goes_through_its_points_and_rises_with_them() {
        let points = "0,0 0.1,0.02 0.5,0.9 0.6,0.9 1,1";
        let out = curve(points, &[0.0, 0.1, 0.5, 0.6, 1.0]);
        assert!(out.iter().zip([0.0, 0.02, 0.9, 0.9, 1.0]).all(|(a, b)| (a - b).abs() < 1e-6));
        let all: Vec<f32> = (0..=1000).map(|k| k as f32 / 1000.0).collect();
        assert!(curve(points, &all).windows(2).all(|pair| pair[1] >= pair[0]));
    }

    #[test]
    fn what_is_no_curve_is_told() {
        let fault =
            |points: &str| Curves { points: points.to_owned() }.check().unwrap_err().message;
        assert_eq!(fault("0,0"), "a curve needs two points at least, and has 1");
        assert_eq!(fault("0,0 0.5,1 0.5,0"), "0.5,0 must lie right of 0.5,1");
        assert!(fault("0,0 1").contains("is no corner"));
    }
}

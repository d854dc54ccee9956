//! Six planes at once on a convex stretch of a profile.
//!
//! On such a stretch a plane of slope g = tan θ is touched where the slope of the profile passes g: all
//! lines that are less steep lie within, and of an arc the part up to the angle θ. So r and h are sums
//! over the pieces, without a branch, of as much as lies within.

use super::general::{Curve, Piece};

/// A stretch along which the slope rises. Where it falls, and nothing stands upright, no plane can be
/// touched: a line amid such falls makes no layer.
pub(super) struct Layer {
    r0: f64,
    h0: f64,
    steps: Vec<Step>,
}

enum Step {
    Line { slope: f64, run: f64, rise: f64 },
    Arc { rho: f64, sin: [f64; 2], cos: [f64; 2] },
}

impl Step {
    fn of(piece: &Piece) -> Self {
        match piece.curve {
            Curve::Line { slope } => {
                Self::Line { slope, run: piece.r1 - piece.r0, rise: piece.h1 - piece.h0 }
            }
            Curve::Arc { r_center, h_center, rho } => {
                let sin = [piece.r0, piece.r1].map(|r| (r - r_center) / rho);
                let cos = [piece.h0, piece.h1].map(|h| (h_center - h) / rho);
                // Ordered also where rounding made them differ from what a piece is.
                Self::Arc {
                    rho,
                    sin: [sin[0].min(sin[1]), sin[1]],
                    cos: [cos[0], cos[1].min(cos[0])],
                }
            }
        }
    }
}

impl Layer {
    /// The layers of a profile; slopes that fall by no more than `tangent` do not fall.
    pub(super) fn of(pieces: &[Piece], tangent: f64) -> Vec<Self> {
        let falls = |k: usize| {
            let (before, next) = (&pieces[k - 1], &pieces[k]);
            before.wall || next.slopes[0] + tangent < before.slopes[1]
        };
        let starts: Vec<usize> = (0..pieces.len()).filter(|&k| k == 0 || falls(k)).collect();
        let ends = starts.iter().skip(1).copied().chain([pieces.len()]);
        let stretches = starts.iter().zip(ends).map(|(&start, end)| start..end);
        let touchable = stretches.filter(|stretch| {
            let (first, last) = (&pieces[stretch.start], &pieces[stretch.end - 1]);
            let line = matches!(first.curve, Curve::Line { .. }) && stretch.len() == 1;
            !line || stretch.start == 0 || last.wall
        });
        let layer = |pieces: &[Piece]| Self {
            r0: pieces[0].r0,
            h0: pieces[0].h0,
            steps: pieces.iter().map(Step::of).collect(),
        };
        touchable.map(|stretch| layer(&pieces[stretch])).collect()
    }

    /// See [`super::shape::Shape::touch_planes`].
    #[inline(always)]
    pub(super) fn touch_planes(&self, slope2: &[f64; 6]) -> [[f64; 6]; 2] {
        let (mut g, mut sin, mut cos) = ([0.0; 6], [0.0; 6], [0.0; 6]);
        for k in 0..6 {
            g[k] = slope2[k].sqrt();
            cos[k] = 1.0 / (1.0 + slope2[k]).sqrt();
            sin[k] = g[k] * cos[k];
        }
        let (mut r, mut h) = ([self.r0; 6], [self.h0; 6]);
        for step in &self.steps {
            match *step {
                Step::Line { slope, run, rise } => {
                    for k in 0..6 {
                        let (way, up) = if g[k] > slope { (run, rise) } else { (0.0, 0.0) };
                        (r[k], h[k]) = (r[k] + way, h[k] + up);
                    }
                }
                Step::Arc { rho, sin: [from, to], cos: [high, low] } => {
                    for k in 0..6 {
                        r[k] += rho * (within(sin[k], from, to) - from);
                        h[k] += rho * (high - within(cos[k], low, high));
                    }
                }
            }
        }
        let mut touch = [[0.0; 6]; 2];
        for k in 0..6 {
            // On a level plane a place near the tip is the axis.
            touch[0][k] = r[k] / if g[k] < TINY { TINY } else { g[k] };
            touch[1][k] = g[k] * r[k] - h[k];
        }
        touch
    }
}

/// A slope that is none.
const TINY: f64 = 1e-150;

/// Clamped; NaN becomes a number.
#[inline(always)]
fn within(v: f64, low: f64, high: f64) -> f64 {
    let v = if v > low { v } else { low };
    if v < high { v } else { high }
}

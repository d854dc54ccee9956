//! A picture turned.
//!
//! Quarter turns move pixels and change none. At any other angle a pixel of the turned picture is
//! looked up in the given one by cubic convolution (R. Keys, *Cubic Convolution Interpolation for
//! Digital Image Processing*, IEEE Trans. ASSP 29, 1981, a = -1/2): exact for planes and for
//! parabolas along a row or column. The turned picture is large enough to hold all of the given one;
//! what lies outside of it is filled. Within a pixel of the border the edge pixel is repeated.

use super::rows::by_bands;
use crate::picture::MAX_PIXELS;
use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};

/// Side of the squares that are turned at once: what they read stays in the nearest cache.
const TILE: usize = 32;

/// Turns a picture about its middle.
#[derive(Clone, Debug, Params)]
pub(crate) struct RotateImage {
    /// By how much, counterclockwise; quarter turns are exact.
    #[param(unit = "deg", default = 0.0, range = -360.0..=360.0)]
    pub(crate) angle: f64,
    /// The gray of what lies outside of the turned picture.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub(crate) backdrop: f64,
}

#[derive(Inputs)]
pub(crate) struct Upright<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Turned {
    /// The turned picture.
    image: GrayImage,
}

impl Node for RotateImage {
    const KIND: &'static str = "rotate_image";
    const VERSION: u32 = 2;
    type Inputs<'a> = Upright<'a>;
    type Outputs = Turned;

    fn run(&self, inputs: Upright<'_>, cx: &Context<'_>) -> Result<Turned, NodeError> {
        let image = match self.angle % 90.0 == 0.0 {
            true => quarter_turns(inputs.image, (self.angle / 90.0) as i32, cx)?,
            false => self.turned(inputs.image, cx)?,
        };
        Ok(Turned { image })
    }
}

/// Turned counterclockwise so many times.
fn quarter_turns(image: &GrayImage, turns: i32, cx: &Context<'_>) -> Result<GrayImage, NodeError> {
    let (width, height) = (image.width, image.height);
    let pixel = |x: usize, y: usize| image.values[y * width + x];
    match turns.rem_euclid(4) {
        0 => Ok(image.clone()),
        1 => by_tiles((height, width), cx, |x, y| pixel(width - 1 - y, x)),
        2 => by_tiles((width, height), cx, |x, y| pixel(width - 1 - x, height - 1 - y)),
        _ => by_tiles((height, width), cx, |x, y| pixel(y, height - 1 - x)),
    }
}

/// The picture of that size whose pixels `pixel` makes, tile by tile: neighbours on all sides are read
/// from places near each other, whichever way the picture is turned.
fn by_tiles(
    (width, height): (usize, usize),
    cx: &Context<'_>,
    pixel: impl Fn(usize, usize) -> f32 + Sync,
) -> Result<GrayImage, NodeError> {
    by_bands((width, height), TILE, cx, |top, band| {
        for left in (0..width).step_by(TILE) {
            for (k, row) in band.chunks_exact_mut(width).enumerate() {
                let row = row[left..].iter_mut().take(TILE).enumerate();
                row.for_each(|(i, value)| *value = pixel(left + i, top + k));
            }
        }
    })
}

impl RotateImage {
    fn turned(&self, image: &GrayImage, cx: &Context<'_>) -> Result<GrayImage, NodeError> {
        let (sin, cos) = self.angle.to_radians().sin_cos();
        let (width, height) = (image.width as f64, image.height as f64);
        let side = |a: f64, b: f64| (a.abs() + b.abs()).ceil().max(1.0);
        let (wide, high) = (side(width * cos, height * sin), side(width * sin, height * cos));
        if wide * high > MAX_PIXELS as f64 {
            let message =
                format!("turned, the picture has {wide} × {high} px; the limit is {MAX_PIXELS}");
            return Err(NodeError::Refused { param: "angle", message });
        }
        let backdrop = self.backdrop as f32;
        by_tiles((wide as usize, high as usize), cx, |x, y| {
            let (right, down) = (x as f64 + 0.5 - wide / 2.0, y as f64 + 0.5 - high / 2.0);
            // y counts downwards, so this is the place before a counterclockwise turn.
            let u = right * cos - down * sin + width / 2.0;
            let v = right * sin + down * cos + height / 2.0;
            let is_inside = (0.0..=width).contains(&u) && (0.0..=height).contains(&v);
            if is_inside { cubic(image, u, v) } else { backdrop }
        })
    }
}

/// The picture at a place between pixels; the middle of the first is at 0.5, 0.5.
fn cubic(image: &GrayImage, u: f64, v: f64) -> f32 {
    // The second of the four pixels around the place along each side, and how far after it.
    let split = |place: f64| {
        let after = (place + 0.5) as u32;
        (after as usize, (place + 0.5 - f64::from(after)) as f32)
    };
    let ((right, across), (below, down)) = (split(u), split(v));
    let (across, down) = (keys(across), keys(down));
    let (width, height) = (image.width, image.height);
    let mut sums = [0.0; 4];
    if right >= 2 && right + 1 < width && below >= 2 && below + 1 < height {
        for (k, weight) in down.iter().enumerate() {
            let row = &image.values[(below + k - 2) * width + right - 2..][..4];
            sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
        }
    } else {
        let hold = |i: usize, count: usize| i.saturating_sub(2).min(count - 1);
        for (k, weight) in down.iter().enumerate() {
            let row = &image.values[hold(below + k, height) * width..];
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum += weight * row[hold(right + i, width)];
            }
        }
    }
    sums.iter().zip(across).map(|(sum, weight)| sum * weight).sum()
}

/// The weights of the four pixels around a place, `t` after the second.
fn keys(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        -0.5 * t3 + t2 - 0.5 * t,
        1.5 * t3 - 2.5 * t2 + 1.0,
        -1.5 * t3 + 2.0 * t2 + 0.5 * t,
        0.5 * t3 - 0.5 * t2,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn turn(angle: f64, image: &GrayImage) -> GrayImage {
        let node = RotateImage { angle, backdrop: 0.0 };
        run(|cx| node.run(Upright { image }, cx)).unwrap().image
    }

    fn numbers(width: usize, height: usize) -> GrayImage {
        GrayImage { width, height, values: (0..width * height).map(|k| k as f32).collect() }
    }

    #[test]
    fn quarter_turns_move_pixels() {
        let turned = turn(90.0, &numbers(3, 2));
        assert_eq!((turned.width, turned.height), (2, 3));
        assert_eq!(turned.values, [2.0, 5.0, 1.0, 4.0, 0.0, 3.0]);
        assert_eq!(turn(-270.0, &numbers(3, 2)), turned);
        assert_eq!(turn(180.0, &numbers(3, 2)).values, [5.0, 4.0, 3.0, 2.0, 1.0, 0.0]);
        assert_eq!(turn(360.0, &numbers(1, 4)), numbers(1, 4));
        let four = (0..4).fold(numbers(5, 3), |image, _| turn(90.0, &image));
        assert_eq!(four, numbers(5, 3));
        let back = turn(270.0, &turn(90.0, &numbers(4, 7)));
        assert_eq!(back, numbers(4, 7));
    }

    #[test]
    fn an_angle_near_a_quarter_turn_gives_nearly_that() {
        let image = numbers(41, 31);
        let (exact, near) = (turn(90.0, &image), turn(90.0 + 1e-6, &image));
        // One pixel larger, since it sticks out by a hair; its middle is moved by half of one.
        assert_eq!((near.width, near.height), (exact.width + 1, exact.height + 1));
        let mean = |x: usize, y: usize| {
            (exact.values[y * 31 + x] + exact.values[(y - 1) * 31 + x - 1]) / 2.0
        };
        assert!((near.values[20 * 32 + 15] - mean(15, 20)).abs() < 0.01);
    }

    #[test]
    fn a_plane_stays_a_plane() {
        let values =
            (0..60 * 50).map(|k| 0.01 * (k % 60) as f32 - 0.02 * (k / 60) as f32).collect();
        let turned = turn(30.0, &GrayImage { width: 60, height: 50, values });
        let pixel = |x: usize, y: usize| turned.values[y * turned.width + x];
        let (x, y) = (turned.width / 2, turned.height / 2);
        // A counterclockwise turn of the slopes (0.01, -0.02 downwards).
        let (sin, cos) = 30.0f32.to_radians().sin_cos();
        let (right, down) = (0.01 * cos - 0.02 * sin, -0.01 * sin - 0.02 * cos);
        for (dx, dy) in [(1, 0), (0, 1), (5, 9)] {
            let step = pixel(x + dx, y + dy) - pixel(x, y);
            assert!((step - (dx as f32 * right + dy as f32 * down)).abs() < 1e-5);
        }
    }

    #[test]
    fn a_dot_and_a_line_can_be_turned() {
        assert_eq!(turn(45.0, &numbers(1, 1)).width, 2);
        assert!(turn(10.0, &numbers(1, 9)).values.iter().all(|value| value.is_finite()));
    }
}

//! A mask of what has a certain colour.
//!
//! Two colours differ by the greatest difference of their channels, as a share of the range from
//! black to white; a gray picture's three channels are the same. Transparency is not looked at. From
//! a seed, the colour is the seed's, and what is selected hangs together with it: a flood fill over
//! the four neighbours of each pixel, each compared to the seed and not to its neighbour, so that a
//! smooth run of colours does not carry the fill away. The mask's edge is crisp.

use super::pixels::Pixels;
use crate::values::{Image, Mask};
use carvegraph_core::{Choice, Conflict, Context, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;

/// Pixels that a fill visits between two looks at the cancel token.
const BATCH: usize = 1 << 16;

/// Selects pixels by their colour: everywhere, or as far as they hang together with one.
#[derive(Clone, Debug, Params)]
pub(crate) struct ColorMask {
    /// Where it selects.
    #[param(default = Reach::Everywhere)]
    pub(crate) reach: Reach,
    /// The colour looked for everywhere, as #rrggbb.
    #[param(default = "#ffffff")]
    pub(crate) color: String,
    /// The pixel that a fill begins at, as column,row; 0,0 is the upper left one.
    #[param(default = "0,0")]
    pub(crate) seed: String,
    /// How much a channel may differ: 0 takes the very colour only, 1 all.
    #[param(default = 0.1, range = 0.0..=1.0)]
    pub(crate) tolerance: f64,
}

/// Where pixels are selected.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Reach {
    /// Wherever the colour is near `color`.
    Everywhere,
    /// What hangs together with the seed and is near its colour.
    FromSeed,
}

#[derive(Inputs)]
pub(crate) struct Colored<'a> {
    /// The picture.
    image: &'a Image,
}

#[derive(Outputs)]
pub(crate) struct Found {
    /// What has the colour.
    mask: Mask,
}

impl Node for ColorMask {
    const KIND: &'static str = "color_mask";
    type Inputs<'a> = Colored<'a>;
    type Outputs = Found;

    fn check(&self) -> Result<(), Conflict> {
        read_color(&self.color).map_err(|message| Conflict { param: "color", message })?;
        read_seed(&self.seed).map_err(|message| Conflict { param: "seed", message })?;
        Ok(())
    }

    fn run(&self, inputs: Colored<'_>, cx: &Context<'_>) -> Result<Found, NodeError> {
        let image = inputs.image;
        let (width, height) = (image.width, image.height);
        let pixels = Pixels::new(image);
        let near = |at: usize, color: [f32; 3]| {
            let differs = |(a, b): (f32, f32)| f64::from((a - b).abs()) > self.tolerance + LAST_BIT;
            !pixels.at(at).into_iter().zip(color).any(differs)
        };
        let values = match self.reach {
            Reach::Everywhere => {
                let color = read_color(&self.color).map_err(NodeError::failed)?;
                let all = (0..width * height).into_par_iter();
                all.map(|at| if near(at, color) { 1.0 } else { 0.0 }).collect()
            }
            Reach::FromSeed => {
                let (x, y) = read_seed(&self.seed).map_err(NodeError::failed)?;
                if x >= width || y >= height {
                    return Err(NodeError::Failed(format!(
                        "seed {x},{y} lies outside of the picture of {width} × {height} px"
                    )));
                }
                let color = pixels.at(y * width + x);
                let ticker = cx.ticker(width * height);
                let filled =
                    fill((width, height), y * width + x, |at| near(at, color), |n| ticker.tick(n));
                cx.completed(filled)?
            }
        };
        Ok(Found { mask: Mask { width, height, values } })
    }
}

/// Levels of 8 bits are no round shares: a difference of exactly the tolerance is one within it.
const LAST_BIT: f64 = 1e-6;

/// What hangs together with `seed` among the pixels that fit. `None` if `tick` says stop.
fn fill(
    (width, height): (usize, usize),
    seed: usize,
    fits: impl Fn(usize) -> bool,
    tick: impl Fn(usize) -> bool,
) -> Option<Vec<f32>> {
    let mut values = vec![0.0; width * height];
    values[seed] = 1.0;
    let mut open = vec![seed];
    let mut visited = 0;
    while let Some(at) = open.pop() {
        let (x, y) = (at % width, at / width);
        let neighbours = [
            (x > 0).then(|| at - 1),
            (x + 1 < width).then(|| at + 1),
            (y > 0).then(|| at - width),
            (y + 1 < height).then(|| at + width),
        ];
        for next in neighbours.into_iter().flatten() {
            if values[next] == 0.0 && fits(next) {
                values[next] = 1.0;
                open.push(next);
            }
        }
        visited += 1;
        if visited % BATCH == 0 && !tick(BATCH) {
            return None;
        }
    }
    Some(values)
}

fn read_color(text: &str) -> Result<[f32; 3], String> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii());
    let channel = |k: usize| u8::from_str_radix(digits?.get(2 * k..2 * k + 2)?, 16).ok();
    match [channel(0), channel(1), channel(2)] {
        [Some(red), Some(green), Some(blue)] if !text.contains('+') => {
            Ok([red, green, blue].map(|level| f32::from(level) / 255.0))
        }
        _ => Err(format!("{text:?} is no colour: write it as #ff8000, red, green and blue")),
    }
}

fn read_seed(text: &str) -> Result<(usize, usize), String> {
    let place = text.split_once(',');
    let place = place.and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    place.ok_or_else(|| format!("{text:?} is no pixel: write it as column,row, such as 120,80"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use crate::values::{Channels, Samples};

    fn node(reach: Reach, color: &str, seed: &str, tolerance: f64) -> ColorMask {
        ColorMask { reach, color: color.to_owned(), seed: seed.to_owned(), tolerance }
    }

    fn select(node: &ColorMask, image: &Image) -> Result<Vec<f32>, String> {
        node.check().unwrap();
        let found = run(|cx| node.run(Colored { image }, cx));
        found.map(|found| found.mask.values).map_err(|fault| fault.to_string())
    }

    fn gray(width: usize, levels: &[u8]) -> Image {
        let samples = Samples::U8(levels.to_vec());
        Image { width, height: levels.len() / width, channels: Channels::Gray, samples }
    }

    #[test]
    fn the_channel_that_differs_most_decides() {
        let samples = Samples::U8(vec![255, 128, 0, 255, 138, 0, 255, 128, 11, 245, 118, 10]);
        let image = Image { width: 4, height: 1, channels: Channels::Rgb, samples };
        let near = node(Reach::Everywhere, "#ff8000", "0,0", 10.0 / 255.0);
        assert_eq!(select(&near, &image).unwrap(), [1.0, 1.0, 0.0, 1.0]);
        let exact = node(Reach::Everywhere, "#FF8000", "0,0", 0.0);
        assert_eq!(select(&exact, &image).unwrap(), [1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn a_fill_stops_at_what_differs_and_does_not_leap() {
        #[rustfmt::skip]
        let image = gray(5, &[
            10, 10, 90, 10, 10,
            10, 90, 10, 10, 90,
            10, 10, 90, 90, 12,
        ]);
        #[rustfmt::skip]
        let left = [
            1., 1., 0., 0., 0.,
            1., 0., 0., 0., 0.,
            1., 1., 0., 0., 0.,
        ];
        assert_eq!(select(&node(Reach::FromSeed, "#ffffff", "0,2", 0.05), &image).unwrap(), left);
        assert_eq!(
            select(&node(Reach::FromSeed, "#ffffff", "4, 2", 1.0), &image).unwrap(),
            [1.0; 15]
        );
    }

    #[test]
    fn a_smooth_run_does_not_carry_the_fill_away() {
        let ramp: Vec<u8> = (0..100).collect();
        let found =
            select(&node(Reach::FromSeed, "#ffffff", "0,0", 20.0 / 255.0), &gray(100, &ramp));
        assert_eq!(found.unwrap().iter().sum::<f32>(), 21.0);
    }

    #[test]
    fn what_is_no_colour_or_pixel_is_told() {
        let fault = |color: &str, seed: &str| {
            node(Reach::Everywhere, color, seed, 0.0).check().unwrap_err().message
        };
        assert_eq!(
            fault("red", "0,0"),
            "\"red\" is no colour: write it as #ff8000, red, green and blue"
        );
        for color in ["#ff80", "#ff80zz", "#+f8000", "#é0000", "ff8000"] {
            assert!(fault(color, "0,0").contains("is no colour"), "{color}");
        }
        assert_eq!(
            fault("#000000", "3;4"),
            "\"3;4\" is no pixel: write it as column,row, such as 120,80"
        );
        let outside = select(&node(Reach::FromSeed, "#000000", "3,0", 0.0), &gray(3, &[0; 6]));
        assert_eq!(outside.unwrap_err(), "seed 3,0 lies outside of the picture of 3 × 2 px");
    }

    /// What hangs together with the seed, found by going over all pixels until nothing changes.
    fn hanging_together(width: usize, levels: &[u8], seed: usize, tolerance: u8) -> Vec<f32> {
        let mut found = vec![0.0; levels.len()];
        found[seed] = 1.0;
        loop {
            let before = found.clone();
            for at in 0..levels.len() {
                let beside = |other: usize| {
                    let apart =
                        |k: fn(usize, usize) -> usize| k(at, width).abs_diff(k(other, width));
                    apart(|at, width| at % width) + apart(|at, width| at / width) == 1
                };
                let reached = (0..levels.len()).any(|other| found[other] == 1.0 && beside(other));
                if reached && levels[at].abs_diff(levels[seed]) <= tolerance {
                    found[at] = 1.0;
                }
            }
            if found == before {
                return found;
            }
        }
    }

    #[test]
    fn a_fill_finds_what_a_slow_search_finds() {
        let mut random = fastrand::Rng::with_seed(3);
        for (width, height) in [(1, 1), (1, 19), (19, 1), (9, 13)] {
            for _ in 0..20 {
                let levels: Vec<u8> = (0..width * height).map(|_| random.u8(0..40)).collect();
                let seed = random.usize(..levels.len());
                let place = format!("{},{}", seed % width, seed / width);
                let node = node(Reach::FromSeed, "#ffffff", &place, 25.0 / 255.0);
                let wanted = hanging_together(width, &levels, seed, 25);
                assert_eq!(select(&node, &gray(width, &levels)).unwrap(), wanted);
            }
        }
    }

    #[test]
    fn transparency_is_not_looked_at_and_16_bits_are() {
        let near = node(Reach::Everywhere, "#808080", "0,0", 0.0);
        let samples = Samples::U8(vec![128, 0, 129, 255, 128, 255]);
        let image = Image { width: 1, height: 3, channels: Channels::GrayAlpha, samples };
        assert_eq!(select(&near, &image).unwrap(), [1.0, 0.0, 1.0]);
        let samples = Samples::U16(vec![128 * 257, 128 * 257 + 1]);
        let image = Image { width: 2, height: 1, channels: Channels::Gray, samples };
        assert_eq!(select(&near, &image).unwrap(), [1.0, 0.0]);
    }
}

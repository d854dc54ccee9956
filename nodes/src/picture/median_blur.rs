//! Median of a gray picture.
//!
//! Each pixel becomes the median of the k × k pixels around it; beyond the border the edge pixel is
//! repeated, as OpenCV's `medianBlur` does. The window slides along a row while a histogram of it is
//! kept (T. Huang, G. Yang, G. Tang, *A Fast Two-Dimensional Median Filtering Algorithm*, IEEE Trans.
//! ASSP 27, 1979): 2k pixels change at each step, and the median is followed from where it was. The
//! picture's range is divided into 65,536 levels; the result is a level's value, so that for pictures
//! of 8 or 16 bits it is the median to within rounding, and for others to 1/131,070 of the range.

use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;

/// Levels that are told apart.
const LEVELS: usize = 1 << 16;
/// Levels that are counted together besides, so that a far median is found in few steps.
const GROUP: usize = 1 << 8;
/// Rows that share one histogram; emptying it costs less than one of them.
const BAND_ROWS: usize = 32;

/// Takes out specks and keeps edges where they are.
#[derive(Clone, Debug, Params)]
pub(crate) struct MedianBlur {
    /// Width of the window; 1 leaves the picture as it is.
    #[param(unit = "px", default = 3, range = 1..=99, odd)]
    pub(crate) kernel: u32,
}

#[derive(Inputs)]
pub(crate) struct Specked<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Clean {
    /// The picture without specks.
    image: GrayImage,
}

impl Node for MedianBlur {
    const KIND: &'static str = "median_blur";
    type Inputs<'a> = Specked<'a>;
    type Outputs = Clean;

    fn run(&self, inputs: Specked<'_>, cx: &Context<'_>) -> Result<Clean, NodeError> {
        let image = inputs.image;
        let pixels = image.values.par_iter().map(|value| (*value, *value));
        let (dark, bright) = pixels
            .reduce(|| (f32::INFINITY, f32::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        if self.kernel == 1 || dark == bright {
            return Ok(Clean { image: image.clone() });
        }
        let (low, range) = (f64::from(dark), f64::from(bright) - f64::from(dark));
        let top = (LEVELS - 1) as f64;
        let level = |value: &f32| ((f64::from(*value) - low) / range * top).round() as u16;
        let levels: Vec<u16> = image.values.par_iter().map(level).collect();
        let window = Window { levels: &levels, image, reach: self.kernel as usize / 2 };
        let ticker = cx.ticker(image.height);
        let mut values = vec![0.0; levels.len()];
        let bands = values.par_chunks_mut(BAND_ROWS * image.width).enumerate();
        let done = bands.try_for_each(|(band, out)| {
            let mut histogram = Histogram::new();
            for (row, out) in out.chunks_exact_mut(image.width).enumerate() {
                window.slide(band * BAND_ROWS + row, &mut histogram, |x, median| {
                    out[x] = (low + f64::from(median) / top * range) as f32;
                });
                if !ticker.tick(1) {
                    return None;
                }
            }
            Some(())
        });
        cx.completed(done)?;
        Ok(Clean { image: GrayImage { width: image.width, height: image.height, values } })
    }
}

/// The pixels that a median is taken of.
struct Window<'a> {
    levels: &'a [u16],
    image: &'a GrayImage,
    reach: usize,
}

impl Window<'_> {
    /// Calls `found` with the median around every pixel of row `y`. The histogram is empty before and
    /// after.
    fn slide(&self, y: usize, histogram: &mut Histogram, mut found: impl FnMut(usize, u16)) {
        let reach = self.reach as isize;
        let hold = |i: isize, count: usize| i.clamp(0, count as isize - 1) as usize;
        let rows: Vec<usize> = (-reach..=reach)
            .map(|by| hold(y as isize + by, self.image.height) * self.image.width)
            .collect();
        let column = |x: isize| {
            let x = hold(x, self.image.width);
            rows.iter().map(move |row| self.levels[row + x])
        };
        let half = rows.len() * rows.len() / 2;
        (-reach..reach).for_each(|x| column(x).for_each(|level| histogram.add(level)));
        for x in 0..self.image.width as isize {
            column(x + reach).for_each(|level| histogram.add(level));
            found(x as usize, histogram.median(half));
            column(x - reach).for_each(|level| histogram.remove(level));
        }
        let last = self.image.width as isize;
        (last - reach..last + reach)
            .for_each(|x| column(x).for_each(|level| histogram.remove(level)));
    }
}

/// How often each level occurs, and how many pixels lie below the last median. The widest window
/// holds 9801 pixels, and small counts stay in the nearest caches.
struct Histogram {
    counts: Vec<u16>,
    groups: Vec<u16>,
    median: usize,
    below: usize,
}

impl Histogram {
    fn new() -> Self {
        Self { counts: vec![0; LEVELS], groups: vec![0; LEVELS / GROUP], median: 0, below: 0 }
    }

    fn add(&mut self, level: u16) {
        let level = usize::from(level);
        self.counts[level] += 1;
        self.groups[level / GROUP] += 1;
        self.below += usize::from(level < self.median);
    }

    fn remove(&mut self, level: u16) {
        let level = usize::from(level);
        self.counts[level] -= 1;
        self.groups[level / GROUP] -= 1;
        self.below -= usize::from(level < self.median);
    }

    /// The level that has `half` of the pixels below it or at it and before it.
    fn median(&mut self, half: usize) -> u16 {
        while self.below > half {
            if self.median.is_multiple_of(GROUP)
                && self.below - self.group(self.median / GROUP - 1) > half
            {
                self.below -= self.group(self.median / GROUP - 1);
                self.median -= GROUP;
            } else {
                self.median -= 1;
                self.below -= self.counts[self.median] as usize;
            }
        }
        while self.below + self.counts[self.median] as usize <= half {
            if self.median.is_multiple_of(GROUP)
                && self.below + self.group(self.median / GROUP) <= half
            {
                self.below += self.group(self.median / GROUP);
                self.median += GROUP;
            } else {
                self.below += self.counts[self.median] as usize;
                self.median += 1;
            }
        }
        self.median as u16
    }

    fn group(&self, group: usize) -> usize {
        self.groups[group] as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn blur(kernel: u32, width: usize, values: &[f32]) -> Vec<f32> {
        let image = GrayImage { width, height: values.len() / width, values: values.to_vec() };
        run(|cx| MedianBlur { kernel }.run(Specked { image: &image }, cx)).unwrap().image.values
    }

    fn brute(kernel: u32, width: usize, values: &[f32]) -> Vec<f32> {
        let (height, reach) = (values.len() / width, kernel as isize / 2);
        let at = |x: isize, y: isize| {
            values[y.clamp(0, height as isize - 1) as usize * width
                + x.clamp(0, width as isize - 1) as usize]
        };
        let median = |k: usize| {
            let (x, y) = ((k % width) as isize, (k / width) as isize);
            let window = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)));
            let mut all: Vec<f32> = window.map(|(dx, dy)| at(x + dx, y + dy)).collect();
            all.sort_by(f32::total_cmp);
            all[all.len() / 2]
        };
        (0..values.len()).map(median).collect()
    }

    #[test]
    fn medians_are_those_of_sorting_every_window() {
        let mut random = fastrand::Rng::with_seed(3);
        for (width, height, kernel) in [(17, 70, 3), (1, 40, 5), (40, 1, 5), (9, 8, 7), (3, 2, 21)]
        {
            let values: Vec<f32> =
                (0..width * height).map(|_| f32::from(random.u16(..)) / 65535.0).collect();
            let found = blur(kernel, width, &values);
            let near =
                found.iter().zip(brute(kernel, width, &values)).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(near, "{width} × {height}, {kernel}");
        }
    }

    #[test]
    fn specks_go_and_edges_stay() {
        let mut values = vec![0.0; 90];
        (0..90).filter(|k| k % 10 >= 5).for_each(|k| values[k] = 1.0);
        let clean = values.clone();
        (values[22], values[67]) = (1.0, 0.0);
        assert_eq!(blur(3, 10, &values), clean);
    }

    #[test]
    fn kernel_1_is_identity() {
        assert_eq!(blur(1, 3, &[0.3, 0.1, 0.2]), [0.3, 0.1, 0.2]);
        assert_eq!(blur(5, 3, &[0.3; 6]), [0.3; 6]);
    }
}

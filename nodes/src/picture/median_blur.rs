//! Median of a gray picture.
//!
//! Each pixel becomes the median of the k × k pixels around it; beyond the border the edge pixel is
//! repeated, as OpenCV's `medianBlur` does. The result is exact for any values.
//!
//! Up to k = 5, windows are gone through eight at once: one pixel more than half of a window is taken. The
//! least and the greatest of these cannot be the median and are dropped, another pixel is taken, and so
//! on until three are left (A. Paeth, *Median Finding on a 3 × 3 Grid*, Graphics Gems, 1990, for any k).
//!
//! Beyond, the picture is gone through in tiles of at most 2¹⁶ pixels, overhang included. These are
//! sorted, so that each has a rank of its own in the tile; a window is the set of its ranks, one bit
//! each. It slides to and fro over the tile: 2k ranks change at each step, and the median is found by
//! counting bits (T. Huang, G. Yang, G. Tang, *A Fast Two-Dimensional Median Filtering Algorithm*, IEEE
//! Trans. ASSP 27, 1979, with ranks in place of gray levels).

use super::rows::{by_bands, by_rows};
use crate::values::GrayImage;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use std::array::from_fn;
use wide::f32x8;

/// Windows that are gone through at once.
const LANES: usize = 8;
/// Side of a tile with its overhang: ranks within fit 16 bits.
const TILE: usize = 1 << 8;
/// Ranks that are counted together, so that a far median is found in few steps.
const GROUP: usize = 1 << 8;
const WORD: usize = u64::BITS as usize;

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
    const VERSION: u32 = 2;
    type Inputs<'a> = Specked<'a>;
    type Outputs = Clean;

    fn run(&self, inputs: Specked<'_>, cx: &Context<'_>) -> Result<Clean, NodeError> {
        let image = match self.kernel {
            1 => inputs.image.clone(),
            3 => small::<3, 9>(inputs.image, cx, median_of_9)?,
            5 => small::<5, 25>(inputs.image, cx, median_of_25)?,
            kernel => large(inputs.image, kernel as usize, cx)?,
        };
        Ok(Clean { image })
    }
}

/// The index of the `i`th of a line that is repeated `reach` times beyond both ends.
fn hold(i: usize, reach: usize, count: usize) -> usize {
    i.saturating_sub(reach).min(count - 1)
}

/// Medians of `SIDE` × `SIDE` = `COUNT` pixels.
fn small<const SIDE: usize, const COUNT: usize>(
    image: &GrayImage,
    cx: &Context<'_>,
    median: impl Fn([f32x8; COUNT]) -> f32x8 + Sync,
) -> Result<GrayImage, NodeError> {
    let (width, height, reach) = (image.width, image.height, SIDE / 2);
    // To the right as far as the last pixels that are gone through at once.
    let padded = width.next_multiple_of(LANES) + 2 * reach;
    by_rows((width, height), cx, |y, out| {
        let line = |k: usize| {
            let row = &image.values[hold(y + k, reach, height) * width..][..width];
            let mut line = vec![row[width - 1]; padded];
            line[..reach].fill(row[0]);
            line[reach..reach + width].copy_from_slice(row);
            line
        };
        let lines: [Vec<f32>; SIDE] = from_fn(line);
        for (k, out) in out.chunks_mut(LANES).enumerate() {
            let pixels = |i: usize| f32x8::from(&lines[i / SIDE][k * LANES + i % SIDE..][..LANES]);
            out.copy_from_slice(&median(from_fn(pixels)).to_array()[..out.len()]);
        }
    })
}

/// The medians of eight windows, the `i`th pixel of each in `window[i]`.
fn median_of_9(mut window: [f32x8; 9]) -> f32x8 {
    drop_extremes::<6, 9>(&mut window);
    drop_extremes::<5, 9>(&mut window);
    drop_extremes::<4, 9>(&mut window);
    drop_extremes::<3, 9>(&mut window);
    window[1]
}

/// The same of larger windows.
fn median_of_25(mut window: [f32x8; 25]) -> f32x8 {
    drop_extremes::<14, 25>(&mut window);
    drop_extremes::<13, 25>(&mut window);
    drop_extremes::<12, 25>(&mut window);
    drop_extremes::<11, 25>(&mut window);
    drop_extremes::<10, 25>(&mut window);
    drop_extremes::<9, 25>(&mut window);
    drop_extremes::<8, 25>(&mut window);
    drop_extremes::<7, 25>(&mut window);
    drop_extremes::<6, 25>(&mut window);
    drop_extremes::<5, 25>(&mut window);
    drop_extremes::<4, 25>(&mut window);
    drop_extremes::<3, 25>(&mut window);
    window[1]
}

/// Puts the least of the first `TAKEN` pixels first and the greatest last among them, then the next
/// pixel in place of the least, so that one fewer are taken. `TAKEN` begins at one more than half of all
/// `COUNT` and is known to the compiler, so that pixels stay in registers.
#[inline(always)]
fn drop_extremes<const TAKEN: usize, const COUNT: usize>(window: &mut [f32x8; COUNT]) {
    let mut exchange = |first: usize, second: usize| {
        let (a, b) = (window[first], window[second]);
        (window[first], window[second]) = (a.fast_min(b), a.fast_max(b));
    };
    for i in 0..TAKEN / 2 {
        exchange(i, TAKEN - 1 - i);
    }
    for i in 1..TAKEN.div_ceil(2) {
        exchange(0, i);
        exchange(TAKEN - 1 - i, TAKEN - 1);
    }
    if TAKEN > 3 {
        window[0] = window[COUNT + 3 - TAKEN];
    }
}

/// Medians of `side` × `side` pixels.
fn large(image: &GrayImage, side: usize, cx: &Context<'_>) -> Result<GrayImage, NodeError> {
    let (width, height) = (image.width, image.height);
    let inner = TILE + 1 - side;
    by_bands((width, height), inner, cx, |top, band| {
        let rows = band.len() / width;
        let mut window = Window::new();
        for left in (0..width).step_by(inner) {
            if cx.is_cancelled() {
                return;
            }
            let columns = inner.min(width - left);
            let tile = Tile::new(image, (left, top), (columns, rows), side);
            window.slide(&tile, |x, y, median| band[y * width + left + x] = median);
        }
    })
}

/// A part of a picture, with the overhang of the windows around its pixels.
struct Tile {
    columns: usize,
    rows: usize,
    side: usize,
    /// Row by row, overhang included.
    ranks: Vec<u16>,
    /// The value of each rank.
    values: Vec<f32>,
}

impl Tile {
    fn new(
        image: &GrayImage,
        (left, top): (usize, usize),
        (columns, rows): (usize, usize),
        side: usize,
    ) -> Self {
        let (wide, high) = (columns + side - 1, rows + side - 1);
        let pixels = (0..high).flat_map(|y| {
            let row = &image.values[hold(top + y, side / 2, image.height) * image.width..];
            (0..wide).map(move |x| row[hold(left + x, side / 2, image.width)])
        });
        let values: Vec<f32> = pixels.collect();
        let mut order: Vec<u64> = values
            .iter()
            .zip(0..)
            .map(|(value, at)| u64::from(ordered(*value)) << 16 | at)
            .collect();
        order.sort_unstable();
        let mut ranks = vec![0; values.len()];
        let at = |key: &u64| (key & 0xffff) as usize;
        order.iter().enumerate().for_each(|(rank, key)| ranks[at(key)] = rank as u16);
        let values = order.iter().map(|key| values[at(key)]).collect();
        Self { columns, rows, side, ranks, values }
    }

    fn rank(&self, x: usize, y: usize) -> usize {
        usize::from(self.ranks[y * (self.columns + self.side - 1) + x])
    }
}

/// A whole number that is ordered as the value is.
fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    if value.is_sign_negative() { !bits } else { bits | 1 << 31 }
}

/// A set of ranks.
struct Window {
    /// One bit for each rank.
    words: Vec<u64>,
    /// Ranks in each group.
    groups: Vec<u16>,
    /// The group in which the last median was, and how many ranks lie in the groups before.
    group: usize,
    before: usize,
}

impl Window {
    fn new() -> Self {
        let ranks = TILE * TILE;
        Self { words: vec![0; ranks / WORD], groups: vec![0; ranks / GROUP], group: 0, before: 0 }
    }

    /// Calls `found` with the median around each pixel of a tile. The set is empty before and after.
    fn slide(&mut self, tile: &Tile, mut found: impl FnMut(usize, usize, f32)) {
        let (side, last) = (tile.side, tile.columns - 1);
        let half = side * side / 2;
        for y in 0..side {
            (0..side).for_each(|x| self.add(tile.rank(x, y)));
        }
        for y in 0..tile.rows {
            let to_the_right = y % 2 == 0;
            for k in 0..=last {
                let x = if to_the_right { k } else { last - k };
                // The columns that leave and come as the window moves by one.
                let change =
                    if to_the_right { (x.wrapping_sub(1), x + side - 1) } else { (x + side, x) };
                if k > 0 {
                    (y..y + side).for_each(|y| self.remove(tile.rank(change.0, y)));
                    (y..y + side).for_each(|y| self.add(tile.rank(change.1, y)));
                } else if y > 0 {
                    (x..x + side).for_each(|x| self.remove(tile.rank(x, y - 1)));
                    (x..x + side).for_each(|x| self.add(tile.rank(x, y + side - 1)));
                }
                found(x, y, tile.values[self.nth(half)]);
            }
        }
        self.clear();
    }

    fn add(&mut self, rank: usize) {
        self.words[rank / WORD] |= 1 << (rank % WORD);
        self.groups[rank / GROUP] += 1;
        self.before += usize::from(rank / GROUP < self.group);
    }

    fn remove(&mut self, rank: usize) {
        self.words[rank / WORD] &= !(1 << (rank % WORD));
        self.groups[rank / GROUP] -= 1;
        self.before -= usize::from(rank / GROUP < self.group);
    }

    fn clear(&mut self) {
        self.words.fill(0);
        self.groups.fill(0);
        (self.group, self.before) = (0, 0);
    }

    /// The rank that has `count` others of the set before it.
    fn nth(&mut self, count: usize) -> usize {
        while self.before > count {
            self.group -= 1;
            self.before -= usize::from(self.groups[self.group]);
        }
        while self.before + usize::from(self.groups[self.group]) <= count {
            self.before += usize::from(self.groups[self.group]);
            self.group += 1;
        }
        let mut left = count - self.before;
        let mut at = self.group * GROUP / WORD;
        loop {
            let ones = self.words[at].count_ones() as usize;
            if left < ones {
                break;
            }
            left -= ones;
            at += 1;
        }
        let word = (0..left).fold(self.words[at], |word, _| word & (word - 1));
        at * WORD + word.trailing_zeros() as usize
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
        let sizes = [(17, 70), (1, 40), (40, 1), (9, 8), (3, 2), (1, 1), (300, 270)];
        for (width, height) in sizes {
            for kernel in [3, 5, 7, 11, 21] {
                // Few levels, and values of any size and sign; the large picture is for windows of 7 px.
                for levels in [3, u32::MAX] {
                    if width == 300 && kernel != 7 {
                        continue;
                    }
                    let mut value = |_| random.u32(..levels) as f32 - 1e9;
                    let values: Vec<f32> = (0..width * height).map(&mut value).collect();
                    let found = blur(kernel, width, &values);
                    assert_eq!(
                        found,
                        brute(kernel, width, &values),
                        "{width} × {height}, {kernel}"
                    );
                }
            }
        }
    }

    #[test]
    fn medians_are_those_of_opencv() {
        // cv2.medianBlur of OpenCV 5.0.0, windows of 5 and 7 px.
        let picture = |count: usize| -> Vec<f32> {
            (0..count).map(|k| ((k * k * 7 + k * 13) % 97) as f32).collect()
        };
        #[rustfmt::skip]
        let five = [
             5., 13., 20., 46., 46., 46., 46., 24., 24., 44., 46., 46., 44., 44., 32., 46., 46., 46.,
            46., 46., 46., 46., 49., 49., 49., 49., 49., 53., 32., 49., 49., 49., 49., 49., 53.,
        ];
        assert_eq!(blur(5, 7, &picture(35)), five);
        #[rustfmt::skip]
        let seven = [
             5., 20., 25., 39., 46., 46., 46., 46., 46., 22., 32., 34., 46., 46., 46., 46., 46., 46.,
            22., 34., 46., 49., 52., 52., 49., 49., 46., 34., 53., 52., 53., 54., 53., 52., 52., 46.,
            54., 58., 56., 58., 59., 59., 59., 52., 29., 65., 65., 59., 59., 59., 59., 59., 56., 56.,
            65., 65., 56., 52., 56., 56., 56., 56., 56., 68., 65., 65., 52., 52., 56., 56., 56., 56.,
            73., 68., 59., 49., 49., 56., 56., 56., 56.,
        ];
        assert_eq!(blur(7, 9, &picture(81)), seven);
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

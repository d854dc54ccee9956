//! Thin anti-aliased lines on a picture, many at a time.
//!
//! Two kinds. **Threads** carry a tone from 0 to 1: coverages and tones of all threads on a pixel
//! are summed, so a pixel crossed by several takes their mean tone, and a pixel brushed by one takes
//! as little of it as is covered; any order gives the same picture. **Inks** have a colour of their
//! own and lie over everything, in the order given.
//!
//! The picture is cut into bands of rows; each band is drawn on its own by going through the strokes
//! that touch it, in order, so the result doesn't depend on the number of threads.
//!
//! Limits: coverage is taken from the distance of the pixel's middle, exact to a few percent; a
//! thread's ends are cut square, so a sharp bend leaves a notch less than a line's width.

use super::color::{Linear, mix};
use super::resample::BANDS;
use std::ops::Range;

/// A place in the picture, in pixels from its upper left corner.
pub(super) type Place = [f32; 2];

/// A straight piece of a line that carries a tone.
#[derive(Clone, Copy)]
pub(super) struct Thread {
    pub(super) ends: [Place; 2],
    /// Half the width, in pixels.
    pub(super) half_width: f32,
    /// From 0 to 1.
    pub(super) tone: f32,
    /// How much of the pixels below is hidden where fully covered, 0 to 1.
    pub(super) strength: f32,
}

/// A straight piece of a line with round ends; a dot if both ends are the same place.
#[derive(Clone, Copy)]
pub(super) struct Ink {
    pub(super) ends: [Place; 2],
    /// Half the width, in pixels.
    pub(super) half_width: f32,
    pub(super) color: Linear,
    /// 0 clear … 1 opaque.
    pub(super) opacity: f32,
}

/// A run of whole rows of a picture.
pub(super) struct Band {
    pub(super) width: usize,
    pub(super) rows: Range<usize>,
}

/// Something drawn along a straight line.
pub(super) trait Stroke {
    /// Both ends and half the width.
    fn line(&self) -> ([Place; 2], f32);
}

impl Stroke for Thread {
    fn line(&self) -> ([Place; 2], f32) {
        (self.ends, self.half_width)
    }
}

impl Stroke for Ink {
    fn line(&self) -> ([Place; 2], f32) {
        (self.ends, self.half_width)
    }
}

/// For each of the [`BANDS`] bands of a picture of `height` rows, which strokes touch it, in order.
pub(super) fn by_band<S: Stroke>(strokes: &[S], height: usize) -> Vec<Vec<u32>> {
    let mut lists = vec![Vec::new(); BANDS];
    let band_of = |row: usize| ((row + 1) * BANDS - 1) / height;
    for (index, stroke) in strokes.iter().enumerate() {
        let ([a, b], half_width) = stroke.line();
        let reach = half_width + 1.0;
        let (top, bottom) = (a[1].min(b[1]) - reach, a[1].max(b[1]) + reach);
        if bottom >= 0.0 && top < height as f32 {
            let rows = (top.max(0.0) as usize, (bottom as usize).min(height - 1));
            for list in &mut lists[band_of(rows.0)..=band_of(rows.1)] {
                list.push(index as u32);
            }
        }
    }
    lists
}

impl Band {
    /// Adds a thread to `sums`: coverage, and coverage times tone, of every pixel.
    pub(super) fn add_thread(&self, thread: &Thread, sums: &mut [[f32; 2]]) {
        let [a, b] = thread.ends;
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy);
        if length == 0.0 {
            return;
        }
        let (ux, uy) = (dx / length, dy / length);
        self.each_pixel(thread, |pixel, place| {
            let (px, py) = (place[0] - a[0], place[1] - a[1]);
            // Half open: of two pieces that meet, just one takes the pixel between them.
            let along = px * ux + py * uy;
            if (0.0..length).contains(&along) {
                let cover = cover(thread.half_width, (px * uy - py * ux).abs()) * thread.strength;
                sums[pixel][0] += cover;
                sums[pixel][1] += cover * thread.tone;
            }
        });
    }

    /// Lays an ink over the colours.
    pub(super) fn lay_ink(&self, ink: &Ink, colors: &mut [Linear]) {
        let [a, b] = ink.ends;
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let square = (dx * dx + dy * dy).max(f32::MIN_POSITIVE);
        self.each_pixel(ink, |pixel, place| {
            let (px, py) = (place[0] - a[0], place[1] - a[1]);
            let along = ((px * dx + py * dy) / square).clamp(0.0, 1.0);
            let cover = cover(ink.half_width, (px - along * dx).hypot(py - along * dy));
            if cover > 0.0 {
                colors[pixel] = mix(colors[pixel], ink.color, cover * ink.opacity);
            }
        });
    }

    /// Calls `draw` with the index in the band and the middle of every pixel near the stroke.
    fn each_pixel(&self, stroke: &impl Stroke, mut draw: impl FnMut(usize, Place)) {
        let ([a, b], half_width) = stroke.line();
        let reach = half_width + 1.0;
        let top = (a[1].min(b[1]) - reach).max(self.rows.start as f32) as usize;
        let bottom = (a[1].max(b[1]) + reach).min(self.rows.end as f32) as usize;
        for y in top..bottom.saturating_add(1).min(self.rows.end) {
            let Some(columns) = self.columns(a, b, reach, y as f32 + 0.5) else { continue };
            for x in columns {
                draw((y - self.rows.start) * self.width + x, [x as f32 + 0.5, y as f32 + 0.5]);
            }
        }
    }

    /// The columns within `reach` of the line from `a` to `b` on the row whose middle is at `y`.
    fn columns(&self, a: Place, b: Place, reach: f32, y: f32) -> Option<Range<usize>> {
        let (mut low, mut high) = (a[0].min(b[0]) - reach, a[0].max(b[0]) + reach);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        // A steep or slanting line fills little of its box: keep to it.
        if dy.abs() > reach {
            let middle = a[0] + (y - a[1]) * dx / dy;
            let half = reach * dx.hypot(dy) / dy.abs();
            (low, high) = (low.max(middle - half), high.min(middle + half));
        }
        let (low, high) = (low.max(0.0), high.min(self.width as f32));
        (low < high).then(|| low as usize..(high.ceil() as usize).min(self.width))
    }
}

/// Share of a pixel that a line covers whose axis is `distance` from the pixel's middle.
fn cover(half_width: f32, distance: f32) -> f32 {
    (half_width + 0.5 - distance).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thread(a: Place, b: Place) -> Thread {
        Thread { ends: [a, b], half_width: 0.75, tone: 0.5, strength: 1.0 }
    }

    fn sums(threads: &[Thread]) -> Vec<[f32; 2]> {
        let band = Band { width: 64, rows: 0..64 };
        let mut sums = vec![[0.0; 2]; 64 * 64];
        for thread in threads {
            band.add_thread(thread, &mut sums);
        }
        sums
    }

    #[test]
    fn coverage_is_length_times_width() {
        for end in [[50.0, 30.3], [12.2, 55.0], [44.0, 51.0], [41.0, 9.5]] {
            let line = thread([10.3, 20.1], end);
            let length = (end[0] - 10.3).hypot(end[1] - 20.1);
            let covered: f32 = sums(&[line]).iter().map(|s| s[0]).sum();
            assert!((covered / (length * 1.5) - 1.0).abs() < 0.06, "{covered} of {}", length * 1.5);
        }
    }

    #[test]
    fn a_line_cut_in_two_covers_the_same() {
        let whole = sums(&[thread([5.0, 5.0], [45.0, 25.0])]);
        let cut = sums(&[thread([5.0, 5.0], [21.0, 13.0]), thread([21.0, 13.0], [45.0, 25.0])]);
        assert!(whole.iter().zip(&cut).all(|(a, b)| (a[0] - b[0]).abs() < 1e-3));
    }

    #[test]
    fn bands_hold_the_strokes_that_touch_them() {
        let lists = by_band(&[thread([0.0, 1.0], [9.0, 1.0]), thread([3.0, 0.0], [3.0, 64.0])], 64);
        assert_eq!(lists[0], [0, 1]);
        assert_eq!(lists[BANDS - 1], [1]);
    }
}

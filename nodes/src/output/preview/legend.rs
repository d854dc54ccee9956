//! The legend of a picture: a scale in mm, and what the marks mean.
//!
//! Letters are drawn as strokes, like those of a plotter, so they need no font and stay sharp at
//! every size.

use super::color::Linear;
use super::strokes::{Ink, Place, Thread};

/// Room for the legend below the picture, in its units (1/1200 of the picture's longest side).
pub(super) const HEIGHT_UNITS: f32 = 74.0;
/// Height of a digit, in units: legible when the picture is shown at half its size.
const TEXT_UNITS: f32 = 13.0;
/// Most labels on the scale.
const MAX_LABELS: f64 = 7.0;

/// What a mark means, and the inks it is drawn with.
pub(super) struct Entry {
    pub(super) name: &'static str,
    /// Draws the mark about a place, given the length of a unit in pixels.
    pub(super) draw: fn(Place, f32, &mut Vec<Ink>),
}

/// Strokes of the whole legend in the box from `left` to `right` px, its top at `top` px.
pub(super) fn draw(
    (left, right, top): (f32, f32, f32),
    unit: f32,
    heights_mm: Option<(f64, f64)>,
    entries: &[Entry],
    text_color: Linear,
) -> (Vec<Thread>, Vec<Ink>) {
    let pen = Pen { size: TEXT_UNITS * unit, color: text_color };
    let mut inks = Vec::new();
    let key_left = draw_entries(right, top + 26.0 * unit, unit, entries, &pen, &mut inks);
    let bar_right = (key_left - 60.0 * unit).max(left + 100.0 * unit);
    let threads = heights_mm.map_or_else(Vec::new, |heights| {
        draw_scale((left, bar_right, top + 20.0 * unit), unit, heights, &pen, &mut inks)
    });
    (threads, inks)
}

/// Marks with their names, in a row that ends at `right`; returns where the row begins.
fn draw_entries(
    right: f32,
    middle: f32,
    unit: f32,
    entries: &[Entry],
    pen: &Pen,
    inks: &mut Vec<Ink>,
) -> f32 {
    let mut x = right;
    for entry in entries.iter().rev() {
        x -= pen.width(entry.name);
        pen.write(entry.name, [x, middle - pen.size / 2.0], inks);
        x -= 24.0 * unit;
        (entry.draw)([x, middle], unit, inks);
        x -= 36.0 * unit;
    }
    x
}

/// The bar of tones with its labels.
fn draw_scale(
    (left, right, top): (f32, f32, f32),
    unit: f32,
    (low_mm, high_mm): (f64, f64),
    pen: &Pen,
    inks: &mut Vec<Ink>,
) -> Vec<Thread> {
    let steps = ((right - left) / unit).max(2.0) as usize;
    let x_at = |share: f32| left + (right - left) * share;
    let middle = top + 6.0 * unit;
    let threads = (0..steps).map(|i| {
        let share = |i: usize| i as f32 / steps as f32;
        Thread {
            ends: [[x_at(share(i)), middle], [x_at(share(i + 1)), middle]],
            half_width: 6.0 * unit,
            tone: (i as f32 + 0.5) / steps as f32,
            strength: 1.0,
        }
    });
    let below = top + 12.0 * unit;
    for (value_mm, label) in labels(low_mm, high_mm) {
        let span = high_mm - low_mm;
        let share = if span > 0.0 { (value_mm - low_mm) / span } else { 0.5 };
        let x = x_at(share as f32);
        pen.line([x, below], [x, below + 5.0 * unit], inks);
        pen.write(&label, [x - pen.width(&label) / 2.0, below + 10.0 * unit], inks);
    }
    pen.write("mm", [right + 10.0 * unit, middle - pen.size / 2.0], inks);
    threads.collect()
}

/// Round values between `low` and `high` with their text; just one if both are the same.
fn labels(low: f64, high: f64) -> Vec<(f64, String)> {
    let span = high - low;
    if span <= 0.0 {
        return vec![(low, format!("{low:.2}"))];
    }
    let power = (span / MAX_LABELS).log10().ceil();
    let round = 10_f64.powf(power);
    let step = [0.2, 0.5, 1.0].map(|f| f * round).into_iter().find(|s| span / s <= MAX_LABELS);
    let step = step.unwrap_or(round);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let first = (low / step - 1e-9).ceil();
    (0..=MAX_LABELS as usize)
        .map(|k| (first + k as f64) * step)
        .take_while(|value| *value <= high + step * 1e-9)
        // Adding 0 turns -0 into 0.
        .map(|value| (value, format!("{:.decimals$}", value + 0.0)))
        .collect()
}

/// Writes in strokes.
struct Pen {
    /// Height of a digit, in pixels.
    size: f32,
    color: Linear,
}

impl Pen {
    fn line(&self, a: Place, b: Place, inks: &mut Vec<Ink>) {
        let half_width = (self.size * 0.058).max(0.45);
        inks.push(Ink { ends: [a, b], half_width, color: self.color, opacity: 1.0 });
    }

    /// Width of a text, in pixels.
    fn width(&self, text: &str) -> f32 {
        text.chars().map(advance).sum::<f32>() * self.size / 6.0
    }

    /// Writes `text` with its upper left corner at `corner`.
    fn write(&self, text: &str, corner: Place, inks: &mut Vec<Ink>) {
        let scale = self.size / 6.0;
        let mut x = corner[0];
        for letter in text.chars() {
            for stroke in strokes(letter).split(' ').filter(|s| !s.is_empty()) {
                let at = |pair: &[u8]| {
                    let grid = |digit: u8| f32::from(digit - b'0') * scale;
                    [x + grid(pair[0]), corner[1] + grid(pair[1])]
                };
                let points: Vec<Place> = stroke.as_bytes().chunks_exact(2).map(at).collect();
                for pair in points.windows(2) {
                    self.line(pair[0], pair[1], inks);
                }
            }
            x += advance(letter) * scale;
        }
    }
}

/// Steps from a letter to the next, in sixths of a digit's height.
fn advance(letter: char) -> f32 {
    match letter {
        '.' | 'i' | 'l' => 2.5,
        _ => 5.6,
    }
}

/// Strokes of a letter: lines of points, each two digits, to the right and down, on a grid where
/// a digit is 4 wide and 6 high.
fn strokes(letter: char) -> &'static str {
    match letter {
        '0' => "103041453616050110",
        '1' => "112026",
        '2' => "01103041420646",
        '3' => "0110304142334445361605 1333",
        '4' => "300444 3036",
        '5' => "400002324345361605",
        '6' => "30100105163645443303",
        '7' => "004016",
        '8' => "103041423313020110 1304051636454433",
        '9' => "16364541301001021343",
        '-' => "0333",
        '.' => "0506",
        'a' => "4246 4332120305163645",
        'c' => "4332120305163645",
        'd' => "4046 4332120305163645",
        'e' => "04444332120305163645",
        'g' => "42473818 4332120305163645",
        'i' => "0206 0000",
        'l' => "0006",
        'm' => "0206 03122326 23324346",
        'n' => "0206 0312324346",
        'o' => "123243453616050312",
        'p' => "0208 0312324345361605",
        'r' => "0206 041232",
        's' => "421203143445 453606",
        't' => "1015263645 0232",
        'u' => "0205163645 4246",
        'x' => "0246 4206",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(low: f64, high: f64) -> Vec<String> {
        labels(low, high).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn labels_are_round_and_inside() {
        assert_eq!(texts(0.0, 5.0), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(texts(-0.31, 0.32), ["-0.3", "-0.2", "-0.1", "0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(texts(12.0, 98.0), ["20", "40", "60", "80"]);
        assert_eq!(texts(2.5, 2.5), ["2.50"]);
    }

    #[test]
    fn every_letter_of_a_label_can_be_drawn() {
        for letter in "0123456789.-mmrapidplungestartendgougeexcess".chars() {
            assert!(!strokes(letter).is_empty(), "{letter}");
        }
    }
}

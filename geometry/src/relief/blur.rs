//! A Gaussian mean of values that are not known everywhere.
//!
//! Values and weights are blurred alike and divided, so that what has no weight counts for nothing
//! (*normalized convolution*: Knutsson and Westin, CVPR 1993). The Gaussian is three running means
//! one after the other (Wells, *Efficient synthesis of Gaussian filters by cascaded uniform filters*,
//! IEEE PAMI 8, 1986), which take the same time for every width. Three means over w values have the
//! variance 3·(w² - 1)/12; w is the odd number that comes nearest, so σ is met within half a pixel.

use rayon::prelude::*;

/// Running means one after the other; their convolution is within 3 % of a Gaussian.
const PASSES: usize = 3;

/// Rows that are turned into columns at a time, so that each piece of cache serves some of them.
const BAND: usize = 16;

/// The mean around each value, row by row, `width` of them a row; a row beyond the border has no
/// weight. 0 where there is no weight within reach.
pub(super) fn mean(values: &[f32], weights: &[f32], width: usize, sigma: f64) -> Vec<f32> {
    let radius = radius(sigma);
    let weighted = values.par_iter().zip(weights).map(|(v, w)| v * w).collect();
    let [sums, shares] =
        [weighted, weights.to_vec()].map(|grid| blurred_both_ways(grid, width, radius));
    let ratio = |(sum, share): (&f32, &f32)| if *share > 1e-6 { sum / share } else { 0.0 };
    sums.par_iter().zip(&shares).map(ratio).collect()
}

/// Values on either side that a running mean takes in.
fn radius(sigma: f64) -> usize {
    let width = (12.0 * sigma * sigma / PASSES as f64 + 1.0).sqrt();
    ((width - 1.0) / 2.0).round() as usize
}

fn blurred_both_ways(mut grid: Vec<f32>, width: usize, radius: usize) -> Vec<f32> {
    let height = grid.len() / width;
    blur_rows(&mut grid, width, radius);
    let mut turned = transposed(&grid, width);
    blur_rows(&mut turned, height, radius);
    transposed(&turned, height)
}

fn blur_rows(grid: &mut [f32], width: usize, radius: usize) {
    grid.par_chunks_exact_mut(width).for_each_init(
        || vec![0.0; width],
        |scratch, row| {
            for _ in 0..PASSES {
                scratch.copy_from_slice(row);
                running_mean(scratch, radius, row);
            }
        },
    );
}

/// The mean of the `2·radius + 1` values around each; those beyond the ends are 0.
fn running_mean(values: &[f32], radius: usize, means: &mut [f32]) {
    let share = 1.0 / (2 * radius + 1) as f64;
    let mut sum: f64 = values.iter().take(radius).map(|value| f64::from(*value)).sum();
    for (at, mean) in means.iter_mut().enumerate() {
        sum += values.get(at + radius).map_or(0.0, |value| f64::from(*value));
        *mean = (sum * share) as f32;
        sum -= at.checked_sub(radius).map_or(0.0, |first| f64::from(values[first]));
    }
}

fn transposed(grid: &[f32], width: usize) -> Vec<f32> {
    let height = grid.len() / width;
    let mut turned = vec![0.0; grid.len()];
    turned.par_chunks_mut(BAND * height).enumerate().for_each(|(band, columns)| {
        for (y, row) in grid.chunks_exact(width).enumerate() {
            for (column, value) in columns.chunks_exact_mut(height).zip(&row[band * BAND..]) {
                column[y] = *value;
            }
        }
    });
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_field_stays_even_to_its_border() {
        for (width, height) in [(1, 1), (1, 40), (33, 17), (40, 1)] {
            let found = mean(&vec![2.5; width * height], &vec![1.0; width * height], width, 3.0);
            assert!(found.iter().all(|value| (value - 2.5).abs() < 1e-5), "{width} × {height}");
        }
    }

    #[test]
    fn what_has_no_weight_does_not_count() {
        let weights = [1.0, 1.0, 0.0, 1.0, 1.0, 0.0];
        let found = mean(&[1.0, 1.0, 900.0, 1.0, 1.0, -7.0], &weights, 3, 1.0);
        assert!(found.iter().all(|value| (value - 1.0).abs() < 1e-5), "{found:?}");
    }

    #[test]
    fn a_dot_spreads_by_sigma_both_ways() {
        let (width, height, sigma) = (61, 51, 4.0);
        let mut dot = vec![0.0; width * height];
        dot[25 * width + 30] = 1.0;
        let found = mean(&dot, &vec![1.0; dot.len()], width, sigma);
        let moment = |power: fn(f64, f64) -> f64| -> f64 {
            let place = |at: usize| ((at % width) as f64 - 30.0, (at / width) as f64 - 25.0);
            let of = |at: usize| power(place(at).0, place(at).1) * f64::from(found[at]);
            (0..found.len()).map(of).sum()
        };
        assert!((moment(|_, _| 1.0) - 1.0).abs() < 1e-4);
        assert!(moment(|x, _| x).abs() < 1e-4 && moment(|_, y| y).abs() < 1e-4);
        for variance in [moment(|x, _| x * x), moment(|_, y| y * y)] {
            assert!((variance.sqrt() - sigma).abs() < 0.5, "{variance}");
        }
    }
}

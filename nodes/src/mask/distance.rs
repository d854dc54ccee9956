//! How far every pixel is from the nearest one of a set, exactly and in linear time.
//!
//! Method: A. Meijster, J. Roerdink, W. Hesselink, *A General Algorithm for Computing Distance
//! Transforms in Linear Time*, ISMM 2000. A first phase takes the distance g along each column; a
//! second finds, along each row, the lower envelope of the parabolas (x - i)² + g(i)². All of it is
//! in integers, so the distance is that between the middles of two pixels, rounded once, by the
//! last square root. Squares stay below 2⁶³ for sides below 2³¹.

use rayon::prelude::*;

/// Marks a column that holds no pixel of the set.
const NONE: u32 = u32::MAX;

/// The distance in pixels of each pixel's middle from that of the nearest pixel for which `is_in`
/// holds; infinite if there is none. `tick` is called for each row; `None` if it says stop.
pub(crate) fn distances(
    (width, height): (usize, usize),
    is_in: impl Fn(usize) -> bool + Sync,
    tick: impl Fn() -> bool + Sync,
) -> Option<Vec<f32>> {
    let columns = along_columns(width, height, is_in);
    let mut distances = vec![0.0; columns.len()];
    distances.par_chunks_exact_mut(width).zip(columns.par_chunks_exact(width)).try_for_each_init(
        Vec::new,
        |envelope, (out, row)| {
            along_row(row, envelope, out);
            tick().then_some(())
        },
    )?;
    Some(distances)
}

/// The distance of each pixel from the nearest one of the set above or below it.
fn along_columns(width: usize, height: usize, is_in: impl Fn(usize) -> bool + Sync) -> Vec<u32> {
    let mut nearest: Vec<u32> =
        (0..width * height).into_par_iter().map(|at| if is_in(at) { 0 } else { NONE }).collect();
    // One more than the neighbour's, and NONE stays NONE.
    let closer = |to: &mut u32, from: u32| *to = (*to).min(from.saturating_add(1));
    for y in 1..height {
        let (above, below) = nearest.split_at_mut(y * width);
        below[..width].iter_mut().zip(&above[(y - 1) * width..]).for_each(|(to, f)| closer(to, *f));
    }
    for y in (1..height).rev() {
        let (above, below) = nearest.split_at_mut(y * width);
        above[(y - 1) * width..].iter_mut().zip(&below[..width]).for_each(|(to, f)| closer(to, *f));
    }
    nearest
}

/// A parabola of the envelope: its column, and the first column where it is the lowest.
type Lowest = (usize, i64);

/// The second phase for one row. `envelope` is scratch space.
fn along_row(columns: &[u32], envelope: &mut Vec<Lowest>, out: &mut [f32]) {
    let squared = |i: usize| i64::from(columns[i]) * i64::from(columns[i]);
    let height = |x: i64, i: usize| (x - i as i64) * (x - i as i64) + squared(i);
    envelope.clear();
    for u in (0..columns.len()).filter(|u| columns[*u] != NONE) {
        while envelope.last().is_some_and(|(s, t)| height(*t, *s) > height(*t, u)) {
            envelope.pop();
        }
        let Some((s, _)) = envelope.last() else {
            envelope.push((u, 0));
            continue;
        };
        let (a, b) = (*s as i64, u as i64);
        let from = 1 + (b * b - a * a + squared(u) - squared(*s)).div_euclid(2 * (b - a));
        if from < columns.len() as i64 {
            envelope.push((u, from));
        }
    }
    for (x, out) in out.iter_mut().enumerate().rev() {
        while envelope.last().is_some_and(|(_, from)| *from > x as i64) {
            envelope.pop();
        }
        let nearest = envelope.last().map(|(s, _)| height(x as i64, *s));
        *out = nearest.map_or(f32::INFINITY, |square| (square as f64).sqrt() as f32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn brute(width: usize, set: &[bool]) -> Vec<f32> {
        let place = |at: usize| ((at % width) as f64, (at / width) as f64);
        let from = |at: usize| {
            let (x, y) = place(at);
            let all = (0..set.len()).filter(|other| set[*other]).map(place);
            all.map(|(a, b)| ((x - a).powi(2) + (y - b).powi(2)).sqrt())
                .fold(f64::INFINITY, f64::min) as f32
        };
        (0..set.len()).map(from).collect()
    }

    #[test]
    fn distances_are_those_of_trying_every_pixel() {
        let mut random = fastrand::Rng::with_seed(5);
        for (width, height) in [(1, 1), (1, 17), (23, 1), (2, 9), (31, 17), (8, 40)] {
            for share in [0.0, 0.02, 0.3, 1.0] {
                let set: Vec<bool> = (0..width * height).map(|_| random.f64() < share).collect();
                let found = distances((width, height), |at| set[at], || true).unwrap();
                assert_eq!(found, brute(width, &set), "{width} × {height}, {share}");
            }
        }
    }

    #[test]
    fn it_stops_when_told() {
        assert!(distances((4, 4), |at| at == 0, || false).is_none());
    }
}

//! Contour lines of a grid of values: marching squares.
//!
//! Each cell between four nodes is crossed by no line, one or two, by which of its corners lie at the
//! level or above (Lorensen and Cline 1987, in the plane). A line crosses the side of a cell where the
//! value, taken to be linear along the side, is the level. Where two opposite corners are above and two
//! below, the mean of the four decides whether those above are joined.
//!
//! What is above lies to the left of a line, so that outlines turn counter-clockwise and holes
//! clockwise. Beyond the grid everything is below: an area that reaches the border is closed along it.
//!
//! Limits: an area without extent, such as one node that lies just at the level, has no line.

use glam::DVec2;

/// The sides of a cell, counter-clockwise from the lower one, as steps to the cell beyond.
const BEYOND: [(isize, isize); 4] = [(0, -1), (1, 0), (0, 1), (-1, 0)];

/// The corners of a cell, counter-clockwise from the lower left. Side k leads from corner k to the next.
const CORNERS: [(usize, usize); 4] = [(0, 0), (1, 0), (1, 1), (0, 1)];

/// The closed lines around all places of a grid where the value is `level` or more. Coordinates are in
/// columns and rows; the last corner of a line is joined to its first.
///
/// The order is that of the first cell of each line, row by row.
#[must_use]
pub fn contour_lines(
    columns: usize,
    rows: usize,
    value: impl Fn(usize, usize) -> f64,
    level: f64,
) -> Vec<Vec<DVec2>> {
    let cells = Cells { columns, rows, value, level };
    // A rim of nodes that are below surrounds the grid.
    let (across, down) = (columns + 1, rows + 1);
    let mut begun = vec![0_u8; across * down];
    let mut lines = Vec::new();
    for j in 0..down {
        for i in 0..across {
            let inside = cells.inside(i, j);
            if inside == 0 || inside == 0b1111 {
                continue;
            }
            for side in 0..4 {
                if begins(inside, side) && begun[j * across + i] & (1 << side) == 0 {
                    let line = cells.follow((i, j), side, &mut begun);
                    lines.extend(Some(line).filter(|line| line.len() >= 3));
                }
            }
        }
    }
    lines
}

/// Whether a line enters a cell through a side: along it, counter-clockwise, one goes from above to below.
fn begins(inside: u8, side: usize) -> bool {
    inside & (1 << side) != 0 && inside & (1 << ((side + 1) % 4)) == 0
}

/// The cells of a grid with its rim: cell (i, j) has node (i - 1, j - 1) of the grid as its first corner.
struct Cells<V> {
    columns: usize,
    rows: usize,
    value: V,
    level: f64,
}

impl<V: Fn(usize, usize) -> f64> Cells<V> {
    /// The value of a node of the rimmed grid, which on the rim is below everything.
    fn at(&self, i: usize, j: usize) -> f64 {
        let within = (1..=self.columns).contains(&i) && (1..=self.rows).contains(&j);
        if within { (self.value)(i - 1, j - 1) } else { f64::NEG_INFINITY }
    }

    /// Which corners of a cell are at the level or above, as bits.
    fn inside(&self, i: usize, j: usize) -> u8 {
        CORNERS.iter().enumerate().fold(0, |bits, (k, (right, up))| {
            bits | u8::from(self.at(i + right, j + up) >= self.level) << k
        })
    }

    /// The side through which a line leaves that entered through `side`.
    fn leaves(&self, (i, j): (usize, usize), side: usize) -> usize {
        let inside = self.inside(i, j);
        if inside != 0b0101 && inside != 0b1010 {
            // From below to above, counter-clockwise: the mirror of where it begins.
            return (0..4).find(|k| begins(!inside & 0b1111, *k)).unwrap_or(side);
        }
        let sum: f64 = CORNERS.iter().map(|(right, up)| self.at(i + right, j + up)).sum();
        let joined = sum / 4.0 >= self.level;
        // Around the corner below that the side leads to, or around the one above that it comes from.
        (side + if joined { 1 } else { 3 }) % 4
    }

    /// Where a line crosses a side of a cell, in the grid's own coordinates.
    fn crossing(&self, (i, j): (usize, usize), side: usize) -> DVec2 {
        let [mut a, mut b] = [side, (side + 1) % 4].map(|k| (i + CORNERS[k].0, j + CORNERS[k].1));
        // The same arithmetic from both sides of a side.
        if b < a {
            (a, b) = (b, a);
        }
        let [low, high] = [a, b].map(|(i, j)| self.at(i, j));
        let [from, to] = [a, b].map(|(i, j)| DVec2::new(i as f64 - 1.0, j as f64 - 1.0));
        if low == f64::NEG_INFINITY {
            return to;
        }
        if high == f64::NEG_INFINITY {
            return from;
        }
        // Exact on the side's own axis, so that no corner leaves the border by a rounding.
        from + (to - from) * ((self.level - low) / (high - low))
    }

    /// The line that enters a cell through a side, all the way around.
    fn follow(&self, start: (usize, usize), side: usize, begun: &mut [u8]) -> Vec<DVec2> {
        let (mut cell, mut entered) = (start, side);
        let mut line: Vec<DVec2> = Vec::new();
        loop {
            begun[cell.1 * (self.columns + 1) + cell.0] |= 1 << entered;
            let corner = self.crossing(cell, entered);
            if line.last() != Some(&corner) {
                line.push(corner);
            }
            let left = self.leaves(cell, entered);
            let (right, up) = BEYOND[left];
            // Lines stay within the rim: its outer sides lie below everything.
            cell = (cell.0.wrapping_add_signed(right), cell.1.wrapping_add_signed(up));
            entered = (left + 2) % 4;
            if (cell, entered) == (start, side) {
                break;
            }
        }
        if line.len() > 1 && line.first() == line.last() {
            line.pop();
        }
        line
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;

    /// The lines of a picture of digits, row 0 first.
    fn lines(rows: &[&str], level: f64) -> Vec<Vec<DVec2>> {
        let value = |i: usize, j: usize| f64::from(rows[j].as_bytes()[i] - b'0');
        contour_lines(rows[0].len(), rows.len(), value, level)
    }

    /// Twice the area within a line, above 0 if it turns counter-clockwise.
    fn twice_area(line: &[DVec2]) -> f64 {
        let next = line.iter().cycle().skip(1);
        line.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum()
    }

    /// Whether a place is within an odd number of lines.
    fn is_within(lines: &[Vec<DVec2>], place: DVec2) -> bool {
        let sides = lines.iter().flat_map(|line| {
            let next = line.iter().cycle().skip(1);
            line.iter().zip(next)
        });
        let crossed = sides.filter(|(a, b)| {
            (a.y <= place.y) != (b.y <= place.y)
                && place.x < a.x + (place.y - a.y) / (b.y - a.y) * (b.x - a.x)
        });
        crossed.count() % 2 == 1
    }

    #[test]
    fn a_peak_has_a_diamond_around_it() {
        let peak = lines(&["000", "040", "000"], 1.0);
        let corners = [(1.0, 0.25), (1.75, 1.0), (1.0, 1.75), (0.25, 1.0)].map(DVec2::from);
        assert_eq!(peak.len(), 1);
        let first = peak[0].iter().position(|corner| *corner == corners[0]).unwrap();
        let mut turned = peak[0].clone();
        turned.rotate_left(first);
        assert_eq!(turned, corners);
    }

    #[test]
    fn outlines_turn_one_way_and_holes_the_other() {
        let ring = lines(&["00000", "02220", "02020", "02220", "00000"], 1.0);
        let mut areas: Vec<f64> = ring.iter().map(|line| twice_area(line) / 2.0).collect();
        areas.sort_by(f64::total_cmp);
        // A square of 3 whose corners are cut, less the diamond around its middle.
        assert_eq!(areas, [-0.5, 8.5]);
    }

    #[test]
    fn an_area_at_the_border_is_closed_along_it() {
        let all = lines(&["11", "11"], 1.0);
        assert_eq!((all.len(), twice_area(&all[0])), (1, 2.0));
        let half = lines(&["20", "20", "20"], 1.0);
        assert_eq!((half.len(), twice_area(&half[0])), (1, 2.0));
        assert!(half[0].iter().all(|corner| (0.0..=0.5).contains(&corner.x)));
        assert!(lines(&["00", "00"], 1.0).is_empty());
    }

    #[test]
    fn the_mean_says_whether_opposite_corners_are_joined() {
        let saddle = |level: f64| {
            let found = lines(&["0000", "0300", "0030", "0000"], level);
            found.iter().map(|line| twice_area(line)).filter(|area| *area > 0.0).count()
        };
        // The mean of the middle cell is 1.5.
        assert_eq!((saddle(1.4), saddle(1.6)), (1, 2));
    }

    #[test]
    fn what_has_no_extent_has_no_line() {
        assert!(lines(&["000", "010", "000"], 1.0).is_empty());
    }

    #[test]
    fn lines_keep_nodes_above_apart_from_those_below() {
        let mut random = Rng::with_seed(7);
        for _ in 0..200 {
            let (columns, rows) = (random.usize(1..12), random.usize(1..12));
            let values: Vec<f64> = (0..columns * rows).map(|_| random.f64()).collect();
            let level = random.f64();
            let value = |i: usize, j: usize| values[j * columns + i];
            let found = contour_lines(columns, rows, value, level);
            for j in 0..rows {
                for i in 0..columns {
                    // On the border a node lies on its line: one looks a little inside of it.
                    if i == 0 || j == 0 || i + 1 == columns || j + 1 == rows {
                        continue;
                    }
                    let place = DVec2::new(i as f64, j as f64);
                    let above = value(i, j) >= level;
                    assert_eq!(is_within(&found, place), above, "{place} {level} {values:?}");
                }
            }
            let corners = found.iter().flatten();
            let (most_x, most_y) = (columns as f64 - 1.0, rows as f64 - 1.0);
            assert!(
                corners
                    .clone()
                    .all(|c| (0.0..=most_x).contains(&c.x) && (0.0..=most_y).contains(&c.y))
            );
        }
    }
}

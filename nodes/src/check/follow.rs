//! Whether a program follows the path that was meant.
//!
//! Both are taken as chains of cuts, a new one behind each rapid, and chains are compared one by one: walking
//! along both at once, no corner of either may be farther from the other than a tolerance. How a chain
//! is divided into moves does not count, nor which of them are arcs.

use carvegraph_geometry::{DVec3, Motion, MoveKind};

/// Arcs are compared as chords so near to them, in mm: a program's last decimal.
const CHORD_MM: f64 = 1e-3;

/// Cuts without a rapid between them.
struct Chain {
    /// Its corners, in mm.
    points: Vec<DVec3>,
    /// The move, by its number among all, that leads to each corner.
    moves: Vec<usize>,
}

impl Chain {
    fn is_longer_than(&self, length_mm: f64) -> bool {
        self.points.iter().any(|point| point.distance(self.points[0]) > length_mm)
    }
}

/// Where a program leaves the path that was meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Departure {
    /// The program's move that does, by its number among all.
    pub(super) number: usize,
    /// How far it goes, in mm; nothing where a cut is missing or is one too many.
    pub(super) by_mm: Option<f64>,
}

/// How far, in mm, `read` is from `meant` at most.
///
/// # Errors
/// If that is more than `tolerance_mm`, or there are more cuts or fewer.
pub(super) fn follows<'m>(
    meant: impl Iterator<Item = &'m Motion>,
    read: impl Iterator<Item = &'m Motion>,
    tolerance_mm: f64,
) -> Result<f64, Departure> {
    let (meant, read) = (chains(meant, tolerance_mm), chains(read, tolerance_mm));
    let mut worst = 0.0_f64;
    for (meant, read) in meant.iter().zip(&read) {
        worst = worst.max(along(meant, read, tolerance_mm)?);
    }
    if meant.len() == read.len() {
        return Ok(worst);
    }
    let more = read.get(meant.len()).or(read.last());
    let number = more.and_then(|chain| chain.moves.last().copied()).unwrap_or_default();
    Err(Departure { number, by_mm: None })
}

/// The chains that are longer than `least_mm`.
fn chains<'m>(motions: impl Iterator<Item = &'m Motion>, least_mm: f64) -> Vec<Chain> {
    let mut chains: Vec<Chain> = Vec::new();
    let mut number = 0;
    for motion in motions {
        let mut open = false;
        for (from, moved) in motion.legs() {
            let cuts = moved.kind != MoveKind::Rapid;
            if cuts && !open {
                chains.push(Chain { points: vec![from], moves: vec![number] });
            }
            open = cuts;
            if let Some(chain) = chains.last_mut().filter(|_| cuts) {
                match motion.arc(moved) {
                    Some(arc) => chain.points.extend(arc.chords(from, moved.to, CHORD_MM)),
                    None => chain.points.push(moved.to),
                }
                chain.moves.resize(chain.points.len(), number);
            }
            number += 1;
        }
    }
    chains.retain(|chain| chain.is_longer_than(least_mm));
    chains
}

/// Walks along two chains at once; answers how far they are apart at most.
fn along(meant: &Chain, read: &Chain, tolerance_mm: f64) -> Result<f64, Departure> {
    let mut worst = 0.0_f64;
    // The place on the meant chain that was reached: a segment, and the share of it.
    let (mut segment, mut share) = (0, 0.0);
    let mut before = read.points[0];
    for (k, &point) in read.points.iter().enumerate() {
        let departs = |by_mm: f64| Departure { number: read.moves[k], by_mm: Some(by_mm) };
        loop {
            let [a, b] = [meant.points[segment], meant.points[segment + 1]];
            let (distance, at) = nearest(a, b, point, share);
            // Farther on the program passes the corner between.
            let (passed, _) = nearest(before, point, b, 0.0);
            let next = meant.points.get(segment + 2).filter(|_| passed <= tolerance_mm);
            let nearer = next.filter(|next| {
                distance > tolerance_mm || nearest(b, **next, point, 0.0).0 < distance
            });
            if nearer.is_some() {
                worst = worst.max(passed);
                (segment, share) = (segment + 1, 0.0);
            } else if distance <= tolerance_mm {
                worst = worst.max(distance);
                share = at;
                break;
            } else {
                let corner = if passed > tolerance_mm { passed } else { f64::INFINITY };
                return Err(departs(distance.min(corner)));
            }
        }
        before = point;
    }
    for point in &meant.points[segment + 1..] {
        let distance = point.distance(before);
        if distance > tolerance_mm {
            let number = read.moves[read.moves.len() - 1];
            return Err(Departure { number, by_mm: Some(distance) });
        }
        worst = worst.max(distance);
    }
    Ok(worst)
}

/// Distance of `point` from the part of the line from `a` to `b` that is at `least` share or farther on,
/// and the share of the place nearest to it.
fn nearest(a: DVec3, b: DVec3, point: DVec3, least: f64) -> (f64, f64) {
    let way = b - a;
    let length2 = way.length_squared();
    let share = if length2 > 0.0 { (point - a).dot(way) / length2 } else { 1.0 };
    let share = share.clamp(least, 1.0);
    (point.distance(a + way * share), share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_geometry::{Direction, Move, PathArc, Plane};

    const TOLERANCE: f64 = 0.01;

    /// A cut through these points, a rapid to those with true.
    fn motion(points: &[([f64; 3], bool)]) -> Motion {
        let moved = |&(to, rapid): &([f64; 3], bool)| Move {
            to: DVec3::from_array(to),
            mm_per_min: 100.0,
            kind: if rapid { MoveKind::Rapid } else { MoveKind::Line },
        };
        let start = DVec3::from_array(points[0].0);
        Motion { start, moves: points[1..].iter().map(moved).collect(), arcs: Vec::new() }
    }

    fn compare(meant: &Motion, read: &Motion) -> Result<f64, Departure> {
        follows([meant].into_iter(), [read].into_iter(), TOLERANCE)
    }

    /// Down, along a row of peaks and up again over the same place, thrice.
    fn there_and_back() -> Vec<([f64; 3], bool)> {
        let mut points = vec![([0.0, 0.0, 5.0], true)];
        for row in 0..3 {
            let y = f64::from(row);
            points.push(([0.0, y, 5.0], true));
            points.push(([0.0, y, 0.0], false));
            for k in 1..20 {
                points.push(([f64::from(k), y, f64::from(k * k % 7)], false));
            }
            points.push(([19.0, y, 5.0], true));
        }
        points
    }

    #[test]
    fn rounding_is_no_departure_and_points_in_line_may_go() {
        let points = there_and_back();
        let mut read = points.clone();
        read.iter_mut().for_each(|(p, _)| p[2] += 0.004);
        let worst = compare(&motion(&points), &motion(&read)).unwrap();
        assert!((worst - 0.004).abs() < 1e-9, "{worst}");
        let straight = |count: i32| {
            let along =
                (0..=count).map(|k| ([10.0 * f64::from(k) / f64::from(count), 0.0, 0.0], false));
            motion(&along.collect::<Vec<_>>())
        };
        for (a, b) in [(1, 50), (50, 1), (7, 9)] {
            assert!(compare(&straight(a), &straight(b)).unwrap() < 1e-9);
        }
    }

    #[test]
    fn one_lowered_point_is_found_with_its_move() {
        let points = there_and_back();
        let mut read = points.clone();
        read[8].0[2] -= 0.05;
        let departure = compare(&motion(&points), &motion(&read)).unwrap_err();
        assert_eq!(departure.number, 7);
        assert!(departure.by_mm.unwrap() > TOLERANCE && departure.by_mm.unwrap() < 0.06);
    }

    #[test]
    fn what_is_left_out_put_in_or_turned_round_is_found() {
        let points = there_and_back();
        for cut in [4, 12, 25, points.len() - 2] {
            let mut read = points.clone();
            read.remove(cut);
            assert!(compare(&motion(&points), &motion(&read)).is_err(), "{cut}");
            let mut read = points.clone();
            read.insert(cut, ([3.0, 9.0, 0.0], false));
            assert!(compare(&motion(&points), &motion(&read)).is_err(), "{cut}");
            let mut read = points.clone();
            read.swap(cut - 1, cut);
            assert!(compare(&motion(&points), &motion(&read)).is_err(), "{cut}");
        }
        let mut read = points.clone();
        read.truncate(points.len() - 23);
        assert_eq!(compare(&motion(&points), &motion(&read)).unwrap_err().by_mm, None);
    }

    #[test]
    fn a_place_that_is_passed_twice_is_not_passed_once() {
        let way = |turns: usize| {
            let x = (0..=turns).map(|k| ([10.0 * (k % 2) as f64, 0.0, 0.0], false));
            motion(&x.collect::<Vec<_>>())
        };
        assert_eq!(compare(&way(3), &way(3)), Ok(0.0));
        assert!(compare(&way(3), &way(1)).is_err());
        assert!(compare(&way(1), &way(3)).is_err());
    }

    #[test]
    fn an_arc_is_its_chords_and_the_other_way_round_is_not() {
        let (from, to) = (DVec3::new(5.0, 0.0, 0.0), DVec3::new(0.0, 5.0, 0.0));
        let turn = |direction| PathArc { plane: Plane::Xy, direction, center: DVec3::ZERO };
        let arc = |direction| Motion {
            start: from,
            moves: vec![Move { to, mm_per_min: 1.0, kind: MoveKind::Arc { arc: 0 } }],
            arcs: vec![turn(direction)],
        };
        let chords = turn(Direction::CounterClockwise).chords(from, to, 0.005);
        let line = |to| Move { to, mm_per_min: 1.0, kind: MoveKind::Line };
        let lines = Motion { start: from, moves: chords.map(line).collect(), arcs: Vec::new() };
        assert!(compare(&arc(Direction::CounterClockwise), &lines).unwrap() < 0.0051);
        assert!(compare(&lines, &arc(Direction::CounterClockwise)).is_ok());
        assert!(compare(&arc(Direction::CounterClockwise), &arc(Direction::Clockwise)).is_err());
    }
}

//! What a cutter leaves of a surface, and where that is worth a finer one (rest finishing).
//!
//! # What is left
//! A cutter that has been everywhere on a surface leaves the lowest of all its places above each point:
//!
//! ```text
//! left(x) = min over u of CL(u) + h(|x - u|)
//! ```
//!
//! CL(u) is the height of its tip at u (the drop cutter's) and h its profile. In the words of
//! mathematical morphology this is the closing of the surface by the cutter (Serra 1982, chapter XII).
//! With the sign turned it is a drop again, of the same profile on the field −CL:
//! left(x) = −max over u of (−CL(u) − h(|x − u|)). So one exact kernel serves twice, on the mesh for CL
//! and on the nodes for what is left.
//!
//! # Where it goes
//! The cutter's tip visits the nodes of the field, and nothing beyond: a raster covers the rectangle of
//! the part and no more, so that along the border more may be left than if the cutter had gone over it.
//! A real first pass, whose passes lie wider apart than the nodes, leaves its scallops besides. They are
//! left to the first pass on purpose and do not count.
//!
//! # Limits
//! Between nodes the tip would leave less. On a slope a tip that lies half a cell's diagonal beside the
//! best one leaves some pitch² / 4R more with a ball, and as much as the surface falls over a cell with
//! the edge of a flat end mill. The area is too large by that, never too small; thresholds below it find
//! all slopes.
//!
//! # The area
//! Contour lines of left − surface at a threshold ([`trace_level`]) or, where a margin is wanted, of
//! the distance to the nodes that reach the threshold, which is exact on the grid ([`distances`]). Lines
//! are simplified, and set out by as much as that, a cell's side for what lies between nodes included,
//! may take away: the area is never smaller than asked for.

use crate::{
    Against, DropCutter, HeightField, Pattern, PatternSpan, Polygon, PolygonError, Profile,
    Surface, Tick, TraceError, distances, simplify_loop, trace_level,
};
use glam::DVec2;
use rayon::prelude::*;

/// By how much simplified lines may leave the true ones, as a share of the pitch and of the margin. A
/// tenth leaves some ten corners on the circle around a point.
const SIMPLER: f64 = 0.1;

/// Nodes that the cutter is dropped at in one go: a place of a path takes 72 bytes, of which 4 are kept.
const NODES_AT_ONCE: usize = 1 << 20;

/// Where something is left, and how much.
#[derive(Clone, Debug, PartialEq)]
pub struct RestArea {
    /// All places that reach the threshold, grown by the margin.
    pub outline: Polygon,
    /// The share of the field's nodes that reach the threshold.
    pub share: f64,
    /// The share of the field's rectangle that lies within the outline.
    pub outlined: f64,
    /// The most that is left above a node, in mm.
    pub most_mm: f64,
}

/// Why there is no area.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum RestError {
    /// Nothing reaches the threshold.
    #[error("nothing above {threshold_mm} mm is left; the most is {most_mm:.4} mm")]
    Nothing {
        /// The threshold, in mm.
        threshold_mm: f64,
        /// The most that is left above a node, in mm.
        most_mm: f64,
    },
    /// The lines have more corners than an outline may have.
    #[error("the outline of what is left is too ragged: {0}")]
    Ragged(PolygonError),
    /// The lines are too many to be followed.
    #[error("the outline of what is left is too ragged: {0}")]
    TooLong(TraceError),
    /// The two fields are not over one grid.
    #[error("what is left and the surface have different grids")]
    OtherGrid,
    /// The tick said so.
    #[error("it was told to stop")]
    Stopped,
}

/// The surface that a cutter leaves of `field` where its tip has visited every node. It lies nowhere
/// below the field.
///
/// `tick` counts nodes, each twice. `None` if it stopped the work.
#[must_use]
pub fn leftover(field: &HeightField, profile: &Profile, tick: Tick) -> Option<HeightField> {
    let over = |heights: Vec<f32>| {
        HeightField::new(field.columns(), field.rows(), field.pitch_mm(), heights).ok()
    };
    let mut tips = tips_over_nodes(field, Against::Mesh, profile, tick)?;
    tips.par_iter_mut().for_each(|tip| *tip = -*tip);
    let mut left = tips_over_nodes(&over(tips)?, Against::Points, profile, tick)?;
    left.par_iter_mut().zip(field.heights()).for_each(|(left, height)| {
        // Rounding to f32 may have gone below.
        *left = (-*left).max(*height);
    });
    over(left)
}

/// The height of the tip, in mm, of a cutter lowered on a field at each of its nodes, row by row.
fn tips_over_nodes(
    field: &HeightField,
    against: Against,
    profile: &Profile,
    tick: Tick,
) -> Option<Vec<f32>> {
    let (columns, rows, pitch_mm) = (field.columns(), field.rows(), field.pitch_mm());
    let at_once = (NODES_AT_ONCE / columns).max(1);
    let cutter = DropCutter::new(Surface::Field(field, against), profile, 0.0, tick).ok()?;
    let mut heights = Vec::with_capacity(columns * rows);
    for start in (0..rows).step_by(at_once) {
        let row = |j: usize| {
            (0..columns).map(move |i| DVec2::new(i as f64 * pitch_mm, j as f64 * pitch_mm))
        };
        let points: Vec<DVec2> = (start..rows.min(start + at_once)).flat_map(row).collect();
        let spans = vec![PatternSpan { points: 0..points.len(), link: false, joined: false }];
        let pattern = Pattern { points, spans };
        // Under a node lies the node itself, so that something is touched everywhere.
        let path = cutter.path(&pattern, 0.0, tick)?;
        heights.extend(path.tips.iter().map(|tip| tip.z as f32));
    }
    Some(heights)
}

/// Where `left` stands `threshold_mm` or more above `surface`, grown by `margin_mm`.
///
/// `tick` counts nodes, each up to twice.
///
/// # Errors
/// If that is nowhere, the outline has too many corners, the grids differ, or the tick says stop.
pub fn rest_area(
    surface: &HeightField,
    left: &HeightField,
    threshold_mm: f64,
    margin_mm: f64,
    tick: Tick,
) -> Result<RestArea, RestError> {
    let (columns, rows, pitch_mm) = (surface.columns(), surface.rows(), surface.pitch_mm());
    if (left.columns(), left.rows(), left.pitch_mm()) != (columns, rows, pitch_mm) {
        return Err(RestError::OtherGrid);
    }
    let pairs = left.heights().par_iter().zip(surface.heights());
    let excesses: Vec<f32> = pairs.map(|(left, height)| left - height).collect();
    let most_mm = excesses.par_iter().map(|excess| f64::from(*excess)).reduce(|| 0.0, f64::max);
    let threshold = threshold_mm as f32;
    let count = excesses.par_iter().filter(|excess| **excess >= threshold).count();
    if count == 0 {
        return Err(RestError::Nothing { threshold_mm, most_mm });
    }
    // Without a margin nothing may be taken away, and lines stay as they are.
    let (values, level, tolerance) = if margin_mm > 0.0 {
        let tolerance = SIMPLER * (1.0 + margin_mm / pitch_mm);
        let reaches = |at: usize| excesses[at] >= threshold;
        let nearness = distances((columns, rows), reaches, &|rows| tick(rows * columns));
        let mut nearness = nearness.ok_or(RestError::Stopped)?;
        nearness.par_iter_mut().for_each(|distance| *distance = -*distance);
        (nearness, -(margin_mm / pitch_mm + 1.0 + tolerance) as f32, tolerance)
    } else {
        // Inside is what lies above, and what just reaches the threshold is to be.
        (excesses, threshold.next_down(), 0.0)
    };
    let lines = trace_level(columns, &values, level, &|rows| tick(rows * columns));
    let lines = lines.map_err(|fault| match fault {
        TraceError::Stopped => RestError::Stopped,
        TraceError::TooLong => RestError::TooLong(fault),
    })?;
    let simpler = |line: &Vec<DVec2>| -> Vec<DVec2> {
        simplify_loop(line, tolerance).into_iter().map(|corner| corner * pitch_mm).collect()
    };
    let loops = lines.par_iter().map(simpler).filter(|line| line.len() > 2);
    let loops: Vec<Vec<DVec2>> = loops.collect();
    // Nodes that just reach the threshold and stand alone have no extent.
    if loops.is_empty() {
        return Err(RestError::Nothing { threshold_mm, most_mm });
    }
    let size = surface.bounds().size();
    let outlined = area_mm2(&loops) / (size.x * size.y);
    let outline = Polygon::new(loops).map_err(RestError::Ragged)?;
    let share = count as f64 / (columns * rows) as f64;
    Ok(RestArea { outline, share, outlined, most_mm })
}

/// The area within closed lines that turn one way around it and the other way around holes.
fn area_mm2(loops: &[Vec<DVec2>]) -> f64 {
    let twice = |corners: &Vec<DVec2>| -> f64 {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum()
    };
    loops.iter().map(twice).sum::<f64>().abs() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Region;
    use fastrand::Rng;
    use std::f64::consts::SQRT_2;

    const GO: Tick = &|_| true;

    fn field(columns: usize, pitch_mm: f64, heights: Vec<f32>) -> HeightField {
        let rows = heights.len() / columns;
        HeightField::new(columns, rows, pitch_mm, heights).unwrap()
    }

    fn rough(random: &mut Rng) -> HeightField {
        let (columns, rows) = (random.usize(2..14), random.usize(2..14));
        let steep = [0.1, 1.0, 5.0][random.usize(..3)];
        let heights = (0..columns * rows).map(|_| (random.f64() * steep) as f32).collect();
        field(columns, 0.2 + random.f64(), heights)
    }

    fn cutters(radius: f64) -> [Profile; 4] {
        let cone = crate::Segment::Line { to: [radius, 1.5 * radius] };
        [
            Profile::ball(radius).unwrap(),
            Profile::flat(radius).unwrap(),
            Profile::bull_nose(radius, 0.3 * radius).unwrap(),
            Profile::new(vec![cone]).unwrap(),
        ]
    }

    /// All tips above all nodes, one by one.
    #[test]
    fn what_is_left_is_the_lowest_of_all_places_of_the_cutter() {
        let mut random = Rng::with_seed(11);
        for _ in 0..40 {
            let field = rough(&mut random);
            let radius = field.pitch_mm() * [0.7, 1.5, 3.3, 20.0][random.usize(..4)];
            for profile in cutters(radius) {
                let left = leftover(&field, &profile, GO).unwrap();
                let nodes =
                    || (0..field.rows()).flat_map(|j| (0..field.columns()).map(move |i| (i, j)));
                let tips: Vec<(DVec2, f64)> = nodes()
                    .map(|(i, j)| {
                        let at = field.point(i, j).truncate();
                        (at, crate::oracle::drop(&field, Against::Mesh, &profile, at))
                    })
                    .collect();
                for (i, j) in nodes() {
                    let at = field.point(i, j).truncate();
                    let above = tips.iter().map(|(tip, z)| z + profile.height(tip.distance(at)));
                    let lowest = above.fold(f64::INFINITY, f64::min);
                    let found = left.height(i, j);
                    // Tips and what is left are kept as f32; others than balls and flats to 1e-6.
                    assert!((found - lowest).abs() < 3e-6, "{found} {lowest} at {at}");
                    assert!(found >= field.height(i, j));
                }
            }
        }
    }

    #[test]
    fn a_cutter_leaves_nothing_of_its_own_shape_or_flatter() {
        let bowl = |radius: f64| {
            let height = |k: usize| {
                let (x, y) = ((k % 21) as f64 * 0.1 - 1.0, (k / 21) as f64 * 0.1 - 1.0);
                (radius - (radius * radius - x * x - y * y).sqrt()) as f32
            };
            field(21, 0.1, (0..441).map(height).collect())
        };
        let left = |radius: f64| {
            let bowl = bowl(radius);
            let left = leftover(&bowl, &Profile::ball(3.0).unwrap(), GO).unwrap();
            match rest_area(&bowl, &left, 1.0, 0.0, GO) {
                Err(RestError::Nothing { most_mm, .. }) => most_mm,
                other => panic!("{other:?}"),
            }
        };
        // Between two nodes, 0.07 mm from either, a ball of radius 3 stands 0.0008 mm off; twice that
        // where both the tip and the point looked at lie so.
        assert!(left(6.0) < 0.002 && left(3.0) < 0.002, "{} {}", left(6.0), left(3.0));
        assert!(left(2.0) > 0.02, "{}", left(2.0));
    }

    /// A groove of two walls at 45°, 2 deep: a ball of radius R stops R (√2 - 1) above its bottom, and
    /// touches the walls R / √2 beside it.
    #[test]
    fn a_ball_leaves_a_fillet_in_a_groove() {
        let (columns, pitch) = (201, 0.02);
        let wall = |k: usize| ((k % columns) as f64 * pitch - 2.0).abs() as f32;
        let groove = field(columns, pitch, (0..columns * 41).map(wall).collect());
        let radius = 1.0;
        let left = leftover(&groove, &Profile::ball(radius).unwrap(), GO).unwrap();
        let middle = left.height(100, 20);
        assert!((middle - radius * (SQRT_2 - 1.0)).abs() < 1e-6, "{middle}");
        let area = rest_area(&groove, &left, 0.001, 0.0, GO).unwrap();
        assert!((area.most_mm - middle).abs() < 1e-9);
        let reach = radius / SQRT_2;
        let widest = area.outline.loops().iter().flatten().map(|c| (c.x - 2.0).abs());
        let widest = widest.fold(0.0, f64::max);
        // Where the threshold is reached the ball is a little way off the wall.
        assert!(widest < reach && widest > reach - 0.06, "{widest} of {reach}");
        assert!((area.share - 2.0 * widest / 4.0).abs() < 0.02, "{}", area.share);
        assert!((area.outlined - 2.0 * widest / 4.0).abs() < 0.001, "{}", area.outlined);
    }

    #[test]
    fn a_level_plane_is_finished_up_to_its_border() {
        let plane = field(9, 0.5, vec![1.5; 81]);
        for profile in cutters(1.0) {
            assert_eq!(leftover(&plane, &profile, GO).unwrap(), plane);
        }
    }

    /// A flat end mill rests on its uphill rim. What lies less than its radius from the low border
    /// would be reached from beyond it only.
    #[test]
    fn on_a_slope_the_low_border_stays_uncut() {
        let slope = field(9, 0.5, (0..81).map(|k| (k % 9) as f32 * 0.1).collect());
        let left = leftover(&slope, &Profile::flat(1.0).unwrap(), GO).unwrap();
        let row: Vec<f64> = (0..9).map(|i| left.height(i, 4) - slope.height(i, 4)).collect();
        assert!((row[0] - 0.2).abs() < 1e-6 && (row[1] - 0.1).abs() < 1e-6, "{row:?}");
        assert!(row[2..].iter().all(|excess| excess.abs() < 1e-6), "{row:?}");
    }

    #[test]
    fn the_area_holds_all_that_is_within_the_margin_of_it() {
        let mut random = Rng::with_seed(3);
        for _ in 0..60 {
            let surface = field(30, 0.4, vec![0.0; 900]);
            let mut left = vec![0.0; 900];
            let seeds: Vec<usize> = (0..random.usize(1..6)).map(|_| random.usize(..900)).collect();
            seeds.iter().for_each(|seed| left[*seed] = 0.2);
            let left = field(30, 0.4, left);
            let margin = random.f64() * 3.0 + 0.01;
            let area = rest_area(&surface, &left, 0.1, margin, GO).unwrap();
            let all = Region::new(&surface.bounds()).unwrap();
            let region = all.within(area.outline).unwrap();
            for _ in 0..300 {
                let place = DVec2::new(random.f64(), random.f64()) * 11.6;
                let seed = |k: &usize| DVec2::new((k % 30) as f64, (k / 30) as f64) * 0.4;
                let distance = seeds.iter().map(|k| seed(k).distance(place));
                let distance = distance.fold(f64::INFINITY, f64::min);
                // It is larger by two cells and a fifth of the margin at most.
                let within = region.contains(place);
                assert!(distance > margin || within, "{place} at {distance} of {margin}");
                assert!(
                    distance < 1.2 * margin + 0.8 || !within,
                    "{place} at {distance} of {margin}"
                );
            }
        }
    }

    #[test]
    fn it_stops_when_told() {
        let field = field(9, 0.5, vec![0.0; 81]);
        let ball = Profile::ball(1.0).unwrap();
        assert_eq!(leftover(&field, &ball, &|_| false), None);
        let above = HeightField::new(9, 9, 0.5, vec![1.0; 81]).unwrap();
        let area = rest_area(&field, &above, 0.1, 0.5, &|_| false);
        assert_eq!(area, Err(RestError::Stopped));
    }

    #[test]
    fn other_grids_are_refused() {
        let (a, b) = (field(9, 0.5, vec![0.0; 81]), field(9, 0.4, vec![0.0; 81]));
        assert_eq!(rest_area(&a, &b, 0.1, 0.0, GO), Err(RestError::OtherGrid));
    }
}

//! What every layout promises, held against areas of all kinds: everything is covered, nothing lies
//! outside, points are even, counts are told beforehand.

use super::*;
use crate::{Bounds, Polygon, Raster, RasterStyle};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

const PACE: Pace = Pace { stepover_mm: 0.5, feed_step_mm: 0.4 };

fn region(x: f64, y: f64) -> Region {
    let min = DVec3::new(1.0, -2.0, 0.0);
    Region::new(&Bounds { min, max: min + DVec3::new(x, y, 5.0) }).unwrap()
}

/// A star with a hole, touching the area's border.
fn star() -> Region {
    let spikes = |radius: f64, inner: f64| {
        let corner = |k: usize| {
            let radius = if k.is_multiple_of(2) { radius } else { inner };
            DVec2::new(6.0, 3.0) + radius * DVec2::from_angle(k as f64 * PI / 5.0)
        };
        (0..10).map(corner).collect()
    };
    region(12.0, 10.0)
        .within(Polygon::new(vec![spikes(6.0, 3.0), spikes(1.6, 1.2)]).unwrap())
        .unwrap()
}

/// An L whose sides lie on the border of the area.
fn angle() -> Region {
    let corners = [(1.0, -2.0), (11.0, -2.0), (11.0, 1.0), (4.0, 1.0), (4.0, 6.0), (1.0, 6.0)];
    let corners = corners.map(|(x, y)| DVec2::new(x, y)).to_vec();
    region(10.0, 8.0).within(Polygon::new(vec![corners]).unwrap()).unwrap()
}

fn layouts(pace: Pace) -> Vec<(&'static str, Box<dyn Layout>)> {
    let Pace { stepover_mm, feed_step_mm } = pace;
    let raster = |degrees: f64, style| {
        let direction_rad = degrees.to_radians();
        Raster { stepover_mm, feed_step_mm, direction_rad, style }
    };
    let zigzag = RasterStyle::Zigzag;
    let (start, turn, border) = (Start::Middle, Turn::CounterClockwise, true);
    let (outside, clockwise) = (Start::Outside, Turn::Clockwise);
    vec![
        ("raster", Box::new(raster(0.0, zigzag))),
        ("slanted", Box::new(raster(30.0, RasterStyle::OneWay))),
        ("raster climb", Box::new(raster(90.0, RasterStyle::Climb))),
        ("cross climb", Box::new(CrossRaster { first: raster(20.0, RasterStyle::Climb) })),
        ("cross", Box::new(CrossRaster { first: raster(45.0, zigzag) })),
        ("spiral", Box::new(Spiral { pace, start, turn, border })),
        ("spiral in", Box::new(Spiral { pace, start: outside, turn: clockwise, border })),
        ("circles", Box::new(Circles { pace, start, turn, border })),
        ("circles in", Box::new(Circles { pace, start: outside, turn: clockwise, border })),
        ("radial", Box::new(Radial { pace, border })),
        ("hilbert", Box::new(Hilbert { pace })),
        ("contour", Box::new(ContourParallel { pace, start: outside, turn })),
        ("contour out", Box::new(ContourParallel { pace, start, turn: clockwise })),
    ]
}

/// Distance of a place from the passes and links.
fn distance(pattern: &Pattern, place: DVec2) -> f64 {
    let mut nearest = f64::MAX;
    for (k, point) in pattern.points.iter().enumerate() {
        nearest = nearest.min(point.distance(place));
        let starts = pattern.spans.iter().any(|s| s.points.start == k && !s.joined);
        if k > 0 && !starts {
            let from = pattern.points[k - 1];
            let line = *point - from;
            let share = (place - from).dot(line) / line.length_squared().max(f64::MIN_POSITIVE);
            nearest = nearest.min(place.distance(from + line * share.clamp(0.0, 1.0)));
        }
    }
    nearest
}

/// Places spread over a region, its corners among them.
fn places(region: &Region) -> Vec<DVec2> {
    let share = |k: usize| k as f64 / 36.0;
    let grid = (0..=36).flat_map(|i| (0..=36).map(move |j| DVec2::new(share(i), share(j))));
    grid.map(|p| region.min() + region.size() * p).filter(|p| region.contains(*p)).collect()
}

fn assert_sound(name: &str, pattern: &Pattern, region: &Region, pace: Pace) {
    let mut end = 0;
    for (k, span) in pattern.spans.iter().enumerate() {
        assert_eq!(span.points.start, end, "{name}: a gap");
        assert!(span.points.end > end, "{name}: an empty span");
        assert!(k > 0 || !(span.joined || span.link), "{name}: joined to nothing");
        assert!(span.joined || !span.link, "{name}: a link that is not joined");
        end = span.points.end;
        let first = if span.joined { span.points.start - 1 } else { span.points.start };
        for pair in pattern.points[first..end].windows(2) {
            let step = pair[0].distance(pair[1]);
            assert!(step <= pace.feed_step_mm * (1.0 + 1e-6), "{name}: a step of {step}");
            assert!(step > 1e-7, "{name}: a step of {step}");
        }
    }
    assert_eq!(end, pattern.points.len());
    for point in &pattern.points {
        assert!(region.contains(*point), "{name}: {point} lies outside");
    }
}

#[test]
fn passes_stay_inside_go_in_small_steps_and_are_counted() {
    let paces = [PACE, Pace { stepover_mm: 0.3, feed_step_mm: 2.0 }];
    let regions =
        [region(7.0, 5.0), region(5.0, 7.3), region(30.0, 2.0), region(0.1, 0.2), star(), angle()];
    for pace in paces {
        for region in &regions {
            for (name, layout) in layouts(pace) {
                let pattern = layout.pattern(region);
                assert!(!pattern.points.is_empty(), "{name}");
                assert_sound(name, &pattern, region, pace);
                assert_eq!(pattern, layout.pattern(region), "{name} differs from itself");
                let passes = pattern.spans.iter().filter(|span| !span.link);
                let points: usize = passes.map(|span| span.points.len()).sum();
                // A border and the ends of short pieces come on top of what is counted.
                let most = 2.0 * layout.count(region) + 150.0;
                assert!((points as f64) < most, "{name}: {points} points, told {most}");
            }
        }
    }
}

#[test]
fn every_place_is_within_half_a_stepover_of_a_pass() {
    for region in [region(7.0, 5.0), region(4.0, 6.1), region(9.0, 1.3), region(0.3, 0.4)] {
        for (name, layout) in layouts(PACE) {
            // A raster may stay short of the far border by a step, and points lie apart.
            let most = match name {
                "raster" | "slanted" | "cross" | "raster climb" | "cross climb" => {
                    1.5 * PACE.stepover_mm
                }
                "hilbert" => 0.5_f64.sqrt() * PACE.stepover_mm,
                "contour" | "contour out" => 0.65 * PACE.stepover_mm,
                _ => PACE.stepover_mm / 2.0 + PACE.sagitta_mm(),
            };
            let pattern = layout.pattern(&region);
            for place in places(&region) {
                let off = distance(&pattern, place);
                assert!(off <= most + 1e-9, "{name}: {place} is {off} off");
            }
        }
    }
}

#[test]
fn a_boundary_is_covered_as_a_rectangle_is() {
    for region in [star(), angle()] {
        for (name, layout) in layouts(PACE) {
            let most = match name {
                "contour" | "contour out" => 0.65 * PACE.stepover_mm,
                "raster" | "slanted" | "cross" | "raster climb" | "cross climb" => {
                    1.5 * PACE.stepover_mm
                }
                // Next to the border the cells' middles may lie outside.
                "hilbert" => 2.0 * PACE.stepover_mm,
                _ => PACE.stepover_mm / 2.0 + PACE.sagitta_mm(),
            };
            let pattern = layout.pattern(&region);
            for place in places(&region) {
                let off = distance(&pattern, place);
                assert!(off <= most + 1e-9, "{name}: {place} is {off} off");
            }
        }
    }
}

#[test]
fn an_area_without_width_is_passed_over_once() {
    for (name, layout) in layouts(PACE) {
        if !["raster", "slanted", "cross", "raster climb", "cross climb"].contains(&name) {
            let line = layout.pattern(&region(0.0, 3.0));
            assert_eq!((line.spans.len(), line.points.len()), (1, 9), "{name}");
        }
        let point = layout.pattern(&region(0.0, 0.0));
        assert!(point.points.iter().all(|p| *p == DVec2::new(1.0, -2.0)), "{name}");
        assert!(!point.points.is_empty(), "{name}");
    }
}

#[test]
fn impossible_steps_make_nothing() {
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for pace in [Pace { stepover_mm: step, ..PACE }, Pace { feed_step_mm: step, ..PACE }] {
            for (name, layout) in layouts(pace) {
                assert_eq!(layout.count(&region(3.0, 3.0)), f64::INFINITY, "{name}");
                assert!(layout.pattern(&region(3.0, 3.0)).points.is_empty(), "{name}");
            }
        }
    }
}

#[test]
fn huge_counts_are_told_without_working_them_out() {
    let fine = Pace { stepover_mm: 1e-9, feed_step_mm: 1e-9 };
    for (name, layout) in layouts(fine) {
        let count = layout.count(&region(10.0, 10.0));
        assert!((1e19..1e22).contains(&count), "{name}: {count}");
    }
}

/// The only pass of a pattern that has no border and is not cut.
fn only_pass(pattern: &Pattern) -> &[DVec2] {
    assert_eq!(pattern.spans.len(), 1);
    &pattern.points
}

#[test]
fn a_spiral_is_as_long_as_its_closed_form_and_its_steps_are_even() {
    let pace = Pace { stepover_mm: 0.5, feed_step_mm: 0.05 };
    let (start, turn) = (Start::Middle, Turn::CounterClockwise);
    // As wide as it reaches, so that nothing is cut off before the sides are reached.
    let spiral = Spiral { pace, start, turn, border: false };
    let pattern = spiral.pattern(&region(8.0, 8.0));
    let center = DVec2::new(5.0, 2.0);
    let inner: Vec<DVec2> =
        pattern.points.iter().copied().take_while(|p| p.distance(center) < 3.9).collect();
    let b = 0.5 / TAU;
    let length: f64 = inner.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let exact = b * spiral::arc_length(inner.last().unwrap().distance(center) / b);
    assert!((length / exact - 1.0).abs() < 1e-3, "{length} {exact}");
    for pair in inner[40..].windows(2) {
        let step = pair[0].distance(pair[1]);
        assert!((step / 0.05 - 1.0).abs() < 0.01, "{step}");
    }
    // Turns are a stepover apart along a ray.
    for point in &inner {
        let from = *point - center;
        let turns = from.length() / 0.5 - from.to_angle().rem_euclid(TAU) / TAU;
        assert!((turns - turns.round()).abs() < 1e-9, "{turns}");
    }
}

#[test]
fn passes_go_round_the_way_they_are_told() {
    let swept = |points: &[DVec2]| -> f64 {
        let center = DVec2::new(5.0, 2.0);
        points.windows(2).map(|p| (p[0] - center).perp_dot(p[1] - center)).sum()
    };
    let near = |pattern: Pattern| {
        let center = DVec2::new(5.0, 2.0);
        pattern.points.into_iter().filter(|p| p.distance(center) < 3.9).collect::<Vec<_>>()
    };
    for (turn, sign) in [(Turn::CounterClockwise, 1.0), (Turn::Clockwise, -1.0)] {
        for start in [Start::Middle, Start::Outside] {
            let (pace, border) = (PACE, false);
            let all: [Pattern; 3] = [
                Spiral { pace, start, turn, border }.pattern(&region(8.0, 8.0)),
                Circles { pace, start, turn, border }.pattern(&region(8.0, 8.0)),
                ContourParallel { pace, start, turn }.pattern(&region(8.0, 8.0)),
            ];
            for pattern in all {
                assert!(swept(&near(pattern)) * sign > 0.0, "{start:?} {turn:?}");
            }
        }
    }
}

#[test]
fn circles_have_the_radii_and_points_of_their_closed_form() {
    let pace = Pace { stepover_mm: 1.0, feed_step_mm: 0.1 };
    let (start, turn) = (Start::Middle, Turn::CounterClockwise);
    let pattern = Circles { pace, start, turn, border: false }.pattern(&region(20.0, 20.0));
    let center = DVec2::new(11.0, 8.0);
    let mut rings = pattern.spans.iter().filter(|span| !span.link);
    assert_eq!(pattern.points[rings.next().unwrap().points.clone()], [center]);
    for (ring, k) in rings.take(9).zip(1..) {
        let points = &pattern.points[ring.points.clone()];
        assert!(points.iter().all(|p| (p.distance(center) - f64::from(k)).abs() < 1e-12));
        assert_eq!(points.len(), (TAU * f64::from(k) / 0.1).ceil() as usize + 1);
        assert_eq!(points.first(), points.last());
    }
}

#[test]
fn nothing_is_lifted_before_the_sides_are_reached_and_corners_are_finished_one_by_one() {
    let (start, turn) = (Start::Middle, Turn::CounterClockwise);
    let lifts = |pattern: Pattern| pattern.spans.iter().filter(|span| !span.joined).count() - 1;
    let circles = Circles { pace: PACE, start, turn, border: false };
    let spiral = Spiral { pace: PACE, start, turn, border: false };
    // Some thirty rings are cut, each into four arcs.
    assert!(lifts(circles.pattern(&region(80.0, 80.0))) <= 16);
    assert!(lifts(spiral.pattern(&region(80.0, 80.0))) <= 16);
}

#[test]
fn rectangles_within_a_rectangle_are_as_long_as_their_closed_form() {
    let pace = Pace { stepover_mm: 1.0, feed_step_mm: 0.25 };
    let (start, turn) = (Start::Outside, Turn::CounterClockwise);
    let pattern = ContourParallel { pace, start, turn }.pattern(&region(12.0, 8.5));
    let passes: Vec<_> = pattern.spans.iter().filter(|span| !span.link).collect();
    // Insets 0, 1, 2, 3, 4 leave half a step across, which is enough.
    assert_eq!(passes.len(), 5);
    for (pass, inset) in passes.iter().zip(0..) {
        let points = &pattern.points[pass.points.clone()];
        let length: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        assert!((length - 2.0 * (12.0 + 8.5 - 4.0 * f64::from(inset))).abs() < 1e-9, "{length}");
    }
    // Here they leave 1.6 across, so that the middle line is passed.
    let pattern = ContourParallel { pace, start, turn }.pattern(&region(12.0, 9.6));
    let last = &pattern.points[pattern.spans.last().unwrap().points.clone()];
    assert!(last.iter().all(|p| (p.y - (-2.0 + 4.8)).abs() < 0.03));
    // It ends where corners are as far as its sides.
    let ends = [last[0].x, last[last.len() - 1].x];
    assert!((ends[0].min(ends[1]) - (1.0 + 4.8)).abs() < 0.03, "{ends:?}");
    assert!((ends[0].max(ends[1]) - (1.0 + 12.0 - 4.8)).abs() < 0.03, "{ends:?}");
}

#[test]
fn spokes_are_between_half_a_stepover_and_one_apart() {
    let pattern = Radial { pace: PACE, border: false }.pattern(&region(20.0, 20.0));
    let center = DVec2::new(11.0, 8.0);
    for radius in [2.0, 3.3, 5.0, 7.7, 9.9] {
        let mut angles: Vec<f64> = pattern
            .spans
            .iter()
            .filter(|span| !span.link)
            .filter_map(|span| {
                let points = &pattern.points[span.points.clone()];
                let radii = [points[0].distance(center), points[points.len() - 1].distance(center)];
                let crosses = radii[0].min(radii[1]) <= radius && radius <= radii[0].max(radii[1]);
                let far = if radii[0] > radii[1] { points[0] } else { points[points.len() - 1] };
                crosses.then(|| (far - center).to_angle().rem_euclid(TAU))
            })
            .collect();
        angles.sort_by(f64::total_cmp);
        angles.push(angles[0] + TAU);
        for pair in angles.windows(2) {
            let apart = radius * (pair[1] - pair[0]) / PACE.stepover_mm;
            assert!((0.49..=1.0 + 1e-9).contains(&apart), "{apart} at {radius}");
        }
    }
}

#[test]
fn the_curve_visits_every_cell_once_by_way_of_its_neighbours() {
    for (x, y) in [(8.0, 8.0), (7.0, 3.0), (31.0, 5.5), (2.0, 9.0), (0.7, 6.0), (13.0, 12.0)] {
        let pace = Pace { stepover_mm: 1.0, feed_step_mm: 10.0 };
        let region = region(x, y);
        let pattern = Hilbert { pace }.pattern(&region);
        let points = only_pass(&pattern);
        let even = |l: f64| if l <= 1.0 { 1.0 } else { 2.0 * (l / 2.0).ceil() };
        let cells = DVec2::new(even(x), even(y));
        let mut visited: Vec<(i64, i64)> = points
            .iter()
            .map(|p| ((*p - region.min()) / region.size() * cells).floor())
            .map(|cell| (cell.x as i64, cell.y as i64))
            .collect();
        for pair in visited.windows(2) {
            assert_eq!((pair[0].0 - pair[1].0).abs() + (pair[0].1 - pair[1].1).abs(), 1);
        }
        visited.sort_unstable();
        visited.dedup();
        assert_eq!(visited.len() as f64, cells.x * cells.y, "{x} {y}");
    }
}

#[test]
fn a_cross_begins_with_the_plain_raster() {
    let (stepover_mm, feed_step_mm) = (0.5, 0.4);
    let style = RasterStyle::Zigzag;
    let first = Raster { stepover_mm, feed_step_mm, direction_rad: 0.0, style };
    let region = region(6.0, 4.0);
    let cross = Layout::pattern(&CrossRaster { first }, &region);
    let plain = first.pattern(region.bounds());
    assert_eq!(cross.points[..plain.points.len()], plain.points);
    assert_eq!(cross.spans[..plain.spans.len()], plain.spans);
    let second = cross.spans[plain.spans.len()].clone();
    assert!(!second.joined);
    let step = cross.points[second.points.start + 1] - cross.points[second.points.start];
    assert!((step.y.abs() - 0.4).abs() < 1e-12 && step.x.abs() < 1e-12);
}

/// Every straight move of a pattern on the surface, and its lone points.
fn moves(pattern: &Pattern) -> Vec<[DVec2; 2]> {
    let along = |span: &PatternSpan| {
        let first = if span.joined { span.points.start - 1 } else { span.points.start };
        let points = &pattern.points[first..span.points.end];
        let lone = (points.len() == 1).then(|| [points[0], points[0]]);
        points.windows(2).map(|pair| [pair[0], pair[1]]).chain(lone).collect::<Vec<_>>()
    };
    pattern.spans.iter().flat_map(along).collect()
}

#[test]
fn rings_cover_regions_of_any_kind_and_stay_inside() {
    let mut rng = fastrand::Rng::with_seed(11);
    let area = Bounds { min: DVec3::splat(5.0), max: DVec3::new(90.0, 100.0, 9.0) };
    for kind in (0..6).cycle().take(36) {
        let polygon = crate::polygon::nasty(&mut rng, kind);
        let region = Region::new(&area).unwrap().within(polygon).unwrap();
        let stepover_mm = [0.7, 2.0, 5.0, 30.0][rng.usize(..4)];
        let pace = Pace { stepover_mm, feed_step_mm: stepover_mm };
        let start = [Start::Middle, Start::Outside][rng.usize(..2)];
        let turn = [Turn::Clockwise, Turn::CounterClockwise][rng.usize(..2)];
        let pattern = ContourParallel { pace, start, turn }.pattern(&region);
        assert_sound("contour", &pattern, &region, pace);
        let moves = moves(&pattern);
        let mut tried = 0;
        for _ in 0..3000 {
            let place = DVec2::new(rng.f64(), rng.f64()) * 100.0;
            if tried == 150 || !region.contains(place) {
                continue;
            }
            tried += 1;
            let off = moves.iter().map(|[a, b]| crate::polygon::distance(place, *a, *b));
            let off = off.fold(f64::INFINITY, f64::min) / stepover_mm;
            assert!(off < 0.65, "{kind}, stepover {stepover_mm}: {place} is {off} off");
        }
    }
}

/// The side on which rings leave material for the passes that follow: the right in climb milling with a
/// spindle that turns clockwise.
#[test]
fn from_the_middle_counter_clockwise_rings_are_climb_around_holes_too() {
    let square = |half: f64| {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        corners.map(|(x, y)| DVec2::splat(10.0) + half * DVec2::new(x, y)).to_vec()
    };
    let frame = Polygon::new(vec![square(9.0), square(3.0)]).unwrap();
    let area = Bounds { min: DVec3::ZERO, max: DVec3::splat(20.0) };
    let region = Region::new(&area).unwrap().within(frame).unwrap();
    let sides = |p: DVec2| {
        let off = (p - 10.0).abs();
        let beyond = off - 3.0;
        let inner = beyond.max(DVec2::ZERO).length() + beyond.max_element().min(0.0);
        [9.0 - off.max_element(), inner]
    };
    let depth = |p: DVec2| sides(p)[0].min(sides(p)[1]);
    let pace = Pace { stepover_mm: 1.0, feed_step_mm: 0.5 };
    for (start, turn, climb) in [
        (Start::Middle, Turn::CounterClockwise, true),
        (Start::Middle, Turn::Clockwise, false),
        (Start::Outside, Turn::Clockwise, true),
        (Start::Outside, Turn::CounterClockwise, false),
    ] {
        let pattern = ContourParallel { pace, start, turn }.pattern(&region);
        for span in pattern.spans.iter().filter(|span| !span.link) {
            let points = &pattern.points[span.points.clone()];
            for pair in points.windows(2) {
                let (middle, along) = (pair[0].midpoint(pair[1]), pair[1] - pair[0]);
                let right = -along.perp().normalize() * 0.1;
                // The middle line has no side.
                let [outer, inner] = sides(middle);
                if (outer - inner).abs() > 0.3 {
                    let stands = match start {
                        Start::Middle => depth(middle + right) < depth(middle),
                        Start::Outside => depth(middle + right) > depth(middle),
                    };
                    assert_eq!(stands, climb, "{start:?} {turn:?} at {middle}");
                }
            }
        }
    }
}

#[test]
fn an_island_is_finished_before_the_next() {
    let island = |x: f64| {
        let corners = [(x, 0.0), (x + 30.0, 0.0), (x + 30.0, 30.0), (x, 30.0)];
        corners.map(|(x, y)| DVec2::new(x, y)).to_vec()
    };
    let islands = Polygon::new(vec![island(0.0), island(40.0), island(80.0)]).unwrap();
    let area = Bounds { min: DVec3::ZERO, max: DVec3::splat(200.0) };
    let region = Region::new(&area).unwrap().within(islands).unwrap();
    for start in [Start::Middle, Start::Outside] {
        let rings = ContourParallel { pace: PACE, start, turn: Turn::Clockwise };
        let pattern = rings.pattern(&region);
        assert_eq!(pattern.spans.iter().filter(|span| !span.joined).count(), 3);
    }
}

//! Parallel lines over a rectangle: where a finishing cutter is dropped.
//!
//! Along an axis the lines and points stand on the grid `min + k · step` with k from 0 to
//! ⌊extent / step⌋, as in Sood, *Novel algorithms for CAD-free machining* (thesis, 2015), section
//! 4.3: a count of (⌊extent_x / step⌋ + 1)·(⌊extent_y / step⌋ + 1). In any other direction the
//! lines are clipped to the rectangle and their points start where the line enters it.
//!
//! The last line, and the last point of a line, may stay short of the far border by less than a
//! step.
//!
//! Climb and conventional. A spindle that turns clockwise seen from above (M3) moves the edges on the
//! right of the cutter, seen along the feed, backwards. With the material there an edge enters it at full
//! chip and leaves it at none: climb milling. With the material on the left it is conventional. Lines
//! follow each other across, so the side on which material still stands is the one that they go
//! towards; the feed direction is as told, and the order of lines is turned round where that side is
//! wrong. The first line has material on both sides.

use crate::pattern::{Layer, STEP_SLACK, between, push};
use crate::{Bounds, Layout, Pace, Pattern, Region};
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// A direction this close to an axis, in radians, is that axis: 90° converted to radians and back
/// is not exact, and over 10 m the difference is 10 nm.
const AXIS_SLACK_RAD: f64 = 1e-9;

/// Which way the passes go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RasterStyle {
    /// There and back: each pass starts beside the end of the one before.
    Zigzag,
    /// All the same way; the cutter is lifted back.
    OneWay,
    /// As one way, with the lines in such an order that what is uncut lies on the right.
    Climb,
    /// As one way, with what is uncut on the left.
    Conventional,
}

/// Parallel passes over the XY rectangle of a box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Raster {
    /// Distance between neighbouring passes, in mm, positive.
    pub stepover_mm: f64,
    /// Distance between points along a pass, in mm, positive.
    pub feed_step_mm: f64,
    /// Feed direction of the first pass, from +X counter-clockwise, in radians.
    pub direction_rad: f64,
    /// Which way the passes go.
    pub style: RasterStyle,
}

/// A straight line of points, evenly spaced, in the order they are visited.
struct Line {
    first: DVec2,
    step: DVec2,
    points: usize,
}

impl Line {
    fn point(&self, i: usize) -> DVec2 {
        self.first + self.step * i as f64
    }

    fn reversed(self) -> Self {
        let last = self.points.saturating_sub(1);
        Self { first: self.point(last), step: -self.step, points: self.points }
    }
}

impl Raster {
    /// How many points the passes of [`Self::pattern`] have: exact along an axis, estimated in
    /// other directions. Infinite when a step is not a positive number or the area is not finite.
    #[must_use]
    pub fn count(&self, area: &Bounds) -> f64 {
        if !self.is_sound(area) {
            return f64::INFINITY;
        }
        let size = area.size().truncate();
        if let Some(axis) = self.axis() {
            let (along, across) = if axis % 2 == 0 { (size.x, size.y) } else { (size.y, size.x) };
            return (steps(along, self.feed_step_mm) + 1.0)
                * (steps(across, self.stepover_mm) + 1.0);
        }
        let across = across_of(DVec2::from_angle(self.direction_rad));
        let lines = steps(size.dot(across.abs()), self.stepover_mm) + 1.0;
        size.x * size.y / (self.stepover_mm * self.feed_step_mm) + lines / 2.0
    }

    /// The passes over `area`, and for zigzag the links between them. Empty when a step is not a
    /// positive number or the area is not finite.
    ///
    /// Memory grows with [`Self::count`]: look at it first.
    #[must_use]
    pub fn pattern(&self, area: &Bounds) -> Pattern {
        let mut pattern = Pattern::EMPTY;
        if !self.is_sound(area) {
            return pattern;
        }
        for (k, line) in self.lines(area).enumerate() {
            let back = self.style == RasterStyle::Zigzag && k % 2 == 1;
            self.add(&mut pattern, if back { line.reversed() } else { line });
        }
        pattern
    }

    fn is_sound(&self, area: &Bounds) -> bool {
        let step = |s: f64| s.is_finite() && s > 0.0;
        let size = area.size().truncate();
        step(self.stepover_mm)
            && step(self.feed_step_mm)
            && self.direction_rad.is_finite()
            && area.min.truncate().is_finite()
            && size.is_finite()
            && size.min_element() >= 0.0
    }

    /// The quarter turns from +X, if the direction is along an axis.
    fn axis(&self) -> Option<usize> {
        let quarters = (self.direction_rad / FRAC_PI_2).round();
        let close = (self.direction_rad - quarters * FRAC_PI_2).abs() <= AXIS_SLACK_RAD;
        close.then(|| quarters.rem_euclid(4.0) as usize)
    }

    fn lines<'a>(&'a self, area: &'a Bounds) -> Box<dyn Iterator<Item = Line> + 'a> {
        match (self.axis(), self.is_reversed()) {
            (Some(axis), false) => Box::new(self.lines_along_axis(area, axis)),
            (Some(axis), true) => Box::new(self.lines_along_axis(area, axis).rev()),
            (None, false) => Box::new(self.lines_across(area).filter(|line| line.points > 0)),
            (None, true) => Box::new(self.lines_across(area).filter(|line| line.points > 0).rev()),
        }
    }

    /// Whether the lines follow each other from the far side, for what is uncut to lie as the style wants.
    fn is_reversed(&self) -> bool {
        let feed = DVec2::from_angle(self.direction_rad);
        let across = match self.axis() {
            Some(axis) if axis.is_multiple_of(2) => DVec2::Y,
            Some(_) => DVec2::X,
            None => across_of(feed),
        };
        let uncut_on_left = feed.perp().dot(across) > 0.0;
        match self.style {
            RasterStyle::Zigzag | RasterStyle::OneWay => false,
            RasterStyle::Climb => uncut_on_left,
            RasterStyle::Conventional => !uncut_on_left,
        }
    }

    fn lines_along_axis(
        &self,
        area: &Bounds,
        axis: usize,
    ) -> impl DoubleEndedIterator<Item = Line> {
        let size = area.size().truncate();
        let min = area.min.truncate();
        let (feed, across) =
            if axis.is_multiple_of(2) { (DVec2::X, DVec2::Y) } else { (DVec2::Y, DVec2::X) };
        let points = steps(size.dot(feed), self.feed_step_mm) as usize + 1;
        let lines = steps(size.dot(across), self.stepover_mm) as usize + 1;
        let (feed_step, stepover) = (self.feed_step_mm, self.stepover_mm);
        (0..lines).map(move |k| {
            let first = min + across * (k as f64 * stepover);
            let line = Line { first, step: feed * feed_step, points };
            if axis >= 2 { line.reversed() } else { line }
        })
    }

    fn lines_across(&self, area: &Bounds) -> impl DoubleEndedIterator<Item = Line> {
        let feed = DVec2::from_angle(self.direction_rad);
        let across = across_of(feed);
        let (min, max) = (area.min.truncate(), area.max.truncate());
        let size = max - min;
        // The corner where the lines begin: the least across of the four.
        let corner = DVec2::new(
            if across.x >= 0.0 { min.x } else { max.x },
            if across.y >= 0.0 { min.y } else { max.y },
        );
        let lines = steps(size.dot(across.abs()), self.stepover_mm) as usize + 1;
        let (feed_step, stepover) = (self.feed_step_mm, self.stepover_mm);
        (0..lines).map(move |k| {
            let on_line = corner + across * (k as f64 * stepover);
            let (enter, leave) = clip(on_line, feed, min, max);
            let points =
                if leave >= enter { steps(leave - enter, feed_step) as usize + 1 } else { 0 };
            let first = (on_line + feed * enter).clamp(min, max);
            Line { first, step: feed * feed_step, points }
        })
    }

    /// Adds a pass, and for zigzag the points on the way to it, so that the cutter stays on the
    /// surface.
    fn add(&self, pattern: &mut Pattern, line: Line) {
        let joined = self.style == RasterStyle::Zigzag && !pattern.points.is_empty();
        if let (true, Some(&from)) = (joined, pattern.points.last()) {
            push(pattern, between(from, line.first, self.feed_step_mm), true, true);
        }
        push(pattern, (0..line.points).map(|i| line.point(i)), false, joined);
    }

    /// The lines over the box of a region, cut down to it.
    fn cut(&self, region: &Region) -> Pattern {
        let pace = Pace { stepover_mm: self.stepover_mm, feed_step_mm: self.feed_step_mm };
        let mut layer = match Layer::new(region, pace) {
            Ok(layer) => layer,
            Err(pattern) => return pattern,
        };
        for (k, line) in self.lines(region.bounds()).enumerate() {
            let back = self.style == RasterStyle::Zigzag && k % 2 == 1;
            let line = if back { line.reversed() } else { line };
            self.add_parts(&mut layer, region, &line);
        }
        match self.style {
            RasterStyle::Zigzag => layer.into_pattern(false),
            RasterStyle::OneWay | RasterStyle::Climb | RasterStyle::Conventional => {
                layer.into_lifted()
            }
        }
    }

    /// Adds the parts of a line inside a region, their points at whole steps from where they begin.
    fn add_parts(&self, layer: &mut Layer<'_>, region: &Region, line: &Line) {
        let (from, to) = (line.first, line.point(line.points.saturating_sub(1)));
        for (enter, leave) in region.inside(from, to) {
            let (enter, leave) = (from.lerp(to, enter), from.lerp(to, leave));
            let points = steps(enter.distance(leave), self.feed_step_mm) as usize + 1;
            let part = Line { first: enter, step: line.step, points };
            layer.add_whole((0..points).map(|i| part.point(i)).collect());
        }
    }
}

impl Layout for Raster {
    fn count(&self, region: &Region) -> f64 {
        Self::count(self, region.bounds())
    }

    fn pattern(&self, region: &Region) -> Pattern {
        if region.has_boundary() { self.cut(region) } else { Self::pattern(self, region.bounds()) }
    }
}

/// Whole steps in an extent.
fn steps(extent: f64, step: f64) -> f64 {
    (extent / step * (1.0 + STEP_SLACK)).floor().max(0.0)
}

/// The normal to the feed direction that points away from the corner of least coordinates.
fn across_of(feed: DVec2) -> DVec2 {
    let left = feed.perp();
    if left.x + left.y >= 0.0 { left } else { -left }
}

/// Where the line `origin + t · direction` enters and leaves a rectangle (t, mm); leaves before it
/// enters if it misses. The direction is along no axis.
fn clip(origin: DVec2, direction: DVec2, min: DVec2, max: DVec2) -> (f64, f64) {
    let a = (min - origin) / direction;
    let b = (max - origin) / direction;
    (a.min(b).max_element(), a.max(b).min_element())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn area(x: f64, y: f64) -> Bounds {
        Bounds { min: DVec3::new(1.0, -2.0, 0.0), max: DVec3::new(1.0 + x, y - 2.0, 5.0) }
    }

    fn raster(direction_rad: f64, style: RasterStyle) -> Raster {
        Raster { stepover_mm: 0.3, feed_step_mm: 0.3, direction_rad, style }
    }

    #[test]
    fn whole_steps_survive_rounding() {
        let grid = raster(0.0, RasterStyle::OneWay);
        assert_eq!(grid.count(&area(3.0, 0.9)), 11.0 * 4.0);
        assert_eq!(grid.pattern(&area(3.0, 0.9)).points.len(), 44);
    }

    #[test]
    fn counts_of_the_source_are_reproduced() {
        let cases =
            [(480, 480, 456_976), (1104, 1392, 363_549), (1024, 640, 286_371), (618, 328, 242_684)];
        for (columns, rows, expected) in cases {
            let pitch = (203.0 / f64::from(columns)).min(203.0 / f64::from(rows));
            let (x, y) = (f64::from(columns - 1) * pitch, f64::from(rows - 1) * pitch);
            for direction in [0.0, FRAC_PI_2, 90_f64.to_radians(), -FRAC_PI_2] {
                let grid = raster(direction, RasterStyle::Zigzag);
                let bounds = Bounds { min: DVec3::ZERO, max: DVec3::new(x, y, 5.0) };
                assert_eq!(grid.count(&bounds), f64::from(expected));
                let pattern = grid.pattern(&bounds);
                let on_passes: usize =
                    pattern.spans.iter().filter(|s| !s.link).map(|s| s.points.len()).sum();
                assert_eq!(on_passes, expected as usize);
            }
        }
    }

    #[test]
    fn zigzag_alternates_and_links() {
        let grid =
            Raster { stepover_mm: 1.0, feed_step_mm: 0.4, ..raster(0.0, RasterStyle::Zigzag) };
        let pattern = grid.pattern(&area(4.0, 2.0));
        let kinds: Vec<_> = pattern.spans.iter().map(|s| (s.link, s.joined)).collect();
        let (first, pass, link) = ((false, false), (false, true), (true, true));
        assert_eq!(kinds, [first, link, pass, link, pass]);
        let ends: Vec<_> =
            pattern.spans.iter().map(|s| pattern.points[s.points.end - 1].x).collect();
        assert_eq!(ends, [5.0, 5.0, 1.0, 1.0, 5.0]);
        for pair in pattern.points.windows(2) {
            assert!(pair[0].distance(pair[1]) < 0.4 + 1e-12);
        }
    }

    #[test]
    fn one_way_passes_are_not_joined() {
        let pattern = raster(0.0, RasterStyle::OneWay).pattern(&area(3.0, 3.0));
        assert!(pattern.spans.iter().all(|s| !s.joined && !s.link));
        assert!(pattern.spans.iter().all(|s| pattern.points[s.points.start].x == 1.0));
    }

    #[test]
    fn backward_directions_start_at_the_far_end() {
        let pattern = raster(std::f64::consts::PI, RasterStyle::OneWay).pattern(&area(3.0, 3.0));
        assert!((pattern.points[0].x - 4.0).abs() < 1e-12);
        assert_eq!(pattern.points[0].y, -2.0);
    }

    /// Cuts pass by pass and looks on which side of the feed there is something to be cut by those that
    /// follow.
    #[test]
    fn climb_leaves_the_uncut_side_on_the_right_and_conventional_on_the_left() {
        let triangle = [(1.0, -2.0), (5.0, -2.0), (2.0, 1.5)].map(|(x, y)| DVec2::new(x, y));
        let triangle = crate::Polygon::new(vec![triangle.to_vec()]).unwrap();
        let whole = Region::new(&area(4.0, 3.0)).unwrap();
        let cut = whole.clone().within(triangle).unwrap();
        for (style, right) in [(RasterStyle::Climb, true), (RasterStyle::Conventional, false)] {
            for degrees in (-180..=360).step_by(15) {
                for region in [&whole, &cut] {
                    let grid = raster(f64::from(degrees).to_radians(), style);
                    let pattern = Layout::pattern(&grid, region);
                    assert!(pattern.spans.iter().all(|span| !span.joined && !span.link));
                    let passes: Vec<&[DVec2]> =
                        pattern.spans.iter().map(|s| &pattern.points[s.points.clone()]).collect();
                    let feed = DVec2::from_angle(grid.direction_rad);
                    for pair in passes.windows(2) {
                        let along = pair[0][pair[0].len() - 1] - pair[0][0];
                        assert!(along.dot(feed) >= along.length() - 1e-9, "{degrees}: another way");
                        let uncut = pair[1][0] - pair[0][0];
                        let to_the_right = -feed.perp().dot(uncut);
                        assert!((to_the_right.abs() - 0.3).abs() < 1e-6, "{degrees}");
                        assert_eq!(to_the_right > 0.0, right, "{style:?} at {degrees}");
                    }
                }
            }
        }
    }

    #[test]
    fn climb_has_the_points_of_one_way() {
        for degrees in [0.0, 90.0, 180.0, -90.0, 33.0, 200.0_f64] {
            let sorted = |style| {
                let mut points =
                    raster(degrees.to_radians(), style).pattern(&area(4.0, 3.0)).points;
                points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
                points
            };
            assert_eq!(sorted(RasterStyle::Climb), sorted(RasterStyle::OneWay));
            assert_eq!(sorted(RasterStyle::Conventional), sorted(RasterStyle::OneWay));
        }
    }

    #[test]
    fn slanted_lines_stay_inside_and_cover() {
        for degrees in [1.0, 30.0, 45.0, 60.0, 89.0, 100.0, 200.0, 300.0_f64] {
            let grid = raster(degrees.to_radians(), RasterStyle::Zigzag);
            let bounds = area(7.0, 5.0);
            let pattern = grid.pattern(&bounds);
            let (min, max) = (bounds.min.truncate(), bounds.max.truncate());
            for p in &pattern.points {
                assert!(p.cmpge(min - 1e-9).all() && p.cmple(max + 1e-9).all(), "{p}");
            }
            // Every place in the area is within a step both ways of a point.
            for (fx, fy) in [(0.1, 0.1), (0.5, 0.5), (0.9, 0.2), (0.3, 0.95)] {
                let place = min + (max - min) * DVec2::new(fx, fy);
                let nearest =
                    pattern.points.iter().map(|p| p.distance(place)).fold(f64::MAX, f64::min);
                assert!(nearest < 0.3, "{degrees}: {nearest}");
            }
            let passes: usize =
                pattern.spans.iter().filter(|s| !s.link).map(|s| s.points.len()).sum();
            let estimate = grid.count(&bounds);
            assert!((passes as f64 / estimate - 1.0).abs() < 0.05, "{passes} {estimate}");
            assert!(pattern.spans.iter().all(|s| !s.points.is_empty()));
        }
    }

    #[test]
    fn impossible_steps_make_nothing() {
        for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let grid = Raster { stepover_mm: step, ..raster(0.0, RasterStyle::Zigzag) };
            assert_eq!(grid.count(&area(3.0, 3.0)), f64::INFINITY);
            assert!(grid.pattern(&area(3.0, 3.0)).points.is_empty());
        }
    }

    #[test]
    fn a_point_is_an_area() {
        let pattern = raster(0.3, RasterStyle::Zigzag).pattern(&area(0.0, 0.0));
        assert_eq!(pattern.points, [DVec2::new(1.0, -2.0)]);
    }
}

//! A mask of one plain shape.
//!
//! With a and b half its width and height, about its middle: an ellipse is all within (x/a)² + (y/b)² = 1;
//! corners of polygons and stars lie on that ellipse, the first at its top, inner ones of stars on
//! one by a share smaller. A line keeps what is within its width of the outline, inside of it, at the
//! same distance everywhere.

use super::sheet::{Drawn, Ground, Place, Sheet};
use carvegraph_core::{Choice, Context, Node, NodeError, Params, Yielding};
use carvegraph_geometry::{DVec2, Filling, offset};
use kurbo::{BezPath, Ellipse, PathEl, Point, Rect, Shape as _};

/// How far curves of paths may be from the shapes that they stand for, in mm: less than any cutter
/// shows.
const WITHIN_MM: f64 = 1e-4;

/// How far a line's inner edge may be off, in pixels.
const WITHIN_PX: f64 = 0.01;

/// Selects a rectangle, an ellipse, a polygon or a star, whole or as a line along its outline.
#[derive(Clone, Debug, Params)]
pub(crate) struct ShapeMask {
    /// What is drawn.
    #[param(default = Shape::Rectangle)]
    pub(crate) shape: Shape,
    /// How wide it is before it is turned. Left alone, as the picture or surface less its margins.
    #[param(unit = "mm", default = 0.0, range = 0.0..=100_000.0)]
    pub(crate) width: Yielding<f64>,
    /// How high it is before it is turned. Left alone, as the picture or surface less its margins.
    #[param(unit = "mm", default = 0.0, range = 0.0..=100_000.0)]
    pub(crate) height: Yielding<f64>,
    /// Room on all sides for a width or height that is left alone.
    #[param(unit = "mm", default = 0.0, range = 0.0..=100_000.0)]
    pub(crate) margin: f64,
    /// Whether it is filled.
    #[param(default = Fill::Area)]
    pub(crate) fill: Fill,
    /// Width of a line, inwards from the outline; 0 draws none.
    #[param(unit = "mm", default = 1.0, range = 0.0..=100_000.0)]
    pub(crate) line: f64,
    /// Radius of a rectangle's corners.
    #[param(unit = "mm", default = 0.0, range = 0.0..=100_000.0)]
    pub(crate) corner_radius: f64,
    /// Corners of a polygon, points of a star.
    #[param(default = 5, range = 3..=1000)]
    pub(crate) points: u32,
    /// How far the inner corners of a star are from its middle, its points being 100 % off.
    #[param(unit = "%", default = 38.0, range = 1.0..=100.0)]
    pub(crate) inner: f64,
    #[param(shared)]
    pub(crate) place: Place,
}

/// Whether a shape is filled.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Fill {
    /// All of it is selected.
    Area,
    /// A line along its outline is selected.
    Line,
}

/// What a shape mask draws.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Shape {
    /// A rectangle, with round corners if it has a corner radius.
    Rectangle,
    /// An ellipse; a circle if it is as wide as high.
    Ellipse,
    /// A regular polygon, stretched to its width and height.
    Polygon,
    /// A star.
    Star,
}

impl Node for ShapeMask {
    const KIND: &'static str = "shape_mask";
    type Inputs<'a> = Ground<'a>;
    type Outputs = Drawn;

    fn run(&self, ground: Ground<'_>, cx: &Context<'_>) -> Result<Drawn, NodeError> {
        let sheet = ground.sheet(self.place.picture_width)?;
        let room = sheet.size_mm - 2.0 * self.margin;
        let size = DVec2::new(self.width.or(Some(room.x)), self.height.or(Some(room.y)));
        if size.min_element() <= 0.0 {
            let message = format!("a shape of {:.3} × {:.3} mm has no inside", size.x, size.y);
            return Err(NodeError::refused("width", message));
        }
        let path = sheet.to_pixels() * self.place.to_sheet() * self.path(size / 2.0);
        let whole = Sheet::inside(&path, Filling::EvenOdd)?;
        let outline = match self.fill {
            Fill::Area => whole,
            Fill::Line if self.line == 0.0 => return Ok(Drawn { mask: sheet.blank() }),
            Fill::Line => {
                let line_px = self.line * sheet.to_pixels().determinant().abs().sqrt();
                let inner = whole.as_ref().and_then(|whole| offset(whole, -line_px, WITHIN_PX));
                match (whole, inner) {
                    (Some(whole), Some(inner)) => whole.minus(&inner),
                    (whole, _) => whole,
                }
            }
        };
        Ok(Drawn { mask: sheet.cover(outline.as_ref(), cx)? })
    }
}

impl ShapeMask {
    /// The outline about the origin; `half` its width and height.
    fn path(&self, half: DVec2) -> BezPath {
        let corner = |share: f64, k: u32, of: u32| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(of)).sin_cos();
            Point::new(-share * half.x * sin, share * half.y * cos)
        };
        match self.shape {
            Shape::Rectangle => Rect::new(-half.x, -half.y, half.x, half.y)
                .to_rounded_rect(self.corner_radius.min(half.min_element()))
                .to_path(WITHIN_MM),
            Shape::Ellipse => Ellipse::new(Point::ZERO, (half.x, half.y), 0.0).to_path(WITHIN_MM),
            Shape::Polygon => closed((0..self.points).map(|k| corner(1.0, k, self.points))),
            Shape::Star => closed((0..2 * self.points).map(|k| {
                let share = if k % 2 == 0 { 1.0 } else { self.inner / 100.0 };
                corner(share, k, 2 * self.points)
            })),
        }
    }
}

fn closed(corners: impl Iterator<Item = Point>) -> BezPath {
    let element =
        |(k, corner)| if k == 0 { PathEl::MoveTo(corner) } else { PathEl::LineTo(corner) };
    corners.enumerate().map(element).chain([PathEl::ClosePath]).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sheet::MIDDLE;
    use super::super::sheet::testing::{extent, on_image, on_surface};
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn plain(shape: Shape, width: f64, height: f64) -> ShapeMask {
        ShapeMask {
            shape,
            width: Yielding::given(width),
            height: Yielding::given(height),
            margin: 0.0,
            fill: Fill::Area,
            line: 0.0,
            corner_radius: 0.0,
            points: 5,
            inner: 38.0,
            place: MIDDLE,
        }
    }

    /// What is drawn on a surface of 40 × 30 mm, in mm².
    fn area(node: &ShapeMask) -> f64 {
        on_surface(node, [201, 151], 0.2).unwrap().selected_px() * 0.04
    }

    #[track_caller]
    fn assert_area(node: &ShapeMask, expected: f64) {
        let found = area(node);
        assert!((found - expected).abs() < 1e-3 * expected, "{found} {expected}");
    }

    #[test]
    fn areas_are_those_of_the_formulas() {
        assert_area(&plain(Shape::Rectangle, 20.0, 10.0), 200.0);
        assert_area(&plain(Shape::Ellipse, 20.0, 10.0), PI * 10.0 * 5.0);
        let round = ShapeMask { corner_radius: 3.0, ..plain(Shape::Rectangle, 20.0, 10.0) };
        assert_area(&round, 200.0 - (4.0 - PI) * 9.0);
        let hexagon = ShapeMask {
            points: 6,
            place: Place { turn: 17.0, ..MIDDLE },
            ..plain(Shape::Polygon, 20.0, 20.0)
        };
        assert_area(&hexagon, 3.0 * 100.0 * (TAU / 6.0).sin());
        // 2n triangles of sides r and 0.5 r, π/n apart.
        let star = ShapeMask { points: 7, inner: 50.0, ..plain(Shape::Star, 20.0, 20.0) };
        assert_area(&star, 7.0 * 100.0 * 0.5 * (PI / 7.0).sin());
    }

    #[test]
    fn a_line_leaves_what_is_within_its_width() {
        let ring = ShapeMask { fill: Fill::Line, line: 2.0, ..plain(Shape::Ellipse, 20.0, 20.0) };
        assert_area(&ring, PI * (100.0 - 64.0));
        let frame =
            ShapeMask { fill: Fill::Line, line: 1.0, ..plain(Shape::Rectangle, 20.0, 10.0) };
        assert_area(&frame, 200.0 - 18.0 * 8.0);
        assert_eq!(area(&ShapeMask { line: 0.0, ..frame.clone() }), 0.0);
        let wider_than_the_shape = ShapeMask { line: 50.0, ..frame };
        assert_area(&wider_than_the_shape, 200.0);
    }

    #[test]
    fn a_shape_left_alone_fills_the_surface_within_its_margin() {
        let (width, height) = (Yielding::left(0.0), Yielding::left(0.0));
        let node = ShapeMask { margin: 5.0, width, height, ..plain(Shape::Rectangle, 1.0, 1.0) };
        assert_area(&node, 30.0 * 20.0);
        let told = on_surface(&ShapeMask { margin: 15.0, ..node }, [201, 151], 0.2).unwrap_err();
        assert_eq!(told, "a shape of 10.000 × 0.000 mm has no inside");
    }

    #[test]
    fn it_lies_where_it_is_told_turned_counter_clockwise() {
        let node = ShapeMask {
            place: Place { x: 20.0, y: 10.0, ..MIDDLE },
            ..plain(Shape::Rectangle, 10.0, 4.0)
        };
        // A picture 100 mm wide has its middle at 50, 25, and y goes down.
        assert_eq!(extent(&on_image(&node, [100, 50]).unwrap()), [65.0, 13.0, 75.0, 17.0]);
        let star = ShapeMask {
            points: 3,
            inner: 1.0,
            place: Place { turn: 90.0, ..MIDDLE },
            ..plain(Shape::Star, 40.0, 40.0)
        };
        // The point that was at the top lies at the left.
        let [left, _, right, _] = extent(&on_image(&star, [100, 50]).unwrap());
        assert!(left == 30.0 && right == 60.0, "{left} {right}");
    }
}

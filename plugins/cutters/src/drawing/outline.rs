//! Reads the data of an SVG path (SVG 2, chapter 9) to curves in the path's own units.

use super::curve::{Arc, Curve};
use super::sheet::unreadable;
use super::{DrawingError, MAX_COMMANDS};
use kurbo::{CubicBez, Point, QuadBez, Vec2};
use svgtypes::{PathParser, PathSegment};

/// The curves of path data, which must be one open piece.
pub(super) fn path(data: &str) -> Result<Vec<Curve>, DrawingError> {
    let mut pen = Pen::default();
    for (index, command) in PathParser::from(data).enumerate() {
        if index == MAX_COMMANDS {
            return Err(DrawingError::TooManyCommands);
        }
        pen.follow(command.map_err(|e| unreadable("path", data, &e.to_string()))?)?;
    }
    if pen.curves.is_empty() { Err(DrawingError::NoShape) } else { Ok(pen.curves) }
}

/// The control point that a smooth command mirrors.
#[derive(Clone, Copy)]
enum Control {
    None,
    Cubic(Point),
    Quadratic(Point),
}

struct Pen {
    at: Point,
    control: Control,
    /// Whether it was lifted since it drew last.
    lifted: bool,
    curves: Vec<Curve>,
}

impl Default for Pen {
    fn default() -> Self {
        Self { at: Point::ZERO, control: Control::None, lifted: false, curves: Vec::new() }
    }
}

impl Pen {
    fn follow(&mut self, command: PathSegment) -> Result<(), DrawingError> {
        use PathSegment as Path;
        let from = if command.is_abs() { Vec2::ZERO } else { self.at.to_vec2() };
        let place = |x, y| Point::new(x, y) + from;
        match command {
            Path::MoveTo { x, y, .. } => {
                (self.at, self.control) = (place(x, y), Control::None);
                self.lifted = !self.curves.is_empty();
                Ok(())
            }
            Path::LineTo { x, y, .. } => self.line(place(x, y)),
            Path::HorizontalLineTo { x, .. } => self.line(Point::new(x + from.x, self.at.y)),
            Path::VerticalLineTo { y, .. } => self.line(Point::new(self.at.x, y + from.y)),
            Path::CurveTo { x1, y1, x2, y2, x, y, .. } => {
                self.cubic(place(x1, y1), place(x2, y2), place(x, y))
            }
            Path::SmoothCurveTo { x2, y2, x, y, .. } => {
                let first =
                    if let Control::Cubic(p) = self.control { self.mirror(p) } else { self.at };
                self.cubic(first, place(x2, y2), place(x, y))
            }
            Path::Quadratic { x1, y1, x, y, .. } => self.quadratic(place(x1, y1), place(x, y)),
            Path::SmoothQuadratic { x, y, .. } => {
                let control =
                    if let Control::Quadratic(p) = self.control { self.mirror(p) } else { self.at };
                self.quadratic(control, place(x, y))
            }
            Path::EllipticalArc { rx, ry, x_axis_rotation, large_arc, sweep, x, y, .. } => {
                let (to, turn) = (place(x, y), x_axis_rotation.to_radians());
                let arc = Arc::from_svg(self.at, to, [rx.abs(), ry.abs()], turn, large_arc, sweep);
                let curve = arc.map_or(Curve::Line(self.at, to), Curve::Arc);
                self.draw(curve, Control::None)
            }
            Path::ClosePath { .. } => Err(DrawingError::Closed),
        }
    }

    fn mirror(&self, control: Point) -> Point {
        self.at + (self.at - control)
    }

    fn line(&mut self, to: Point) -> Result<(), DrawingError> {
        self.draw(Curve::Line(self.at, to), Control::None)
    }

    fn cubic(&mut self, p1: Point, p2: Point, to: Point) -> Result<(), DrawingError> {
        self.draw(Curve::Bezier(CubicBez::new(self.at, p1, p2, to)), Control::Cubic(p2))
    }

    fn quadratic(&mut self, p1: Point, to: Point) -> Result<(), DrawingError> {
        let raised = QuadBez::new(self.at, p1, to).raise();
        self.draw(Curve::Bezier(raised), Control::Quadratic(p1))
    }

    fn draw(&mut self, curve: Curve, control: Control) -> Result<(), DrawingError> {
        if self.lifted {
            return Err(DrawingError::Pieces);
        }
        (self.at, self.control) = (curve.end(), control);
        self.curves.push(curve);
        Ok(())
    }
}

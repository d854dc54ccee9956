//! Pieces of an outline: lines, Bézier curves and elliptic arcs, and how they are parted where they
//! turn and flattened to chains of lines.
//!
//! An elliptic arc is the image of an arc of the unit circle: c + u·cos t + v·sin t, where u and v are
//! the images of the unit vectors. Any affine map takes it to another such arc, exactly. It is
//! circular if u and v are equally long and square to each other.

use super::{CIRCLE_MM, MAX_SEGMENTS, NOISE_MM, WITHIN_MM};
use kurbo::{Affine, CubicBez, ParamCurve, ParamCurveExtrema, Point, Vec2};
use std::f64::consts::{PI, TAU};

/// Halvings of a curve: those that take [`super::MAX_REACH_MM`] to below [`WITHIN_MM`], and as many
/// again for curves that run unevenly.
const MAX_HALVINGS: u32 = 40;

/// A piece of an outline. Its ends are exact.
#[derive(Clone, Copy, Debug)]
pub(super) enum Curve {
    Line(Point, Point),
    Bezier(CubicBez),
    Arc(Arc),
}

/// A piece of an ellipse.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    center: Point,
    u: Vec2,
    v: Vec2,
    /// t at its ends, at most a turn apart.
    t: [f64; 2],
    ends: [Point; 2],
}

impl Arc {
    /// SVG 2, appendix B.2.4 and B.2.5, solved on the unit circle. `None` if it is straight.
    pub(super) fn from_svg(
        from: Point,
        to: Point,
        radii: [f64; 2],
        turn_rad: f64,
        large: bool,
        sweep: bool,
    ) -> Option<Self> {
        let frame = Affine::rotate(turn_rad) * Affine::scale_non_uniform(radii[0], radii[1]);
        let to_unit = Affine::scale_non_uniform(radii[0].recip(), radii[1].recip())
            * Affine::rotate(-turn_rad);
        let (a, b) = ((to_unit * from).to_vec2(), (to_unit * to).to_vec2());
        let half = (b - a) / 2.0;
        // Radii too small to reach are scaled up until they do.
        let grow = half.hypot().max(1.0);
        let (a, b, half) = (a / grow, b / grow, half / grow);
        let side = if large == sweep { -1.0 } else { 1.0 };
        let off = side * (1.0 - half.hypot2()).max(0.0).sqrt() / half.hypot();
        let center = (a + b) / 2.0 + Vec2::new(-half.y, half.x) * off;
        let [from_t, mut to_t] = [(a - center).atan2(), (b - center).atan2()];
        if sweep && to_t < from_t {
            to_t += TAU;
        } else if !sweep && to_t > from_t {
            to_t -= TAU;
        }
        let [u, v] = [Vec2::new(grow, 0.0), Vec2::new(0.0, grow)].map(|w| linear(frame, w));
        let center = frame * (center * grow).to_point();
        let arc = Self { center, u, v, t: [from_t, to_t], ends: [from, to] };
        (arc.is_finite() && from != to).then_some(arc)
    }

    fn is_finite(&self) -> bool {
        let numbers = [self.center.to_vec2(), self.u, self.v, Vec2::new(self.t[0], self.t[1])];
        numbers.iter().all(|n| n.is_finite())
    }

    fn at(&self, t: f64) -> Point {
        let (sin, cos) = t.sin_cos();
        self.center + self.u * cos + self.v * sin
    }

    /// The way it goes at t.
    fn direction(&self, t: f64) -> Vec2 {
        let (sin, cos) = t.sin_cos();
        (self.v * cos - self.u * sin) * (self.t[1] - self.t[0]).signum()
    }

    /// t, in its order, where it turns back along x or y.
    fn turns(&self) -> Vec<f64> {
        let [low, high] = [self.t[0].min(self.t[1]), self.t[0].max(self.t[1])];
        let mut turns = Vec::new();
        for first in [self.v.x.atan2(self.u.x), self.v.y.atan2(self.u.y)] {
            let mut t = first + ((low - first) / PI).ceil() * PI;
            while t < high {
                turns.push(t);
                t += PI;
            }
        }
        turns.sort_by(f64::total_cmp);
        if self.t[1] < self.t[0] {
            turns.reverse();
        }
        turns
    }

    fn between(&self, t: [f64; 2], ends: [Point; 2]) -> Self {
        Self { t, ends, ..*self }
    }

    fn parts(&self) -> Vec<Curve> {
        let mut parts = Vec::new();
        let (mut t, mut from) = (self.t[0], self.ends[0]);
        for turn in self.turns() {
            let to = self.at(turn);
            parts.push(Curve::Arc(self.between([t, turn], [from, to])));
            (t, from) = (turn, to);
        }
        parts.push(Curve::Arc(self.between([t, self.t[1]], [from, self.ends[1]])));
        parts
    }
}

/// The linear part of a map.
fn linear(map: Affine, w: Vec2) -> Vec2 {
    let [a, b, c, d, ..] = map.as_coeffs();
    Vec2::new(a * w.x + c * w.y, b * w.x + d * w.y)
}

impl Curve {
    pub(super) fn line(from: (f64, f64), to: (f64, f64)) -> Self {
        Self::Line(from.into(), to.into())
    }

    pub(super) fn start(&self) -> Point {
        match self {
            Self::Line(from, _) => *from,
            Self::Bezier(bezier) => bezier.p0,
            Self::Arc(arc) => arc.ends[0],
        }
    }

    pub(super) fn end(&self) -> Point {
        match self {
            Self::Line(_, to) => *to,
            Self::Bezier(bezier) => bezier.p3,
            Self::Arc(arc) => arc.ends[1],
        }
    }

    /// Whether it is made of numbers, all of its ends and control points within `reach` of a place.
    pub(super) fn is_near(&self, place: Point, reach: f64) -> bool {
        let near = |p: Point| (p.x - place.x).abs() <= reach && (p.y - place.y).abs() <= reach;
        match self {
            Self::Line(from, to) => near(*from) && near(*to),
            Self::Bezier(b) => [b.p0, b.p1, b.p2, b.p3].into_iter().all(near),
            Self::Arc(arc) => arc.is_finite() && arc.ends.into_iter().all(near),
        }
    }

    pub(super) fn transformed(&self, map: Affine) -> Self {
        match self {
            Self::Line(from, to) => Self::Line(map * *from, map * *to),
            Self::Bezier(bezier) => Self::Bezier(map * *bezier),
            Self::Arc(arc) => Self::Arc(Arc {
                center: map * arc.center,
                u: linear(map, arc.u),
                v: linear(map, arc.v),
                t: arc.t,
                ends: arc.ends.map(|end| map * end),
            }),
        }
    }

    pub(super) fn reversed(&self) -> Self {
        match self {
            Self::Line(from, to) => Self::Line(*to, *from),
            Self::Bezier(b) => Self::Bezier(CubicBez::new(b.p3, b.p2, b.p1, b.p0)),
            Self::Arc(arc) => {
                let ([t0, t1], [from, to]) = (arc.t, arc.ends);
                Self::Arc(arc.between([t1, t0], [to, from]))
            }
        }
    }

    /// Pieces that each go one way along x and one way along y and curve to one side only.
    pub(super) fn parts(&self) -> Vec<Self> {
        match self {
            Self::Line(..) => vec![*self],
            Self::Bezier(bezier) => {
                let mut t = vec![0.0, 1.0];
                t.extend(bezier.extrema());
                t.extend(bezier.inflections());
                t.sort_by(f64::total_cmp);
                t.dedup();
                t.windows(2).map(|t| Self::Bezier(bezier.subsegment(t[0]..t[1]))).collect()
            }
            Self::Arc(arc) => arc.parts(),
        }
    }

    fn middle(&self) -> Point {
        match self {
            Self::Line(from, to) => from.midpoint(*to),
            Self::Bezier(bezier) => bezier.eval(0.5),
            Self::Arc(arc) => arc.at(arc.t[0].midpoint(arc.t[1])),
        }
    }

    /// The radius of its circle, if it is a piece of one.
    pub(super) fn circle_radius(&self) -> Option<f64> {
        let Self::Arc(Arc { u, v, .. }) = self else { return None };
        let (uu, vv, uv) = (u.hypot2(), v.hypot2(), u.dot(*v));
        let radius = ((uu + vv) / 2.0).sqrt();
        // The difference of the squared semi-axes is 2·hypot((u² - v²)/2, u·v).
        let difference = ((uu - vv) / 2.0).hypot(uv) / radius;
        (difference <= CIRCLE_MM).then_some(radius)
    }

    /// Whether a part lies to the right of its chord, by the noise at least: for one that goes outward
    /// and upward that is below.
    pub(super) fn sags(&self) -> bool {
        self.bulge_mm() < -NOISE_MM
    }

    /// Whether a part can't be told from its chord.
    fn is_straight(&self) -> bool {
        match self {
            Self::Line(..) => true,
            Self::Bezier(b) => {
                let off = |p| distance(p, b.p0, b.p3).abs() <= NOISE_MM;
                off(b.p1) && off(b.p2)
            }
            Self::Arc(_) => self.bulge_mm().abs() <= NOISE_MM,
        }
    }

    /// How far its middle lies to the left of its chord.
    fn bulge_mm(&self) -> f64 {
        distance(self.middle(), self.start(), self.end())
    }

    fn halves(&self) -> [Self; 2] {
        match self {
            Self::Line(from, to) => {
                let middle = from.midpoint(*to);
                [Self::Line(*from, middle), Self::Line(middle, *to)]
            }
            Self::Bezier(bezier) => {
                let (first, second) = bezier.subdivide();
                [Self::Bezier(first), Self::Bezier(second)]
            }
            Self::Arc(arc) => {
                let ([t0, t1], [from, to]) = (arc.t, arc.ends);
                let (t, middle) = (t0.midpoint(t1), self.middle());
                [([t0, t], [from, middle]), ([t, t1], [middle, to])]
                    .map(|(t, ends)| Self::Arc(arc.between(t, ends)))
            }
        }
    }

    /// The way it sets out, and the way it arrives. A Bézier curve's is that of its control polygon.
    fn directions(&self) -> [Vec2; 2] {
        match self {
            Self::Line(from, to) => [*to - *from; 2],
            Self::Bezier(b) => {
                let first = |ways: [Vec2; 3]| {
                    ways.into_iter().find(|way| way.hypot2() > 0.0).unwrap_or_default()
                };
                [
                    first([b.p1 - b.p0, b.p2 - b.p0, b.p3 - b.p0]),
                    first([b.p3 - b.p2, b.p3 - b.p1, b.p3 - b.p0]),
                ]
            }
            Self::Arc(arc) => arc.t.map(|t| arc.direction(t)),
        }
    }

    /// Where the tangents at its ends meet, if that is between them, as on any part of less than a
    /// quarter turn. The part lies within the triangle of this corner and its ends.
    fn corner(&self) -> Option<Point> {
        let [out, into] = self.directions();
        let (a, b) = (self.start(), self.end());
        let turn = out.cross(into);
        let [along, back] = [(b - a).cross(into) / turn, out.cross(b - a) / turn];
        let corner = a + out * along;
        let box_of = |p: f64, a: f64, b: f64| p.clamp(a.min(b), a.max(b));
        let between = along >= 0.0 && back >= 0.0 && corner.is_finite();
        between.then(|| Point::new(box_of(corner.x, a.x, b.x), box_of(corner.y, a.y, b.y)))
    }

    /// The points of a chain of lines from the start of a part, which is not among them, to its end.
    /// The chain lies to the right of the part by at most [`WITHIN_MM`]; by [`NOISE_MM`] it may lie to
    /// its left. It ends early at [`MAX_SEGMENTS`].
    pub(super) fn flattened(&self) -> Vec<Point> {
        let mut points = Vec::new();
        self.flatten(self.bulge_mm() < 0.0, MAX_HALVINGS, &mut points);
        points.push(self.end());
        points
    }

    /// With `tangents`, the corners of tangents; else the ends of chords.
    fn flatten(&self, tangents: bool, halvings: u32, points: &mut Vec<Point>) {
        let (from, to) = (self.start(), self.end());
        if points.len() > MAX_SEGMENTS {
            return;
        }
        if halvings == 0 || self.is_straight() || from.distance(to) <= NOISE_MM {
            return points.push(to);
        }
        let corner = self.corner().filter(|c| distance(*c, from, to).abs() <= WITHIN_MM);
        if let Some(corner) = corner {
            return points.push(if tangents { corner } else { to });
        }
        for half in self.halves() {
            half.flatten(tangents, halvings - 1, points);
        }
    }
}

/// How far a place lies to the left of the line from `a` to `b`, x to the right and y up.
fn distance(place: Point, a: Point, b: Point) -> f64 {
    let chord = b - a;
    if chord.hypot2() > 0.0 { chord.cross(place - a) / chord.hypot() } else { place.distance(a) }
}

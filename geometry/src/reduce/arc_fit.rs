//! The arc over a run of points in a plane.
//!
//! All arcs from A to B are told apart by one number, the *bulge* β = tan(φ/2), φ the angle turned through,
//! positive to the left of AB. In the frame of the chord, s along AB, h to its left, L its length, the arc
//! through a point is that of
//!
//! ```text
//! β(s, h) = L h / (s (L − s) − h²)
//! ```
//!
//! (the inscribed angle over AB is the same all along an arc, and is π − φ/2). At each s an arc rises with β,
//! so that each place that the arc may not pass on one side of bounds β from one side, and what is left of
//! all bounds is an interval. Its middle is taken.
//!
//! *Upright* (u along the pass, v up) the arc is held against the path at the same place in plan: it may pass
//! `above` over it and `below` under it. Along a leg of the path β is a linear function over a quadratic one,
//! N/D, so its extremes lie at the ends or at the roots of N'D − ND', a quadratic: no place between two
//! points is overlooked. *Level*, distances are measured from the centre: at each angle the path and the arc
//! are |r − R| apart, which bounds how far each leaves the other. The extremes lie at points and at the foot
//! of the centre on a leg. The directions towards the centre are those of a first arc, through the point
//! farthest from the chord.
//!
//! Whatever was found is measured with the very centre that is returned, and dropped if it exceeds the
//! tolerances. Upright, arcs that are steep at an end are left out: see [`STEEPEST`].

use super::Deviation;
use super::chord::Band;
use glam::DVec2;
use std::f64::consts::FRAC_PI_2;

/// The greatest bulge: arcs turn through 150° at most. Closer to half a circle their ends no longer hold the
/// middle where a controller's rounding moves the centre.
const MOST_BULGE: f64 = 3.732;

/// Arcs closer to their chord are none, in mm: rounded to a controller's steps of 0.001 mm they
/// would become lines.
const LEAST_SAGITTA_MM: f64 = 0.003;

/// The least radius, in mm: with a finer one, the rounding of a centre to 0.001 mm or 0.0001 in turns
/// the arc by some per cent.
pub(super) const LEAST_RADIUS_MM: f64 = 0.05;

/// The greatest radius, in mm: half of what dialects take.
pub(super) const MOST_RADIUS_MM: f64 = 5000.0;

/// Upright arcs keep their ends this share of the angle away from the vertical.
const STEEPEST: f64 = 0.02;

/// What was found over a run.
#[derive(Clone, Copy, Debug)]
pub(super) enum Fit {
    /// Nothing that holds.
    Nothing,
    /// A line, or an arc too flat for controllers.
    Flat,
    /// An arc.
    Arc(Arc),
}

/// An arc between the ends of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    pub(super) center: DVec2,
    pub(super) deviation: Deviation,
}

/// How arcs are held against a path.
pub(super) enum Gauge<'a> {
    /// In height, at the same place in plan.
    Upright(&'a Band),
    /// From the centre, within so many mm.
    Level(f64),
}

impl Gauge<'_> {
    /// The arc from the first to the last of three points or more.
    pub(super) fn fit(&self, points: &[DVec2]) -> Fit {
        let [start, between @ .., end] = points else { return Fit::Nothing };
        let Some(chord) = Chord::new(*start, *end) else { return Fit::Nothing };
        let limits = match self {
            Self::Upright(band) => chord.upright(points, band),
            Self::Level(tolerance) => chord.level(points, between, *tolerance),
        };
        let Some(limits) = limits else { return Fit::Nothing };
        match limits {
            (least, greatest) if least <= 0.0 && greatest >= 0.0 => Fit::Flat,
            limits => self.settle(&chord, points, limits),
        }
    }

    /// Takes the middle of what is allowed of a bulge to one side.
    fn settle(&self, chord: &Chord, points: &[DVec2], (least, greatest): (f64, f64)) -> Fit {
        let side = if least > 0.0 { 1.0 } else { -1.0 };
        let (flattest, roundest) =
            (least.abs().min(greatest.abs()), least.abs().max(greatest.abs()));
        let (lowest, highest) = chord.writable(matches!(self, Self::Upright(_)));
        if roundest < lowest {
            return Fit::Flat;
        }
        let (flattest, roundest) = (flattest.max(lowest), roundest.min(highest));
        if flattest > roundest {
            return Fit::Nothing;
        }
        let center = chord.center(side * (flattest + roundest) / 2.0);
        match self.measure(points, center) {
            Some(deviation) if self.holds(&deviation) => Fit::Arc(Arc { center, deviation }),
            _ => Fit::Nothing,
        }
    }

    fn holds(&self, deviation: &Deviation) -> bool {
        match self {
            Self::Upright(band) => deviation.above <= band.above && deviation.below <= band.below,
            Self::Level(tolerance) => deviation.distance <= *tolerance,
        }
    }

    /// How far the arc about a centre and the path through the points leave each other; `None` where they
    /// do not go the same way.
    fn measure(&self, points: &[DVec2], center: DVec2) -> Option<Deviation> {
        match self {
            Self::Upright(_) => measure_upright(points, center),
            Self::Level(_) => measure_level(points, center),
        }
    }
}

/// The line from the first to the last point of a run.
struct Chord {
    start: DVec2,
    along: DVec2,
    length: f64,
}

impl Chord {
    fn new(start: DVec2, end: DVec2) -> Option<Self> {
        let length = start.distance(end);
        let along = (end - start) / length;
        (length > 0.0 && along.is_finite()).then_some(Self { start, along, length })
    }

    /// Along the chord and to its left.
    fn place(&self, point: DVec2) -> DVec2 {
        let from_start = point - self.start;
        DVec2::new(self.along.dot(from_start), self.along.perp_dot(from_start))
    }

    /// The bulge of the arc through a place; endless where none of less than half a circle goes.
    fn bulge(&self, place: DVec2) -> f64 {
        let under = place.x * (self.length - place.x) - place.y * place.y;
        match under > 0.0 {
            true => self.length * place.y / under,
            false => f64::INFINITY.copysign(place.y),
        }
    }

    /// The places on the leg from `a` to `b`, ends excluded, where the bulge is least or greatest.
    fn turning_places(&self, a: DVec2, b: DVec2) -> impl Iterator<Item = DVec2> {
        let leg = b - a;
        let under = a.x * (self.length - a.x) - a.y * a.y;
        let first = leg.x * (self.length - 2.0 * a.x) - 2.0 * a.y * leg.y;
        let square = leg.length_squared();
        let (p, q, r) = (leg.y * square, a.y * square, leg.y * under - a.y * first);
        // p t² + 2 q t + r = 0, both roots without cancellation.
        let root = (q * q - p * r).sqrt();
        let sum = -(q + root.copysign(q));
        let shares = [sum / p, r / sum].into_iter().filter(|t| 0.0 < *t && *t < 1.0);
        shares.map(move |t| a + leg * t)
    }

    /// The bulges that pass all legs within the band.
    fn upright(&self, points: &[DVec2], band: &Band) -> Option<(f64, f64)> {
        let over = DVec2::new(self.along.y, self.along.x);
        let (mut least, mut greatest) = (f64::NEG_INFINITY, f64::INFINITY);
        for point in &points[1..points.len() - 1] {
            let place = self.place(*point);
            least = least.max(self.bulge(place - over * band.below));
            greatest = greatest.min(self.bulge(place + over * band.above));
            if least > greatest {
                return None;
            }
        }
        // Between two points a hill rises farthest over the path, a valley dips farthest below it.
        let (hill, valley) = (least > 0.0, greatest < 0.0);
        if hill || valley {
            let shift = if hill { over * band.above } else { over * -band.below };
            for leg in points.windows(2) {
                let [a, b] = [leg[0], leg[1]].map(|point| self.place(point) + shift);
                for place in self.turning_places(a, b) {
                    let bulge = self.bulge(place);
                    (least, greatest) = match hill {
                        true => (least, greatest.min(bulge)),
                        false => (least.max(bulge), greatest),
                    };
                }
                if least > greatest {
                    return None;
                }
            }
        }
        Some((least, greatest))
    }

    /// The bulges that pass all points and legs within a distance, towards the centre of a first arc.
    fn level(&self, points: &[DVec2], between: &[DVec2], tolerance: f64) -> Option<(f64, f64)> {
        let places = || between.iter().map(|point| self.place(*point));
        let farthest = places().reduce(|a, b| if b.y.abs() > a.y.abs() { b } else { a })?;
        if farthest.y.abs() <= tolerance {
            let ordered = places().all(|place| (0.0..=self.length).contains(&place.x));
            return ordered.then_some((0.0, 0.0));
        }
        let (lowest, highest) = self.writable(false);
        let first = self.bulge(farthest).abs().clamp(lowest, highest.max(lowest));
        let center = self.center(first.copysign(farthest.y));
        let feet = points.windows(2).filter_map(|leg| foot(leg[0], leg[1], center));
        let (mut least, mut greatest) = (f64::NEG_INFINITY, f64::INFINITY);
        for point in between.iter().copied().chain(feet) {
            let shift = (point - center).normalize_or_zero() * tolerance;
            let bulges = [point - shift, point + shift].map(|p| self.bulge(self.place(p)));
            least = least.max(bulges[0].min(bulges[1]));
            greatest = greatest.min(bulges[0].max(bulges[1]));
            if least > greatest {
                return None;
            }
        }
        Some((least, greatest))
    }

    /// The least and the greatest bulge, to either side, that controllers take, and of an upright arc that
    /// does not stand on end.
    fn writable(&self, upright: bool) -> (f64, f64) {
        let share = 2.0 * LEAST_SAGITTA_MM / self.length;
        let seen = if share < 1.0 { 2.0 * share / (1.0 - share * share) } else { f64::INFINITY };
        let of_radius = |radius: f64| {
            let across = 2.0 * radius / self.length;
            if across > 1.0 { 1.0 / (across * across - 1.0).sqrt() } else { f64::INFINITY }
        };
        let steep = if upright {
            (FRAC_PI_2 - self.along.y.atan2(self.along.x).abs()).max(0.0)
        } else {
            FRAC_PI_2
        };
        let steepest = (steep * (1.0 - STEEPEST)).tan();
        let lowest = seen.max(of_radius(MOST_RADIUS_MM));
        (lowest, MOST_BULGE.min(of_radius(LEAST_RADIUS_MM)).min(steepest))
    }

    /// The centre of an arc.
    fn center(&self, bulge: f64) -> DVec2 {
        let middle = self.start + self.along * (self.length / 2.0);
        middle - self.along.perp() * (self.length / (2.0 * bulge))
    }
}

/// The foot of a point on a leg, if it lies between the leg's ends.
fn foot(a: DVec2, b: DVec2, from: DVec2) -> Option<DVec2> {
    let leg = b - a;
    let share = (from - a).dot(leg) / leg.length_squared();
    (0.0 < share && share < 1.0).then(|| a + leg * share)
}

fn measure_upright(points: &[DVec2], center: DVec2) -> Option<Deviation> {
    let [start, .., end] = points else { return None };
    let radius = (start.distance(center) + end.distance(center)) / 2.0;
    // A hill's centre lies to the right of its chord.
    let side = -(*end - *start).perp_dot(center - *start).signum();
    let height = |u: f64| {
        let from_center = u - center.x;
        center.y + side * (radius * radius - from_center * from_center).sqrt()
    };
    let mut worst = Deviation::default();
    for leg in points.windows(2) {
        let [a, b] = [leg[0], leg[1]];
        let slope = (b.y - a.y) / (b.x - a.x);
        // Where the arc runs along the leg's way.
        let along = center.x - side * radius * slope / slope.hypot(1.0);
        let between = (a.x < along && along < b.x).then_some(along);
        for u in between.into_iter().chain((b != *end).then_some(b.x)) {
            let above = height(u) - (a.y + slope * (u - a.x));
            // Off the circle's side there is no height.
            if !above.is_finite() {
                return None;
            }
            worst.rise(above);
        }
    }
    Some(worst)
}

fn measure_level(points: &[DVec2], center: DVec2) -> Option<Deviation> {
    let [start, .., end] = points else { return None };
    let radius = (start.distance(center) + end.distance(center)) / 2.0;
    let middle = (*start + *end) / 2.0 - center;
    let turn = (*start - center).perp_dot(*end - center).signum();
    let mut worst = Deviation::default();
    for leg in points.windows(2) {
        let [a, b] = [leg[0] - center, leg[1] - center];
        let onward = a.perp_dot(b) * turn > 0.0 && b.dot(middle) > 0.0;
        if !onward {
            return None;
        }
        let nearest = foot(leg[0], leg[1], center);
        for place in nearest.into_iter().chain([leg[1]].into_iter().filter(|b| b != end)) {
            worst.distance = worst.distance.max((place.distance(center) - radius).abs());
        }
    }
    worst.distance.is_finite().then_some(worst)
}

//! How far it is from a point of the surface, along its normal, into what moves sweep out.
//!
//! | symbol | meaning |
//! |---|---|
//! | P, n | point and unit normal |
//! | A, B | ends of a move: centres of the sphere |
//! | R | its radius |
//!
//! A sphere along A B sweeps out a capsule: two spheres and a cylinder. The ray P + t·n enters it at the least
//! t at which it enters one of them, the cylinder between its ends only.

use crate::{ContactKind, Profile, Segment};
use glam::{DVec2, DVec3};

/// A contact so close to upright, as the cosine of its slope, is a wall: there h'(r) has no digits left.
const UPRIGHT: f64 = 1e-3;

/// Golden section, as a share.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Steps of a search along a move: its length shrinks to 2e-4, and near the least the height is off by the
/// square of that.
const SEARCHES: usize = 18;

/// A point of the surface where the cutter touched it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touched {
    /// The point, raised by the allowance.
    pub(super) point: DVec3,
    /// The normal, unit.
    pub(super) normal: DVec3,
}

/// The shape that sweeps.
pub(super) enum Sweep<'a> {
    /// A ball's sphere, by its radius.
    Ball(f64),
    /// Any convex profile.
    Other(&'a Profile),
}

impl<'a> Sweep<'a> {
    pub(super) fn new(profile: &'a Profile) -> Self {
        match *profile.segments() {
            [Segment::Arc { to, center: [0.0, _] }] if to[0] == to[1] => Self::Ball(to[0]),
            _ => Self::Other(profile),
        }
    }

    /// Where a dropped cutter touches; `None` if it touches nothing, or a wall.
    pub(super) fn touched(
        &self,
        tip: DVec3,
        contact: &crate::Contact,
        allowance_mm: f64,
    ) -> Option<Touched> {
        if contact.kind == ContactKind::None {
            return None;
        }
        if self.is_flat_at(tip, contact.point) {
            // The surface touches the bottom anywhere; what comes of it is level under the axis.
            return Some(Touched { point: tip, normal: DVec3::Z });
        }
        let normal = match self {
            Self::Ball(radius) => (tip + DVec3::Z * radius - contact.point).try_normalize()?,
            Self::Other(profile) => normal_of(profile, tip, contact.point, allowance_mm)?,
        };
        let point = match self {
            Self::Ball(radius) => tip + DVec3::Z * radius - normal * radius,
            Self::Other(_) => contact.point + normal * allowance_mm,
        };
        (normal.z > UPRIGHT).then_some(Touched { point, normal })
    }

    /// Whether a contact lies under a flat bottom.
    fn is_flat_at(&self, tip: DVec3, contact: DVec3) -> bool {
        match self {
            Self::Ball(_) => false,
            Self::Other(profile) => {
                let r = tip.truncate().distance(contact.truncate());
                matches!(profile.segments()[0], Segment::Line { to: [end, 0.0] } if r <= end)
            }
        }
    }

    /// What stands on a point after a move from tip to tip, along the normal, in mm; infinite if the move
    /// leaves it as it was.
    pub(super) fn left_mm(&self, at: &Touched, from: DVec3, to: DVec3) -> f64 {
        match self {
            Self::Ball(radius) => {
                let up = DVec3::Z * *radius;
                into_capsule(at, from + up, to + up, *radius)
            }
            Self::Other(profile) => {
                ((least_above(profile, at.point, from, to) - at.point.z) * at.normal.z).max(0.0)
            }
        }
    }
}

/// The normal where a cutter touches a point: the cutter's own, turned round. With an allowance the point is
/// off the cutter; it is looked for along the normal.
fn normal_of(profile: &Profile, tip: DVec3, point: DVec3, allowance_mm: f64) -> Option<DVec3> {
    let out = point.truncate() - tip.truncate();
    let away = out.normalize_or_zero();
    let radius = profile.radius_mm();
    let delta = radius * 1e-7;
    let normal_at = |r: f64| {
        let (low, high) = ((r - delta).max(0.0), (r + delta).min(radius));
        let rise = (profile.height(high) - profile.height(low)) / (high - low);
        DVec2::new(-rise, 1.0).normalize()
    };
    // r + a·sin = the distance of the point: at an allowance of 0 the first is right.
    let mut r = out.length().min(radius);
    if allowance_mm > 0.0 {
        let (mut low, mut high) = (0.0, radius);
        for _ in 0..50 {
            r = (low + high) / 2.0;
            let beyond = r - normal_at(r).x * allowance_mm > out.length();
            (low, high) = if beyond { (low, r) } else { (r, high) };
        }
    }
    let normal = normal_at(r);
    normal.is_finite().then(|| (away * normal.x).extend(normal.y))
}

/// The way along the normal into a capsule.
fn into_capsule(at: &Touched, a: DVec3, b: DVec3, radius: f64) -> f64 {
    let Touched { point, normal } = *at;
    let ends = into_sphere(point - a, normal, radius).min(into_sphere(point - b, normal, radius));
    let way = b - a;
    let length2 = way.length_squared();
    if ends == 0.0 || length2 == 0.0 {
        return ends;
    }
    let from = point - a;
    let across = |v: DVec3| v - way * (v.dot(way) / length2);
    let (off, aim) = (across(from), across(normal));
    let (square, half, rest) =
        (aim.length_squared(), off.dot(aim), off.length_squared() - radius * radius);
    let t = if rest <= 0.0 {
        0.0
    } else {
        let under = half * half - square * rest;
        let t = (-half - under.max(0.0).sqrt()) / square;
        // Along the axis, beside it, or behind.
        if square == 0.0 || under < 0.0 || t < 0.0 {
            return ends;
        }
        t
    };
    let share = (from + normal * t).dot(way) / length2;
    if (0.0..=1.0).contains(&share) { ends.min(t) } else { ends }
}

/// The way along a unit vector into a sphere about 0.
fn into_sphere(from: DVec3, aim: DVec3, radius: f64) -> f64 {
    let (half, rest) = (from.dot(aim), from.length_squared() - radius * radius);
    if rest <= 0.0 {
        return 0.0;
    }
    let under = half * half - rest;
    if under >= 0.0 && half <= 0.0 { -half - under.sqrt() } else { f64::INFINITY }
}

/// The lowest that a cutter's surface comes over a point along a move, in mm. It is convex along it.
fn least_above(profile: &Profile, point: DVec3, from: DVec3, to: DVec3) -> f64 {
    let (start, way) = (from.truncate() - point.truncate(), (to - from).truncate());
    let radius = profile.radius_mm();
    // Where the point is under the cutter: |start + u·way| ≤ R.
    let (square, half) = (way.length_squared(), start.dot(way));
    let rest = start.length_squared() - radius * radius;
    let under = half * half - square * rest;
    let (mut low, mut high) = if square > 0.0 {
        if under < 0.0 {
            return f64::INFINITY;
        }
        let root = under.sqrt();
        (((-half - root) / square).max(0.0), ((-half + root) / square).min(1.0))
    } else {
        (0.0, 0.0)
    };
    if low > high {
        return f64::INFINITY;
    }
    let above = |u: f64| {
        // At the rim rounding must not count as beyond.
        let r = (start + way * u).length();
        if r > radius * (1.0 + 1e-12) {
            f64::INFINITY
        } else {
            from.z + (to.z - from.z) * u + profile.height(r.min(radius))
        }
    };
    let ends = above(low).min(above(high));
    let (mut c, mut d) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut at_c, mut at_d) = (above(c), above(d));
    for _ in 0..SEARCHES {
        if at_c < at_d {
            (high, d, at_d) = (d, c, at_c);
            c = high - GOLDEN * (high - low);
            at_c = above(c);
        } else {
            (low, c, at_c) = (c, d, at_d);
            d = low + GOLDEN * (high - low);
            at_d = above(d);
        }
    }
    ends.min(at_c).min(at_d)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touched(x: f64, y: f64, z: f64, normal: DVec3) -> Touched {
        Touched { point: DVec3::new(x, y, z), normal: normal.normalize() }
    }

    #[test]
    fn a_ball_leaves_the_closed_form_beside_a_level_move() {
        let ball = Profile::ball(3.0).unwrap();
        let sweep = Sweep::new(&ball);
        let (from, to) = (DVec3::new(-5.0, 0.0, 0.0), DVec3::new(5.0, 0.0, 0.0));
        for half in [0.0, 0.3, 1.0, 2.5_f64] {
            let left = sweep.left_mm(&touched(0.3, half, 0.0, DVec3::Z), from, to);
            assert!((left - (3.0 - (9.0 - half * half).sqrt())).abs() < 1e-12, "{left}");
        }
        assert_eq!(sweep.left_mm(&touched(0.0, 3.1, 0.0, DVec3::Z), from, to), f64::INFINITY);
        assert_eq!(sweep.left_mm(&touched(9.0, 0.0, 0.0, DVec3::Z), from, to), f64::INFINITY);
    }

    /// By walking along the normal until a sphere somewhere on the move is entered.
    #[test]
    fn the_way_into_a_capsule_is_what_walking_finds() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut place = move || DVec3::from_array([0; 3].map(|_| random.f64() * 4.0 - 2.0));
        let mut entered = 0;
        for _ in 0..400 {
            let (a, b, point, normal) = (place(), place(), place(), place().normalize());
            let found = into_capsule(&Touched { point, normal }, a, b, 1.0);
            let away = |t: f64| {
                let p = point + normal * t;
                let u = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                p.distance(a.lerp(b, u)) - 1.0
            };
            let walked = (0..80_000).map(|k| f64::from(k) * 1e-4).find(|t| away(*t) <= 0.0);
            match walked {
                Some(t) => assert!((t - found).abs() <= 1.1e-4, "{t} {found}"),
                None => assert!(found > 7.9 || away(found) > -1e-6, "{found}"),
            }
            entered += usize::from(walked.is_some());
        }
        assert!(entered > 40, "{entered}");
    }

    #[test]
    fn a_profile_taken_upward_is_the_ball_on_planes() {
        let ball = Profile::ball(3.0).unwrap();
        let (exact, upward) = (Sweep::new(&ball), Sweep::Other(&ball));
        let (from, to) = (DVec3::new(-2.0, 0.0, 0.0), DVec3::new(2.0, 0.5, 1.0));
        for y in [0.1, 0.6, 1.0] {
            let at = touched(0.2, y, 0.0, DVec3::Z);
            let (a, b) = (exact.left_mm(&at, from, to), upward.left_mm(&at, from, to));
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }

    #[test]
    fn a_tapered_ball_touches_with_its_flank_across_it() {
        // 45° of flank from r = √½ on.
        let r = 0.5_f64.sqrt();
        let flank = Segment::Line { to: [3.0, 1.0 - r + 3.0 - r] };
        let segments = vec![Segment::Arc { to: [r, 1.0 - r], center: [0.0, 1.0] }, flank];
        let profile = Profile::new(segments).unwrap();
        let sweep = Sweep::new(&profile);
        let contact = |x: f64, z: f64| crate::Contact {
            point: DVec3::new(x, 0.0, z),
            kind: ContactKind::Facet,
        };
        let height = profile.height(2.0);
        let at = sweep.touched(DVec3::ZERO, &contact(2.0, height), 0.0).unwrap();
        assert!(at.normal.distance(DVec3::new(-r, 0.0, r)) < 1e-6, "{:?}", at.normal);
        // The point lies off by the allowance.
        let off = contact(2.0 + 0.3 * r, height - 0.3 * r);
        let at = sweep.touched(DVec3::ZERO, &off, 0.3).unwrap();
        assert!(at.point.distance(DVec3::new(2.0, 0.0, height)) < 1e-6, "{:?}", at.point);
    }
}

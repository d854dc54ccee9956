//! The shape of a cutter with an allowance around it.
//!
//! A cutter that is to leave an allowance a on a surface is dropped as if it were larger by a on
//! every side: no point of it then comes closer to the surface than a, on slopes and walls as on
//! level ground. The larger body is the Minkowski sum of the cutter and a ball of radius a. Of a
//! convex profile it is known in closed form: lines move out by a, arcs get a larger radius, and at
//! corners, the rim among them, an arc of radius a goes around.
//!
//! Of a profile with a notch (a form tool) the convex hull is taken first: more is left in the notch,
//! nowhere less than a.

use crate::profile::{Profile, ProfileError, Segment};

/// Normals whose cross product is less are one: no arc is put between.
const TANGENT: f64 = 1e-9;

/// The normal at the axis, and at the rim.
const DOWN: [f64; 2] = [0.0, -1.0];
const OUT: [f64; 2] = [1.0, 0.0];

/// An arc of a notched profile is replaced by this many tangents, which lie outside of it.
const TANGENTS: usize = 8;

impl Profile {
    /// The profile of this cutter grown by `allowance_mm` on every side. Its tip lies that much lower:
    /// where the grown cutter's tip is at z, the cutter's own is at z + allowance.
    ///
    /// # Errors
    /// If the allowance is not a length that can be added; 0 is one.
    pub fn grown(&self, allowance_mm: f64) -> Result<Self, ProfileError> {
        if allowance_mm == 0.0 {
            return Ok(self.clone());
        }
        if !(allowance_mm.is_finite() && allowance_mm > 0.0) {
            return Err(ProfileError::BadLength { what: "allowance", value: allowance_mm });
        }
        let chain = Chain::of(self);
        let chain = if chain.is_convex() { chain } else { chain.hull() };
        Self::new(chain.grown(allowance_mm))
    }
}

/// A piece of a profile, and its normals out of the cutter at both ends.
#[derive(Clone, Copy)]
struct Piece {
    from: [f64; 2],
    segment: Segment,
    begins: [f64; 2],
    ends: [f64; 2],
}

struct Chain(Vec<Piece>);

impl Piece {
    fn new(from: [f64; 2], segment: Segment) -> Self {
        let (begins, ends) = match segment {
            Segment::Line { to } => {
                let length = distance(from, to);
                let normal = [(to[1] - from[1]) / length, (from[0] - to[0]) / length];
                (normal, normal)
            }
            Segment::Arc { to, center } => {
                let normal = |p: [f64; 2]| {
                    let radius = distance(p, center);
                    [(p[0] - center[0]) / radius, (p[1] - center[1]) / radius]
                };
                (normal(from), normal(to))
            }
        };
        Self { from, segment, begins, ends }
    }
}

impl Chain {
    fn of(profile: &Profile) -> Self {
        Self(profile.pieces().map(|(from, segment)| Piece::new(from, *segment)).collect())
    }

    /// Whether the profile's direction never turns back.
    fn is_convex(&self) -> bool {
        self.0.windows(2).all(|pair| cross(pair[0].ends, pair[1].begins) > -TANGENT)
    }

    /// The convex hull, arcs replaced by tangents outside of them.
    fn hull(&self) -> Self {
        let mut corners = vec![[0.0; 2]];
        for piece in &self.0 {
            if let Segment::Arc { center, .. } = piece.segment {
                let radius = distance(piece.from, center);
                // 0 down to π/2 outward.
                let way = |normal: [f64; 2]| normal[0].atan2(-normal[1]);
                let step = (way(piece.ends) - way(piece.begins)) / TANGENTS as f64;
                let reach = radius / (step / 2.0).cos();
                corners.extend((0..TANGENTS).map(|k| {
                    let way = way(piece.begins) + (k as f64 + 0.5) * step;
                    // Not below the tip: level with it is outside of the arc as well.
                    [center[0] + reach * way.sin(), (center[1] - reach * way.cos()).max(0.0)]
                }));
            }
            corners.push(piece.segment.to());
        }
        // The outermost corner is the rim's: a tangent near it may reach beyond.
        let rim = corners[corners.len() - 1][0];
        corners.iter_mut().for_each(|corner| corner[0] = corner[0].min(rim));
        corners.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let mut hull: Vec<[f64; 2]> = Vec::new();
        for corner in corners {
            while hull.len() > 1 && !turns_up(hull[hull.len() - 2], hull[hull.len() - 1], corner) {
                hull.pop();
            }
            // Of corners one above the other only the lowest bounds the cutter from below.
            if hull.last().is_none_or(|last| corner[0] > last[0]) {
                hull.push(corner);
            }
        }
        let lines = hull.windows(2).map(|ends| Piece::new(ends[0], Segment::Line { to: ends[1] }));
        Self(lines.collect())
    }

    /// The segments of a convex chain moved out by `by`, from the tip of the new one.
    fn grown(&self, by: f64) -> Vec<Segment> {
        // The new tip lies `by` below the old one, so all heights count from there.
        let moved =
            |p: [f64; 2], normal: [f64; 2]| [p[0] + by * normal[0], p[1] + by + by * normal[1]];
        let mut segments = Vec::new();
        let mut normal = DOWN;
        let around = |segments: &mut Vec<Segment>, corner, normal, to| {
            if cross(normal, to) > TANGENT {
                let center = moved(corner, [0.0; 2]);
                segments.push(Segment::Arc { to: moved(corner, to), center });
            }
        };
        for piece in &self.0 {
            around(&mut segments, piece.from, normal, piece.begins);
            let to = moved(piece.segment.to(), piece.ends);
            segments.push(match piece.segment {
                Segment::Line { .. } => Segment::Line { to },
                Segment::Arc { center, .. } => Segment::Arc { to, center: moved(center, [0.0; 2]) },
            });
            normal = piece.ends;
        }
        if let Some(last) = self.0.last() {
            around(&mut segments, last.segment.to(), normal, OUT);
        }
        segments
    }
}

/// Positive if `b` points to the left of `a`.
fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Whether the way from `a` over `b` to `c` turns to the left.
fn turns_up(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> bool {
    cross([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const BY: f64 = 0.4;

    fn line(r: f64, h: f64) -> Segment {
        Segment::Line { to: [r, h] }
    }

    /// The grown profile's height as its definition has it: the least of h(r′) − √(a² − (r − r′)²), by
    /// trying many r′, and both sides of the axis.
    fn by_trial(profile: &Profile, r: f64) -> f64 {
        let (from, to) = ((r - BY).max(-profile.radius_mm()), (r + BY).min(profile.radius_mm()));
        let steps = 400_000;
        let least = (0..=steps).map(|k| {
            let other = from + (to - from) * f64::from(k) / f64::from(steps);
            profile.height(other.clamp(from, to)) - (BY * BY - (r - other).powi(2)).max(0.0).sqrt()
        });
        least.fold(f64::INFINITY, f64::min) + BY
    }

    #[test]
    fn balls_and_flats_grow_into_what_everybody_knows() {
        assert_eq!(Profile::ball(3.0).unwrap().grown(0.5), Profile::ball(3.5));
        assert_eq!(Profile::flat(3.0).unwrap().grown(0.5), Profile::bull_nose(3.5, 0.5));
        assert_eq!(Profile::flat(3.0).unwrap().grown(0.0), Profile::flat(3.0));
    }

    #[test]
    fn a_convex_profile_grows_by_the_allowance_on_every_side() {
        let profiles = [
            Profile::bull_nose(3.0, 1.0).unwrap(),
            Profile::new(vec![line(3.0, 4.0)]).unwrap(),
            Profile::new(vec![line(0.2, 0.0), line(2.0, 1.0), line(3.0, 5.0)]).unwrap(),
        ];
        for profile in profiles {
            let grown = profile.grown(BY).unwrap();
            assert!((grown.radius_mm() - profile.radius_mm() - BY).abs() < 1e-12);
            for k in 0..=40 {
                let r = grown.radius_mm() * f64::from(k) / 40.0;
                let (is, should) = (grown.height(r), by_trial(&profile, r));
                assert!((is - should).abs() < 1e-5, "r {r}: {is}, not {should}, of {profile:?}");
            }
        }
    }

    #[test]
    fn a_notched_profile_grows_by_no_less() {
        // A bead: its arc meets a lower slope.
        let arc = Segment::Arc { to: [1.0, 1.0], center: [0.0, 1.0] };
        let profile = Profile::new(vec![arc, line(3.0, 1.5), line(3.5, 4.0)]).unwrap();
        let grown = profile.grown(BY).unwrap();
        assert!((grown.radius_mm() - 3.5 - BY).abs() < 1e-12);
        for k in 0..=60 {
            let r = grown.radius_mm() * f64::from(k) / 60.0;
            let (is, most) = (grown.height(r), by_trial(&profile, r));
            assert!(is <= most + 1e-5, "r {r}: {is}, more than {most}");
        }
    }

    #[test]
    fn what_is_no_allowance_is_refused() {
        let ball = Profile::ball(3.0).unwrap();
        for bad in [-0.1, f64::NAN, f64::INFINITY] {
            assert!(matches!(ball.grown(bad), Err(ProfileError::BadLength { .. })));
        }
    }
}

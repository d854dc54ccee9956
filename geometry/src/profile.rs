//! The shape of a cutter: a body of revolution given by its profile.
//!
//! The profile is the height h(r) of the cutting surface above the tip at the distance r from the
//! axis, 0 ≤ r ≤ R. It is a chain of straight lines and circular arcs that starts at the tip
//! (0, 0) and never falls, neither in r nor in h. Arcs curve upward, like the lower right quarter
//! of a circle: their centre lies above their end and not to the right of their start.
//!
//! A line may stand upright (a shoulder): at its radius the height is that of its foot. Undercut
//! shapes (lollipops) have no such profile and can't be said.
//!
//! | symbol | meaning |
//! |---|---|
//! | r | distance from the cutter's axis, mm |
//! | h | height above the tip, mm |
//! | R | radius of the cutter: the r of the chain's last point, mm |

use serde::{Deserialize, Serialize};

/// How far the ends of an arc may lie off its circle, relative to the arc's radius. Shapes come
/// from plugins and text with some ten digits; the chain is used as written, so a larger gap
/// would show in the heights.
const ON_CIRCLE: f64 = 1e-9;

/// One piece of a profile, from the end of the piece before (the tip for the first one).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Segment {
    /// A straight piece.
    Line {
        /// Its end (r, h) in mm.
        to: [f64; 2],
    },
    /// A piece of a circle that curves upward.
    Arc {
        /// Its end (r, h) in mm.
        to: [f64; 2],
        /// The centre (r, h) of its circle in mm; its r may be negative.
        center: [f64; 2],
    },
}

impl Segment {
    /// The end (r, h) in mm.
    #[must_use]
    pub fn to(&self) -> [f64; 2] {
        match *self {
            Self::Line { to } | Self::Arc { to, .. } => to,
        }
    }
}

/// Why a chain of segments is no profile. Segments are counted from 1.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum ProfileError {
    /// No segment at all, or nothing but upright ones.
    #[error("the profile has no radius: it must reach some way out from the axis")]
    NoRadius,
    /// A NaN or an infinity.
    #[error("segment {0} of the profile holds a number that is not finite")]
    NotFinite(usize),
    /// The radius asked for is not a positive length.
    #[error("the cutter's {what} must be a positive length, not {value} mm")]
    BadLength {
        /// Which length.
        what: &'static str,
        /// What was given, in mm.
        value: f64,
    },
    /// A corner that does not fit.
    #[error("the corner radius {corner_mm} mm is larger than the cutter's radius {radius_mm} mm")]
    CornerTooLarge {
        /// Radius of the corner, in mm.
        corner_mm: f64,
        /// Radius of the cutter, in mm.
        radius_mm: f64,
    },
    /// Start and end are the same point.
    #[error("segment {0} of the profile has no length")]
    NoLength(usize),
    /// The chain goes inward or down.
    #[error(
        "segment {segment} of the profile goes back from r {from_r_mm}, h {from_h_mm} to r {to_r_mm}, h \
         {to_h_mm}; neither may fall"
    )]
    Falls {
        /// The segment.
        segment: usize,
        /// r of its start, in mm.
        from_r_mm: f64,
        /// h of its start, in mm.
        from_h_mm: f64,
        /// r of its end, in mm.
        to_r_mm: f64,
        /// h of its end, in mm.
        to_h_mm: f64,
    },
    /// The ends of an arc are not equally far from its centre.
    #[error(
        "the ends of arc {segment} of the profile lie {start_mm} mm and {end_mm} mm from its center; \
         they must be equal"
    )]
    OffCircle {
        /// The segment.
        segment: usize,
        /// Distance of the start from the centre, in mm.
        start_mm: f64,
        /// Distance of the end from the centre, in mm.
        end_mm: f64,
    },
    /// The arc curves downward or turns too far.
    #[error(
        "arc {0} of the profile must curve upward within the lower right quarter of its circle: \
         center above its end and not right of its start"
    )]
    NotConvex(usize),
}

/// The height h(r) of a cutter's surface above its tip, checked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Segment>", into = "Vec<Segment>")]
pub struct Profile {
    segments: Vec<Segment>,
}

/// A cutter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cutter {
    /// What people call it.
    pub name: String,
    /// Its shape.
    pub profile: Profile,
}

impl Profile {
    /// Makes a profile from segments, the first of which starts at the tip (0, 0).
    ///
    /// # Errors
    /// If a number is not finite, a segment has no length or falls, an arc's ends are not on its
    /// circle or it does not curve upward, or the chain has no radius.
    pub fn new(segments: Vec<Segment>) -> Result<Self, ProfileError> {
        let mut from = [0.0; 2];
        for (index, segment) in segments.iter().enumerate() {
            check(index + 1, from, segment)?;
            from = segment.to();
        }
        if from[0] > 0.0 { Ok(Self { segments }) } else { Err(ProfileError::NoRadius) }
    }

    /// A ball nose: one arc up to (R, R).
    ///
    /// # Errors
    /// If the radius is not a positive length.
    pub fn ball(radius_mm: f64) -> Result<Self, ProfileError> {
        let radius = positive("radius", radius_mm)?;
        Self::new(vec![Segment::Arc { to: [radius, radius], center: [0.0, radius] }])
    }

    /// A flat end mill: one line out to (R, 0).
    ///
    /// # Errors
    /// If the radius is not a positive length.
    pub fn flat(radius_mm: f64) -> Result<Self, ProfileError> {
        let radius = positive("radius", radius_mm)?;
        Self::new(vec![Segment::Line { to: [radius, 0.0] }])
    }

    /// A flat end mill whose corner is rounded: a flat end mill at corner radius 0, a ball nose at
    /// the full radius.
    ///
    /// # Errors
    /// If the radius is not a positive length, or the corner is negative or larger than it.
    pub fn bull_nose(radius_mm: f64, corner_radius_mm: f64) -> Result<Self, ProfileError> {
        let radius = positive("radius", radius_mm)?;
        if corner_radius_mm == 0.0 {
            return Self::flat(radius);
        }
        let corner = positive("corner radius", corner_radius_mm)?;
        if corner > radius {
            return Err(ProfileError::CornerTooLarge { corner_mm: corner, radius_mm: radius });
        }
        if corner == radius {
            return Self::ball(radius);
        }
        let flat = radius - corner;
        Self::new(vec![
            Segment::Line { to: [flat, 0.0] },
            Segment::Arc { to: [flat + corner, corner], center: [flat, corner] },
        ])
    }

    /// The chain, from the tip outward.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The chain with the start (r, h) of each segment in mm.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = ([f64; 2], &Segment)> {
        let starts = std::iter::once([0.0; 2]).chain(self.segments.iter().map(Segment::to));
        starts.zip(&self.segments)
    }

    /// R, in mm.
    #[must_use]
    pub fn radius_mm(&self) -> f64 {
        self.segments.last().map_or(0.0, |s| s.to()[0])
    }

    /// How round or wide the tip is: the radius of its arc or of its flat, in mm; 0 of a point.
    #[must_use]
    pub fn tip_radius_mm(&self) -> f64 {
        match self.segments.first() {
            Some(Segment::Arc { center, .. }) if center[0] >= 0.0 => center[0].hypot(center[1]),
            Some(Segment::Line { to }) if to[1] == 0.0 => to[0],
            _ => 0.0,
        }
    }

    /// h(r) in mm; infinite beyond R, for there the cutter touches nothing.
    #[must_use]
    pub fn height(&self, r_mm: f64) -> f64 {
        let r = r_mm.abs();
        for (from, segment) in self.pieces() {
            if r <= segment.to()[0] {
                return height_on(from, segment, r);
            }
        }
        f64::INFINITY
    }
}

/// h(r) on one segment, r between its ends.
fn height_on(from: [f64; 2], segment: &Segment, r: f64) -> f64 {
    match *segment {
        Segment::Line { to } if to[0] <= from[0] => from[1],
        Segment::Line { to } => from[1] + (r - from[0]) * ((to[1] - from[1]) / (to[0] - from[0])),
        Segment::Arc { to, center } => {
            let radius = (from[0] - center[0]).hypot(from[1] - center[1]);
            let out = r - center[0];
            let below = (radius * radius - out * out).max(0.0).sqrt();
            (center[1] - below).clamp(from[1], to[1])
        }
    }
}

fn positive(what: &'static str, value: f64) -> Result<f64, ProfileError> {
    let good = value.is_finite() && value > 0.0;
    if good { Ok(value) } else { Err(ProfileError::BadLength { what, value }) }
}

fn check(number: usize, from: [f64; 2], segment: &Segment) -> Result<(), ProfileError> {
    let to = segment.to();
    let center = if let Segment::Arc { center, .. } = *segment { center } else { [0.0; 2] };
    if !to.iter().chain(&center).all(|v| v.is_finite()) {
        return Err(ProfileError::NotFinite(number));
    }
    if to == from {
        return Err(ProfileError::NoLength(number));
    }
    if to[0] < from[0] || to[1] < from[1] {
        return Err(ProfileError::Falls {
            segment: number,
            from_r_mm: from[0],
            from_h_mm: from[1],
            to_r_mm: to[0],
            to_h_mm: to[1],
        });
    }
    if matches!(segment, Segment::Arc { .. }) {
        check_arc(number, from, to, center)
    } else {
        Ok(())
    }
}

fn check_arc(
    number: usize,
    from: [f64; 2],
    to: [f64; 2],
    center: [f64; 2],
) -> Result<(), ProfileError> {
    let distance = |p: [f64; 2]| (p[0] - center[0]).hypot(p[1] - center[1]);
    let (start, end) = (distance(from), distance(to));
    let slack = ON_CIRCLE * start.max(end);
    if (start - end).abs() > slack {
        return Err(ProfileError::OffCircle { segment: number, start_mm: start, end_mm: end });
    }
    let upward = center[0] <= from[0] + slack && to[1] <= center[1] + slack && to[0] > from[0];
    if upward { Ok(()) } else { Err(ProfileError::NotConvex(number)) }
}

impl TryFrom<Vec<Segment>> for Profile {
    type Error = ProfileError;

    fn try_from(segments: Vec<Segment>) -> Result<Self, ProfileError> {
        Self::new(segments)
    }
}

impl From<Profile> for Vec<Segment> {
    fn from(profile: Profile) -> Self {
        profile.segments
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_a_quarter_circle() {
        let ball = Profile::ball(3.0).unwrap();
        assert_eq!(ball.radius_mm(), 3.0);
        for r in [0.0, 0.1, 1.5, 2.9, 3.0] {
            let expected = 3.0 - (9.0_f64 - r * r).sqrt();
            assert!((ball.height(r) - expected).abs() < 1e-15);
        }
        assert_eq!(ball.height(3.000001), f64::INFINITY);
    }

    #[test]
    fn a_flat_is_flat() {
        let flat = Profile::flat(2.0).unwrap();
        assert_eq!((flat.height(0.0), flat.height(2.0)), (0.0, 0.0));
    }

    #[test]
    fn a_bull_nose_goes_from_flat_to_ball() {
        assert_eq!(Profile::bull_nose(3.0, 0.0), Profile::flat(3.0));
        assert_eq!(Profile::bull_nose(3.0, 3.0), Profile::ball(3.0));
        let bull = Profile::bull_nose(3.0, 1.0).unwrap();
        assert_eq!(bull.height(2.0), 0.0);
        assert!((bull.height(2.5) - (1.0 - 0.75_f64.sqrt())).abs() < 1e-15);
        assert_eq!(bull.height(3.0), 1.0);
        let error = Profile::bull_nose(3.0, 4.0).unwrap_err();
        assert!(matches!(error, ProfileError::CornerTooLarge { .. }));
    }

    #[test]
    fn a_shoulder_has_the_height_of_its_foot() {
        let line = |r, h| Segment::Line { to: [r, h] };
        let step = Profile::new(vec![line(1.0, 0.0), line(1.0, 2.0), line(3.0, 2.5)]).unwrap();
        assert_eq!(step.height(1.0), 0.0);
        assert!((step.height(1.0 + 1e-9) - 2.0).abs() < 1e-8);
    }

    #[test]
    fn bad_chains_are_refused() {
        let line = |r, h| Segment::Line { to: [r, h] };
        assert_eq!(Profile::new(vec![]), Err(ProfileError::NoRadius));
        assert_eq!(Profile::new(vec![line(0.0, 1.0)]), Err(ProfileError::NoRadius));
        assert_eq!(Profile::new(vec![line(f64::NAN, 0.0)]), Err(ProfileError::NotFinite(1)));
        let twice = Profile::new(vec![line(1.0, 0.0), line(1.0, 0.0)]);
        assert_eq!(twice, Err(ProfileError::NoLength(2)));
        let falls = Profile::new(vec![line(1.0, 1.0), line(2.0, 0.5)]);
        assert!(matches!(falls, Err(ProfileError::Falls { segment: 2, .. })));
        let off = Profile::new(vec![Segment::Arc { to: [1.0, 1.0], center: [0.0, 1.1] }]);
        assert!(matches!(off, Err(ProfileError::OffCircle { segment: 1, .. })));
        let downward = Profile::new(vec![Segment::Arc { to: [1.0, 1.0], center: [1.0, 0.0] }]);
        assert_eq!(downward, Err(ProfileError::NotConvex(1)));
        assert!(matches!(Profile::ball(0.0), Err(ProfileError::BadLength { .. })));
        assert!(matches!(Profile::flat(f64::INFINITY), Err(ProfileError::BadLength { .. })));
    }

    #[test]
    fn what_is_read_is_checked() {
        let bull = Profile::bull_nose(3.0, 1.0).unwrap();
        let text = serde_json::to_string(&bull).unwrap();
        assert_eq!(serde_json::from_str::<Profile>(&text).unwrap(), bull);
        let falls = r#"[{"Line":{"to":[1.0,1.0]}},{"Line":{"to":[2.0,0.5]}}]"#;
        let error = serde_json::from_str::<Profile>(falls).unwrap_err();
        assert!(error.to_string().contains("segment 2 of the profile goes back"), "{error}");
    }
}

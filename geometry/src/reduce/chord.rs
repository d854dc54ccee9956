//! Chords over as many points as a tolerance lets them pass.
//!
//! Along a span that is straight in plan the heights are a function of the way s. A chord from
//! point i may run to point j if its slope lies in the cone of slopes that pass all points between
//! within the band [z − below, z + above]; the cone narrows from point to point (the sleeve or
//! funnel method). So a walk from i tells all points that it reaches, and the least number of chords
//! follows point by point (H. Imai, M. Iri, *Polygonal approximations of a curve*, 1988, as the
//! shortest way through a graph).
//!
//! A walk ends where its cone closes, or after [`LOOK`] points. Only from the points of one way, that which
//! always goes as far as it can, does it go on: else the flat ground of a picture would take
//! the square of its length. So the number of chords is the least where cones close within so many
//! points, and never more than by going farthest.
//!
//! Along a span that bends in plan a chord is tried over twice as many points each time, then the
//! farthest that fits is searched by halving: n log n, each test by the plain distances. Going
//! farthest is not always the least number there.

use super::fewest::Fewest;
use super::{CHORD_ALLOWANCE_MM, offset, straight_runs};
use glam::DVec3;

/// How many points most walks look ahead. On photographs a cone closes after 5 to 20; longer looks cost
/// time on flat ground only, where there is next to nothing to gain.
pub(super) const LOOK: usize = 128;

/// A cone that has accepted no point for this many is given up though still open, so that the time
/// stays linear on paths that are noise within the band.
const PATIENCE: usize = 4096;

/// How far a chord may pass above and below the points it skips, in mm.
pub(super) struct Band {
    pub(super) above: f64,
    pub(super) below: f64,
}

impl Band {
    pub(super) fn new(tolerance_mm: f64, gouge_tolerance_mm: f64) -> Self {
        // NaN fails both comparisons. A band turned over lets no chord pass a point.
        if !(tolerance_mm >= 0.0 && gouge_tolerance_mm >= 0.0) {
            return Self { above: -1.0, below: -1.0 };
        }
        let below = gouge_tolerance_mm.min(tolerance_mm);
        Self { above: tolerance_mm + CHORD_ALLOWANCE_MM, below: below + CHORD_ALLOWANCE_MM }
    }

    /// Indices of the points of a span that are kept.
    pub(super) fn keep(&self, tips: &[DVec3]) -> Vec<usize> {
        if straight_runs(tips).len() == 2 { self.fewest(tips) } else { self.farthest_first(tips) }
    }

    /// The points that chords along a straight span end at, as few as a look ahead finds.
    fn fewest(&self, tips: &[DVec3]) -> Vec<usize> {
        let last = tips.len() - 1;
        let mut route = Fewest::new(tips.len(), ());
        let mut landmark = 0;
        for from in 0..last {
            let far = from == landmark;
            let end = if far { last } else { last.min(from + LOOK) };
            let farthest = self.walk(tips, from, end, |to| route.lead(from, to, 1, ()));
            if far {
                landmark = farthest;
            }
        }
        std::iter::once(0).chain(route.moves().into_iter().map(|(end, ())| end)).collect()
    }

    /// Walks over a straight span from one point up to `end` until the cone closes, tells all points
    /// that a chord reaches and answers the farthest of them.
    pub(super) fn walk(
        &self,
        tips: &[DVec3],
        from: usize,
        end: usize,
        mut reached: impl FnMut(usize),
    ) -> usize {
        let origin = tips[from];
        let (mut least, mut greatest) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut farthest = from + 1;
        reached(farthest);
        for (k, tip) in tips.iter().enumerate().take(end + 1).skip(from + 1) {
            let way = (tip.truncate() - origin.truncate()).length();
            let rise = tip.z - origin.z;
            let slope = rise / way;
            if k > farthest && least <= slope && slope <= greatest {
                farthest = k;
                reached(k);
            }
            least = least.max((rise - self.below) / way);
            greatest = greatest.min((rise + self.above) / way);
            // What is no number is not skipped.
            if slope.is_nan() || least > greatest || k - farthest > PATIENCE {
                break;
            }
        }
        farthest
    }

    fn farthest_first(&self, tips: &[DVec3]) -> Vec<usize> {
        let mut kept = vec![0];
        let mut from = 0;
        while from + 1 < tips.len() {
            from = self.farthest_that_fits(tips, from);
            kept.push(from);
        }
        kept
    }

    /// A far point that a chord from `from` reaches on any span.
    pub(super) fn farthest_that_fits(&self, tips: &[DVec3], from: usize) -> usize {
        let last = tips.len() - 1;
        let (mut good, mut bad) = (from + 1, last + 1);
        let mut step = 2;
        while good < last && bad > last {
            let to = (from + step).min(last);
            if self.fits(&tips[from..=to]) {
                good = to
            } else {
                bad = to
            }
            step *= 2;
        }
        while bad - good > 1 {
            let to = good + (bad - good) / 2;
            if self.fits(&tips[from..=to]) { good = to } else { bad = to }
        }
        good
    }

    /// Whether the chord from the first to the last point passes the others within the band.
    fn fits(&self, tips: &[DVec3]) -> bool {
        let [a, between @ .., b] = tips else { return true };
        between.iter().all(|&tip| {
            let (aside, above) = offset(*a, *b, tip);
            aside.hypot(above) <= self.above && -above <= self.below
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::reduce_chord;
    use super::super::tests::{GO, along_x, path_of, wavy};
    use super::*;

    #[test]
    fn points_in_line_vanish_at_tolerance_0() {
        let slanted: Vec<_> =
            (0..700).map(|k| DVec3::new(0.1, -0.3, 0.7) * (f64::from(k) * 0.3)).collect();
        let (reduced, facts) = reduce_chord(&path_of(&[slanted]), 0.0, 0.0, GO).unwrap();
        assert_eq!(reduced.tips.len(), 2);
        assert!(facts.max_deviation_mm <= CHORD_ALLOWANCE_MM);
        let roof = along_x(&[0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0]);
        assert_eq!(Band::new(0.0, 0.0).keep(&roof), [0, 3, 6]);
    }

    #[test]
    fn a_polygon_keeps_its_corners_alone() {
        let square = |k: usize| match (k / 10, (k % 10) as f64) {
            (0, t) => DVec3::new(t, 0.0, 0.0),
            (1, t) => DVec3::new(10.0, t, t),
            _ => DVec3::new(10.0, 10.0, 10.0),
        };
        let tips: Vec<_> = (0..21).map(square).collect();
        assert_eq!(Band::new(0.0, 0.0).keep(&tips), [0, 10, 20]);
    }

    #[test]
    fn tolerances_hold_and_gouges_have_their_own() {
        let path = path_of(&[wavy(2000)]);
        for (tolerance, gouge) in [(0.001, 0.0), (0.02, 0.0), (0.02, 0.005), (0.1, 0.1)] {
            let (_, facts) = reduce_chord(&path, tolerance, gouge, GO).unwrap();
            assert!(facts.max_above_mm <= tolerance + CHORD_ALLOWANCE_MM);
            assert!(facts.max_below_mm <= gouge + CHORD_ALLOWANCE_MM);
            assert!(facts.max_deviation_mm <= tolerance + CHORD_ALLOWANCE_MM);
        }
        let (_, facts) = reduce_chord(&path, 0.1, 0.1, GO).unwrap();
        assert!(facts.points_out < facts.points_in / 4);
    }

    #[test]
    fn a_circle_becomes_a_polygon_within_tolerance() {
        let radius = 20.0_f64;
        let circle = |k: i32| (f64::from(k) * 0.005).sin_cos();
        let tips: Vec<_> = (0..1200)
            .map(circle)
            .map(|(s, c)| DVec3::new(radius * c, radius * s, 0.2 * s))
            .collect();
        let (reduced, facts) = reduce_chord(&path_of(&[tips]), 0.01, 0.01, GO).unwrap();
        assert!(facts.max_deviation_mm <= 0.01 + CHORD_ALLOWANCE_MM);
        // A chord of half angle a has the sagitta r (1 − cos a).
        let half = (1.0 - 0.01 / radius).acos();
        let ideal = 6.0 / (2.0 * half);
        assert!((reduced.tips.len() as f64) < ideal * 1.2 + 2.0, "{} {ideal}", reduced.tips.len());
    }

    /// The least number of points, by trying all chords against all points between.
    fn least_by_trying(band: &Band, tips: &[DVec3]) -> usize {
        let mut least = vec![1; tips.len()];
        for to in 1..tips.len() {
            let from = (0..to).filter(|&from| band.fits(&tips[from..=to]));
            least[to] = from.map(|from| least[from] + 1).min().unwrap_or(usize::MAX);
        }
        least[tips.len() - 1]
    }

    #[test]
    fn straight_spans_keep_the_least_number_of_points() {
        let mut random = fastrand::Rng::with_seed(11);
        let mut fewer = 0;
        for _ in 0..2000 {
            let (rough, steep) = (random.f64() * 0.1, random.f64());
            let heights: Vec<f64> = (0..random.usize(3..40))
                .map(|k| (k as f64 * steep).sin() * 0.2 + rough * random.f64())
                .collect();
            let tips = along_x(&heights);
            let band = Band::new(0.05 * random.f64(), [0.0, 0.01, 0.05][random.usize(0..3)]);
            let kept = band.keep(&tips).len();
            assert_eq!(kept, least_by_trying(&band, &tips));
            fewer += usize::from(kept < band.farthest_first(&tips).len());
        }
        assert!(fewer > 20, "going farthest is as good: {fewer}");
    }

    #[test]
    fn flat_ground_longer_than_the_look_is_one_chord() {
        let flat = along_x(&vec![1.0; 5 * LOOK]);
        assert_eq!(Band::new(0.01, 0.0).keep(&flat), [0, 5 * LOOK - 1]);
    }

    #[test]
    fn nonsense_tolerances_change_nothing() {
        let path = path_of(&[wavy(40)]);
        for bad in [-1.0, f64::NAN] {
            assert_eq!(reduce_chord(&path, bad, bad, GO).unwrap().0, path);
            assert_eq!(reduce_chord(&path, 1.0, bad, GO).unwrap().0, path);
        }
    }

    #[test]
    fn noise_takes_linear_time() {
        let noise: Vec<f64> = (0..200_000_u64)
            .map(|k| (k.wrapping_mul(6_364_136_223_846_793_005) >> 40) as f64 * 1e-8)
            .collect();
        let (reduced, facts) = reduce_chord(&path_of(&[along_x(&noise)]), 0.05, 0.05, GO).unwrap();
        assert!(reduced.tips.len() < 200_000 && facts.max_deviation_mm <= 0.05 + 1e-9);
    }
}

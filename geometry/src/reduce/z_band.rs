//! The source's rule: Sood, *Novel algorithms for CAD-free machining* (thesis, 2015), section 4.4,
//! figures 4.3 and 4.4; its ε is the tolerance here.

use super::straight_runs;
use glam::DVec3;

/// Indices of the points of a span that the rule keeps.
pub(super) fn keep(tips: &[DVec3], tolerance_mm: f64) -> Vec<usize> {
    let mut kept = vec![0];
    for run in straight_runs(tips).windows(2) {
        let (mut reference, end) = (run[0], run[1]);
        while reference < end {
            reference = last_in_band(tips, reference, end, tolerance_mm).max(reference + 1);
            kept.push(reference);
        }
    }
    kept
}

/// The last of the points after `reference` before one that leaves the band.
fn last_in_band(tips: &[DVec3], reference: usize, end: usize, tolerance_mm: f64) -> usize {
    let level = tips[reference].z;
    let in_band = |tip: &&DVec3| (tip.z - level).abs() <= tolerance_mm;
    reference + tips[reference + 1..=end].iter().take_while(in_band).count()
}

#[cfg(test)]
mod tests {
    use super::super::reduce_z_band;
    use super::super::tests::{GO, along_x, path_of, wavy};
    use super::*;
    use crate::Toolpath;

    #[test]
    fn the_last_point_in_the_band_is_the_next_reference() {
        let tips = along_x(&[0.0, 0.1, -0.1, 0.08, 0.15, 0.05, 0.3, 0.3]);
        assert_eq!(keep(&tips, 0.1), [0, 3, 5, 6, 7]);
    }

    #[test]
    fn tolerance_0_merges_equal_heights() {
        let tips = along_x(&[1.0, 1.0, 1.0, 2.0, 2.0, 1.0, 1.0]);
        assert_eq!(keep(&tips, 0.0), [0, 2, 3, 4, 5, 6]);
        let path = path_of(&[tips]);
        let (_, facts) = reduce_z_band(&path, 0.0, GO).unwrap();
        assert_eq!((facts.points_in, facts.points_out, facts.max_deviation_mm), (7, 6, 0.0));
    }

    #[test]
    fn nonsense_tolerances_change_nothing() {
        let path = path_of(&[wavy(40)]);
        for tolerance in [-1.0, f64::NAN] {
            assert_eq!(reduce_z_band(&path, tolerance, GO).unwrap().0, path);
        }
    }

    #[test]
    fn bend_points_are_kept() {
        let corner = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (2.0, 2.0)];
        let tips: Vec<_> = corner.map(|(x, y)| DVec3::new(x, y, 0.0)).into();
        assert_eq!(keep(&tips, 1.0), [0, 2, 4]);
        let circle: Vec<_> = (0..20)
            .map(|k| f64::from(k) * 0.1)
            .map(|a| DVec3::new(9.0 * a.cos(), 9.0 * a.sin(), 0.0))
            .collect();
        assert_eq!(keep(&circle, 1.0).len(), 20);
    }

    #[test]
    fn passes_do_not_mix() {
        let path = path_of(&[along_x(&[1.0; 5]), along_x(&[1.0; 5])]);
        let (reduced, _) = reduce_z_band(&path, 0.5, GO).unwrap();
        assert_eq!(reduced.spans.iter().map(|s| s.points.len()).collect::<Vec<_>>(), [2, 2]);
    }

    #[test]
    fn tolerance_0_loses_nothing() {
        let mut random = fastrand::Rng::with_seed(2);
        for _ in 0..300 {
            // Few levels, so that many neighbours are as high.
            let heights: Vec<f64> =
                (0..random.usize(3..200)).map(|_| 0.1 * f64::from(random.u8(0..4))).collect();
            let path = path_of(&[along_x(&heights)]);
            let (reduced, facts) = reduce_z_band(&path, 0.0, GO).unwrap();
            assert!(facts.max_deviation_mm < 1e-15);
            for tip in &path.tips {
                assert!((height_at(&reduced, tip.x) - tip.z).abs() < 1e-9);
            }
        }
    }

    /// The height of a path along +x.
    fn height_at(path: &Toolpath, x: f64) -> f64 {
        let k = path.tips.partition_point(|t| t.x < x).max(1);
        let (a, b) = (path.tips[k - 1], path.tips[k]);
        a.z + (b.z - a.z) * (x - a.x) / (b.x - a.x)
    }

    #[test]
    fn the_deviation_is_the_real_one_and_at_most_twice_the_band() {
        let path = path_of(&[wavy(500)]);
        for tolerance in [0.01, 0.05, 0.2] {
            let (reduced, facts) = reduce_z_band(&path, tolerance, GO).unwrap();
            let differences = path.tips.iter().map(|t| height_at(&reduced, t.x) - t.z);
            let above = differences.clone().fold(0.0, f64::max);
            let below = differences.fold(0.0, |m: f64, d| m.max(-d));
            assert!((facts.max_above_mm - above).abs() < 1e-12);
            assert!((facts.max_below_mm - below).abs() < 1e-12);
            assert!(facts.max_deviation_mm <= 2.0 * tolerance);
            assert!(facts.points_out < facts.points_in);
        }
    }
}

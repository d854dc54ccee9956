//! Fitted arcs held against the path that they were fitted to, by dense sampling.

use super::tests::{GO, along_x, path_of, wavy};
use super::*;
use crate::{Direction, Plane};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Places along the move that ends at a tip, the ends included.
fn places(path: &Toolpath, end: usize, count: usize) -> Vec<DVec3> {
    let (from, to) = (path.tips[end - 1], path.tips[end]);
    let arc = path.arcs.iter().find(|(at, _)| *at == end).map(|(_, arc)| *arc);
    let share = |k: usize| k as f64 / count as f64;
    let place = |t: f64| arc.map_or_else(|| from.lerp(to, t), |arc| arc.point(from, to, t));
    (0..=count).map(|k| place(share(k))).collect()
}

/// The height of a row of points above a place on its way along an axis.
fn height_at(row: &[DVec3], axis: usize, at: f64) -> f64 {
    let sign = if row[row.len() - 1][axis] > row[0][axis] { 1.0 } else { -1.0 };
    let k = row.partition_point(|tip| sign * tip[axis] < sign * at).clamp(1, row.len() - 1);
    let (a, b) = (row[k - 1], row[k]);
    if a[axis] == b[axis] { b.z } else { a.z + (b.z - a.z) * (at - a[axis]) / (b[axis] - a[axis]) }
}

/// The most that reduced passes along an axis run above and below the original, at many places and at all
/// points.
fn sampled(path: &Toolpath, reduced: &Toolpath, axis: usize) -> (f64, f64) {
    let mut rises = vec![0.0];
    for (span, original) in reduced.spans.iter().zip(&path.spans) {
        let row = &path.tips[original.points.clone()];
        let ends = span.points.start + 1..span.points.end;
        let samples: Vec<DVec3> = ends.flat_map(|end| places(reduced, end, 2000)).collect();
        let over = |place: &DVec3| place.z - height_at(row, axis, place[axis]);
        rises.extend(samples.iter().map(over));
        rises.extend(row.iter().map(|tip| height_at(&samples, axis, tip[axis]) - tip.z));
    }
    let above = rises.iter().copied().fold(0.0, f64::max);
    (above, rises.iter().fold(0.0, |below: f64, rise| below.max(-rise)))
}

/// Arcs end on points of the path, with equal radii, in the limits given.
fn check_form(path: &Toolpath, reduced: &Toolpath) {
    for (end, arc) in &reduced.arcs {
        let (from, to) = (reduced.tips[end - 1], reduced.tips[*end]);
        assert!(path.tips.contains(&from) && path.tips.contains(&to));
        let (start, stop) = (arc.radius_mm(from), arc.radius_mm(to));
        assert!((start - stop).abs() < 1e-11 * start.max(1.0), "{start} {stop}");
        assert!((0.0499..=5000.1).contains(&start), "{start}");
        assert!(arc.sweep_rad(from, to).to_degrees() <= 150.01);
    }
    assert!(reduced.arcs.windows(2).all(|pair| pair[0].0 < pair[1].0));
}

fn turned(tips: &[DVec3]) -> Vec<DVec3> {
    tips.iter().map(|tip| DVec3::new(tip.y, tip.x, tip.z)).collect()
}

fn random_heights(random: &mut fastrand::Rng, count: usize) -> Vec<f64> {
    let (rough, pitch, high) = (0.05 * random.f64().powi(2), random.f64(), 2.0 * random.f64());
    (0..count).map(|k| (k as f64 * pitch).sin() * high + rough * random.f64()).collect()
}

#[test]
fn random_passes_deviate_as_reported_and_within_their_tolerances() {
    let mut random = fastrand::Rng::with_seed(3);
    let mut arcs = 0;
    for round in 0..400 {
        let count = random.usize(3..60);
        let mut tips = along_x(&random_heights(&mut random, count));
        let axis = round % 2;
        if axis == 1 {
            tips = turned(&tips);
        }
        if random.bool() {
            tips.reverse();
        }
        let path = path_of(&[tips]);
        let tolerance = [0.002, 0.01, 0.05, 0.2][random.usize(0..4)];
        let gouge = [0.0, 0.25 * tolerance, tolerance][random.usize(0..3)];
        let (reduced, facts) = fit_arcs(&path, tolerance, gouge, GO).unwrap();
        check_form(&path, &reduced);
        arcs += reduced.arcs.len();
        assert!(facts.max_above_mm <= tolerance + CHORD_ALLOWANCE_MM);
        assert!(facts.max_below_mm <= gouge + CHORD_ALLOWANCE_MM);
        let (above, below) = sampled(&path, &reduced, axis);
        // A chord between two of 2000 samples of an arc leaves it by less.
        let near = |reported: f64, found: f64| (found - reported).abs() < 3e-6;
        assert!(near(facts.max_above_mm, above), "{round}: {} {above}", facts.max_above_mm);
        assert!(near(facts.max_below_mm, below), "{round}: {} {below}", facts.max_below_mm);
        let (chords, _) = reduce_chord(&path, tolerance, gouge, GO).unwrap();
        assert!(reduced.tips.len() <= chords.tips.len(), "{round}");
    }
    assert!(arcs > 1000, "{arcs}");
}

#[test]
fn an_arc_that_bulges_between_two_points_is_seen() {
    // On a circle of 1 mm, 40° apart: points alone would let it pass, the lines between lie 0.06 mm off.
    let at = |k: i32| f64::from(k * 40 - 60).to_radians();
    let hill: Vec<_> = (0..4).map(|k| DVec3::new(at(k).sin(), 0.0, at(k).cos())).collect();
    let valley: Vec<_> = hill.iter().map(|tip| tip.with_z(-tip.z)).collect();
    let sagitta = 1.0 - 20_f64.to_radians().cos();
    for (tips, gouge) in [(hill, 0.0), (valley, 1.4 * sagitta)] {
        let fit = |tolerance: f64| {
            fit_arcs(&path_of(std::slice::from_ref(&tips)), tolerance, gouge, GO).unwrap()
        };
        assert!(fit(0.4 * sagitta).0.arcs.is_empty());
        assert_eq!(fit(1.4 * sagitta).0.arcs.len(), 1);
    }
}

#[test]
fn a_finely_sampled_quarter_is_one_arc_of_its_radius() {
    let (radius, center) = (8.0, DVec3::new(3.0, -2.0, 1.0));
    let steps = 4000;
    for (plane, from, to) in [
        (Plane::Xy, 0.0, FRAC_PI_2),
        (Plane::Xy, 2.0, 2.0 - FRAC_PI_2),
        // The steep ends of a quarter in a vertical plane are no heights over a plan.
        (Plane::Zx, 0.8, -0.7),
        (Plane::Zx, -0.7, 0.8),
        (Plane::Yz, 0.8, 2.3),
        (Plane::Yz, 3.9, 5.4),
    ] {
        let [first, second, _] = plane.axes();
        let tips: Vec<DVec3> = (0..=steps)
            .map(|k| from + (to - from) * f64::from(k) / f64::from(steps))
            .map(|angle: f64| {
                let mut tip = center;
                tip[first] += radius * angle.cos();
                tip[second] += radius * angle.sin();
                tip
            })
            .collect();
        let path = path_of(std::slice::from_ref(&tips));
        let (reduced, facts) = fit_arcs(&path, 0.001, 0.001, GO).unwrap();
        assert_eq!((reduced.tips.len(), facts.points_out), (2, 2), "{plane:?} {from}");
        let (end, arc) = reduced.arcs[0];
        assert_eq!((end, arc.plane), (1, plane));
        let turn = if to > from { Direction::CounterClockwise } else { Direction::Clockwise };
        assert_eq!(arc.direction, turn, "{plane:?} {from}");
        assert!((arc.radius_mm(tips[0]) - radius).abs() < 0.005);
        assert!(
            (arc.sweep_rad(reduced.tips[0], reduced.tips[1]) - (to - from).abs()).abs() < 0.002
        );
        assert!(facts.max_deviation_mm <= 0.001 + CHORD_ALLOWANCE_MM);
        check_form(&path, &reduced);
    }
}

#[test]
fn a_helix_has_no_arcs() {
    let helix = |k: i32| {
        let angle = f64::from(k) * 0.01;
        DVec3::new(5.0 * angle.cos(), 5.0 * angle.sin(), 0.1 * angle)
    };
    let path = path_of(&[(0..1000).map(helix).collect()]);
    let (reduced, facts) = fit_arcs(&path, 0.01, 0.01, GO).unwrap();
    assert!(reduced.arcs.is_empty() && facts.points_out < 300);
    assert_eq!((reduced, facts), reduce_chord(&path, 0.01, 0.01, GO).unwrap());
}

#[test]
fn level_rings_become_few_arcs_both_sides_within_tolerance() {
    let mut random = fastrand::Rng::with_seed(5);
    for round in 0..60 {
        let (wide, slim) = (2.0 + 20.0 * random.f64(), 2.0 + 20.0 * random.f64());
        let rough = 0.002 * random.f64();
        let ring: Vec<DVec3> = (0..=720)
            .map(|k| TAU * f64::from(k) / 720.0)
            .map(|a| {
                DVec3::new(wide * a.cos(), slim * a.sin(), -1.0)
                    * (1.0 + 1e-4 * random.f64() * rough)
            })
            .map(|tip| tip.with_z(-1.0))
            .collect();
        let path = path_of(&[ring]);
        let (reduced, facts) = fit_arcs(&path, 0.01, 0.0, GO).unwrap();
        check_form(&path, &reduced);
        let (chords, _) = reduce_chord(&path, 0.01, 0.0, GO).unwrap();
        assert!(2 * reduced.tips.len() < chords.tips.len(), "{round}");
        assert!(facts.max_deviation_mm <= 0.01 + CHORD_ALLOWANCE_MM);
        assert_eq!((facts.max_above_mm, facts.max_below_mm), (0.0, 0.0));
        let mut start = 0;
        let mut worst = 0.0_f64;
        for end in 1..reduced.tips.len() {
            let stop = (start..).find(|&k| path.tips[k] == reduced.tips[end] && k > start).unwrap();
            let part = &path.tips[start..=stop];
            let (near, far) = both_ways(part, &reduced, end);
            assert!(near <= facts.max_deviation_mm + 1e-9, "{round}: {near}");
            worst = worst.max(far);
            start = stop;
        }
        assert!((worst - facts.max_deviation_mm).abs() < 1e-5, "{round}: {worst} {facts:?}");
    }
}

/// The farthest that the move lies from a part of the path, and that this lies from the move.
fn both_ways(part: &[DVec3], reduced: &Toolpath, end: usize) -> (f64, f64) {
    let to_leg = |p: DVec3, a: DVec3, b: DVec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a.lerp(b, t))
    };
    let to_part =
        |p: DVec3| part.windows(2).map(|l| to_leg(p, l[0], l[1])).fold(f64::INFINITY, f64::min);
    let near = places(reduced, end, 300).into_iter().map(to_part).fold(0.0, f64::max);
    let arc = reduced.arcs.iter().find(|(at, _)| *at == end).map(|(_, arc)| *arc);
    let (a, b) = (reduced.tips[end - 1], reduced.tips[end]);
    let off = |p: DVec3| match arc {
        Some(arc) => (arc.radius_mm(p) - arc.radius_mm(a)).abs(),
        None => to_leg(p, a, b),
    };
    let legs =
        part.windows(2).flat_map(|leg| (0..=50).map(|k| leg[0].lerp(leg[1], f64::from(k) / 50.0)));
    (near, legs.map(off).fold(0.0, f64::max))
}

#[test]
fn a_plate_with_rounded_corners_has_four_lines_and_four_arcs() {
    let corner = |k: u32, (x, y): (f64, f64)| {
        (0..=90)
            .map(move |a| f64::from(a + 90 * k).to_radians())
            .map(move |a| DVec3::new(x + 3.0 * a.cos(), y + 3.0 * a.sin(), -2.0))
    };
    let centers = [(20.0, 10.0), (-20.0, 10.0), (-20.0, -10.0), (20.0, -10.0)];
    let mut tips: Vec<DVec3> = (0_u32..).zip(centers).flat_map(|(k, c)| corner(k, c)).collect();
    tips.push(tips[0]);
    let (reduced, _) = fit_arcs(&path_of(&[tips]), 0.001, 0.0, GO).unwrap();
    assert_eq!((reduced.tips.len(), reduced.arcs.len()), (9, 4));
}

#[test]
fn passes_across_the_planes_have_chords_alone() {
    let slanted: Vec<DVec3> =
        wavy(300).iter().map(|tip| DVec3::new(tip.x * 0.6, tip.x * 0.8, tip.z)).collect();
    let path = path_of(&[slanted]);
    assert_eq!(fit_arcs(&path, 0.01, 0.0, GO), reduce_chord(&path, 0.01, 0.0, GO));
}

#[test]
fn smooth_passes_need_a_fraction_of_the_chords() {
    let path = path_of(&[wavy(2000)]);
    for (tolerance, gouge) in [(0.001, 0.001), (0.01, 0.01), (0.05, 0.01)] {
        let (arcs, _) = fit_arcs(&path, tolerance, gouge, GO).unwrap();
        let (chords, _) = reduce_chord(&path, tolerance, gouge, GO).unwrap();
        assert!(
            2 * arcs.tips.len() < chords.tips.len(),
            "{} {}",
            arcs.tips.len(),
            chords.tips.len()
        );
    }
}

#[test]
fn a_path_that_has_arcs_keeps_them() {
    let path = path_of(&[wavy(200), wavy(100)]);
    let (mut reduced, _) = fit_arcs(&path, 0.01, 0.01, GO).unwrap();
    let first = reduced.spans[0].points.end;
    reduced.arcs.retain(|(end, _)| *end < first);
    for (again, facts) in [
        reduce_z_band(&reduced, 10.0, GO).unwrap(),
        reduce_chord(&reduced, 10.0, 10.0, GO).unwrap(),
        fit_arcs(&reduced, 10.0, 10.0, GO).unwrap(),
    ] {
        assert_eq!(again.tips[..first], reduced.tips[..first]);
        assert_eq!(
            (again.arcs_within(&again.spans[0]), again.tips.len()),
            (&reduced.arcs[..], first + 2)
        );
        assert_eq!(facts.points_out, again.tips.len());
    }
}

#[test]
fn nonsense_leaves_every_point() {
    let path = path_of(&[wavy(40)]);
    for bad in [-1.0, f64::NAN] {
        assert_eq!(fit_arcs(&path, bad, bad, GO).unwrap().0, path);
        assert_eq!(fit_arcs(&path, 1.0, bad, GO).unwrap().0, path);
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let mut broken = path.clone();
        broken.tips[20].z = bad;
        let (reduced, _) = fit_arcs(&broken, 0.01, 0.01, GO).unwrap();
        assert!(reduced.tips.iter().any(|tip| !tip.z.is_finite()), "a bad height goes on unseen");
    }
    assert!(fit_arcs(&path, 0.1, 0.1, &|_| false).is_none());
}

#[test]
fn noise_and_long_arcs_take_linear_time() {
    let count = 200_000_u64;
    let noise = |k: u64| (k.wrapping_mul(6_364_136_223_846_793_005) >> 40) as f64 * 1e-8;
    let rough: Vec<f64> = (0..count).map(noise).collect();
    let smooth: Vec<f64> = (0..count).map(|k| 50.0 * (k as f64 * 1e-5).sin()).collect();
    for heights in [rough, smooth] {
        let (reduced, facts) = fit_arcs(&path_of(&[along_x(&heights)]), 0.05, 0.05, GO).unwrap();
        assert!(
            reduced.tips.len() < 200_000 && facts.max_deviation_mm <= 0.05 + CHORD_ALLOWANCE_MM
        );
    }
}

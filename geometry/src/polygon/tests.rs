//! Polygons of all kinds, nasty ones above all, against what they mean place by place.

use super::simplify::distance;
use super::*;
use crate::{Bounds, Region};
use glam::DVec3;
use std::f64::consts::TAU;

fn polygon(loops: Vec<Vec<DVec2>>) -> Polygon {
    Polygon::new(loops).unwrap()
}

/// Even-odd, straight from the definition.
fn contains(polygon: &Polygon, place: DVec2) -> bool {
    let crossed = polygon.edges().filter(|[a, b]| {
        (a.y <= place.y) != (b.y <= place.y)
            && place.x < a.x + (place.y - a.y) / (b.y - a.y) * (b.x - a.x)
    });
    crossed.count() % 2 == 1
}

/// Distance from the boundary, positive inside. Where two edges lie over each other there is none, so
/// the polygon has to be clean.
fn depth(clean: &Polygon, place: DVec2) -> f64 {
    let off = clean.edges().map(|[a, b]| distance(place, a, b)).fold(f64::INFINITY, f64::min);
    if contains(clean, place) { off } else { -off }
}

fn place(rng: &mut fastrand::Rng) -> DVec2 {
    DVec2::new(rng.f64(), rng.f64()) * 140.0 - 20.0
}

fn ring(center: DVec2, corners: usize, radius: impl FnMut(f64) -> f64) -> Vec<DVec2> {
    let angles = (0..corners).map(|k| k as f64 / corners as f64 * TAU);
    let radii: Vec<f64> = angles.clone().map(radius).collect();
    angles.zip(radii).map(|(angle, r)| center + r * DVec2::from_angle(angle)).collect()
}

const MIDDLE: DVec2 = DVec2::splat(50.0);

/// Loops over a square of 100 mm: crossing themselves and each other, on the nodes of a grid so that
/// edges touch and lie over each other, with spikes, as slivers, and noisy rings with holes.
pub(crate) fn nasty(rng: &mut fastrand::Rng, kind: usize) -> Polygon {
    let mut any = || DVec2::new(rng.f64(), rng.f64()) * 100.0;
    let loops = match kind {
        0 => vec![(0..12).map(|_| any()).collect()],
        1 => (0..4).map(|_| (0..5).map(|_| any()).collect()).collect(),
        2 => (0..5).map(|_| (0..6).map(|_| (any() / 12.5).floor() * 10.0).collect()).collect(),
        3 => {
            let mut long = false;
            let radius = |_| {
                long = !long;
                if long { 50.0 } else { 2.0 + rng.f64() * 5.0 }
            };
            vec![ring(MIDDLE, 60, radius)]
        }
        4 => (0..6)
            .map(|_| {
                let (a, b) = (any(), any());
                vec![a, b, b + any() * 1e-5]
            })
            .collect(),
        _ => {
            let mut noisy = |r: f64| {
                let radius = |a: f64| r * (1.0 + 0.3 * (5.0 * a).sin()) + 2.0 * rng.f64();
                ring(MIDDLE, 200, radius)
            };
            vec![noisy(35.0), noisy(12.0)]
        }
    };
    polygon(loops)
}

const KINDS: usize = 6;

#[test]
fn growing_and_shrinking_move_the_boundary_by_their_length() {
    let mut rng = fastrand::Rng::with_seed(7);
    for kind in (0..KINDS).cycle().take(10 * KINDS) {
        let before = nasty(&mut rng, kind);
        let clean = before.clean().unwrap();
        for by_mm in [-20.0, -3.0, -0.5, -0.01, 0.01, 0.7, 5.0, 40.0] {
            let tolerance_mm = 0.01;
            let after = offset(&before, by_mm, tolerance_mm);
            for _ in 0..100 {
                let place = place(&mut rng);
                let wanted = depth(&clean, place) + by_mm;
                let made = after.as_ref().is_some_and(|after| contains(after, place));
                let slack = tolerance_mm.max(3e-4 * by_mm.abs()) + 1e-9;
                assert!(made == (wanted > 0.0) || wanted.abs() <= slack, "{kind} {by_mm} {wanted}");
            }
        }
    }
}

#[test]
fn unions_intersections_and_differences_are_told_place_by_place() {
    let mut rng = fastrand::Rng::with_seed(8);
    for kind in (0..KINDS).cycle().take(10 * KINDS) {
        let (a, b) = (nasty(&mut rng, kind), nasty(&mut rng, (kind + 1) % KINDS));
        let (and, or, minus) = (a.and(&b), a.or(&b), a.minus(&b));
        for _ in 0..200 {
            let place = place(&mut rng);
            let (in_a, in_b) = (contains(&a, place), contains(&b, place));
            let within = |made: &Option<Polygon>| made.as_ref().is_some_and(|p| contains(p, place));
            assert_eq!(within(&and), in_a && in_b, "{kind}");
            assert_eq!(within(&or), in_a || in_b, "{kind}");
            assert_eq!(within(&minus), in_a && !in_b, "{kind}");
        }
        let area = |made: &Option<Polygon>| made.as_ref().map_or(0.0, Polygon::area_mm2);
        let whole = area(&a.clean());
        assert!((area(&and) + area(&minus) - whole).abs() < 1e-6 * whole.max(1.0), "{kind}");
    }
}

#[test]
fn what_is_made_is_clean() {
    let mut rng = fastrand::Rng::with_seed(9);
    for kind in (0..KINDS).cycle().take(4 * KINDS) {
        let made = offset(&nasty(&mut rng, kind), 1.0, 0.01).unwrap();
        // To the left of every edge is inside, to the right outside.
        for [a, b] in made.edges().filter(|[a, b]| a.distance(*b) > 0.01) {
            let aside = (b - a).perp().normalize() * 1e-4;
            assert!(contains(&made, a.midpoint(b) + aside), "{kind}: {a} {b}");
            assert!(!contains(&made, a.midpoint(b) - aside), "{kind}: {a} {b}");
        }
        let parts: f64 = made.parts().iter().map(Polygon::area_mm2).sum();
        assert!((parts - made.area_mm2()).abs() < 1e-6);
    }
}

#[test]
fn a_square_stays_exact_inwards_and_becomes_round_outwards() {
    let square = Polygon::rectangle(DVec2::ZERO, DVec2::splat(10.0)).unwrap();
    let inner = offset(&square, -2.0, 0.01).unwrap();
    assert_eq!(inner.loops().len(), 1);
    assert_eq!(inner.corners(), 4);
    assert!((inner.area_mm2() - 36.0).abs() < 1e-9);
    let outer = offset(&square, 2.0, 1e-3).unwrap();
    let exact = 100.0 + 4.0 * 20.0 + TAU / 2.0 * 4.0;
    assert!((outer.area_mm2() - exact).abs() < TAU * 2.0 * 1e-3, "{}", outer.area_mm2());
    assert!(offset(&square, -5.0, 0.01).is_none());
    assert_eq!(offset(&square, 0.0, 0.01).unwrap().area_mm2(), 100.0);
}

#[test]
fn holes_close_as_their_surroundings_grow() {
    let hole = ring(MIDDLE, 90, |_| 3.0);
    let plate = polygon(vec![ring(MIDDLE, 90, |_| 30.0), hole]);
    assert_eq!(offset(&plate, 2.0, 0.01).unwrap().loops().len(), 2);
    assert_eq!(offset(&plate, 3.5, 0.01).unwrap().loops().len(), 1);
}

/// An outline as it is traced from a picture, with details much smaller than the offset.
#[test]
fn traced_outlines_of_thousands_of_corners_are_offset_far() {
    let radius = |a: f64| {
        80.0 * (1.0 + 0.2 * (7.0 * a).sin() + 0.02 * (311.0 * a).sin() + 4e-3 * (1777.0 * a).sin())
    };
    let outline = polygon(vec![ring(MIDDLE, 20_000, radius)]);
    let clean = outline.clean().unwrap();
    let mut rng = fastrand::Rng::with_seed(10);
    for by_mm in [-30.0, -0.3, 3.0] {
        let after = offset(&outline, by_mm, 0.01).unwrap();
        for _ in 0..100 {
            let place = place(&mut rng);
            let wanted = depth(&clean, place) + by_mm;
            assert!(contains(&after, place) == (wanted > 0.0) || wanted.abs() < 0.011, "{wanted}");
        }
    }
}

#[test]
fn lengths_that_are_none_leave_nothing() {
    let square = Polygon::rectangle(DVec2::ZERO, DVec2::ONE).unwrap();
    for by_mm in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e10] {
        assert!(offset(&square, by_mm, 0.01).is_none());
    }
    assert!(offset(&square, 1.0, f64::NAN).is_none());
    assert!(offset(&square, 1e9, 0.0).is_some());
    let line = polygon(vec![vec![DVec2::ZERO, DVec2::ONE, DVec2::splat(2.0)]]);
    assert!(line.clean().is_none() && offset(&line, 1.0, 0.01).is_none());
    assert!(line.parts().is_empty() && line.and(&square).is_none());
    // As small and as far as they may be.
    let grain = polygon(vec![vec![DVec2::ZERO, DVec2::X * 1e-300, DVec2::Y * 1e-300]]);
    assert!(grain.and(&square).is_none() && offset(&grain, -1.0, 0.01).is_none());
    let far = vec![DVec2::splat(1e9), DVec2::splat(-1e9), DVec2::new(1e9, -1e9)];
    assert!(polygon(vec![far]).and(&square).is_some());
}

#[test]
fn loops_that_are_none_are_refused() {
    let square = vec![DVec2::ZERO, DVec2::X, DVec2::ONE];
    assert_eq!(Polygon::new(vec![]), Err(PolygonError::Empty));
    let bad = Polygon::new(vec![square.clone(), vec![DVec2::ZERO; 2]]).unwrap_err();
    assert_eq!(bad.to_string(), "loop 2 has 2 corners; the least is 3");
    assert!(Polygon::new(vec![vec![DVec2::NAN; 3]]).is_err());
    let far = Polygon::new(vec![vec![DVec2::X * 2e9; 3]]).unwrap_err();
    assert_eq!(far.to_string(), "loop 1 has a corner farther than 1e9 mm from the origin");
    let many = Polygon::new(vec![vec![DVec2::ZERO; 100_001]]).unwrap_err();
    assert_eq!(many.to_string(), "there are 100001 corners; the limit is 100000");
    let area = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
    let beside = Polygon::rectangle(DVec2::splat(2.0), DVec2::splat(3.0)).unwrap();
    assert!(Region::new(&area).unwrap().within(beside).is_none());
}

#[test]
fn simplified_loops_stay_within_the_tolerance() {
    let wavy = ring(MIDDLE, 5000, |a| 40.0 + 3.0 * (9.0 * a).sin());
    for tolerance_mm in [0.001, 0.05, 1.0] {
        let simple = simplify_loop(&wavy, tolerance_mm);
        assert!(simple.len() < 1500);
        for corner in &wavy {
            let next = simple.iter().cycle().skip(1);
            let off = simple.iter().zip(next).map(|(a, b)| distance(*corner, *a, *b));
            assert!(off.fold(f64::INFINITY, f64::min) <= tolerance_mm + 1e-12);
        }
        // Wherever the loop starts.
        let mut turned = wavy.clone();
        turned.rotate_left(1234);
        assert_eq!(simplify_loop(&turned, tolerance_mm), simple);
    }
    assert!(simplify_loop(&ring(MIDDLE, 9, |_| 0.1), 1.0).len() < 3);
    assert!(simplify_loop(&[], 1.0).is_empty());
}

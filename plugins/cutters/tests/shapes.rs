//! What every standard shape must keep to, and the heights of each against closed forms.

#![allow(clippy::unwrap_used, reason = "a failing helper fails its test")]

use carvegraph_cutters::{Standard, standard};
use carvegraph_host::{linked, load};
use carvegraph_sdk::conformance::built_library;
use carvegraph_sdk::conformance::cutter::{check, check_drawn};
use carvegraph_sdk::export::{Entry, entry};
use carvegraph_sdk::{CutterShape, Dimensions, Profile};

const ROUND_OVER: &str = include_str!("drawings/round_over.svg");
const OGEE: &str = include_str!("drawings/ogee.svg");

/// The ways in which the standard shapes reach a program, and the shapes that come that way.
fn ways() -> Vec<(&'static str, Vec<Box<dyn CutterShape>>)> {
    static ENTRY: Entry = entry::<Standard>();
    vec![
        ("direct", standard()),
        ("linked", linked(&ENTRY).unwrap().cutters),
        ("library", load(&built_library("carvegraph_cutters_plugin")).unwrap().cutters),
    ]
}

/// What a shape makes of dimensions, which is the same whichever way it came.
fn made(name: &str, given: &[(&str, f64)]) -> Result<Profile, String> {
    let mut all = ways().into_iter().map(|(_, shapes)| {
        let shape = shapes.into_iter().find(|shape| shape.name() == name).unwrap();
        let dimensions = Dimensions::new(shape.dimensions(), given).unwrap();
        shape.profile(&dimensions).map_err(|fault| fault.to_string())
    });
    let first = all.next().unwrap();
    all.for_each(|other| assert_eq!(other, first));
    first
}

fn profile(name: &str, given: &[(&str, f64)]) -> Profile {
    made(name, given).unwrap()
}

fn refusal(name: &str, given: &[(&str, f64)]) -> String {
    made(name, given).unwrap_err()
}

/// h at each r, to rounding.
fn has_heights(profile: &Profile, heights: impl Fn(f64) -> f64) {
    for k in 0..=200 {
        let r = profile.radius_mm() * f64::from(k) / 200.0;
        let (found, expected) = (profile.height(r), heights(r));
        assert!((found - expected).abs() < 1e-12, "{found}, not {expected}, at r {r}");
    }
}

#[test]
fn shapes_are_sorted_and_named_once() {
    for (way, shapes) in ways() {
        let names: Vec<_> = shapes.iter().map(|s| s.name().to_owned()).collect();
        assert_eq!(names, ["ball", "bull_nose", "flat", "form", "tapered_ball", "v_bit"], "{way}");
    }
}

#[test]
fn every_shape_keeps_its_promises() {
    for (_, shapes) in ways() {
        for shape in &shapes {
            match shape.drawing() {
                None => check(&**shape),
                Some(_) => check_drawn(&**shape, &[ROUND_OVER, OGEE]),
            }
        }
    }
}

#[test]
fn a_ball_is_round_and_a_flat_is_level() {
    has_heights(&profile("ball", &[]), |r| 3.0 - (9.0 - r * r).sqrt());
    has_heights(&profile("flat", &[]), |_| 0.0);
}

#[test]
fn a_bull_nose_is_level_up_to_its_corner() {
    let bull = profile("bull_nose", &[("diameter", 8.0), ("corner_radius", 1.5)]);
    let corner = |r: f64| 1.5 - (1.5 * 1.5 - (r - 2.5) * (r - 2.5)).max(0.0).sqrt();
    has_heights(&bull, |r| if r < 2.5 { 0.0 } else { corner(r) });
}

#[test]
fn a_bull_nose_goes_from_flat_to_ball() {
    assert_eq!(profile("bull_nose", &[("corner_radius", 0.0)]), profile("flat", &[]));
    assert_eq!(profile("bull_nose", &[("corner_radius", 1e-9)]), profile("flat", &[]));
    assert_eq!(profile("bull_nose", &[("corner_radius", 3.0)]), profile("ball", &[]));
}

#[test]
fn a_corner_too_large_is_refused() {
    assert_eq!(
        refusal("bull_nose", &[("corner_radius", 4.0)]),
        "a corner_radius of 4 mm is more than half the diameter of 6 mm; give a corner_radius of at \
         most 3 mm, or a diameter of at least 8 mm"
    );
}

#[test]
fn a_sharp_v_bit_is_a_cone_of_its_included_angle() {
    let cot = |deg: f64| 1.0 / (deg / 2.0).to_radians().tan();
    has_heights(&profile("v_bit", &[]), |r| r * 3.0_f64.sqrt());
    has_heights(&profile("v_bit", &[("included_angle", 90.0), ("diameter", 12.7)]), |r| r);
    has_heights(&profile("v_bit", &[("included_angle", 20.0)]), |r| r * cot(20.0));
}

#[test]
fn an_engraving_bit_has_a_flat_tip() {
    let bit =
        profile("v_bit", &[("diameter", 3.175), ("included_angle", 30.0), ("tip_diameter", 0.1)]);
    let steep = 1.0 / 15.0_f64.to_radians().tan();
    has_heights(&bit, |r| (r - 0.05).max(0.0) * steep);
}

#[test]
fn a_rounded_tip_runs_smoothly_into_the_sides() {
    // A 60° cone about a ball of radius ρ has its apex 2ρ below the ball's centre.
    let bit = profile("v_bit", &[("tip_radius", 0.5)]);
    let meet = 0.5 * 30.0_f64.to_radians().cos();
    let ball = |r: f64| 0.5 - (0.25 - r * r).sqrt();
    has_heights(&bit, |r| if r < meet { ball(r) } else { r * 3.0_f64.sqrt() - 0.5 });
    let slope = |r: f64| (bit.height(r + 1e-7) - bit.height(r)) / 1e-7;
    assert!((slope(meet - 2e-7) - slope(meet + 1e-7)).abs() < 1e-5);
}

#[test]
fn tips_that_do_not_fit_are_refused() {
    assert_eq!(
        refusal("v_bit", &[("tip_diameter", 0.2), ("tip_radius", 0.1)]),
        "a tip is either flat or rounded, but tip_diameter is 0.2 mm and tip_radius 0.1 mm; set one of \
         them to 0"
    );
    assert_eq!(
        refusal("v_bit", &[("tip_diameter", 6.0)]),
        "a tip_diameter of 6 mm leaves no cone at a diameter of 6 mm; give a smaller tip_diameter or a \
         larger diameter"
    );
    assert_eq!(
        refusal("v_bit", &[("tip_radius", 4.0)]),
        "a tip_radius of 4 mm leaves no cone at a diameter of 6 mm and an included_angle of 60.0000 deg; \
         give a tip_radius below 3.4641 mm or a diameter above 6.9282 mm"
    );
    assert_eq!(
        refusal("tapered_ball", &[("tip_radius", 3.5)]),
        "a tip_radius of 3.5 mm leaves no taper at a diameter of 6 mm, which is that where the taper \
         ends; give a tip_radius below 3.0115 mm or a diameter above 6.9734 mm, or take a ball"
    );
}

#[test]
fn a_tapered_ball_is_a_ball_and_a_slender_cone() {
    // The cone about a ball of radius ρ has its apex ρ/sin α below the ball's centre.
    let (nose, angle) = (0.5, 5.0_f64.to_radians());
    let bit = profile("tapered_ball", &[]);
    let cone = |r: f64| r / angle.tan() + nose - nose / angle.sin();
    let ball = |r: f64| nose - (nose * nose - r * r).sqrt();
    has_heights(&bit, |r| if r < nose * angle.cos() { ball(r) } else { cone(r) });
}

#[test]
fn the_taper_angle_is_that_of_one_side() {
    // A ball of 1/32 in and a shank of 1/4 in, 5.4° a side, taper over about an inch.
    let inch = 25.4;
    let given = [("diameter", 0.25 * inch), ("tip_radius", inch / 32.0), ("taper_angle", 5.4)];
    let length = profile("tapered_ball", &given).height(0.125 * inch);
    assert!((length - inch).abs() < 0.03 * inch, "{length}");
}

//! What every standard shape must keep to, and the heights of each against closed forms.

#![allow(clippy::unwrap_used, reason = "a failing helper fails its test")]

use carvegraph_cutters::standard;
use carvegraph_sdk::{CutterShape, Dimensions, Profile};

fn shape(name: &str) -> Box<dyn CutterShape> {
    standard().into_iter().find(|s| s.name() == name).unwrap()
}

fn profile(shape: &dyn CutterShape, given: &[(&str, f64)]) -> Profile {
    shape.profile(&Dimensions::new(shape.dimensions(), given).unwrap()).unwrap()
}

#[test]
fn shapes_are_sorted_and_named_once() {
    let names: Vec<_> = standard().iter().map(|s| s.name().to_owned()).collect();
    assert_eq!(names, ["ball", "flat"]);
}

#[test]
fn every_shape_is_documented_and_has_a_diameter() {
    for shape in standard() {
        assert!(!shape.about().is_empty());
        assert_eq!(shape.dimensions()[0].name, "diameter", "{}", shape.name());
        for d in shape.dimensions() {
            assert!(!d.about.is_empty() && (d.min..=d.max).contains(&d.default), "{}", d.name);
        }
    }
}

#[test]
fn the_diameter_is_kept_over_its_whole_range() {
    for shape in standard() {
        let spec = shape.dimensions()[0];
        for diameter in [spec.min, spec.default, 3.175, spec.max] {
            let profile = profile(&*shape, &[("diameter", diameter)]);
            assert_eq!(profile.radius_mm(), diameter / 2.0);
            assert_eq!(profile.height(0.0), 0.0, "the tip is the controlled point");
        }
    }
}

#[test]
fn a_ball_is_round_and_a_flat_is_level() {
    let ball = profile(&*shape("ball"), &[("diameter", 6.0)]);
    assert!((ball.height(1.5) - (3.0 - 6.75_f64.sqrt())).abs() < 1e-12);
    assert!((ball.height(3.0) - 3.0).abs() < 1e-12);
    let flat = profile(&*shape("flat"), &[("diameter", 6.0)]);
    assert_eq!(flat.height(2.999), 0.0);
}

//! The suite finds what is wrong.

use super::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

const SPECS: &[DimensionSpec] = &[
    DimensionSpec::DIAMETER,
    DimensionSpec { name: "tip", about: "Its tip", default: 1.0, ..DimensionSpec::DIAMETER },
];

/// A flat end mill that does something wrong.
struct Wrong<'a> {
    name: &'static str,
    specs: &'a [DimensionSpec],
    make: fn(f64) -> Result<Profile, CutterError>,
}

const RIGHT: Wrong<'static> = Wrong {
    name: "right",
    specs: &[DimensionSpec::DIAMETER],
    make: |diameter| Ok(Profile::flat(diameter / 2.0)?),
};

impl CutterShape for Wrong<'_> {
    fn name(&self) -> &str {
        self.name
    }

    fn about(&self) -> &str {
        "A cutter for tests"
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        self.specs
    }

    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        (self.make)(dimensions.get("diameter")?)
    }
}

fn fault(shape: &Wrong<'_>) -> String {
    described(shape).and_then(|()| sized(shape, None)).unwrap_err()
}

#[test]
fn a_right_shape_passes() {
    check(&RIGHT);
}

#[test]
#[should_panic(expected = "cutter shape \"Flat\": its name, \"Flat\", must be lower case")]
fn a_panic_names_the_shape() {
    check(&Wrong { name: "Flat", ..RIGHT });
}

#[test]
#[should_panic(expected = "check_drawn is for shapes that need a drawing")]
fn drawings_are_for_shapes_that_need_them() {
    check_drawn(&RIGHT, &["<svg/>"]);
}

#[test]
fn dimensions_are_looked_through() {
    let told = |specs: &[DimensionSpec]| fault(&Wrong { specs, ..RIGHT });
    assert!(told(&[]).contains("first dimension must be \"diameter\""));
    assert!(told(&[SPECS[1]]).contains("first dimension must be \"diameter\""));
    assert!(told(&[SPECS[0], SPECS[0]]).contains("two of its dimensions"));
    const WIDE: DimensionSpec = DimensionSpec { default: 300.0, ..DimensionSpec::DIAMETER };
    assert!(told(&[WIDE]).contains("its default between"));
    const ENDLESS: DimensionSpec = DimensionSpec { max: f64::INFINITY, ..DimensionSpec::DIAMETER };
    assert!(told(&[ENDLESS]).contains("finite min < max"));
}

#[test]
fn profiles_are_looked_through() {
    let told = |specs, make| fault(&Wrong { specs, make, ..RIGHT });
    assert!(told(&SPECS[..1], |d| Ok(Profile::flat(d)?)).contains("not half the diameter"));
    let small = |d| match d {
        d if d < 3.0 => Err(CutterError::Shape("too small".to_owned())),
        d => Ok(Profile::flat(d / 2.0)?),
    };
    assert!(told(&SPECS[..1], small).contains("it must be taken: too small"));
    assert!(told(SPECS, small).contains("must name a dimension"));
    let never = |_| Err(CutterError::Shape("no".to_owned()));
    assert!(told(SPECS, never).contains("the defaults must make a cutter: no"));
}

#[test]
fn answers_that_change_are_told() {
    static TURN: AtomicBool = AtomicBool::new(false);
    let make = |d| {
        let turn = TURN.fetch_xor(true, Relaxed);
        Ok(if turn { Profile::flat(d / 2.0)? } else { Profile::ball(d / 2.0)? })
    };
    assert!(fault(&Wrong { make, ..RIGHT }).contains("two answers"));
}

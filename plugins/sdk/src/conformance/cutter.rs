//! What every cutter shape must fulfil.
//!
//! * Its name and its dimensions are spelled, described, unique and in range; the first is `diameter`
//!   unless a drawing says how wide it is.
//! * Over the whole range of its dimensions, the ends included, it gives a profile or an error that
//!   names a dimension and a number; at the defaults, and where it has but one dimension, a profile.
//! * The same dimensions give the same answer.
//! * A profile starts at the tip, is finite, never falls, and is as wide as its diameter says.
//! * The drop cutter's heights with it are those of brute force.
//! * A shape that needs a drawing refuses none, an empty and a broken one, and takes no harm from
//!   drawings of which parts are missing or changed.

mod drawings;
mod drops;
mod samples;
#[cfg(test)]
mod tests;

use crate::{CutterError, CutterShape, DimensionSpec, DimensionUnit, Dimensions, Profile};
use samples::samples;

/// Holds a shape against what [`CutterShape`] promises.
///
/// # Panics
/// With what is wrong, if anything is.
#[track_caller]
pub fn check(shape: &dyn CutterShape) {
    let fault = if shape.drawing().is_some() {
        Err("it needs a drawing: call check_drawn with some that it must take".to_owned())
    } else {
        described(shape).and_then(|()| sized(shape, None))
    };
    told(shape, fault);
}

/// Holds a shape that needs a drawing against what [`CutterShape`] promises, with `drawings` that it
/// must take.
///
/// # Panics
/// With what is wrong, if anything is.
#[track_caller]
pub fn check_drawn(shape: &dyn CutterShape, drawings: &[&str]) {
    let fault = if shape.drawing().is_none() || drawings.is_empty() {
        Err("check_drawn is for shapes that need a drawing, and needs one that they take"
            .to_owned())
    } else {
        described(shape)
            .and_then(|()| drawings::bad_ones_are_refused(shape))
            .and_then(|()| drawings.iter().try_for_each(|text| sized(shape, Some(text))))
            .and_then(|()| drawings.iter().try_for_each(|text| drawings::changed(shape, text)))
    };
    told(shape, fault);
}

#[track_caller]
fn told(shape: &dyn CutterShape, fault: Fault) {
    if let Err(fault) = fault {
        panic!("cutter shape {:?}: {fault}", shape.name());
    }
}

/// `Err` with what is wrong.
type Fault = Result<(), String>;

fn ensure(good: bool, fault: impl FnOnce() -> String) -> Fault {
    if good { Ok(()) } else { Err(fault()) }
}

/// Names, words, units and ranges.
fn described(shape: &dyn CutterShape) -> Fault {
    named("its name", shape.name())?;
    worded("about", shape.about())?;
    if let Some(drawing) = shape.drawing() {
        worded("drawing", drawing)?;
    }
    let specs = shape.dimensions();
    specs.iter().try_for_each(dimension)?;
    for (index, spec) in specs.iter().enumerate() {
        let again = specs[..index].iter().any(|before| before.name == spec.name);
        ensure(!again, || format!("two of its dimensions are named {:?}", spec.name))?;
    }
    let first = specs.first();
    let diameter = first.is_some_and(|d| d.name == "diameter" && d.unit == DimensionUnit::Mm);
    ensure(diameter || shape.drawing().is_some(), || {
        "its first dimension must be \"diameter\", in mm".to_owned()
    })?;
    outside_is_refused(specs)
}

fn named(what: &str, name: &str) -> Fault {
    let lower = name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    ensure(lower, || {
        format!("{what}, {name:?}, must be lower case letters, digits and _, a letter first")
    })
}

fn worded(what: &str, words: &str) -> Fault {
    let line = !words.trim().is_empty() && !words.contains(['\n', '\r']);
    ensure(line, || format!("{what}() must be a line of words, not {words:?}"))
}

fn dimension(spec: &DimensionSpec) -> Fault {
    named("the name of a dimension", spec.name)?;
    worded(&format!("the about of {}", spec.name), spec.about)?;
    let DimensionSpec { name, min, default, max, .. } = *spec;
    let ordered = min < max && (min..=max).contains(&default);
    let finite = [min, default, max].iter().all(|v| v.is_finite());
    ensure(finite && ordered, || {
        format!(
            "{name} must have finite min < max and its default between, not {min}, {max}, {default}"
        )
    })
}

fn outside_is_refused(specs: &[DimensionSpec]) -> Fault {
    for spec in specs {
        let outside = [spec.min.next_down(), spec.max.next_up(), f64::INFINITY, -f64::INFINITY];
        for value in outside.into_iter().chain([f64::NAN]) {
            let refused = Dimensions::new(specs, &[(spec.name, value)]).is_err();
            ensure(refused, || format!("a {} of {value} must be refused", spec.name))?;
        }
    }
    Ok(())
}

/// Profiles over the range of the dimensions, and what the drop cutter makes of some.
fn sized(shape: &dyn CutterShape, drawing: Option<&str>) -> Fault {
    for (index, given) in samples(shape.dimensions()).iter().enumerate() {
        let told = |fault| format!("with {given:?}: {fault}");
        match profile(shape, given, drawing).map_err(told)? {
            Ok(made) => {
                sound(&made, shape.dimensions(), given).map_err(told)?;
                let fields = if index == 0 { FIELDS } else { 1 };
                drops::equal_brute_force(&made, index as u64, fields).map_err(told)?;
            }
            Err(error) => {
                ensure(index > 0, || format!("the defaults must make a cutter: {error}"))?;
                says_what_to_change(&error, shape.dimensions()).map_err(told)?;
            }
        }
    }
    Ok(())
}

/// Fields on which the cutter of the default dimensions is dropped; others are on one. Brute force is
/// slow.
const FIELDS: usize = 20;

/// What the shape answers, the same twice.
fn profile(
    shape: &dyn CutterShape,
    given: &[(&str, f64)],
    drawing: Option<&str>,
) -> Result<Result<Profile, CutterError>, String> {
    let dimensions = Dimensions::new(shape.dimensions(), given).map_err(|e| e.to_string())?;
    let dimensions = match drawing {
        Some(text) => dimensions.with_drawing(text),
        None => dimensions,
    };
    let answer = shape.profile(&dimensions);
    ensure(answer == shape.profile(&dimensions), || {
        "two calls of profile() give two answers".to_owned()
    })?;
    Ok(answer)
}

/// An error must tell a user which number to change.
fn says_what_to_change(error: &CutterError, specs: &[DimensionSpec]) -> Fault {
    ensure(specs.len() > 1, || {
        format!("there is nothing its value must go together with, so it must be taken: {error}")
    })?;
    let text = error.to_string();
    let names = specs.iter().any(|spec| text.contains(spec.name));
    ensure(names && text.contains(|c: char| c.is_ascii_digit()), || {
        format!("the error must name a dimension as it is spelled and a value to change: {text:?}")
    })
}

/// A profile as the drop cutter needs it, as wide as the dimensions say.
fn sound(profile: &Profile, specs: &[DimensionSpec], given: &[(&str, f64)]) -> Fault {
    /// Rounding, in radii.
    const ROUNDING: f64 = 1e-12;
    let radius = profile.radius_mm();
    ensure(radius.is_finite() && radius > 0.0, || format!("its radius is {radius} mm"))?;
    let default = specs.first().filter(|s| s.name == "diameter").map(|s| s.default);
    let diameter = given.iter().find(|(name, _)| *name == "diameter").map(|&(_, d)| d);
    if let Some(diameter) = default.map(|default| diameter.unwrap_or(default)) {
        ensure((radius - diameter / 2.0).abs() <= ROUNDING * radius, || {
            format!("its radius is {radius} mm, not half the diameter of {diameter} mm")
        })?;
    }
    runs_up(profile)
}

/// h is 0 at the tip, finite, does not fall, and goes through the ends of all segments.
fn runs_up(profile: &Profile) -> Fault {
    const SAMPLES: u32 = 1000;
    /// Where an arc ends upright, half the digits are lost from r to h.
    const SLACK: f64 = 1e-7;
    let (radius, mut before) = (profile.radius_mm(), 0.0);
    let top = profile.segments().last().map_or(0.0, |segment| segment.to()[1]);
    let rounding = SLACK * (radius + top);
    ensure(profile.height(0.0) == 0.0, || "its tip is not at height 0".to_owned())?;
    for k in 0..=SAMPLES {
        let r = (radius * f64::from(k) / f64::from(SAMPLES)).min(radius);
        let h = profile.height(r);
        ensure(h.is_finite() && h >= before - rounding, || {
            format!("its height at r {r} mm is {h} mm, {before} mm further in")
        })?;
        before = h;
    }
    let mut from = [0.0; 2];
    for segment in profile.segments() {
        let [r, h] = segment.to();
        let found = profile.height(r);
        // At a shoulder the height is that of its foot.
        ensure(r <= from[0] || (found - h).abs() <= rounding, || {
            format!("a segment ends at r {r} mm, h {h} mm, where its height is {found} mm")
        })?;
        from = [r, h];
    }
    Ok(())
}

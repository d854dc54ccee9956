//! Dimensions to try a shape with.

use crate::DimensionSpec;
use fastrand::Rng;

/// Random samples: enough for each pair of dimensions to meet at their extremes.
const RANDOM: usize = 300;

/// Dimensions of which all corners of the range are tried; 2 to this power.
const CORNERS: usize = 6;

/// Sets of dimensions within their ranges. The defaults come first, then sets near them, then
/// corners and random ones; always the same.
pub(super) fn samples(specs: &[DimensionSpec]) -> Vec<Vec<(&'static str, f64)>> {
    let mut sets = vec![Vec::new()];
    if specs.is_empty() {
        return sets;
    }
    let mut random = Rng::with_seed(1);
    sets.extend((0..RANDOM / 10).map(|_| near_defaults(specs, &mut random)));
    for spec in specs {
        sets.extend([spec.min, spec.max].map(|end| vec![(spec.name, end)]));
    }
    let corners = 1_usize << specs.len().min(CORNERS);
    sets.extend((0..corners).map(|corner| {
        let ends = specs.iter().enumerate().take(CORNERS);
        ends.map(|(k, s)| (s.name, if corner >> k & 1 == 0 { s.min } else { s.max })).collect()
    }));
    sets.extend((0..RANDOM).map(|_| anywhere(specs, &mut random)));
    sets
}

/// Half to twice the defaults.
fn near_defaults(specs: &[DimensionSpec], random: &mut Rng) -> Vec<(&'static str, f64)> {
    let near = |s: &DimensionSpec, share: f64| (s.default * share).clamp(s.min, s.max);
    specs.iter().map(|s| (s.name, near(s, 2.0_f64.powf(2.0 * random.f64() - 1.0)))).collect()
}

/// Evenly over the range, at its ends, or as near to its lower end as numbers of all sizes are.
fn anywhere(specs: &[DimensionSpec], random: &mut Rng) -> Vec<(&'static str, f64)> {
    let mut value = |s: &DimensionSpec| {
        let width = s.max - s.min;
        match random.usize(..6) {
            0 => s.min,
            1 => s.max,
            2 | 3 => s.min + width * 10.0_f64.powf(-16.0 * random.f64()),
            _ => s.min + width * random.f64(),
        }
    };
    specs.iter().map(|s| (s.name, value(s).clamp(s.min, s.max))).collect()
}

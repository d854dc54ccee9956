//! The drop cutter with a profile, against brute force.

use super::{Fault, ensure};
use carvegraph_geometry::{
    Against, DVec2, HeightField, Pattern, PatternSpan, Profile, drop_on_height_field, oracle,
};
use fastrand::Rng;

const FLOOR_MM: f64 = -1e6;

/// Greatest difference from brute force in mm: what is promised for any profile.
const EXACT_MM: f64 = 1e-6;

/// Rounding of heights, relative to the greatest there are: slender cones are metres high.
const ROUNDING: f64 = 1e-12;

/// On small fields of random heights, as points and as meshes.
pub(super) fn equal_brute_force(profile: &Profile, seed: u64, fields: usize) -> Fault {
    let mut random = Rng::with_seed(seed);
    (0..fields).try_for_each(|_| {
        let field = field(profile.radius_mm(), &mut random)?;
        let places = places(&field, profile.radius_mm(), &mut random);
        equal_on(&field, profile, &places)
    })
}

fn equal_on(field: &HeightField, profile: &Profile, places: &[DVec2]) -> Fault {
    for against in [Against::Points, Against::Mesh] {
        let tips = tips(field, against, profile, places)?;
        for (tip, &at) in tips.into_iter().zip(places) {
            let truth = oracle::drop(field, against, profile, at).max(FLOOR_MM);
            let top = profile.height(profile.radius_mm()) + field.bounds().size().z;
            ensure((tip - truth).abs() <= EXACT_MM + ROUNDING * top, || {
                format!(
                    "dropped at {at} against {against:?} of a field of pitch {} mm, its tip is at {tip} mm; \
                     brute force has {truth} mm",
                    field.pitch_mm()
                )
            })?;
        }
    }
    Ok(())
}

/// A field of 9 × 8 nodes, finer than the cutter or about as coarse.
fn field(radius_mm: f64, random: &mut Rng) -> Result<HeightField, String> {
    let (columns, rows) = (9, 8);
    let pitch = radius_mm * [0.13, 0.4, 1.2][random.usize(..3)];
    let steep = radius_mm * [0.05, 0.5, 2.0][random.usize(..3)];
    let heights = (0..columns * rows).map(|_| (steep * random.f64()) as f32).collect();
    HeightField::new(columns, rows, pitch, heights).map_err(|e| e.to_string())
}

/// Places over the field, at its border and beyond.
fn places(field: &HeightField, radius_mm: f64, random: &mut Rng) -> Vec<DVec2> {
    let size = field.bounds().size().truncate();
    let mut anywhere = || {
        let share = DVec2::new(random.f64(), random.f64());
        (size + radius_mm) * share - radius_mm / 2.0
    };
    (0..10).map(|_| anywhere()).chain([field.point(3, 4).truncate(), size * 3.0]).collect()
}

fn tips(
    field: &HeightField,
    against: Against,
    profile: &Profile,
    places: &[DVec2],
) -> Result<Vec<f64>, String> {
    let span = PatternSpan { points: 0..places.len(), link: false, joined: false };
    let pattern = Pattern { points: places.to_vec(), spans: vec![span] };
    let path = drop_on_height_field(field, against, profile, &pattern, FLOOR_MM, &|_| true);
    let path = path.ok_or("the drop cutter stopped of itself")?;
    Ok(path.tips.iter().map(|tip| tip.z).collect())
}

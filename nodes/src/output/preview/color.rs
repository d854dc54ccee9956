//! Colours in linear light, and their way into a picture's bytes.
//!
//! Light adds up linearly, so everything is mixed in linear light and encoded once at the end as
//! sRGB (IEC 61966-2-1). A fixed pattern of half a level either way hides the steps that 256 levels
//! would show on a large, almost even wall.

use std::sync::LazyLock;

/// Red, green and blue in linear light; 1 is the brightest the picture can show.
pub(super) type Linear = [f32; 3];

/// Entries of the encoding table. With the square root as index it is within 0.06 of a level.
const TABLE_LEN: usize = 4096;

/// sRGB levels 0 … 255, not rounded, by the square root of the linear light.
static ENCODED: LazyLock<Vec<f32>> = LazyLock::new(|| {
    let level = |i: usize| {
        let light = (i as f64 / (TABLE_LEN - 1) as f64).powi(2);
        let encoded = if light <= 0.003_130_8 {
            12.92 * light
        } else {
            1.055 * light.powf(1.0 / 2.4) - 0.055
        };
        (encoded * 255.0) as f32
    };
    (0..TABLE_LEN).map(level).collect()
});

/// Linear light of a colour given as sRGB bytes, the way colours are usually written down.
pub(super) fn linear(srgb: [u8; 3]) -> Linear {
    srgb.map(|level| {
        let encoded = f32::from(level) / 255.0;
        if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    })
}

/// sRGB bytes of a colour at pixel (`x`, `y`), clipped to what can be shown.
pub(super) fn encode(color: Linear, x: usize, y: usize) -> [u8; 3] {
    let table = &*ENCODED;
    let dither = unit_hash(x as u32, y as u32, 0) - 0.5;
    color.map(|light| {
        let index = light.clamp(0.0, 1.0).sqrt() * (TABLE_LEN - 1) as f32;
        (table[index as usize] + 0.5 + dither).clamp(0.0, 255.0) as u8
    })
}

/// `a` where `share` is 0, `b` where it is 1.
pub(super) fn mix(a: Linear, b: Linear, share: f32) -> Linear {
    [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * share)
}

/// 0 below `low`, 1 above `high`, a smooth cubic between.
pub(super) fn smooth_step(low: f32, high: f32, value: f32) -> f32 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Linear light of a colour given as lightness, chroma and hue (in turns) in the Oklab space, where
/// equal steps look equal (B. Ottosson, "A perceptual color space for image processing", 2020).
pub(super) fn oklch(lightness: f32, chroma: f32, hue_turns: f32) -> Linear {
    let (sin, cos) = (hue_turns * std::f32::consts::TAU).sin_cos();
    let (a, b) = (chroma * cos, chroma * sin);
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ]
    .map(|light| light.clamp(0.0, 1.0))
}

/// A number from 0 to below 1 that looks random but depends on the arguments alone (the "lowbias32"
/// mixer of C. Wellons, "Prospecting for Hash Functions", 2018).
pub(super) fn unit_hash(x: u32, y: u32, seed: u32) -> f32 {
    // Odd multipliers spread neighbouring places over all bits before they are mixed.
    let mut h = x
        .wrapping_mul(0x9e37_79b1)
        .wrapping_add(y.wrapping_mul(0x85eb_ca77))
        .wrapping_add(seed.wrapping_mul(0xc2b2_ae3d));
    h ^= h >> 16;
    h = h.wrapping_mul(0x7feb_352d);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846c_a68b);
    h ^= h >> 16;
    (h >> 8) as f32 / 16_777_216.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoding_undoes_linear_but_for_the_dither() {
        for level in 0..=255_u8 {
            for x in 0..20 {
                let [found, ..] = encode(linear([level; 3]), x, 3);
                assert!(found.abs_diff(level) <= 1, "{level} became {found}");
            }
        }
    }

    #[test]
    fn oklab_white_is_white() {
        assert!(oklch(1.0, 0.0, 0.3).iter().all(|light| (light - 1.0).abs() < 1e-3));
    }
}

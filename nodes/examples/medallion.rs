//! Makes the bundled sample `graphs/samples/medallion.png`: a sun in a laurel wreath.
//!
//! The picture is a 16-bit depth map, bright is high: 65 535 is 5 mm when carved on a plaque of
//! 203 × 203 mm. It is computed, not painted: every part is a height in mm as a function of the
//! place in mm, parts lie over each other by taking the higher one, and features of the face are
//! smooth bumps added to a dome. Hollows are wide enough for a 6 mm ball-nose cutter to shape.
//!
//! Each pixel is the mean of a grid of samples, so outlines are smooth. `sin` and `cos` may differ
//! in their last bit between machines; after rounding a level of 65 535 may then differ by one.
//!
//! ```text
//! cargo run --release --example medallion [graphs/samples/medallion.png]
//! ```

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ImageBuffer, ImageEncoder, ImageResult, Luma};
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

/// Side of the plaque, in mm.
const SIDE_MM: f64 = 203.0;
/// Height of the brightest level, in mm.
const DEPTH_MM: f64 = 5.0;
/// Side of the shipped picture.
const SIZE_PX: u32 = 640;
/// Samples a pixel along x and along y: enough that no outline shows steps.
const SAMPLES: u32 = 3;

/// The ground outside the rim, between rim and beads, and behind the sun, in mm.
const OUTER_GROUND: f64 = 0.9;
const WREATH_GROUND: f64 = 0.8;
const SUN_GROUND: f64 = 0.35;

fn main() -> ImageResult<()> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs/samples/medallion.png");
    let path = std::env::args_os().nth(1).map_or(default, PathBuf::from);
    let picture = medallion(SIZE_PX);
    let bytes: Vec<u8> = picture.as_raw().iter().flat_map(|level| level.to_ne_bytes()).collect();
    let file = std::io::BufWriter::new(std::fs::File::create(path)?);
    PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive).write_image(
        &bytes,
        SIZE_PX,
        SIZE_PX,
        image::ExtendedColorType::L16,
    )
}

/// The depth map, `size` × `size` pixels.
#[must_use]
pub fn medallion(size: u32) -> ImageBuffer<Luma<u16>, Vec<u16>> {
    let step = SIDE_MM / f64::from(size * SAMPLES);
    let place = |pixel: u32, sample: u32| {
        (f64::from(pixel * SAMPLES + sample) + 0.5) * step - SIDE_MM / 2.0
    };
    ImageBuffer::from_fn(size, size, |i, j| {
        let mut sum = 0.0;
        for sample in 0..SAMPLES * SAMPLES {
            let x = place(i, sample % SAMPLES);
            sum += height(V { x, y: -place(j, sample / SAMPLES) });
        }
        let mean = sum / f64::from(SAMPLES * SAMPLES);
        Luma([(mean / DEPTH_MM * 65_535.0).round().clamp(0.0, 65_535.0) as u16])
    })
}

/// A place on the plaque in mm: x to the right, y up, from the middle.
#[derive(Clone, Copy)]
struct V {
    x: f64,
    y: f64,
}

impl V {
    fn len(self) -> f64 {
        (self.x * self.x + self.y * self.y).sqrt()
    }

    fn minus(self, other: V) -> V {
        V { x: self.x - other.x, y: self.y - other.y }
    }

    /// The same place in axes turned counterclockwise by `angle`.
    fn turned(self, angle: f64) -> V {
        let (sin, cos) = angle.sin_cos();
        V { x: self.x * cos + self.y * sin, y: self.y * cos - self.x * sin }
    }

    fn polar(radius: f64, angle: f64) -> V {
        let (sin, cos) = angle.sin_cos();
        V { x: radius * cos, y: radius * sin }
    }
}

/// Radii of the middle lines of the rope, of the wreath and of the string of beads, in mm.
const ROPE_RING: f64 = 89.8;
const WREATH_RING: f64 = 73.2;
const BEAD_RING: f64 = 60.2;

/// Height of the plaque at `p`, in mm.
fn height(p: V) -> f64 {
    let r = p.len();
    let ground = ground(r);
    if r > 97.0 {
        ground.max(corner(p))
    } else if r > 82.0 {
        ground.max(rope(p, r)).max(rosette(V { x: p.x, y: p.y + WREATH_RING }))
    } else if r > BEAD_RING {
        ground.max(wreath(p)).max(beads(p, r))
    } else {
        ground.max(beads(p, r)).max(sun(p, r))
    }
}

/// Everything that only depends on the distance from the middle: grounds and fillets.
fn ground(r: f64) -> f64 {
    let outer = mix(WREATH_GROUND, OUTER_GROUND, step(84.0, 98.0, r));
    let ground = mix(SUN_GROUND, outer, step(BEAD_RING - 5.0, BEAD_RING - 1.5, r));
    let fillet = |middle: f64, half: f64, top: f64| {
        let e = ((r - middle) / half).abs();
        if e < 1.0 { top * (1.0 - e * e * e * e).sqrt() } else { 0.0 }
    };
    ground.max(fillet(96.4, 2.0, 2.3)).max(fillet(83.2, 1.9, 2.1)).max(fillet(BEAD_RING, 4.4, 1.5))
}

/// A twisted rope around the wreath.
fn rope(p: V, r: f64) -> f64 {
    const STRANDS: f64 = 42.0;
    let q = (r - ROPE_RING) / 5.4;
    if q.abs() >= 1.0 {
        return 0.0;
    }
    // A helix on a torus, seen from above, leans over towards its sides.
    let twist = p.y.atan2(p.x) / TAU * STRANDS + 0.55 * q * (1.0 + 0.35 * q * q);
    let across = 2.0 * (twist - twist.floor()) - 1.0;
    let strand = (1.0 - 0.93 * across * across).sqrt();
    0.8 + (1.0 - q * q).sqrt() * (1.2 + 1.75 * strand)
}

/// A string of beads between wreath and sun.
fn beads(p: V, r: f64) -> f64 {
    const BEADS: f64 = 38.0;
    let turn = p.y.atan2(p.x) / TAU * BEADS;
    let along = (turn - turn.floor() - 0.5) * TAU * BEAD_RING / BEADS;
    let d2 = (along * along + (r - BEAD_RING) * (r - BEAD_RING)) / (4.0 * 4.0);
    if d2 < 1.0 { 0.9 + 2.3 * (1.0 - d2).sqrt() } else { 0.0 }
}

/// A leaf from the origin along +x: its height above its ground, in mm. It has a blunt base, a
/// pointed tip, and a vein down the middle; it rises from `low` to `high`.
fn leaf(p: V, length: f64, half_width: f64, low: f64, high: f64) -> f64 {
    let s = p.x / length;
    if s <= 0.0 || s >= 1.0 {
        return 0.0;
    }
    // √s · (1 - s) is widest at s = 1/3, where it is 1 / 2.598.
    let width = half_width * 2.598 * s.sqrt() * (1.0 - s);
    let e = p.y.abs() / width;
    if e >= 1.0 {
        return 0.0;
    }
    let vein = 0.42 * bump(p.y / (0.42 * half_width)) * step(1.0, 0.7, s);
    mix(low, high, s) * ((1.0 - e * e * e).sqrt() - vein)
}

/// Two branches of laurel from a rosette at the bottom to the top.
fn wreath(p: V) -> f64 {
    const PITCH: f64 = 0.2;
    const STATIONS: f64 = 14.0;
    let p = V { x: p.x.abs(), y: p.y };
    // Angle from the bottom, where the branch starts.
    let turn = p.x.atan2(-p.y);
    let near = (turn / PITCH).floor();
    let mut top: f64 = stem(p);
    for k in -3..=1 {
        let station = near + f64::from(k);
        if (0.0..STATIONS).contains(&station) {
            top = top.max(sprig(p, (station + 0.6) * PITCH));
        }
    }
    let low = V { x: p.x, y: p.y + WREATH_RING };
    let high = V { x: p.x, y: p.y - WREATH_RING };
    let beside = V { x: p.x - 8.4, y: p.y - WREATH_RING + 0.5 };
    top = top.max(berry(high, 4.9, 2.7)).max(berry(beside, 3.7, 1.9));
    (WREATH_GROUND + top).max(rosette(low))
}

fn stem(p: V) -> f64 {
    0.9 * bump((p.len() - WREATH_RING) / 2.6)
}

/// Three leaves and two berries at `turn` along the branch.
fn sprig(p: V, turn: f64) -> f64 {
    let root = V::polar(WREATH_RING, turn - PI / 2.0);
    let ahead = p.minus(root).turned(turn);
    let side = |offset: f64, lean: f64| V { x: ahead.x, y: ahead.y - offset }.turned(lean);
    let outer = leaf(side(-1.2, -0.5), 18.5, 5.2, 0.8, 2.4);
    let inner = leaf(side(1.2, 0.5), 17.5, 5.0, 0.8, 2.4);
    let middle = leaf(side(0.0, 0.0), 20.5, 5.2, 1.0, 3.1);
    outer.max(inner).max(middle)
}

fn berry(p: V, radius: f64, top: f64) -> f64 {
    let d2 = (p.x * p.x + p.y * p.y) / (radius * radius);
    if d2 < 1.0 { top * (1.0 - d2).sqrt() } else { 0.0 }
}

/// A flower with five petals.
fn rosette(p: V) -> f64 {
    let r = p.len();
    if r > 13.5 {
        return 0.0;
    }
    let turn = p.x.atan2(p.y) / TAU * 5.0;
    let place = V::polar(r, (turn - turn.round()) * TAU / 5.0);
    let flower = WREATH_GROUND + 2.7 * petal(place, 12.4, 6.4);
    flower.max(1.2 + berry(p, 4.4, 2.9))
}

/// A petal from the origin along +x with a round tip, hollow along its middle: 1 at its highest.
fn petal(p: V, length: f64, half_width: f64) -> f64 {
    let s = p.x / length;
    if s <= 0.0 || s >= 1.0 {
        return 0.0;
    }
    // s · √(1 - s²) is widest at s = 1/√2, where it is 1/2.
    let width = half_width * 2.0 * s * (1.0 - s * s).sqrt();
    let e = p.y.abs() / width;
    if e >= 1.0 {
        return 0.0;
    }
    (0.35 + 0.65 * s) * ((1.0 - e * e * e).sqrt() - 0.3 * bump(e / 0.75) * step(1.0, 0.6, s))
}

/// A palmette in a corner.
fn corner(p: V) -> f64 {
    let p = V { x: p.x.abs(), y: p.y.abs() }.turned(PI / 4.0);
    let p = V { x: p.x - 100.0, y: p.y.abs() };
    let fan = [(0.0, 38.0, 6.6), (0.42, 31.5, 5.6), (0.83, 27.0, 5.0), (1.22, 24.0, 4.4)];
    let mut top: f64 = 0.0;
    for (lean, length, half_width) in fan {
        top = top.max(petal(p.turned(lean), length, half_width));
    }
    (OUTER_GROUND + 2.2 * top).max(OUTER_GROUND + berry(p, 7.5, 2.9))
}

/// The sun: rays and face.
fn sun(p: V, r: f64) -> f64 {
    let mut top = SUN_GROUND;
    if r > 28.0 {
        top = top.max(SUN_GROUND + rays(p));
    }
    top.max(face(p))
}

/// Twelve straight rays, and twelve flames between them.
fn rays(p: V) -> f64 {
    let turn = p.x.atan2(p.y) / TAU * 12.0;
    let at = |turn: f64| V::polar(p.len(), (turn - turn.round()) * TAU / 12.0);
    straight_ray(at(turn)).max(flame(at(turn + 0.5)))
}

fn straight_ray(p: V) -> f64 {
    let s = (p.x - 32.0) / 23.6;
    let width = 7.4 * (1.0 - s);
    let e = p.y.abs() / width;
    if s < 1.0 && e < 1.0 { swell(s) * soft_roof(e) } else { 0.0 }
}

fn flame(p: V) -> f64 {
    let s = (p.x - 32.0) / 22.0;
    let sway = 1.9 * (s * TAU * 0.95 + 0.6).sin() * s;
    let width = 5.2 * (1.0 - s * s);
    let e = (p.y - sway).abs() / width;
    if s < 1.0 && e < 1.0 { 0.85 * swell(s) * (1.0 - e * e).sqrt() } else { 0.0 }
}

/// Height of a ray from its root, which dips under the face, to its tip.
fn swell(s: f64) -> f64 {
    mix(0.9, 2.3, step(0.1, 0.5, s)) * mix(1.0, 0.55, s * s)
}

/// A ridge with straight sides and a rounded top, 1 in the middle and 0 where `e` is 1.
fn soft_roof(e: f64) -> f64 {
    1.12 - (e * e + 0.0144 + 0.2256 * e * e * e * e).sqrt().min(1.12)
}

/// The face is laid out 33 mm wide and 35.5 mm high each way, then enlarged by this factor.
const FACE_SCALE: f64 = 1.07;

/// The face, mirrored about its middle.
fn face(p: V) -> f64 {
    let p = V { x: p.x.abs() / FACE_SCALE, y: p.y / FACE_SCALE };
    let q2 = (p.x / 33.0) * (p.x / 33.0) + (p.y / 35.5) * (p.y / 35.5);
    if q2 >= 1.0 {
        return 0.0;
    }
    let q4 = q2 * q2;
    let dome = 1.65 * (1.0 - q4 * q4).sqrt() + 1.5 * (1.0 - q2);
    let skin = dome + brow(p) + cheeks(p) + nose(p) + mouth(p) + chin(p);
    eye(p, skin)
}

fn brow(p: V) -> f64 {
    let arch = 13.2 - 0.028 * (p.x - 13.5) * (p.x - 13.5);
    let ridge = 1.2 * bump((p.y - arch) / 4.2) * step(26.0, 17.0, p.x) * step(1.5, 6.0, p.x);
    let forehead = 0.45 * blob(p, 0.0, 24.0, 19.0, 10.0);
    ridge + forehead
}

fn cheeks(p: V) -> f64 {
    1.0 * blob(p, 17.5, -6.5, 12.5, 11.5) - 0.4 * blob(p, 21.0, -18.0, 9.0, 9.0)
}

fn nose(p: V) -> f64 {
    let down = step(15.0, -5.0, p.y);
    let width = mix(4.4, 7.0, down * down);
    let rise = mix(0.7, 1.85, down) * step(-9.6, -5.6, p.y) * step(19.0, 11.0, p.y);
    let bridge = rise * bump(p.x / width);
    let wings = 0.95 * blob(p, 5.4, -5.8, 4.1, 3.8);
    bridge + wings
}

fn mouth(p: V) -> f64 {
    let line = -15.2 + 0.014 * p.x * p.x;
    let reach = step(12.0, 7.0, p.x);
    let upper = 1.1 * blob(p, 2.9, -13.1, 6.8, 3.1) + 0.2 * blob(p, 0.0, -13.4, 4.0, 2.6);
    let lower = 1.4 * blob(p, 0.0, -17.9, 9.0, 3.8);
    let cut = 0.9 * bump((p.y - line) / 1.8) * reach;
    let dimple = 0.4 * blob(p, 12.4, -13.4, 4.4, 4.4);
    let philtrum = 0.3 * blob(p, 0.0, -10.4, 2.0, 2.6);
    let fold = 0.5
        * stroke(p, V { x: 8.6, y: -4.5 }, V { x: 14.5, y: -14.0 }, 3.6)
        * step(-14.5, -8.0, p.y);
    upper + lower - cut - dimple - philtrum - fold
}

fn chin(p: V) -> f64 {
    1.2 * blob(p, 0.0, -27.5, 10.0, 7.5) - 0.5 * blob(p, 0.0, -22.2, 9.0, 3.4)
}

/// Sinks the socket into `skin` and sets eyeball and lids into it.
fn eye(p: V, skin: f64) -> f64 {
    let socket = 1.15 * blob(p, 12.6, 6.0, 11.5, 7.6) + 0.5 * blob(p, 6.0, 6.5, 4.5, 6.0);
    let (d, above) = almond(p.minus(V { x: 13.0, y: 5.2 }).turned(-0.05));
    let skin = skin - socket;
    let lid = mix(0.45, 0.85, above) * bump((d - 1.0) / 2.2);
    let crease = 0.3 * above * bump((d - 3.6) / 1.8);
    let inside = step(0.35, -0.35, d);
    let ball = 0.25 + 0.75 * blob(p, 13.0, 5.2, 9.0, 6.5);
    let pupil = 0.6 * step(3.2, 1.4, p.minus(V { x: 12.8, y: 5.8 }).len());
    mix(skin + lid - crease, skin + ball - pupil, inside)
}

/// Distance from the outline of an eye, negative inside, and whether the upper lid is nearer (0…1).
fn almond(p: V) -> (f64, f64) {
    let lens = |half: f64, rise: f64, sign: f64| {
        let radius = (half * half + rise * rise) / (2.0 * rise);
        V { x: p.x, y: p.y + sign * (radius - rise) }.len() - radius
    };
    let (upper, lower) = (lens(7.6, 4.1, 1.0), lens(7.6, 2.7, -1.0));
    (upper.max(lower), step(-1.5, 1.5, upper - lower))
}

/// A smooth hill: 1 in the middle, 0 from distance 1 on, with continuous curvature.
fn bump(t: f64) -> f64 {
    let u = 1.0 - t * t;
    if u > 0.0 { u * u * u } else { 0.0 }
}

/// A hill over an ellipse about (`x`, `y`).
fn blob(p: V, x: f64, y: f64, half_x: f64, half_y: f64) -> f64 {
    let (dx, dy) = ((p.x - x) / half_x, (p.y - y) / half_y);
    bump((dx * dx + dy * dy).sqrt())
}

/// A hill along the line from `a` to `b`.
fn stroke(p: V, a: V, b: V, half_width: f64) -> f64 {
    let (along, to) = (b.minus(a), p.minus(a));
    let t = (to.x * along.x + to.y * along.y) / (along.x * along.x + along.y * along.y);
    let t = t.clamp(0.0, 1.0);
    bump(to.minus(V { x: along.x * t, y: along.y * t }).len() / half_width)
}

/// 0 at `from`, 1 at `to` and beyond, smooth between; `from` may be the greater.
fn step(from: f64, to: f64, value: f64) -> f64 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * t * (t * (6.0 * t - 15.0) + 10.0)
}

fn mix(a: f64, b: f64, share: f64) -> f64 {
    a + (b - a) * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_picture_is_what_this_computes() {
        let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/../graphs/samples/medallion.png");
        let shipped = image::open(shipped).unwrap().into_luma16();
        let computed = medallion(SIZE_PX);
        assert_eq!(shipped.dimensions(), computed.dimensions());
        // Last bits of sin and cos may differ between machines.
        let same = |(a, b): (&u16, &u16)| a.abs_diff(*b) <= 1;
        assert!(shipped.as_raw().iter().zip(computed.as_raw()).all(same));
    }

    #[test]
    fn the_relief_uses_the_whole_depth_and_is_not_clipped() {
        let levels = medallion(160).into_raw();
        let highest = levels.iter().max().copied().unwrap_or_default();
        assert!((63_000..65_535).contains(&highest), "{highest}");
        assert!(levels.iter().all(|level| *level > 0));
    }
}

//! A picture of the carved plaque, hung on a wall.
//!
//! The view is straight on, without perspective. Light comes from the upper left through a window:
//! three neighbouring directions, each with a soft edge, so cast shadows blur with distance. The
//! rest is skylight, as much as the horizon in eight directions lets in (ambient occlusion), and
//! a satin gleam. The material is walnut; the plaque has rounded edges and casts a shadow on the
//! wall.
//!
//! A relief of 5 mm on 200 mm is nearly flat, and its shading alone would hardly show. Heights are
//! therefore multiplied by [`exaggeration`] for shading only: outlines and proportions stay true.
//!
//! Time is linear in the nodes of the field and the pixels of the picture.
//!
//! Limits: light is not coloured by what it bounced off, and the wall gets one shadow of the whole
//! board, not of its relief.

use super::color::{Linear, encode, linear, mix, smooth_step};
use super::horizon::{LIGHT_WORK, skylight, sunlight};
use super::resample::{Axis, BANDS, Raster, bands, resample};
use super::wood::Wood;
use carvegraph_geometry::{HeightField, Tick};
use image::RgbImage;
use rayon::prelude::*;

/// Units of work of [`render_surface`], as told to its `tick`.
pub(super) const SURFACE_WORK: usize = 2 * BANDS + LIGHT_WORK;

/// The longest side a picture may have: 8192² pixels are 200 MB of picture and 1 GB of work.
pub(super) const MAX_SIDE_PX: u32 = 8192;

/// Wall around the plaque, as a share of the plaque's longest side.
const MARGIN: f32 = 0.075;
/// Width of the rounded edge, as a share of the plaque's longest side.
const EDGE: f32 = 0.012;
/// How far the edge falls, in widths of the edge: steep enough to shade, too flat to hide itself.
const EDGE_DROP: f32 = 0.9;
/// Radius of the plaque's corners, in widths of the edge.
const CORNER: usize = 2;

/// The relief's depth, as a share of the plaque's shorter side, that shades best: deeper and
/// shadows swallow the ground, shallower and it looks stamped.
const BEST_DEPTH: f32 = 0.062;
/// Beyond this factor the noise of a shallow relief would pass for its shape.
const MAX_EXAGGERATION: f32 = 6.0;

/// Towards the middle of the window: right, up the picture, out of the wall. A unit vector.
const TO_SUN: [f32; 3] = [-0.570, 0.570, 0.592];

/// Strength of the window, of the light the room throws back, and of the sky.
const SUN_LIGHT: f32 = 1.75;
const FILL_LIGHT: f32 = 0.16;
const SKY_LIGHT: f32 = 0.58;
/// A warm window and a cool room tell lit from shaded sides.
const SUN_COLOR: Linear = [1.04, 1.0, 0.93];
const SKY_COLOR: Linear = [0.97, 0.99, 1.06];
/// Towards the lower right, where the room throws light back from. A unit vector.
const TO_FILL: [f32; 3] = [0.6, -0.48, 0.64];
/// Halfway between the window and the eye: a normal this way shows the gleam. A unit vector.
const HALFWAY: [f32; 3] = [-0.319, 0.319, 0.892];
/// Satin, not gloss.
const GLEAM: f32 = 0.05;
const GLEAM_POWER: i32 = 22;
/// From this many pixels on, fibres and pores are drawn in full; below, they would flicker.
const FULL_GRAIN_PX: f32 = 900.0;

/// How far a shadow falls to the right and down, half the width of its soft edge, both as shares of
/// the plaque's longest side, and the share of light it takes.
struct Shadow {
    shift: f32,
    blur: f32,
    depth: f32,
}

const WIDE: Shadow = Shadow { shift: 0.022, blur: 0.05, depth: 0.42 };
const NARROW: Shadow = Shadow { shift: 0.008, blur: 0.014, depth: 0.5 };

/// Light plaster, as bytes of sRGB.
const PLASTER: [u8; 3] = [226, 222, 214];
/// Light at the upper left corner, and how much of it is lost at the lower right: it falls off away
/// from the window.
const LIGHT: f32 = 1.06;
const FALL_OFF: f32 = 0.22;

/// Draws `field` as a carved plaque; the longer side of the picture is `longest_side_px` (clamped
/// to 1 … 8192). Calls `tick` with [`SURFACE_WORK`] units in all; `None` if stopped.
#[must_use]
pub(super) fn render_surface(
    field: &HeightField,
    longest_side_px: u32,
    tick: Tick<'_>,
) -> Option<RgbImage> {
    let layout = Layout::new(field, longest_side_px);
    let scale = layout.px_per_mm * exaggeration(field);
    let mut relief = resample(field, layout.x, layout.y, scale, tick)?;
    lower_edges(&mut relief, layout.x.border_px);
    let sun = sunlight(&relief, tick)?;
    let sky = skylight(&relief, tick)?;
    let wall = Wall::new(&layout);
    let scene = Scene { layout, relief, sun, sky, wood: Wood::walnut(), wall };
    scene.draw(tick)
}

/// What heights are multiplied by for shading: as much as brings the relief's depth to 6.2 % of
/// the plaque's shorter side, between 1 and 6. A relief of 5 mm on 203 mm is shaded 2.5-fold.
#[must_use]
pub(super) fn exaggeration(field: &HeightField) -> f32 {
    let size = field.bounds().size();
    let depth = size.z as f32;
    let best = BEST_DEPTH * size.x.min(size.y) as f32;
    if depth > 0.0 { (best / depth).clamp(1.0, MAX_EXAGGERATION) } else { 1.0 }
}

/// Where things are in the picture.
struct Layout {
    /// Size of the picture, in pixels.
    width: usize,
    height: usize,
    /// Columns and rows of wall before the board.
    margin: (usize, usize),
    /// The board, its rounded edge being the border.
    x: Axis,
    y: Axis,
    px_per_mm: f32,
}

impl Layout {
    fn new(field: &HeightField, longest_side_px: u32) -> Self {
        let longest_px = longest_side_px.clamp(1, MAX_SIDE_PX) as usize;
        let size = field.bounds().size();
        let longest_mm = size.x.max(size.y);
        let board_px = longest_px as f32 / (1.0 + 2.0 * MARGIN);
        let edge_px = (board_px * EDGE).round() as usize;
        let margin_px = (board_px * MARGIN).floor() as usize;
        let span_px = longest_px - 2 * (margin_px + edge_px);
        let axis = |length_mm: f64| Axis {
            span_px: ((length_mm / longest_mm * span_px as f64).round() as usize).max(1),
            border_px: edge_px,
        };
        let (x, y) = (axis(size.x), axis(size.y));
        Self {
            width: x.len_px() + 2 * margin_px,
            height: y.len_px() + 2 * margin_px,
            margin: (margin_px, margin_px),
            x,
            y,
            px_per_mm: (span_px as f64 / longest_mm) as f32,
        }
    }
}

/// Rounds the plaque's edge over: heights fall towards the outline as a parabola.
fn lower_edges(relief: &mut Raster, edge_px: usize) {
    let (width, height) = (relief.width, relief.height);
    let corner_px = CORNER * edge_px;
    for (y, row) in relief.values.chunks_exact_mut(width).enumerate() {
        let near_end = y < corner_px || y + corner_px >= height || width <= 2 * corner_px;
        let (left, right) = if near_end { (width, width) } else { (corner_px, width - corner_px) };
        for x in (0..left).chain(right..width) {
            let inside = inset(x, y, width, height, corner_px);
            let out = (1.0 - inside / edge_px as f32).clamp(0.0, 1.0);
            row[x] -= EDGE_DROP * edge_px as f32 * out * out;
        }
    }
}

/// How far pixel (`x`, `y`) lies inside the outline of a board with rounded corners, in pixels.
fn inset(x: usize, y: usize, width: usize, height: usize, corner_px: usize) -> f32 {
    let corner = corner_px as f32;
    let to_side = |i: usize, len: usize| (i.min(len - 1 - i)) as f32 + 0.5;
    let (dx, dy) = (to_side(x, width), to_side(y, height));
    if dx < corner && dy < corner { corner - (corner - dx).hypot(corner - dy) } else { dx.min(dy) }
}

/// Everything that the colour of a pixel depends on.
struct Scene {
    layout: Layout,
    relief: Raster,
    sun: Vec<f32>,
    sky: Raster,
    wood: Wood,
    wall: Wall,
}

impl Scene {
    fn draw(&self, tick: Tick<'_>) -> Option<RgbImage> {
        let (width, height) = (self.layout.width, self.layout.height);
        let mut bytes = vec![0; width * height * 3];
        bands(&mut bytes, width * 3, height).into_par_iter().try_for_each(|(rows, band)| {
            for (y, row) in rows.zip(band.chunks_exact_mut(width * 3)) {
                for (x, pixel) in row.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                    *pixel = encode(self.color(x, y), x, y);
                }
            }
            tick(1).then_some(())
        })?;
        RgbImage::from_raw(width as u32, height as u32, bytes)
    }

    fn color(&self, x: usize, y: usize) -> Linear {
        let (left, top) = self.layout.margin;
        let (bx, by) = (x.wrapping_sub(left), y.wrapping_sub(top));
        if bx >= self.relief.width || by >= self.relief.height {
            return self.wall.color(x, y);
        }
        let corner_px = CORNER * self.layout.x.border_px;
        let inside = inset(bx, by, self.relief.width, self.relief.height, corner_px);
        let cover = (inside + 0.5).clamp(0.0, 1.0);
        if cover == 1.0 {
            self.board(bx, by)
        } else {
            mix(self.wall.color(x, y), self.board(bx, by), cover)
        }
    }

    /// Colour of the plaque at a pixel of the board.
    fn board(&self, x: usize, y: usize) -> Linear {
        let normal = self.relief.normal(x, y);
        let dot = |a: [f32; 3]| a[0] * normal[0] + a[1] * normal[1] + a[2] * normal[2];
        let seen = self.sun[y * self.relief.width + x];
        let sun = SUN_LIGHT * seen * dot(TO_SUN).max(0.0);
        let fill = FILL_LIGHT * dot(TO_FILL).max(0.0);
        let open = self.sky.between(x as f32 / 2.0 - 0.25, y as f32 / 2.0 - 0.25);
        let sky = SKY_LIGHT * open * open * (0.5 + 0.5 * normal[2]);
        let gleam = GLEAM * seen * dot(HALFWAY).max(0.0).powi(GLEAM_POWER);
        let wood = self.wood_at(x, y);
        [0, 1, 2].map(|k| {
            tone(
                wood[k] * (sun * SUN_COLOR[k] + (fill + sky) * SKY_COLOR[k]) + gleam * SUN_COLOR[k],
            )
        })
    }

    fn wood_at(&self, x: usize, y: usize) -> Linear {
        let (width, height) = (self.relief.width as f32, self.relief.height as f32);
        let longest = width.max(height);
        let across = (x as f32 - width / 2.0) / longest;
        let along = (y as f32 - height / 2.0) / longest;
        let z = self.relief.at(x, y) / longest;
        let fine = (longest / FULL_GRAIN_PX).min(1.0);
        if width > height {
            self.wood.color(across, along, z, fine)
        } else {
            self.wood.color(along, across, z, fine)
        }
    }
}

/// Rolls the brightest lights off so that they keep their colour: identity up to 1/2, 1 at most.
fn tone(light: f32) -> f32 {
    if light <= 0.5 { light } else { 1.0 - 0.25 / light }
}

/// The wall behind the plaque, with the plaque's shadow on it. The shadow of a rectangle under a soft
/// light is the product of what is hidden along x and along y; a wide and a narrow one together look
/// like a board that touches the wall.
struct Wall {
    /// Light lost to each shadow along x and along y; the product of both is what is lost.
    shadows: [(Vec<f32>, Vec<f32>); 2],
    color: Linear,
}

impl Wall {
    /// The wall of a picture.
    fn new(layout: &Layout) -> Self {
        let longest = layout.x.len_px().max(layout.y.len_px()) as f32;
        let shadows = [WIDE, NARROW].map(|shadow| {
            let side = |len, margin, board| hidden(&shadow, longest, len, margin, board);
            let mut across = side(layout.width, layout.margin.0, layout.x.len_px());
            across.iter_mut().for_each(|hidden| *hidden *= shadow.depth);
            (across, side(layout.height, layout.margin.1, layout.y.len_px()))
        });
        Self { shadows, color: linear(PLASTER) }
    }

    /// Colour of the wall at a pixel of the picture.
    fn color(&self, x: usize, y: usize) -> Linear {
        let [wide, narrow] = &self.shadows;
        let (width, height) = (wide.0.len() as f32, wide.1.len() as f32);
        let away = (x as f32 / width + y as f32 / height) / 2.0;
        let lit = (1.0 - wide.0[x] * wide.1[y]) * (1.0 - narrow.0[x] * narrow.1[y]);
        self.color.map(|c| c * (LIGHT - FALL_OFF * away) * lit)
    }
}

/// How much a board of `board` pixels that begins at `margin` hides from each of `len` pixels.
fn hidden(shadow: &Shadow, longest: f32, len: usize, margin: usize, board: usize) -> Vec<f32> {
    let half = shadow.blur * longest;
    let step = |place: f32| smooth_step(-half, half, place);
    (0..len)
        .map(|i| i as f32 + 0.5 - margin as f32 - shadow.shift * longest)
        .map(|place| step(place) * (1.0 - step(place - board as f32)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    const GO: Tick<'_> = &|_| true;

    fn field(columns: usize, rows: usize, height: impl Fn(f32, f32) -> f32) -> HeightField {
        let heights =
            (0..columns * rows).map(|k| height((k % columns) as f32, (k / columns) as f32));
        HeightField::new(columns, rows, 0.5, heights.collect()).unwrap()
    }

    /// Mean brightness of the middle half of a picture.
    fn brightness(picture: &RgbImage) -> f64 {
        let (width, height) = picture.dimensions();
        let part = image::imageops::crop_imm(picture, width / 4, height / 4, width / 2, height / 2);
        let sum: f64 = part.to_image().as_raw().iter().map(|level| f64::from(*level)).sum();
        sum / f64::from(3 * (width / 2) * (height / 2))
    }

    #[test]
    fn a_constant_field_is_flat_fully_lit_and_not_exaggerated() {
        let flat = field(20, 30, |_, _| 3.0);
        assert_eq!(exaggeration(&flat), 1.0);
        let axis = |span_px| Axis { span_px, border_px: 0 };
        let relief = resample(&flat, axis(50), axis(80), 1.0, GO).unwrap();
        assert!(relief.values.iter().all(|z| z.abs() < 1e-5));
        assert!(sunlight(&relief, GO).unwrap().iter().all(|light| (light - 1.0).abs() < 1e-5));
        assert!(
            skylight(&relief, GO).unwrap().values.iter().all(|light| (light - 1.0).abs() < 1e-3)
        );
        assert!((100.0..200.0).contains(&brightness(&render_surface(&flat, 200, GO).unwrap())));
    }

    #[test]
    fn a_slope_that_faces_the_upper_left_is_brighter() {
        let slope = |sign: f32| field(60, 60, move |x, y| sign * 0.1 * (x - y));
        let level = brightness(&render_surface(&field(60, 60, |_, _| 0.0), 300, GO).unwrap());
        // Falling to the left and up the picture is facing there.
        let facing = brightness(&render_surface(&slope(1.0), 300, GO).unwrap());
        let away = brightness(&render_surface(&slope(-1.0), 300, GO).unwrap());
        assert!(facing > level + 5.0 && level > away + 5.0, "{facing} {level} {away}");
    }

    #[test]
    fn a_wall_casts_its_shadow_to_the_lower_right() {
        let axis = Axis { span_px: 100, border_px: 0 };
        let wall = field(101, 101, |x, _| if (48.0..52.0).contains(&x) { 10.0 } else { 0.0 });
        let relief = resample(&wall, axis, axis, 2.0, GO).unwrap();
        let sun = sunlight(&relief, GO).unwrap();
        assert!(sun[50 * 100 + 30] > 0.99 && sun[50 * 100 + 57] < 0.01);
    }

    #[test]
    fn the_longer_side_is_as_asked_whatever_the_shape() {
        for (columns, rows) in [(2, 5000), (5000, 2), (2, 2), (48, 32)] {
            let field = field(columns, rows, |x, y| (x * y).sin());
            for side in [1, 2, 9, 64, 333] {
                let (width, height) = render_surface(&field, side, GO).unwrap().dimensions();
                assert_eq!(width.max(height), side, "{columns} {rows} {side}");
            }
        }
    }

    #[test]
    fn the_picture_is_bounded_and_never_empty() {
        let thin = field(2, 5000, |_, _| 0.0);
        for (side, longest) in [(0, 1), (u32::MAX, 8192)] {
            let layout = Layout::new(&thin, side);
            assert_eq!(layout.width.max(layout.height), longest);
            assert!(layout.width > 0 && layout.height > 0);
        }
    }

    #[test]
    fn five_mm_on_203_mm_are_shaded_two_and_a_half_fold() {
        let plaque = field(407, 407, |x, _| 5.0 * x / 406.0);
        assert!((exaggeration(&plaque) - 2.517).abs() < 1e-3);
    }

    #[test]
    fn the_picture_does_not_depend_on_threads_and_all_work_is_told() {
        let field = field(90, 70, |x, y| (x * 0.3).sin() + (y * 0.2).cos());
        let [one, two] = [1, 2].map(|threads| {
            let told = AtomicUsize::new(0);
            let tick = |work| {
                told.fetch_add(work, Ordering::Relaxed);
                true
            };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let picture = pool.install(|| render_surface(&field, 400, &tick));
            assert_eq!(told.into_inner(), SURFACE_WORK);
            picture.unwrap()
        });
        assert!(one == two);
        assert!(render_surface(&field, 400, &|_| false).is_none());
    }
}

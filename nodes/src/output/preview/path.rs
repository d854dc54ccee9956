//! A plan view of a tool path.
//!
//! Passes and links are coloured by the height of the tip: from blue (low) over green to pale yellow
//! (high), in even steps of perceived lightness and hue. Rapids are dashed red lines, plunges orange
//! dots, the start a green disk and the end a white ring. Points stand out as dots where they are
//! sparse, as after a reduction. If the surface is given, it is shown dimmed below, and its shading
//! tints the passes.
//!
//! Lines are as wide as their mean spacing allows, and where they lie closer than a few pixels every
//! n-th is drawn stronger, so that even hundreds of passes read as lines and not as a solid patch.
//! Of many rapids every n-th is drawn clear and the others faint, lest they hide what they cross.
//!
//! Limits: the view is straight down; moves along z only show as plunges. Points less than half a
//! pixel from the last one drawn are joined with the next.

use super::color::{Linear, encode, linear, mix, oklch};
use super::legend;
use super::marks::Drawing;
use super::render::{MAX_SIDE_PX, exaggeration};
use super::resample::{Axis, BANDS, Raster, bands, resample};
use super::strokes::{Band, Place, by_band};
use carvegraph_geometry::{DVec3, HeightField, Tick, Toolpath};
use image::RgbImage;
use rayon::prelude::*;

/// Units of work of [`render_path`], as told to its `tick`.
pub(super) const PATH_WORK: usize = 2 * BANDS;

/// Room and marks are measured in units of 1/1200 of the picture's longest side.
pub(super) const UNITS: f32 = 1200.0;
/// Room around the path.
pub(super) const MARGIN_UNITS: f32 = 28.0;
/// Below this many pixels there is no room for a legend.
const MIN_LEGEND_PX: u32 = 480;

/// sRGB colours of the ground and of the surface below the path.
const GROUND: [u8; 3] = [27, 31, 36];
const SURFACE: [u8; 3] = [62, 69, 77];

/// Draws `path` from above, over `field` if there is one; the longer side of the picture is
/// `longest_side_px` (clamped to 1 … 8192). Calls `tick` with [`PATH_WORK`] units in all; `None` if
/// stopped.
#[must_use]
pub(super) fn render_path(
    field: Option<&HeightField>,
    path: &Toolpath,
    longest_side_px: u32,
    tick: Tick<'_>,
) -> Option<RgbImage> {
    let view = View::new(field, path, longest_side_px);
    let ground = match field {
        Some(field) => Some(Ground::new(field, &view, tick)?),
        None => tick(BANDS).then_some(None)?,
    };
    let drawing = Drawing::new(path, &view);
    draw(&drawing, ground.as_ref(), &view, tick)
}

/// How mm become pixels.
pub(super) struct View {
    /// Size of the picture, in pixels.
    pub(super) width: usize,
    pub(super) height: usize,
    /// Where x = 0, y = 0 is in the picture.
    origin: Place,
    px_per_mm: f64,
    /// Length of a unit, in pixels.
    pub(super) unit: f32,
    /// Top of the legend, if there is room for one.
    pub(super) legend_top: Option<f32>,
}

impl View {
    fn new(field: Option<&HeightField>, path: &Toolpath, longest_side_px: u32) -> Self {
        let longest_px = longest_side_px.clamp(1, MAX_SIDE_PX);
        let longest = f64::from(longest_px);
        let unit = longest as f32 / UNITS;
        let legend = longest_px >= MIN_LEGEND_PX;
        let margin = f64::from(MARGIN_UNITS * unit);
        let foot = if legend { f64::from(legend::HEIGHT_UNITS * unit) } else { 0.0 };
        let (min, max) = extent(field, path);
        let size = max - min;
        let fit = ((longest - 2.0 * margin) / size.x).min((longest - 2.0 * margin - foot) / size.y);
        let px_per_mm = if fit.is_normal() { fit } else { 1.0 };
        let (across, along) = (size.x * px_per_mm, size.y * px_per_mm);
        // The legend is 640 units wide at least.
        let least = if legend { f64::from(640.0 * unit) } else { 1.0 };
        let width = (across + 2.0 * margin).round().clamp(least.min(longest), longest);
        let height = (along + 2.0 * margin + foot).round().clamp(1.0, longest);
        let left = (width - across) / 2.0 - min.x * px_per_mm;
        let bottom = margin + along + min.y * px_per_mm;
        Self {
            width: width as usize,
            height: height as usize,
            origin: [left as f32, bottom as f32],
            px_per_mm,
            unit,
            legend_top: legend.then_some((margin * 1.5 + along) as f32),
        }
    }

    /// Where a tip is in the picture.
    pub(super) fn place(&self, tip: DVec3) -> Place {
        let [x, y] = self.origin;
        [x + (tip.x * self.px_per_mm) as f32, y - (tip.y * self.px_per_mm) as f32]
    }
}

/// The corners of the box around the field and all finite points of the path.
fn extent(field: Option<&HeightField>, path: &Toolpath) -> (DVec3, DVec3) {
    let of_field = field.map(|field| field.bounds()).map(|b| [b.min, b.max]);
    let points = path.tips.iter().copied().filter(|tip| tip.is_finite());
    points
        .chain(of_field.into_iter().flatten())
        .fold(None, |extent: Option<(DVec3, DVec3)>, p| {
            Some(extent.map_or((p, p), |(min, max)| (min.min(p), max.max(p))))
        })
        .unwrap_or_default()
}

/// The surface below the path.
struct Ground {
    relief: Raster,
    left: usize,
    top: usize,
}

impl Ground {
    fn new(field: &HeightField, view: &View, tick: Tick<'_>) -> Option<Self> {
        let bounds = field.bounds();
        let corner = view.place(DVec3::new(bounds.min.x, bounds.max.y, 0.0));
        let axis = |length_mm: f64| Axis {
            span_px: ((length_mm * view.px_per_mm).round() as usize).clamp(1, MAX_SIDE_PX as usize),
            border_px: 0,
        };
        let (x, y) = (axis(bounds.size().x), axis(bounds.size().y));
        let scale = view.px_per_mm as f32 * exaggeration(field);
        let relief = resample(field, x, y, scale, tick)?;
        Some(Self { relief, left: corner[0].round() as usize, top: corner[1].round() as usize })
    }

    /// Brightness of the surface at a pixel of the picture, 1 where level; `None` beside it.
    fn shade(&self, x: usize, y: usize) -> Option<f32> {
        let (x, y) = (x.wrapping_sub(self.left), y.wrapping_sub(self.top));
        (x < self.relief.width && y < self.relief.height).then(|| {
            let [right, up, out] = self.relief.normal(x, y);
            (out + 0.7 * (up - right)).max(0.0)
        })
    }
}

/// Colours of tones 0 … 1: from blue over green to pale yellow.
fn ramp() -> [Linear; 256] {
    std::array::from_fn(|i| {
        let t = i as f32 / 255.0;
        oklch(0.52 + 0.42 * t, 0.108 + 0.02 * t, 0.75 - 0.465 * t)
    })
}

fn draw(
    drawing: &Drawing,
    ground: Option<&Ground>,
    view: &View,
    tick: Tick<'_>,
) -> Option<RgbImage> {
    let (width, height) = (view.width, view.height);
    let (threads, inks) = (by_band(&drawing.threads, height), by_band(&drawing.inks, height));
    let ramp = ramp();
    let mut bytes = vec![0; width * height * 3];
    let parts = bands(&mut bytes, width * 3, height).into_par_iter().zip(threads).zip(inks);
    parts.try_for_each(|(((rows, bytes), threads), inks)| {
        let band = Band { width, rows };
        let mut sums = vec![[0.0; 2]; width * band.rows.len()];
        for index in threads {
            band.add_thread(&drawing.threads[index as usize], &mut sums);
        }
        let mut colors = blend(&band, &sums, ground, &ramp);
        for index in inks {
            band.lay_ink(&drawing.inks[index as usize], &mut colors);
        }
        for (pixel, (bytes, color)) in
            bytes.as_chunks_mut::<3>().0.iter_mut().zip(colors).enumerate()
        {
            *bytes = encode(color, pixel % width, band.rows.start + pixel / width);
        }
        tick(1).then_some(())
    })?;
    RgbImage::from_raw(width as u32, height as u32, bytes)
}

/// Colours of a band: threads over the ground.
fn blend(
    band: &Band,
    sums: &[[f32; 2]],
    ground: Option<&Ground>,
    ramp: &[Linear; 256],
) -> Vec<Linear> {
    let (bare, surface) = (linear(GROUND), linear(SURFACE));
    let color = |(pixel, [cover, toned]): (usize, &[f32; 2])| {
        let (x, y) = (pixel % band.width, band.rows.start + pixel / band.width);
        let shade = ground.and_then(|ground| ground.shade(x, y));
        let below = shade.map_or(bare, |shade| surface.map(|c| c * (0.25 + 0.75 * shade)));
        if *cover <= 0.0 {
            return below;
        }
        let tone = ramp[(toned / cover * 255.0 + 0.5).clamp(0.0, 255.0) as usize];
        let tint = 0.45 + 0.55 * shade.unwrap_or(1.0);
        mix(below, tone.map(|c| c * tint), cover.min(1.0))
    };
    sums.iter().enumerate().map(color).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_geometry::{Contact, Span, SpanKind};
    use std::sync::atomic::{AtomicUsize, Ordering};

    const GO: Tick<'_> = &|_| true;

    /// A path whose spans are all joined.
    fn path(spans: &[(SpanKind, &[[f64; 3]])]) -> Toolpath {
        let mut path = Toolpath::default();
        for (kind, tips) in spans {
            let start = path.tips.len();
            path.tips.extend(tips.iter().copied().map(DVec3::from));
            path.contacts.resize(path.tips.len(), Contact::NONE);
            path.spans.push(Span {
                points: start..path.tips.len(),
                kind: *kind,
                joined: start > 0,
            });
        }
        path
    }

    fn zigzag(passes: usize) -> Toolpath {
        let rows: Vec<[[f64; 3]; 2]> = (0..passes)
            .map(|j| {
                let (y, z) = (j as f64, j as f64 / 10.0);
                let (a, b) = ([0.0, y, z], [50.0, y, z]);
                if j % 2 == 0 { [a, b] } else { [b, a] }
            })
            .collect();
        let spans: Vec<(SpanKind, &[[f64; 3]])> =
            rows.iter().map(|row| (SpanKind::Pass, &row[..])).collect();
        path(&spans)
    }

    fn count(picture: &RgbImage, like: impl Fn([u8; 3]) -> bool) -> usize {
        picture.pixels().filter(|pixel| like(pixel.0)).count()
    }

    #[test]
    fn an_empty_path_is_bare_ground() {
        let picture = render_path(None, &path(&[]), 300, GO).unwrap();
        assert_eq!(count(&picture, |[r, g, b]| r > 60 || g > 60 || b > 60), 0);
    }

    #[test]
    fn a_point_and_a_path_with_nan_are_drawn_without_harm() {
        for tips in
            [&[[5.0, 5.0, 1.0]][..], &[[0.0, 0.0, 0.0], [f64::NAN, 1.0, 0.0], [9.0, 1.0, 0.0]]]
        {
            assert!(render_path(None, &path(&[(SpanKind::Pass, tips)]), 500, GO).is_some());
        }
    }

    #[test]
    fn the_longer_side_is_as_asked() {
        let tall = path(&[(SpanKind::Pass, &[[0.0, 0.0, 0.0], [1.0, 5000.0, 1.0]])]);
        for side in [1, 7, 100, 480, 900] {
            for path in [&tall, &zigzag(20)] {
                let picture = render_path(None, path, side, GO).unwrap();
                assert_eq!(picture.width().max(picture.height()), side);
            }
        }
    }

    #[test]
    fn rapids_are_red_and_plunges_orange() {
        let red = |[r, g, b]: [u8; 3]| r > 200 && g < 110 && b < 110;
        let orange = |[r, g, b]: [u8; 3]| r > 200 && (130..190).contains(&g) && b < 90;
        let cut: &[[f64; 3]] = &[[0.0, 0.0, 0.0], [50.0, 40.0, 2.0]];
        let plain = render_path(None, &path(&[(SpanKind::Pass, cut)]), 400, GO).unwrap();
        assert_eq!((count(&plain, red), count(&plain, orange)), (0, 0));
        let travel = path(&[
            (SpanKind::Pass, cut),
            (SpanKind::Rapid, &[[50.0, 40.0, 9.0], [0.0, 40.0, 9.0]]),
            (SpanKind::Plunge, &[[0.0, 40.0, 0.0]]),
            (SpanKind::Pass, &[[50.0, 0.0, 1.0]]),
        ]);
        let picture = render_path(None, &travel, 400, GO).unwrap();
        assert!(count(&picture, red) > 20, "{}", count(&picture, red));
        assert!(count(&picture, orange) > 1, "{}", count(&picture, orange));
    }

    #[test]
    fn higher_passes_are_lighter() {
        let picture = render_path(None, &zigzag(40), 400, GO).unwrap();
        let light = |y: u32| {
            let pixel = picture.get_pixel(picture.width() / 2, y).0;
            pixel.map(u32::from).iter().sum::<u32>()
        };
        let mean =
            |rows: std::ops::Range<u32>| rows.clone().map(light).sum::<u32>() / rows.len() as u32;
        let height = picture.height();
        assert!(mean(20..60) > mean(height - 60..height - 20) + 60);
    }

    #[test]
    fn the_picture_does_not_depend_on_threads_and_all_work_is_told() {
        let field =
            HeightField::new(30, 30, 2.0, (0..900).map(|i| (i % 7) as f32).collect()).unwrap();
        let [one, two] = [1, 2].map(|threads| {
            let told = AtomicUsize::new(0);
            let tick = |work| {
                told.fetch_add(work, Ordering::Relaxed);
                true
            };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let picture = pool.install(|| render_path(Some(&field), &zigzag(60), 600, &tick));
            assert_eq!(told.into_inner(), PATH_WORK);
            picture.unwrap()
        });
        assert!(one == two);
        assert!(render_path(Some(&field), &zigzag(60), 600, &|_| false).is_none());
    }
}

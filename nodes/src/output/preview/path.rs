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
use super::legend::{self, Entry};
use super::render::{MAX_SIDE_PX, exaggeration};
use super::resample::{Axis, BANDS, Raster, bands, resample};
use super::strokes::{Band, Ink, Place, Thread, by_band};
use carvegraph_geometry::{DVec3, HeightField, Span, SpanKind, Tick, Toolpath};
use image::RgbImage;
use rayon::prelude::*;

/// Units of work of [`render_path`], as told to its `tick`.
pub const PATH_WORK: usize = 2 * BANDS;

/// Room around the path, and marks, are measured in units of 1/1200 of the longest side.
const UNITS: f32 = 1200.0;
const MARGIN_UNITS: f32 = 28.0;
/// Below this many pixels there is no room for a legend.
const MIN_LEGEND_PX: u32 = 480;

/// Width of a line, as a share of the mean spacing, and its limits in pixels.
const LINE_SHARE: f32 = 0.7;
const LINE_PX: (f32, f32) = (0.6, 2.2);
/// Lines closer than this, in pixels, are drawn in groups: one strong, the others weak.
const GROUP_PX: f32 = 4.0;
const WEAK: f32 = 0.72;
/// Points whose next point is farther than this, in pixels, are drawn as dots.
const SPARSE_PX: f32 = 7.0;
/// Points closer than this, in pixels, are joined.
const JOIN_PX: f32 = 0.5;
/// Rapids closer than this, in units, are drawn in groups too: one clear, the others faint.
const RAPID_GROUP_UNITS: f32 = 26.0;
const FAINT: f32 = 0.1;
/// Dashes of a rapid and the gaps between, in units.
const DASH_UNITS: (f32, f32) = (9.0, 6.0);

/// sRGB colours: the ground, the surface below the path, and the marks.
const GROUND: [u8; 3] = [27, 31, 36];
const SURFACE: [u8; 3] = [62, 69, 77];
const TEXT: [u8; 3] = [205, 211, 217];
const DOT: [u8; 3] = [250, 250, 245];
const RAPID: [u8; 3] = [255, 82, 82];
const PLUNGE: [u8; 3] = [255, 159, 28];
const START: [u8; 3] = [64, 220, 110];
const END: [u8; 3] = [255, 255, 255];
const OUTLINE: [u8; 3] = [12, 14, 16];

/// Draws `path` from above, over `field` if there is one; the longer side of the picture is
/// `longest_side_px` (clamped to 1 … 8192). Calls `tick` with [`PATH_WORK`] units in all; `None` if
/// stopped.
#[must_use]
pub fn render_path(
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
struct View {
    width: usize,
    height: usize,
    /// Where x = 0, y = 0 is in the picture.
    origin: Place,
    px_per_mm: f64,
    /// Length of a unit, in pixels.
    unit: f32,
    /// Top of the legend, if there is room for one.
    legend_top: Option<f32>,
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

    fn place(&self, tip: DVec3) -> Place {
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

/// All strokes of a picture.
struct Drawing {
    threads: Vec<Thread>,
    inks: Vec<Ink>,
}

impl Drawing {
    fn new(path: &Toolpath, view: &View) -> Self {
        let style = Style::new(path, view);
        let mut pass = 0;
        let strengths: Vec<f32> = path
            .spans
            .iter()
            .map(|span| {
                pass += usize::from(span.kind == SpanKind::Pass);
                if pass % style.group == 0 { 1.0 } else { WEAK }
            })
            .collect();
        let mut threads: Vec<Thread> = path
            .spans
            .par_iter()
            .zip(strengths)
            .filter(|(span, _)| is_cut(span))
            .flat_map_iter(|(span, strength)| style.threads(path, span, view, strength))
            .collect();
        let mut inks: Vec<Ink> = path
            .spans
            .par_iter()
            .filter(|span| span.kind == SpanKind::Pass)
            .flat_map_iter(|span| style.dots(path, span, view))
            .collect();
        style.mark_travel(path, view, &mut inks);
        mark_ends(path, view, &mut inks);
        if let Some(top) = view.legend_top {
            let margin = MARGIN_UNITS * view.unit;
            let place = (margin, view.width as f32 - margin, top);
            let (bar, text) = legend::draw(place, view.unit, style.heights_mm, &KEY, linear(TEXT));
            threads.extend(bar);
            inks.extend(text);
        }
        Self { threads, inks }
    }
}

fn is_cut(span: &Span) -> bool {
    matches!(span.kind, SpanKind::Pass | SpanKind::Link)
}

/// The points of a span in the picture, with their heights in mm, from the point it is reached from.
fn places<'a>(
    path: &'a Toolpath,
    span: &Span,
    view: &'a View,
) -> impl Iterator<Item = (Place, f64)> + 'a {
    let first = span.points.start - usize::from(span.joined && span.points.start > 0);
    let tips = path.tips[first..span.points.end].iter().filter(|tip| tip.is_finite());
    tips.map(|tip| (view.place(*tip), tip.z))
}

fn distance(a: Place, b: Place) -> f32 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// How the lines of a path are drawn, from how dense it is.
struct Style {
    half_width: f32,
    /// Every how manieth pass is drawn strong.
    group: usize,
    /// The lowest and the highest tip of passes and links, if there are any.
    heights_mm: Option<(f64, f64)>,
    /// Every how manieth rapid is drawn clear.
    rapid_group: usize,
    dot_opacity: f32,
    plunge_px: f32,
}

impl Style {
    fn new(path: &Toolpath, view: &View) -> Self {
        let spacing = spacing_px(path, view, is_cut);
        let width = (LINE_SHARE * spacing).clamp(LINE_PX.0, LINE_PX.1);
        let heights = path
            .spans
            .iter()
            .filter(|span| is_cut(span))
            .flat_map(|span| &path.tips[span.points.clone()])
            .filter(|tip| tip.is_finite())
            .map(|tip| (tip.z, tip.z))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let rapid_spacing = spacing_px(path, view, |span| span.kind == SpanKind::Rapid);
        Self {
            half_width: width / 2.0,
            group: (GROUP_PX / spacing).ceil().clamp(1.0, 16.0) as usize,
            heights_mm: heights,
            rapid_group: (RAPID_GROUP_UNITS * view.unit / rapid_spacing).ceil().max(1.0) as usize,
            dot_opacity: (spacing / 8.0).clamp(0.4, 0.85),
            plunge_px: (3.4 * view.unit).min(0.5 * spacing.max(2.0)).max(0.9),
        }
    }

    fn threads(&self, path: &Toolpath, span: &Span, view: &View, strength: f32) -> Vec<Thread> {
        let (low, high) = self.heights_mm.unwrap_or_default();
        let tone = |z: f64| if high > low { ((z - low) / (high - low)) as f32 } else { 0.5 };
        let mut threads = Vec::new();
        let mut points = places(path, span, view).peekable();
        let Some((mut from, mut from_z)) = points.next() else { return threads };
        while let Some((to, z)) = points.next() {
            if distance(from, to) >= JOIN_PX || points.peek().is_none() {
                threads.push(Thread {
                    ends: [from, to],
                    half_width: self.half_width,
                    tone: tone((from_z + z) / 2.0),
                    strength,
                });
                (from, from_z) = (to, z);
            }
        }
        threads
    }

    /// Dots where the points of a pass are far from one another.
    fn dots(&self, path: &Toolpath, span: &Span, view: &View) -> Vec<Ink> {
        let tips = &path.tips[span.points.clone()];
        let far = |pair: &[DVec3]| distance(view.place(pair[0]), view.place(pair[1])) >= SPARSE_PX;
        let half_width = (1.15 * self.half_width).max(0.5);
        let mut before = false;
        let mut dots = Vec::new();
        for (i, tip) in tips.iter().enumerate() {
            let after = tips.get(i..i + 2).is_some_and(far);
            if (before || after) && tip.is_finite() {
                let place = view.place(*tip);
                dots.push(ink([place; 2], half_width, DOT, self.dot_opacity));
            }
            before = after;
        }
        dots
    }

    /// Dashes of the rapids and dots of the plunges.
    fn mark_travel(&self, path: &Toolpath, view: &View, inks: &mut Vec<Ink>) {
        let mut rapids = 0;
        for span in &path.spans {
            let line = places(path, span, view).map(|(place, _)| place);
            match span.kind {
                SpanKind::Rapid => {
                    let line: Vec<Place> = line.collect();
                    // A rapid straight up or down does not show.
                    if line.windows(2).any(|pair| distance(pair[0], pair[1]) >= JOIN_PX) {
                        let opacity = if rapids % self.rapid_group == 0 { 0.95 } else { FAINT };
                        // A phase that never repeats keeps dashes from lining up in columns.
                        let phase = (rapids as f32 * 0.618_034).fract();
                        dash(&line, phase, view.unit, opacity, inks);
                        rapids += 1;
                    }
                }
                SpanKind::Plunge => {
                    if let Some(place) = line.last() {
                        inks.push(ink([place; 2], self.plunge_px, PLUNGE, 0.9));
                    }
                }
                SpanKind::Pass | SpanKind::Link => {}
            }
        }
    }
}

fn ink(ends: [Place; 2], half_width: f32, srgb: [u8; 3], opacity: f32) -> Ink {
    Ink { ends, half_width, color: linear(srgb), opacity }
}

/// Mean distance in pixels between the lines of the wanted spans, were they spread evenly over the
/// picture's box around the path; far apart if there are none.
fn spacing_px(path: &Toolpath, view: &View, wanted: impl Fn(&Span) -> bool) -> f32 {
    let margin = 2.0 * MARGIN_UNITS * view.unit;
    let area = (view.width as f32 - margin) * (view.height as f32 - margin);
    let length: f32 = path
        .spans
        .iter()
        .filter(|span| wanted(span))
        .map(|span| {
            let mut places = places(path, span, view).map(|(place, _)| place);
            let first = places.next().unwrap_or_default();
            places.fold((0.0, first), |(sum, from), to| (sum + distance(from, to), to)).0
        })
        .sum();
    if length > 0.0 && area > 0.0 { area / length } else { UNITS * view.unit }
}

/// Cuts a line into dashes; `phase` says how much of the first dash and gap is left out, 0 to 1.
fn dash(line: &[Place], phase: f32, unit: f32, opacity: f32, inks: &mut Vec<Ink>) {
    let (on, period) = (DASH_UNITS.0 * unit, (DASH_UNITS.0 + DASH_UNITS.1) * unit);
    let mut gone = phase * period;
    for pair in line.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let length = distance(a, b);
        if length == 0.0 {
            continue;
        }
        let at = |s: f32| [a[0] + (b[0] - a[0]) * s / length, a[1] + (b[1] - a[1]) * s / length];
        let mut start = -(gone % period);
        while start < length {
            let ends = [at(start.max(0.0)), at((start + on).clamp(0.0, length))];
            if start + on > 0.0 {
                inks.push(ink(ends, (0.8 * unit).max(0.4), RAPID, opacity));
            }
            start += period;
        }
        gone += length;
    }
}

/// Marks where the path begins and where it ends.
fn mark_ends(path: &Toolpath, view: &View, inks: &mut Vec<Ink>) {
    let mut finite = path.tips.iter().filter(|tip| tip.is_finite());
    let Some(first) = finite.next() else { return };
    let last = finite.next_back().unwrap_or(first);
    mark_end(view.place(*last), view.unit, inks);
    mark_start(view.place(*first), view.unit, inks);
}

fn mark_start(place: Place, unit: f32, inks: &mut Vec<Ink>) {
    inks.push(ink([place; 2], 8.5 * unit, OUTLINE, 1.0));
    inks.push(ink([place; 2], 6.5 * unit, START, 1.0));
}

fn mark_end(place: Place, unit: f32, inks: &mut Vec<Ink>) {
    inks.push(ink([place; 2], 8.5 * unit, OUTLINE, 1.0));
    inks.push(ink([place; 2], 6.5 * unit, END, 1.0));
    inks.push(ink([place; 2], 3.0 * unit, OUTLINE, 1.0));
}

/// What the legend explains.
const KEY: [Entry; 4] = [
    Entry {
        name: "rapid",
        draw: |[x, y], unit, inks| {
            let line = [[x - 20.0 * unit, y], [x + 14.0 * unit, y]];
            dash(&line, 0.0, unit, 1.0, inks);
        },
    },
    Entry {
        name: "plunge",
        draw: |place, unit, inks| inks.push(ink([place; 2], 3.4 * unit, PLUNGE, 1.0)),
    },
    Entry { name: "start", draw: mark_start },
    Entry { name: "end", draw: mark_end },
];

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
    use carvegraph_geometry::Contact;
    use std::sync::atomic::{AtomicUsize, Ordering};

    const GO: Tick<'_> = &|_| true;

    /// A path whose spans are all joined.
    fn path(spans: &[(SpanKind, &[[f64; 3]])]) -> Toolpath {
        let mut path = Toolpath { tips: vec![], contacts: vec![], spans: vec![], feeds: None };
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

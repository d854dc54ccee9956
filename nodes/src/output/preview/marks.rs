//! The strokes of a tool path: threads for what is cut, inks for marks and travel.
//!
//! How strong a stroke is follows from how close the path's lines lie: see [`Style`].

use super::color::linear;
use super::legend::{self, Entry};
use super::path::{MARGIN_UNITS, UNITS, View};
use super::strokes::{Ink, Place, Thread};
use carvegraph_geometry::{DVec3, Span, SpanKind, Toolpath};
use rayon::prelude::*;

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
/// sRGB colours of the marks and of the legend's text.
const TEXT: [u8; 3] = [205, 211, 217];
const DOT: [u8; 3] = [250, 250, 245];
const RAPID: [u8; 3] = [255, 82, 82];
const PLUNGE: [u8; 3] = [255, 159, 28];
const START: [u8; 3] = [64, 220, 110];
const END: [u8; 3] = [255, 255, 255];
const OUTLINE: [u8; 3] = [12, 14, 16];

/// All strokes of a picture.
pub(super) struct Drawing {
    /// What is cut.
    pub(super) threads: Vec<Thread>,
    /// Marks, travel and the legend's text, from the lowest up.
    pub(super) inks: Vec<Ink>,
}

impl Drawing {
    /// The strokes of `path`, and of its legend if the view has room for one.
    pub(super) fn new(path: &Toolpath, view: &View) -> Self {
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

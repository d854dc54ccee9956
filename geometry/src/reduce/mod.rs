//! Takes points out of a path that the machine can do without.
//!
//! * [`reduce_z_band`]: the rule of Sood (thesis 2015, section 4.4): points as high as the last one
//!   kept, within a band, are skipped.
//! * [`reduce_chord`]: as few points as are found such that the path stays within a tolerance of every
//!   point left out.
//! * [`fit_arcs`]: the same with arcs beside the lines, within a tolerance of the whole path.
//!
//! All work on each pass or link by itself and keep its first and last point; rapids, plunges and spans
//! that have arcs already stay as they are. What was lost is measured on the result, not taken from the
//! tolerance. Spans are independent, so the result is the same whatever the number of threads.

mod arc_fit;
mod arcs;
mod chord;
mod fewest;
mod sheet;
#[cfg(test)]
mod tests_of_arcs;
mod z_band;

use crate::{PathArc, Span, SpanKind, Tick, Toolpath};
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What a reduction did. Points on passes and links count.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reduction {
    /// Points before.
    pub points_in: usize,
    /// Points after.
    pub points_out: usize,
    /// The farthest that a point left out lies from the reduced path at the same place in plan, in
    /// mm: the vertical distance, and along bending passes the sideways one with it. Under an arc the
    /// path between the points counts too; under a level one at the same angle about its centre.
    pub max_deviation_mm: f64,
    /// The most that the reduced path runs above a point left out, under an arc above the path, in mm:
    /// material stays.
    pub max_above_mm: f64,
    /// The most that the reduced path runs below a point left out, under an arc below the path, in mm: a
    /// gouge.
    pub max_below_mm: f64,
}

/// Takes out points that are as high as the last point kept, within `tolerance_mm`.
///
/// Along a span the last point kept is the reference. Points are skipped while their height differs
/// from the reference by no more than the tolerance; the last of them is kept and becomes the next
/// reference. A tolerance of 0 merges equal heights; a negative one or NaN changes nothing. Where a
/// span bends in plan its points are kept. The path moves by up to twice the tolerance: see
/// [`Reduction`] for how much it did.
///
/// `tick` counts points. `None` if it stopped the work.
#[must_use]
pub fn reduce_z_band(
    path: &Toolpath,
    tolerance_mm: f64,
    tick: Tick,
) -> Option<(Toolpath, Reduction)> {
    reduce_by(path, tick, |tips| Kept::lines(tips, z_band::keep(tips, tolerance_mm)))
}

/// Takes out points that lie within `tolerance_mm` of the path without them, as many as possible,
/// while the path is never more than `gouge_tolerance_mm` below them.
///
/// The heights are compared at the same place in plan, which is never less than the distance
/// between the lines. Both tolerances are widened by [`CHORD_ALLOWANCE_MM`] so that points in line
/// vanish at tolerance 0 in spite of rounding; negative ones or NaN change nothing.
///
/// `tick` counts points. `None` if it stopped the work.
#[must_use]
pub fn reduce_chord(
    path: &Toolpath,
    tolerance_mm: f64,
    gouge_tolerance_mm: f64,
    tick: Tick,
) -> Option<(Toolpath, Reduction)> {
    let band = chord::Band::new(tolerance_mm, gouge_tolerance_mm);
    reduce_by(path, tick, |tips| Kept::lines(tips, band.keep(tips)))
}

/// Takes out points that lie within `tolerance_mm` of a path of lines and arcs, as many as possible, while
/// that is never more than `gouge_tolerance_mm` below the path given.
///
/// Arcs follow where a span lies in a plane that a machine turns in: passes along X (G18) and along Y (G19),
/// and what is level (G17). They turn through 150° at most, with radii from 0.05 mm to 5 m, and begin and
/// end on points of the path. Elsewhere there are chords, as in [`reduce_chord`], and its tolerances and
/// [`CHORD_ALLOWANCE_MM`] are those here.
///
/// An arc is held against all of the path that it replaces, the lines between its points included:
/// upright in height at the same place in plan, level by the distances from its centre, where `tolerance_mm`
/// alone counts.
///
/// `tick` counts points. `None` if it stopped the work.
#[must_use]
pub fn fit_arcs(
    path: &Toolpath,
    tolerance_mm: f64,
    gouge_tolerance_mm: f64,
    tick: Tick,
) -> Option<(Toolpath, Reduction)> {
    let band = chord::Band::new(tolerance_mm, gouge_tolerance_mm);
    reduce_by(path, tick, |tips| arcs::keep(tips, &band))
}

/// What [`reduce_chord`] adds to its tolerances, in mm: a thousand times the rounding of a
/// coordinate of a metre, a thousandth of the finest step of a controller.
pub const CHORD_ALLOWANCE_MM: f64 = 1e-9;

/// A point of a straight run may be this far beside the line of the run, in mm: far above the
/// rounding of slanted passes, far below what a machine resolves.
const STRAIGHT_MM: f64 = 1e-6;

/// Reduces each span to what `keep` leaves of it.
fn reduce_by(
    path: &Toolpath,
    tick: Tick,
    keep: impl Fn(&[DVec3]) -> Kept + Sync,
) -> Option<(Toolpath, Reduction)> {
    let kept: Option<Vec<Kept>> = path
        .spans
        .par_iter()
        .map(|span| {
            let tips = &path.tips[span.points.clone()];
            let arcs = path.arcs_within(span);
            let kept = if is_cut(span) && tips.len() > 2 && arcs.is_empty() {
                keep(tips)
            } else {
                let arcs = arcs.iter().map(|(end, arc)| (end - span.points.start, *arc)).collect();
                let deviation = Deviation::default();
                Kept { indices: (0..tips.len()).collect(), arcs, deviation }
            };
            tick(tips.len()).then_some(kept)
        })
        .collect();
    Some(assemble(path, &kept?))
}

fn is_cut(span: &Span) -> bool {
    matches!(span.kind, SpanKind::Pass | SpanKind::Link)
}

/// What is left of a span.
struct Kept {
    /// Indices into the span.
    indices: Vec<usize>,
    /// Arcs, by the index into the span of the point that they end at.
    arcs: Vec<(usize, PathArc)>,
    deviation: Deviation,
}

impl Kept {
    /// Lines between some points of a span.
    fn lines(tips: &[DVec3], indices: Vec<usize>) -> Self {
        let mut deviation = Deviation::default();
        for pair in indices.windows(2) {
            deviation.widen(&Deviation::of_line(&tips[pair[0]..=pair[1]]));
        }
        Self { indices, arcs: Vec::new(), deviation }
    }
}

fn assemble(path: &Toolpath, kept: &[Kept]) -> (Toolpath, Reduction) {
    let total = kept.iter().map(|k| k.indices.len()).sum();
    let mut reduced = Toolpath {
        tips: Vec::with_capacity(total),
        contacts: Vec::with_capacity(total),
        spans: Vec::with_capacity(path.spans.len()),
        feeds: path.feeds,
        arcs: Vec::new(),
    };
    let mut facts = Reduction {
        points_in: 0,
        points_out: 0,
        max_deviation_mm: 0.0,
        max_above_mm: 0.0,
        max_below_mm: 0.0,
    };
    for (span, kept) in path.spans.iter().zip(kept) {
        let start = reduced.tips.len();
        let mut arcs = kept.arcs.iter().peekable();
        for &index in &kept.indices {
            if let Some((_, arc)) = arcs.next_if(|(end, _)| *end == index) {
                reduced.arcs.push((reduced.tips.len(), *arc));
            }
            reduced.tips.push(path.tips[span.points.start + index]);
            reduced.contacts.push(path.contacts[span.points.start + index]);
        }
        reduced.spans.push(Span { points: start..reduced.tips.len(), ..span.clone() });
        if is_cut(span) {
            facts.points_in += span.points.len();
            facts.points_out += kept.indices.len();
        }
        facts.max_deviation_mm = facts.max_deviation_mm.max(kept.deviation.distance);
        facts.max_above_mm = facts.max_above_mm.max(kept.deviation.above);
        facts.max_below_mm = facts.max_below_mm.max(kept.deviation.below);
    }
    (reduced, facts)
}

/// Greatest distances of what is left out from the path, in mm.
#[derive(Clone, Copy, Debug, Default)]
struct Deviation {
    distance: f64,
    above: f64,
    below: f64,
}

impl Deviation {
    /// Of the points between the first and the last from the line that joins these.
    fn of_line(tips: &[DVec3]) -> Self {
        let mut worst = Self::default();
        if let [a, between @ .., b] = tips {
            for tip in between {
                let (aside, above) = offset(*a, *b, *tip);
                worst.rise(above);
                worst.distance = worst.distance.max(aside.hypot(above));
            }
        }
        worst
    }

    /// Takes in a place where the path runs so far above what is left out, or below.
    fn rise(&mut self, above: f64) {
        self.distance = self.distance.max(above.abs());
        self.above = self.above.max(above);
        self.below = self.below.max(-above);
    }

    fn widen(&mut self, other: &Self) {
        self.distance = self.distance.max(other.distance);
        self.above = self.above.max(other.above);
        self.below = self.below.max(other.below);
    }
}

/// How far the move from `a` to `b` passes beside `p` in plan, and how far above it at the nearest
/// place in plan, both in mm.
fn offset(a: DVec3, b: DVec3, p: DVec3) -> (f64, f64) {
    let (run, to_p) = ((b - a).truncate(), (p - a).truncate());
    let length_squared = run.length_squared();
    if length_squared > 0.0 {
        let t = (to_p.dot(run) / length_squared).clamp(0.0, 1.0);
        ((to_p - run * t).length(), a.z + (b.z - a.z) * t - p.z)
    } else {
        (to_p.length(), p.z.clamp(a.z.min(b.z), a.z.max(b.z)) - p.z)
    }
}

/// Ends of the straight runs that a span is made of in plan, each the start of the next; the first
/// is 0, the last the last index.
fn straight_runs(tips: &[DVec3]) -> Vec<usize> {
    let mut ends = vec![0];
    let mut start = 0;
    while start + 1 < tips.len() {
        start = end_of_run(tips, start);
        ends.push(start);
    }
    ends
}

/// The last point of the straight run that begins at `start`, which is not the last point.
fn end_of_run(tips: &[DVec3], start: usize) -> usize {
    let origin = tips[start].truncate();
    let Some(direction) = (tips[start + 1].truncate() - origin).try_normalize() else {
        return start + 1;
    };
    let mut end = start + 1;
    let mut way = (tips[end].truncate() - origin).dot(direction);
    for tip in &tips[start + 2..] {
        let to_tip = tip.truncate() - origin;
        let further = to_tip.dot(direction);
        if further <= way || direction.perp_dot(to_tip).abs() > STRAIGHT_MM {
            break;
        }
        (end, way) = (end + 1, further);
    }
    end
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::Contact;

    pub(crate) const GO: Tick = &|_| true;

    /// A path of one span for each list of points.
    pub(crate) fn path_of(spans: &[Vec<DVec3>]) -> Toolpath {
        let mut path = Toolpath::default();
        for tips in spans {
            let start = path.tips.len();
            path.tips.extend(tips);
            let points = start..path.tips.len();
            path.spans.push(Span { points, kind: SpanKind::Pass, joined: start > 0 });
        }
        path.contacts = vec![Contact::NONE; path.tips.len()];
        path
    }

    pub(crate) fn along_x(heights: &[f64]) -> Vec<DVec3> {
        let point = |(k, &z): (usize, &f64)| DVec3::new(k as f64 * 0.3, 1.0, z);
        heights.iter().enumerate().map(point).collect()
    }

    pub(crate) fn wavy(n: usize) -> Vec<DVec3> {
        let height = |k: usize| (k as f64 * 0.03).sin() + 0.3 * (k as f64 * 0.11).sin();
        along_x(&(0..n).map(height).collect::<Vec<_>>())
    }

    #[test]
    fn rapids_and_plunges_stay() {
        let mut path = path_of(&[along_x(&[1.0; 4]), along_x(&[1.0; 5])]);
        path.spans[0].kind = SpanKind::Rapid;
        let (reduced, facts) = reduce_z_band(&path, 0.0, GO).unwrap();
        assert_eq!((facts.points_in, facts.points_out), (5, 2));
        assert_eq!(reduced.spans[0].points, 0..4);
        assert_eq!(reduced.spans[1].points, 4..6);
    }

    #[test]
    fn a_stopped_reduction_is_none() {
        let path = path_of(&[wavy(50)]);
        assert!(reduce_z_band(&path, 0.1, &|_| false).is_none());
        assert!(reduce_chord(&path, 0.1, 0.1, &|_| false).is_none());
    }

    #[test]
    fn contacts_stay_with_their_points() {
        let mut path = path_of(&[wavy(80)]);
        for (contact, tip) in path.contacts.iter_mut().zip(&path.tips) {
            contact.point = *tip;
        }
        for (reduced, _) in
            [reduce_z_band(&path, 0.05, GO).unwrap(), reduce_chord(&path, 0.05, 0.01, GO).unwrap()]
        {
            assert!(reduced.tips.len() < 80);
            assert!(reduced.tips.iter().zip(&reduced.contacts).all(|(t, c)| *t == c.point));
        }
    }

    #[test]
    fn empty_paths_stay_empty() {
        let path = path_of(&[]);
        let (reduced, facts) = reduce_chord(&path, 0.05, 0.01, GO).unwrap();
        assert_eq!((reduced, facts.points_in), (path, 0));
    }

    #[test]
    fn bends_end_runs() {
        let corner = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (2.0, 2.0), (2.0, 1.0)];
        let tips: Vec<_> = corner.map(|(x, y)| DVec3::new(x, y, 0.0)).into();
        assert_eq!(straight_runs(&tips), [0, 2, 4, 5]);
    }
}

//! Waterlines: passes around the surface at constant heights.

use super::{LevelError, Levels, Milling, Outline};
use crate::pattern::{Layer, Stroke, along};
use crate::{Pace, Pattern, Profile, Region, Surface, Tick, Toolpath};
use glam::DVec2;

/// Finishes steep walls by passes around them, each at one height. What is level lies between two of
/// them and is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waterline<'a> {
    /// Where, how high and how exact.
    pub levels: Levels<'a>,
    /// On which side of the cutter the surface is.
    pub milling: Milling,
}

impl Waterline<'_> {
    /// The passes, from the highest level to the lowest. Where an outline is the border of the area
    /// there is none.
    ///
    /// `tick` counts levels, of which [`Levels::count`] tells twice the number.
    ///
    /// # Errors
    /// If the cutter cannot be dropped, there are too many levels or nodes, or `tick` stopped it.
    pub fn path(
        &self,
        surface: Surface<'_>,
        profile: &Profile,
        tick: Tick,
    ) -> Result<Toolpath, LevelError> {
        let step_mm = self.levels.pitch_mm;
        // Links reach ten stepovers, and are to reach a cutter's width.
        let pace = Pace { stepover_mm: profile.radius_mm() / 5.0, feed_step_mm: step_mm };
        let within = self.levels.boundary.map(|boundary| {
            Region::new(&self.levels.area).and_then(|area| area.within(boundary.clone()))
        });
        let plan = |outlines: &[Outline], region: &Region| {
            let mut layer = match Layer::new(region, pace) {
                Ok(layer) => layer,
                Err(pattern) => return pattern,
            };
            let pieces = outlines.iter().flat_map(touching);
            let pieces = match &within {
                None => pieces.collect(),
                Some(None) => Vec::new(),
                Some(Some(within)) => pieces.flat_map(|piece| cut(piece, within, pace)).collect(),
            };
            for mut piece in nearest_first(pieces) {
                if self.milling == Milling::Conventional {
                    piece.reverse();
                }
                layer.add_whole(along(&piece, step_mm).collect());
            }
            layer.into_pattern(false)
        };
        self.levels.path(surface, profile, false, plan, tick)
    }
}

/// The parts of a piece in a region.
fn cut(piece: Vec<DVec2>, within: &Region, pace: Pace) -> Vec<Vec<DVec2>> {
    let Ok(mut layer) = Layer::new(within, pace) else { return Vec::new() };
    let closed = piece.first() == piece.last();
    let points = piece.into_iter();
    layer.add(if closed { Stroke::Closed(points) } else { Stroke::Open(points) });
    let Pattern { points, spans } = layer.into_lifted();
    spans.into_iter().map(|span| points[span.points].to_vec()).collect()
}

/// Pieces in an order with little travel: each is followed by the one that begins nearest to its end.
fn nearest_first(mut pieces: Vec<Vec<DVec2>>) -> Vec<Vec<DVec2>> {
    /// The work grows with the square of the number; so many are in order in some 10 ms.
    const MANY: usize = 4000;
    for k in 1..pieces.len().min(MANY) {
        let Some(&end) = pieces[k - 1].last() else { continue };
        let away = |piece: &Vec<DVec2>| piece[0].distance_squared(end);
        let nearest =
            (k..pieces.len()).min_by(|a, b| away(&pieces[*a]).total_cmp(&away(&pieces[*b])));
        pieces.swap(k, nearest.unwrap_or(k));
    }
    pieces
}

/// The parts of an outline where the surface is touched. A closed one ends where it begins.
fn touching(outline: &Outline) -> Vec<Vec<DVec2>> {
    let corners = &outline.corners;
    let Some(border) = corners.iter().position(|corner| corner.border) else {
        let around = corners.iter().chain(corners.first());
        return vec![around.map(|corner| corner.at).collect()];
    };
    // From the border around to it.
    let around = (0..=corners.len()).map(|k| corners[(border + k) % corners.len()]);
    let around: Vec<_> = around.collect();
    let parts = around.chunk_by(|a, b| !(a.border && b.border));
    let parts = parts.map(|part| part.iter().map(|corner| corner.at).collect());
    parts.filter(|part: &Vec<DVec2>| part.len() > 1).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Corner;
    use super::*;

    #[test]
    fn what_lies_along_the_border_is_no_pass() {
        let corner = |x, y, border| Corner { at: DVec2::new(x, y), border };
        let outline = |borders: [bool; 5]| {
            let [a, b, c, d, e] = borders;
            Outline {
                corners: vec![
                    corner(0.0, 0.0, a),
                    corner(4.0, 0.0, b),
                    corner(4.0, 4.0, c),
                    corner(2.0, 2.0, d),
                    corner(0.0, 4.0, e),
                ],
            }
        };
        let open = touching(&outline([true, true, true, false, true]));
        assert_eq!(open.len(), 1);
        assert_eq!(open[0], [DVec2::new(4.0, 4.0), DVec2::splat(2.0), DVec2::new(0.0, 4.0)]);
        let closed = touching(&outline([false; 5]));
        assert_eq!((closed.len(), closed[0].len()), (1, 6));
        assert!(touching(&outline([true; 5])).is_empty());
    }
}

//! A border around a relief: the surface is extended by it on all four sides.
//!
//! With t the distance from the relief's edge, mitred in the corners (the greater of those along x
//! and y), w the width and h the height, the border is above its level
//!
//! | shape | height |
//! |---|---|
//! | flat | 0 |
//! | raised | h |
//! | bevel | h·t/w |
//! | cove | h·(1 - √(1 - (t/w)²)), a quarter of a hollow that leaves the relief level |
//!
//! The border has whole pitches: the width is rounded to the nearest, at least one if it is not 0. Raised,
//! it rises within its first pitch, as steeply as the surface can say.

use super::{After, Before, check_size};
use carvegraph_core::{Choice, Context, Node, NodeError, Params, Yielding};
use carvegraph_geometry::HeightField;

/// Lays a margin or a frame around a relief.
#[derive(Clone, Debug, Params)]
pub(crate) struct Border {
    /// Its cross-section.
    #[param(default = Shape::Flat)]
    pub(crate) shape: Shape,
    /// How wide it is; 0 leaves the relief as it is.
    #[param(unit = "mm", default = 5.0, range = 0.0..=10_000.0)]
    pub(crate) width: f64,
    /// How far its highest place stands above its level; negative is sunk.
    #[param(unit = "mm", default = 2.0, range = -1000.0..=1000.0)]
    pub(crate) height: f64,
    /// Its level. Left alone, it is that of the lowest node on the relief's edge.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) level: Yielding<f64>,
}

/// The cross-section of a border.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Shape {
    /// A level margin; the height does not count.
    Flat,
    /// A level frame that stands above the margin's level.
    Raised,
    /// A plane that rises outwards.
    Bevel,
    /// A hollow that rises outwards.
    Cove,
}

impl Node for Border {
    const KIND: &'static str = "border";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn run(&self, Before { surface }: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let pitches = self.width / surface.pitch_mm();
        let width = if self.width > 0.0 { pitches.round().max(1.0) as usize } else { 0 };
        let (columns, rows) = (surface.columns(), surface.rows());
        let whole = [columns, rows].map(|count| count.saturating_add(width.saturating_mul(2)));
        check_size(whole, "width")?;
        if width > 0 {
            let moved = width as f64 * surface.pitch_mm();
            cx.note(format!("the border is {moved:.4} mm wide; the relief begins at that x and y"));
        }
        let level = self.level.or(Some(lowest_on_edge(surface)));
        let beyond = |k: usize, count: usize| {
            (width.saturating_sub(k)).max((k + 1).saturating_sub(width + count))
        };
        let height = |i: usize, j: usize| match beyond(i, columns).max(beyond(j, rows)) {
            0 => surface.height(i - width, j - width),
            steps => level + self.shape.rise(steps as f64 / width as f64) * self.height,
        };
        After::by_nodes(whole, surface, cx, height)
    }
}

impl Shape {
    /// The share of the height at a share of the width.
    fn rise(self, t: f64) -> f64 {
        match self {
            Self::Flat => 0.0,
            Self::Raised => 1.0,
            Self::Bevel => t,
            Self::Cove => 1.0 - (1.0 - t * t).max(0.0).sqrt(),
        }
    }
}

fn lowest_on_edge(surface: &HeightField) -> f64 {
    let (columns, rows) = (surface.columns(), surface.rows());
    let sides = (0..rows).flat_map(|j| [surface.height(0, j), surface.height(columns - 1, j)]);
    let ends = [surface.row(0), surface.row(rows - 1)].into_iter().flatten();
    sides.chain(ends.map(|z| f64::from(*z))).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{field, shaped};
    use super::*;

    const PLAIN: Border =
        Border { shape: Shape::Flat, width: 1.0, height: 4.0, level: Yielding::left(0.0) };

    fn relief() -> HeightField {
        field(&[[2.0, 3.0, 2.0], [2.0, 0.0, 1.0], [2.0, 3.0, 2.0]])
    }

    #[test]
    fn a_flat_border_lies_at_the_edges_lowest_node_around_the_untouched_relief() {
        let found = shaped(&PLAIN, &relief()).unwrap();
        assert_eq!((found.columns(), found.rows(), found.pitch_mm()), (7, 7, 0.5));
        assert_eq!(found.row(1), [1.0; 7]);
        assert_eq!(found.row(3), [1.0, 1.0, 2.0, 0.0, 1.0, 1.0, 1.0]);
    }

    #[test]
    fn shapes_rise_as_told_and_corners_are_mitred() {
        let row = |shape, j: usize| {
            let node = Border { shape, level: Yielding::given(-1.0), ..PLAIN };
            shaped(&node, &relief()).unwrap().row(j).to_vec()
        };
        assert_eq!(row(Shape::Raised, 3)[..3], [3.0, 3.0, 2.0]);
        assert_eq!(row(Shape::Bevel, 3)[..3], [3.0, 1.0, 2.0]);
        assert_eq!(row(Shape::Bevel, 5), [3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0]);
        let hollow = (3.0 - 4.0 * 0.75_f64.sqrt()) as f32;
        assert_eq!(row(Shape::Cove, 3)[..2], [3.0, hollow]);
    }

    #[test]
    fn no_width_is_no_border_and_a_narrow_one_is_a_pitch_wide() {
        let columns = |width| shaped(&Border { width, ..PLAIN }, &relief()).unwrap().columns();
        assert_eq!((columns(0.0), columns(0.01), columns(0.8)), (3, 5, 7));
        assert_eq!(shaped(&Border { width: 0.0, ..PLAIN }, &relief()).unwrap(), relief());
    }

    #[test]
    fn a_border_beyond_all_limits_is_refused() {
        let told = shaped(&Border { width: 9000.0, ..PLAIN }, &relief()).unwrap_err();
        assert!(told.contains("36003 × 36003 nodes; the limit is 400000000"), "{told}");
    }
}

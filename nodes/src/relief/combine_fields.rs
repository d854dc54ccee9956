//! Two surfaces become one.
//!
//! At each node of the first, a is its height and b that of the second there, bilinear between the
//! second's nodes, whatever its pitch:
//!
//! | rule | height |
//! |---|---|
//! | add | a + b |
//! | subtract | a - b |
//! | max | the higher; with a blend k, max(a, b) + k·h²/4, h = max(0, 1 - abs(a - b)/k) |
//! | min | the lower; with a blend, min(a, b) - k·h²/4 |
//! | replace | b |
//!
//! The blend is the quadratic smooth minimum (Quilez, *Smooth minimum*, 2013): heights closer than k
//! are joined by a fillet without a crease, at most k/4 off, where both are equal. Where the second
//! surface has nothing, the first stays as it is. Under a mask of share m it is a + m·(height - a).

use super::{After, size};
use crate::values::Mask;
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Params};
use carvegraph_geometry::HeightField;

/// Adds or subtracts two surfaces, takes the higher or the lower, or lays one into the other.
#[derive(Clone, Debug, Params)]
pub(crate) struct CombineFields {
    /// What becomes of two heights.
    #[param(default = Rule::Max)]
    pub(crate) rule: Rule,
    /// Heights closer than that are joined by a fillet, for max and min; 0 leaves the crease.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1000.0)]
    pub(crate) blend: f64,
    /// Where on the first surface the second one's near left corner lies, along x.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) offset_x: f64,
    /// Where it lies along y.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) offset_y: f64,
    /// How much the second surface is raised before.
    #[param(unit = "mm", default = 0.0, range = -1000.0..=1000.0)]
    pub(crate) offset_z: f64,
}

/// What becomes of the heights of two surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Rule {
    /// Their sum.
    Add,
    /// The first less the second.
    Subtract,
    /// The higher one.
    Max,
    /// The lower one.
    Min,
    /// That of the second.
    Replace,
}

#[derive(Inputs)]
pub(crate) struct Pair<'a> {
    /// The first surface, whose nodes the result has.
    first: &'a HeightField,
    /// The second surface.
    second: &'a HeightField,
    /// Where the second one counts, laid over the first as a picture is; everywhere if there is none.
    mask: Option<&'a Mask>,
}

impl Node for CombineFields {
    const KIND: &'static str = "combine_fields";
    type Inputs<'a> = Pair<'a>;
    type Outputs = After;

    fn run(&self, inputs: Pair<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let Pair { first, second, mask } = inputs;
        let pitch_mm = first.pitch_mm();
        let top = Grid::of(second);
        let mask = mask.map(Grid::of_mask);
        let [columns, rows] = size(first).map(|count| count as f64 - 1.0);
        let meets = |i: usize, j: usize| {
            let at = [(i, self.offset_x), (j, self.offset_y)];
            let at = at.map(|(k, offset)| (k as f64 * pitch_mm - offset) / second.pitch_mm());
            top.sample(at)
        };
        let share = |i: usize, j: usize| match &mask {
            Some(mask) => {
                let (across, up) = (i as f64 / columns, 1.0 - j as f64 / rows);
                mask.sample([across * mask.last(0), up * mask.last(1)]).unwrap_or(0.0)
            }
            None => 1.0,
        };
        let height = |i: usize, j: usize| {
            let own = first.height(i, j);
            meets(i, j).map_or(own, |met| {
                own + share(i, j) * (self.rule.of(own, met + self.offset_z, self.blend) - own)
            })
        };
        let after = After::by_nodes(size(first), first, cx, height)?;
        if !self.overlaps(first, second) {
            cx.warn("the second surface lies beside the first: set offset_x and offset_y");
        }
        Ok(after)
    }
}

impl CombineFields {
    fn overlaps(&self, first: &HeightField, second: &HeightField) -> bool {
        let (first, second) = (first.bounds().max, second.bounds().max);
        let within = |offset: f64, first: f64, second: f64| offset <= first && -offset <= second;
        within(self.offset_x, first.x, second.x) && within(self.offset_y, first.y, second.y)
    }
}

impl Rule {
    fn of(self, a: f64, b: f64, blend: f64) -> f64 {
        let near = if blend > 0.0 { (1.0 - (a - b).abs() / blend).max(0.0) } else { 0.0 };
        let fillet = 0.25 * blend * near * near;
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Max => a.max(b) + fillet,
            Self::Min => a.min(b) - fillet,
            Self::Replace => b,
        }
    }
}

/// Values in rows.
struct Grid<'a> {
    columns: usize,
    values: &'a [f32],
}

impl<'a> Grid<'a> {
    fn of(field: &'a HeightField) -> Self {
        Self { columns: field.columns(), values: field.heights() }
    }

    fn of_mask(mask: &'a Mask) -> Self {
        Self { columns: mask.width, values: &mask.values }
    }

    /// The number of the last column (0) or row (1).
    fn last(&self, axis: usize) -> f64 {
        let counts = [self.columns, self.values.len() / self.columns];
        counts[axis] as f64 - 1.0
    }

    /// The bilinear value at a column and row, which may be broken; `None` outside.
    fn sample(&self, at: [f64; 2]) -> Option<f64> {
        // 0.3 · 10 is not 3: a node on the border counts as within.
        const SLACK: f64 = 1e-9;
        let [x, y] = [0, 1].map(|axis| {
            let (at, last) = (at[axis], self.last(axis));
            ((-SLACK..=last + SLACK).contains(&at)).then(|| at.clamp(0.0, last))
        });
        let (x, y) = (x?, y?);
        let (i, j) = (x as usize, y as usize);
        let (u, v) = (x - i as f64, y - j as f64);
        let value = |i: usize, j: usize| f64::from(self.values[j * self.columns + i]);
        // Only what has a share is looked at: the last column has no neighbour.
        let along = |j: usize| match u > 0.0 {
            true => value(i, j) + u * (value(i + 1, j) - value(i, j)),
            false => value(i, j),
        };
        let low = along(j);
        Some(if v > 0.0 { low + v * (along(j + 1) - low) } else { low })
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::field;
    use super::*;
    use crate::testing::run;

    const PLAIN: CombineFields =
        CombineFields { rule: Rule::Max, blend: 0.0, offset_x: 0.0, offset_y: 0.0, offset_z: 0.0 };

    fn combined(
        node: &CombineFields,
        first: &HeightField,
        second: &HeightField,
        mask: Option<&Mask>,
    ) -> Vec<f32> {
        let after = run(|cx| node.run(Pair { first, second, mask }, cx)).unwrap();
        after.surface.heights().to_vec()
    }

    #[test]
    fn rules_go_node_by_node() {
        let (a, b) = (field(&[[0.0, 2.0], [3.0, -1.0]]), field(&[[1.0, 1.0], [5.0, -3.0]]));
        for (rule, expected) in [
            (Rule::Add, [1.0, 3.0, 8.0, -4.0]),
            (Rule::Subtract, [-1.0, 1.0, -2.0, 2.0]),
            (Rule::Max, [1.0, 2.0, 5.0, -1.0]),
            (Rule::Min, [0.0, 1.0, 3.0, -3.0]),
            (Rule::Replace, [1.0, 1.0, 5.0, -3.0]),
        ] {
            assert_eq!(combined(&CombineFields { rule, ..PLAIN }, &a, &b, None), expected);
        }
    }

    #[test]
    fn the_second_is_sampled_where_it_lies_and_the_first_stays_beside_it() {
        let first = field(&[[0.0; 5]; 3]);
        // A plane x + 10·y over 1.5 × 0.75 mm.
        let second = HeightField::new(3, 2, 0.75, vec![0.0, 0.75, 1.5, 7.5, 8.25, 9.0]).unwrap();
        let node = CombineFields { rule: Rule::Replace, offset_x: 0.25, offset_z: 1.0, ..PLAIN };
        let found = combined(&node, &first, &second, None);
        assert_eq!(found[..5], [0.0, 1.25, 1.75, 2.25, 0.0]);
        assert_eq!(found[5..10], [0.0, 6.25, 6.75, 7.25, 0.0]);
        assert_eq!(found[10..], [0.0; 5]);
    }

    #[test]
    fn a_blend_is_a_fillet_of_a_quarter_at_most_and_ends_at_its_width() {
        let (low, high) = (Rule::Min, Rule::Max);
        assert_eq!((high.of(1.0, 1.0, 2.0), low.of(1.0, 1.0, 2.0)), (1.5, 0.5));
        assert_eq!((high.of(0.0, 2.0, 2.0), low.of(0.0, 2.0, 2.0)), (2.0, 0.0));
        // No crease: the slope of max(0, x) goes from 0 to 1 in steps that shrink with those of x.
        let slope = |x: f64| (high.of(0.0, x + 1e-6, 2.0) - high.of(0.0, x - 1e-6, 2.0)) / 2e-6;
        let bends =
            (-300..300).map(|k| slope(f64::from(k + 1) / 100.0) - slope(f64::from(k) / 100.0));
        assert!(bends.into_iter().all(|bend| (-1e-6..0.006).contains(&bend)));
    }

    #[test]
    fn a_mask_says_where_and_how_much() {
        let (first, second) = (field(&[[0.0; 3]; 3]), field(&[[8.0; 3]; 3]));
        // Two pixels by two: their middles lie on the corners, the top row far.
        let mask = Mask { width: 2, height: 2, values: vec![1.0, 0.0, 0.0, 0.5] };
        let node = CombineFields { rule: Rule::Replace, ..PLAIN };
        let found = combined(&node, &first, &second, Some(&mask));
        assert_eq!(found, [0.0, 2.0, 4.0, 4.0, 3.0, 2.0, 8.0, 4.0, 0.0]);
    }
}

//! Heights scaled: z' = s·z + shift, or the lowest and the highest brought to given heights.

use super::{After, Before, size};
use carvegraph_core::{Choice, Conflict, Context, Node, NodeError, Params};

/// Makes a surface deeper or flatter, raises it, or fits it between two heights.
#[derive(Clone, Debug, Params)]
pub(crate) struct ScaleField {
    /// What says where heights go.
    #[param(default = By::Factor)]
    pub(crate) by: By,
    /// Height of what was 100 % high, seen from 0; negative turns the surface upside down.
    #[param(unit = "%", default = 100.0, range = -1_000_000.0..=1_000_000.0)]
    pub(crate) scale: f64,
    /// How much it is raised after that.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) shift: f64,
    /// Where the lowest node comes to lie, for by: range.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) z_min: f64,
    /// Where the highest node comes to lie, for by: range.
    #[param(unit = "mm", default = 5.0, range = -100_000.0..=100_000.0)]
    pub(crate) z_max: f64,
}

/// What says where heights go.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum By {
    /// The scale and the shift.
    Factor,
    /// The lowest and the highest node.
    Range,
}

impl Node for ScaleField {
    const KIND: &'static str = "scale_field";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn check(&self) -> Result<(), Conflict> {
        if self.by == By::Factor || self.z_min < self.z_max {
            return Ok(());
        }
        let message = format!("z_max ({} mm) must be above z_min ({} mm)", self.z_max, self.z_min);
        Err(Conflict { param: "z_max", message })
    }

    fn run(&self, Before { surface }: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let (low, high) = (surface.bounds().min.z, surface.bounds().max.z);
        let height: &(dyn Fn(f64) -> f64 + Sync) = match self.by {
            By::Factor => &|z| self.scale / 100.0 * z + self.shift,
            By::Range if low == high => {
                cx.warn(format!("the surface is flat: it lies at z_min = {} mm", self.z_min));
                &|_| self.z_min
            }
            By::Range => &|z| {
                let share = (z - low) / (high - low);
                (1.0 - share) * self.z_min + share * self.z_max
            },
        };
        After::by_nodes(size(surface), surface, cx, |i, j| height(surface.height(i, j)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{field, shaped};
    use super::*;

    const PLAIN: ScaleField =
        ScaleField { by: By::Factor, scale: 100.0, shift: 0.0, z_min: 0.0, z_max: 5.0 };

    #[test]
    fn a_factor_scales_about_0_and_then_shifts() {
        let node = ScaleField { scale: -50.0, shift: 1.0, ..PLAIN };
        let found = shaped(&node, &field(&[[0.0, 2.0], [4.0, -6.0]])).unwrap();
        assert_eq!(found.heights(), [1.0, 0.0, -1.0, 4.0]);
    }

    #[test]
    fn a_range_is_filled_to_both_ends() {
        let node = ScaleField { by: By::Range, z_min: -1.3, z_max: 0.7, ..PLAIN };
        let found = shaped(&node, &field(&[[7.0, 8.0], [9.0, 7.5]])).unwrap();
        assert_eq!(found.heights()[..3], [-1.3, -0.3, 0.7]);
        let flat = shaped(&node, &field(&[[7.0; 2]; 2])).unwrap();
        assert_eq!(flat.heights(), [-1.3; 4]);
    }

    #[test]
    fn a_range_the_wrong_way_round_is_told() {
        let node = ScaleField { by: By::Range, z_min: 5.0, ..PLAIN };
        assert_eq!(node.check().unwrap_err().message, "z_max (5 mm) must be above z_min (5 mm)");
        assert!(ScaleField { z_min: 9.0, ..PLAIN }.check().is_ok());
    }
}

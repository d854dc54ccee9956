//! Heights held between two planes: z' = min(max(z, z_min), z_max).

use super::{After, Before, check_range, size};
use carvegraph_core::{Conflict, Context, Node, NodeError, Params, Yielding};

/// Cuts off what stands higher than a plane and fills what lies lower than another.
#[derive(Clone, Debug, Params)]
pub(crate) struct ClampField {
    /// What lies below is raised to that. Left alone, nothing is.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) z_min: Yielding<f64>,
    /// What stands higher is lowered to that, if it is set.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) z_max: Yielding<f64>,
}

impl Node for ClampField {
    const KIND: &'static str = "clamp_field";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn check(&self) -> Result<(), Conflict> {
        check_range(&self.z_min, &self.z_max)
    }

    fn run(&self, Before { surface }: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let low = self.z_min.or(Some(f64::NEG_INFINITY));
        let high = self.z_max.or(Some(f64::INFINITY));
        let height = |i: usize, j: usize| surface.height(i, j).max(low).min(high);
        After::by_nodes(size(surface), surface, cx, height)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{field, shaped};
    use super::*;

    #[test]
    fn each_limit_counts_if_it_is_set() {
        let surface = field(&[[-2.0, 0.5], [1.0, 7.0]]);
        let open = Yielding::left(0.0);
        for (z_min, z_max, expected) in [
            (open.clone(), open.clone(), [-2.0, 0.5, 1.0, 7.0]),
            (Yielding::given(0.0), open.clone(), [0.0, 0.5, 1.0, 7.0]),
            (open, Yielding::given(0.75), [-2.0, 0.5, 0.75, 0.75]),
            (Yielding::given(0.0), Yielding::given(3.0), [0.0, 0.5, 1.0, 3.0]),
        ] {
            let found = shaped(&ClampField { z_min, z_max }, &surface).unwrap();
            assert_eq!(found.heights(), expected);
        }
    }

    #[test]
    fn limits_the_wrong_way_round_are_told() {
        let node = ClampField { z_min: Yielding::given(2.0), z_max: Yielding::given(1.0) };
        assert_eq!(node.check().unwrap_err().message, "z_max (1 mm) must be above z_min (2 mm)");
    }
}

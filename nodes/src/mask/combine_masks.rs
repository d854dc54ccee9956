//! Two masks become one.
//!
//! Shares are combined as fuzzy sets are (Zadeh, *Fuzzy Sets*, Information and Control 8, 1965):
//! and = min(a, b), or = max(a, b), minus = min(a, 1 - b). Where masks are crisp these are the usual
//! ones, and what is done twice is as if done once.

use super::check_size;
use crate::values::Mask;
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use rayon::prelude::*;

/// Takes two masks together, what they share, or the first without the second.
#[derive(Clone, Debug, Params)]
pub(crate) struct CombineMasks {
    /// What is selected.
    #[param(default = Rule::Or)]
    pub(crate) rule: Rule,
}

/// What of two masks is selected.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Rule {
    /// What both select.
    And,
    /// What either selects.
    Or,
    /// What the first selects and the second does not.
    Minus,
}

#[derive(Inputs)]
pub(crate) struct Pair<'a> {
    /// The first mask.
    first: &'a Mask,
    /// The second mask.
    second: &'a Mask,
}

#[derive(Outputs)]
pub(crate) struct Combined {
    /// The mask of both.
    mask: Mask,
}

impl Node for CombineMasks {
    const KIND: &'static str = "combine_masks";
    type Inputs<'a> = Pair<'a>;
    type Outputs = Combined;

    fn run(&self, inputs: Pair<'_>, _: &Context<'_>) -> Result<Combined, NodeError> {
        let Pair { first, second } = inputs;
        check_size(second, "the first mask", (first.width, first.height))?;
        let both = first.values.par_iter().zip(&second.values);
        let values = both.map(|(a, b)| self.rule.of(*a, *b)).collect();
        Ok(Combined { mask: Mask { width: first.width, height: first.height, values } })
    }
}

impl Rule {
    fn of(self, a: f32, b: f32) -> f32 {
        match self {
            Self::And => a.min(b),
            Self::Or => a.max(b),
            Self::Minus => a.min(1.0 - b),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn line(values: &[f32]) -> Mask {
        Mask { width: values.len(), height: 1, values: values.to_vec() }
    }

    fn combine(rule: Rule, first: &Mask, second: &Mask) -> Result<Vec<f32>, String> {
        let combined = run(|cx| CombineMasks { rule }.run(Pair { first, second }, cx));
        combined.map(|combined| combined.mask.values).map_err(|fault| fault.to_string())
    }

    #[test]
    fn crisp_masks_follow_the_table_of_truth() {
        let (a, b) = (line(&[0., 0., 1., 1., 0.25]), line(&[0., 1., 0., 1., 1.]));
        assert_eq!(combine(Rule::And, &a, &b).unwrap(), [0., 0., 0., 1., 0.25]);
        assert_eq!(combine(Rule::Or, &a, &b).unwrap(), [0., 1., 1., 1., 1.]);
        assert_eq!(combine(Rule::Minus, &a, &b).unwrap(), [0., 0., 1., 0., 0.]);
    }

    #[test]
    fn masks_of_two_sizes_are_refused_with_both() {
        let message = combine(Rule::Or, &line(&[0.0; 3]), &line(&[0.0; 4])).unwrap_err();
        assert_eq!(
            message,
            "the mask has 4 × 1 px and the first mask 3 × 1 px: make the mask for this picture, \
             pixel by pixel"
        );
    }

    #[test]
    fn soft_masks_keep_to_the_laws_of_fuzzy_sets() {
        let mut random = fastrand::Rng::with_seed(9);
        // Shares of 256ths, so that 1 - a is exact.
        let mut mask =
            || line(&(0..97).map(|_| f32::from(random.u8(..)) / 256.0).collect::<Vec<_>>());
        let (a, b) = (mask(), mask());
        let not =
            |mask: &Mask| line(&mask.values.iter().map(|share| 1.0 - share).collect::<Vec<_>>());
        let of = |rule, a: &Mask, b: &Mask| line(&combine(rule, a, b).unwrap());
        assert_eq!(not(&of(Rule::Or, &a, &b)), of(Rule::And, &not(&a), &not(&b)));
        assert_eq!(of(Rule::Minus, &a, &b), of(Rule::And, &a, &not(&b)));
        for rule in [Rule::And, Rule::Or] {
            assert_eq!(of(rule, &a, &a), a);
            assert_eq!(of(rule, &a, &b), of(rule, &b, &a));
        }
    }
}

//! Numbers as a controller reads them: counts of the last decimal place.
//!
//! A length becomes a whole number of steps (0.001 mm, or 0.0001 in) once, and everything after
//! (what changed, arcs, digits) works on those. Rounding is to the nearest step, halves away from
//! zero, and exact: it is the given binary number that is rounded, not a product that was itself
//! rounded. At least one digit stands behind the point, trailing zeros beyond it are left out: a
//! serial line to a small controller carries some 11,000 characters a second.

use carvegraph_sdk::Units;

/// How a controller wants its numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NumberFormat {
    /// Decimals of a millimetre; up to 3 are rounded exactly.
    pub(crate) decimals_mm: u32,
    /// Decimals of an inch; up to 4 are rounded exactly.
    pub(crate) decimals_inch: u32,
    /// Decimals that are written even if they are zeros; with 1 the point is never missing.
    pub(crate) least_decimals: u32,
    /// Whether a sign stands before positive coordinates too.
    pub(crate) plus: bool,
}

/// What feeds are counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FeedUnit {
    /// Millimetres or inches a minute.
    PerMinute,
    /// Millimetres or inches a second.
    PerSecond,
    /// Millimetres or tenths of an inch a minute.
    TenthInchPerMinute,
}

/// The steps of one unit system: `numerator / denominator` of them make a millimetre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    numerator: f64,
    denominator: f64,
    decimals: u32,
    least_decimals: u32,
    plus: bool,
}

/// How near to a half a rounded product must be for its true side to be worked out. Two roundings
/// of up to 4·10⁸ steps are wrong by less than 2·10⁻⁷.
const NEAR_HALF: f64 = 1e-6;

impl Grid {
    /// Thousandths of what has no units; seconds.
    pub(crate) const THOUSANDTHS: Self =
        Self { numerator: 1000.0, denominator: 1.0, decimals: 3, least_decimals: 1, plus: false };

    /// Whole numbers.
    pub(crate) const WHOLE: Self =
        Self { numerator: 1.0, denominator: 1.0, decimals: 0, least_decimals: 0, plus: false };

    /// The grid of coordinates.
    pub(crate) fn lengths(units: Units, format: NumberFormat) -> Self {
        let (decimals, numerator, denominator) = match units {
            Units::Mm => (format.decimals_mm, 1.0, 1.0),
            // 25.4 mm, in whole numbers.
            Units::Inch => (format.decimals_inch, 10.0, 254.0),
        };
        let least_decimals = format.least_decimals.min(decimals);
        let numerator = numerator * 10_f64.powi(decimals as i32);
        Self { numerator, denominator, decimals, least_decimals, plus: format.plus }
    }

    /// The grid of feeds, which are given in mm/min.
    pub(crate) fn feeds(units: Units, format: NumberFormat, unit: FeedUnit) -> Self {
        let grid = Self { plus: false, ..Self::lengths(units, format) };
        match (unit, units) {
            (FeedUnit::PerSecond, _) => Self { denominator: 60.0 * grid.denominator, ..grid },
            (FeedUnit::TenthInchPerMinute, Units::Inch) => {
                Self { numerator: 10.0 * grid.numerator, ..grid }
            }
            _ => grid,
        }
    }

    /// The whole number of steps nearest to a finite value in mm, halves away from zero.
    #[inline]
    pub(crate) fn round(self, value: f64) -> i64 {
        let steps = value * self.numerator / self.denominator;
        let whole = steps as i64;
        let rest = (steps - whole as f64).abs();
        let outwards = if (rest - 0.5).abs() > NEAR_HALF {
            rest > 0.5
        } else {
            self.reaches_half(value.abs(), whole.abs())
        };
        whole + if outwards { 1 - 2 * i64::from(steps < 0.0) } else { 0 }
    }

    /// Whether `value` is `whole` steps and a half, or more. One rounding decides the sign, so the
    /// answer is exact.
    #[cold]
    fn reaches_half(self, value: f64, whole: i64) -> bool {
        value.mul_add(self.numerator, -self.denominator * (whole as f64 + 0.5)) >= 0.0
    }

    /// A value in mm as a fraction of steps.
    pub(crate) fn steps(self, value: f64) -> f64 {
        value * self.numerator / self.denominator
    }

    /// One step in mm.
    pub(crate) fn step_mm(self) -> f64 {
        self.denominator / self.numerator
    }

    /// A number of steps as the number that its decimals read as.
    pub(crate) fn number(self, steps: i64) -> f64 {
        steps as f64 / 10_f64.powi(self.decimals as i32)
    }

    /// Writes a number of steps in decimals.
    #[inline]
    pub(crate) fn push(self, out: &mut Vec<u8>, steps: i64) {
        // 20 digits, a point and a sign fit.
        let mut text = [0_u8; 24];
        let mut at = text.len();
        let mut rest = steps.unsigned_abs();
        let mut decimals = self.decimals;
        while decimals > self.least_decimals && rest.is_multiple_of(10) {
            rest /= 10;
            decimals -= 1;
        }
        let mut digit = |rest: &mut u64, at: &mut usize| {
            *at -= 1;
            text[*at] = b'0' + (*rest % 10) as u8;
            *rest /= 10;
        };
        for _ in 0..decimals {
            digit(&mut rest, &mut at);
        }
        let point = at - usize::from(decimals > 0);
        at = point;
        digit(&mut rest, &mut at);
        while rest > 0 {
            digit(&mut rest, &mut at);
        }
        if decimals > 0 {
            text[point] = b'.';
        }
        if steps < 0 || self.plus {
            at -= 1;
            text[at] = if steps < 0 { b'-' } else { b'+' };
        }
        out.extend_from_slice(&text[at..]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMAT: NumberFormat =
        NumberFormat { decimals_mm: 3, decimals_inch: 4, least_decimals: 1, plus: false };

    fn written(units: Units, value_mm: f64) -> String {
        text(Grid::lengths(units, FORMAT), value_mm)
    }

    fn text(grid: Grid, value_mm: f64) -> String {
        let mut out = Vec::new();
        grid.push(&mut out, grid.round(value_mm));
        String::from_utf8(out).unwrap()
    }

    fn mm(value: f64) -> String {
        written(Units::Mm, value)
    }

    #[test]
    fn a_digit_stands_behind_the_point() {
        assert_eq!(mm(0.0), "0.0");
        assert_eq!(mm(12.0), "12.0");
        assert_eq!(mm(12.5), "12.5");
        assert_eq!(mm(-0.25), "-0.25");
        assert_eq!(mm(203.125), "203.125");
        assert_eq!(mm(-1e6), "-1000000.0");
    }

    #[test]
    fn nothing_is_minus_nothing() {
        assert_eq!(mm(-0.0), "0.0");
        assert_eq!(mm(-0.000_4), "0.0");
        assert_eq!(mm(-0.000_6), "-0.001");
    }

    #[test]
    fn halves_go_away_from_zero() {
        assert_eq!(mm(0.0625), "0.063");
        assert_eq!(mm(-0.0625), "-0.063");
        assert_eq!(mm(0.1875), "0.188");
    }

    #[test]
    fn the_binary_value_decides_not_its_product() {
        // 1.0005 is a little below in binary, 1.0015 a little below, 1.0025 above.
        for value in [1.0005, 1.0015, 1.0025, 2.0005, 8.1255, 100.0005, 999_999.000_5] {
            for value in [value, -value] {
                assert_eq!(Grid::THOUSANDTHS.round(value), exactly(value), "{value}");
            }
        }
        assert_eq!(mm(0.499_999_999_999_999_94 / 1000.0), "0.0");
    }

    #[test]
    fn rounding_agrees_with_the_exact_expansion() {
        let mut seed = 1_u64;
        for _ in 0..100_000 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let value = (seed >> 20) as f64 / (1_u64 << 34) as f64 - 512.0;
            assert_eq!(Grid::THOUSANDTHS.round(value), exactly(value), "{value}");
            // Decimal ties that binary cannot hold.
            let tie = ((seed >> 40) as f64 + 0.5) / 1000.0;
            assert_eq!(Grid::THOUSANDTHS.round(tie), exactly(tie), "{tie}");
        }
    }

    #[test]
    fn inches_have_four_decimals() {
        assert_eq!(written(Units::Inch, 25.4), "1.0");
        assert_eq!(written(Units::Inch, -12.7), "-0.5");
        assert_eq!(written(Units::Inch, 1.0), "0.0394");
        assert_eq!(written(Units::Inch, 0.001_27), "0.0001");
        assert_eq!(written(Units::Inch, 25.4e3 + 0.001_26), "1000.0");
    }

    #[test]
    fn signs_and_points_follow_the_format() {
        let signed = NumberFormat { least_decimals: 0, plus: true, ..FORMAT };
        let grid = Grid::lengths(Units::Mm, signed);
        let texts = [0.0, 10.0, -10.5, 0.001].map(|value| text(grid, value));
        assert_eq!(texts, ["+0", "+10", "-10.5", "+0.001"]);
        let whole = NumberFormat { decimals_mm: 0, ..FORMAT };
        assert_eq!(text(Grid::lengths(Units::Mm, whole), 120.4), "120");
        let three = NumberFormat { least_decimals: 3, ..FORMAT };
        assert_eq!(text(Grid::lengths(Units::Mm, three), 2.5), "2.500");
    }

    #[test]
    fn feeds_have_their_own_units() {
        let feed = |units, unit| text(Grid::feeds(units, FORMAT, unit), 254.0);
        assert_eq!(feed(Units::Mm, FeedUnit::PerMinute), "254.0");
        assert_eq!(feed(Units::Inch, FeedUnit::PerMinute), "10.0");
        assert_eq!(feed(Units::Mm, FeedUnit::PerSecond), "4.233");
        assert_eq!(feed(Units::Inch, FeedUnit::PerSecond), "0.1667");
        assert_eq!(feed(Units::Mm, FeedUnit::TenthInchPerMinute), "254.0");
        assert_eq!(feed(Units::Inch, FeedUnit::TenthInchPerMinute), "100.0");
    }

    /// Thousandths by way of the exact decimal expansion of a binary number; a finite expansion
    /// shorter than 60 places holds every number used here.
    fn exactly(value: f64) -> i64 {
        let text = format!("{:.60}", value.abs());
        let (whole, rest) = text.split_once('.').unwrap();
        let kept: i64 = format!("{whole}{}", &rest[..3]).parse().unwrap();
        let steps = kept + i64::from(rest.as_bytes()[3] >= b'5');
        if value < 0.0 { -steps } else { steps }
    }
}

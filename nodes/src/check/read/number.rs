//! Numbers in programs: digits with or without a sign and a point.

/// The largest power of ten that a float holds exactly.
const EXACT_POWERS: usize = 22;

/// The number that `text` begins with, and what comes behind it. `None` if it begins with none.
pub(super) fn number(text: &str) -> Option<(f64, &str)> {
    let bytes = text.as_bytes();
    let signed = matches!(bytes.first(), Some(b'+' | b'-'));
    let mut at = usize::from(signed);
    let (mut digits, mut decimals, mut point) = (0_u64, 0_usize, false);
    let begin = at;
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'0'..=b'9' => {
                // 18 digits are more than a float holds; a longer number is no coordinate.
                digits = digits.checked_mul(10)?.checked_add(u64::from(byte - b'0'))?;
                decimals += usize::from(point);
            }
            b'.' if !point => point = true,
            _ => break,
        }
        at += 1;
    }
    if at - begin == usize::from(point) || decimals > EXACT_POWERS {
        return None;
    }
    // Both are exact, so the quotient is the nearest float.
    let value = digits as f64 / 10_f64.powi(decimals as i32);
    let value = if bytes[0] == b'-' { -value } else { value };
    Some((value, &text[at..]))
}

/// `text` as a number and nothing else.
pub(super) fn whole(text: &str) -> Option<f64> {
    number(text).filter(|(_, rest)| rest.is_empty()).map(|(value, _)| value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_that_the_standard_library_reads() {
        let mut seed = 3_u64;
        for _ in 0..20_000 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let (whole_part, part) = ((seed >> 40) % 100_000, (seed >> 20) % 10_000);
            let sign = ["", "-", "+"][(seed >> 60) as usize % 3];
            let text = format!("{sign}{whole_part}.{part:04}");
            assert_eq!(whole(&text), text.parse().ok(), "{text}");
        }
        assert_eq!(number("-.5Y3"), Some((-0.5, "Y3")));
        assert_eq!(number("7.X"), Some((7.0, "X")));
    }

    #[test]
    fn what_is_no_number_is_none() {
        for text in ["", "-", ".", "+.", "X", "1e3", "123456789012345678901234567890"] {
            assert_eq!(whole(text), None, "{text}");
        }
    }
}

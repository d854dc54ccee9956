//! Program names and numbers out of a title, which is anybody's text.

/// The name of a program whose title has no letter or digit.
const NAMELESS: &str = "CARVEGRAPH";

/// Numbers that Fanuc and Haas keep for macros and may protect from being written.
const RESERVED: std::ops::RangeInclusive<u32> = 8000..=9999;

/// How many numbers a title is spread over: all below the reserved ones.
const SPREAD: u32 = 7999;

/// Upper case letters, digits and `_`, two letters first, at most `longest`: what Siemens,
/// Heidenhain and UCCNC all take for a name.
pub(crate) fn name(title: &str, longest: usize) -> String {
    let mut name = String::new();
    for character in title.chars() {
        match character.to_ascii_uppercase() {
            kept if kept.is_ascii_alphanumeric() => name.push(kept),
            _ if name.is_empty() || name.ends_with('_') => {}
            _ => name.push('_'),
        }
        if name.len() == longest {
            break;
        }
    }
    name.truncate(name.trim_end_matches('_').len());
    if name.is_empty() {
        name.push_str(NAMELESS);
    }
    let letters = name.bytes().take(2).filter(u8::is_ascii_alphabetic).count();
    if letters < 2 {
        name.insert_str(0, "CG_");
    }
    name.truncate(longest);
    name
}

/// A program number up to `limit`, none of the reserved ones: the title itself if it is one ("1234"
/// or "O1234"), otherwise one that only depends on the title.
pub(crate) fn number(title: &str, limit: u32) -> u32 {
    let title = title.trim();
    let own = title.strip_prefix(['O', 'o']).unwrap_or(title);
    let own = if own.bytes().all(|b| b.is_ascii_digit()) { own.parse().ok() } else { None };
    match own {
        Some(number) if number > 0 && number <= limit && !RESERVED.contains(&number) => number,
        _ => 1 + (fnv1a(title.as_bytes()) % u64::from(SPREAD.min(limit))) as u32,
    }
}

/// FNV-1a, 64 bits: small, and the same on every machine and for ever.
fn fnv1a(bytes: &[u8]) -> u64 {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_harmless_and_bounded() {
        assert_eq!(name("relief", 24), "RELIEF");
        assert_eq!(name("Mother's day, 2 mm", 24), "MOTHER_S_DAY_2_MM");
        assert_eq!(name("3D", 24), "CG_3D");
        assert_eq!(name(" \n%é", 24), NAMELESS);
        assert_eq!(name("_N_X\n%_N_Y_MPF", 24), "CG_N_X_N_Y_MPF");
        assert_eq!(name(&"x".repeat(1000), 24), "X".repeat(24));
        assert_eq!(name(&"7".repeat(1000), 8), "CG_77777");
    }

    #[test]
    fn numbers_are_the_titles_own_or_follow_from_it() {
        assert_eq!(number("1234", 7999), 1234);
        assert_eq!(number(" O0042 ", 7999), 42);
        assert_eq!(number("12345", 99_999), 12_345);
        assert_eq!(number("relief", 7999), number("relief", 99_999));
        assert_ne!(number("relief", 7999), number("portrait", 7999));
    }

    #[test]
    fn no_number_is_reserved_or_out_of_range() {
        let mut titles = vec!["0", "8000", "9999", "O9001", "12345", "99999999999", "", "O"];
        titles.extend(["relief", "é", "-5"]);
        for title in titles {
            for limit in [7999, 99_999] {
                let number = number(title, limit);
                assert!(number > 0 && number <= limit && !RESERVED.contains(&number), "{title}");
            }
        }
    }
}

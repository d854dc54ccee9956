//! Words of a block, and which of them a controller rejects.

/// The first of `rejects` (words, blanks between them) that stands in `block`. A single sign stands
/// for all words that begin with it; zeros before a number do not count: M06 is M6.
pub(crate) fn rejected<'r>(block: &str, rejects: &'r str) -> Option<&'r str> {
    if rejects.is_empty() {
        return None;
    }
    let words: Vec<String> = block.split_whitespace().flat_map(words).collect();
    rejects.split_whitespace().find(|rejected| {
        let plain = plain(rejected);
        words.iter().any(|word| *word == plain || plain.len() == 1 && word.starts_with(&plain))
    })
}

/// The words in what stands between blanks: `G17G21` is two, `CYCLE832(0.1)` one.
fn words(text: &str) -> Vec<String> {
    let is_number = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    let mut words: Vec<&str> = Vec::new();
    let mut rest = text;
    while let Some(letter) = rest.chars().next() {
        let numbered = rest[letter.len_utf8()..].find(|c| !is_number(c));
        let end = numbered.map_or(rest.len(), |at| at + letter.len_utf8());
        if !letter.is_ascii_alphabetic() || end == 1 {
            return vec![plain(text)];
        }
        words.push(&rest[..end]);
        rest = &rest[end..];
    }
    words.into_iter().map(plain).collect()
}

/// Upper case, without zeros before the number.
fn plain(word: &str) -> String {
    let word = word.to_ascii_uppercase();
    let digits = word.trim_start_matches(|c: char| c.is_ascii_alphabetic());
    let letters = &word[..word.len() - digits.len()];
    let short = digits.trim_start_matches('0');
    let zero =
        if short.starts_with(|c: char| c.is_ascii_digit()) || digits.is_empty() { "" } else { "0" };
    match digits.starts_with('0') {
        true => format!("{letters}{zero}{short}"),
        false => word,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_found_however_they_are_written() {
        let check = |block: &str, expected| {
            assert_eq!(rejected(block, "G43 M6 T % G0"), expected, "{block}")
        };
        check("G17 G21", None);
        check("G43 H1", Some("G43"));
        check("g17g43h1", Some("G43"));
        check("M06", Some("M6"));
        check("M60", None);
        check("G43.1", None);
        check("T12 D1", Some("T"));
        check("%", Some("%"));
        check("%NAME", Some("%"));
        check("G00 X1", Some("G0"));
        check("CYCLE832(0.01,1,1)", None);
        check("STOPRE", None);
        check("TRAORI", Some("T"));
        check("", None);
    }
}

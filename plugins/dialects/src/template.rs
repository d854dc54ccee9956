//! Lines with places for values: `T{tool} M6`.

/// `line` with each `{key}` replaced by `value(key)`. A key that has no value stays as it stands.
pub(crate) fn fill(line: &str, value: impl Fn(&str) -> Option<String>) -> String {
    let mut filled = String::with_capacity(line.len() + 16);
    let mut rest = line;
    while let Some((before, after)) = rest.split_once('{') {
        filled.push_str(before);
        let found = after.split_once('}').and_then(|(key, left)| Some((value(key)?, left)));
        let (text, left) = found.unwrap_or_else(|| ("{".to_owned(), after));
        filled.push_str(&text);
        rest = left;
    }
    filled.push_str(rest);
    filled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_become_values() {
        let value = |key: &str| (key == "tool").then(|| "7".to_owned());
        assert_eq!(fill("T{tool} M6", value), "T7 M6");
        assert_eq!(fill("G43 H{tool}{tool}", value), "G43 H77");
        assert_eq!(fill("{what} {tool", value), "{what} {tool");
        assert_eq!(fill("%", value), "%");
    }
}

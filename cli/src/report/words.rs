//! Facts, times and sizes as a person reads them.

use serde_json::Value as Json;

/// So many entries of a list are told; it may have thousands.
const MAX_LISTED: usize = 12;

/// So many letters of a text that is a fact.
const MAX_CHARS: usize = 300;

/// Endings of names that are units, longest first.
const UNITS: [(&str, &str); 7] = [
    ("_mm_per_min", "mm/min"),
    ("_per_s", "a second"),
    ("_mm", "mm"),
    ("_px", "px"),
    ("_rpm", "rpm"),
    ("_deg", "deg"),
    ("_s", "s"),
];

/// A fact's name and value in words: `("max_gouge_mm", 0.01)` is "max gouge", "0.01 mm".
pub(super) fn fact(name: &str, value: &Json) -> (String, String) {
    let unit = UNITS.iter().find(|(ending, _)| name.ends_with(ending) && name.len() > ending.len());
    let plain = unit.and_then(|(ending, _)| name.strip_suffix(ending)).unwrap_or(name);
    let unit = unit.map(|(_, unit)| *unit).unwrap_or_default();
    (plain.replace('_', " "), with_unit(value, unit))
}

fn with_unit(value: &Json, unit: &str) -> String {
    match value {
        Json::Null => "not known".to_owned(),
        Json::Array(values) if values.is_empty() => "none".to_owned(),
        Json::Array(values) => {
            let told: Vec<_> = values.iter().take(MAX_LISTED).map(|v| with_unit(v, unit)).collect();
            let more = values.len().saturating_sub(MAX_LISTED);
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            format!("{}{more}", told.join(", "))
        }
        Json::Number(number) => match (number.as_f64(), unit) {
            (Some(seconds), "s") => time(seconds),
            (Some(float), _) if number.is_f64() => format!("{} {unit}", short(float)),
            _ => format!("{number} {unit}"),
        }
        .trim_end()
        .to_owned(),
        Json::String(text) => clean(&cut(text)),
        other => clean(&cut(&other.to_string())),
    }
}

fn cut(text: &str) -> String {
    match text.char_indices().nth(MAX_CHARS) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// To a thousandth at most: 22.5, 180; small ones to three digits.
pub(super) fn short(value: f64) -> String {
    let text = match value.abs() {
        small if small > 0.0 && small < 0.01 => format!("{value:.5}"),
        _ => format!("{value:.3}"),
    };
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// "12.3 s", "41 min", "1 h 05 min". Whole minutes are rounded up.
pub(super) fn time(seconds: f64) -> String {
    let minutes = (seconds / 60.0).ceil();
    match seconds {
        brief if brief < 10.0 => format!("{} s", short(brief)),
        brief if brief < 90.0 => format!("{brief:.1} s"),
        _ if minutes < 60.0 => format!("{minutes} min"),
        _ => format!("{} h {:02} min", (minutes / 60.0).floor(), minutes % 60.0),
    }
}

/// "734 bytes", "3.4 MB".
pub(super) fn size(bytes: u64) -> String {
    match bytes {
        0..=9_999 => format!("{bytes} bytes"),
        10_000..=999_999 => format!("{:.0} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

/// Without what is no text: signs that control a terminal or turn the direction of reading.
pub(super) fn clean(text: &str) -> String {
    let is_harmless = |sign: char| {
        let turns = matches!(sign, '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        matches!(sign, '\n' | '\t') || !(sign.is_control() || turns)
    };
    let clean = |sign| if is_harmless(sign) { sign } else { '\u{fffd}' };
    text.replace("\r\n", "\n").chars().map(clean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[track_caller]
    fn assert_told(name: &str, value: Json, words: &str) {
        let (name, value) = fact(name, &value);
        assert_eq!(format!("{name}: {value}"), words);
    }

    #[test]
    fn units_stand_behind_their_numbers() {
        assert_told("max_gouge_mm", json!(0.0123), "max gouge: 0.012 mm");
        assert_told("max_below_mm", json!(0.00125), "max below: 0.00125 mm");
        assert_told("width_mm", json!(203.0), "width: 203 mm");
        assert_told("mean_feed_mm_per_min", json!(812.25), "mean feed: 812.25 mm/min");
        assert_told("time_s", json!(2460.0), "time: 41 min");
        assert_told("cl_points", json!(457_000), "cl points: 457000");
        assert_told("min_mm", json!([0.0, -1.5, 2]), "min: 0 mm, -1.5 mm, 2 mm");
        assert_told("s", json!(3), "s: 3");
        assert_told("tool", json!("ball_6"), "tool: ball_6");
        assert_told("materials", json!([]), "materials: none");
        assert_told("time_s", Json::Null, "time: not known");
    }

    #[test]
    fn long_lists_and_texts_are_cut() {
        let (_, listed) = fact("each", &json!((0..1000).collect::<Vec<_>>()));
        assert_eq!(listed, "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 988 more");
        let (_, text) = fact("text", &json!("ä".repeat(5000)));
        assert_eq!(text.chars().count(), MAX_CHARS + 1);
    }

    #[test]
    fn times_are_as_coarse_as_they_are_long() {
        let told = [0.0, 0.1234, 12.345, 89.0, 91.0, 3540.0, 3541.0, 5400.0].map(time);
        let words =
            ["0 s", "0.123 s", "12.3 s", "89.0 s", "2 min", "59 min", "1 h 00 min", "1 h 30 min"];
        assert_eq!(told, words);
    }

    #[test]
    fn nothing_that_controls_anything_is_left() {
        assert_eq!(clean("a\u{1b}[2Jb\u{202e}c\r\n\td\0"), "a\u{fffd}[2Jb\u{fffd}c\n\td\u{fffd}");
    }
}

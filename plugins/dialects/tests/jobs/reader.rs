//! A controller's side of the bargain: reads a program as strictly as GRBL 1.1 or LinuxCNC would,
//! and answers the moves it makes.

use super::Move;
use carvegraph_sdk::{Arc, Direction, Plane};
use std::collections::BTreeMap;

/// What a controller accepts.
pub(crate) struct Rules {
    pub(crate) codes: &'static [&'static str],
    pub(crate) letters: &'static str,
    pub(crate) line_limit: usize,
    pub(crate) arc_tolerance_mm: f64,
    pub(crate) arc_least_radius_mm: f64,
    pub(crate) end: &'static str,
}

pub(crate) fn rules(dialect: &str) -> Rules {
    match dialect {
        "grbl" => Rules {
            codes: &[
                "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G21", "G40", "G49",
                "G80", "G90", "G91.1", "G94", "M3", "M4", "M5", "M30",
            ],
            letters: "FGIJKMPSTXYZ",
            line_limit: 79,
            arc_tolerance_mm: 0.005,
            arc_least_radius_mm: 0.001,
            end: "M30",
        },
        _ => Rules {
            codes: &[
                "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G21", "G40", "G43",
                "G64", "G80", "G90", "G91.1", "G94", "M2", "M3", "M4", "M5", "M6",
            ],
            letters: "FGIJKMPQSTXYZ",
            line_limit: 255,
            arc_tolerance_mm: 0.028_2,
            arc_least_radius_mm: 0.001_27,
            end: "M2",
        },
    }
}

/// What the controller knows.
struct Machine {
    unit_mm: f64,
    motion: String,
    plane: Plane,
    feed: Option<f64>,
    at: [f64; 3],
    moves: Vec<Move>,
    ended: bool,
}

/// The moves of a program; the first position is unknown (NaN).
pub(crate) fn read(text: &str, rules: &Rules) -> Vec<Move> {
    let mut machine = Machine {
        unit_mm: f64::NAN,
        motion: String::new(),
        plane: Plane::Xy,
        feed: None,
        at: [f64::NAN; 3],
        moves: Vec::new(),
        ended: false,
    };
    assert!(text.ends_with('\n') && text.is_ascii());
    for line in text.lines() {
        assert!(!machine.ended, "{line:?} after the end");
        if let Some(comment) = line.strip_prefix('(') {
            check_comment(comment, line, rules);
        } else {
            let significant = line.bytes().filter(|&b| b != b' ').count();
            assert!(significant <= rules.line_limit, "{line:?}");
            machine.block(line, rules);
        }
    }
    assert!(machine.ended, "no {}", rules.end);
    machine.moves
}

/// One pair of brackets, nothing that acts, nothing that begins like an order.
fn check_comment(comment: &str, line: &str, rules: &Rules) {
    let inner = comment.strip_suffix(')').unwrap_or_else(|| panic!("{line:?}"));
    assert!(line.len() <= rules.line_limit, "{line:?}");
    assert!(!inner.contains(['(', ')', '!', '?', '~', ';', '$', '[', ']']), "{line:?}");
    assert!(inner.bytes().all(|b| (b' '..=b'~').contains(&b)), "{line:?}");
    assert!(inner.starts_with("- ") || inner.starts_with("Carvegraph: "), "{line:?}");
}

impl Machine {
    fn block(&mut self, line: &str, rules: &Rules) {
        let mut values = BTreeMap::new();
        let mut motion_now = None;
        for word in line.split(' ') {
            let letter = word.chars().next().unwrap();
            assert!(rules.letters.contains(letter), "{letter} in {line:?}");
            if "GM".contains(letter) {
                assert!(rules.codes.contains(&word), "{word} in {line:?}");
                self.code(word, rules, &mut motion_now);
            } else {
                let value = number(&word[1..], "TS".contains(letter), line);
                assert!(values.insert(letter, value).is_none(), "{letter} twice in {line:?}");
            }
        }
        if let Some(f) = values.remove(&'F') {
            assert!(f > 0.0, "{line:?}");
            self.feed = Some(f * self.unit_mm);
        }
        if values.keys().any(|l| "XYZ".contains(*l)) {
            self.motion(&values, line, rules);
        } else {
            assert!(motion_now.is_none(), "{line:?} moves nowhere");
        }
    }

    fn code(&mut self, word: &str, rules: &Rules, motion_now: &mut Option<()>) {
        match word {
            "G0" | "G1" | "G2" | "G3" => {
                self.motion = word.to_owned();
                *motion_now = Some(());
            }
            "G17" => self.plane = Plane::Xy,
            "G18" => self.plane = Plane::Zx,
            "G19" => self.plane = Plane::Yz,
            "G20" => self.unit_mm = 25.4,
            "G21" => self.unit_mm = 1.0,
            "M6" => self.at = [f64::NAN; 3],
            _ => self.ended |= word == rules.end,
        }
    }

    fn motion(&mut self, values: &BTreeMap<char, f64>, line: &str, rules: &Rules) {
        let mut to = self.at;
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if let Some(value) = values.get(&letter) {
                to[axis] = value * self.unit_mm;
            }
        }
        assert!(to != self.at || ["G2", "G3"].contains(&&*self.motion), "{line:?} stands still");
        let moved = match self.motion.as_str() {
            "G0" => {
                let (across, z) = (values.contains_key(&'X') || values.contains_key(&'Y'), 'Z');
                assert!(!(across && values.contains_key(&z)), "{line:?} is a diagonal rapid");
                Move::Rapid { to }
            }
            "G1" => Move::Feed { to, mm_per_min: self.feed.expect(line) },
            "G2" => self.arc(Direction::Clockwise, to, values, line, rules),
            "G3" => self.arc(Direction::CounterClockwise, to, values, line, rules),
            _ => panic!("{line:?} without a motion mode"),
        };
        if !matches!(moved, Move::Rapid { .. }) {
            assert!(self.at.iter().chain(&to).all(|c| c.is_finite()), "{line:?} from nowhere");
        }
        self.at = to;
        self.moves.push(moved);
    }

    fn arc(
        &self,
        direction: Direction,
        to: [f64; 3],
        values: &BTreeMap<char, f64>,
        line: &str,
        rules: &Rules,
    ) -> Move {
        let [first, second, _] = self.plane.axes();
        assert!(values.contains_key(&['X', 'Y', 'Z'][first]), "{line:?}");
        assert!(values.contains_key(&['X', 'Y', 'Z'][second]), "{line:?}");
        let mut center = self.at;
        for axis in [first, second] {
            center[axis] += values[&['I', 'J', 'K'][axis]] * self.unit_mm;
        }
        let radius = |p: [f64; 3]| (p[first] - center[first]).hypot(p[second] - center[second]);
        let (start, end) = (radius(self.at), radius(to));
        assert!((start - end).abs() <= rules.arc_tolerance_mm, "{line:?}: radii {start}, {end}");
        assert!(start.min(end) > rules.arc_least_radius_mm, "{line:?}");
        let mm_per_min = self.feed.expect(line);
        Move::Arc(Arc { plane: self.plane, direction, center, to, mm_per_min })
    }
}

fn number(text: &str, whole: bool, line: &str) -> f64 {
    let digits = text.strip_prefix('-').unwrap_or(text);
    let parts: Vec<&str> = digits.split('.').collect();
    let good = parts.len() == if whole { 1 } else { 2 }
        && parts.iter().all(|p| !p.is_empty() && p.bytes().all(|b| b.is_ascii_digit()));
    assert!(good, "{text} in {line:?}");
    let value: f64 = text.parse().unwrap();
    assert!(value != 0.0 || digits == text, "-0 in {line:?}");
    value
}

//! A controller's side of the bargain: reads a program of the word-address family as strictly as its
//! controller would, and answers the moves it makes.

use super::Move;
use carvegraph_sdk::{Arc, Direction, Plane};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// What a controller accepts.
#[derive(Clone, Copy)]
pub(crate) struct Rules {
    codes: &'static [&'static str],
    letters: &'static str,
    /// Letters whose numbers have no point.
    whole: &'static str,
    line_limit: usize,
    arc_tolerance_mm: f64,
    arc_least_radius_mm: f64,
    /// Beginnings of the lines before and after everything else.
    first: &'static [&'static str],
    last: &'static [&'static str],
    end: &'static str,
    comment: [&'static str; 2],
    /// What must not stand in a comment.
    harmful: &'static str,
    numbered: bool,
    /// Whether a motion word holds until the next.
    modal: bool,
    /// The largest angle of one arc, in degrees.
    sweep_limit: f64,
    /// Whether a tool's length is taken up in the block that moves Z.
    length_with_z: bool,
}

const COMMON: &str = "G0 G1 G2 G3 G4 G17 G90 G94 M3 M4 M5";

/// `COMMON` is not repeated in each dialect's list.
const USUAL: Rules = Rules {
    codes: &["G18", "G19", "G20", "G21", "G43", "M6", "M30"],
    letters: "FGHIJKMPSTXYZ",
    whole: "HST",
    line_limit: 79,
    arc_tolerance_mm: 0.005,
    arc_least_radius_mm: 0.001_27,
    first: &[],
    last: &[],
    end: "M30",
    comment: ["(", ")"],
    harmful: "()!?~;$[]{}\\<>|^`",
    numbered: false,
    modal: true,
    sweep_limit: 360.0,
    length_with_z: false,
};

pub(crate) fn rules(dialect: &str) -> Rules {
    match dialect {
        "grbl" => Rules {
            codes: &["G18", "G19", "G20", "G21", "M30"],
            letters: "FGIJKMPSXYZ",
            whole: "S",
            ..USUAL
        },
        "fluidnc" => Rules {
            codes: &["G18", "G19", "G20", "G21", "M6", "M30"],
            letters: "FGIJKMPSTXYZ",
            line_limit: 255,
            ..USUAL
        },
        "linuxcnc" => Rules {
            codes: &["G18", "G19", "G20", "G21", "G40", "G43", "G64", "G80", "G91.1", "M2", "M6"],
            letters: "FGIJKMPQSTXYZ",
            line_limit: 255,
            arc_tolerance_mm: 0.028_2,
            end: "M2",
            ..USUAL
        },
        "mach3" => Rules {
            codes: &[
                "G18", "G19", "G20", "G21", "G40", "G43", "G49", "G64", "G80", "G91.1", "M6", "M30",
            ],
            ..USUAL
        },
        "fanuc" => Rules {
            codes: &["G18", "G19", "G20", "G21", "G40", "G43", "G80", "M6", "M30"],
            whole: "HPST",
            first: &["%", "O"],
            last: &["%"],
            harmful: "()!?~;$[]{}\\<>|^`%:#@&'\"_",
            sweep_limit: 180.0,
            length_with_z: true,
            ..USUAL
        },
        "haas" => Rules {
            codes: &["G18", "G19", "G20", "G21", "G40", "G43", "G80", "G187", "M6", "M30"],
            letters: "EFGHIJKMPSTXYZ",
            ..rules("fanuc")
        },
        "siemens" => Rules {
            codes: &["G18", "G19", "G40", "G700", "G710", "M6", "M30"],
            letters: "DFGIJKMSTXYZ",
            whole: "DST",
            line_limit: 512,
            first: &["; %_N_"],
            comment: ["; ", ""],
            numbered: true,
            ..USUAL
        },
        "marlin" => Rules {
            codes: &["G20", "G21"],
            letters: "FGIJMPSXYZ",
            whole: "PS",
            line_limit: 95,
            end: "M5",
            comment: ["; ", ""],
            modal: false,
            ..USUAL
        },
        "uccnc" => Rules {
            codes: &["G20", "G21", "G40", "G43", "G80", "G91.1", "M6", "M30"],
            first: &["%"],
            harmful: "()!?~;$[]{}\\<>|^`%",
            ..USUAL
        },
        "iso6983" => USUAL,
        _ => panic!("no rules for {dialect}"),
    }
}

/// What the controller knows.
struct Machine<'a> {
    rules: &'a Rules,
    unit_mm: f64,
    motion: String,
    plane: Plane,
    feed: Option<f64>,
    at: [f64; 3],
    tool: f64,
    /// A tool was changed and its length is not taken up.
    length_missing: bool,
    incremental: bool,
    /// Whether Z was sent to the top.
    high: bool,
    moves: Vec<Move>,
    ended: bool,
}

/// The moves of a program; a position that is unknown is NaN.
pub(crate) fn read(text: &str, rules: &Rules) -> Vec<Move> {
    assert!(text.ends_with('\n') && text.is_ascii());
    let lines: Vec<&str> = text.lines().collect();
    let (first, lines) = lines.split_at(rules.first.len());
    let (lines, last) = lines.split_at(lines.len() - rules.last.len());
    for (line, begin) in first.iter().zip(rules.first).chain(last.iter().zip(rules.last)) {
        check_frame(line, begin);
    }
    let mut machine = Machine {
        rules,
        unit_mm: f64::NAN,
        motion: String::new(),
        plane: Plane::Xy,
        feed: None,
        at: [f64::NAN; 3],
        tool: f64::NAN,
        length_missing: false,
        incremental: false,
        high: false,
        moves: Vec::new(),
        ended: false,
    };
    let mut number = 0;
    for line in lines {
        assert!(line.len() <= rules.line_limit, "{line:?}");
        assert!(!machine.ended || rules.end == "M5", "{line:?} after the end");
        machine.ended = false;
        if let Some(comment) = line.strip_prefix(rules.comment[0]) {
            check_comment(comment, line, rules);
            continue;
        }
        let mut block = *line;
        if rules.numbered {
            let (n, rest) = line.split_once(' ').unwrap();
            number += 10;
            assert_eq!(n, format!("N{number}"));
            block = rest;
        }
        machine.block(block);
    }
    assert!(machine.ended, "no {}", rules.end);
    machine.moves
}

/// A line that is no block: `%`, a program number or a name.
fn check_frame(line: &str, begin: &str) {
    let rest = line.strip_prefix(begin).unwrap_or_else(|| panic!("{line:?} for {begin:?}"));
    match begin {
        "O" => {
            let number: u32 = rest.parse().unwrap();
            assert!((4..=5).contains(&rest.len()) && number > 0, "{line:?}");
            assert!(!(8000..=9999).contains(&number), "{line:?} is reserved");
        }
        _ => assert!(
            rest.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_'),
            "{line:?}"
        ),
    }
}

/// Closed where it must be, nothing that acts, nothing that begins like an order.
fn check_comment(comment: &str, line: &str, rules: &Rules) {
    let inner = comment.strip_suffix(rules.comment[1]).unwrap_or_else(|| panic!("{line:?}"));
    assert!(!inner.contains(|c| rules.harmful.contains(c)), "{line:?}");
    assert!(inner.bytes().all(|b| (b' '..=b'~').contains(&b)), "{line:?}");
    let upper = rules.harmful.contains(':');
    assert!(!upper || !inner.contains(|c: char| c.is_ascii_lowercase()), "{line:?}");
    let marks = ["- ", "Carvegraph: ", "CARVEGRAPH "];
    assert!(marks.iter().any(|mark| inner.starts_with(mark)), "{line:?}");
}

impl Machine<'_> {
    fn block(&mut self, line: &str) {
        match line {
            "G91 G28 Z0.0" => {
                self.incremental = true;
                self.high = true;
                self.at[2] = f64::NAN;
                return;
            }
            "G53 G0 Z0.0" => {
                self.high = true;
                self.at[2] = f64::NAN;
                self.motion = "G0".to_owned();
                return;
            }
            "G90" => self.incremental = false,
            _ => {}
        }
        assert!(!self.incremental, "{line:?} in G91");
        if let Some(tolerance) = line.strip_prefix("CYCLE832(") {
            assert!(self.rules.numbered && tolerance.ends_with(",1,1)"), "{line:?}");
            number(tolerance.strip_suffix(",1,1)").unwrap(), false, line);
            return;
        }
        let rules = self.rules;
        let dwell = line.starts_with("G4 ");
        let mut values = BTreeMap::new();
        let mut motion_now = false;
        let mut lengths_now = false;
        for word in line.split(' ') {
            let letter = word.chars().next().unwrap();
            assert!(rules.letters.contains(letter), "{letter} in {line:?}");
            if "GM".contains(letter) {
                let known = rules.codes.contains(&word) || COMMON.split(' ').any(|c| c == word);
                assert!(known, "{word} in {line:?}");
                motion_now |= ["G0", "G1", "G2", "G3"].contains(&word);
                lengths_now |= word == "G43";
                self.code(word, line);
            } else {
                // Smoothness is a level, not a time.
                let whole =
                    rules.whole.contains(letter) || line.starts_with("G187 P3 ") && letter == 'P';
                let value = number(&word[1..], whole, line);
                assert!(values.insert(letter, value).is_none(), "{letter} twice in {line:?}");
            }
        }
        if dwell {
            let time = ['P', 'F'].iter().find_map(|l| values.get(l)).expect(line);
            assert!(*time >= 0.0 && values.len() == 1, "{line:?}");
            return;
        }
        if let Some(tool) = values.get(&'T') {
            self.tool = *tool;
        }
        if lengths_now && rules.letters.contains('H') {
            assert_eq!(values.remove(&'H'), Some(self.tool), "{line:?}");
            assert_eq!(values.contains_key(&'Z'), rules.length_with_z, "{line:?}");
        }
        self.length_missing &= !(lengths_now || line == "D1");
        if let Some(f) = values.remove(&'F') {
            assert!(f > 0.0, "{line:?}");
            self.feed = Some(f * self.unit_mm);
        }
        if values.keys().any(|l| "XYZ".contains(*l)) {
            assert!(motion_now || rules.modal, "{line:?} forgets its motion");
            self.motion(&values, line);
        } else {
            assert!(!motion_now, "{line:?} moves nowhere");
        }
    }

    fn code(&mut self, word: &str, line: &str) {
        match word {
            "G0" | "G1" | "G2" | "G3" => word.clone_into(&mut self.motion),
            "G17" => self.plane = Plane::Xy,
            "G18" => self.plane = Plane::Zx,
            "G19" => self.plane = Plane::Yz,
            "G20" | "G700" => self.unit_mm = 25.4,
            "G21" | "G710" => self.unit_mm = 1.0,
            "M6" => {
                assert!(self.high || !self.rules.length_with_z, "{line:?} down in the work");
                self.at = [f64::NAN; 3];
                // A macro may have left any plane.
                self.plane = Plane::Yz;
                let codes = self.rules.codes;
                self.length_missing = codes.contains(&"G43") || self.rules.letters.contains('D');
            }
            _ => {}
        }
        self.ended = word == self.rules.end && line == word;
    }

    fn motion(&mut self, values: &BTreeMap<char, f64>, line: &str) {
        let mut to = self.at;
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if let Some(value) = values.get(&letter) {
                to[axis] = value * self.unit_mm;
            }
        }
        assert!(to != self.at || ["G2", "G3"].contains(&&*self.motion), "{line:?} stands still");
        assert!(!(self.length_missing && values.contains_key(&'Z')), "{line:?} without its length");
        let moved = match self.motion.as_str() {
            "G0" => {
                let (across, z) = (values.contains_key(&'X') || values.contains_key(&'Y'), 'Z');
                assert!(!(across && values.contains_key(&z)), "{line:?} is a diagonal rapid");
                let blind = across && self.at[2].is_nan();
                assert!(self.high || !blind, "{line:?} at an unknown height");
                self.high &= across;
                Move::Rapid { to }
            }
            "G1" => Move::Feed { to, mm_per_min: self.feed.expect(line) },
            "G2" => self.arc(Direction::Clockwise, to, values, line),
            "G3" => self.arc(Direction::CounterClockwise, to, values, line),
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
        let tolerance = self.rules.arc_tolerance_mm;
        assert!((start - end).abs() <= tolerance, "{line:?}: radii {start}, {end}");
        assert!(start.min(end) > self.rules.arc_least_radius_mm, "{line:?}");
        let mm_per_min = self.feed.expect(line);
        let arc = Arc { plane: self.plane, direction, center, to, mm_per_min };
        assert!(sweep(&arc, self.at) <= self.rules.sweep_limit.to_radians() + 1e-9, "{line:?}");
        Move::Arc(arc)
    }
}

/// The angle that a controller turns an arc through; a full turn where it ends at its start.
pub(crate) fn sweep(arc: &Arc, from: [f64; 3]) -> f64 {
    let [first, second, _] = arc.plane.axes();
    if from[first] == arc.to[first] && from[second] == arc.to[second] {
        return TAU;
    }
    let angle = |p: [f64; 3]| (p[second] - arc.center[second]).atan2(p[first] - arc.center[first]);
    let sign = if arc.direction == Direction::Clockwise { -1.0 } else { 1.0 };
    (sign * (angle(arc.to) - angle(from))).rem_euclid(TAU)
}

pub(crate) fn number(text: &str, whole: bool, line: &str) -> f64 {
    let digits = text.strip_prefix('-').unwrap_or(text);
    let parts: Vec<&str> = digits.split('.').collect();
    let good = parts.len() == if whole { 1 } else { 2 }
        && parts.iter().all(|p| !p.is_empty() && p.bytes().all(|b| b.is_ascii_digit()));
    assert!(good && parts.get(1).is_none_or(|p| p.len() <= 4), "{text} in {line:?}");
    let value: f64 = text.parse().unwrap();
    assert!(value != 0.0 || digits == text, "-0 in {line:?}");
    value
}

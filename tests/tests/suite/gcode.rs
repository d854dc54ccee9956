//! A program read as a machine reads it: block by block, with what is in force.

use std::fmt;

/// How a machine moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Motion {
    Rapid,
    Feed,
}

/// One move, in mm and mm/min whatever the program's units are. `from` is unknown on the axes that
/// no block has named yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Move {
    pub(crate) line: usize,
    pub(crate) motion: Motion,
    pub(crate) from: [Option<f64>; 3],
    pub(crate) to: [Option<f64>; 3],
    pub(crate) mm_per_min: Option<f64>,
    pub(crate) spindle_on: bool,
}

impl Move {
    /// Whether it moves along X or Y.
    pub(crate) fn travels(&self) -> bool {
        self.from[..2] != self.to[..2]
    }

    pub(crate) fn z(&self) -> f64 {
        self.to[2].unwrap_or_else(|| panic!("no Z before {self}"))
    }

    pub(crate) fn point(&self) -> [f64; 3] {
        self.to.map(|axis| axis.unwrap_or_else(|| panic!("an axis is unknown at {self}")))
    }
}

impl fmt::Display for Move {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {:?} to {:?}", self.line, self.motion, self.to)
    }
}

/// What a program makes a machine do.
#[derive(Debug)]
pub(crate) struct Program {
    pub(crate) moves: Vec<Move>,
    pub(crate) inches: bool,
    /// Whether the spindle still turns when the program ends.
    pub(crate) spindle_left_on: bool,
    /// The block that ends it.
    pub(crate) end: String,
}

/// Reads a program; panics at whatever a strict controller would not take.
pub(crate) fn read(text: &str) -> Program {
    let mut reader = Reader::default();
    for (at, line) in text.lines().enumerate() {
        reader.block(at + 1, line);
    }
    assert!(!reader.end.is_empty(), "the program does not end");
    Program {
        moves: reader.moves,
        inches: reader.inches.expect("neither G20 nor G21"),
        spindle_left_on: reader.spindle_on,
        end: reader.end,
    }
}

#[derive(Default)]
struct Reader {
    moves: Vec<Move>,
    motion: Option<Motion>,
    at: [Option<f64>; 3],
    feed: Option<f64>,
    inches: Option<bool>,
    absolute: bool,
    spindle_on: bool,
    end: String,
}

impl Reader {
    fn block(&mut self, line: usize, text: &str) {
        assert!(text.is_ascii() && text.len() <= 79, "line {line}: {text:?}");
        assert!(self.end.is_empty(), "line {line} stands behind the end: {text:?}");
        if text.starts_with('(') {
            let inside = text.strip_suffix(')').unwrap_or_else(|| panic!("line {line}: {text:?}"));
            assert!(!inside[1..].contains(['(', ')']), "line {line}: {text:?}");
            return;
        }
        let mut to = self.at;
        let mut moves = false;
        let mut dwells = false;
        let scale = if self.inches == Some(true) { 25.4 } else { 1.0 };
        for word in text.split(' ') {
            let (letter, number) = word.split_at(1);
            let value: f64 = number.parse().unwrap_or_else(|_| panic!("line {line}: {text:?}"));
            assert!(
                value.is_finite() && !number.contains(['e', 'E', '+']),
                "line {line}: {text:?}"
            );
            match (letter, number) {
                ("G", "0") => self.motion = Some(Motion::Rapid),
                ("G", "1") => self.motion = Some(Motion::Feed),
                ("G", "4") => dwells = true,
                ("G", "20") => self.inches = Some(true),
                ("G", "21") => self.inches = Some(false),
                ("G", "90") => self.absolute = true,
                ("G", "17" | "40" | "64" | "80" | "91.1" | "94") => {}
                ("M", "3") => self.spindle_on = true,
                ("M", "5") => self.spindle_on = false,
                ("M", "2" | "30") => text.clone_into(&mut self.end),
                ("S" | "Q", _) => assert!(value > 0.0, "line {line}: {text:?}"),
                ("P", _) => assert!(value > 0.0, "line {line}: {text:?}"),
                ("F", _) => {
                    assert!(value > 0.0, "line {line}: {text:?}");
                    self.feed = Some(value * scale);
                }
                ("X" | "Y" | "Z", _) => {
                    moves = true;
                    to["XYZ".find(letter).unwrap()] = Some(value * scale);
                }
                _ => panic!("line {line}: {word:?} is not known: {text:?}"),
            }
        }
        if moves && !dwells {
            self.move_to(line, to);
        }
    }

    fn move_to(&mut self, line: usize, to: [Option<f64>; 3]) {
        assert!(self.absolute && self.inches.is_some(), "line {line}: a move before G90 or G21");
        let motion = self.motion.unwrap_or_else(|| panic!("line {line}: no motion in force"));
        let (from, mm_per_min, spindle_on) = (self.at, self.feed, self.spindle_on);
        self.moves.push(Move { line, motion, from, to, mm_per_min, spindle_on });
        self.at = to;
    }
}

//! A controller's side of the bargain: reads a program of the word-address family as strictly as its
//! controller would, and answers the moves it makes.

use super::{Centers, Fault, Move, Reading, ensure};
use crate::{Arc, Direction, Plane};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// What a program does.
#[derive(Debug, Default)]
pub(super) struct Heard {
    pub(super) moves: Vec<Move>,
    pub(super) dwells_s: Vec<f64>,
}

/// The moves of a program; a position that is not known is NaN.
///
/// # Errors
/// What the controller would complain of.
pub fn read(text: &str, reading: &Reading) -> Result<Vec<Move>, String> {
    Ok(hear(text, reading)?.moves)
}

pub(super) fn hear(text: &str, reading: &Reading) -> Fault<Heard> {
    if let Some(read) = reading.read {
        return Ok(Heard { moves: read(text), dwells_s: Vec::new() });
    }
    ensure(text.ends_with('\n') && text.is_ascii(), || "it is no text of ASCII lines".to_owned())?;
    let lines: Vec<&str> = text.lines().collect();
    let (first, last) = (reading.first.len(), reading.last.len());
    ensure(lines.len() >= first + last, || format!("it has only {} lines", lines.len()))?;
    let (head, lines) = lines.split_at(first);
    let (lines, tail) = lines.split_at(lines.len() - last);
    let begins = reading.first.iter().chain(reading.last);
    head.iter().chain(tail).zip(begins).try_for_each(|(line, begin)| frame(line, begin))?;
    let mut machine = Machine::new(reading);
    lines
        .iter()
        .try_for_each(|line| machine.line(line).map_err(|fault| format!("{line:?}: {fault}")))?;
    ensure(machine.ended, || format!("it does not end with {}", reading.end))?;
    Ok(machine.heard)
}

/// A line that is no block: `%`, a program number or a name.
fn frame(line: &str, begin: &str) -> Fault {
    let Some(rest) = line.strip_prefix(begin) else {
        return Err(format!("{line:?} stands where a line with {begin:?} must"));
    };
    if begin == "O" {
        let number: u32 = rest.parse().unwrap_or(0);
        let good = (4..=5).contains(&rest.len()) && number > 0 && !(8000..=9999).contains(&number);
        return ensure(good, || format!("{line:?} is no program number, or a reserved one"));
    }
    let plain = |b: u8| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_';
    ensure(rest.bytes().all(plain), || format!("{line:?} is no name"))
}

/// What the controller knows.
struct Machine<'a> {
    reading: &'a Reading,
    unit_mm: f64,
    motion: Option<String>,
    plane: Plane,
    feed: Option<f64>,
    at: [f64; 3],
    tool: f64,
    /// A tool was changed and its length is not taken up.
    length_missing: bool,
    incremental: bool,
    /// Whether Z was sent to the top.
    high: bool,
    /// Whether the spindle was stopped and not started again.
    stopped: bool,
    number: u32,
    heard: Heard,
    ended: bool,
}

/// The words of a block: its codes in order, and the values of its other letters.
struct Block<'l> {
    codes: Vec<String>,
    values: BTreeMap<char, f64>,
    line: &'l str,
}

impl Block<'_> {
    fn has(&self, code: &str) -> bool {
        self.codes.iter().any(|c| c == code)
    }
}

impl<'a> Machine<'a> {
    fn new(reading: &'a Reading) -> Self {
        Self {
            reading,
            unit_mm: f64::NAN,
            motion: None,
            plane: Plane::Xy,
            feed: None,
            at: [f64::NAN; 3],
            tool: f64::NAN,
            length_missing: false,
            incremental: false,
            high: false,
            stopped: false,
            number: 0,
            heard: Heard::default(),
            ended: false,
        }
    }

    fn line(&mut self, line: &str) -> Fault {
        let reading = self.reading;
        ensure(line.len() <= reading.line_limit, || format!("{} characters", line.len()))?;
        // M5 alone ends a program only where nothing follows.
        ensure(!self.ended || reading.end == "M5", || "it stands after the end".to_owned())?;
        self.ended = false;
        if !reading.comment[0].is_empty()
            && let Some(comment) = line.strip_prefix(reading.comment[0])
        {
            return comment_is_harmless(comment, reading);
        }
        let block = self.without_number(line)?;
        if reading.top.contains(&block) {
            self.incremental = block.contains("G91");
            self.motion = block.contains("G0").then(|| "G0".to_owned());
            self.high = true;
            self.at[2] = f64::NAN;
            return Ok(());
        }
        if reading.ignored.iter().any(|begin| block.starts_with(begin)) {
            return Ok(());
        }
        let block = words(block, reading, self.unit_mm)?;
        self.block(block)
    }

    fn without_number<'l>(&mut self, line: &'l str) -> Fault<&'l str> {
        let Some((letter, step)) = self.reading.numbered else { return Ok(line) };
        self.number += step;
        let begin = format!("{letter}{} ", self.number);
        line.strip_prefix(begin.as_str()).ok_or_else(|| format!("it must begin with {begin:?}"))
    }

    fn block(&mut self, mut block: Block<'_>) -> Fault {
        if block.has("G4") {
            let (letter, per_second) = self.reading.dwell;
            let time = block.values.get(&letter).filter(|_| block.values.len() == 1);
            let time = time.ok_or_else(|| format!("a dwell has {letter} and nothing else"))?;
            ensure(*time >= 0.0, || "a dwell is negative".to_owned())?;
            self.heard.dwells_s.push(time / per_second);
            return Ok(());
        }
        self.incremental &= !block.has("G90");
        ensure(!self.incremental, || "G91 is in force".to_owned())?;
        if let Some(tool) = block.values.get(&'T') {
            self.tool = *tool;
        }
        self.codes(&block)?;
        self.length(&mut block)?;
        if let Some(f) = block.values.remove(&'F') {
            ensure(f > 0.0, || "a feed is above 0".to_owned())?;
            self.feed = Some(f * self.unit_mm);
        }
        let moves = block.values.keys().any(|letter| "XYZ".contains(*letter));
        let named = block.codes.iter().any(|code| MOTIONS.contains(&code.as_str()));
        if !moves {
            return ensure(!named, || "it moves nowhere".to_owned());
        }
        ensure(named || self.reading.modal, || "it forgets its motion".to_owned())?;
        self.motion(&block)
    }

    fn codes(&mut self, block: &Block<'_>) -> Fault {
        for code in &block.codes {
            match code.as_str() {
                "G0" | "G1" | "G2" | "G3" => self.motion = Some(code.clone()),
                "G17" => self.plane = Plane::Xy,
                "G18" => self.plane = Plane::Zx,
                "G19" => self.plane = Plane::Yz,
                "M3" | "M4" => self.stopped = false,
                "M5" => self.stopped = true,
                "M6" => self.tool_change()?,
                _ => {}
            }
            match self.reading.units.iter().position(|units| code == units) {
                Some(0) => self.unit_mm = 1.0,
                Some(_) => self.unit_mm = 25.4,
                None => {}
            }
            self.ended = *code == self.reading.end && block.line == code;
        }
        Ok(())
    }

    fn tool_change(&mut self) -> Fault {
        let safe = self.high || !self.reading.starts_high;
        ensure(safe, || "the tool is changed down in the work".to_owned())?;
        self.at = [f64::NAN; 3];
        // A macro may have left any plane.
        self.plane = Plane::Yz;
        self.stopped = true;
        self.length_missing = !self.reading.length.is_empty();
        Ok(())
    }

    /// What takes up a tool's length.
    fn length(&mut self, block: &mut Block<'_>) -> Fault {
        let taken = |word: &&str| match word.split_at(1) {
            ("D" | "H", number) => {
                block.values.get(&word.chars().next().unwrap_or('D')).copied()
                    == number.parse().ok()
            }
            _ => block.has(word),
        };
        if !self.reading.length.iter().any(taken) {
            return Ok(());
        }
        self.length_missing = false;
        if let Some(number) = block.values.remove(&'H') {
            let tool = self.tool;
            ensure(number == tool, || format!("it takes up the length of another than {tool}"))?;
        }
        let with_z = block.values.contains_key(&'Z') == self.reading.length_with_z;
        ensure(with_z, || "the length is taken up in the wrong block".to_owned())
    }

    fn motion(&mut self, block: &Block<'_>) -> Fault {
        let values = &block.values;
        let mut to = self.at;
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if let Some(value) = values.get(&letter) {
                to[axis] = value * self.unit_mm;
            }
        }
        let motion = self.motion.clone().ok_or("there is no motion in force")?;
        let turns = ["G2", "G3"].contains(&motion.as_str());
        ensure(to != self.at || turns, || "it stands still".to_owned())?;
        let ready = !(self.length_missing && values.contains_key(&'Z'));
        ensure(ready, || "the tool's length is not taken up".to_owned())?;
        let moved = match motion.as_str() {
            "G0" => self.rapid(values, to)?,
            "G1" => Move::Feed { to, mm_per_min: self.feed()? },
            "G2" => self.arc(Direction::Clockwise, to, values)?,
            _ => self.arc(Direction::CounterClockwise, to, values)?,
        };
        if !matches!(moved, Move::Rapid { .. }) {
            let known = self.at.iter().chain(&to).all(|c| c.is_finite());
            ensure(known, || "it cuts from nowhere".to_owned())?;
            ensure(!self.stopped, || "it cuts with the spindle stopped".to_owned())?;
        }
        self.at = to;
        self.heard.moves.push(moved);
        Ok(())
    }

    fn rapid(&mut self, values: &BTreeMap<char, f64>, to: [f64; 3]) -> Fault<Move> {
        let across = values.contains_key(&'X') || values.contains_key(&'Y');
        let diagonal = across && values.contains_key(&'Z');
        ensure(!diagonal, || "a rapid moves Z and XY at once".to_owned())?;
        let blind = across && self.at[2].is_nan() && !self.high;
        ensure(!blind, || "it travels at an unknown height".to_owned())?;
        self.high &= across;
        Ok(Move::Rapid { to })
    }

    fn feed(&self) -> Fault<f64> {
        self.feed.ok_or_else(|| "there is no feed in force".to_owned())
    }

    fn arc(&self, direction: Direction, to: [f64; 3], values: &BTreeMap<char, f64>) -> Fault<Move> {
        let [first, second, _] = self.plane.axes();
        let both = [first, second].iter().all(|&axis| values.contains_key(&['X', 'Y', 'Z'][axis]));
        ensure(both, || "an arc gives both axes of its plane".to_owned())?;
        let center = self.center(direction, to, values)?;
        let radius = |p: [f64; 3]| (p[first] - center[first]).hypot(p[second] - center[second]);
        let (start, end) = (radius(self.at), radius(to));
        let can = &self.reading.arcs;
        let agree = (start - end).abs() <= can.tolerance_mm;
        ensure(agree, || format!("its radii are {start} and {end} mm"))?;
        ensure(start.min(end) > can.least_radius_mm, || format!("its radius is {start} mm"))?;
        let arc = Arc { plane: self.plane, direction, center, to, mm_per_min: self.feed()? };
        let turned = sweep(&arc, self.at).to_degrees();
        ensure(turned <= can.sweep_limit_deg + 1e-7, || {
            format!("it turns through {turned} degrees")
        })?;
        Ok(Move::Arc(arc))
    }

    fn center(
        &self,
        direction: Direction,
        to: [f64; 3],
        values: &BTreeMap<char, f64>,
    ) -> Fault<[f64; 3]> {
        let [first, second, _] = self.plane.axes();
        let mut center = self.at;
        if self.reading.arcs.centers == Centers::Radius {
            let radius = values.get(&'R').ok_or("an arc has an R")? * self.unit_mm;
            let half = [first, second].map(|axis| (to[axis] - self.at[axis]) / 2.0);
            let chord = half[0].hypot(half[1]);
            ensure(chord > 0.0, || "a full circle cannot be given by its radius".to_owned())?;
            let height = (radius * radius - chord * chord).max(0.0).sqrt() / chord;
            let side = if direction == Direction::Clockwise { -height } else { height };
            center[first] += half[0] - side * half[1];
            center[second] += half[1] + side * half[0];
            return Ok(center);
        }
        for axis in [first, second] {
            let letter = ['I', 'J', 'K'][axis];
            let value = values.get(&letter).ok_or_else(|| format!("an arc has an {letter}"))?;
            match self.reading.arcs.centers {
                Centers::Absolute => center[axis] = value * self.unit_mm,
                _ => center[axis] += value * self.unit_mm,
            }
        }
        Ok(center)
    }
}

const MOTIONS: [&str; 4] = ["G0", "G1", "G2", "G3"];

/// Closed where it must be, nothing that acts, nothing that begins like an order.
fn comment_is_harmless(comment: &str, reading: &Reading) -> Fault {
    let Reading { comment: [_, close], harmful, marks, .. } = reading;
    let inner = comment.strip_suffix(close).ok_or_else(|| format!("it lacks {close:?}"))?;
    let harm = inner.chars().find(|c| harmful.contains(*c) || !(' '..='~').contains(c));
    ensure(harm.is_none(), || format!("a comment must not hold {harm:?}"))?;
    let marked = marks.is_empty() || marks.iter().any(|mark| inner.starts_with(mark));
    ensure(marked, || format!("a comment must begin with one of {marks:?}"))
}

/// Takes a block apart.
fn words<'l>(line: &'l str, reading: &Reading, unit_mm: f64) -> Fault<Block<'l>> {
    let mut block = Block { codes: Vec::new(), values: BTreeMap::new(), line };
    let mut rest = line.trim_start();
    while let Some(letter) = rest.chars().next() {
        let known = reading.letters.contains(letter);
        ensure(known, || format!("{letter} is no letter for a word"))?;
        let length = rest[1..].find(|c: char| !c.is_ascii_digit() && !"+-.".contains(c));
        let (text, left) = rest[1..].split_at(length.unwrap_or(rest.len() - 1));
        if "GM".contains(letter) {
            block.codes.push(code(letter, text, reading)?);
        } else {
            let whole = reading.whole.contains(letter);
            let inch = unit_mm == 25.4;
            let decimals = reading.decimals[usize::from(inch)];
            let value = number(text, whole, decimals)?;
            let twice = block.values.insert(letter, value).is_some();
            ensure(!twice, || format!("{letter} stands there twice"))?;
        }
        rest = left.trim_start();
    }
    Ok(block)
}

/// A G or M word without zeros before its number.
fn code(letter: char, number: &str, reading: &Reading) -> Fault<String> {
    let short = number.trim_start_matches('0');
    let zero = if short.starts_with(|c: char| c.is_ascii_digit()) { "" } else { "0" };
    let code = format!("{letter}{zero}{short}");
    let known = reading.codes.is_none_or(|codes| codes.contains(&code.as_str()));
    ensure(known && !number.is_empty(), || format!("{code} is no word that it takes"))?;
    Ok(code)
}

/// The angle that a controller turns an arc through; a full turn where it ends at its start.
#[must_use]
pub fn sweep(arc: &Arc, from: [f64; 3]) -> f64 {
    let [first, second, _] = arc.plane.axes();
    if from[first] == arc.to[first] && from[second] == arc.to[second] {
        return TAU;
    }
    let angle = |p: [f64; 3]| (p[second] - arc.center[second]).atan2(p[first] - arc.center[first]);
    let sign = if arc.direction == Direction::Clockwise { -1.0 } else { 1.0 };
    let turned = (sign * (angle(arc.to) - angle(from))).rem_euclid(TAU);
    // Half a turn by its radius comes out on either side of it.
    if (turned - PI).abs() < 1e-9 { PI } else { turned }
}

/// A number as strict controllers take it: whole or with its point, digits on both sides of it, no
/// more than `decimals`, and no minus before nothing.
///
/// # Errors
/// If it is none.
pub fn number(text: &str, whole: bool, decimals: usize) -> Result<f64, String> {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    let parts: Vec<&str> = digits.split('.').collect();
    let good = parts.len() == if whole { 1 } else { 2 }
        && parts.iter().all(|p| !p.is_empty() && p.bytes().all(|b| b.is_ascii_digit()));
    let wanted = if whole { "without a point" } else { "with a point" };
    ensure(good, || format!("{text:?} is no number {wanted}"))?;
    let fits = parts.get(1).is_none_or(|part| part.len() <= decimals);
    ensure(fits, || format!("{text:?} has more than {decimals} decimals"))?;
    let value: f64 = text.parse().map_err(|_| format!("{text:?} is no number"))?;
    ensure(value != 0.0 || !text.starts_with('-'), || format!("{text:?} is minus nothing"))?;
    Ok(value)
}

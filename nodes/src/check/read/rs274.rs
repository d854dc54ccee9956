//! Word addresses: RS-274/NGC as Kramer, Proctor and Messina give it (*The NIST RS274NGC Interpreter,
//! Version 3*, 2000), and what GRBL, Fanuc, Haas, Siemens, Marlin and others add to it.
//!
//! All words of a block are taken first and done in the standard's order: feed, speed, tool, spindle,
//! dwell, plane, units, distance mode, then the move, then the end.

use super::Stop;
use super::number::number;
use super::recorder::Recorder;
use carvegraph_geometry::{DVec3, Direction, PathArc, Plane};

/// Codes in a block; more are no program.
const CODES_IN_BLOCK: usize = 16;

/// Controllers that count a dwell's P in milliseconds; the others count seconds.
const MILLISECONDS: [&str; 3] = ["fanuc", "haas", "marlin"];

/// G words that change nothing that is read here, in tenths: cancelled compensations, turns and cycles,
/// tool lengths, the first work offset, path modes and smoothness, feeds a minute, cycles' return heights.
const HARMLESS_G: [i32; 15] =
    [150, 400, 430, 490, 500, 540, 610, 611, 640, 690, 800, 940, 980, 990, 1870];

/// M words that do not move the tip: stops, coolants, overrides.
const HARMLESS_M: [i32; 8] = [0, 10, 70, 80, 90, 480, 490, 600];

/// What is in force.
pub(super) struct Reader<'a> {
    unit_mm: Option<f64>,
    motion: Option<Motion>,
    plane: Plane,
    incremental: bool,
    absolute_centers: bool,
    tool: Option<u32>,
    /// Whether a move was read.
    moved: bool,
    ended: bool,
    milliseconds: bool,
    ignored: &'a [String],
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    Rapid,
    Line,
    Arc(Direction),
}

/// The words of a block.
#[derive(Default)]
struct Block {
    /// G and M words: their letter and ten times their number.
    codes: [(u8, i32); CODES_IN_BLOCK],
    count: usize,
    /// The numbers of the other letters.
    values: [Option<f64>; 26],
    /// Whether there are any.
    any: bool,
}

impl Block {
    fn codes(&self) -> &[(u8, i32)] {
        &self.codes[..self.count]
    }

    fn has(&self, letter: u8, tenths: i32) -> bool {
        self.codes().contains(&(letter, tenths))
    }

    fn value(&self, letter: u8) -> Option<f64> {
        self.values[usize::from(letter - b'A')]
    }

    fn of(&self, letters: [u8; 3]) -> [Option<f64>; 3] {
        letters.map(|letter| self.value(letter))
    }
}

impl<'a> Reader<'a> {
    pub(super) fn new(dialect: &str, ignored: &'a [String]) -> Self {
        Self {
            unit_mm: None,
            motion: None,
            plane: Plane::Xy,
            incremental: false,
            absolute_centers: false,
            tool: None,
            moved: false,
            ended: false,
            milliseconds: MILLISECONDS.contains(&dialect),
            ignored,
        }
    }
}

impl super::Reader for Reader<'_> {
    fn line(&mut self, line: &str, recorder: &mut Recorder<'_>) -> Result<(), Stop> {
        let line = line.trim();
        let program_number = line.strip_prefix('O').is_some_and(|rest| {
            rest.bytes().next().is_some_and(|byte| byte.is_ascii_digit())
                && rest.trim_start_matches(|c: char| c.is_ascii_digit()).is_empty()
        });
        if line.starts_with('%') || program_number {
            return Ok(());
        }
        let block = self.words(line)?;
        if block.any || block.count > 0 {
            // Marlin stops its spindle last, and has no other end.
            self.ended = false;
            self.block(&block, recorder)?;
        }
        Ok(())
    }

    fn ended(&self) -> bool {
        self.ended
    }
}

impl Reader<'_> {
    /// Takes a line apart.
    fn words(&self, line: &str) -> Result<Block, Stop> {
        let mut block = Block::default();
        let mut rest = line.strip_prefix('/').unwrap_or(line);
        while let Some(first) = rest.bytes().next() {
            match first {
                b' ' | b'\t' => rest = &rest[1..],
                b'(' => {
                    let end = rest.find(')').ok_or("a comment is not closed")?;
                    rest = &rest[end + 1..];
                }
                b';' => break,
                _ => rest = self.word(rest, &mut block)?,
            }
        }
        Ok(block)
    }

    /// Takes the word that `text` begins with; answers what comes behind it.
    fn word<'t>(&self, text: &'t str, block: &mut Block) -> Result<&'t str, Stop> {
        if let Some(word) = self.ignored.iter().find(|word| begins_with_word(text, word)) {
            return Ok(&text[word.len()..]);
        }
        let cannot = || {
            let word: String = text.chars().take_while(|c| !c.is_whitespace()).take(24).collect();
            format!("{word:?} is no word that can be followed")
        };
        if let Some(rest) = text.strip_prefix("CYCLE832(") {
            // How smoothly to go, not where.
            return rest.find(')').map(|end| &rest[end + 1..]).ok_or_else(cannot);
        }
        if let Some(rest) = text.strip_prefix("CR=") {
            let (value, rest) = number(rest).ok_or_else(cannot)?;
            return set(block, b'R', value).map(|()| rest);
        }
        let letter = text.as_bytes()[0].to_ascii_uppercase();
        if !letter.is_ascii_uppercase() {
            return Err(cannot());
        }
        let (value, rest) = number(text[1..].trim_start()).ok_or_else(cannot)?;
        match letter {
            b'G' | b'M' => {
                let tenths = (value * 10.0).round();
                if block.count == CODES_IN_BLOCK || (tenths - value * 10.0).abs() > 1e-6 {
                    return Err(cannot());
                }
                block.codes[block.count] = (letter, tenths as i32);
                block.count += 1;
            }
            // The number of a line, or of a block.
            b'N' => {}
            _ => set(block, letter, value)?,
        }
        Ok(rest)
    }

    fn block(&mut self, block: &Block, recorder: &mut Recorder<'_>) -> Result<(), Stop> {
        if block.has(b'G', 40) {
            self.dwell(block, recorder);
            return Ok(());
        }
        self.known(block, recorder)?;
        self.modes(block, recorder);
        if let Some(feed) = block.value(b'F') {
            if feed > 0.0 {
                recorder.feed_mm_per_min = Some(feed * self.unit_mm.unwrap_or(1.0));
            } else {
                recorder.fault("feed", format!("its feed is {feed}"));
            }
        }
        self.tool_and_spindle(block, recorder);
        self.distance(block);
        self.go(block, recorder)?;
        self.ended |= [20, 300].iter().any(|end| block.has(b'M', *end));
        // Marlin has no other end.
        self.ended |= block.has(b'M', 50);
        Ok(())
    }

    fn dwell(&self, block: &Block, recorder: &mut Recorder<'_>) {
        let scale = if self.milliseconds { 1e-3 } else { 1.0 };
        let seconds = block.value(b'P').map(|time| time * scale);
        let seconds = seconds.or(block.value(b'F')).or(block.value(b'S')).or(block.value(b'X'));
        match seconds {
            Some(seconds) if seconds >= 0.0 => recorder.dwell(seconds),
            _ => recorder.fault("dwell", "its dwell has no time".to_owned()),
        }
    }

    /// Finds codes that do what is not followed here.
    fn known(&self, block: &Block, recorder: &mut Recorder<'_>) -> Result<(), Stop> {
        for &(letter, tenths) in block.codes() {
            let code = || {
                let part =
                    if tenths % 10 == 0 { String::new() } else { format!(".{}", tenths % 10) };
                format!("{}{}{part}", char::from(letter), tenths / 10)
            };
            match (letter, tenths) {
                (b'G', 0 | 10 | 20 | 30 | 170 | 180 | 190 | 900 | 901 | 910 | 911 | 530)
                | (b'G', 280 | 300 | 200 | 210 | 700 | 710 | 7000 | 7100)
                | (b'M', 20 | 30 | 40 | 50 | 60 | 300) => {}
                (b'G', tenths) if HARMLESS_G.contains(&tenths) => {}
                (b'M', tenths) if HARMLESS_M.contains(&tenths) => {}
                (b'M', 980 | 990) | (b'G', 650 | 660) => {
                    return Err(format!("{} calls another program", code()));
                }
                (b'G', 100 | 520 | 550 | 560 | 570 | 580 | 590 | 680 | 920 | 921) => {
                    return Err(format!("{} shifts or turns the zero", code()));
                }
                (b'G', 730 | 740 | 760 | 810..=890) => {
                    return Err(format!("{} is a canned cycle", code()));
                }
                (b'G', 930 | 950) => {
                    return Err(format!("{} gives feeds in another measure", code()));
                }
                (b'G', _) => return Err(format!("{} is not known", code())),
                _ => recorder.fault("code", format!("{} is not known", code())),
            }
        }
        Ok(())
    }

    fn modes(&mut self, block: &Block, recorder: &mut Recorder<'_>) {
        for &(_, tenths) in block.codes().iter().filter(|(letter, _)| *letter == b'G') {
            let unit_mm = match tenths {
                200 | 700 | 7000 => 25.4,
                210 | 710 | 7100 => 1.0,
                _ => continue,
            };
            if self.moved && self.unit_mm != Some(unit_mm) {
                let text = "it changes between millimetres and inches in the midst of the program";
                recorder.fault("units", text.to_owned());
            }
            self.unit_mm = Some(unit_mm);
        }
        for &(letter, tenths) in block.codes() {
            match (letter, tenths) {
                (b'G', 170) => self.plane = Plane::Xy,
                (b'G', 180) => self.plane = Plane::Zx,
                (b'G', 190) => self.plane = Plane::Yz,
                (b'G', 901) => self.absolute_centers = true,
                (b'G', 911) => self.absolute_centers = false,
                _ => {}
            }
        }
    }

    fn tool_and_spindle(&mut self, block: &Block, recorder: &mut Recorder<'_>) {
        if let Some(tool) = block.value(b'T') {
            self.tool = Some(tool as u32);
        }
        if block.has(b'M', 60) {
            recorder.change_tool(self.tool);
        }
        if block.has(b'M', 30) || block.has(b'M', 40) {
            recorder.spindle(true);
        }
        if block.has(b'M', 50) {
            recorder.spindle(false);
        }
    }

    fn distance(&mut self, block: &Block) {
        if block.has(b'G', 900) {
            self.incremental = false;
        }
        if block.has(b'G', 910) {
            self.incremental = true;
        }
        for &(letter, tenths) in block.codes() {
            match (letter, tenths) {
                (b'G', 0) => self.motion = Some(Motion::Rapid),
                (b'G', 10) => self.motion = Some(Motion::Line),
                (b'G', 20) => self.motion = Some(Motion::Arc(Direction::Clockwise)),
                (b'G', 30) => self.motion = Some(Motion::Arc(Direction::CounterClockwise)),
                _ => {}
            }
        }
    }

    fn go(&mut self, block: &Block, recorder: &mut Recorder<'_>) -> Result<(), Stop> {
        if block.value(b'E').is_some() && !block.has(b'G', 1870) {
            return Err("E is not known, nor are exponents".to_owned());
        }
        if let Some(axis) =
            [b'A', b'B', b'C', b'U', b'V', b'W'].iter().find(|a| block.value(**a).is_some())
        {
            return Err(format!("it moves the axis {}", char::from(*axis)));
        }
        let words = block.of([b'X', b'Y', b'Z']);
        if block.has(b'G', 280) || block.has(b'G', 300) || block.has(b'G', 530) {
            // To a place of the machine: some axes, or all where none is named.
            let named = words.map(|word| word.is_some());
            let all = !named.contains(&true) && !block.has(b'G', 530);
            recorder.forget(named.map(|named| named || all));
            return Ok(());
        }
        let turns = matches!(self.motion, Some(Motion::Arc(_)))
            && [b'I', b'J', b'K', b'R'].iter().any(|letter| block.value(*letter).is_some());
        if !words.iter().any(Option::is_some) && !turns {
            return Ok(());
        }
        let Some(unit_mm) = self.unit_mm else {
            recorder
                .fault("units", "it moves, and says nowhere whether in mm or in inches".to_owned());
            self.unit_mm = Some(1.0);
            return self.go(block, recorder);
        };
        self.moved = true;
        let at = recorder.at();
        let to: [Option<f64>; 3] = std::array::from_fn(|axis| {
            let word = words[axis].map(|word| word * unit_mm);
            if self.incremental { Some(word? + at[axis]?) } else { word }
        });
        match self.motion {
            None => return Err("it moves, and no G0, G1, G2 or G3 is in force".to_owned()),
            Some(Motion::Rapid) => recorder.rapid(to),
            Some(Motion::Line) => recorder.cut(to),
            Some(Motion::Arc(direction)) => {
                let arc = self.arc(direction, block, unit_mm, to, recorder)?;
                recorder.cut_arc(to, arc);
            }
        }
        Ok(())
    }

    /// The arc of a block that leads `to` coordinates in mm.
    fn arc(
        &self,
        direction: Direction,
        block: &Block,
        unit_mm: f64,
        to: [Option<f64>; 3],
        recorder: &Recorder<'_>,
    ) -> Result<PathArc, Stop> {
        let plane = self.plane;
        let from = recorder.at().map(Option::unwrap_or_default);
        let end: [f64; 3] = std::array::from_fn(|axis| to[axis].unwrap_or(from[axis]));
        let [first, second, _] = plane.axes();
        let mut center = DVec3::from_array(from);
        if let Some(radius) = block.value(b'R') {
            let half = [first, second].map(|axis| (end[axis] - from[axis]) / 2.0);
            let (reach, radius) = (half[0].hypot(half[1]), radius * unit_mm);
            if reach == 0.0 || reach > radius.abs() * (1.0 + 1e-3) {
                return Err(format!(
                    "a radius of {radius} mm does not reach from end to end of its arc"
                ));
            }
            let height = (radius * radius - reach * reach).max(0.0).sqrt() / reach;
            // A negative radius asks for the longer of both arcs.
            let left = (direction == Direction::CounterClockwise) == (radius > 0.0);
            let side = if left { height } else { -height };
            center[first] += half[0] - side * half[1];
            center[second] += half[1] + side * half[0];
            return Ok(PathArc { plane, direction, center });
        }
        for axis in [first, second] {
            let offset = block.value([b'I', b'J', b'K'][axis]).map(|offset| offset * unit_mm);
            match offset {
                Some(place) if self.absolute_centers => center[axis] = place,
                None if self.absolute_centers => {
                    return Err("an arc does not give both coordinates of its centre".to_owned());
                }
                offset => center[axis] += offset.unwrap_or(0.0),
            }
        }
        Ok(PathArc { plane, direction, center })
    }
}

/// A letter's number, once in a block.
fn set(block: &mut Block, letter: u8, value: f64) -> Result<(), Stop> {
    let place = &mut block.values[usize::from(letter - b'A')];
    block.any = true;
    match place.replace(value) {
        None => Ok(()),
        Some(_) => Err(format!("{} stands in it twice", char::from(letter))),
    }
}

/// Whether `text` begins with `word` and goes on with something else.
fn begins_with_word(text: &str, word: &str) -> bool {
    let more = |rest: &str| rest.bytes().next().is_some_and(|b| b.is_ascii_digit() || b == b'.');
    text.strip_prefix(word).is_some_and(|rest| !more(rest))
}

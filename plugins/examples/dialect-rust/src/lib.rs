//! The dialect of the Kestrel K3, a milling control of 1998. (There is none: put yours in its place.)
//!
//! What its manual says, and what this file makes of it:
//!
//! * Lines end in CR LF; the program stands between two lines of `%`. Blocks are numbered N10, N20 and
//!   so on, with eight digits at most.
//! * Coordinates and feeds have a point and four decimals, in mm after G71, in inches after G70.
//! * G00 is a dog-leg: Z and XY never move at once here. F stays in force, G words are always repeated.
//! * G02 and G03 are arcs in XY of less than half a circle, I and J lead from start to centre; radii at
//!   start and end may differ by 0.01 mm. Helices and arcs in other planes become chords: see `arc`.
//! * There is no tool changer, and no M04. G04 P waits milliseconds, 99999 at most.
//! * `;` begins a comment, in upper case, up to 72 characters a line.

mod arc;
#[cfg(test)]
mod tests;

use carvegraph_sdk::export::Offers;
use carvegraph_sdk::{Capabilities, Command, Dialect, Direction, PostError, Program, Units};
use std::fmt::Write;
use std::io;

carvegraph_sdk::export!(Offers::new().dialect(Kestrel));

const STEPS_PER_UNIT: f64 = 10_000.0;
const LIMIT_MM: f64 = 10_000.0;
const LIMIT_MM_PER_MIN: f64 = 20_000.0;
const LIMIT_RPM: f64 = 24_000.0;
const LIMIT_DWELL_S: f64 = 99.999;
const LAST_BLOCK: u32 = 99_999_990;
const COMMENT_LENGTH: usize = 72;

/// The text goes to the sink in pieces of this size.
const PIECE_BYTES: usize = 1 << 16;

struct Kestrel;

impl Dialect for Kestrel {
    fn name(&self) -> &str {
        "kestrel"
    }

    fn about(&self) -> &str {
        "Kestrel K3 milling controls"
    }

    fn extension(&self) -> &str {
        "knc"
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { arcs: true, tool_change: false, path_tolerance: false }
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn io::Write) -> Result<(), PostError> {
        let mut sheet = Sheet::new(program, out);
        sheet.head()?;
        for (index, command) in program.commands.iter().enumerate() {
            sheet.index = index;
            sheet.command(command)?;
        }
        sheet.end()
    }
}

/// A program being written, and what the control knows by now.
struct Sheet<'a> {
    program: &'a Program<'a>,
    out: &'a mut dyn io::Write,
    text: String,
    block: u32,
    /// Index of the command being written, for errors.
    index: usize,
    steps_per_mm: f64,
    /// Where the tip is, as it was written, in steps.
    at: Option<[i64; 3]>,
    /// The same as it is meant, in mm.
    meant: [f64; 3],
    /// The feed in force, in steps.
    feed: Option<i64>,
}

impl<'a> Sheet<'a> {
    fn new(program: &'a Program<'a>, out: &'a mut dyn io::Write) -> Self {
        let steps_per_mm = match program.units {
            Units::Mm => STEPS_PER_UNIT,
            Units::Inch => STEPS_PER_UNIT / 25.4,
        };
        let (text, meant) = (String::new(), [0.0; 3]);
        Self { program, out, text, block: 0, index: 0, steps_per_mm, at: None, meant, feed: None }
    }

    fn head(&mut self) -> Result<(), PostError> {
        self.line("%")?;
        self.comment(self.program.title)?;
        self.program.remarks.iter().try_for_each(|remark| self.comment(remark))?;
        let units = match self.program.units {
            Units::Mm => "G71",
            Units::Inch => "G70",
        };
        self.block(&format!("{units} G90 G94 G17"))
    }

    fn end(mut self) -> Result<(), PostError> {
        self.block("M05")?;
        self.block("M30")?;
        self.line("%")?;
        Ok(self.out.write_all(self.text.as_bytes())?)
    }

    fn command(&mut self, command: &Command) -> Result<(), PostError> {
        match *command {
            Command::Comment { text } => {
                let text = self.entry(self.program.texts, "text", text)?;
                self.comment(text)
            }
            Command::ToolChange { .. } => {
                self.unsupported("kestrel has no tool changer: write one program for each tool")
            }
            Command::Spindle { direction: Direction::CounterClockwise, .. } => {
                self.unsupported("kestrel cannot turn the spindle counter-clockwise")
            }
            Command::Spindle { rpm, .. } => self.spindle(rpm),
            Command::SpindleStop => self.block("M05"),
            Command::Dwell { seconds } => self.dwell(seconds),
            Command::Rapid { to } => self.rapid(to),
            Command::Feed { to, mm_per_min } => self.cut(to, mm_per_min),
            Command::Arc { arc } => {
                let arc = self.entry(self.program.arcs, "arc", arc)?;
                self.arc(&arc)
            }
            // Later versions of Carvegraph may know more.
            _ => self.unsupported("kestrel does not know this command"),
        }
    }

    fn spindle(&mut self, rpm: f64) -> Result<(), PostError> {
        if !(rpm.round() >= 1.0 && rpm <= LIMIT_RPM) {
            let limit_rpm = LIMIT_RPM;
            return Err(PostError::SpindleSpeed { command: self.index, rpm, limit_rpm });
        }
        self.block(&format!("S{} M03", rpm.round()))
    }

    fn dwell(&mut self, seconds: f64) -> Result<(), PostError> {
        if !(0.0..=LIMIT_DWELL_S).contains(&seconds) {
            let limit_seconds = LIMIT_DWELL_S;
            return Err(PostError::Dwell { command: self.index, seconds, limit_seconds });
        }
        self.block(&format!("G04 P{}", (seconds * 1000.0).round()))
    }

    /// Up first, down last. From where nobody knows, as at the start, Z goes first.
    fn rapid(&mut self, to: [f64; 3]) -> Result<(), PostError> {
        let end = self.steps(to)?;
        let from = self.at.replace(end);
        self.meant = to;
        if from.is_none_or(|from| end[2] > from[2]) {
            self.motion("G00", end, [false, false, true], "")?;
        }
        let across = [0, 1].map(|axis| from.is_none_or(|from| end[axis] != from[axis]));
        if across != [false; 2] {
            self.motion("G00", end, [across[0], across[1], false], "")?;
        }
        if from.is_some_and(|from| end[2] < from[2]) {
            self.motion("G00", end, [false, false, true], "")?;
        }
        Ok(())
    }

    fn cut(&mut self, to: [f64; 3], mm_per_min: f64) -> Result<(), PostError> {
        let from = self.cutting_from()?;
        let (end, feed) = (self.steps(to)?, self.feed_steps(mm_per_min)?);
        self.straight(from, end, feed)?;
        self.meant = to;
        Ok(())
    }

    /// A straight cut, where it leads anywhere.
    fn straight(&mut self, from: [i64; 3], end: [i64; 3], feed: i64) -> Result<(), PostError> {
        if from == end {
            return Ok(());
        }
        let feed = self.feed_word(feed);
        self.at = Some(end);
        self.motion("G01", end, [0, 1, 2].map(|axis| end[axis] != from[axis]), &feed)
    }

    fn cutting_from(&self) -> Result<[i64; 3], PostError> {
        self.at.ok_or(PostError::PositionUnknown { command: self.index })
    }

    /// A point as it is written; NaN is in no range.
    fn steps(&self, mm: [f64; 3]) -> Result<[i64; 3], PostError> {
        if let Some(axis) = (0..3).find(|&axis| !(-LIMIT_MM..=LIMIT_MM).contains(&mm[axis])) {
            let (value_mm, limit_mm) = (mm[axis], LIMIT_MM);
            let axis = ['X', 'Y', 'Z'][axis];
            return Err(PostError::Coordinate { command: self.index, axis, value_mm, limit_mm });
        }
        Ok(mm.map(|mm| (mm * self.steps_per_mm).round() as i64))
    }

    fn feed_steps(&self, mm_per_min: f64) -> Result<i64, PostError> {
        let steps = (mm_per_min * self.steps_per_mm).round();
        if steps >= 1.0 && mm_per_min <= LIMIT_MM_PER_MIN {
            return Ok(steps as i64);
        }
        let limit_mm_per_min = LIMIT_MM_PER_MIN;
        Err(PostError::Feed { command: self.index, mm_per_min, limit_mm_per_min })
    }

    /// The word for a feed, if another one is in force.
    fn feed_word(&mut self, feed: i64) -> String {
        if self.feed.replace(feed) == Some(feed) {
            String::new()
        } else {
            format!(" F{}", number(feed))
        }
    }

    fn entry<T: Copy>(&self, all: &[T], table: &'static str, index: u32) -> Result<T, PostError> {
        let (command, length) = (self.index, all.len());
        all.get(index as usize).copied().ok_or(PostError::Index { command, table, index, length })
    }

    fn unsupported(&self, message: &str) -> Result<(), PostError> {
        Err(PostError::Unsupported { command: self.index, message: message.to_owned() })
    }

    fn motion(
        &mut self,
        word: &str,
        to: [i64; 3],
        axes: [bool; 3],
        rest: &str,
    ) -> Result<(), PostError> {
        let mut words = word.to_owned();
        for (axis, letter) in
            ['X', 'Y', 'Z'].into_iter().enumerate().filter(|(axis, _)| axes[*axis])
        {
            // Writing to a String cannot fail.
            let _ = write!(words, " {letter}{}", number(to[axis]));
        }
        self.block(&(words + rest))
    }

    fn block(&mut self, words: &str) -> Result<(), PostError> {
        self.block = self.block % LAST_BLOCK + 10;
        self.line(&format!("N{} {words}", self.block))
    }

    /// A text is anybody's: what is left of it can neither end its line nor be taken for an order.
    fn comment(&mut self, text: &str) -> Result<(), PostError> {
        let harmless =
            |c: char| if c.is_ascii_alphanumeric() || ".,:-".contains(c) { c } else { ' ' };
        let text: String = text.chars().map(harmless).take(COMMENT_LENGTH - "; - ".len()).collect();
        if text.trim().is_empty() {
            return Ok(());
        }
        self.line(&format!("; - {}", text.to_ascii_uppercase()))
    }

    fn line(&mut self, line: &str) -> Result<(), PostError> {
        self.text.push_str(line);
        self.text.push_str("\r\n");
        if self.text.len() >= PIECE_BYTES {
            self.out.write_all(self.text.as_bytes())?;
            self.text.clear();
        }
        Ok(())
    }
}

/// Steps as a number with its point and four decimals. There is no minus nothing.
fn number(steps: i64) -> String {
    let (sign, steps) = (if steps < 0 { "-" } else { "" }, steps.unsigned_abs());
    format!("{sign}{}.{:04}", steps / 10_000, steps % 10_000)
}

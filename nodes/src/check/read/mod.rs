//! Reads programs as a controller does: which moves their text makes.
//!
//! It knows nothing of the dialects that write them, so that an error in one of them shows. There are
//! three languages, told apart by what a text holds, whatever its file is called: word addresses
//! ([`rs274`]: RS-274/NGC, ISO 6983 and what their controllers add), Heidenhain's conversational
//! language ([`heidenhain`]) and OpenSBP ([`shopbot`]).
//!
//! Limits: no variables, expressions, subprograms, canned cycles or shifts of the zero. Reading ends where
//! one comes, and says so, for nothing behind it is sure.

mod heidenhain;
mod number;
mod recorder;
mod rs274;
mod shopbot;

use crate::machining::{Machining, ToolRun};
use crate::values::{Gcode, ProgramText};
use carvegraph_geometry::{Cutter, DVec3, Motion};
use recorder::Recorder;

/// What keeps reading from going on, in words.
pub(super) type Stop = String;

/// Asked every so many lines whether to go on.
const LINES_AT_ONCE: usize = 1 << 14;

/// The moves of all programs of `code`, whose zero lies at `zero` of the part's frame. `ignored` are words
/// that change nothing. `None` if `go_on` says so, which is asked from time to time.
///
/// Tools are those that each program says it uses, `cutter` where it says none.
pub(crate) fn read_programs(
    code: &Gcode,
    zero: DVec3,
    cutter: &Cutter,
    ignored: &[String],
    go_on: &dyn Fn() -> bool,
) -> Option<Machining> {
    let mut machining = Machining { runs: Vec::new(), faults: Vec::new(), readable: true };
    for (index, program) in code.programs.iter().enumerate() {
        let recorder = Recorder::new(index, &program.tools, cutter, zero);
        let read = read_program(program, &code.dialect, recorder, ignored, go_on)?;
        machining.runs.extend(read.runs);
        machining.faults.extend(read.faults);
        machining.readable &= read.readable;
    }
    if machining.runs.is_empty() {
        let motion = Motion { start: zero, moves: Vec::new(), arcs: Vec::new() };
        let (lines, cutter) = (Vec::new(), cutter.clone());
        machining.runs.push(ToolRun { program: 0, cutter, motion, lines, dwell_s: 0.0 });
    }
    Some(machining)
}

fn read_program(
    program: &ProgramText,
    dialect: &str,
    recorder: Recorder<'_>,
    ignored: &[String],
    go_on: &dyn Fn() -> bool,
) -> Option<Machining> {
    let text = String::from_utf8_lossy(&program.text);
    let mut reader: Box<dyn Reader> = match Language::of(&text) {
        Language::WordAddress => Box::new(rs274::Reader::new(dialect, ignored)),
        Language::Heidenhain => Box::new(heidenhain::Reader::default()),
        Language::ShopBot => Box::new(shopbot::Reader::default()),
        Language::Unknown => return Some(Machining { readable: false, ..recorder.finish() }),
    };
    let mut recorder = recorder;
    for (index, line) in text.lines().enumerate() {
        if index % LINES_AT_ONCE == 0 && !go_on() {
            return None;
        }
        recorder.line = index as u32 + 1;
        if let Err(stop) = reader.line(line, &mut recorder) {
            recorder.fault("stop", format!("{stop}: what comes after it is not read"));
            return Some(recorder.finish());
        }
    }
    recorder.end(reader.ended());
    Some(recorder.finish())
}

/// A language that programs are written in.
trait Reader {
    /// Reads the next line.
    fn line(&mut self, line: &str, recorder: &mut Recorder<'_>) -> Result<(), Stop>;

    /// Whether the program has come to its end.
    fn ended(&self) -> bool;
}

#[derive(Debug, PartialEq)]
enum Language {
    WordAddress,
    Heidenhain,
    ShopBot,
    /// None of them.
    Unknown,
}

/// Lines that are looked at to tell a language; heads are shorter.
const HEAD_LINES: usize = 200;

impl Language {
    fn of(text: &str) -> Self {
        let head = || text.lines().take(HEAD_LINES).map(str::trim_start);
        let first = head().find(|line| !line.is_empty()).unwrap_or("");
        let block = first.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
        if block.starts_with("BEGIN PGM ") {
            return Self::Heidenhain;
        }
        let moves = ["M2,", "M3,", "MX,", "MY,", "MZ,", "J2,", "J3,", "JX,", "JY,", "JZ,", "MS,"];
        if head().any(|line| moves.iter().any(|begin| line.starts_with(begin))) {
            return Self::ShopBot;
        }
        let words = |line: &str| {
            let line = line.trim_end();
            line.is_empty() || line.starts_with(|c| "%(;/NOGMTSFXYZ".contains(c))
        };
        if head().any(words) { Self::WordAddress } else { Self::Unknown }
    }
}

#[cfg(test)]
mod tests;

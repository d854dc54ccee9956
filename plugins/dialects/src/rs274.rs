//! The core of all word-address dialects (RS-274/NGC, ISO 6983).
//!
//! What a controller wants differently is data: [`Rs274`]. [`crate::iso6983`] holds all of it once,
//! and a dialect's own file overrides some. The [`front`] checks and rounds; the [`writer`] is left
//! with which words a block holds.

mod writer;

use crate::block::Numbering;
use crate::comment::CommentStyle;
use crate::front::{self, Abilities, Tools};
use carvegraph_sdk::{Capabilities, Dialect, PostError, Program};
use std::io;
use writer::Rs274Writer;

/// What a dialect does differently, as plain data.
///
/// Lines may hold `{units}` (the word for them), `{unit}` (their name), `{number}` and `{name}` (of
/// the program), `{tool}`, `{rpm}`, `{seconds}`, `{milliseconds}`, `{tolerance}`.
#[derive(Clone, Copy)]
pub(crate) struct Rs274 {
    pub(crate) name: &'static str,
    pub(crate) about: &'static str,
    pub(crate) extension: &'static str,
    pub(crate) abilities: Abilities,
    /// Characters in a block or comment that the controller reads.
    pub(crate) line_limit: usize,
    pub(crate) numbering: Option<Numbering>,
    pub(crate) comments: CommentStyle,
    pub(crate) program_number: ProgramNumber,
    /// Lines before everything else, without block numbers.
    pub(crate) opening: &'static [&'static str],
    /// Remarks that the operator must know, after the program's own.
    pub(crate) notes: &'static [&'static str],
    /// One more for a program that takes up no tool.
    pub(crate) note_without_tool: &'static str,
    /// One more before the first dwell.
    pub(crate) note_on_dwell: &'static str,
    /// Modes set at the head.
    pub(crate) head: &'static [&'static str],
    pub(crate) path_tolerance: PathTolerance,
    /// Sends Z to the machine's top, before a tool change or a program that has none.
    pub(crate) retract: &'static [&'static str],
    /// Changes to a tool, after a remark on it.
    pub(crate) tool_note: &'static str,
    pub(crate) tool_change: &'static [&'static str],
    /// Takes up a tool's length, in the block that first moves Z.
    pub(crate) length_with_z: &'static str,
    pub(crate) words: Words,
    /// Whether motion words stand in every block.
    pub(crate) repeat_motion: bool,
    pub(crate) center: Center,
    /// How a program ends, after the spindle's stop.
    pub(crate) end: &'static [&'static str],
    /// Lines after the end, without block numbers.
    pub(crate) closing: &'static [&'static str],
    /// Words that the controller must not be told: single letters stand for all their words.
    pub(crate) rejects: &'static [&'static str],
}

/// The words that differ between controllers.
#[derive(Clone, Copy)]
pub(crate) struct Words {
    pub(crate) rapid: &'static str,
    pub(crate) feed: &'static str,
    pub(crate) clockwise: &'static str,
    pub(crate) counterclockwise: &'static str,
    pub(crate) planes: [&'static str; 3],
    pub(crate) mm: &'static str,
    pub(crate) inch: &'static str,
    pub(crate) spindle_clockwise: &'static str,
    pub(crate) spindle_counterclockwise: &'static str,
    pub(crate) spindle_stop: &'static str,
    pub(crate) dwell: &'static str,
}

/// How an arc's centre is given.
#[allow(dead_code, reason = "dialects from a file choose among all")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Center {
    /// By I, J, K from the start.
    Incremental,
    /// By I, J, K from the program's zero.
    Absolute,
    /// By the radius, after this word. Arcs of more than [`RADIUS_SWEEP_LIMIT_DEG`] are divided.
    Radius(&'static str),
}

/// Beyond, a radius that is rounded by half a step moves the arc by more than its rounding may: at
/// 120° by a step, towards 180° without bound.
const RADIUS_SWEEP_LIMIT_DEG: f64 = 120.0;

/// How a program's number is written.
#[derive(Clone, Copy)]
pub(crate) struct ProgramNumber {
    pub(crate) digits: usize,
    pub(crate) limit: u32,
}

/// How the controller is told how far it may leave the path.
#[derive(Clone, Copy)]
pub(crate) enum PathTolerance {
    /// Not at all.
    None,
    /// By this line, if the program says how far.
    IfGiven(&'static str),
    /// By this line; a program must say how far.
    Always(&'static str),
}

impl Dialect for Rs274 {
    fn name(&self) -> &str {
        self.name
    }

    fn about(&self) -> &str {
        self.about
    }

    fn extension(&self) -> &str {
        self.extension
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities {
            arcs: true,
            tool_change: matches!(self.abilities.tools, Tools::UpTo(_)),
            path_tolerance: !matches!(self.path_tolerance, PathTolerance::None),
        }
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn io::Write) -> Result<(), PostError> {
        if let Some((line, word)) = self.rejected() {
            let (dialect, line, word) = (self.name.to_owned(), line.to_owned(), word.to_owned());
            return Err(PostError::Rejected { dialect, line, word });
        }
        let mut abilities = self.abilities;
        if matches!(self.center, Center::Radius(_)) {
            let limit = &mut abilities.arcs.sweep_limit_deg;
            *limit = limit.min(RADIUS_SWEEP_LIMIT_DEG);
        }
        let writer = Rs274Writer::new(self, program, out);
        front::post(self.name, &abilities, program, writer)
    }
}

impl Rs274 {
    /// All lines and words that it may write by itself.
    fn own_lines(&self) -> Vec<&'static str> {
        let w = &self.words;
        let mut lines = vec![w.rapid, w.feed, w.clockwise, w.counterclockwise, w.mm, w.inch];
        lines.extend([w.spindle_clockwise, w.spindle_counterclockwise, w.spindle_stop, w.dwell]);
        lines.extend(if self.abilities.arcs.all_planes { &w.planes[..] } else { &[] });
        if let PathTolerance::IfGiven(line) | PathTolerance::Always(line) = self.path_tolerance {
            lines.push(line);
        }
        if let Tools::UpTo(_) = self.abilities.tools {
            lines.extend(self.tool_change);
            lines.push(self.length_with_z);
        }
        let Self { opening, head, retract, end, closing, .. } = *self;
        lines.extend([opening, head, retract, end, closing].concat());
        lines
    }

    /// The first of them that holds a word which the controller rejects, and that word.
    fn rejected(&self) -> Option<(&'static str, &'static str)> {
        let says = |line: &str, rejected: &str| {
            line.split(' ').any(|w| w == rejected || rejected.len() == 1 && w.starts_with(rejected))
        };
        self.own_lines().into_iter().find_map(|line| {
            Some((line, *self.rejects.iter().find(|rejected| says(line, rejected))?))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::iso6983::ISO;
    use crate::template::fill;
    use crate::{family, grbl};
    use carvegraph_sdk::{Arc, Command, Direction, Plane};

    fn blocks(dialect: &Rs274, turn: f64) -> Vec<String> {
        let arc = Arc {
            plane: Plane::Xy,
            direction: Direction::CounterClockwise,
            center: [10.0, 20.0, 0.0],
            to: [10.0 + 5.0 * turn.cos(), 20.0 + 5.0 * turn.sin(), 5.0],
            mm_per_min: 100.0,
        };
        let program = Program {
            commands: &[Command::Rapid { to: [15.0, 20.0, 5.0] }, Command::Arc { arc: 0 }],
            arcs: &[arc],
            ..Program::default()
        };
        let mut out = Vec::new();
        dialect.post(&program, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        text.lines().filter(|l| l.contains("G3") || l.contains('R')).map(str::to_owned).collect()
    }

    #[test]
    fn centers_are_written_as_the_controller_wants_them() {
        let turn = 2.0;
        assert_eq!(blocks(&ISO, turn), ["G3 X7.919 Y24.546 I-5.0 J0.0 F100.0"]);
        let absolute = Rs274 { center: Center::Absolute, ..ISO };
        assert_eq!(blocks(&absolute, turn), ["G3 X7.919 Y24.546 I10.0 J20.0 F100.0"]);
        let radius = Rs274 { center: Center::Radius("CR="), ..ISO };
        assert_eq!(blocks(&radius, turn), ["G3 X7.919 Y24.546 CR=5.0 F100.0"]);
    }

    #[test]
    fn radii_never_leave_the_side_of_an_arc_open() {
        let radius = Rs274 { center: Center::Radius("R"), ..ISO };
        // Half a circle, by its radius, would lie on either side.
        let halves = blocks(&radius, std::f64::consts::PI);
        assert_eq!(halves, ["G3 X10.0 Y25.0 R5.0 F100.0", "X5.0 Y20.0 R5.0"]);
        let full = Rs274 { center: Center::Radius("R"), ..ISO };
        let mut turn = blocks(&full, 0.0);
        assert_eq!(turn.len(), 4, "{turn:?}");
        assert_eq!(turn.pop().unwrap(), "X15.0 Y20.0 R5.0");
    }

    #[test]
    fn blocks_are_numbered() {
        let numbering = Some(Numbering { prefix: "N", first: 10, step: 5 });
        let numbered = Rs274 { numbering, ..grbl::GRBL };
        let mut out = Vec::new();
        let program = Program { title: "x", ..Program::default() };
        numbered.post(&program, &mut out).unwrap();
        let expected = "(Carvegraph: x)\nN10 G17 G21 G90 G94\nN15 M5\nN20 M30\n";
        assert_eq!(String::from_utf8(out).unwrap(), expected);
    }

    #[test]
    fn no_dialect_says_what_its_controller_rejects() {
        for dialect in family() {
            assert_eq!(dialect.rejected(), None, "{}", dialect.name);
        }
        let forgetful = Rs274 { end: &["M5 M30"], rejects: &["M30", "T"], ..grbl::GRBL };
        let error = forgetful.post(&Program::default(), &mut io::sink()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "grbl would write \"M5 M30\", but its controller rejects M30"
        );
        let tools = Rs274 { rejects: &["T"], ..ISO };
        assert_eq!(tools.rejected(), Some(("T{tool} M6", "T")));
    }

    #[test]
    fn every_place_for_a_value_has_one() {
        let known = |key: &str| {
            let keys = ["units", "unit", "number", "name", "tool", "rpm", "seconds"];
            let known = keys.contains(&key) || ["milliseconds", "tolerance"].contains(&key);
            known.then(|| "1".to_owned())
        };
        for dialect in family() {
            let notes = [dialect.note_without_tool, dialect.note_on_dwell, dialect.tool_note];
            for line in [dialect.own_lines(), dialect.notes.to_vec(), notes.to_vec()].concat() {
                assert!(!fill(line, known).contains(['{', '}']), "{}: {line}", dialect.name);
            }
        }
    }
}

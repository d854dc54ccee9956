//! The core of all word-address dialects (RS-274/NGC, ISO 6983).
//!
//! What a controller wants differently is data: [`Rs274`]. [`crate::iso6983`] holds all of it once,
//! and a dialect's own file, ours or a user's, overrides some. The [`front`] checks and rounds; the
//! [`writer`] is left with which words a block holds.

mod writer;

use crate::Text;
use crate::block::Numbering;
use crate::comment::CommentStyle;
use crate::front::{self, Abilities, Arcs, Tools};
use crate::lines::{Common, Lines, ProgramNumber, Sheet};
use crate::number::{FeedUnit, NumberFormat};
use crate::template;
use crate::words::rejected;
use carvegraph_sdk::{Capabilities, Dialect, PostError, Program, Units};
use std::io;
use writer::Rs274Writer;

/// What a dialect does differently, as plain data.
#[derive(Clone, Debug)]
pub(crate) struct Rs274 {
    pub(crate) name: Text,
    pub(crate) about: Text,
    pub(crate) extension: Text,
    pub(crate) numbers: NumberFormat,
    pub(crate) feed_unit: FeedUnit,
    /// Which arcs the controller takes; with none all become chords.
    pub(crate) arcs: Option<Arcs>,
    pub(crate) center: Center,
    /// What stands before an arc's radius, where its centre is given so.
    pub(crate) radius_word: Text,
    /// Whether a rapid moves one axis at a time, across the work too.
    pub(crate) single_axis_rapids: bool,
    /// Speed of rapids, where the controller does not have one of its own.
    pub(crate) rapid_mm_per_min: Option<f64>,
    /// The largest tool number, where the controller changes tools.
    pub(crate) tool_limit: Option<u32>,
    /// What a program that changes tools is told where it does not, behind the dialect's name.
    pub(crate) tool_refusal: Text,
    /// Dwell after the spindle starts, where the controller does not wait by itself.
    pub(crate) spin_up_s: Option<f64>,
    pub(crate) dwell_limit_s: f64,
    /// Characters in a block or comment that the controller reads.
    pub(crate) line_limit: u32,
    pub(crate) numbering: Option<Numbering>,
    /// How comments are written, if the controller takes any.
    pub(crate) comments: Option<CommentStyle>,
    pub(crate) program_number: ProgramNumber,
    pub(crate) words: Words,
    /// Whether motion words stand in every block.
    pub(crate) repeat_motion: bool,
    pub(crate) lines: Lines<Text>,
    /// Whether a program must say how far the controller may leave the path.
    pub(crate) needs_path_tolerance: bool,
    /// Words that the controller must not be told, blanks between them: single signs stand for all
    /// their words.
    pub(crate) rejects: Text,
}

/// The words that differ between controllers.
#[derive(Clone, Debug)]
pub(crate) struct Words {
    pub(crate) rapid: Text,
    pub(crate) feed: Text,
    pub(crate) clockwise: Text,
    pub(crate) counterclockwise: Text,
    /// Those of XY, ZX and YZ.
    pub(crate) planes: [Text; 3],
    pub(crate) mm: Text,
    pub(crate) inch: Text,
}

/// How an arc's centre is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Center {
    /// By I, J, K from the start.
    Incremental,
    /// By I, J, K from the program's zero.
    Absolute,
    /// By the radius. Arcs of more than [`RADIUS_SWEEP_LIMIT_DEG`] are divided.
    Radius,
}

/// Beyond, a radius that is rounded by half a step moves the arc by more than its rounding may: at
/// 120° by a step, towards 180° without bound.
pub(crate) const RADIUS_SWEEP_LIMIT_DEG: f64 = 120.0;

impl Dialect for Rs274 {
    fn name(&self) -> &str {
        &self.name
    }

    fn about(&self) -> &str {
        &self.about
    }

    fn extension(&self) -> &str {
        &self.extension
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities {
            arcs: self.arcs.is_some(),
            tool_change: self.tool_limit.is_some(),
            path_tolerance: !self.lines.path_tolerance.is_empty(),
        }
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn io::Write) -> Result<(), PostError> {
        if let Some((line, word)) = self.rejected_word() {
            let (dialect, line, word) = (self.name.to_string(), line.to_owned(), word.to_owned());
            return Err(PostError::Rejected { dialect, line, word });
        }
        let engine = template::engine();
        let sheet = Sheet::new(&engine, &self.lines, self.common(program.units), program)?;
        // A template may leave it out in some programs.
        let starts_high = !sheet.render(|lines| &lines.retract, &[])?.is_empty();
        let abilities = Abilities { starts_high, ..self.abilities() };
        let writer = Rs274Writer::new(self, program, sheet, out);
        front::post(&self.name, &abilities, program, writer)
    }
}

impl Rs274 {
    /// What the front must know, but whether Z starts at the top.
    pub(crate) fn abilities(&self) -> Abilities {
        let divided = |arcs: &Arcs| match self.center {
            Center::Radius => {
                let sweep_limit_deg = arcs.sweep_limit_deg.min(RADIUS_SWEEP_LIMIT_DEG);
                Arcs { sweep_limit_deg, ..*arcs }
            }
            _ => *arcs,
        };
        Abilities {
            numbers: self.numbers,
            feed_unit: self.feed_unit,
            arcs: self.arcs.as_ref().map(divided),
            single_axis_rapids: self.single_axis_rapids,
            starts_high: false,
            tools: match self.tool_limit {
                Some(limit) => Tools::UpTo(limit),
                None => Tools::None(self.tool_refusal.clone()),
            },
            counterclockwise: !self.lines.spindle_counterclockwise.is_empty(),
            spin_up_s: self.spin_up_s,
            dwell_limit_s: self.dwell_limit_s,
            rapid_mm_per_min: self.rapid_mm_per_min,
        }
    }

    /// What its lines have in common in a program of these units.
    pub(crate) fn common(&self, units: Units) -> Common<'_> {
        let units_word = match units {
            Units::Mm => &self.words.mm,
            Units::Inch => &self.words.inch,
        };
        Common {
            comments: self.comments.as_ref(),
            rejects: &self.rejects,
            program_number: self.program_number,
            ..Common::new(&self.name, units_word)
        }
    }

    /// The first word it may write by itself that its controller rejects, and which of
    /// [`Rs274::rejects`] says so. Lines are looked at when they are rendered.
    pub(crate) fn rejected_word(&self) -> Option<(&str, &str)> {
        let w = &self.words;
        let mut words = vec![&w.rapid, &w.feed];
        if let Some(arcs) = &self.arcs {
            words.extend([&w.clockwise, &w.counterclockwise]);
            words.extend(if arcs.all_planes { &w.planes[..] } else { &[] });
        }
        words.into_iter().find_map(|word| Some((&**word, rejected(word, &self.rejects)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{family, grbl, iso6983};
    use carvegraph_sdk::{Arc, Command, Direction, Plane};

    fn posted(dialect: &Rs274, program: &Program<'_>) -> String {
        let mut out = Vec::new();
        dialect.post(program, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

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
        let text = posted(dialect, &program);
        text.lines().filter(|l| l.contains("G3") || l.contains('R')).map(str::to_owned).collect()
    }

    fn centered(center: Center) -> Rs274 {
        let radius_word = "CR=".into();
        Rs274 { center, radius_word, ..iso6983::settings() }
    }

    #[test]
    fn centers_are_written_as_the_controller_wants_them() {
        let turn = 2.0;
        let text = blocks(&centered(Center::Incremental), turn);
        assert_eq!(text, ["G3 X7.919 Y24.546 I-5.0 J0.0 F100.0"]);
        let text = blocks(&centered(Center::Absolute), turn);
        assert_eq!(text, ["G3 X7.919 Y24.546 I10.0 J20.0 F100.0"]);
        let text = blocks(&centered(Center::Radius), turn);
        assert_eq!(text, ["G3 X7.919 Y24.546 CR=5.0 F100.0"]);
    }

    #[test]
    fn radii_never_leave_the_side_of_an_arc_open() {
        let radius = centered(Center::Radius);
        // Half a circle, by its radius, would lie on either side.
        let halves = blocks(&radius, std::f64::consts::PI);
        assert_eq!(halves, ["G3 X10.0 Y25.0 CR=5.0 F100.0", "X5.0 Y20.0 CR=5.0"]);
        let mut turn = blocks(&radius, 0.0);
        assert_eq!(turn.len(), 4, "{turn:?}");
        assert_eq!(turn.pop().unwrap(), "X15.0 Y20.0 CR=5.0");
    }

    #[test]
    fn blocks_are_numbered() {
        let numbering = Some(Numbering { prefix: "N".into(), first: 10, step: 5, last: 15 });
        let numbered = Rs274 { numbering, ..grbl::settings() };
        let text = posted(&numbered, &Program { title: "x", ..Program::default() });
        assert_eq!(text, "(Carvegraph: x)\nN10 G17 G21 G90 G94\nN15 M5\nN10 M30\n");
    }

    #[test]
    fn a_controller_without_comments_is_told_none() {
        let silent = Rs274 { comments: None, ..grbl::settings() };
        let text = posted(&silent, &Program { title: "x", remarks: &["y"], ..Program::default() });
        assert_eq!(text, "G17 G21 G90 G94\nM5\nM30\n");
    }

    #[test]
    fn no_dialect_says_what_its_controller_rejects() {
        for dialect in family() {
            assert_eq!(dialect.rejected_word(), None, "{}", dialect.name);
        }
        let grbl = grbl::settings();
        let lines = Lines { footer: "M5 M30".into(), ..grbl.lines.clone() };
        let forgetful = Rs274 { lines, rejects: "M30 T".into(), ..grbl.clone() };
        let error = forgetful.post(&Program::default(), &mut io::sink()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "grbl would write \"M5 M30\", but its controller rejects M30"
        );
        let wordless = Rs274 { rejects: "G".into(), ..grbl };
        assert_eq!(wordless.rejected_word(), Some(("G0", "G")));
    }
}

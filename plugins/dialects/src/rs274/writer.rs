//! Writes blocks of words as an [`Rs274`] wants them.
//!
//! A word stands only where it changes something (motion, plane, F), unless the controller forgets
//! it; an arc carries both axes of its plane and both offsets.

use super::{Center, PathTolerance, ProgramNumber, Rs274};
use crate::block::Blocks;
use crate::comment::{MARK, comments};
use crate::front::{self, Abilities, Rapid, Turn, Writer};
use crate::name;
use crate::number::Grid;
use crate::template::fill;
use carvegraph_sdk::{Command, Direction, Plane, PostError, Program, Units};
use std::io;

/// The longest name that Siemens takes, and longer than anybody reads.
const NAME_LENGTH: usize = 24;

/// The motion mode the controller is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Motion {
    Rapid,
    Feed,
    Arc(Direction),
}

/// A program being written, and which words the controller has in force.
pub(crate) struct Rs274Writer<'a> {
    dialect: &'a Rs274,
    program: &'a Program<'a>,
    grid: Grid,
    feeds: Grid,
    blocks: Blocks<'a>,
    motion: Option<Motion>,
    plane: Option<Plane>,
    /// The tool whose length is still to be taken up.
    length: Option<u32>,
    /// Whether there has been a dwell.
    dwelt: bool,
}

impl Writer for Rs274Writer<'_> {
    fn head(&mut self) -> Result<(), PostError> {
        let dialect = self.dialect;
        for line in dialect.opening {
            let line = self.filled(line);
            self.blocks.bare_line(&line)?;
        }
        self.comment("Carvegraph: ", self.program.title)?;
        for remark in self.program.remarks {
            self.comment(MARK, remark)?;
        }
        for note in dialect.notes {
            self.note(note)?;
        }
        let moves = |command: &&Command| {
            use Command::{Arc, Feed, Rapid, ToolChange};
            matches!(command, ToolChange { .. } | Rapid { .. } | Feed { .. } | Arc { .. })
        };
        let first = self.program.commands.iter().find(moves);
        let has_tool = matches!(first, Some(Command::ToolChange { .. }));
        if !has_tool {
            self.note(dialect.note_without_tool)?;
        }
        self.lines(dialect.head)?;
        self.path_tolerance()?;
        if has_tool { Ok(()) } else { self.lines(dialect.retract) }
    }

    fn comment(&mut self, mark: &str, text: &str) -> Result<(), PostError> {
        for line in comments(&self.dialect.comments, mark, text, self.dialect.line_limit) {
            self.blocks.bare_line(&line)?;
        }
        Ok(())
    }

    fn tool_change(&mut self, number: u32) -> Result<(), PostError> {
        let dialect = self.dialect;
        let tool = |key: &str| (key == "tool").then(|| number.to_string());
        self.lines(dialect.retract)?;
        self.comment(MARK, &fill(dialect.tool_note, tool))?;
        for line in dialect.tool_change {
            self.blocks.line(&fill(line, tool))?;
        }
        self.motion = None;
        self.plane = None;
        self.length = (!dialect.length_with_z.is_empty()).then_some(number);
        Ok(())
    }

    fn spindle(&mut self, rpm: u32, direction: Direction) -> Result<(), PostError> {
        let line = match direction {
            Direction::Clockwise => self.dialect.words.spindle_clockwise,
            Direction::CounterClockwise => self.dialect.words.spindle_counterclockwise,
        };
        self.blocks.line(&fill(line, |key| (key == "rpm").then(|| rpm.to_string())))
    }

    fn spindle_stop(&mut self) -> Result<(), PostError> {
        self.blocks.line(self.dialect.words.spindle_stop)
    }

    fn dwell(&mut self, milliseconds: i64) -> Result<(), PostError> {
        if !std::mem::replace(&mut self.dwelt, true) {
            self.note(self.dialect.note_on_dwell)?;
        }
        let line = fill(self.dialect.words.dwell, |key| match key {
            "seconds" => Some(Grid::THOUSANDTHS.text(milliseconds)),
            "milliseconds" => Some(milliseconds.to_string()),
            _ => None,
        });
        self.blocks.line(&line)
    }

    fn rapid(&mut self, rapid: Rapid) -> Result<(), PostError> {
        self.motion(Motion::Rapid);
        if rapid.axes[2]
            && let Some(number) = self.length.take()
        {
            let tool = |key: &str| (key == "tool").then(|| number.to_string());
            self.blocks.word(&fill(self.dialect.length_with_z, tool));
        }
        for axis in 0..3 {
            if rapid.axes[axis] {
                self.blocks.number(b"XYZ"[axis], self.grid, rapid.to[axis]);
            }
        }
        self.feed(rapid.feed);
        self.blocks.end()
    }

    #[inline]
    fn line(&mut self, from: [i64; 3], to: [i64; 3], feed: Option<i64>) -> Result<(), PostError> {
        self.motion(Motion::Feed);
        for axis in 0..3 {
            if to[axis] != from[axis] {
                self.blocks.number(b"XYZ"[axis], self.grid, to[axis]);
            }
        }
        self.feed(feed);
        self.blocks.end()
    }

    fn arc(&mut self, turn: &Turn) -> Result<(), PostError> {
        let [first, second, normal] = turn.plane.axes();
        if self.plane.replace(turn.plane) != Some(turn.plane) {
            let word = match turn.plane {
                Plane::Xy => 0,
                Plane::Zx => 1,
                Plane::Yz => 2,
            };
            self.blocks.line(self.dialect.words.planes[word])?;
        }
        self.motion(Motion::Arc(turn.direction));
        for axis in 0..3 {
            if axis != normal || turn.to[axis] != turn.from[axis] {
                self.blocks.number(b"XYZ"[axis], self.grid, turn.to[axis]);
            }
        }
        match self.dialect.center {
            Center::Radius(word) => {
                self.blocks.word(word);
                self.blocks.digits(self.grid, radius(turn));
            }
            center => {
                let mut offsets = [(first, turn.offset[0]), (second, turn.offset[1])];
                offsets.sort_unstable();
                for (axis, offset) in offsets {
                    let zero = if center == Center::Absolute { turn.from[axis] } else { 0 };
                    self.blocks.number(b"IJK"[axis], self.grid, zero + offset);
                }
            }
        }
        self.feed(turn.feed);
        self.blocks.end()
    }

    fn end(mut self) -> Result<(), PostError> {
        self.blocks.line(self.dialect.words.spindle_stop)?;
        self.lines(self.dialect.end)?;
        for line in self.dialect.closing {
            self.blocks.bare_line(line)?;
        }
        self.blocks.finish()
    }
}

impl<'a> Rs274Writer<'a> {
    pub(crate) fn new(
        dialect: &'a Rs274,
        program: &'a Program<'a>,
        out: &'a mut dyn io::Write,
    ) -> Self {
        let Abilities { numbers, feed_unit, .. } = dialect.abilities;
        Self {
            dialect,
            program,
            grid: Grid::lengths(program.units, numbers),
            feeds: Grid::feeds(program.units, numbers, feed_unit),
            blocks: Blocks::new(out, dialect.line_limit, dialect.numbering),
            motion: None,
            plane: Some(Plane::Xy),
            length: None,
            dwelt: false,
        }
    }

    /// The motion word, where the mode changes or must be said again.
    #[inline]
    fn motion(&mut self, motion: Motion) {
        if self.motion.replace(motion) != Some(motion) || self.dialect.repeat_motion {
            let words = &self.dialect.words;
            self.blocks.word(match motion {
                Motion::Rapid => words.rapid,
                Motion::Feed => words.feed,
                Motion::Arc(Direction::Clockwise) => words.clockwise,
                Motion::Arc(Direction::CounterClockwise) => words.counterclockwise,
            });
        }
    }

    #[inline]
    fn feed(&mut self, feed: Option<i64>) {
        if let Some(feed) = feed {
            self.blocks.number(b'F', self.feeds, feed);
        }
    }

    fn lines(&mut self, lines: &[&str]) -> Result<(), PostError> {
        for line in lines {
            let line = self.filled(line);
            self.blocks.line(&line)?;
        }
        Ok(())
    }

    fn note(&mut self, note: &str) -> Result<(), PostError> {
        let note = self.filled(note);
        self.comment(MARK, &note)
    }

    /// A line with what is the same in the whole program.
    fn filled(&self, line: &str) -> String {
        let title = self.program.title;
        fill(line, |key| match (key, self.program.units) {
            ("units", Units::Mm) => Some(self.dialect.words.mm.to_owned()),
            ("units", Units::Inch) => Some(self.dialect.words.inch.to_owned()),
            ("unit", Units::Mm) => Some("millimetres".to_owned()),
            ("unit", Units::Inch) => Some("inches".to_owned()),
            ("name", _) => Some(name::name(title, NAME_LENGTH)),
            ("number", _) => {
                let ProgramNumber { digits, limit } = self.dialect.program_number;
                Some(format!("{:0digits$}", name::number(title, limit)))
            }
            _ => None,
        })
    }

    fn path_tolerance(&mut self) -> Result<(), PostError> {
        let line = match self.dialect.path_tolerance {
            PathTolerance::None => return Ok(()),
            PathTolerance::IfGiven(_) if self.program.path_tolerance_mm == 0.0 => return Ok(()),
            PathTolerance::IfGiven(line) | PathTolerance::Always(line) => line,
        };
        let steps = front::path_tolerance(self.program, self.grid)?;
        let line = fill(line, |key| (key == "tolerance").then(|| self.grid.text(steps)));
        self.blocks.line(&line)
    }
}

/// The radius of an arc as it is written, in steps; at least half its chord, or no circle would fit.
fn radius(turn: &Turn) -> i64 {
    let [first, second, _] = turn.plane.axes();
    let [x, y] = turn.offset.map(|o| o as f64);
    let chord = [first, second].map(|axis| (turn.to[axis] - turn.from[axis]) as f64);
    let ends = [x.hypot(y), (x - chord[0]).hypot(y - chord[1])];
    let mean = (ends[0] + ends[1]) / 2.0;
    (mean.round() as i64).max((chord[0].hypot(chord[1]) / 2.0).ceil() as i64)
}

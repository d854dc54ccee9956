//! Writes blocks of words as an [`Rs274`] wants them.
//!
//! A word stands only where it changes something (motion, plane, F), unless the controller forgets
//! it; an arc carries both axes of its plane and both offsets.

use super::{Center, Rs274};
use crate::block::Blocks;
use crate::comment::{MARK, comments};
use crate::front::{self, Rapid, Turn, Writer};
use crate::lines::{Pick, Sheet};
use crate::number::Grid;
use carvegraph_sdk::{Command, Direction, Plane, PostError, Program};
use minijinja::value::Value;
use std::io;

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
    sheet: Sheet<'a>,
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
        for line in self.sheet.render(|lines| &lines.opening, &[])? {
            self.blocks.bare_line(&line)?;
        }
        self.comment("Carvegraph: ", self.program.title)?;
        for remark in self.program.remarks {
            self.comment(MARK, remark)?;
        }
        self.remarks(|lines| &lines.notes, &[])?;
        let moves = |command: &&Command| {
            use Command::{Arc, Feed, Rapid, ToolChange};
            matches!(command, ToolChange { .. } | Rapid { .. } | Feed { .. } | Arc { .. })
        };
        let first = self.program.commands.iter().find(moves);
        let has_tool = matches!(first, Some(Command::ToolChange { .. }));
        if !has_tool {
            self.remarks(|lines| &lines.note_without_tool, &[])?;
        }
        self.lines(|lines| &lines.header, &[])?;
        self.path_tolerance()?;
        if has_tool { Ok(()) } else { self.lines(|lines| &lines.retract, &[]) }
    }

    fn comment(&mut self, mark: &str, text: &str) -> Result<(), PostError> {
        let Some(style) = &self.dialect.comments else { return Ok(()) };
        for line in comments(style, mark, text, self.dialect.line_limit as usize) {
            self.blocks.bare_line(&line)?;
        }
        Ok(())
    }

    fn tool_change(&mut self, number: u32) -> Result<(), PostError> {
        let tool = [("tool", Value::from(number))];
        self.lines(|lines| &lines.retract, &[])?;
        self.remarks(|lines| &lines.tool_note, &tool)?;
        self.lines(|lines| &lines.tool_change, &tool)?;
        self.motion = None;
        self.plane = None;
        self.length = Some(number);
        Ok(())
    }

    fn spindle(&mut self, rpm: u32, direction: Direction) -> Result<(), PostError> {
        let rpm = [("rpm", Value::from(rpm))];
        match direction {
            Direction::Clockwise => self.lines(|lines| &lines.spindle_clockwise, &rpm),
            Direction::CounterClockwise => {
                self.lines(|lines| &lines.spindle_counterclockwise, &rpm)
            }
        }
    }

    fn spindle_stop(&mut self) -> Result<(), PostError> {
        self.lines(|lines| &lines.spindle_stop, &[])
    }

    fn dwell(&mut self, milliseconds: i64) -> Result<(), PostError> {
        if !std::mem::replace(&mut self.dwelt, true) {
            self.remarks(|lines| &lines.note_on_dwell, &[])?;
        }
        let seconds = Value::from(milliseconds as f64 / 1000.0);
        let time = [("milliseconds", Value::from(milliseconds)), ("seconds", seconds)];
        self.lines(|lines| &lines.dwell, &time)
    }

    fn rapid(&mut self, rapid: Rapid) -> Result<(), PostError> {
        self.motion(Motion::Rapid);
        if rapid.axes[2]
            && let Some(number) = self.length.take()
        {
            let tool = [("tool", Value::from(number))];
            for words in self.sheet.render(|lines| &lines.tool_length, &tool)? {
                self.blocks.word(&words);
            }
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
            self.blocks.line(&self.dialect.words.planes[word])?;
        }
        self.motion(Motion::Arc(turn.direction));
        for axis in 0..3 {
            if axis != normal || turn.to[axis] != turn.from[axis] {
                self.blocks.number(b"XYZ"[axis], self.grid, turn.to[axis]);
            }
        }
        match self.dialect.center {
            Center::Radius => {
                self.blocks.word(&self.dialect.radius_word);
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
        self.spindle_stop()?;
        self.lines(|lines| &lines.footer, &[])?;
        for line in self.sheet.render(|lines| &lines.closing, &[])? {
            self.blocks.bare_line(&line)?;
        }
        self.blocks.finish()
    }
}

impl<'a> Rs274Writer<'a> {
    pub(crate) fn new(
        dialect: &'a Rs274,
        program: &'a Program<'a>,
        sheet: Sheet<'a>,
        out: &'a mut dyn io::Write,
    ) -> Self {
        Self {
            dialect,
            program,
            sheet,
            grid: Grid::lengths(program.units, dialect.numbers),
            feeds: Grid::feeds(program.units, dialect.numbers, dialect.feed_unit),
            blocks: Blocks::new(out, dialect.line_limit as usize, dialect.numbering.as_ref()),
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
                Motion::Rapid => &words.rapid,
                Motion::Feed => &words.feed,
                Motion::Arc(Direction::Clockwise) => &words.clockwise,
                Motion::Arc(Direction::CounterClockwise) => &words.counterclockwise,
            });
        }
    }

    #[inline]
    fn feed(&mut self, feed: Option<i64>) {
        if let Some(feed) = feed {
            self.blocks.number(b'F', self.feeds, feed);
        }
    }

    fn lines(&mut self, pick: Pick, values: &[(&'static str, Value)]) -> Result<(), PostError> {
        self.sheet.write(pick, values, &mut self.blocks)
    }

    fn remarks(&mut self, pick: Pick, values: &[(&'static str, Value)]) -> Result<(), PostError> {
        for remark in self.sheet.remarks(pick, values)? {
            self.comment(MARK, &remark)?;
        }
        Ok(())
    }

    fn path_tolerance(&mut self) -> Result<(), PostError> {
        let is_told = !self.dialect.lines.path_tolerance.is_empty();
        let is_given = self.program.path_tolerance_mm != 0.0;
        if !is_told || !is_given && !self.dialect.needs_path_tolerance {
            return Ok(());
        }
        let tolerance = front::path_tolerance(self.program, self.grid)?;
        self.lines(|lines| &lines.path_tolerance, &[("tolerance", tolerance)])
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

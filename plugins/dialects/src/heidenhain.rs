//! Heidenhain iTNC 530 and TNC 6xx, in conversational language.
//!
//! * `BEGIN PGM`, the blank for its graphics (`BLK FORM`), blocks numbered from 0 without a gap, `END
//!   PGM`. Coordinates always have a sign.
//! * `TOOL CALL` changes the tool and sets the speed; without a number it only sets the speed. M3
//!   goes with the rapid that follows.
//! * `CC` sets the centre, `C` turns about it; `CP IPA` is a helix by its angle, in thousandths of a
//!   degree, so a line to its exact end follows. Arcs in other planes become lines: which way `DR`
//!   turns there is not sure.
//! * Cycle 9 waits, cycle 32 sets the path tolerance.
//! * In a program in inches an F counts tenths of an inch a minute.
//!
//! M128 is for five axes only.

use crate::Text;
use crate::block::{Blocks, Numbering};
use crate::comment::{CommentStyle, MARK, brackets, comments};
use crate::front::{self, Abilities, Arcs, COORDINATE_LIMIT_MM, Rapid, Tools, Turn, Writer};
use crate::iso6983;
use crate::lines::{Common, Lines, Pick, Sheet};
use crate::number::{FeedUnit, Grid, NumberFormat};
use crate::template;
use carvegraph_sdk::{Capabilities, Command, Dialect, Direction, PostError, Program, Stock, Units};
use minijinja::value::Value;
use std::io;

/// What an iTNC reads of a block.
const LINE_LIMIT: usize = 128;

/// Digits of a block number, and a space.
const NUMBER_WIDTH: usize = 11;

/// What older controls take for a name.
const NAME_LENGTH: usize = 16;

/// Numbers that a tool table has.
const TOOL_LIMIT: u32 = 30_000;

/// A blank must have some extent each way.
const LEAST_BLANK_MM: f64 = 1.0;

/// Blocks are numbered from 0 without a gap.
const NUMBERING: Numbering =
    Numbering { prefix: Text::Borrowed(""), first: 0, step: 1, last: u32::MAX };

fn comment_style() -> CommentStyle {
    CommentStyle { open: "; ".into(), close: "".into(), ..brackets() }
}

fn abilities() -> Abilities {
    let iso = iso6983::settings();
    Abilities {
        numbers: NumberFormat { least_decimals: 0, plus: true, ..iso.numbers },
        feed_unit: FeedUnit::TenthInchPerMinute,
        arcs: Some(Arcs { all_planes: false, ..Arcs::ALL }),
        tools: Tools::UpTo(TOOL_LIMIT),
        ..iso.abilities()
    }
}

/// A speed is set by a tool call, which names the tool where that changes.
fn lines() -> Lines<Text> {
    let call = "TOOL CALL{% if tool %} {{ tool }}{% endif %} Z S{{ rpm }}";
    Lines {
        opening: "BEGIN PGM {{ name }} {{ units }}".into(),
        path_tolerance: "CYCL DEF 32.0 TOLERANCE\n\
                         CYCL DEF 32.1 T{{ tolerance }}\n\
                         CYCL DEF 32.2 HSC-MODE:0"
            .into(),
        tool_change: "TOOL CALL {{ tool }} Z".into(),
        spindle_clockwise: call.into(),
        spindle_stop: "M5".into(),
        dwell: "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL {{ seconds }}".into(),
        footer: "M5\nM30\nEND PGM {{ name }} {{ units }}".into(),
        ..Lines::default()
    }
}

/// The dialect.
pub(crate) struct Heidenhain;

impl Dialect for Heidenhain {
    fn name(&self) -> &str {
        "heidenhain"
    }

    fn about(&self) -> &str {
        "Heidenhain iTNC 530 and TNC 6xx, conversational"
    }

    fn extension(&self) -> &str {
        "h"
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { arcs: true, tool_change: true, path_tolerance: true }
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn io::Write) -> Result<(), PostError> {
        let units_word = match program.units {
            Units::Mm => "MM",
            Units::Inch => "INCH",
        };
        let common = Common { name_length: NAME_LENGTH, ..Common::new(self.name(), units_word) };
        let (abilities, lines, engine) = (abilities(), lines(), template::engine());
        let writer = HeidenhainWriter {
            program,
            sheet: Sheet::new(&engine, &lines, common, program)?,
            comments: comment_style(),
            grid: Grid::lengths(program.units, abilities.numbers),
            feeds: Grid::feeds(program.units, abilities.numbers, abilities.feed_unit),
            blocks: Blocks::new(out, LINE_LIMIT, Some(&NUMBERING)),
            tool: None,
            start: None,
        };
        front::post(self.name(), &abilities, program, writer)
    }
}

/// A program being written.
struct HeidenhainWriter<'a> {
    program: &'a Program<'a>,
    sheet: Sheet<'a>,
    comments: CommentStyle,
    grid: Grid,
    feeds: Grid,
    blocks: Blocks<'a>,
    /// A tool that is still to be called, in one block with its speed.
    tool: Option<u32>,
    /// The M that starts the spindle, still to be written.
    start: Option<&'static str>,
}

impl Writer for HeidenhainWriter<'_> {
    fn head(&mut self) -> Result<(), PostError> {
        self.lines(|lines| &lines.opening, &[])?;
        if let Some(Stock { min, max }) = self.blank()? {
            self.corner("BLK FORM 0.1 Z", min)?;
            self.corner("BLK FORM 0.2", max)?;
        }
        self.comment("Carvegraph: ", self.program.title)?;
        for remark in self.program.remarks {
            self.comment(MARK, remark)?;
        }
        if self.program.path_tolerance_mm == 0.0 {
            return Ok(());
        }
        // In the plain form of lengths, without a sign.
        let grid = Grid::lengths(self.program.units, iso6983::settings().numbers);
        let tolerance = front::path_tolerance(self.program, grid)?;
        self.lines(|lines| &lines.path_tolerance, &[("tolerance", tolerance)])
    }

    fn comment(&mut self, mark: &str, text: &str) -> Result<(), PostError> {
        for line in comments(&self.comments, mark, text, LINE_LIMIT - NUMBER_WIDTH) {
            self.blocks.line(&line)?;
        }
        Ok(())
    }

    fn tool_change(&mut self, number: u32) -> Result<(), PostError> {
        self.tool_call()?;
        self.tool = Some(number);
        Ok(())
    }

    fn spindle(&mut self, rpm: u32, direction: Direction) -> Result<(), PostError> {
        let tool = Value::from(self.tool.take().unwrap_or(0));
        let values = [("tool", tool), ("rpm", Value::from(rpm))];
        self.lines(|lines| &lines.spindle_clockwise, &values)?;
        self.start = Some(match direction {
            Direction::Clockwise => "M3",
            Direction::CounterClockwise => "M4",
        });
        Ok(())
    }

    fn spindle_stop(&mut self) -> Result<(), PostError> {
        self.pending()?;
        self.lines(|lines| &lines.spindle_stop, &[])
    }

    fn dwell(&mut self, milliseconds: i64) -> Result<(), PostError> {
        self.pending()?;
        let seconds = Value::from(milliseconds as f64 / 1000.0);
        self.lines(|lines| &lines.dwell, &[("seconds", seconds)])
    }

    fn rapid(&mut self, rapid: Rapid) -> Result<(), PostError> {
        self.tool_call()?;
        self.blocks.word("L");
        self.axes(rapid.to, rapid.axes);
        self.blocks.word("R0 FMAX");
        if let Some(start) = self.start.take() {
            self.blocks.word(start);
        }
        self.blocks.end()
    }

    #[inline]
    fn line(&mut self, from: [i64; 3], to: [i64; 3], feed: Option<i64>) -> Result<(), PostError> {
        self.pending()?;
        self.blocks.word("L");
        self.axes(to, [0, 1, 2].map(|axis| to[axis] != from[axis]));
        self.feed(feed);
        self.blocks.end()
    }

    fn arc(&mut self, turn: &Turn) -> Result<(), PostError> {
        self.pending()?;
        let center = [turn.from[0] + turn.offset[0], turn.from[1] + turn.offset[1], 0];
        self.blocks.word("CC");
        self.axes(center, [true, true, false]);
        self.blocks.end()?;
        let (sign, direction) = match turn.direction {
            Direction::Clockwise => (-1.0, "DR-"),
            Direction::CounterClockwise => (1.0, "DR+"),
        };
        let helix = turn.to[2] != turn.from[2];
        if helix {
            // An angle is written as a length in mm is.
            let angle = Grid::lengths(Units::Mm, abilities().numbers);
            self.blocks.word("CP IPA");
            self.blocks.digits(angle, angle.round(sign * turn.sweep_rad.to_degrees()));
            self.axes(turn.to, [false, false, true]);
        } else {
            self.blocks.word("C");
            self.axes(turn.to, [true, true, false]);
        }
        self.blocks.word(direction);
        self.feed(turn.feed);
        self.blocks.end()?;
        if helix && turn.to[..2] != turn.from[..2] {
            self.blocks.word("L");
            self.axes(turn.to, [true, true, false]);
            self.blocks.end()?;
        }
        Ok(())
    }

    fn end(mut self) -> Result<(), PostError> {
        self.pending()?;
        self.lines(|lines| &lines.footer, &[])?;
        self.blocks.finish()
    }
}

impl HeidenhainWriter<'_> {
    fn lines(&mut self, pick: Pick, values: &[(&'static str, Value)]) -> Result<(), PostError> {
        self.sheet.write(pick, values, &mut self.blocks)
    }

    fn corner(&mut self, words: &str, point: [f64; 3]) -> Result<(), PostError> {
        self.blocks.word(words);
        self.axes(point.map(|c| self.grid.round(c)), [true; 3]);
        self.blocks.end()
    }

    /// The block to cut from: the program's stock or, if it has none, what its cuts pass through.
    fn blank(&self) -> Result<Option<Stock>, PostError> {
        if let Some(Stock { min, max }) = self.program.stock {
            let good = |axis: usize| {
                let [low, high] = [min[axis], max[axis]];
                low <= high && low >= -COORDINATE_LIMIT_MM && high <= COORDINATE_LIMIT_MM
            };
            if !(0..3).all(good) {
                return Err(PostError::Stock { min, max });
            }
            let max = [0, 1, 2].map(|axis| max[axis].max(min[axis] + LEAST_BLANK_MM));
            return Ok(Some(Stock { min, max }));
        }
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for command in self.program.commands {
            let to = match *command {
                Command::Feed { to, .. } => to,
                Command::Arc { arc } => match self.program.arcs.get(arc as usize) {
                    Some(arc) => arc.to,
                    None => continue,
                },
                _ => continue,
            };
            // A coordinate that is none is refused when its command's turn comes.
            for axis in 0..3 {
                if to[axis].abs() <= COORDINATE_LIMIT_MM {
                    min[axis] = min[axis].min(to[axis]);
                    max[axis] = max[axis].max(to[axis]);
                }
            }
        }
        let max = [0, 1, 2].map(|axis| max[axis].max(min[axis] + LEAST_BLANK_MM));
        Ok(min.iter().all(|c| c.is_finite()).then_some(Stock { min, max }))
    }

    /// Calls a tool whose speed nobody has given.
    fn tool_call(&mut self) -> Result<(), PostError> {
        match self.tool.take() {
            Some(number) => {
                self.lines(|lines| &lines.tool_change, &[("tool", Value::from(number))])
            }
            None => Ok(()),
        }
    }

    /// Writes what was waiting for a rapid to go with.
    #[inline]
    fn pending(&mut self) -> Result<(), PostError> {
        if self.tool.is_none() && self.start.is_none() {
            return Ok(());
        }
        self.tool_call()?;
        match self.start.take() {
            Some(start) => self.blocks.line(start),
            None => Ok(()),
        }
    }

    #[inline]
    fn axes(&mut self, point: [i64; 3], axes: [bool; 3]) {
        for axis in 0..3 {
            if axes[axis] {
                self.blocks.number(b"XYZ"[axis], self.grid, point[axis]);
            }
        }
    }

    #[inline]
    fn feed(&mut self, feed: Option<i64>) {
        if let Some(feed) = feed {
            self.blocks.number(b'F', self.feeds, feed);
        }
    }
}

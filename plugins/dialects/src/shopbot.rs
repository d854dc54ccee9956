//! ShopBot, in its OpenSBP language.
//!
//! Source: ShopBot's Command Reference, and what its users' posts write.
//!
//! * `M3` is a move of three axes. The spindle's speed is `TR`, in rpm; macro `C6` starts it and
//!   `C7` stops it. It turns one way only.
//! * Speeds are per second: `MS` for cuts, the same for XY and Z, for the path's speed is meant.
//!   Jogs (`J`) go at the operator's speeds.
//! * The control's own units count: `%(25)` is 0 for inches and 1 for millimetres, and a program for
//!   the other one jumps to its end before anything moves.
//! * `CG` is an arc in XY, 1 for clockwise. How it takes full circles and Z is not sure: larger arcs
//!   are halved, helices and arcs in other planes become lines.
//! * Macro `C9` changes to the tool in `&Tool`. Comments begin with `'`.

use crate::Text;
use crate::block::Blocks;
use crate::comment::{CommentStyle, MARK, brackets, comments};
use crate::front::{self, Abilities, Arcs, Rapid, Tools, Turn, Writer};
use crate::grbl::SPIN_UP_S;
use crate::iso6983;
use crate::lines::{Common, Lines, Pick, Sheet};
use crate::number::{FeedUnit, Grid};
use crate::template;
use carvegraph_sdk::{Capabilities, Dialect, Direction, PostError, Program, Units};
use minijinja::value::Value;
use std::io;

/// No limit is known; no line comes near.
const LINE_LIMIT: usize = 255;

/// Tool numbers beyond are warned of.
const TOOL_LIMIT: u32 = 99;

fn comment_style() -> CommentStyle {
    CommentStyle { open: "'".into(), close: "".into(), ..brackets() }
}

fn abilities() -> Abilities {
    Abilities {
        feed_unit: FeedUnit::PerSecond,
        arcs: Some(Arcs { all_planes: false, helices: false, sweep_limit_deg: 180.0 }),
        tools: Tools::UpTo(TOOL_LIMIT),
        counterclockwise: false,
        spin_up_s: Some(SPIN_UP_S),
        ..iso6983::settings().abilities()
    }
}

/// `units` is what `%(25)` must not be.
fn lines() -> Lines<Text> {
    Lines {
        header: "IF %(25)={{ units }} THEN GOTO UNIT_ERROR\nSA".into(),
        tool_change: "&Tool = {{ tool }}\nC9".into(),
        spindle_clockwise: "TR,{{ rpm }}\nC6".into(),
        spindle_stop: "C7".into(),
        dwell: "PAUSE {{ seconds }}".into(),
        footer: "END\nUNIT_ERROR:\nCN,91\nEND".into(),
        ..Lines::default()
    }
}

/// The dialect.
pub(crate) struct ShopBot;

impl Dialect for ShopBot {
    fn name(&self) -> &str {
        "shopbot"
    }

    fn about(&self) -> &str {
        "ShopBot and Handibot routers, OpenSBP"
    }

    fn extension(&self) -> &str {
        "sbp"
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { arcs: true, tool_change: true, path_tolerance: false }
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn io::Write) -> Result<(), PostError> {
        let wrong_units = match program.units {
            Units::Mm => "0",
            Units::Inch => "1",
        };
        let common = Common::new(self.name(), wrong_units);
        let (abilities, lines, engine) = (abilities(), lines(), template::engine());
        let writer = ShopBotWriter {
            program,
            sheet: Sheet::new(&engine, &lines, common, program)?,
            comments: comment_style(),
            grid: Grid::lengths(program.units, abilities.numbers),
            feeds: Grid::feeds(program.units, abilities.numbers, abilities.feed_unit),
            blocks: Blocks::new(out, LINE_LIMIT, None),
        };
        front::post(self.name(), &abilities, program, writer)
    }
}

/// A program being written.
struct ShopBotWriter<'a> {
    program: &'a Program<'a>,
    sheet: Sheet<'a>,
    comments: CommentStyle,
    grid: Grid,
    feeds: Grid,
    blocks: Blocks<'a>,
}

impl Writer for ShopBotWriter<'_> {
    fn head(&mut self) -> Result<(), PostError> {
        self.comment("Carvegraph: ", self.program.title)?;
        for remark in self.program.remarks {
            self.comment(MARK, remark)?;
        }
        self.lines(|lines| &lines.header, &[])
    }

    fn comment(&mut self, mark: &str, text: &str) -> Result<(), PostError> {
        for line in comments(&self.comments, mark, text, LINE_LIMIT) {
            self.blocks.line(&line)?;
        }
        Ok(())
    }

    fn tool_change(&mut self, number: u32) -> Result<(), PostError> {
        self.lines(|lines| &lines.tool_change, &[("tool", Value::from(number))])
    }

    fn spindle(&mut self, rpm: u32, _: Direction) -> Result<(), PostError> {
        self.lines(|lines| &lines.spindle_clockwise, &[("rpm", Value::from(rpm))])
    }

    fn spindle_stop(&mut self) -> Result<(), PostError> {
        self.lines(|lines| &lines.spindle_stop, &[])
    }

    fn dwell(&mut self, milliseconds: i64) -> Result<(), PostError> {
        let seconds = Value::from(milliseconds as f64 / 1000.0);
        self.lines(|lines| &lines.dwell, &[("seconds", seconds)])
    }

    fn rapid(&mut self, rapid: Rapid) -> Result<(), PostError> {
        self.travel(["JX", "JY", "JZ", "J2", "J3"], rapid.to, rapid.axes)
    }

    #[inline]
    fn line(&mut self, from: [i64; 3], to: [i64; 3], feed: Option<i64>) -> Result<(), PostError> {
        self.speed(feed)?;
        let axes = [0, 1, 2].map(|axis| to[axis] != from[axis]);
        self.travel(["MX", "MY", "MZ", "M2", "M3"], to, axes)
    }

    fn arc(&mut self, turn: &Turn) -> Result<(), PostError> {
        self.speed(turn.feed)?;
        self.blocks.word("CG,");
        for steps in [turn.to[0], turn.to[1], turn.offset[0], turn.offset[1]] {
            self.value(self.grid, steps);
        }
        self.blocks.text(match turn.direction {
            Direction::Clockwise => ",T,1",
            Direction::CounterClockwise => ",T,-1",
        });
        self.blocks.end()
    }

    fn end(mut self) -> Result<(), PostError> {
        self.spindle_stop()?;
        self.lines(|lines| &lines.footer, &[])?;
        self.blocks.finish()
    }
}

impl ShopBotWriter<'_> {
    fn lines(&mut self, pick: Pick, values: &[(&'static str, Value)]) -> Result<(), PostError> {
        self.sheet.write(pick, values, &mut self.blocks)
    }

    /// A move by the command for the axes that change: X, Y, Z, XY or all.
    #[inline]
    fn travel(
        &mut self,
        commands: [&str; 5],
        to: [i64; 3],
        axes: [bool; 3],
    ) -> Result<(), PostError> {
        let (command, axes): (_, &[usize]) = match axes {
            [true, false, false] => (commands[0], &[0]),
            [false, true, false] => (commands[1], &[1]),
            [false, false, true] => (commands[2], &[2]),
            [true, true, false] => (commands[3], &[0, 1]),
            _ => (commands[4], &[0, 1, 2]),
        };
        self.blocks.word(command);
        for &axis in axes {
            self.value(self.grid, to[axis]);
        }
        self.blocks.end()
    }

    #[inline]
    fn speed(&mut self, feed: Option<i64>) -> Result<(), PostError> {
        let Some(feed) = feed else { return Ok(()) };
        self.blocks.word("MS");
        self.value(self.feeds, feed);
        self.value(self.feeds, feed);
        self.blocks.end()
    }

    #[inline]
    fn value(&mut self, grid: Grid, steps: i64) {
        self.blocks.text(",");
        self.blocks.digits(grid, steps);
    }
}

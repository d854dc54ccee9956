//! The core of all word-address dialects (RS-274/NGC, ISO 6983).
//!
//! Goes through a program once, knowing what the controller knows (position, motion mode, plane,
//! feed, spindle), and writes a word only where it changes something:
//!
//! * Points are rounded once, on the grid of the last decimal place; a move that ends where it
//!   begins leaves no block.
//! * F stands in the first feed move and wherever it changes. Controllers keep it across rapids.
//! * Rapids never move Z and XY in one block: controllers may run them as dog-legs. Upwards Z goes
//!   first, downwards last; from an unknown position (the start, after a tool change) Z goes first.
//! * Arcs carry both axes of their plane and both offsets, incremental, see [`crate::arc`].
//! * A program that would be wrong is refused.
//!
//! It neither selects nor shifts a work offset: the frame is the one that the operator has set.

use crate::arc::{PlaneArc, Written};
use crate::block::Blocks;
use crate::comment::{MARK, comments};
use crate::number::Grid;
use carvegraph_sdk::{
    Arc, Capabilities, Command, Dialect, Direction, Plane, PostError, Program, Units,
};
use std::io;

/// A kilometre: nothing that is carved lies farther away, and a number that large is a mistake.
const COORDINATE_LIMIT_MM: f64 = 1e6;

/// A kilometre a minute.
const FEED_LIMIT_MM_PER_MIN: f64 = 1e6;

/// Ten times the fastest dental spindle.
const SPINDLE_LIMIT_RPM: f64 = 5e6;

/// Ten metres. GRBL computes in 32-bit floats, which at larger radii hold no micrometre.
const ARC_RADIUS_LIMIT_MM: f64 = 10_000.0;

/// By how much an arc's radii may differ before rounding, which makes them agree. More is no error of
/// arithmetic but an arc that somebody got wrong, and it would be cut wrong.
const ARC_RADIUS_TOLERANCE_MM: f64 = 0.001;

/// What a dialect does differently. Fields are said once, in [`ISO`]; a dialect overrides some.
pub(crate) struct Rs274 {
    pub(crate) name: &'static str,
    pub(crate) about: &'static str,
    pub(crate) extension: &'static str,
    /// Characters in a block or comment that the controller reads.
    pub(crate) line_limit: usize,
    /// Modes set at the head, after plane and units.
    pub(crate) modes: &'static str,
    /// Whether `G64 P Q` sets the path tolerance.
    pub(crate) path_tolerance: bool,
    pub(crate) tool_change: ToolChange,
    /// Dwell after the spindle starts, where the controller does not wait by itself.
    pub(crate) spin_up_s: Option<f64>,
    pub(crate) dwell_limit_s: f64,
    /// How a program ends.
    pub(crate) end: &'static str,
}

/// How a dialect changes tools.
pub(crate) enum ToolChange {
    /// Not at all; this is what to tell the user.
    None(&'static str),
    /// `T M6`, then the tool's length by `G43`.
    M6 {
        /// The greatest tool number.
        limit: u32,
    },
}

/// What dialects override; not a dialect itself.
pub(crate) const ISO: Rs274 = Rs274 {
    name: "iso",
    about: "ISO 6983",
    extension: "nc",
    line_limit: 79,
    modes: "G90 G94",
    path_tolerance: false,
    tool_change: ToolChange::None("tool changes are not known to this controller"),
    spin_up_s: None,
    dwell_limit_s: 3600.0,
    end: "M30",
};

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
            tool_change: matches!(self.tool_change, ToolChange::M6 { .. }),
            path_tolerance: self.path_tolerance,
        }
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn io::Write) -> Result<(), PostError> {
        let mut post = Post::new(self, program, out);
        post.head()?;
        for (index, command) in program.commands.iter().enumerate() {
            post.index = index;
            post.command(command)?;
        }
        post.end()
    }
}

/// The motion mode the controller is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Motion {
    Rapid,
    Feed,
    Arc(Direction),
}

/// Where the tip is.
#[derive(Clone, Copy, Debug)]
struct Position {
    /// As the program means it, in mm.
    meant: [f64; 3],
    /// As it was written, in steps.
    written: [i64; 3],
}

/// A program being written, and what the controller knows by now.
struct Post<'a> {
    dialect: &'a Rs274,
    program: &'a Program<'a>,
    grid: Grid,
    blocks: Blocks<'a>,
    /// Index of the command being written.
    index: usize,
    position: Option<Position>,
    motion: Option<Motion>,
    plane: Plane,
    /// In steps a minute.
    feed: Option<i64>,
    spindle: Option<Direction>,
    /// Whether a tool change stopped a spindle that nobody has started since.
    spindle_wanted: bool,
}

impl<'a> Post<'a> {
    fn new(dialect: &'a Rs274, program: &'a Program<'a>, out: &'a mut dyn io::Write) -> Self {
        Self {
            dialect,
            program,
            grid: Grid::of(program.units),
            blocks: Blocks::new(out, dialect.line_limit),
            index: 0,
            position: None,
            motion: None,
            plane: Plane::Xy,
            feed: None,
            spindle: None,
            spindle_wanted: false,
        }
    }

    fn head(&mut self) -> Result<(), PostError> {
        self.comment("Carvegraph: ", self.program.title)?;
        for remark in self.program.remarks {
            self.comment(MARK, remark)?;
        }
        self.blocks.word("G17");
        self.blocks.word(match self.program.units {
            Units::Mm => "G21",
            Units::Inch => "G20",
        });
        self.blocks.line(self.dialect.modes)?;
        if self.dialect.path_tolerance { self.path_tolerance() } else { Ok(()) }
    }

    /// Rounded down, but not to 0, which to LinuxCNC means that any departure will do.
    fn path_tolerance(&mut self) -> Result<(), PostError> {
        let tolerance = self.program.path_tolerance_mm;
        if !(tolerance > 0.0 && tolerance <= COORDINATE_LIMIT_MM) {
            return Err(PostError::PathTolerance(tolerance));
        }
        // 0.57 mm must not become 0.569 for the last bit of a product.
        let steps = ((self.grid.steps(tolerance) + 1e-6) as i64).max(1);
        self.blocks.word("G64");
        self.blocks.number(b'P', self.grid, steps);
        self.blocks.number(b'Q', self.grid, steps);
        self.blocks.end()
    }

    fn end(mut self) -> Result<(), PostError> {
        self.blocks.line("M5")?;
        self.blocks.line(self.dialect.end)?;
        self.blocks.finish()
    }

    #[inline]
    fn command(&mut self, command: &Command) -> Result<(), PostError> {
        match *command {
            Command::Feed { to, mm_per_min } => self.feed(to, mm_per_min),
            Command::Rapid { to } => self.rapid(to),
            Command::Arc { arc } => {
                let arc = self.entry(self.program.arcs, "arc", arc)?;
                self.arc(&arc)
            }
            Command::Comment { text } => {
                let text = self.entry(self.program.texts, "text", text)?;
                self.comment(MARK, text)
            }
            Command::ToolChange { number } => self.tool_change(number),
            Command::Spindle { rpm, direction } => self.spindle(rpm, direction),
            Command::SpindleStop => self.spindle_stop(),
            Command::Dwell { seconds } => self.dwell(seconds),
            _ => Err(PostError::Unsupported {
                command: self.index,
                message: format!("{} does not know this command: {command:?}", self.dialect.name),
            }),
        }
    }

    fn entry<T: Copy>(&self, table: &[T], name: &'static str, index: u32) -> Result<T, PostError> {
        table.get(index as usize).copied().ok_or(PostError::Index {
            command: self.index,
            table: name,
            index,
            length: table.len(),
        })
    }

    fn comment(&mut self, mark: &str, text: &str) -> Result<(), PostError> {
        for line in comments(mark, text, self.dialect.line_limit) {
            self.blocks.line(&line)?;
        }
        Ok(())
    }

    fn tool_change(&mut self, number: u32) -> Result<(), PostError> {
        let limit = match self.dialect.tool_change {
            ToolChange::M6 { limit } => limit,
            ToolChange::None(message) => {
                let message = message.to_owned();
                return Err(PostError::Unsupported { command: self.index, message });
            }
        };
        if number == 0 || number > limit {
            return Err(PostError::ToolNumber { command: self.index, number, limit });
        }
        self.spindle_wanted |= self.spindle.is_some();
        self.spindle_stop()?;
        self.blocks.whole('T', number);
        self.blocks.line("M6")?;
        self.blocks.line("G43")?;
        // A controller may move during a change and run a macro of its own.
        self.position = None;
        self.motion = None;
        self.feed = None;
        Ok(())
    }

    fn spindle(&mut self, rpm: f64, direction: Direction) -> Result<(), PostError> {
        if !(rpm.round() >= 1.0 && rpm <= SPINDLE_LIMIT_RPM) {
            let limit_rpm = SPINDLE_LIMIT_RPM;
            return Err(PostError::SpindleSpeed { command: self.index, rpm, limit_rpm });
        }
        self.blocks.word(match direction {
            Direction::Clockwise => "M3",
            Direction::CounterClockwise => "M4",
        });
        self.blocks.whole('S', rpm.round() as u32);
        self.blocks.end()?;
        let turning = self.spindle.replace(direction) == Some(direction);
        self.spindle_wanted = false;
        match self.dialect.spin_up_s {
            Some(seconds) if !turning => self.dwell(seconds),
            _ => Ok(()),
        }
    }

    fn spindle_stop(&mut self) -> Result<(), PostError> {
        self.spindle = None;
        self.blocks.line("M5")
    }

    fn dwell(&mut self, seconds: f64) -> Result<(), PostError> {
        let limit_seconds = self.dialect.dwell_limit_s;
        if !(0.0..=limit_seconds).contains(&seconds) {
            return Err(PostError::Dwell { command: self.index, seconds, limit_seconds });
        }
        self.blocks.word("G4");
        self.blocks.number(b'P', Grid::THOUSANDTHS, Grid::THOUSANDTHS.round(seconds));
        self.blocks.end()
    }

    fn rapid(&mut self, to: [f64; 3]) -> Result<(), PostError> {
        let to = self.position(to)?;
        let [x, y, z] = to.written;
        let from = self.position.replace(to).map(|p| p.written);
        let Some([x0, y0, z0]) = from else {
            self.rapid_block(&[(b'Z', z)])?;
            return self.rapid_block(&[(b'X', x), (b'Y', y)]);
        };
        if z > z0 {
            self.rapid_block(&[(b'Z', z)])?;
        }
        match (x != x0, y != y0) {
            (true, true) => self.rapid_block(&[(b'X', x), (b'Y', y)])?,
            (true, false) => self.rapid_block(&[(b'X', x)])?,
            (false, true) => self.rapid_block(&[(b'Y', y)])?,
            (false, false) => {}
        }
        if z < z0 { self.rapid_block(&[(b'Z', z)]) } else { Ok(()) }
    }

    fn rapid_block(&mut self, words: &[(u8, i64)]) -> Result<(), PostError> {
        self.motion(Motion::Rapid);
        for &(letter, steps) in words {
            self.blocks.number(letter, self.grid, steps);
        }
        self.blocks.end()
    }

    #[inline]
    fn feed(&mut self, to: [f64; 3], mm_per_min: f64) -> Result<(), PostError> {
        let from = self.cutting_from()?;
        let feed = self.feed_steps(mm_per_min)?;
        let to = self.position(to)?;
        self.position = Some(to);
        self.line(from.written, to.written, feed)
    }

    /// A straight cut, where it leads anywhere.
    #[inline]
    fn line(&mut self, from: [i64; 3], to: [i64; 3], feed: i64) -> Result<(), PostError> {
        if from == to {
            return Ok(());
        }
        self.motion(Motion::Feed);
        for axis in 0..3 {
            if to[axis] != from[axis] {
                self.blocks.number(b"XYZ"[axis], self.grid, to[axis]);
            }
        }
        self.feed_word(feed);
        self.blocks.end()
    }

    fn arc(&mut self, arc: &Arc) -> Result<(), PostError> {
        let from = self.cutting_from()?;
        let feed = self.feed_steps(arc.mm_per_min)?;
        let to = self.position(arc.to)?;
        let in_plane = self.plane_arc(arc, from, to)?;
        self.position = Some(to);
        let [first, second, _] = arc.plane.axes();
        let mut end = to.written;
        match in_plane.written() {
            Written::Line => self.line(from.written, end, feed),
            Written::Arc { to: turned, offset } => {
                [end[first], end[second]] = turned;
                self.arc_block(arc, from.written, end, offset, feed)?;
                self.line(end, to.written, feed)
            }
        }
    }

    /// What there is to know of an arc in its plane, in steps.
    fn plane_arc(&self, arc: &Arc, from: Position, to: Position) -> Result<PlaneArc, PostError> {
        let [first, second, _] = arc.plane.axes();
        let steps = |p: [f64; 3]| [first, second].map(|axis| self.grid.steps(p[axis]));
        self.coordinate(arc.center[first], first)?;
        self.coordinate(arc.center[second], second)?;
        let in_plane = PlaneArc {
            meant_start: steps(from.meant),
            meant_end: steps(to.meant),
            center: steps(arc.center),
            direction: arc.direction,
            start: [from.written[first], from.written[second]],
            end: [to.written[first], to.written[second]],
        };
        let [start_mm, end_mm] = in_plane.radii().map(|r| r * self.grid.step_mm());
        if (start_mm - end_mm).abs() > ARC_RADIUS_TOLERANCE_MM {
            let limit_mm = ARC_RADIUS_TOLERANCE_MM;
            return Err(PostError::ArcRadius { command: self.index, start_mm, end_mm, limit_mm });
        }
        if start_mm > ARC_RADIUS_LIMIT_MM {
            let (radius_mm, limit_mm) = (start_mm, ARC_RADIUS_LIMIT_MM);
            return Err(PostError::ArcTooFlat { command: self.index, radius_mm, limit_mm });
        }
        Ok(in_plane)
    }

    fn arc_block(
        &mut self,
        arc: &Arc,
        from: [i64; 3],
        to: [i64; 3],
        offset: [i64; 2],
        feed: i64,
    ) -> Result<(), PostError> {
        self.select_plane(arc.plane)?;
        self.motion(Motion::Arc(arc.direction));
        let [first, second, normal] = arc.plane.axes();
        for axis in 0..3 {
            if axis != normal || to[axis] != from[axis] {
                self.blocks.number(b"XYZ"[axis], self.grid, to[axis]);
            }
        }
        let mut offsets = [(first, offset[0]), (second, offset[1])];
        offsets.sort_unstable();
        for (axis, steps) in offsets {
            self.blocks.number(b"IJK"[axis], self.grid, steps);
        }
        self.feed_word(feed);
        self.blocks.end()
    }

    fn select_plane(&mut self, plane: Plane) -> Result<(), PostError> {
        if self.plane == plane {
            return Ok(());
        }
        self.plane = plane;
        self.blocks.line(match plane {
            Plane::Xy => "G17",
            Plane::Zx => "G18",
            Plane::Yz => "G19",
        })
    }

    /// The motion word, where the mode changes.
    #[inline]
    fn motion(&mut self, motion: Motion) {
        if self.motion.replace(motion) != Some(motion) {
            self.blocks.word(match motion {
                Motion::Rapid => "G0",
                Motion::Feed => "G1",
                Motion::Arc(Direction::Clockwise) => "G2",
                Motion::Arc(Direction::CounterClockwise) => "G3",
            });
        }
    }

    /// The F word, where the feed changes.
    #[inline]
    fn feed_word(&mut self, feed: i64) {
        if self.feed.replace(feed) != Some(feed) {
            self.blocks.number(b'F', self.grid, feed);
        }
    }

    /// Where a cutting move begins.
    #[inline]
    fn cutting_from(&self) -> Result<Position, PostError> {
        if self.spindle_wanted {
            return Err(PostError::SpindleStopped { command: self.index });
        }
        self.position.ok_or(PostError::PositionUnknown { command: self.index })
    }

    /// A feed in steps a minute, at least one.
    #[inline]
    fn feed_steps(&self, mm_per_min: f64) -> Result<i64, PostError> {
        if mm_per_min > 0.0 && mm_per_min <= FEED_LIMIT_MM_PER_MIN {
            let steps = self.grid.round(mm_per_min);
            if steps > 0 {
                return Ok(steps);
            }
        }
        let limit_mm_per_min = FEED_LIMIT_MM_PER_MIN;
        Err(PostError::Feed { command: self.index, mm_per_min, limit_mm_per_min })
    }

    #[inline]
    fn position(&self, meant: [f64; 3]) -> Result<Position, PostError> {
        let [x, y, z] = meant;
        let written = [self.coordinate(x, 0)?, self.coordinate(y, 1)?, self.coordinate(z, 2)?];
        Ok(Position { meant, written })
    }

    #[inline]
    fn coordinate(&self, value_mm: f64, axis: usize) -> Result<i64, PostError> {
        if value_mm.abs() <= COORDINATE_LIMIT_MM {
            return Ok(self.grid.round(value_mm));
        }
        let (axis, limit_mm) = (char::from(b"XYZ"[axis]), COORDINATE_LIMIT_MM);
        Err(PostError::Coordinate { command: self.index, axis, value_mm, limit_mm })
    }
}

//! The front of every dialect: goes through a program once and hands its steps, checked and rounded,
//! to the writer of a controller's language.
//!
//! * Points are rounded once, on the grid of the last decimal place; a move that ends where it
//!   begins is none.
//! * A feed is handed over in the first cut and wherever it changes. Controllers keep it across
//!   rapids.
//! * Rapids never move Z and XY at once: controllers may run them as dog-legs. Upwards Z goes first,
//!   downwards last. From an unknown position (the start, after a tool change) Z goes first, but
//!   last where the controller was sent to the top before.
//! * Start, end and centre of an arc are rounded together, see [`crate::arc`]. An arc that turns
//!   farther than the controller may be told is halved; one that it does not know becomes chords, and
//!   so do all where the program wants lines only.
//! * A program that would be wrong is refused.
//!
//! It neither selects nor shifts a work offset: the frame is the one that the operator has set.

use crate::Text;
use crate::arc::{PlaneArc, Written};
use crate::comment::MARK;
use crate::number::{FeedUnit, Grid, NumberFormat};
use carvegraph_sdk::{Arc, Command, Direction, Plane, PostError, Program};
use minijinja::value::Value;

/// A kilometre: nothing that is carved lies farther away, and a number that large is a mistake.
pub(crate) const COORDINATE_LIMIT_MM: f64 = 1e6;

/// A kilometre a minute.
pub(crate) const FEED_LIMIT_MM_PER_MIN: f64 = 1e6;

/// Ten times the fastest dental spindle.
pub(crate) const SPINDLE_LIMIT_RPM: f64 = 5e6;

/// Ten metres. GRBL computes in 32-bit floats, which at larger radii hold no micrometre.
const ARC_RADIUS_LIMIT_MM: f64 = 10_000.0;

/// LinuxCNC rejects radii below 0.00127 mm, and finer steps do not change that. Rounding may take a
/// third of this away.
const LEAST_RADIUS_MM: f64 = 0.002;

/// By how much an arc's radii may differ before rounding, which makes them agree. More is no error of
/// arithmetic but an arc that somebody got wrong, and it would be cut wrong.
const ARC_RADIUS_TOLERANCE_MM: f64 = 0.001;

/// Chords leave their arc by this many steps where the program gives no tolerance: no more than a
/// written arc may.
const CHORD_STEPS: f64 = 2.0;

/// What a controller can do and how it counts: all that the front asks of a dialect.
#[derive(Clone, Debug)]
pub(crate) struct Abilities {
    pub(crate) numbers: NumberFormat,
    pub(crate) feed_unit: FeedUnit,
    /// Which arcs it takes; with none all become chords.
    pub(crate) arcs: Option<Arcs>,
    /// Whether a rapid moves one axis at a time, across the work too.
    pub(crate) single_axis_rapids: bool,
    /// Whether the writer sends Z to the machine's top before the first rapid and before a tool
    /// change, so that from there XY goes first.
    pub(crate) starts_high: bool,
    pub(crate) tools: Tools,
    /// Whether the spindle can be told to turn counter-clockwise.
    pub(crate) counterclockwise: bool,
    /// Dwell after the spindle starts, where the controller does not wait by itself.
    pub(crate) spin_up_s: Option<f64>,
    pub(crate) dwell_limit_s: f64,
    /// Speed of rapids, where the controller does not have one of its own.
    pub(crate) rapid_mm_per_min: Option<f64>,
}

/// Which arcs a controller takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arcs {
    /// Whether in all planes, or in XY only.
    pub(crate) all_planes: bool,
    /// Whether also off the plane.
    pub(crate) helices: bool,
    /// The largest angle that one arc may turn through, in degrees; 360 takes full circles.
    pub(crate) sweep_limit_deg: f64,
}

impl Arcs {
    /// All there are.
    pub(crate) const ALL: Self = Self { all_planes: true, helices: true, sweep_limit_deg: 360.0 };
}

/// Whether a controller changes tools.
#[derive(Clone, Debug)]
pub(crate) enum Tools {
    /// No; this is what to tell the user, behind the dialect's name.
    None(Text),
    /// Yes, up to this number.
    UpTo(u32),
}

/// A rapid of some axes, in steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rapid {
    pub(crate) to: [i64; 3],
    /// Which axes move.
    pub(crate) axes: [bool; 3],
    /// Its speed where it has one that changes.
    pub(crate) feed: Option<i64>,
}

/// An arc with its start and end, in steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    pub(crate) plane: Plane,
    pub(crate) direction: Direction,
    pub(crate) from: [i64; 3],
    pub(crate) to: [i64; 3],
    /// From the start to the centre, along the plane's first and second axis.
    pub(crate) offset: [i64; 2],
    /// The angle from start to end as they are written, in (0, 2π].
    pub(crate) sweep_rad: f64,
    /// Its speed where it changes.
    pub(crate) feed: Option<i64>,
}

/// Writes the steps of a program in a controller's language. Lengths and feeds are in steps of the
/// grids that [`Abilities`] define.
pub(crate) trait Writer {
    /// What comes before the first command.
    fn head(&mut self) -> Result<(), PostError>;
    /// A text as comments, the first beginning with `mark`.
    fn comment(&mut self, mark: &str, text: &str) -> Result<(), PostError>;
    /// A tool change; the spindle stands still.
    fn tool_change(&mut self, number: u32) -> Result<(), PostError>;
    /// Starts the spindle or changes its speed.
    fn spindle(&mut self, rpm: u32, direction: Direction) -> Result<(), PostError>;
    /// Stops the spindle.
    fn spindle_stop(&mut self) -> Result<(), PostError>;
    /// Waits.
    fn dwell(&mut self, milliseconds: i64) -> Result<(), PostError>;
    /// Travels.
    fn rapid(&mut self, rapid: Rapid) -> Result<(), PostError>;
    /// Cuts a line that leads somewhere, at a new feed if there is one.
    fn line(&mut self, from: [i64; 3], to: [i64; 3], feed: Option<i64>) -> Result<(), PostError>;
    /// Cuts an arc.
    fn arc(&mut self, turn: &Turn) -> Result<(), PostError>;
    /// What comes after the last command.
    fn end(self) -> Result<(), PostError>;
}

/// Writes `program` by `writer` for the dialect called `dialect`.
pub(crate) fn post<W: Writer>(
    dialect: &str,
    abilities: &Abilities,
    program: &Program<'_>,
    writer: W,
) -> Result<(), PostError> {
    let mut post = Post {
        dialect,
        abilities,
        program,
        grid: Grid::lengths(program.units, abilities.numbers),
        feeds: Grid::feeds(program.units, abilities.numbers, abilities.feed_unit),
        writer,
        index: 0,
        position: None,
        feed: None,
        spindle: None,
        spindle_wanted: false,
    };
    post.writer.head()?;
    for (index, command) in program.commands.iter().enumerate() {
        post.index = index;
        post.command(command)?;
    }
    post.writer.end()
}

/// The path tolerance in the program's units, for a template: rounded down to a whole step but not to
/// 0, which to LinuxCNC means that any departure will do.
pub(crate) fn path_tolerance(program: &Program<'_>, grid: Grid) -> Result<Value, PostError> {
    let tolerance = program.path_tolerance_mm;
    if !(tolerance > 0.0 && tolerance <= COORDINATE_LIMIT_MM) {
        return Err(PostError::PathTolerance(tolerance));
    }
    // 0.57 mm must not become 0.569 for the last bit of a product.
    let steps = ((grid.steps(tolerance) + 1e-6) as i64).max(1);
    Ok(Value::from(grid.number(steps)))
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
struct Post<'a, W> {
    dialect: &'a str,
    abilities: &'a Abilities,
    program: &'a Program<'a>,
    grid: Grid,
    feeds: Grid,
    writer: W,
    /// Index of the command being written.
    index: usize,
    position: Option<Position>,
    /// In steps of `feeds`.
    feed: Option<i64>,
    spindle: Option<Direction>,
    /// Whether a tool change stopped a spindle that nobody has started since.
    spindle_wanted: bool,
}

impl<W: Writer> Post<'_, W> {
    #[inline]
    fn command(&mut self, command: &Command) -> Result<(), PostError> {
        match *command {
            Command::Feed { to, mm_per_min } => self.cut(to, mm_per_min),
            Command::Rapid { to } => self.rapid(to),
            Command::Arc { arc } => {
                let arc = self.entry(self.program.arcs, "arc", arc)?;
                self.arc(&arc)
            }
            Command::Comment { text } => {
                let text = self.entry(self.program.texts, "text", text)?;
                self.writer.comment(MARK, text)
            }
            Command::ToolChange { number } => self.tool_change(number),
            Command::Spindle { rpm, direction } => self.spindle(rpm, direction),
            Command::SpindleStop => self.spindle_stop(),
            Command::Dwell { seconds } => self.dwell(seconds),
            _ => Err(self
                .unsupported(format!("{} does not know this command: {command:?}", self.dialect))),
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

    fn unsupported(&self, message: String) -> PostError {
        PostError::Unsupported { command: self.index, message }
    }

    fn tool_change(&mut self, number: u32) -> Result<(), PostError> {
        let limit = match &self.abilities.tools {
            Tools::UpTo(limit) => *limit,
            Tools::None(why) => {
                let words = "write one program for each tool";
                return Err(self.unsupported(format!("{} {why}: {words}", self.dialect)));
            }
        };
        if number == 0 || number > limit {
            return Err(PostError::ToolNumber { command: self.index, number, limit });
        }
        self.spindle_wanted |= self.spindle.is_some();
        self.spindle_stop()?;
        // A controller may move during a change and run a macro of its own.
        self.position = None;
        self.feed = None;
        self.writer.tool_change(number)
    }

    fn spindle(&mut self, rpm: f64, direction: Direction) -> Result<(), PostError> {
        if !(rpm.round() >= 1.0 && rpm <= SPINDLE_LIMIT_RPM) {
            let limit_rpm = SPINDLE_LIMIT_RPM;
            return Err(PostError::SpindleSpeed { command: self.index, rpm, limit_rpm });
        }
        if direction == Direction::CounterClockwise && !self.abilities.counterclockwise {
            return Err(self.unsupported(format!(
                "{} cannot turn the spindle counter-clockwise (M4)",
                self.dialect
            )));
        }
        self.writer.spindle(rpm.round() as u32, direction)?;
        let turning = self.spindle.replace(direction) == Some(direction);
        self.spindle_wanted = false;
        match self.abilities.spin_up_s {
            Some(seconds) if !turning => self.dwell(seconds),
            _ => Ok(()),
        }
    }

    fn spindle_stop(&mut self) -> Result<(), PostError> {
        self.spindle = None;
        self.writer.spindle_stop()
    }

    fn dwell(&mut self, seconds: f64) -> Result<(), PostError> {
        let limit_seconds = self.abilities.dwell_limit_s;
        if !(0.0..=limit_seconds).contains(&seconds) {
            return Err(PostError::Dwell { command: self.index, seconds, limit_seconds });
        }
        self.writer.dwell(Grid::THOUSANDTHS.round(seconds))
    }

    fn rapid(&mut self, to: [f64; 3]) -> Result<(), PostError> {
        let to = self.position(to)?;
        let from = self.position.replace(to).map(|p| p.written);
        let to = to.written;
        let Some(from) = from else {
            if self.abilities.starts_high {
                self.across(to, [true, true])?;
                return self.rapid_of(to, [false, false, true]);
            }
            self.rapid_of(to, [false, false, true])?;
            return self.across(to, [true, true]);
        };
        if to[2] > from[2] {
            self.rapid_of(to, [false, false, true])?;
        }
        self.across(to, [to[0] != from[0], to[1] != from[1]])?;
        if to[2] < from[2] { self.rapid_of(to, [false, false, true]) } else { Ok(()) }
    }

    /// A rapid in XY.
    fn across(&mut self, to: [i64; 3], [x, y]: [bool; 2]) -> Result<(), PostError> {
        match (x, y) {
            (false, false) => Ok(()),
            (true, true) if self.abilities.single_axis_rapids => {
                self.rapid_of(to, [true, false, false])?;
                self.rapid_of(to, [false, true, false])
            }
            _ => self.rapid_of(to, [x, y, false]),
        }
    }

    fn rapid_of(&mut self, to: [i64; 3], axes: [bool; 3]) -> Result<(), PostError> {
        let feed = match self.abilities.rapid_mm_per_min {
            Some(mm_per_min) => {
                let feed = self.feed_steps(mm_per_min)?;
                self.changed(feed)
            }
            None => None,
        };
        self.writer.rapid(Rapid { to, axes, feed })
    }

    #[inline]
    fn cut(&mut self, to: [f64; 3], mm_per_min: f64) -> Result<(), PostError> {
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
        let feed = self.changed(feed);
        self.writer.line(from, to, feed)
    }

    fn arc(&mut self, arc: &Arc) -> Result<(), PostError> {
        let from = self.cutting_from()?;
        let feed = self.feed_steps(arc.mm_per_min)?;
        let to = self.position(arc.to)?;
        self.check_arc(arc, from, to)?;
        self.position = Some(to);
        let [.., normal] = arc.plane.axes();
        let flat = from.written[normal] == to.written[normal];
        match &self.abilities.arcs {
            Some(can)
                if !self.program.lines_only
                    && (can.all_planes || arc.plane == Plane::Xy)
                    && (can.helices || flat) =>
            {
                self.turn(arc, can.sweep_limit_deg, from, to, feed)
            }
            _ => self.chords(arc, from, to, feed),
        }
    }

    fn check_arc(&self, arc: &Arc, from: Position, to: Position) -> Result<(), PostError> {
        let [first, second, _] = arc.plane.axes();
        self.coordinate(arc.center[first], first)?;
        self.coordinate(arc.center[second], second)?;
        let radii = self.plane_arc(arc, from, to).radii();
        let [start_mm, end_mm] = radii.map(|r| r * self.grid.step_mm());
        if (start_mm - end_mm).abs() > ARC_RADIUS_TOLERANCE_MM {
            let limit_mm = ARC_RADIUS_TOLERANCE_MM;
            return Err(PostError::ArcRadius { command: self.index, start_mm, end_mm, limit_mm });
        }
        if start_mm > ARC_RADIUS_LIMIT_MM {
            let (radius_mm, limit_mm) = (start_mm, ARC_RADIUS_LIMIT_MM);
            return Err(PostError::ArcTooFlat { command: self.index, radius_mm, limit_mm });
        }
        Ok(())
    }

    /// What there is to know of an arc, or of the part between two points, in its plane, in steps.
    fn plane_arc(&self, arc: &Arc, from: Position, to: Position) -> PlaneArc {
        let [first, second, _] = arc.plane.axes();
        let steps = |p: [f64; 3]| [first, second].map(|axis| self.grid.steps(p[axis]));
        PlaneArc {
            meant_start: steps(from.meant),
            meant_end: steps(to.meant),
            center: steps(arc.center),
            direction: arc.direction,
            start: [from.written[first], from.written[second]],
            end: [to.written[first], to.written[second]],
            least_radius: LEAST_RADIUS_MM / self.grid.step_mm(),
        }
    }

    /// The part of an arc between two points, in as many pieces as the controller needs.
    fn turn(
        &mut self,
        arc: &Arc,
        sweep_limit_deg: f64,
        from: Position,
        to: Position,
        feed: i64,
    ) -> Result<(), PostError> {
        let in_plane = self.plane_arc(arc, from, to);
        let Written::Arc { to: turned, offset } = in_plane.written() else {
            return self.line(from.written, to.written, feed);
        };
        let sweep_rad = in_plane.understood(turned, offset).sweep();
        // Exact halves come out a rounding of the arctangent too large.
        if sweep_rad > sweep_limit_deg.to_radians() + 1e-9 {
            let middle = self.between(arc, from, to, &in_plane, 0.5);
            self.turn(arc, sweep_limit_deg, from, middle, feed)?;
            return self.turn(arc, sweep_limit_deg, middle, to, feed);
        }
        let [first, second, _] = arc.plane.axes();
        let mut end = to.written;
        [end[first], end[second]] = turned;
        let turn = Turn {
            plane: arc.plane,
            direction: arc.direction,
            from: from.written,
            to: end,
            offset,
            sweep_rad,
            feed: self.changed(feed),
        };
        self.writer.arc(&turn)?;
        self.line(end, to.written, feed)
    }

    /// An arc that the controller does not know.
    fn chords(
        &mut self,
        arc: &Arc,
        from: Position,
        to: Position,
        feed: i64,
    ) -> Result<(), PostError> {
        let in_plane = self.plane_arc(arc, from, to);
        let given = self.grid.steps(self.program.path_tolerance_mm);
        let tolerance = if given > 0.0 && given.is_finite() { given.max(1.0) } else { CHORD_STEPS };
        let count = in_plane.chords(tolerance);
        let mut at = from.written;
        for k in 1..count {
            let fraction = f64::from(k) / f64::from(count);
            let next = self.between(arc, from, to, &in_plane, fraction).written;
            self.line(at, next, feed)?;
            at = next;
        }
        self.line(at, to.written, feed)
    }

    /// The point of an arc after a fraction of its sweep; off the plane it climbs evenly.
    fn between(
        &self,
        arc: &Arc,
        from: Position,
        to: Position,
        in_plane: &PlaneArc,
        fraction: f64,
    ) -> Position {
        let [first, second, normal] = arc.plane.axes();
        let mut meant = from.meant;
        [meant[first], meant[second]] = in_plane.point(fraction).map(|s| s * self.grid.step_mm());
        meant[normal] += fraction * (to.meant[normal] - from.meant[normal]);
        Position { meant, written: meant.map(|c| self.grid.round(c)) }
    }

    /// The feed, if the controller has another one.
    #[inline]
    fn changed(&mut self, feed: i64) -> Option<i64> {
        if self.feed.replace(feed) == Some(feed) { None } else { Some(feed) }
    }

    /// Where a cutting move begins.
    #[inline]
    fn cutting_from(&self) -> Result<Position, PostError> {
        if self.spindle_wanted {
            return Err(PostError::SpindleStopped { command: self.index });
        }
        self.position.ok_or(PostError::PositionUnknown { command: self.index })
    }

    /// A feed in steps, at least one.
    #[inline]
    fn feed_steps(&self, mm_per_min: f64) -> Result<i64, PostError> {
        if mm_per_min > 0.0 && mm_per_min <= FEED_LIMIT_MM_PER_MIN {
            let steps = self.feeds.round(mm_per_min);
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

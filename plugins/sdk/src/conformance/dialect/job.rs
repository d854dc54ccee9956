//! Jobs, and the moves that each is meant to make, in mm.

use super::Reading;
use crate::{Arc, Command, Dialect, Direction, Plane, PostError, Program, Units};
use std::f64::consts::TAU;
use std::io;

/// A program that owns its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// See [`Program`].
    pub title: String,
    /// See [`Program`].
    pub remarks: Vec<String>,
    /// See [`Program`].
    pub units: Units,
    /// See [`Program`].
    pub path_tolerance_mm: f64,
    /// See [`Program`].
    pub lines_only: bool,
    /// See [`Program`].
    pub commands: Vec<Command>,
    /// See [`Program`].
    pub texts: Vec<String>,
    /// See [`Program`].
    pub arcs: Vec<Arc>,
}

impl Default for Job {
    /// An empty one in mm, with a path tolerance, which some controllers must be told.
    fn default() -> Self {
        Self {
            title: String::new(),
            remarks: Vec::new(),
            units: Units::Mm,
            path_tolerance_mm: 0.01,
            lines_only: false,
            commands: Vec::new(),
            texts: Vec::new(),
            arcs: Vec::new(),
        }
    }
}

/// One motion, as meant or as read back, in mm and mm/min. What is not known is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// Travels.
    Rapid {
        /// The end.
        to: [f64; 3],
    },
    /// Cuts a line.
    Feed {
        /// The end.
        to: [f64; 3],
        /// The speed.
        mm_per_min: f64,
    },
    /// Cuts an arc.
    Arc(Arc),
}

impl Job {
    /// One that begins 5 mm above x, y with the spindle turning.
    #[must_use]
    pub fn at(x: f64, y: f64) -> Self {
        let mut job = Self::default();
        job.commands.push(Command::Spindle { rpm: 12_000.0, direction: Direction::Clockwise });
        job.rapid([x, y, 5.0]);
        job
    }

    /// Adds a rapid.
    pub fn rapid(&mut self, to: [f64; 3]) {
        self.commands.push(Command::Rapid { to });
    }

    /// Adds a straight cut.
    pub fn feed(&mut self, to: [f64; 3], mm_per_min: f64) {
        self.commands.push(Command::Feed { to, mm_per_min });
    }

    /// Adds an arc.
    pub fn arc(&mut self, arc: Arc) {
        self.commands.push(Command::Arc { arc: self.arcs.len() as u32 });
        self.arcs.push(arc);
    }

    /// Adds a remark.
    pub fn comment(&mut self, text: &str) {
        self.commands.push(Command::Comment { text: self.texts.len() as u32 });
        self.texts.push(text.to_owned());
    }

    /// Hands it to a dialect as the program that it is.
    ///
    /// # Errors
    /// Those of [`Dialect::post`].
    pub fn post_to(&self, dialect: &dyn Dialect, out: &mut dyn io::Write) -> Result<(), PostError> {
        let remarks: Vec<&str> = self.remarks.iter().map(String::as_str).collect();
        let texts: Vec<&str> = self.texts.iter().map(String::as_str).collect();
        let program = Program {
            title: &self.title,
            remarks: &remarks,
            units: self.units,
            path_tolerance_mm: self.path_tolerance_mm,
            lines_only: self.lines_only,
            commands: &self.commands,
            texts: &texts,
            arcs: &self.arcs,
            ..Program::default()
        };
        dialect.post(&program, out)
    }

    /// The program that a dialect writes of it.
    ///
    /// # Errors
    /// Those of [`Dialect::post`], and that it is not UTF-8.
    pub fn post(&self, dialect: &dyn Dialect) -> Result<String, PostError> {
        let mut out = Vec::new();
        self.post_to(dialect, &mut out)?;
        let text = String::from_utf8(out);
        text.map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error).into())
    }

    /// The moves it is meant to make: rapids split into Z and XY, nothing that stands still.
    #[must_use]
    pub fn meant(&self, reading: &Reading) -> Vec<Move> {
        let mut moves = Vec::new();
        let mut at: Option<[f64; 3]> = None;
        for command in &self.commands {
            match *command {
                Command::Rapid { to } => {
                    rapids(at, to, reading, &mut moves);
                    at = Some(to);
                }
                Command::Feed { to, mm_per_min } => {
                    if at != Some(to) {
                        moves.push(Move::Feed { to, mm_per_min });
                    }
                    at = Some(to);
                }
                Command::Arc { arc } => {
                    let arc = self.arcs[arc as usize];
                    moves.push(Move::Arc(arc));
                    at = Some(arc.to);
                }
                Command::ToolChange { .. } => at = None,
                _ => {}
            }
        }
        moves
    }
}

/// Where a position is not known it is NaN until it is given.
fn rapids(from: Option<[f64; 3]>, to: [f64; 3], reading: &Reading, moves: &mut Vec<Move>) {
    let top = if reading.starts_high { f64::INFINITY } else { f64::NEG_INFINITY };
    let mut at = from.unwrap_or([f64::NAN, f64::NAN, top]);
    let mut go = |axes: &[usize]| {
        for &axis in axes {
            at[axis] = to[axis];
        }
        // The top is somewhere.
        moves.push(Move::Rapid { to: at.map(|c| if c.is_finite() { c } else { f64::NAN }) });
    };
    let from = from.unwrap_or([f64::NAN, f64::NAN, top]);
    if to[2] > from[2] {
        go(&[2]);
    }
    match (to[0] != from[0], to[1] != from[1]) {
        (true, true) if reading.single_axis_rapids => {
            go(&[0]);
            go(&[1]);
        }
        (true, true) => go(&[0, 1]),
        (true, false) => go(&[0]),
        (false, true) => go(&[1]),
        (false, false) => {}
    }
    if to[2] < from[2] {
        go(&[2]);
    }
}

/// A short job with something of everything: rapids, feeds, arcs both ways in two planes, a full
/// circle, a helix, a dwell and awkward comments. Tools are changed where the dialect can.
#[must_use]
pub fn small(dialect: &dyn Dialect) -> Job {
    use Direction::{Clockwise, CounterClockwise};
    let tools = dialect.capabilities().tool_change;
    let mut job = Job::default();
    if tools {
        job.commands.push(Command::ToolChange { number: 1 });
    }
    job.commands.extend(Job::at(10.0, 20.0).commands);
    job.title = "Medallion: 50% (draft) \"A\"".to_owned();
    job.remarks = vec!["Ball 6 mm, stepover 0.3 mm".to_owned(), "Zero: top, corner".to_owned()];
    job.comment("first pass (rough); don't [touch] / O9000 é!");
    job.feed([10.0, 20.0, -1.0], 200.0);
    job.feed([10.5, 20.0, -1.25], 900.0);
    job.feed([10.5, 20.0, -1.25], 900.0);
    job.feed([11.0, 20.0, -1.250_4], 900.0);
    job.feed([11.5, 20.333_333, -1.0], 900.0);
    small_arcs(&mut job);
    job.rapid([14.166_667, 20.0, 5.0]);
    if tools {
        job.commands.push(Command::ToolChange { number: 2 });
        job.commands.push(Command::Spindle { rpm: 8_000.0, direction: Clockwise });
    }
    job.rapid([30.0, 20.0, 2.0]);
    job.feed([30.0, 20.0, -1.0], 200.0);
    job.feed([31.0, 20.0, -1.0], 200.0);
    job.commands.push(Command::Dwell { seconds: 0.5 });
    job.comment(")\nG0 Z-50 (then; \"M3\" %");
    let half = Arc {
        plane: Plane::Yz,
        direction: CounterClockwise,
        center: [0.0, 21.0, -1.0],
        to: [31.0, 22.0, -1.0],
        mm_per_min: 600.0,
    };
    job.arc(half);
    job.rapid([31.0, 22.0, 5.0]);
    job
}

/// In XY a quarter and three quarters, a full circle and a helix, then half a helix in ZX.
fn small_arcs(job: &mut Job) {
    use Direction::{Clockwise, CounterClockwise};
    let mut arc = |plane, direction, center, to| {
        job.arc(Arc { plane, direction, center, to, mm_per_min: 600.0 });
    };
    arc(Plane::Xy, Clockwise, [11.5, 19.333_333, -1.0], [12.5, 19.333_333, -1.0]);
    arc(Plane::Xy, CounterClockwise, [15.5, 19.333_333, 0.0], [15.5, 22.333_333, -1.0]);
    arc(Plane::Xy, Clockwise, [15.5, 20.0, 0.0], [15.5, 22.333_333, -1.0]);
    arc(Plane::Xy, CounterClockwise, [15.5, 20.0, 0.0], [13.166_667, 20.0, -2.0]);
    arc(Plane::Zx, CounterClockwise, [14.166_667, 0.0, -2.0], [14.166_667, 20.0, -3.0]);
}

/// The least arc that halving and rounding to thousandths of a mm or ten-thousandths of an inch leave
/// an arc.
pub(super) const LEAST_RADIUS_MM: f64 = 0.1;

/// Thousands of cuts, rapids and arcs in all planes, of a size that no rounding makes vanish.
#[must_use]
pub fn long(units: Units) -> Job {
    long_with_arcs(units, LEAST_RADIUS_MM)
}

/// The same with arcs from this radius to a thousand times as much.
pub(super) fn long_with_arcs(units: Units, least_radius_mm: f64) -> Job {
    let mut random = random(3);
    let mut job = Job::at(0.123_456, 50.0);
    job.units = units;
    let mut at = [0.123_456, 50.0, 5.0];
    for k in 0..4000 {
        let feed = 100.0 * (1.0 + (random() * 4.0).floor());
        match k % 50 {
            0 => {
                let to = [200.0 * random(), 200.0 * random(), 5.0];
                job.rapid([at[0], at[1], 5.0]);
                job.rapid(to);
                at = to;
            }
            7 | 17 | 27 | 37 => {
                let arc = random_arc(at, feed, least_radius_mm, &mut random);
                at = arc.to;
                job.arc(arc);
            }
            _ => {
                at = at.map(|c| c + random() - 0.5);
                job.feed(at, feed);
            }
        }
    }
    job.rapid([at[0], at[1], 300.0]);
    job
}

fn random_arc(
    from: [f64; 3],
    mm_per_min: f64,
    least_radius_mm: f64,
    random: &mut impl FnMut() -> f64,
) -> Arc {
    let plane = [Plane::Xy, Plane::Zx, Plane::Yz][(3.0 * random()) as usize];
    let direction = [Direction::Clockwise, Direction::CounterClockwise][(2.0 * random()) as usize];
    let radius = least_radius_mm * 10_f64.powf(3.0 * random());
    let begin = TAU * random();
    let turn = TAU * if random() < 0.3 { 1.0 } else { 0.1 + 0.8 * random() };
    let end = if direction == Direction::Clockwise { begin - turn } else { begin + turn };
    let [first, second, normal] = plane.axes();
    let mut center = from;
    center[first] -= radius * begin.cos();
    center[second] -= radius * begin.sin();
    let mut to = from;
    if turn < TAU {
        to[first] = center[first] + radius * end.cos();
        to[second] = center[second] + radius * end.sin();
    }
    if random() < 0.5 {
        to[normal] += 1.0 - 2.0 * random();
    }
    Arc { plane, direction, center, to, mm_per_min }
}

/// The same numbers in [0, 1) on every run.
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

//! Jobs for the tests, and the moves that each is meant to make, in mm.

#![allow(dead_code, reason = "each test uses a part")]
pub(crate) mod heidenhain;
pub(crate) mod reader;
pub(crate) mod shopbot;

use carvegraph_dialects::standard;
use carvegraph_sdk::{Arc, Command, Dialect, Direction, Plane, PostError, Program, Units};
use std::f64::consts::TAU;

/// A program that owns its parts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Job {
    pub(crate) title: String,
    pub(crate) remarks: Vec<String>,
    pub(crate) units: Units,
    pub(crate) commands: Vec<Command>,
    pub(crate) texts: Vec<String>,
    pub(crate) arcs: Vec<Arc>,
}

/// One motion, as meant or as read back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Move {
    Rapid { to: [f64; 3] },
    Feed { to: [f64; 3], mm_per_min: f64 },
    Arc(Arc),
}

pub(crate) fn dialect(name: &str) -> Box<dyn Dialect> {
    standard().into_iter().find(|d| d.name() == name).unwrap()
}

impl Job {
    /// Begins above x, y.
    pub(crate) fn at(x: f64, y: f64) -> Self {
        let mut job = Self::default();
        job.commands.push(Command::Spindle { rpm: 12_000.0, direction: Direction::Clockwise });
        job.rapid([x, y, 5.0]);
        job
    }

    pub(crate) fn rapid(&mut self, to: [f64; 3]) {
        self.commands.push(Command::Rapid { to });
    }

    pub(crate) fn feed(&mut self, to: [f64; 3], mm_per_min: f64) {
        self.commands.push(Command::Feed { to, mm_per_min });
    }

    pub(crate) fn arc(&mut self, arc: Arc) {
        self.commands.push(Command::Arc { arc: self.arcs.len() as u32 });
        self.arcs.push(arc);
    }

    pub(crate) fn comment(&mut self, text: &str) {
        self.commands.push(Command::Comment { text: self.texts.len() as u32 });
        self.texts.push(text.to_owned());
    }

    pub(crate) fn post(&self, dialect: &dyn Dialect) -> Result<String, PostError> {
        let mut out = Vec::new();
        let remarks: Vec<&str> = self.remarks.iter().map(String::as_str).collect();
        let texts: Vec<&str> = self.texts.iter().map(String::as_str).collect();
        let program = Program {
            title: &self.title,
            remarks: &remarks,
            units: self.units,
            path_tolerance_mm: 0.01,
            commands: &self.commands,
            texts: &texts,
            arcs: &self.arcs,
            ..Program::default()
        };
        dialect.post(&program, &mut out)?;
        Ok(String::from_utf8(out).unwrap())
    }

    /// The moves it is meant to make: rapids split into Z and XY, nothing that stands still.
    pub(crate) fn meant(&self, habits: &Habits) -> Vec<Move> {
        let mut moves = Vec::new();
        let mut at: Option<[f64; 3]> = None;
        for command in &self.commands {
            match *command {
                Command::Rapid { to } => {
                    rapids(at, to, habits, &mut moves);
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

    /// Posts, reads back and compares; answers the program.
    pub(crate) fn check(&self, dialect: &dyn Dialect) -> String {
        let text = self.post(dialect).unwrap_or_else(|e| panic!("{}: {e}", dialect.name()));
        let habits = habits(dialect.name());
        compare(&self.meant(&habits), &read(dialect.name(), &text), self.units, &habits);
        text
    }
}

/// The moves that a program makes, as its controller would read it.
pub(crate) fn read(dialect: &str, text: &str) -> Vec<Move> {
    match dialect {
        "heidenhain" => heidenhain::read(text),
        "shopbot" => shopbot::read(text),
        _ => reader::read(text, &reader::rules(dialect)),
    }
}

/// What is meant to be different in the moves of a dialect.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Habits {
    /// The first rapid comes from the machine's top.
    xy_first: bool,
    single_axis_rapids: bool,
    /// Arcs are in XY only.
    xy_arcs: bool,
    /// Helices become lines.
    flat_arcs: bool,
    /// In degrees.
    sweep_limit: f64,
    /// What a feed is rounded to, in mm/min or in/min.
    feed_steps: [f64; 2],
}

pub(crate) fn habits(dialect: &str) -> Habits {
    let usual = Habits {
        xy_first: false,
        single_axis_rapids: false,
        xy_arcs: false,
        flat_arcs: false,
        sweep_limit: 360.0,
        feed_steps: [0.001, 0.000_1],
    };
    match dialect {
        "fanuc" => Habits { xy_first: true, sweep_limit: 180.0, ..usual },
        "haas" => Habits { xy_first: true, single_axis_rapids: true, sweep_limit: 180.0, ..usual },
        "marlin" | "uccnc" | "heidenhain" => Habits { xy_arcs: true, ..usual },
        "shopbot" => Habits {
            xy_arcs: true,
            flat_arcs: true,
            sweep_limit: 180.0,
            feed_steps: [0.06, 0.006],
            ..usual
        },
        _ => usual,
    }
}

/// Where a position is unknown it is NaN until it is given.
fn rapids(from: Option<[f64; 3]>, to: [f64; 3], habits: &Habits, moves: &mut Vec<Move>) {
    let top = if habits.xy_first { f64::INFINITY } else { f64::NEG_INFINITY };
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
        (true, true) if habits.single_axis_rapids => {
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

/// The job of the golden files: short, with something of everything. Tools are changed where the
/// dialect can.
pub(crate) fn small(dialect: &dyn Dialect) -> Job {
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
    let arc =
        |plane, direction, center, to| Arc { plane, direction, center, to, mm_per_min: 600.0 };
    use Direction::{Clockwise, CounterClockwise};
    let quarter = ([11.5, 19.333_333, -1.0], [12.5, 19.333_333, -1.0]);
    job.arc(arc(Plane::Xy, Clockwise, quarter.0, quarter.1));
    job.arc(arc(Plane::Xy, CounterClockwise, [15.5, 19.333_333, 0.0], [15.5, 22.333_333, -1.0]));
    job.arc(arc(Plane::Xy, Clockwise, [15.5, 20.0, 0.0], [15.5, 22.333_333, -1.0]));
    job.arc(arc(Plane::Xy, CounterClockwise, [15.5, 20.0, 0.0], [13.166_667, 20.0, -2.0]));
    job.arc(arc(Plane::Zx, CounterClockwise, [14.166_667, 0.0, -2.0], [14.166_667, 20.0, -3.0]));
    job.rapid([14.166_667, 20.0, 5.0]);
    if tools {
        job.commands.push(Command::ToolChange { number: 2 });
        job.commands.push(Command::Spindle { rpm: 8_000.0, direction: Clockwise });
    }
    job.rapid([30.0, 20.0, 2.0]);
    job.feed([30.0, 20.0, -1.0], 200.0);
    job.feed([31.0, 20.0, -1.0], 200.0);
    job.commands.push(Command::Dwell { seconds: 0.5 });
    job.rapid([31.0, 20.0, 5.0]);
    job
}

/// Thousands of cuts, rapids and arcs in all planes, of a size that no rounding makes vanish.
pub(crate) fn long(units: Units) -> Job {
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
                let arc = random_arc(at, feed, &mut random);
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

fn random_arc(from: [f64; 3], mm_per_min: f64, random: &mut impl FnMut() -> f64) -> Arc {
    let plane = [Plane::Xy, Plane::Zx, Plane::Yz][(3.0 * random()) as usize];
    let direction = [Direction::Clockwise, Direction::CounterClockwise][(2.0 * random()) as usize];
    let radius = 10_f64.powf(3.0 * random() - 1.0);
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
pub(crate) fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Whether moves that were read back are the meant ones, to within rounding; an arc may have become
/// several, or lines, if that is the dialect's habit.
pub(crate) fn compare(meant: &[Move], read: &[Move], units: Units, habits: &Habits) {
    // Half a step for a point, three steps for a centre (see `arc.rs`), and what rs274 rounds off.
    let (step, feed_step) = match units {
        Units::Mm => (0.001, habits.feed_steps[0]),
        Units::Inch => (0.002_54, 25.4 * habits.feed_steps[1]),
    };
    let near_feed = |f: f64, g: f64| (f - g).abs() < feed_step;
    let point = 0.55 * step;
    let mut rest = read;
    let mut from = [f64::NAN; 3];
    for (index, meant) in meant.iter().enumerate() {
        let Some((first, left)) = rest.split_first() else {
            panic!("only {index} moves: {read:?}")
        };
        let (to, taken) = match (meant, first) {
            (Move::Rapid { to: a }, Move::Rapid { to: b }) if near(*a, *b, point) => (*a, 1),
            (Move::Feed { to: a, mm_per_min: f }, Move::Feed { to: b, mm_per_min: g })
                if near(*a, *b, point) && near_feed(*f, *g) =>
            {
                (*a, 1)
            }
            (Move::Arc(arc), _) => {
                let lines = habits.xy_arcs && arc.plane != Plane::Xy
                    || habits.flat_arcs && helix(arc, from);
                let pieces = Pieces { lines, limit: habits.sweep_limit, step, feed_step };
                (arc.to, pieces.take(arc, from, rest))
            }
            _ => panic!("move {index}: meant {meant:?}, read {first:?}"),
        };
        assert!(taken > 0, "move {index}: meant {meant:?} from {from:?}, read {first:?}");
        rest = if taken == 1 { left } else { &rest[taken..] };
        from = to;
    }
    assert!(rest.is_empty(), "more than was meant: {rest:?}");
}

fn helix(arc: &Arc, from: [f64; 3]) -> bool {
    let [.., normal] = arc.plane.axes();
    (arc.to[normal] - from[normal]).abs() > 1e-3
}

/// How an arc may be divided.
struct Pieces {
    lines: bool,
    limit: f64,
    step: f64,
    feed_step: f64,
}

impl Pieces {
    /// How many moves make up an arc; 0 if they do not.
    fn take(&self, arc: &Arc, from: [f64; 3], moves: &[Move]) -> usize {
        let [first, second, normal] = arc.plane.axes();
        let turned = |a: [f64; 3], b: [f64; 3], center: [f64; 3]| {
            let angle = |p: [f64; 3]| (p[second] - center[second]).atan2(p[first] - center[first]);
            let sign = if arc.direction == Direction::Clockwise { -1.0 } else { 1.0 };
            (sign * (angle(b) - angle(a))).rem_euclid(TAU)
        };
        let radius = (from[first] - arc.center[first]).hypot(from[second] - arc.center[second]);
        // Each piece has its own centre, up to three steps off.
        let slack = (6.0 * self.step / radius).min(0.5);
        let whole = |turn: f64| if turn < slack || turn > TAU - slack { TAU } else { turn };
        let sweep = if from == arc.to { TAU } else { whole(turned(from, arc.to, arc.center)) };
        let (mut at, mut sum) = (from, 0.0);
        for (k, piece) in moves.iter().enumerate() {
            let (to, mm_per_min, turn) = match *piece {
                Move::Feed { to, mm_per_min } if self.lines => {
                    let turn = turned(at, to, arc.center);
                    // The chord's middle may be off by the tolerance of the tests' jobs.
                    if radius * (1.0 - (turn / 2.0).cos()) > 0.01 + 2.0 * self.step {
                        return 0;
                    }
                    (to, mm_per_min, turn)
                }
                Move::Arc(part) if !self.lines => {
                    let off = [first, second].map(|k| (part.center[k] - arc.center[k]).abs());
                    let same = part.plane == arc.plane && part.direction == arc.direction;
                    let closed = [first, second]
                        .iter()
                        .all(|&k| (at[k] - part.to[k]).abs() < 0.6 * self.step);
                    let turn = if closed && self.limit > 180.0 {
                        TAU
                    } else {
                        turned(at, part.to, part.center)
                    };
                    if !same || off[0].max(off[1]) > 3.0 * self.step {
                        return 0;
                    }
                    if turn > self.limit.to_radians() + slack {
                        return 0;
                    }
                    (part.to, part.mm_per_min, turn)
                }
                _ => return 0,
            };
            sum += turn;
            let radial = (to[first] - arc.center[first]).hypot(to[second] - arc.center[second]);
            let climb = from[normal] + (arc.to[normal] - from[normal]) * (sum / sweep).min(1.0);
            let height = (climb - to[normal]).abs();
            let steep = (arc.to[normal] - from[normal]).abs() * slack / sweep;
            if (radial - radius).abs() > 1.5 * self.step
                || height > self.step + steep
                || (mm_per_min - arc.mm_per_min).abs() > self.feed_step
            {
                return 0;
            }
            if sum > sweep - slack {
                let ends = near(arc.to, to, 0.55 * self.step) && sum < sweep + slack;
                return if ends { k + 1 } else { 0 };
            }
            at = to;
        }
        0
    }
}

/// Where `a` is unknown anything will do.
fn near(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| a.is_nan() || (a - b).abs() <= tolerance)
}

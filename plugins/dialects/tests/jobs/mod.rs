//! Jobs for the tests, and the moves that each is meant to make, in mm.

#![allow(dead_code, reason = "each test uses a part")]
pub(crate) mod reader;

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
        };
        dialect.post(&program, &mut out)?;
        Ok(String::from_utf8(out).unwrap())
    }

    /// The moves it is meant to make: rapids split into Z and XY, nothing that stands still.
    pub(crate) fn meant(&self) -> Vec<Move> {
        let mut moves = Vec::new();
        let mut at: Option<[f64; 3]> = None;
        for command in &self.commands {
            match *command {
                Command::Rapid { to } => {
                    rapids(at, to, &mut moves);
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

fn rapids(from: Option<[f64; 3]>, to: [f64; 3], moves: &mut Vec<Move>) {
    let from = from.unwrap_or([f64::NAN, f64::NAN, f64::NEG_INFINITY]);
    let travels = from[..2] != to[..2];
    if to[2] > from[2] {
        // Where x and y are unknown they stay NaN until they are given.
        moves.push(Move::Rapid { to: [from[0], from[1], to[2]] });
    }
    if travels {
        moves.push(Move::Rapid { to: [to[0], to[1], from[2].max(to[2])] });
    }
    if to[2] < from[2] {
        moves.push(Move::Rapid { to });
    }
}

/// The job of the golden files: short, with something of everything both dialects take.
pub(crate) fn small() -> Job {
    let mut job = Job::at(10.0, 20.0);
    job.title = "Medallion".to_owned();
    job.remarks = vec!["Ball 6 mm, stepover 0.3 mm".to_owned(), "Zero: top, corner".to_owned()];
    job.comment("first pass");
    job.feed([10.0, 20.0, -1.0], 200.0);
    job.feed([10.5, 20.0, -1.25], 900.0);
    job.feed([10.5, 20.0, -1.25], 900.0);
    job.feed([11.0, 20.0, -1.250_4], 900.0);
    job.feed([11.5, 20.333_333, -1.0], 900.0);
    job.arc(Arc {
        plane: Plane::Xy,
        direction: Direction::Clockwise,
        center: [11.5, 19.333_333, -1.0],
        to: [12.5, 19.333_333, -1.0],
        mm_per_min: 600.0,
    });
    job.arc(Arc {
        plane: Plane::Zx,
        direction: Direction::CounterClockwise,
        center: [13.5, 0.0, -1.0],
        to: [13.5, 19.333_333, -2.0],
        mm_per_min: 600.0,
    });
    job.rapid([13.5, 19.333_333, 5.0]);
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

/// Whether moves that were read back are the meant ones, to within rounding.
pub(crate) fn compare(meant: &[Move], read: &[Move], units: Units) {
    assert_eq!(meant.len(), read.len(), "number of moves");
    // Half a step for a point, three steps for a centre (see `arc.rs`), and what rs274 rounds off.
    let (step, feed_step) = match units {
        Units::Mm => (0.001, 0.001),
        Units::Inch => (0.002_54, 0.002_54),
    };
    let (point, center) = (0.55 * step, 3.0 * step);
    for (index, (meant, read)) in meant.iter().zip(read).enumerate() {
        let same = match (meant, read) {
            (Move::Rapid { to: a }, Move::Rapid { to: b }) => near(*a, *b, point),
            (Move::Feed { to: a, mm_per_min: f }, Move::Feed { to: b, mm_per_min: g }) => {
                near(*a, *b, point) && (f - g).abs() < feed_step
            }
            (Move::Arc(a), Move::Arc(b)) => same_arc(a, b, point, center),
            _ => false,
        };
        assert!(same, "move {index}: meant {meant:?}, read {read:?}");
    }
}

fn same_arc(a: &Arc, b: &Arc, point: f64, center: f64) -> bool {
    let [first, second, _] = a.plane.axes();
    a.plane == b.plane
        && a.direction == b.direction
        && near(a.to, b.to, point)
        && (a.mm_per_min - b.mm_per_min).abs() < point * 10.0
        && [first, second].iter().all(|&k| (a.center[k] - b.center[k]).abs() < center)
}

/// Where `a` is unknown anything will do.
fn near(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| a.is_nan() || (a - b).abs() <= tolerance)
}

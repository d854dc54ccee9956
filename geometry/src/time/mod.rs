//! How long a machine takes for its moves, with acceleration, corners and look-ahead as a controller plans
//! them.
//!
//! The rules are those of GRBL 1.1 as its `planner.c` documents them; on long moves they give the plain
//! trapezoids of any controller, on dense paths they tell why distance ÷ feed is off by a multiple.
//!
//! | symbol | meaning |
//! |---|---|
//! | d, a, v | length, acceleration and greatest speed of a block, each axis within its own limit |
//! | eₖ | the speed at which block k is entered |
//! | Jₖ | the greatest speed at which it may be: the corner's, and no more than v of both sides |
//! | N | blocks that the controller sees, the one that it executes included |
//!
//! A corner is taken at Jₖ² = a δ sin(θ/2) / (1 − sin(θ/2)): as fast as a circle would be that touches
//! both sides and passes within the junction deviation δ of the corner, θ being the angle between the
//! sides (0 where the way turns back). When block k begins, the last block seen is k + N − 1, and the machine
//! must be able to stop at its end: going backward from eₖ₊ₙ = 0, each eᵢ² = min(Jᵢ², eᵢ₊₁² + 2 aᵢ dᵢ). Then
//! block k gathers no more than eₖ₊₁² ≤ eₖ² + 2 aₖ dₖ. Arcs are made of chords within 2 µm (GRBL's $12), as
//! the controller makes them.
//!
//! How many lines a second a controller takes can be limited: line k comes no sooner than 1/rate after
//! line k − 1 and not before block k − N has left the buffer; the machine waits for it where it must.
//!
//! Source: `planner.c` of GRBL 1.1 (gnea/grbl), its comments on junction speed and on the passes of the
//! planner; no code of it is used.
//!
//! Limits: no jerk, so controllers with S-curves (Smoothieware, LinuxCNC's newer planners, most industrial
//! ones) take somewhat longer between long moves. Blending as LinuxCNC does with `G64` is not known; its
//! corners are about as fast with δ set to the blend. Lengths are not rounded to steps. A controller that
//! starves also slows down ahead of the end of what it has got; only the wait is counted here.

mod ahead;
mod block;
#[cfg(test)]
mod tests;

use crate::{Motion, Move, MoveKind, Tick};
use ahead::Ahead;
use block::{Block, Sort};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// What a machine and its controller can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics {
    /// The greatest speeds of X, Y and Z when feeding, in mm/min; infinite where there is no limit.
    pub feed_mm_per_min: [f64; 3],
    /// The speeds of X, Y and Z in rapids, in mm/min. A rapid goes as fast as the first axis to reach its own.
    pub rapid_mm_per_min: [f64; 3],
    /// How fast X, Y and Z gather speed, in mm/s²; infinite gives length ÷ speed.
    pub acceleration_mm_per_s2: [f64; 3],
    /// How far the controller thinks itself off a corner, in mm.
    pub junction_deviation_mm: f64,
    /// How many blocks it sees, the one that it executes included; GRBL's ring of 16 holds 15.
    pub look_ahead: usize,
    /// How many lines a second it takes; infinite where that is no matter.
    pub lines_per_s: f64,
}

/// How long moves take, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// Feeding, in s; plunges included.
    pub cutting_s: f64,
    /// Feeding straight down, in s.
    pub plunge_s: f64,
    /// Travelling without cutting, in s.
    pub rapid_s: f64,
    /// Standing still for want of lines, in s.
    pub waiting_s: f64,
    /// What it would take at the speeds that are asked for, in s.
    pub asked_s: f64,
    /// What axes add that are slower than that, in s.
    pub slow_axes_s: f64,
    /// What gathering and losing speed adds, in s.
    pub accelerating_s: f64,
    /// Way that is fed, in mm.
    pub feed_length_mm: f64,
    /// Way that is travelled in rapids, in mm.
    pub rapid_length_mm: f64,
    /// Straight pieces that are planned; an arc has many, a move without length none.
    pub blocks: usize,
    /// The shortest of them, in mm; 0 if there are none.
    pub shortest_mm: f64,
    /// The greatest number of lines a second that a buffer full of blocks was used up with.
    pub most_lines_per_s: f64,
}

impl Times {
    /// All of it, in s: cutting, rapids and waiting.
    #[must_use]
    pub fn total_s(&self) -> f64 {
        self.cutting_s + self.rapid_s + self.waiting_s
    }

    /// Mean speed of what is fed, in mm/min; 0 if nothing is.
    #[must_use]
    pub fn mean_feed_mm_per_min(&self) -> f64 {
        if self.cutting_s > 0.0 { self.feed_length_mm / self.cutting_s * 60.0 } else { 0.0 }
    }
}

/// Why no time can be told.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TimeError {
    /// A limit of the machine is none.
    #[error("{what} is {value}; it must be above 0")]
    Limit {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A place, a length or a speed of a move is no number that a machine can go by.
    #[error(
        "move {index} leads to ({}, {}, {}) mm at {mm_per_min} mm/min, which no machine can do",
        to[0], to[1], to[2]
    )]
    Move {
        /// Which, from 0.
        index: usize,
        /// Where it leads, in mm.
        to: [f64; 3],
        /// Its speed.
        mm_per_min: f64,
    },
    /// The caller has had enough.
    #[error("stopped")]
    Stopped,
}

/// Blocks between two looks at the caller's wish to stop: a millisecond or less.
const BLOCKS_A_TICK: usize = 8192;

impl Kinematics {
    /// # Errors
    /// The first limit that is not above 0.
    fn check(&self) -> Result<(), TimeError> {
        let axes = |what, values: [f64; 3]| values.map(|value| (what, value));
        let alone = [
            ("the junction deviation", self.junction_deviation_mm),
            ("the number of blocks seen ahead", self.look_ahead as f64),
            ("the number of lines a second", self.lines_per_s),
        ];
        let limits = axes("a greatest feed", self.feed_mm_per_min)
            .into_iter()
            .chain(axes("a speed of rapids", self.rapid_mm_per_min))
            .chain(axes("an acceleration", self.acceleration_mm_per_s2))
            .chain(alone);
        match limits.into_iter().find(|(_, value)| value.is_nan() || *value <= 0.0) {
            Some((what, value)) => Err(TimeError::Limit { what, value }),
            None => Ok(()),
        }
    }
}

/// How long a machine takes for a motion that begins and ends at rest. Tells `tick` of moves.
///
/// # Errors
/// If a limit is not above 0, if a move has no finite place or no speed, or if `tick` says stop.
pub fn machining_time(
    motion: &Motion,
    kinematics: &Kinematics,
    tick: Tick<'_>,
) -> Result<Times, TimeError> {
    kinematics.check()?;
    let mut run = Run::new(kinematics);
    let mut before: Option<Block> = None;
    let (mut blocks, mut told) = (0, 0);
    for (index, (from, moved)) in motion.legs().enumerate() {
        if !is_sound(motion, from, moved) {
            let to = moved.to.to_array();
            return Err(TimeError::Move { index, to, mm_per_min: moved.mm_per_min });
        }
        for (from, to, first) in block::pieces(motion, from, moved) {
            blocks += 1;
            if blocks % BLOCKS_A_TICK == 0 && !tick(index - std::mem::replace(&mut told, index)) {
                return Err(TimeError::Stopped);
            }
            let block = Block::new(from, to, moved, kinematics, before.as_ref());
            let Some(mut block) = block else { continue };
            block.begins_line = first;
            run.come(block);
            before = Some(block);
        }
    }
    if !tick(motion.moves.len() - told) {
        return Err(TimeError::Stopped);
    }
    Ok(run.end())
}

/// Whether a machine could go that way. The speed of a rapid is the machine's.
fn is_sound(motion: &Motion, from: DVec3, moved: &Move) -> bool {
    let has_speed = moved.kind == MoveKind::Rapid || moved.mm_per_min > 0.0;
    let radius_mm =
        motion.arc(moved).map_or(0.0, |arc| arc.radius_mm(from) + arc.radius_mm(moved.to));
    has_speed && from.distance(moved.to).is_finite() && radius_mm.is_finite()
}

/// A machine at work: the buffer and the clock.
struct Run {
    ahead: Ahead,
    look_ahead: usize,
    /// Time between two lines, in s.
    interval_s: f64,
    /// When the machine is done with what it has executed, in s.
    clock_s: f64,
    /// When the last line came.
    came_s: f64,
    /// When each of the last blocks was done and whether it began a line, as many as the buffer holds.
    done: VecDeque<(f64, bool)>,
    /// How many of these began a line.
    lines: usize,
    /// The square of the speed at which the next block is entered.
    entry2: f64,
    times: Times,
}

impl Run {
    fn new(kinematics: &Kinematics) -> Self {
        Self {
            ahead: Ahead::default(),
            look_ahead: kinematics.look_ahead,
            interval_s: 1.0 / kinematics.lines_per_s,
            clock_s: 0.0,
            came_s: 0.0,
            done: VecDeque::new(),
            lines: 0,
            entry2: 0.0,
            times: Times::default(),
        }
    }

    /// A block comes into the buffer; if that is full then, the oldest one is executed.
    fn come(&mut self, block: Block) {
        self.ahead.push(block);
        if self.ahead.len() == self.look_ahead {
            self.execute();
        }
    }

    /// Executes what is left, to a stop.
    fn end(mut self) -> Times {
        while self.ahead.len() > 0 {
            self.execute();
        }
        self.times
    }

    fn execute(&mut self) {
        let Some(block) = self.ahead.pop() else { return };
        let exit2 = self.ahead.entry2().min(self.entry2 + block.gain2());
        let seconds = block.seconds(self.entry2, exit2);
        self.entry2 = exit2;
        self.wait(block.begins_line);
        self.clock_s += seconds;
        self.note_pace(block.begins_line);
        self.count(&block, seconds);
    }

    /// Waits until the block's line has come.
    fn wait(&mut self, begins_line: bool) {
        if begins_line {
            let is_full = self.done.len() == self.look_ahead;
            let free_s = if is_full { self.done[0].0 } else { 0.0 };
            self.came_s = (self.came_s + self.interval_s).max(free_s);
        }
        let waited = (self.came_s - self.clock_s).max(0.0);
        self.clock_s += waited;
        self.times.waiting_s += waited;
    }

    /// How many lines a second were used up with the last buffer full of blocks.
    fn note_pace(&mut self, begins_line: bool) {
        self.done.push_back((self.clock_s, begins_line));
        self.lines += usize::from(begins_line);
        if self.done.len() > self.look_ahead
            && let Some((since, began)) = self.done.pop_front()
        {
            self.lines -= usize::from(began);
            let pace = self.lines as f64 / (self.clock_s - since);
            // Infinitely fast moves tell nothing.
            if pace.is_finite() {
                self.times.most_lines_per_s = self.times.most_lines_per_s.max(pace);
            }
        }
    }

    fn count(&mut self, block: &Block, seconds: f64) {
        let times = &mut self.times;
        let (part_s, length) = match block.sort {
            Sort::Rapid => (&mut times.rapid_s, &mut times.rapid_length_mm),
            Sort::Cut | Sort::Plunge => (&mut times.cutting_s, &mut times.feed_length_mm),
        };
        *part_s += seconds;
        *length += block.length;
        if block.sort == Sort::Plunge {
            times.plunge_s += seconds;
        }
        let (asked, allowed) = (block.length / block.asked, block.length / block.speed);
        times.asked_s += asked;
        times.slow_axes_s += allowed - asked;
        times.accelerating_s += seconds - allowed;
        let is_shortest = times.blocks == 0 || block.length < times.shortest_mm;
        times.shortest_mm = if is_shortest { block.length } else { times.shortest_mm };
        times.blocks += 1;
    }
}

//! What all languages have in common: where the tip is, what is in force, and what is wrong with it.

use crate::job::described;
use crate::machining::{Machining, TextFault, ToolRun};
use crate::values::ToolUse;
use carvegraph_geometry::{Cutter, DVec3, Motion, Move, MoveKind, PathArc};
use std::collections::BTreeMap;

/// How often one kind of fault is told: a spindle that stands still does so for all lines.
const TOLD_AT_MOST: usize = 5;

/// GRBL's rule for the ends of an arc: their radii may differ by this much in mm, ...
const RADII_DIFFER_MM: f64 = 0.005;
/// ... or by this share of the radius ...
const RADII_DIFFER_SHARE: f64 = 0.001;
/// ... but never by more than this, in mm.
const RADII_DIFFER_MOST_MM: f64 = 0.5;

/// The moves of a program, as they are read.
pub(super) struct Recorder<'a> {
    /// The line that is being read, from 1.
    pub(super) line: u32,
    /// The feed in force, in mm/min.
    pub(super) feed_mm_per_min: Option<f64>,
    program: usize,
    tools: &'a [ToolUse],
    zero: DVec3,
    /// Where the tip is in the program's frame, in mm, as far as it is known.
    at: [Option<f64>; 3],
    /// The highest that it has been, in mm.
    highest: f64,
    spinning: bool,
    run: ToolRun,
    /// Whether the run has a place to start from.
    started: bool,
    runs: Vec<ToolRun>,
    faults: Vec<TextFault>,
    told: BTreeMap<&'static str, usize>,
}

impl<'a> Recorder<'a> {
    /// One for the program number `program` with its tools, the first of which is in the spindle, or
    /// `cutter` if there are none.
    pub(super) fn new(program: usize, tools: &'a [ToolUse], cutter: &Cutter, zero: DVec3) -> Self {
        let first = tools.first().map_or(cutter, |tool| &tool.cutter);
        Self {
            line: 0,
            feed_mm_per_min: None,
            program,
            tools,
            zero,
            at: [None; 3],
            highest: f64::NEG_INFINITY,
            spinning: false,
            run: run_of(program, first.clone()),
            started: false,
            runs: Vec::new(),
            faults: Vec::new(),
            told: BTreeMap::new(),
        }
    }

    /// Where the tip is in the program's frame, in mm, as far as it is known.
    pub(super) fn at(&self) -> [Option<f64>; 3] {
        self.at
    }

    /// Notes something wrong with the line, a few times for each `kind`.
    pub(super) fn fault(&mut self, kind: &'static str, text: String) {
        let told = self.told.entry(kind).or_default();
        *told += 1;
        if *told <= TOLD_AT_MOST {
            self.faults.push(TextFault { program: self.program, line: self.line, text });
        }
    }

    /// Some axes go where the program does not say: to a place of the machine, or by a tool change.
    pub(super) fn forget(&mut self, axes: [bool; 3]) {
        for (axis, forgotten) in axes.into_iter().enumerate() {
            if forgotten {
                self.at[axis] = None;
            }
        }
    }

    pub(super) fn dwell(&mut self, seconds: f64) {
        self.run.dwell_s += seconds;
    }

    pub(super) fn spindle(&mut self, turns: bool) {
        self.spinning = turns;
    }

    /// Puts in another tool.
    pub(super) fn change_tool(&mut self, number: Option<u32>) {
        self.forget([true; 3]);
        self.spinning = false;
        let found = self.tools.iter().find(|tool| tool.number == number);
        let cutter = match (found, self.tools) {
            (Some(tool), _) => &tool.cutter,
            (None, [only]) => &only.cutter,
            (None, [first, ..]) => {
                let number = number.map_or("no number".to_owned(), |number| number.to_string());
                let known = self.tools.iter().map(|tool| {
                    format!("{} ({})", tool.number.unwrap_or_default(), described(&tool.cutter))
                });
                let known = known.collect::<Vec<_>>().join(", ");
                let text = format!("it puts in tool {number}, and the job has {known}");
                self.fault("tool", text);
                &first.cutter
            }
            (None, []) => &self.run.cutter,
        };
        let next = run_of(self.program, cutter.clone());
        let run = std::mem::replace(&mut self.run, next);
        self.keep(run);
        self.started = false;
    }

    /// Travels to coordinates in mm; axes without one stay where they are.
    pub(super) fn rapid(&mut self, to: [Option<f64>; 3]) {
        self.go(to, f64::INFINITY, MoveKind::Rapid);
    }

    /// Cuts a line.
    pub(super) fn cut(&mut self, to: [Option<f64>; 3]) {
        if let Some(mm_per_min) = self.ready() {
            self.go(to, mm_per_min, MoveKind::Line);
        } else {
            self.place(to);
        }
    }

    /// Cuts an arc, whose centre is in the program's frame.
    pub(super) fn cut_arc(&mut self, to: [Option<f64>; 3], arc: PathArc) {
        let Some(mm_per_min) = self.ready() else { return self.place(to) };
        let from = self.at.map(Option::unwrap_or_default);
        let end: [f64; 3] = std::array::from_fn(|axis| to[axis].unwrap_or(from[axis]));
        let radii = [from, end].map(|tip| arc.radius_mm(DVec3::from_array(tip)));
        let differ = (radii[0] - radii[1]).abs();
        let share = RADII_DIFFER_SHARE * radii[0];
        if differ > RADII_DIFFER_MM.max(share).min(RADII_DIFFER_MOST_MM) {
            let [start, end] = radii;
            let text = format!(
                "its arc begins {start:.3} mm from its centre and ends {end:.3} mm from it"
            );
            self.fault("radii", text);
        }
        let index = self.run.motion.arcs.len() as u32;
        self.run.motion.arcs.push(PathArc { center: arc.center + self.zero, ..arc });
        self.go(to, mm_per_min, MoveKind::Arc { arc: index });
    }

    /// Whether the program came to its end.
    pub(super) fn end(&mut self, ended: bool) {
        if !ended {
            let text = "it stops here without an end of the program: a part of it is missing";
            self.fault("end", text.to_owned());
        }
    }

    pub(super) fn finish(mut self) -> Machining {
        let last = self.run.clone();
        self.keep(last);
        Machining { runs: self.runs, faults: self.faults, readable: true }
    }

    fn keep(&mut self, run: ToolRun) {
        if !run.motion.moves.is_empty() || run.dwell_s > 0.0 {
            self.runs.push(run);
        }
    }

    /// The feed of a cut, if it is known where it begins; notes what is missing.
    fn ready(&mut self) -> Option<f64> {
        if !self.spinning {
            self.fault("spindle", "it cuts with the spindle standing still".to_owned());
        }
        if self.feed_mm_per_min.is_none() {
            self.fault("feed", "it cuts, and no feed is in force".to_owned());
        }
        if self.at.contains(&None) {
            self.fault("nowhere", "it cuts before it is known where the tip is".to_owned());
            return None;
        }
        Some(self.feed_mm_per_min.unwrap_or(f64::INFINITY))
    }

    /// Takes up coordinates that come by no move.
    fn place(&mut self, to: [Option<f64>; 3]) {
        for (at, to) in self.at.iter_mut().zip(to) {
            *at = to.or(*at);
        }
    }

    fn go(&mut self, to: [Option<f64>; 3], mm_per_min: f64, kind: MoveKind) {
        let known = !self.at.contains(&None);
        self.place(to);
        let [Some(x), Some(y), Some(z)] = self.at else { return };
        let tip = self.zero + DVec3::new(x, y, z);
        self.highest = self.highest.max(tip.z);
        if !self.started {
            self.started = true;
            self.run.motion.start = tip;
            // A whole turn leads from a place to itself.
            if !known {
                return;
            }
        }
        if !known {
            // From the machine's top, wherever that is.
            let last = self.run.motion.moves.last().map_or(self.run.motion.start, |last| last.to);
            for tip in [last.with_z(self.highest), tip.with_z(self.highest)] {
                self.push(tip, f64::INFINITY, MoveKind::Rapid);
            }
        }
        self.push(tip, mm_per_min, kind);
    }

    fn push(&mut self, to: DVec3, mm_per_min: f64, kind: MoveKind) {
        self.run.motion.moves.push(Move { to, mm_per_min, kind });
        self.run.lines.push(self.line);
    }
}

fn run_of(program: usize, cutter: Cutter) -> ToolRun {
    let motion = Motion { start: DVec3::ZERO, moves: Vec::new(), arcs: Vec::new() };
    ToolRun { program, cutter, motion, lines: Vec::new(), dwell_s: 0.0 }
}

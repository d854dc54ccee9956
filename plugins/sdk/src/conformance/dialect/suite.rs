//! The facts that a dialect is held against.

use super::compare::compared;
use super::job::{LEAST_RADIUS_MM, long_with_arcs};
use super::reader::hear;
use super::{Fault, Job, Move, Reading, ensure, random, small};
use crate::{Arc, Command, Dialect, Direction, Plane, PostError, Units};
use std::f64::consts::TAU;
use std::io;

/// Texts that try to leave their comment, to be an order or to break a controller.
pub const HOSTILE_TEXTS: [&str; 16] = [
    ")\nG0 Z-50",
    "a) G0 Z-50 (",
    "x\r\nM3 S99999\r\n",
    ";\u{0}!\u{18}?~\u{84}\u{85}\u{2028}",
    "LOGOPEN,/tmp/log",
    "py,import os",
    "MSG,$H",
    "((((nested))))",
    "%",
    "é∅漢字🔧 %x=[1+1]",
    "%\nO9000",
    "%_N_OTHER_MPF\n;$PATH=/_N_WKS_DIR",
    "RELIEF MM\n1 L Z-50 FMAX",
    "'\nM3,0,0,-50",
    "* M117 x ;@pause",
    "{number}{{ tool }}{% if 1 %}",
];

/// Bytes after which the sink of [`cancels`] refuses.
const SINK_FULL: usize = 100_000;

/// Bytes that it may be handed in all: output may cross in parts of a megabyte.
const SINK_MOST: usize = 2 << 20;

/// All facts, the quickest first.
pub(super) fn all(dialect: &dyn Dialect, reading: &Reading) -> Fault {
    described(dialect)?;
    for units in [Units::Mm, Units::Inch] {
        for mut tried in [Job::at(1.0, 2.0), small(dialect), long_for(reading, units)] {
            for lines_only in [false, true] {
                tried.units = units;
                tried.lines_only = lines_only;
                job(dialect, reading, &tried)?;
            }
        }
        arcs_of_every_size(dialect, reading, units)?;
    }
    texts(dialect, reading)?;
    far(dialect, reading)?;
    refuses(dialect)?;
    cancels(dialect)
}

/// The long job, its arcs as large in steps as those of usual decimals.
fn long_for(reading: &Reading, units: Units) -> Job {
    let coarser = match units {
        Units::Mm => 3_i32 - reading.decimals[0] as i32,
        Units::Inch => 4_i32 - reading.decimals[1] as i32,
    };
    long_with_arcs(units, LEAST_RADIUS_MM * 10_f64.powi(coarser.max(0)))
}

fn described(dialect: &dyn Dialect) -> Fault {
    let (name, about, extension) = (dialect.name(), dialect.about(), dialect.extension());
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    ensure(!name.is_empty() && name.chars().all(plain), || {
        "its name has lower-case letters, digits and _".to_owned()
    })?;
    let line = !about.trim().is_empty() && !about.contains(char::is_control);
    ensure(line, || "it says in a line what controllers it is for".to_owned())?;
    let short = !extension.is_empty() && extension.bytes().all(|b| b.is_ascii_alphanumeric());
    ensure(short, || format!("{extension:?} is no extension for a file"))
}

/// Posts a job twice, reads it back and compares; answers the program.
pub(super) fn job(dialect: &dyn Dialect, reading: &Reading, job: &Job) -> Fault<String> {
    let text = job.post(dialect).map_err(|error| format!("it refuses a job: {error}"))?;
    let again = job.post(dialect).map_err(|error| format!("it refuses a job: {error}"))?;
    ensure(text == again, || "the same program gives different bytes".to_owned())?;
    let heard = hear(&text, reading)?;
    compared(job, &heard.moves, reading)?;
    let dwell = job.commands.iter().rev().find_map(|command| match command {
        Command::Dwell { seconds } => Some(*seconds),
        _ => None,
    });
    if let Some(meant) = dwell
        && reading.read.is_none()
    {
        let waits = heard.dwells_s.iter().any(|read| (read - meant).abs() < 0.001);
        ensure(waits, || format!("no dwell is {meant} s: {:?}", heard.dwells_s))?;
    }
    Ok(text)
}

/// Whatever their size, arcs end where they must and lie where they are meant.
fn arcs_of_every_size(dialect: &dyn Dialect, reading: &Reading, units: Units) -> Fault {
    let mut random = random(11);
    let step = match units {
        Units::Mm => 0.1_f64.powi(reading.decimals[0] as i32),
        Units::Inch => 25.4 * 0.1_f64.powi(reading.decimals[1] as i32),
    };
    for k in 0..1000 {
        let (job, center, radius, to) = one_arc(k, units, &mut random);
        let text = job.post(dialect).map_err(|error| format!("it refuses an arc: {error}"))?;
        let mut last = [f64::NAN; 3];
        for moved in &hear(&text, reading)?.moves {
            last = match moved {
                Move::Rapid { to } => *to,
                Move::Feed { to, .. } => *to,
                Move::Arc(arc) => arc.to,
            };
            // What a rounded point may lie off its circle.
            let off = (last[0] - center[0]).hypot(last[1] - center[1]) - radius;
            let cuts = !matches!(moved, Move::Rapid { .. });
            ensure(!cuts || off.abs() < 2.0 * step, || format!("{off} mm off its arc: {text}"))?;
        }
        let ends = (0..3).all(|axis| (last[axis] - to[axis]).abs() < 2.0 * step);
        ensure(ends, || format!("it ends at {last:?}, not {to:?}: {text}"))?;
    }
    Ok(())
}

/// A job of one arc in XY, its centre, radius and end.
fn one_arc(
    k: usize,
    units: Units,
    random: &mut impl FnMut() -> f64,
) -> (Job, [f64; 3], f64, [f64; 3]) {
    let radius = 10_f64.powf(7.5 * random() - 4.0);
    let (begin, full) = (TAU * random(), random() < 0.2);
    let turn = if full { 0.0 } else { TAU * random().powi(if k % 4 < 2 { 1 } else { 4 }) };
    let direction = [Direction::Clockwise, Direction::CounterClockwise][k % 2];
    let end = if direction == Direction::Clockwise { begin - turn } else { begin + turn };
    let center = [100.0 * random(), 100.0 * random(), 0.0];
    let at = |angle: f64, z: f64| {
        [center[0] + radius * angle.cos(), center[1] + radius * angle.sin(), z]
    };
    let z = if random() < 0.5 { 5.0 } else { 5.0 + random() };
    let (start, to) = (at(begin, 5.0), at(end, z));
    let mut job = Job { units, ..Job::at(start[0], start[1]) };
    job.arc(Arc { plane: Plane::Xy, direction, center, to, mm_per_min: 100.0 });
    (job, center, radius, to)
}

/// No text gets out of its comment, however long it is.
fn texts(dialect: &dyn Dialect, reading: &Reading) -> Fault {
    for text in HOSTILE_TEXTS {
        let padded = format!("{}{text}", "word ".repeat(30));
        for text in [text.to_owned(), padded, text.repeat(500)] {
            let mut tried = Job::at(0.0, 0.0);
            tried.title.clone_from(&text);
            tried.remarks = vec![text.clone(); 3];
            tried.comment(&text);
            let program = job(dialect, reading, &tried)?;
            ensure(program.lines().count() < 100, || format!("a text takes pages: {program}"))?;
        }
    }
    Ok(())
}

/// The longest numbers fit, or are refused.
fn far(dialect: &dyn Dialect, reading: &Reading) -> Fault {
    let far = 999_999.0;
    let mut job = Job::at(-far, -far);
    job.feed([-far, -far, -far], far);
    job.arc(Arc {
        plane: Plane::Xy,
        direction: Direction::CounterClockwise,
        center: [-far + 8_888.888, -far, -far],
        to: [-far, -far, far],
        mm_per_min: far - 1.0,
    });
    match job.post(dialect) {
        Ok(text) => hear(&text, reading).map(drop),
        Err(_) => Ok(()),
    }
}

/// Jobs that must be refused, and why.
#[must_use]
pub fn refused_jobs() -> Vec<(&'static str, Job)> {
    let start = || Job::at(0.0, 0.0);
    let commands = |more: &[Command]| {
        let mut job = start();
        job.commands.extend_from_slice(more);
        job
    };
    let mut jobs = vec![
        ("a cut before the position is known", {
            let mut job = Job::default();
            job.feed([0.0; 3], 100.0);
            job
        }),
        ("an index outside its table", commands(&[Command::Arc { arc: 3 }])),
        ("an index outside its table", commands(&[Command::Comment { text: 0 }])),
        ("tool 0", commands(&[Command::ToolChange { number: 0 }])),
        ("a tool that no table has", commands(&[Command::ToolChange { number: u32::MAX }])),
    ];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
        let direction = Direction::Clockwise;
        jobs.push(("an absurd rapid", commands(&[Command::Rapid { to: [bad, 0.0, 5.0] }])));
        let feed = Command::Feed { to: [0.0, bad, 5.0], mm_per_min: 100.0 };
        jobs.push(("an absurd cut", commands(&[feed])));
        let feed = Command::Feed { to: [1.0, 0.0, 5.0], mm_per_min: bad };
        jobs.push(("an absurd feed", commands(&[feed])));
        jobs.push(("an absurd speed", commands(&[Command::Spindle { rpm: bad, direction }])));
        jobs.push(("an absurd dwell", commands(&[Command::Dwell { seconds: bad }])));
        for (center, to) in [([bad, 0.0, 5.0], [2.0, 0.0, 5.0]), ([1.0, 0.0, 5.0], [2.0, 0.0, bad])]
        {
            let mut job = start();
            let plane = Plane::Xy;
            job.arc(Arc { plane, direction, center, to, mm_per_min: 100.0 });
            jobs.push(("an absurd arc", job));
        }
    }
    for bad in [0.0, -1.0] {
        let feed = Command::Feed { to: [1.0, 0.0, 5.0], mm_per_min: bad };
        jobs.push(("a feed that is none", commands(&[feed])));
        let direction = Direction::Clockwise;
        let spindle = Command::Spindle { rpm: bad, direction };
        jobs.push(("a speed that is none", commands(&[spindle])));
    }
    let mut job = start();
    job.arc(Arc {
        plane: Plane::Xy,
        direction: Direction::CounterClockwise,
        center: [1.0, 0.0, 5.0],
        to: [2.1, 0.0, 5.0],
        mm_per_min: 100.0,
    });
    jobs.push(("an arc whose ends are not on one circle", job));
    jobs
}

fn refuses(dialect: &dyn Dialect) -> Fault {
    for (what, job) in refused_jobs() {
        let posted = job.post(dialect);
        ensure(posted.is_err(), || format!("it writes {what}: {posted:?}"))?;
    }
    if !dialect.capabilities().tool_change {
        let mut job = Job::at(0.0, 0.0);
        job.commands.push(Command::ToolChange { number: 1 });
        ensure(job.post(dialect).is_err(), || "it changes tools, but says it cannot".to_owned())?;
    }
    Ok(())
}

/// A sink that refuses is not handed the rest of a program, here of more than twice [`SINK_MOST`].
fn cancels(dialect: &dyn Dialect) -> Fault {
    struct Full(usize);
    impl io::Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 += bytes.len();
            if self.0 > SINK_FULL { Err(io::Error::other("enough")) } else { Ok(bytes.len()) }
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let mut job = Job::at(0.0, 0.0);
    for k in 1..400_000 {
        job.feed([f64::from(k) + 0.125, 0.0, 0.0], 1.0);
    }
    let mut sink = Full(0);
    let posted = job.post_to(dialect, &mut sink);
    let told = matches!(posted, Err(PostError::Io(_)));
    ensure(told, || format!("a sink refused, and it answers {posted:?}"))?;
    ensure(sink.0 < SINK_MOST, || format!("a sink refused, and it wrote {} bytes", sink.0))
}

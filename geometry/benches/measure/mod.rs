//! A table of what a drop takes: the index, and each cutter location on one thread and on two.
//!
//! Of some runs the fastest counts. Beside the wall time stands the time that the threads were on a
//! processor, which others that use the machine disturb less; it is known on Linux only.

use carvegraph_geometry::{DropCutter, Pattern, Profile, Surface};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::time::Instant;

/// Runs of each job, of which the fastest counts.
const RUNS: usize = 3;

/// Seconds.
#[derive(Clone, Copy)]
struct Times {
    cpu: f64,
    wall: f64,
}

impl Times {
    const LONGEST: Self = Self { cpu: f64::INFINITY, wall: f64::INFINITY };

    fn of<T>(run: impl FnOnce() -> T) -> (Self, T) {
        let (cpu, begin) = (cpu_s(), Instant::now());
        let value = run();
        (Self { wall: begin.elapsed().as_secs_f64(), cpu: cpu_s() - cpu }, value)
    }

    fn least(self, other: Self) -> Self {
        Self { cpu: self.cpu.min(other.cpu), wall: self.wall.min(other.wall) }
    }
}

/// Seconds that all threads of this program were on a processor; NaN where nobody says.
fn cpu_s() -> f64 {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return f64::NAN };
    let of = |task: std::io::Result<std::fs::DirEntry>| -> Option<f64> {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse().ok()
    };
    tasks.filter_map(of).sum::<f64>() * 1e-9
}

/// Whether a job was asked for: by words that its name holds, or all.
pub(crate) fn asked_for(name: &str) -> bool {
    let mut words = std::env::args().skip(1).filter(|word| !word.starts_with('-')).peekable();
    words.peek().is_none() || words.any(|word| name.contains(&word))
}

/// Pools of one thread and of two. They last, so that the time of their threads is never lost.
pub(crate) struct Pools([ThreadPool; 2]);

/// Makes the pools and prints the head of the table.
#[allow(dead_code, reason = "each bench prints one of the tables")]
pub(crate) fn begin() -> Pools {
    let groups = ["index", "1 thread", "2 threads"];
    println!("{:41} {:>17} {:>17} {:>17} {:>7}", "", groups[0], groups[1], groups[2], "2 / 1");
    println!(
        "{:32} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>7}",
        "job", "CL", "cpu s", "wall s", "cpu us", "wall us", "cpu us", "wall us", "cpu"
    );
    pools()
}

fn pools() -> Pools {
    Pools([1, 2].map(|threads| {
        ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started")
    }))
}

/// Prints the row of a job.
#[allow(dead_code, reason = "each bench prints one of the tables")]
pub(crate) fn row(
    Pools(pools): &Pools,
    name: &str,
    surface: Surface,
    pattern: &Pattern,
    profile: &Profile,
) {
    let (mut index, mut drop) = (Times::LONGEST, [Times::LONGEST; 2]);
    for _ in 0..RUNS {
        for (pool, drop) in pools.iter().zip(&mut drop) {
            pool.install(|| {
                let (took, ready) = Times::of(|| DropCutter::new(surface, profile, 0.0, &|_| true));
                index = index.least(took);
                let ready = ready.expect("the surface is sound");
                let (took, _) = Times::of(|| ready.path(pattern, 0.0, &|_| true));
                *drop = drop.least(took);
            });
        }
    }
    let each = |seconds: f64| seconds / pattern.points.len() as f64 * 1e6;
    println!(
        "{name:32} {:8} {:8.3} {:8.3} {:8.3} {:8.3} {:8.3} {:8.3} {:7.3}",
        pattern.points.len(),
        index.cpu,
        index.wall,
        each(drop[0].cpu),
        each(drop[0].wall),
        each(drop[1].cpu),
        each(drop[1].wall),
        drop[1].cpu / drop[0].cpu
    );
}

/// Cutters of all kinds, R = 3 mm.
pub(crate) fn cutters() -> Vec<(&'static str, Profile)> {
    use carvegraph_geometry::Segment::{Arc, Line};
    let line = |r, h| Line { to: [r, h] };
    let turn = |degrees: u32| f64::from(degrees).to_radians().sin_cos();
    let (sin, cos) = turn(5);
    let (nose_r, nose_h) = (0.5 * cos, 0.5 * (1.0 - sin));
    let nose = Arc { to: [nose_r, nose_h], center: [0.0, 0.5] };
    let flank = line(3.0, nose_h + (3.0 - nose_r) * cos / sin);
    // As a drawing's curve comes: hollow, in many lines.
    let hollow = (1..=90).map(|k| line(0.5 + 2.5 * (1.0 - turn(k).1), 2.5 * turn(k).0));
    let step = vec![line(1.0, 0.5), line(1.0, 1.5), line(2.0, 1.5)];
    let corner = Arc { to: [3.0, 2.5], center: [2.0, 2.5] };
    let made = [
        ("ball", Profile::ball(3.0)),
        ("flat", Profile::flat(3.0)),
        ("bull nose", Profile::bull_nose(3.0, 1.0)),
        ("V 60", Profile::new(vec![line(3.0, 3.0 * 3_f64.sqrt())])),
        ("V 90, flat tip", Profile::new(vec![line(0.1, 0.0), line(3.0, 2.9)])),
        ("tapered ball", Profile::new(vec![nose, flank])),
        ("form, step", Profile::new(step.into_iter().chain([corner]).collect())),
        ("form, hollow", Profile::new([line(0.5, 0.0)].into_iter().chain(hollow).collect())),
    ];
    made.into_iter().map(|(name, made)| (name, made.expect("the shape is sound"))).collect()
}

/// Makes the pools and prints the head of a table of whole jobs.
#[allow(dead_code, reason = "each bench prints one of the tables")]
pub(crate) fn begin_jobs(what: &str) -> Pools {
    let head = ["1 cpu s", "1 wall s", "2 cpu s", "2 wall s"];
    println!("{:32} {what:>8} {:>8} {:>8} {:>8} {:>8}", "job", head[0], head[1], head[2], head[3]);
    pools()
}

/// Prints the row of a job that does so many things.
#[allow(dead_code, reason = "each bench prints one of the tables")]
pub(crate) fn job<T: Send>(
    Pools(pools): &Pools,
    name: &str,
    count: usize,
    run: impl Fn() -> T + Sync,
) {
    let mut least = [Times::LONGEST; 2];
    for _ in 0..RUNS {
        for (pool, least) in pools.iter().zip(&mut least) {
            *least = least.least(pool.install(|| Times::of(&run).0));
        }
    }
    let [one, two] = least;
    println!(
        "{name:32} {count:8} {:8.3} {:8.3} {:8.3} {:8.3}",
        one.cpu, one.wall, two.cpu, two.wall
    );
}

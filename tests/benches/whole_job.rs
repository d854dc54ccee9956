//! Whole jobs, picture to program, and the preparation of a photograph, each as a process of its own: how
//! long, and how much memory.
//!
//! The pictures are made here: soft shapes, hard edges and fine grain, as a photograph has them.

#![expect(clippy::print_stdout, reason = "the figures are what this program is for")]

use image::{ImageEncoder, RgbImage};
use serde_json::Value as Json;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A job, and what the source or the project asks of it.
struct Job {
    recipe: &'static str,
    picture: (u32, u32),
    set: &'static [&'static str],
    runs: usize,
    goal: &'static str,
}

/// Every node that prepares pictures.
const PREPARATION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/preparation.ron");

const JOBS: [Job; 5] = [
    Job { recipe: PREPARATION, picture: (6000, 4000), set: &[], runs: 9, goal: "2 s" },
    Job {
        recipe: "relief",
        picture: (480, 480),
        set: &["surface=mesh"],
        runs: 9,
        goal: "1 s (source: 16 min 14 s)",
    },
    Job {
        recipe: "relief",
        picture: (1104, 1392),
        set: &["surface=mesh"],
        runs: 5,
        goal: "3 s (source: 72 min 58 s)",
    },
    Job {
        recipe: "relief",
        picture: (10_000, 10_000),
        set: &["save_mesh=none"],
        runs: 1,
        goal: "60 s, 3 GiB",
    },
    Job {
        recipe: "relief",
        picture: (10_000, 10_000),
        set: &["save_mesh=none", "surface=mesh"],
        runs: 1,
        goal: "60 s, 3 GiB",
    },
];

fn main() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("whole_job");
    fs::create_dir_all(&folder).expect("the folder for pictures");
    println!(
        "{:<14} {:<32} {:>7} {:>7} {:>9}  goal",
        "picture", "set", "best s", "median", "peak MB"
    );
    for job in &JOBS {
        let picture = picture(&folder, job.picture);
        let mut reports: Vec<Json> = (0..job.runs).map(|_| run(&folder, &picture, job)).collect();
        let wall_s = |report: &Json| report["wall_s"].as_f64().expect("a time");
        reports.sort_by(|a, b| wall_s(a).total_cmp(&wall_s(b)));
        let peak = reports.iter().filter_map(|report| report["peak_rss_mb"].as_f64());
        println!(
            "{:<14} {:<32} {:>7.2} {:>7.2} {:>9.0}  {}",
            format!("{} x {}", job.picture.0, job.picture.1),
            job.set.join(" "),
            wall_s(&reports[0]),
            wall_s(&reports[reports.len() / 2]),
            peak.fold(0.0, f64::max),
            job.goal
        );
        if job.recipe == PREPARATION {
            print_nodes(&reports);
        }
    }
}

/// The least time that each node took in any run.
fn print_nodes(reports: &[Json]) {
    let nodes = reports[0]["nodes"].as_object().expect("nodes");
    for (id, node) in nodes {
        let wall_s = reports.iter().filter_map(|report| report["nodes"][id]["wall_s"].as_f64());
        let kind = node["kind"].as_str().unwrap_or_default();
        println!("{kind:>47} {:>7.3}", wall_s.fold(f64::INFINITY, f64::min));
    }
}

fn run(folder: &Path, picture: &Path, job: &Job) -> Json {
    let report = folder.join("report.json");
    let mut command = Command::new(env!("CARGO_BIN_EXE_carve-under-test"));
    command.args(["run", job.recipe, "--quiet", "--report"]).arg(&report);
    command.arg("--out").arg(folder.join("out"));
    command.arg("--set").arg(format!("image={}", picture.display()));
    for set in job.set {
        command.args(["--set", set]);
    }
    assert!(command.status().expect("carve starts").success(), "the job fails");
    serde_json::from_slice(&fs::read(report).expect("a report")).expect("a report in JSON")
}

/// Makes the picture, or finds it from the last time.
fn picture(folder: &Path, (width, height): (u32, u32)) -> PathBuf {
    let path = folder.join(format!("{width}x{height}.png"));
    if path.exists() {
        return path;
    }
    let scale = 8.0 / f64::from(width.max(height));
    let picture = RgbImage::from_fn(width, height, |x, y| {
        let gray = 255.0 * brightness(f64::from(x) * scale, f64::from(y) * scale, x, y);
        let gray = gray as u8;
        image::Rgb([gray, gray.saturating_add(9), gray.saturating_sub(9)])
    });
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(&picture, width, height, image::ExtendedColorType::Rgb8)
        .expect("a picture");
    fs::write(&path, bytes).expect("the picture is written");
    path
}

/// Soft shapes, a few hard edges, and grain of 3 % from pixel to pixel.
fn brightness(u: f64, v: f64, x: u32, y: u32) -> f64 {
    let soft = 0.5 + 0.2 * (u * 1.3 + (v * 0.9).sin()).sin() + 0.15 * (u * 3.1 - v * 2.3).cos();
    let edge = if (u * 0.8).sin() + (v * 1.1).cos() > 0.7 { 0.15 } else { 0.0 };
    let mut hash = x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2C1B_3C6D);
    let grain = f64::from(hash >> 16) / 65536.0 - 0.5;
    (soft + edge + 0.03 * grain).clamp(0.0, 1.0)
}

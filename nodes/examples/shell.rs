//! Makes the bundled samples `graphs/samples/shell.obj` and `shell.xyz`: a ribbed shell of 60 mm, as a
//! closed mesh and as a scan of its upper side.
//!
//! Height over radius r and angle φ, with R = 30 mm: 12 (1 - (r/R)²) (1 + 0.12 (r/R) cos 12φ). The mesh
//! has a fan in the middle, quads around it and one polygon as its base, so it shows what OBJ faces
//! may be. Lengths are rounded to a micrometre.
//!
//! ```text
//! cargo run --release --example shell [graphs/samples]
//! ```

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// R, in mm.
const RADIUS_MM: f64 = 30.0;
/// Height of the middle, in mm.
const HEIGHT_MM: f64 = 12.0;
/// Ribs around, and how far they rise at the rim as a share of the height.
const RIBS: f64 = 12.0;
const RISE: f64 = 0.12;
/// Rings and sectors of the mesh.
const RINGS: u32 = 20;
const SECTORS: u32 = 72;
/// Distance of the points of the scan, in mm: a seventh of the radius of a 12 mm cutter.
const PITCH_MM: f64 = 0.85;

fn main() -> std::io::Result<()> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs/samples");
    let folder = std::env::args_os().nth(1).map_or(default, PathBuf::from);
    std::fs::write(folder.join("shell.obj"), mesh())?;
    std::fs::write(folder.join("shell.xyz"), scan())
}

fn height(x: f64, y: f64) -> f64 {
    let (share, angle) = (x.hypot(y) / RADIUS_MM, y.atan2(x));
    HEIGHT_MM * (1.0 - share * share) * (1.0 + RISE * share * (RIBS * angle).cos())
}

/// A number of three decimals without a sign before zero.
fn micrometre(length: f64) -> String {
    let text = format!("{length:.3}");
    if text == "-0.000" { "0.000".to_owned() } else { text }
}

fn place(x: f64, y: f64) -> String {
    [x, y, height(x, y)].map(micrometre).join(" ")
}

/// The closed mesh as OBJ.
#[must_use]
pub fn mesh() -> String {
    let mut text = "# Carvegraph sample: a ribbed shell, mm\no shell\n".to_owned();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "v {}", place(0.0, 0.0));
    for (ring, sector) in (1..=RINGS).flat_map(|ring| (0..SECTORS).map(move |s| (ring, s))) {
        let radius = RADIUS_MM * f64::from(ring) / f64::from(RINGS);
        let (sin, cos) = (TAU * f64::from(sector) / f64::from(SECTORS)).sin_cos();
        let _ = writeln!(text, "v {}", place(radius * cos, radius * sin));
    }
    let vertex = |ring: u32, sector: u32| 2 + (ring - 1) * SECTORS + sector % SECTORS;
    for s in 0..SECTORS {
        let _ = writeln!(text, "f 1 {} {}", vertex(1, s), vertex(1, s + 1));
    }
    for (ring, s) in (1..RINGS).flat_map(|ring| (0..SECTORS).map(move |s| (ring, s))) {
        let inner = [vertex(ring, s + 1), vertex(ring, s)];
        let outer = [vertex(ring + 1, s), vertex(ring + 1, s + 1)];
        let _ = writeln!(text, "f {} {} {} {}", inner[0], inner[1], outer[0], outer[1]);
    }
    let base: Vec<String> = (0..SECTORS).rev().map(|s| vertex(RINGS, s).to_string()).collect();
    let _ = writeln!(text, "f {}", base.join(" "));
    text
}

/// Points of the upper side, row by row.
#[must_use]
pub fn scan() -> String {
    let steps = (RADIUS_MM / PITCH_MM).floor() as i32;
    let mut text = "# Carvegraph sample: a scan of a ribbed shell, mm\nx y z\n".to_owned();
    for (j, i) in (-steps..=steps).flat_map(|j| (-steps..=steps).map(move |i| (j, i))) {
        let (x, y) = (f64::from(i) * PITCH_MM, f64::from(j) * PITCH_MM);
        if x.hypot(y) <= RADIUS_MM {
            let _ = writeln!(text, "{}", place(x, y));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_shipped(name: &str, computed: &str) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs/samples");
        let shipped = std::fs::read_to_string(folder.join(name)).unwrap();
        assert_eq!(shipped.lines().count(), computed.lines().count());
        // Last digits may differ between machines, as the last bits of sin and cos may.
        let same = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
            (Ok(a), Ok(b)) => (a - b).abs() < 0.0015,
            _ => a == b,
        };
        assert!(shipped.split_whitespace().zip(computed.split_whitespace()).all(same), "{name}");
    }

    #[test]
    fn the_shipped_shell_is_what_this_computes() {
        assert_shipped("shell.obj", &mesh());
        assert_shipped("shell.xyz", &scan());
    }
}

//! Compares passes planned by scallop with plain parallel passes.
//!
//! `compare_scallop PART SCALLOP RADIUS LEAST` with PART `bezier`, `convex` or a binary STL. A ball of the
//! radius, in mm, is led over the part by each planner; then along plain passes, the stepover halved in until
//! 99 % of the surface is left as low as by the straight planner. Says of each: passes, points, the length
//! fed, and what is left of the surface that the ball touches from places every fifth of a flat step, a
//! radius off the border: 99 % of it is below p99, all of it below max. `held` leaves out what is steeper
//! than 75°.

#![allow(clippy::print_stdout, reason = "the figures are what this program is for")]

use carvegraph_geometry::{
    BezierPatch, Borders, Bounds, ConstantScallop, ContactKind, DVec2, DVec3, DropCutter, Finish,
    Finished, Mesh, Pattern, PatternSpan, Profile, Raster, RasterStyle, ScallopRaster, SpanKind,
    Surface, Toolpath,
};
use rayon::prelude::*;
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

type Anyhow<T> = Result<T, Box<dyn Error>>;

/// What is steeper is not held.
const STEEPEST_DEG: f64 = 75.0;

fn main() -> Anyhow<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [part, scallop, radius, least] = &arguments[..] else {
        return Err("compare_scallop PART SCALLOP RADIUS LEAST".into());
    };
    let mesh = match part.as_str() {
        "bezier" => BezierPatch::rising().part(20, 0.0, &|_| true)?,
        "convex" => BezierPatch::convex().part(20, 0.0, &|_| true)?,
        file => binary_stl(&std::fs::read(file)?),
    };
    let bounds = mesh.bounds().ok_or("no triangles")?;
    let (scallop_mm, radius): (f64, f64) = (scallop.parse()?, radius.parse()?);
    let profile = Profile::ball(radius)?;
    let finish = Finish {
        surface: Surface::Mesh(&mesh),
        profile: &profile,
        area: bounds,
        along_y: bounds.size().y > bounds.size().x,
        style: RasterStyle::Zigzag,
        scallop_mm,
        least_step_mm: least.parse()?,
        steepest_rad: STEEPEST_DEG.to_radians(),
        floor_mm: bounds.min.z,
        allowance_mm: 0.0,
        chord_tolerance_mm: 0.01,
        most_points: 50_000_000,
    };
    let flat_mm = 2.0 * (2.0 * radius * scallop_mm - scallop_mm * scallop_mm).sqrt();
    let ground = Ground::new(&finish, flat_mm / 5.0)?;
    println!(
        "{part}: {} triangles, {:.1} mm, ball {radius}, scallop {scallop_mm}",
        mesh.triangles.len(),
        bounds.size()
    );
    let begin = Instant::now();
    let straight = ScallopRaster { finish, borders: Borders::Inset }.plan(&|_| true)?;
    let p99 = told("scallop_raster", &straight, begin, &ground);
    let begin = Instant::now();
    let bent = ConstantScallop { finish }.plan(&|_| true)?;
    told("constant_scallop", &bent, begin, &ground);
    let (mut low, mut high) = (flat_mm / 50.0, 2.0 * flat_mm);
    for _ in 0..7 {
        let middle = (low * high).sqrt();
        let holds = ground.left(&plain(&finish, middle)?).held_p99 <= p99;
        (low, high) = if holds { (middle, high) } else { (low, middle) };
    }
    let begin = Instant::now();
    let found = Finished { path: plain(&finish, low)?, held: straight.held };
    told(&format!("raster {low:.3} mm"), &found, begin, &ground);
    Ok(())
}

fn told(name: &str, found: &Finished, begin: Instant, ground: &Ground) -> f64 {
    let (took_s, path) = (begin.elapsed().as_secs_f64(), &found.path);
    let left = ground.left(path);
    println!(
        "{name}: {} passes, {} CL, {:.0} mm fed, held p99 {:.4} max {:.4}, all p99 {:.4} max {:.4}, {took_s:.2} s, \
         {} of {} probes above",
        path.passes(),
        path.cl_points(),
        path.length_mm(|kind| kind != SpanKind::Rapid),
        left.held_p99,
        left.held_max,
        left.p99,
        left.max,
        found.held.above,
        found.held.probes
    );
    left.held_p99
}

/// Passes a step apart, with points where they bend.
fn plain(finish: &Finish<'_>, step_mm: f64) -> Anyhow<Toolpath> {
    let direction_rad = if finish.along_y { std::f64::consts::FRAC_PI_2 } else { 0.0 };
    let (stepover_mm, feed_step_mm, style) = (step_mm, step_mm, RasterStyle::Zigzag);
    let raster = Raster { stepover_mm, feed_step_mm, direction_rad, style };
    let cutter = DropCutter::new(finish.surface, finish.profile, 0.0, &|_| true)?;
    let pattern = raster.pattern(&finish.area);
    let mut path = cutter.path(&pattern, finish.floor_mm, &|_| true).ok_or("stopped")?;
    path.raise(finish.floor_mm);
    Ok(cutter.bend(&path, finish.floor_mm, 0.01, finish.most_points, &|_| true)?)
}

/// Points of the surface that a ball touches, with normals.
struct Ground {
    points: Vec<(DVec3, DVec3)>,
    bounds: Bounds,
    radius: f64,
}

/// What a path leaves, in mm.
struct Left {
    held_p99: f64,
    held_max: f64,
    p99: f64,
    max: f64,
}

impl Ground {
    fn new(finish: &Finish<'_>, pitch: f64) -> Anyhow<Self> {
        let (bounds, radius) = (finish.area, finish.profile.radius_mm());
        let (from, to) = (bounds.min.truncate() + radius, bounds.max.truncate() - radius);
        let [columns, rows] = ((to - from) / pitch).to_array().map(|n| n.max(0.0) as usize);
        let at = |k: usize| from + DVec2::new((k % columns) as f64, (k / columns) as f64) * pitch;
        let points: Vec<DVec2> = (0..columns * rows).map(at).collect();
        let spans = vec![PatternSpan { points: 0..points.len(), link: false, joined: false }];
        let cutter = DropCutter::new(finish.surface, finish.profile, 0.0, &|_| true)?;
        let path = cutter.path(&Pattern { points, spans }, finish.floor_mm, &|_| true);
        let path = path.ok_or("stopped")?;
        let touched = path.tips.iter().zip(&path.contacts).filter_map(|(tip, contact)| {
            let normal = (*tip + DVec3::Z * radius - contact.point) / radius;
            let counts =
                contact.kind != ContactKind::None && normal.z > 0.0 && tip.z >= finish.floor_mm;
            counts.then_some((contact.point, normal))
        });
        Ok(Self { points: touched.collect(), bounds, radius })
    }

    fn left(&self, path: &Toolpath) -> Left {
        let swept = Swept::new(path, self.radius, &self.bounds);
        let level = STEEPEST_DEG.to_radians().cos();
        let left =
            |(point, normal): &(DVec3, DVec3)| (swept.left(*point, *normal), normal.z >= level);
        let all: Vec<(f64, bool)> = self.points.par_iter().map(left).collect();
        let sorted = |held: bool| {
            let mut left: Vec<f64> = all.iter().filter(|l| l.1 || !held).map(|l| l.0).collect();
            left.sort_by(f64::total_cmp);
            [left[left.len() * 99 / 100], left[left.len() - 1]]
        };
        let ([held_p99, held_max], [p99, max]) = (sorted(true), sorted(false));
        Left { held_p99, held_max, p99, max }
    }
}

/// Moves of a sphere, by the squares of the plan that they may touch.
struct Swept {
    radius: f64,
    min: DVec2,
    columns: usize,
    moves: Vec<Vec<(DVec3, DVec3)>>,
}

/// The square millimetre of a place.
fn cell_of(place: DVec2) -> [usize; 2] {
    [place.x as usize, place.y as usize]
}

impl Swept {
    fn new(path: &Toolpath, radius: f64, bounds: &Bounds) -> Self {
        let min = bounds.min.truncate() - 2.0 * radius;
        let [columns, rows] = cell_of(bounds.size().truncate() + 4.0 * radius).map(|n| n + 1);
        let mut moves = vec![Vec::new(); columns * rows];
        for span in &path.spans {
            for to in (span.points.start + usize::from(!span.joined)).max(1)..span.points.end {
                let [a, b] = [path.tips[to - 1], path.tips[to]].map(|tip| tip + DVec3::Z * radius);
                let low = cell_of(a.min(b).truncate() - radius - min);
                let high = cell_of(a.max(b).truncate() + radius - min);
                for y in low[1]..=high[1].min(rows - 1) {
                    for x in low[0]..=high[0].min(columns - 1) {
                        moves[y * columns + x].push((a, b));
                    }
                }
            }
        }
        Self { radius, min, columns, moves }
    }

    fn off(&self, place: DVec3) -> f64 {
        let [x, y] = cell_of(place.truncate() - self.min);
        let away = |(a, b): &(DVec3, DVec3)| {
            let way = *b - *a;
            let share = (place - *a).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
            place.distance(*a + way * share.clamp(0.0, 1.0))
        };
        self.moves[y * self.columns + x].iter().map(away).fold(f64::INFINITY, f64::min)
            - self.radius
    }

    /// How far along a normal what is cut begins, by walking as far as nothing is: up to the radius.
    fn left(&self, point: DVec3, normal: DVec3) -> f64 {
        let mut t = 0.0;
        for _ in 0..60 {
            let off = self.off(point + normal * t);
            if off <= 1e-5 || t >= self.radius {
                break;
            }
            t += off;
        }
        t.min(self.radius)
    }
}

fn binary_stl(bytes: &[u8]) -> Mesh {
    let float = |at: &[u8]| f64::from(f32::from_le_bytes([at[0], at[1], at[2], at[3]]));
    let corner = |at: &[u8]| DVec3::new(float(at), float(&at[4..]), float(&at[8..]));
    let triangles = bytes[84..].chunks_exact(50);
    let vertices: Vec<DVec3> =
        triangles.flat_map(|t| [corner(&t[12..]), corner(&t[24..]), corner(&t[36..])]).collect();
    let triangles = (0..vertices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    Mesh { triangles: triangles.collect(), vertices: Arc::new(vertices) }
}

use carvegraph_geometry::*;
use std::time::Instant;
fn load(columns: usize, rows: usize) -> HeightField {
    let b = std::fs::read("/tmp/astro.f32").unwrap();
    let g: Vec<f32> = b.chunks(4).map(|c| f32::from_le_bytes(c.try_into().unwrap())).collect();
    let at = |x: f64, y: f64| {
        let (x, y) = (x.clamp(0.0, 510.999), y.clamp(0.0, 510.999));
        let (i, j) = (x as usize, y as usize);
        let (s, t) = (x - i as f64, y - j as f64);
        let z = |i: usize, j: usize| g[j * 512 + i] as f64;
        (1.0 - t) * ((1.0 - s) * z(i, j) + s * z(i + 1, j))
            + t * ((1.0 - s) * z(i, j + 1) + s * z(i + 1, j + 1))
    };
    let direct = columns <= 512 && rows <= 512;
    let img: Vec<f64> = (0..columns * rows)
        .map(|k| {
            let (i, j) = ((k % columns) as f64, (rows - 1 - k / columns) as f64);
            if direct {
                at(i, j)
            } else {
                at(i * 511.0 / (columns - 1) as f64, j * 511.0 / (rows - 1) as f64).round()
            }
        })
        .collect();
    let w = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];
    let r101 = |k: isize, n: usize| {
        let n = n as isize;
        let k = k.abs();
        (if k >= n { 2 * n - 2 - k } else { k }) as usize
    };
    let mut h = vec![0.0; columns * rows];
    for j in 0..rows {
        for i in 0..columns {
            h[j * columns + i] = (0..5)
                .map(|d| w[d] * img[j * columns + r101(i as isize + d as isize - 2, columns)])
                .sum();
        }
    }
    let mut v = vec![0.0; columns * rows];
    for j in 0..rows {
        for i in 0..columns {
            v[j * columns + i] = (0..5)
                .map(|d| w[d] * h[r101(j as isize + d as isize - 2, rows) * columns + i])
                .sum();
        }
    }
    let (lo, hi) = v.iter().fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
    let heights = v.iter().map(|x| ((x - lo) / (hi - lo) * 5.0) as f32).collect();
    HeightField::new(columns, rows, 203.0 / columns.max(rows) as f64, heights).unwrap()
}
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let v: Vec<&str> = s[s.rfind(')').unwrap() + 2..].split(' ').collect();
    (v[11].parse::<f64>().unwrap() + v[12].parse::<f64>().unwrap()) / 100.0
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let only = args.get(1).map(String::as_str).unwrap_or("");
    let cases =
        [("480", 480, 480), ("1104", 1104, 1392), ("4000", 4000, 4000), ("10000", 10000, 10000)];
    for (name, c, r) in cases {
        if !only.is_empty() && only != name {
            continue;
        }
        if only.is_empty() && name == "10000" {
            continue;
        }
        let field = load(c, r);
        let long_y = r > c;
        let raster = Raster {
            stepover_mm: 0.3,
            feed_step_mm: 0.3,
            direction_rad: if long_y { std::f64::consts::FRAC_PI_2 } else { 0.0 },
            style: RasterStyle::Zigzag,
        };
        let pattern = raster.pattern(&field.bounds());
        let shapes = [
            ("ball", Profile::ball(3.0).unwrap()),
            ("flat", Profile::flat(3.0).unwrap()),
            ("bull", Profile::bull_nose(3.0, 1.0).unwrap()),
            ("cone", Profile::new(vec![Segment::Line { to: [3.0, 5.2] }]).unwrap()),
        ];
        let want = args.get(2).map(String::as_str).unwrap_or("ball");
        for (shape, profile) in shapes {
            if want != "all" && want != shape {
                continue;
            }
            for against in [Against::Mesh, Against::Points] {
                let mut best = f64::MAX;
                let mut sum = 0.0;
                let c0 = cpu();
                for _ in 0..5 {
                    let t = Instant::now();
                    let path =
                        drop_on_height_field(&field, against, &profile, &pattern, 0.0, &|_| true)
                            .unwrap();
                    best = best.min(t.elapsed().as_secs_f64());
                    sum = path.tips.iter().map(|t| t.z).sum();
                }
                print!("cpu {:.3} us/CL ", (cpu() - c0) / 5.0 * 1e6 / pattern.points.len() as f64);
                println!(
                    "{name} {shape} {against:?}: {} CL, {:.4} s, {:.3} us/CL  sum {sum}",
                    pattern.points.len(),
                    best,
                    best * 1e6 / pattern.points.len() as f64
                );
            }
        }
    }
}

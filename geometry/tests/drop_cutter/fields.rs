//! Fields and cutters to test with.

use carvegraph_geometry::{HeightField, Profile, Segment};
use fastrand::Rng;

pub fn field(
    columns: usize,
    rows: usize,
    pitch: f64,
    z: impl Fn(usize, usize) -> f64,
) -> HeightField {
    let heights = (0..columns * rows).map(|k| z(k % columns, k / columns) as f32).collect();
    HeightField::new(columns, rows, pitch, heights).unwrap()
}

/// A field of a kind chosen by `random`.
pub fn any_field(random: &mut Rng) -> (String, HeightField) {
    let (columns, rows) = (random.usize(2..22), random.usize(2..22));
    let pitch = [0.01, 0.3, 0.42, 1.7, 25.0][random.usize(..5)];
    let noise: Vec<f64> = (0..columns * rows).map(|_| random.f64()).collect();
    let at = |i: usize, j: usize| noise[j * columns + i];
    let height = [0.05, 1.0, 5.0, 40.0][random.usize(..4)];
    let kind = ["noise", "constant", "spikes", "cliff", "saw", "waves", "plane"][random.usize(..7)];
    let z = |i: usize, j: usize| {
        let (x, y) = (i as f64, j as f64);
        height
            * match kind {
                "noise" => at(i, j),
                "constant" => 0.7,
                "spikes" => f64::from(u8::from(at(i, j) > 0.93)),
                "cliff" => f64::from(u8::from(x + 0.6 * y > 9.0)),
                "saw" => (x / 4.0).fract(),
                "waves" => (x * 0.4).sin() * (y * 0.3).cos() + 0.02 * at(i, j),
                _ => 0.1 * x - 0.23 * y,
            }
    };
    let name = format!("{kind} {columns}x{rows} pitch {pitch} height {height}");
    (name, field(columns, rows, pitch, z))
}

fn line(r: f64, h: f64) -> Segment {
    Segment::Line { to: [r, h] }
}

pub fn v_cone(radius: f64) -> Profile {
    Profile::new(vec![line(radius, 1.4 * radius)]).unwrap()
}

/// A small ball that goes over into a cone without a corner.
pub fn tapered_ball(radius: f64) -> Profile {
    let (nose, angle) = (0.4 * radius, 0.35_f64);
    let (r, h) = (nose * angle.cos(), nose * (1.0 - angle.sin()));
    let cone = (radius - r) / angle.tan();
    Profile::new(vec![Segment::Arc { to: [r, h], center: [0.0, nose] }, line(radius, h + cone)])
        .unwrap()
}

/// Steps, concave corners, a shoulder and arcs about places off the axis.
pub fn form_tool(radius: f64) -> Profile {
    let u = radius / 3.0;
    let ogive = ((0.8 * u) * (0.8 * u) + u * u).sqrt();
    let start_center_h = (ogive * ogive - (0.4 * u) * (0.4 * u)).sqrt();
    let ogive_end = start_center_h - (ogive * ogive - (0.9 * u) * (0.9 * u)).sqrt();
    Profile::new(vec![
        Segment::Arc { to: [0.5 * u, ogive_end], center: [-0.4 * u, start_center_h] },
        line(0.9 * u, ogive_end + 0.8 * u),
        line(1.2 * u, ogive_end + 0.9 * u),
        line(1.2 * u, ogive_end + 1.3 * u),
        line(2.0 * u, ogive_end + 1.3 * u),
        Segment::Arc { to: [3.0 * u, ogive_end + 2.3 * u], center: [2.0 * u, ogive_end + 2.3 * u] },
    ])
    .unwrap()
}

/// All kinds of cutters, of one radius.
pub fn cutters(radius: f64) -> [(&'static str, Profile); 7] {
    [
        ("ball", Profile::ball(radius).unwrap()),
        ("flat", Profile::flat(radius).unwrap()),
        ("bull nose", Profile::bull_nose(radius, 0.3 * radius).unwrap()),
        ("cone", v_cone(radius)),
        ("tapered ball", tapered_ball(radius)),
        ("form tool", form_tool(radius)),
        ("shallow dome", dome(radius)),
    ]
}

/// A cap of a sphere of twice the radius.
fn dome(radius: f64) -> Profile {
    let big = 2.0 * radius;
    let h = big - (big * big - radius * radius).sqrt();
    Profile::new(vec![Segment::Arc { to: [radius, h], center: [0.0, big] }]).unwrap()
}

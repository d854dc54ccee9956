//! Levels against closed forms, the oracle and a replay in stock.

use super::*;
use crate::{
    Against, Bounds, DVec3, DropCutter, HeightField, Pattern, PatternSpan, Polygon, Profile,
    SpanKind, Surface, Tick, Toolpath,
};

const GO: Tick<'static> = &|_| true;

/// A field of 40 x 30 mm with heights by a function.
fn field(height: impl Fn(f64, f64) -> f64) -> HeightField {
    let (columns, rows, pitch) = (161, 121, 0.25);
    let heights = (0..rows * columns).map(|k| {
        let (x, y) = ((k % columns) as f64 * pitch, (k / columns) as f64 * pitch);
        height(x, y) as f32
    });
    HeightField::new(columns, rows, pitch, heights.collect()).unwrap()
}

fn levels(field: &HeightField, entry: Entry) -> Levels<'static> {
    let bounds = field.bounds();
    Levels {
        area: bounds,
        boundary: None,
        top_mm: bounds.max.z,
        floor_mm: bounds.min.z,
        step_mm: 1.0,
        allowance_mm: 0.3,
        pitch_mm: 0.3,
        tolerance_mm: 0.01,
        entry,
    }
}

fn hills(x: f64, y: f64) -> f64 {
    3.0 + 1.5 * (x / 3.0).sin() * (y / 4.0).cos() + 1.5 * (x / 7.0 + y / 5.0).sin()
}

/// The lowest tips with nothing left, at some places.
fn least(field: &HeightField, profile: &Profile, allowance: f64, places: Vec<DVec2>) -> Vec<f64> {
    let spans = vec![PatternSpan { points: 0..places.len(), link: false, joined: false }];
    let surface = Surface::Field(field, Against::Mesh);
    let cutter = DropCutter::new(surface, profile, allowance, GO).unwrap();
    let path = cutter.path(&Pattern { points: places, spans }, -10.0, GO).unwrap();
    path.tips.iter().map(|tip| tip.z).collect()
}

/// Places along the moves of a path, 0.05 mm apart, with the kind of move: a rapid to where the cutter
/// comes from above.
fn along_moves(path: &Toolpath) -> Vec<(DVec3, SpanKind)> {
    let mut places = Vec::new();
    for span in &path.spans {
        let first = if span.joined { span.points.start - 1 } else { span.points.start };
        if !span.joined {
            places.push((path.tips[first], SpanKind::Rapid));
        }
        for pair in path.tips[first..span.points.end].windows(2) {
            let parts = (pair[0].distance(pair[1]) / 0.05).ceil().max(1.0) as usize;
            let share = (1..=parts).map(|k| k as f64 / parts as f64);
            places.extend(share.map(|t| (pair[0].lerp(pair[1], t), span.kind)));
        }
    }
    places
}

#[test]
fn levels_are_equally_spaced_and_never_too_far_apart() {
    assert_eq!(heights(5.0, 2.0, 1.0), [4.0, 3.0, 2.0]);
    assert_eq!(heights(1.0, 0.0, 0.4).len(), 3);
    assert_eq!(heights(0.3, 0.0, 0.1).len(), 3);
    assert_eq!(heights(3.0, 0.0, 9.0), [0.0]);
    assert!(heights(0.0, 0.0, 1.0).is_empty() && heights(1.0, 0.0, f64::NAN).is_empty());
}

#[test]
fn a_waterline_of_a_ball_around_a_ball_is_a_circle() {
    // A dome of radius 8 about (20, 15, 0): the ball's middle is 8 + 2 from the dome's.
    let dome = |x: f64, y: f64| (64.0 - (x - 20.0).powi(2) - (y - 15.0).powi(2)).max(0.0).sqrt();
    let field = field(dome);
    let (profile, middle) = (Profile::ball(2.0).unwrap(), DVec2::new(20.0, 15.0));
    let levels = Levels { allowance_mm: 0.0, ..levels(&field, Entry::Plunge) };
    let waterline = Waterline { levels, milling: Milling::Climb };
    let path = waterline.path(Surface::Field(&field, Against::Mesh), &profile, GO).unwrap();
    assert_eq!(path.passes(), 8, "eight levels of a millimetre");
    for span in path.spans.iter().filter(|span| span.kind == SpanKind::Pass) {
        let tips = &path.tips[span.points.clone()];
        let z = tips[0].z;
        if z < 1.0 {
            continue;
        }
        // It keeps off by the tolerance.
        let radius = (10.01_f64.powi(2) - (z + 2.0).powi(2)).sqrt();
        let mut turn = 0.0;
        for pair in tips.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|tip| tip.truncate() - middle);
            // The chords of the field's cells lie up to 1 µm within the dome.
            assert!((a.length() - radius).abs() < 0.012, "z {z}: {} for {radius}", a.length());
            assert_eq!(pair[0].z, z);
            turn += a.angle_to(b);
        }
        // The dome is to the right: clockwise.
        assert!((turn + std::f64::consts::TAU).abs() < 1e-6, "{turn}");
    }
}

#[test]
fn waterlines_never_come_closer_than_the_allowance_even_between_their_points() {
    let field = field(hills);
    for (profile, allowance_mm) in [
        (Profile::ball(1.5).unwrap(), 0.0),
        (Profile::flat(1.5).unwrap(), 0.2),
        (Profile::bull_nose(2.0, 0.5).unwrap(), 0.0),
    ] {
        let levels = Levels { allowance_mm, ..levels(&field, Entry::Ramp(0.1)) };
        let waterline = Waterline { levels, milling: Milling::Conventional };
        let path = waterline.path(Surface::Field(&field, Against::Mesh), &profile, GO).unwrap();
        assert!(path.passes() > 6);
        let moves = along_moves(&path);
        let places = moves.iter().map(|(tip, _)| tip.truncate()).collect();
        let least = least(&field, &profile, allowance_mm, places);
        for ((tip, kind), least) in moves.iter().zip(least) {
            assert!(tip.z >= least - 1e-6, "{kind:?} at {tip}: the surface allows {least}");
        }
    }
}

/// Replays a path of a flat in stock; the deepest bites from above and of moves, and what is left.
fn replay(path: &Toolpath, bounds: &Bounds, radius: f64) -> ([f64; 2], Vec<(DVec2, f64)>) {
    const CELL: f64 = 0.2;
    let size = (bounds.size().truncate() / CELL).floor();
    let (columns, rows) = (size.x as usize + 1, size.y as usize + 1);
    let mut stock = vec![bounds.max.z; columns * rows];
    let place = |i: usize, j: usize| bounds.min.truncate() + DVec2::new(i as f64, j as f64) * CELL;
    let mut bites = [0.0_f64; 2];
    for (tip, kind) in along_moves(path) {
        let at = (tip.truncate() - bounds.min.truncate()) / CELL;
        let reach = radius / CELL;
        let range = |at: f64, count: usize| {
            (at - reach).ceil().max(0.0) as usize
                ..((at + reach).floor() + 1.0).max(0.0).min(count as f64) as usize
        };
        for j in range(at.y, rows) {
            for i in range(at.x, columns) {
                let left = &mut stock[j * columns + i];
                if place(i, j).distance(tip.truncate()) <= radius && *left > tip.z {
                    let bite = &mut bites[usize::from(kind != SpanKind::Rapid)];
                    *bite = bite.max(*left - tip.z);
                    *left = tip.z;
                }
            }
        }
    }
    let left = (0..columns * rows).map(|k| (place(k % columns, k / columns), stock[k]));
    (bites, left.collect())
}

#[test]
fn roughing_leaves_the_allowance_and_steps_and_never_bites_deeper_than_a_step() {
    let field = field(hills);
    let (radius, surface) = (1.5, Surface::Field(&field, Against::Mesh));
    let profile = Profile::flat(radius).unwrap();
    for (style, entry) in
        [(RoughStyle::Zigzag, Entry::Ramp(0.1)), (RoughStyle::Offset, Entry::Helix(0.1))]
    {
        let levels = levels(&field, entry);
        let rough = Rough { levels, stepover_mm: 1.2, style, milling: Milling::Climb };
        let path = rough.path(surface, &profile, GO).unwrap();
        let moves = along_moves(&path);
        let places = moves.iter().map(|(tip, _)| tip.truncate()).collect();
        let least = least(&field, &profile, levels.allowance_mm, places);
        for ((tip, kind), least) in moves.iter().zip(least) {
            assert!(tip.z >= least - 1e-6, "{style:?}, {kind:?} at {tip}: {least} is allowed");
        }
        let ([plunge, bite], left) = replay(&path, &field.bounds(), radius);
        assert!(bite <= levels.step_mm + 0.02, "{style:?} bites {bite} mm");
        assert!(plunge <= 0.02, "{style:?} is lowered {plunge} mm into the stock");
        // Where the cutter can stand, the stock is cut down to the level above its lowest tip.
        let places: Vec<DVec2> = left.iter().map(|(at, _)| *at).collect();
        let apart = levels.allowance_mm + levels.tolerance_mm;
        let tips = self::least(&field, &profile, apart, places);
        let heights =
            heights(levels.top_mm, tips.iter().copied().fold(f64::INFINITY, f64::min), 1.0);
        let (mut worst, mut worst_at) = (0.0_f64, DVec2::ZERO);
        for ((at, left), tip) in left.iter().zip(&tips) {
            let due = heights.iter().copied().filter(|z| z >= tip).fold(levels.top_mm, f64::min);
            if left - due > worst {
                (worst, worst_at) = (left - due, *at);
            }
        }
        // Passes rise a little over what the grid does not see.
        assert!(worst < 0.02, "{style:?} leaves {worst} mm too much at {worst_at}");
    }
}

#[test]
fn a_boundary_is_kept_to() {
    let field = field(hills);
    let (profile, surface) = (Profile::flat(1.5).unwrap(), Surface::Field(&field, Against::Mesh));
    let [low, high] = [DVec2::new(10.3, 8.2), DVec2::new(27.7, 21.1)];
    let boundary = Polygon::rectangle(low, high).unwrap();
    let levels = Levels { boundary: Some(&boundary), ..levels(&field, Entry::Helix(0.1)) };
    let milling = Milling::Climb;
    let rough = |style| Rough { levels, stepover_mm: 1.2, style, milling };
    let paths = [
        rough(RoughStyle::Zigzag).path(surface, &profile, GO),
        rough(RoughStyle::Offset).path(surface, &profile, GO),
        Waterline { levels, milling }.path(surface, &profile, GO),
    ];
    for path in paths {
        let path = path.unwrap();
        assert!(path.passes() > 5);
        for tip in &path.tips {
            let at = tip.truncate();
            assert!(at.cmpge(low - 1e-6).all() && at.cmple(high + 1e-6).all(), "{at}");
        }
    }
}

#[test]
fn ways_down_are_no_steeper_than_asked_for() {
    let field = field(hills);
    let profile = Profile::flat(1.5).unwrap();
    for entry in [Entry::Ramp(0.1), Entry::Helix(0.1)] {
        let levels = levels(&field, entry);
        let rough =
            Rough { levels, stepover_mm: 1.2, style: RoughStyle::Zigzag, milling: Milling::Climb };
        let path = rough.path(Surface::Field(&field, Against::Mesh), &profile, GO).unwrap();
        let ways = path.spans.iter().filter(|span| span.kind == SpanKind::Plunge);
        let mut slanted = 0;
        for way in ways.filter(|way| way.points.len() > 2) {
            slanted += 1;
            for pair in path.tips[way.points.clone()].windows(2) {
                let run = pair[0].truncate().distance(pair[1].truncate());
                let fall = pair[0].z - pair[1].z;
                assert!(fall <= run * 0.1_f64.tan() + 1e-9, "{fall} mm down over {run} mm");
            }
        }
        assert!(slanted > 3, "{slanted}");
    }
}

#[test]
fn unreasonable_numbers_are_refused() {
    let field = field(hills);
    let profile = Profile::flat(1.5).unwrap();
    let path = |change: fn(&mut Levels)| {
        let mut levels = levels(&field, Entry::Plunge);
        change(&mut levels);
        let waterline = Waterline { levels, milling: Milling::Climb };
        waterline.path(Surface::Field(&field, Against::Mesh), &profile, GO).unwrap_err()
    };
    assert!(path(|levels| levels.pitch_mm = 1e-6).to_string().contains("nodes; the limit is 1e8"));
    assert!(path(|levels| levels.step_mm = 1e-9).to_string().contains("levels; the limit is"));
    assert!(matches!(path(|levels| levels.allowance_mm = -1.0), LevelError::Drop(_)));
}

#[test]
fn it_stops_when_told_to() {
    let field = field(hills);
    let waterline = Waterline { levels: levels(&field, Entry::Plunge), milling: Milling::Climb };
    let surface = Surface::Field(&field, Against::Mesh);
    let stopped = waterline.path(surface, &Profile::ball(1.5).unwrap(), &|_| false);
    assert_eq!(stopped, Err(LevelError::Drop(crate::DropError::Stopped)));
}

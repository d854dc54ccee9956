//! Writing a relief's program: 460,000 moves, three words or two in most blocks.
//! The goal is 60 ms a dialect.

use carvegraph_dialects::standard;
use carvegraph_sdk::{Command, Direction, Program, Units};

const ROWS: usize = 680;
const COLUMNS: usize = 676;

fn main() {
    divan::main();
}

/// A raster over a rolling surface, like the standard relief of 203 mm at 0.3 mm.
fn relief() -> Vec<Command> {
    let mut commands = vec![
        Command::Spindle { rpm: 12_000.0, direction: Direction::Clockwise },
        Command::Rapid { to: [0.0, 0.0, 5.0] },
    ];
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let column = if row % 2 == 0 { column } else { COLUMNS - 1 - column };
            let (x, y) = (column as f64 * 0.300_3, row as f64 * 0.298_7);
            let z = -2.5 + 2.5 * (0.11 * x).sin() * (0.07 * y).cos();
            commands.push(Command::Feed { to: [x, y, z], mm_per_min: 1200.0 });
        }
    }
    commands
}

/// One of each kind: the family's leanest, its inches, with block numbers, with a motion word in
/// each block, and the two languages of their own.
const DIALECTS: [(&str, Units); 6] = [
    ("grbl", Units::Mm),
    ("grbl", Units::Inch),
    ("siemens", Units::Mm),
    ("marlin", Units::Mm),
    ("heidenhain", Units::Mm),
    ("shopbot", Units::Mm),
];

#[divan::bench(args = DIALECTS)]
fn post(bencher: divan::Bencher<'_, '_>, (name, units): (&str, Units)) {
    let commands = relief();
    let dialects = standard();
    let Some(dialect) = dialects.iter().find(|d| d.name() == name) else {
        panic!("no dialect {name}");
    };
    let program = Program {
        title: "bench",
        units,
        path_tolerance_mm: 0.01,
        commands: &commands,
        ..Program::default()
    };
    bencher.counter(divan::counter::ItemsCount::new(commands.len())).bench(|| {
        let mut out = Vec::new();
        dialect.post(&program, &mut out).map(|()| out)
    });
}

//! Writing a relief's program: 500,000 moves, three words or two in most blocks, by each way that a
//! dialect comes into a program. The goal is a quarter of a second, and at most 1.3 times as long from
//! a library as by a direct call.

use carvegraph_dialects::{Standard, standard};
use carvegraph_host::{LoadError, Plugin};
use carvegraph_sdk::conformance::built_library;
use carvegraph_sdk::export::{Entry, entry};
use carvegraph_sdk::{Command, Dialect, Direction, Program, Units};

const ROWS: usize = 500;
const COLUMNS: usize = 1000;

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

/// By a call of the trait.
#[divan::bench(args = DIALECTS)]
fn direct(bencher: divan::Bencher<'_, '_>, of: (&str, Units)) {
    post(bencher, &standard(), of);
}

/// Through the C layout, linked as `carve` has it.
#[divan::bench(args = DIALECTS)]
fn linked(bencher: divan::Bencher<'_, '_>, of: (&str, Units)) {
    static ENTRY: Entry = entry::<Standard>();
    post(bencher, &plugin(carvegraph_host::linked(&ENTRY)), of);
}

/// Through the C layout, from a shared library.
#[divan::bench(args = DIALECTS)]
fn library(bencher: divan::Bencher<'_, '_>, of: (&str, Units)) {
    let library = built_library("carvegraph_dialects_plugin");
    post(bencher, &plugin(carvegraph_host::load(&library)), of);
}

fn plugin(loaded: Result<Plugin, LoadError>) -> Vec<Box<dyn Dialect>> {
    loaded.unwrap_or_else(|fault| panic!("{fault}")).dialects
}

fn post(
    bencher: divan::Bencher<'_, '_>,
    dialects: &[Box<dyn Dialect>],
    (name, units): (&str, Units),
) {
    let commands = relief();
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

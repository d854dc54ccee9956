//! The dialects that the tests hold, and how their controllers read.

#![allow(dead_code, reason = "each test uses a part")]
pub(crate) mod heidenhain;
pub(crate) mod shopbot;

use carvegraph_dialects::{Standard, standard};
use carvegraph_host::{linked, load};
use carvegraph_sdk::Dialect;
use carvegraph_sdk::conformance::built_library;
use carvegraph_sdk::conformance::dialect::{Arcs, Job, Reading};
use carvegraph_sdk::export::{Entry, entry};

/// All the dialects, by each way that they come into a program.
pub(crate) fn dialects() -> Vec<(&'static str, Vec<Box<dyn Dialect>>)> {
    static ENTRY: Entry = entry::<Standard>();
    vec![
        ("direct", standard()),
        ("linked", linked(&ENTRY).unwrap().dialects),
        ("library", load(&built_library("carvegraph_dialects_plugin")).unwrap().dialects),
    ]
}

/// Does something with each dialect, by each way.
pub(crate) fn each(mut f: impl FnMut(&dyn Dialect)) {
    for (way, dialects) in dialects() {
        eprintln!("dialects {way}");
        dialects.iter().for_each(|dialect| f(&**dialect));
    }
}

/// Does something with the dialect of a name, by each way; all must answer the same.
pub(crate) fn by_each_way<T: PartialEq + std::fmt::Debug>(
    name: &str,
    f: impl Fn(&dyn Dialect) -> T,
) -> T {
    let mut answers: Vec<(&str, T)> = Vec::new();
    for (way, dialects) in dialects() {
        let dialect = dialects.iter().find(|dialect| dialect.name() == name).unwrap();
        answers.push((way, f(&**dialect)));
    }
    assert!(answers.windows(2).all(|pair| pair[0].1 == pair[1].1), "{answers:?}");
    answers.swap_remove(0).1
}

/// The program that a dialect writes of a job, or why not.
pub(crate) fn posted(job: &Job, name: &str) -> Result<String, String> {
    by_each_way(name, |dialect| job.post(dialect).map_err(|error| error.to_string()))
}

/// The lines of that program.
pub(crate) fn blocks(job: &Job, name: &str) -> Vec<String> {
    posted(job, name).unwrap().lines().map(str::to_owned).collect()
}

/// How the controller of a standard dialect reads.
pub(crate) fn reading(dialect: &str) -> Reading {
    let usual = Reading {
        codes: Some(&[
            "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G21", "G43", "G90", "G94",
            "M3", "M4", "M5", "M6", "M30",
        ]),
        letters: "FGHIJKMPSTXYZ",
        marks: &["- ", "Carvegraph: "],
        length: &["G43"],
        ..Reading::default()
    };
    let xy_only = Arcs { xy_only: true, ..Arcs::default() };
    match dialect {
        "grbl" => Reading {
            codes: Some(&[
                "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G21", "G90", "G94",
                "M3", "M4", "M5", "M30",
            ]),
            letters: "FGIJKMPSXYZ",
            ..usual
        },
        "fluidnc" => Reading {
            codes: Some(&[
                "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G21", "G90", "G94",
                "M3", "M4", "M5", "M6", "M30",
            ]),
            letters: "FGIJKMPSTXYZ",
            line_limit: 255,
            length: &[],
            ..usual
        },
        "linuxcnc" => Reading {
            codes: Some(&[
                "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G21", "G40", "G43",
                "G64", "G80", "G90", "G91.1", "G94", "M2", "M3", "M4", "M5", "M6",
            ]),
            letters: "FGIJKMPQSTXYZ",
            line_limit: 255,
            arcs: Arcs { tolerance_mm: 0.028_2, ..Arcs::default() },
            end: "M2",
            ..usual
        },
        "mach3" => Reading {
            codes: Some(&[
                "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G21", "G40", "G43",
                "G49", "G64", "G80", "G90", "G91.1", "G94", "M3", "M4", "M5", "M6", "M30",
            ]),
            ..usual
        },
        "fanuc" => Reading {
            codes: Some(&[
                "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G21", "G40", "G43",
                "G80", "G90", "G94", "M3", "M4", "M5", "M6", "M30",
            ]),
            whole: "HPST",
            dwell: ('P', 1000.0),
            first: &["%", "O"],
            last: &["%"],
            harmful: "()!?~;$[]{}\\<>|^`%:#@&'\"_abcdefghijklmnopqrstuvwxyz",
            marks: &["- ", "CARVEGRAPH "],
            arcs: Arcs { sweep_limit_deg: 180.0, ..Arcs::default() },
            top: &["G91 G28 Z0.0"],
            length_with_z: true,
            starts_high: true,
            ..usual
        },
        "haas" => Reading {
            top: &["G53 G0 Z0.0"],
            // Smoothness: a level, not a time.
            ignored: &["G187 P3 E"],
            single_axis_rapids: true,
            ..reading("fanuc")
        },
        "siemens" => Reading {
            codes: Some(&[
                "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G40", "G90", "G94", "G700",
                "G710", "M3", "M4", "M5", "M6", "M30",
            ]),
            letters: "DFGIJKMSTXYZ",
            units: ["G710", "G700"],
            dwell: ('F', 1.0),
            line_limit: 512,
            first: &["; %_N_"],
            comment: ["; ", ""],
            numbered: Some(('N', 10)),
            ignored: &["CYCLE832("],
            length: &["D1"],
            ..usual
        },
        "marlin" => Reading {
            codes: Some(&["G0", "G1", "G2", "G3", "G4", "G20", "G21", "G90", "M3", "M4", "M5"]),
            letters: "FGIJMPSXYZ",
            whole: "PS",
            dwell: ('P', 1000.0),
            line_limit: 95,
            end: "M5",
            comment: ["; ", ""],
            modal: false,
            arcs: xy_only,
            ..usual
        },
        "uccnc" => Reading {
            codes: Some(&[
                "G0", "G1", "G2", "G3", "G4", "G17", "G20", "G21", "G40", "G43", "G80", "G90",
                "G91.1", "G94", "M3", "M4", "M5", "M6", "M30",
            ]),
            first: &["%"],
            harmful: "()!?~;$[]{}\\<>|^`%",
            arcs: xy_only,
            ..usual
        },
        "heidenhain" => Reading { read: Some(heidenhain::read), arcs: xy_only, ..usual },
        "shopbot" => Reading {
            read: Some(shopbot::read),
            arcs: Arcs { flat_only: true, sweep_limit_deg: 180.0, ..xy_only },
            // Thousandths of a mm and ten-thousandths of an inch a second.
            feed_steps: [0.06, 0.006],
            ..usual
        },
        "iso6983" => usual,
        _ => panic!("it is not known how {dialect} reads"),
    }
}

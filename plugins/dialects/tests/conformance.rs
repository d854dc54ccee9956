//! The suite that every dialect must pass finds what is wrong with one.

#![allow(clippy::unwrap_used, reason = "a failing helper fails its test")]

mod jobs;

use carvegraph_dialects::standard;
use carvegraph_sdk::conformance::dialect::check;
use carvegraph_sdk::{Capabilities, Dialect, PostError, Program};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A dialect whose programs somebody changes.
struct Changed {
    dialect: Box<dyn Dialect>,
    change: Change,
}

type Change = fn(String) -> String;

/// A dialect, a mistake, and words of the complaint about it.
type Mistake = (&'static str, Change, &'static str);

impl Dialect for Changed {
    fn name(&self) -> &str {
        self.dialect.name()
    }

    fn about(&self) -> &str {
        self.dialect.about()
    }

    fn extension(&self) -> &str {
        self.dialect.extension()
    }

    fn capabilities(&self) -> Capabilities {
        self.dialect.capabilities()
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn io::Write) -> Result<(), PostError> {
        let mut text = Vec::new();
        self.dialect.post(program, &mut text)?;
        let changed = (self.change)(String::from_utf8(text).unwrap());
        Ok(changed.as_bytes().chunks(4096).try_for_each(|piece| out.write_all(piece))?)
    }
}

/// What the suite says of a dialect after a change, if anything.
fn complaint(name: &str, change: Change) -> Option<String> {
    let dialect = standard().into_iter().find(|d| d.name() == name).unwrap();
    let changed = Changed { dialect, change };
    let checked = catch_unwind(AssertUnwindSafe(|| check(&changed, &jobs::reading(name))));
    checked.err().map(|panic| panic.downcast_ref::<String>().unwrap().clone())
}

#[test]
fn the_suite_finds_what_is_wrong() {
    let faults: [Mistake; 16] = [
        ("grbl", |t| t.replace("G2 ", "G3 "), "meant Arc"),
        ("grbl", |t| t.replace("G21", "G20"), "meant Rapid"),
        ("grbl", |t| t.replace("F900.0", "F90.0"), "meant Feed"),
        ("grbl", |t| t.replace("X11.0\n", ""), "meant Feed"),
        ("grbl", |t| t.replace("X11.0\n", "X11\n"), "with a point"),
        ("grbl", |t| t.replace("X11.0\n", "X11.00001\n"), "more than 3 decimals"),
        ("grbl", |t| t.replace("M30\n", ""), "does not end with M30"),
        ("grbl", |t| t.replace("M30\n", "M30\nG0 Z5.0\n"), "after the end"),
        ("grbl", |t| t.replace("M30\n", "G64\nM30\n"), "G64 is no word"),
        ("grbl", |t| t.replace("(- ", "("), "must begin with"),
        ("grbl", |t| t.replace("G4 P0.5", "G4 P500.0"), "no dwell is 0.5 s"),
        ("grbl", |t| format!("({})\n{t}", "x".repeat(90)), "92 characters"),
        ("linuxcnc", |t| t.replace("\nG43\n", "\n"), "length is not taken up"),
        ("fanuc", |t| t.replace("O0", "O9"), "program number"),
        ("siemens", |t| t.replace("N60", "N61"), "must begin with \"N60 \""),
        ("marlin", |t| t.replace("G1 X", "X"), "forgets its motion"),
    ];
    for (name, change, words) in faults {
        let complaint = complaint(name, change).unwrap_or_else(|| panic!("{name}: {words}"));
        assert!(complaint.contains(words), "{complaint}");
    }
    assert_eq!(complaint("grbl", |text| text), None);
}

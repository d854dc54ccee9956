//! One small job in every dialect, letter by letter. `CARVE_BLESS=1` rewrites the files.

#![allow(clippy::unwrap_used, reason = "a failing helper fails its test")]

mod jobs;

use carvegraph_dialects::standard;
use carvegraph_sdk::{Command, Units};
use std::path::Path;

fn check(file: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(file);
    if std::env::var_os("CARVE_BLESS").is_some() {
        std::fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    }
    let golden = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(golden, text, "{file} changed; CARVE_BLESS=1 accepts it");
}

#[test]
fn a_small_job_reads_as_before() {
    for dialect in standard() {
        let text = jobs::small().post(&*dialect).unwrap();
        check(&format!("small.{}.{}", dialect.name(), dialect.extension()), &text);
    }
}

#[test]
fn an_inch_job_with_two_tools_reads_as_before() {
    let mut job =
        jobs::Job { units: Units::Inch, title: "Two tools".to_owned(), ..jobs::Job::default() };
    for number in [1, 12] {
        job.commands.push(Command::ToolChange { number });
        job.commands.extend(
            jobs::small()
                .commands
                .into_iter()
                .filter(|c| !matches!(c, Command::Arc { .. } | Command::Comment { .. })),
        );
    }
    check("two_tools.linuxcnc.ngc", &job.post(&*jobs::dialect("linuxcnc")).unwrap());
}

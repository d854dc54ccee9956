//! One small job in every dialect, letter by letter. `CARVE_BLESS=1` rewrites the files.

#![allow(clippy::unwrap_used, reason = "a failing helper fails its test")]

mod jobs;

use carvegraph_sdk::Units;
use carvegraph_sdk::conformance::dialect::small;
use jobs::each;
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
    for (units, name) in [(Units::Mm, "small"), (Units::Inch, "small_inch")] {
        each(|dialect| {
            let mut job = small(dialect);
            job.units = units;
            let text = job.post(dialect).unwrap();
            check(&format!("{name}.{}.{}", dialect.name(), dialect.extension()), &text);
        });
    }
}

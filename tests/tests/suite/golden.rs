//! What a user reads, word for word. `CARVE_BLESS=1 cargo test -p carvegraph-tests golden` writes
//! the files in `tests/golden` anew; read the difference before it is committed.

use crate::bench::{Bench, recipe_text, with_diameter};
use std::path::Path;

/// Compares with a golden file, or writes it where that is asked for.
#[track_caller]
fn assert_golden(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(name);
    if std::env::var_os("CARVE_BLESS").is_some_and(|bless| bless == "1") {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        return;
    }
    let golden = std::fs::read_to_string(&path)
        .unwrap_or_else(|fault| panic!("{}: {fault}; CARVE_BLESS=1 writes it", path.display()));
    assert!(
        text == golden,
        "{name} differs; CARVE_BLESS=1 takes the new text\n--- golden\n{golden}\n--- now\n{text}"
    );
}

/// The standard error of a call that fails, called beside the recipe `mine.ron`.
#[track_caller]
fn assert_error(name: &str, arguments: &[&str], change: impl FnOnce(String) -> String) {
    let bench = Bench::new();
    bench.hills("hills.png", (20, 20));
    bench.picture("line.png", (30, 1), |x, _| x as u8);
    let whole = bench.read("hills.png");
    bench.write("cut.png", &whole[..whole.len() / 2]);
    bench.write(
        "mine.ron",
        change(recipe_text("relief").replace("samples/medallion.png", "hills.png")),
    );
    let answer = bench.carve(&[arguments, &["--quiet"]].concat());
    assert_ne!(answer.status, 0);
    assert_golden(
        &format!("{name}.txt"),
        &format!("{}exit status {}\n", answer.err, answer.status),
    );
}

#[test]
fn a_mistyped_recipe() {
    assert_error("mistyped-recipe", &["run", "releif"], |text| text);
}

#[test]
fn a_mistyped_parameter() {
    assert_error("mistyped-parameter", &["run", "mine.ron", "--set", "diamter=3"], |text| text);
}

#[test]
fn a_missing_picture() {
    let arguments = ["run", "mine.ron", "--set", "image=holiday.png"];
    assert_error("missing-picture", &arguments, |text| text);
}

#[test]
fn a_picture_cut_short() {
    assert_error("cut-picture", &["run", "mine.ron", "--set", "image=cut.png"], |text| text);
}

#[test]
fn a_picture_of_one_line() {
    assert_error("thin-picture", &["run", "mine.ron", "--set", "image=line.png"], |text| text);
}

#[test]
fn an_absurd_stepover() {
    assert_error("absurd-stepover", &["run", "mine.ron", "--set", "stepover=1e-9"], |text| text);
}

#[test]
fn a_loop() {
    assert_error("loop", &["run", "mine.ron"], |text| {
        text.replacen("{ \"image\": \"gray\" }", "{ \"image\": \"smooth\" }", 1)
    });
}

#[test]
fn a_name_twice() {
    assert_error("twice", &["run", "mine.ron"], |text| {
        text.replacen("\"points\": (kind", "\"gray\": (kind", 1)
    });
}

#[test]
fn five_slips_at_once() {
    assert_error("five-slips", &["run", "mine.ron"], |text| {
        with_diameter(&text, "-6.0")
            .replace("\"gaussian_blur\"", "\"gausian_blur\"")
            .replace("\"pattern\": \"passes\"", "\"pattern\": \"pases\"")
            .replacen("\"203mm\"", "\"203rpm\"", 1)
            .replace("\"format\": \"binary\"", "\"formt\": \"binary\"")
    });
}

#[test]
fn a_lost_bracket() {
    assert_error("lost-bracket", &["run", "mine.ron"], |text| {
        text.replacen("\"kernel\": 5 }),", "\"kernel\": 5 ),", 1)
    });
}

#[test]
fn the_summary_of_a_job() {
    let bench = Bench::new();
    bench.hills("hills.png", (50, 40));
    let settings = ["image=hills.png", "canvas_width=3cm", "stepover=0.7", "z_zero=bottom"];
    let set = settings.iter().flat_map(|setting| ["--set", setting]);
    bench.run(&["relief"].into_iter().chain(set).collect::<Vec<_>>());
    assert_golden("summary.txt", &bench.text("out/hills.txt"));
}

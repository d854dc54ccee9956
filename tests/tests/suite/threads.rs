//! The same bytes whatever the number of threads.

use crate::bench::Bench;
use std::collections::BTreeMap;

#[track_caller]
fn assert_same(bench: &Bench, settings: &[&str]) {
    let files = |threads: &str| -> BTreeMap<String, Vec<u8>> {
        let call = ["relief", "--threads", threads, "--out", threads];
        bench.run(&[&call[..], settings].concat());
        bench.files(threads)
    };
    let one = files("1");
    assert_eq!(one.len(), 8);
    for threads in ["2", "3"] {
        for (name, bytes) in files(threads) {
            assert!(bytes == one[&name], "{name} differs on {threads} threads");
        }
    }
}

#[test]
fn threads_do_not_show_on_points() {
    let bench = Bench::new();
    bench.hills("hills.png", (400, 300));
    assert_same(
        &bench,
        &["--set", "image=hills.png", "--set", "save_points=ply", "--set", "stepover=0.7"],
    );
}

#[test]
fn threads_do_not_show_on_a_mesh_with_chords() {
    let bench = Bench::new();
    bench.hills("hills.png", (120, 90));
    let sets = [
        "image=hills.png",
        "surface=mesh",
        "reduce=chord",
        "save_points=xyz",
        "save_mesh=ascii",
        "stepover=1",
    ];
    let sets = sets.iter().flat_map(|set| ["--set", set]).collect::<Vec<_>>();
    assert_same(&bench, &sets);
}

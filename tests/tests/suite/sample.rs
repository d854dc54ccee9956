//! The bundled sample is what its generator makes.

#[allow(dead_code, unreachable_pub, reason = "an example is a program of its own")]
#[path = "../../../nodes/examples/medallion.rs"]
mod medallion;

use crate::bench::workspace;

/// `sin` and `cos` may differ in their last bit between machines.
const LEVELS: u16 = 1;

#[test]
fn the_sample_is_what_its_generator_makes() {
    let shipped = image::open(workspace().join("graphs/samples/medallion.png")).unwrap();
    let shipped = shipped.as_luma16().expect("a gray picture of 16 bits").clone();
    let made = medallion::medallion(shipped.width());
    assert_eq!(made.dimensions(), shipped.dimensions());
    let off = made.iter().zip(shipped.iter()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(off <= Some(LEVELS), "off by {off:?} levels: run `cargo run --example medallion`");
}

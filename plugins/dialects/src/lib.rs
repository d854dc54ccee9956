//! The standard G-code dialects.
//!
//! A dialect has two halves. The `front` goes through a program, checks and rounds it and knows the
//! machine's state; a writer spells it. `rs274` is the writer of the whole word-address family, whose
//! members are data; `heidenhain` and `shopbot` have languages of their own.

mod arc;
mod block;
mod comment;
mod fanuc;
mod fluidnc;
mod front;
mod grbl;
mod haas;
mod heidenhain;
mod iso6983;
mod linuxcnc;
mod mach3;
mod marlin;
mod name;
mod number;
mod rs274;
mod shopbot;
mod siemens;
mod template;
mod uccnc;

use carvegraph_sdk::Dialect;
use rs274::Rs274;

/// The word-address family, sorted by name.
fn family() -> [&'static Rs274; 10] {
    [
        &fanuc::FANUC,
        &fluidnc::FLUIDNC,
        &grbl::GRBL,
        &haas::HAAS,
        &iso6983::ISO,
        &linuxcnc::LINUXCNC,
        &mach3::MACH3,
        &marlin::MARLIN,
        &siemens::SIEMENS,
        &uccnc::UCCNC,
    ]
}

/// All of them, sorted by name.
#[must_use]
pub fn standard() -> Vec<Box<dyn Dialect>> {
    let mut dialects: Vec<Box<dyn Dialect>> =
        vec![Box::new(heidenhain::Heidenhain), Box::new(shopbot::ShopBot)];
    for dialect in family() {
        dialects.push(Box::new(*dialect));
    }
    dialects.sort_by(|a, b| a.name().cmp(b.name()));
    dialects
}

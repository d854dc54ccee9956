//! The standard G-code dialects.
//!
//! A dialect has two halves. The `front` goes through a program, checks and rounds it and knows the
//! machine's state; a writer spells it. `rs274` is the writer of the whole word-address family, whose
//! members are data; `heidenhain` and `shopbot` have languages of their own. So a member may also come
//! from a file: [`from_file`] reads one, [`starter`] begins one.

mod arc;
mod block;
mod comment;
mod fanuc;
mod file;
mod fluidnc;
mod front;
mod grbl;
mod haas;
mod heidenhain;
mod iso6983;
mod lines;
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
mod words;

use carvegraph_sdk::Dialect;
pub use file::{DialectFile, FORMAT, from_file, starter};
use rs274::Rs274;
use std::borrow::Cow;

/// A text of a dialect: ours are in the program, a user's come from a file.
type Text = Cow<'static, str>;

/// The word-address family, sorted by name.
fn family() -> [Rs274; 10] {
    [
        fanuc::settings(),
        fluidnc::settings(),
        grbl::settings(),
        haas::settings(),
        iso6983::settings(),
        linuxcnc::settings(),
        mach3::settings(),
        marlin::settings(),
        siemens::settings(),
        uccnc::settings(),
    ]
}

/// All of them, sorted by name.
#[must_use]
pub fn standard() -> Vec<Box<dyn Dialect>> {
    let mut dialects: Vec<Box<dyn Dialect>> =
        vec![Box::new(heidenhain::Heidenhain), Box::new(shopbot::ShopBot)];
    for dialect in family() {
        dialects.push(Box::new(dialect));
    }
    dialects.sort_by(|a, b| a.name().cmp(b.name()));
    dialects
}

carvegraph_sdk::plugin!(
    /// The standard dialects as a plugin like anybody's: `carve` links it, and `shared` beside this
    /// crate exports it from a library.
    Standard,
    carvegraph_sdk::export::Offers::new().dialects(standard())
);

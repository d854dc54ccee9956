//! Drop cutter: lowers a cutter along −Z until it first touches a surface.
//!
//! At each place of a pattern the height of the tip is the greatest of z − h(r) over the surface
//! under the cutter, h the cutter's [`Profile`], r the distance from its axis. Sources: the "ball
//! drop" of Sood (thesis 2015, chapter 4), and the vertex, facet and edge tests that are the field's
//! standard, in the formulation of OpenCAMLib by A. Wallin.
//!
//! # Method
//! 1. A pyramid of greatest heights over the field ([`pyramid`]), built once.
//! 2. The node touched at the neighbouring place, or the one as far along, and all around it give a height
//!    that this place surely reaches.
//! 3. Branch and bound ([`search`]): blocks that lie below the cutter even so are left out, four
//!    tested at a time by quick [`gauge`]s. Against a mesh it matters what may [`bulge`] between nodes.
//! 4. What remains is tested exactly ([`around_node`]), in closed form for balls and flats, by pieces for
//!    any other profile ([`general`], [`layer`], [`rising`]). The shape is read off the profile's
//!    segments, never from a name.
//!
//! Either index serves one cutter and any number of patterns ([`DropCutter`], in [`prepared`]).
//!
//! Meshes and points that lie anywhere ([`on_mesh`]) go the same way: [`boxes`] with tilted [`lids`] take
//! the place of the pyramid, and [`facet`] that of the six triangles, over the same closed forms. Of the
//! boxes the one likeliest to be touched is looked at first.
//!
//! # Limits
//! * Exact to rounding: 1e-9 mm for balls and flats, 1e-6 mm and mostly far better for others.
//! * A field has one height at each node: what has overhangs is a mesh.
//! * Exact at the places of the pattern. Between two of them, e apart, a straight path runs below that of
//!   the cutter by what the cutter's profile sags below its chord: for a ball e²/8R on level ground,
//!   e²/(8R·cos³θ), nearly, on a slope of angle θ, and without bound at a wall. [`DropCutter::bend`] puts
//!   places in until it is less than a tolerance.
//! * Where a cutter lies on a great part of a surface that has its own shape (a ball in a bowl of
//!   its radius), nothing can be left out and the time per location grows with the shadow.

mod around_node;
mod ball;
mod best;
mod between;
mod boxes;
mod bulge;
mod cell;
mod edge;
mod facet;
mod flat;
mod gauge;
mod general;
mod layer;
mod lids;
mod on_height_field;
mod on_mesh;
mod places;
mod prepared;
mod probes;
mod pyramid;
mod rising;
mod search;
mod shape;
mod swept;

#[cfg(doc)]
use crate::Profile;
pub use on_height_field::{Against, drop_on_height_field};
pub use on_mesh::{DropError, drop_on_mesh, drop_on_points};
pub use prepared::{DropCutter, Surface};
pub(crate) use shape::ShapeKind;
pub(crate) use swept::Swept;

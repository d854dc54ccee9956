//! What passes between nodes, as a plugin sees it.
//!
//! Each standard port type is a struct here. Its big arrays are borrowed where the other side's layout
//! allows it, so that a surface of 10,000 × 10,000 heights is not copied on its way in. [`PortValue`]
//! turns each into a [`Raw`] and back; `carvegraph.h` lists the arrays of every type.
//!
//! Frame: right-handed, millimetres, Z up; the controlled point of a cutter is its tip.
//!
//! What comes from `carve` is well-formed and finite. What goes to `carve` is checked there once more:
//! numbers that are not finite are refused, and so is what no node of the program could make.

mod error;
mod fields;
mod path;
mod picture;
mod program;
mod raw;
mod surface;
#[cfg(test)]
mod tests;
mod tool;

pub use carvegraph_geometry::{
    Bounds, Contact, ContactKind, Cutter, DVec2, DVec3, Feeds, PatternSpan, Reduction, Span,
    SpanKind,
};
pub use error::ValueError;
pub use path::{Pattern, Toolpath};
pub use picture::{Channels, GrayImage, Image, Samples};
pub use program::{Gcode, Remark};
pub use raw::{Elements, Raw, RawArray};
pub use surface::{HeightField, Mesh, PointCloud};

/// A standard port type as a plugin sees it.
pub trait PortValue<'a>: Sized {
    /// Its name in definitions of ports.
    const TYPE: &'static str;

    /// The value as it crosses. Nothing big is copied.
    fn into_raw(self) -> Raw<'a>;

    /// The value that has crossed. Arrays that `raw` owns are taken over where their layout allows it.
    ///
    /// # Errors
    /// If `raw` is of another type, its arrays are not those of this type, or do not go together.
    fn read(raw: Raw<'a>) -> Result<Self, ValueError>;

    /// The value that has crossed, borrowed.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    fn from_raw(raw: &'a Raw<'_>) -> Result<Self, ValueError> {
        Self::read(raw.view())
    }
}

macro_rules! types {
    ($($value:ident),*) => {
        /// The names of all port types, sorted.
        pub const TYPES: &[&str] = &[$(<$value as PortValue>::TYPE),*];

        /// Whether `raw` is a well-formed value of its type.
        ///
        /// # Errors
        /// If its type is unknown, its arrays are not those of the type, or do not go together.
        pub fn check(raw: &Raw<'_>) -> Result<(), ValueError> {
            match raw.type_name.as_ref() {
                $(<$value as PortValue>::TYPE => $value::from_raw(raw).map(drop),)*
                _ => Err(ValueError::unknown_type(&raw.type_name)),
            }
        }
    };
}

types!(
    Bounds,
    Cutter,
    Gcode,
    GrayImage,
    HeightField,
    Image,
    Mesh,
    Pattern,
    PointCloud,
    Reduction,
    Remark,
    Toolpath
);

/// Whether `raw` says that it is of type `wanted`.
///
/// # Errors
/// If it says something else.
pub fn check_type(raw: &Raw<'_>, wanted: &'static str) -> Result<(), ValueError> {
    if raw.type_name == wanted {
        return Ok(());
    }
    Err(ValueError::Type { wanted, given: error::shown(&raw.type_name) })
}

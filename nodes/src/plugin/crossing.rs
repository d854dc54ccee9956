//! How a value crosses between the program and a plugin.

use crate::path::MAX_POINTS;
use crate::picture::MAX_PIXELS;
use crate::values::{Gcode, GrayImage, Image, Remark};
use carvegraph_core::{InputValues, PortSpec, Value};
use carvegraph_geometry::{
    Bounds, Cutter, HeightField, HeightFieldError, Mesh, Pattern, PointCloud, Reduction, Toolpath,
};
use carvegraph_sdk::node::Port;
use carvegraph_sdk::value::{PortValue, Raw, ValueError};
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// A type of the program's that plugins know.
pub(super) trait Crosses: Any + Send + Sync + Sized {
    /// How a plugin sees it.
    type Seen<'a>: PortValue<'a>;

    /// This value as a plugin sees it, big arrays borrowed where the layout allows it.
    fn seen(&self) -> Self::Seen<'_>;

    /// Why a plugin cannot be shown this value, if so.
    fn kept_back(&self) -> Option<String> {
        None
    }

    /// The value that a plugin made, if it is one.
    fn taken(made: Self::Seen<'static>) -> Result<Self, OutputFault>;
}

/// How the values of one type cross.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    /// The type's name.
    pub(super) type_name: &'static str,
    port: fn(&Port) -> PortSpec,
    give: Give,
    take: fn(Raw<'static>) -> Result<Value, OutputFault>,
}

type Give = for<'a> fn(&'a InputValues, &str) -> Given<'a>;

/// What stands at an input, if it is connected, or why a plugin cannot be shown it.
type Given<'a> = Result<Option<Raw<'a>>, String>;

/// Every type of the [registry](crate::registry()).
pub(super) const CROSSINGS: &[Crossing] = &[
    Crossing::new::<Bounds>(),
    Crossing::new::<Cutter>(),
    Crossing::new::<Gcode>(),
    Crossing::new::<GrayImage>(),
    Crossing::new::<HeightField>(),
    Crossing::new::<Image>(),
    Crossing::new::<Mesh>(),
    Crossing::new::<Pattern>(),
    Crossing::new::<PointCloud>(),
    Crossing::new::<Reduction>(),
    Crossing::new::<Remark>(),
    Crossing::new::<Toolpath>(),
];

impl Crossing {
    const fn new<T: Crosses>() -> Self {
        Self {
            type_name: <T::Seen<'static> as PortValue<'static>>::TYPE,
            port: |port| PortSpec::of::<T>(port.name, port.about, port.optional),
            give: give::<T>,
            take: take::<T>,
        }
    }

    /// That of the values at `port`.
    pub(super) fn of(port: &Port) -> Option<Self> {
        CROSSINGS.iter().find(|crossing| crossing.type_name == port.type_name).copied()
    }

    /// The port as the engine knows it.
    pub(super) fn port(&self, port: &Port) -> PortSpec {
        (self.port)(port)
    }

    /// What stands at an input, if it is connected.
    ///
    /// # Errors
    /// If it cannot be shown to a plugin.
    pub(super) fn give<'a>(&self, inputs: &'a InputValues, port: &str) -> Given<'a> {
        (self.give)(inputs, port)
    }

    /// What a plugin made, if it is a value of this type.
    pub(super) fn take(&self, made: Raw<'static>) -> Result<Value, OutputFault> {
        (self.take)(made)
    }
}

fn give<'a, T: Crosses>(inputs: &'a InputValues, port: &str) -> Given<'a> {
    let given = inputs.optional::<T>(port);
    match given.and_then(T::kept_back) {
        Some(why) => Err(why),
        None => Ok(given.map(|value| value.seen().into_raw())),
    }
}

fn take<T: Crosses>(made: Raw<'static>) -> Result<Value, OutputFault> {
    Ok(Arc::new(T::taken(PortValue::read(made)?)?))
}

/// What is wrong with what a plugin made.
#[derive(Debug, thiserror::Error, PartialEq)]
pub(super) enum OutputFault {
    /// It is malformed.
    #[error(transparent)]
    Value(#[from] ValueError),
    /// It is no surface.
    #[error(transparent)]
    Field(#[from] HeightFieldError),
    /// A number that must be finite is not.
    #[error("{what} {place} is {value}; it must be finite")]
    NotFinite {
        /// What the number belongs to, such as "point".
        what: &'static str,
        /// Which one, from 0.
        place: usize,
        /// It, or the point that it is part of.
        value: String,
    },
    /// Larger than anything that the program makes.
    #[error("it has {count} {what}; the limit is {limit}")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A picture without pixels.
    #[error("it is {width} × {height} pixels; a picture has one at least")]
    NoPixels {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
    },
    /// A box whose corners are the wrong way round.
    #[error("it reaches from {min} to {max}; give the corner with the lesser coordinates first")]
    Inverted {
        /// The corner that should be the lesser.
        min: String,
        /// The other.
        max: String,
    },
    /// A speed or a measure that is none.
    #[error("its {what} is {value}; it must be {wanted}")]
    Measure {
        /// What it measures.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it must be.
        wanted: &'static str,
    },
    /// A word that cannot be shown or be part of a file's name.
    #[error("its {what} is {text:?}; it must be {wanted}")]
    Word {
        /// What it is for.
        what: &'static str,
        /// What it is.
        text: String,
        /// What it must be.
        wanted: &'static str,
    },
}

/// Nodes of the grids of surfaces and clouds, and pixels: as many as a picture may have.
pub(super) const MAX_NODES: usize = MAX_PIXELS as usize;

/// Cutter locations: as many as a raster may have.
pub(super) const MAX_CL_POINTS: usize = MAX_POINTS as usize;

/// Whether there are not too many of something.
pub(super) fn check_count(
    what: &'static str,
    count: usize,
    limit: usize,
) -> Result<(), OutputFault> {
    if count <= limit { Ok(()) } else { Err(OutputFault::TooMany { what, count, limit }) }
}

/// Whether all numbers of some tuples are finite. `what` names one tuple.
pub(super) fn check_finite<const N: usize>(
    what: &'static str,
    tuples: &[[f64; N]],
) -> Result<(), OutputFault> {
    let is_finite = |tuple: &[f64; N]| tuple.iter().all(|number| number.is_finite());
    match tuples.iter().position(|tuple| !is_finite(tuple)) {
        None => Ok(()),
        Some(place) => Err(not_finite(what, place, format!("{:?}", tuples[place]))),
    }
}

pub(super) fn not_finite(
    what: &'static str,
    place: usize,
    value: impl fmt::Display,
) -> OutputFault {
    OutputFault::NotFinite { what, place, value: value.to_string() }
}

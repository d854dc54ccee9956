//! The parameters of the nodes that place things, stated once for meshes and points.

use carvegraph_core::Choice;
use carvegraph_geometry::{Axis, Datum, HeightDatum};

/// Which axis is turned round.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Mirror {
    /// None: it stays as it is.
    None,
    /// Left and right are exchanged.
    X,
    /// Near and far are exchanged.
    Y,
    /// Up and down are exchanged.
    Z,
}

impl Mirror {
    pub(super) fn axis(self) -> Option<Axis> {
        match self {
            Self::None => None,
            Self::X => Some(Axis::X),
            Self::Y => Some(Axis::Y),
            Self::Z => Some(Axis::Z),
        }
    }
}

/// What of a part lies at x = 0, y = 0.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Place {
    /// What lay there before.
    Keep,
    /// The near left corner of its box.
    Corner,
    /// The middle of its box.
    Center,
}

impl Place {
    pub(super) fn datum(self) -> Datum {
        match self {
            Self::Keep => Datum::Keep,
            Self::Corner => Datum::Corner,
            Self::Center => Datum::Center,
        }
    }
}

/// What of a part lies at z = 0.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum HeightPlace {
    /// What lay there before.
    Keep,
    /// Its lowest point.
    Bottom,
    /// Its highest point.
    Top,
}

impl HeightPlace {
    pub(super) fn datum(self) -> HeightDatum {
        match self {
            Self::Keep => HeightDatum::Keep,
            Self::Bottom => HeightDatum::Bottom,
            Self::Top => HeightDatum::Top,
        }
    }
}

/// A node's struct with the parameters of a [`Placing`](carvegraph_geometry::Placing), and the way to
/// one.
macro_rules! placing_params {
    ($(#[$about:meta])* $name:ident) => {
        $(#[$about])*
        #[derive(Clone, Debug, carvegraph_core::Params)]
        pub(crate) struct $name {
            /// What is exchanged first of all.
            #[param(default = crate::surface::placing::Mirror::None)]
            pub(crate) mirror: crate::surface::placing::Mirror,
            /// Turn about the x axis, counter-clockwise seen from its end; then y, then z.
            #[param(unit = "deg", default = 0.0, range = -360.0..=360.0)]
            pub(crate) turn_x: f64,
            /// Turn about the y axis.
            #[param(unit = "deg", default = 0.0, range = -360.0..=360.0)]
            pub(crate) turn_y: f64,
            /// Turn about the z axis.
            #[param(unit = "deg", default = 0.0, range = -360.0..=360.0)]
            pub(crate) turn_z: f64,
            /// Size after turning, all ways.
            #[param(unit = "%", default = 100.0, range = 0.0001..=1_000_000.0)]
            pub(crate) scale: f64,
            /// Height besides, to make a relief flatter or deeper.
            #[param(unit = "%", default = 100.0, range = 0.0001..=1_000_000.0)]
            pub(crate) scale_z: f64,
            /// Width (x) to fill as far as proportions allow; 0 is any.
            #[param(unit = "mm", default = 0.0, range = 0.0..=100_000.0)]
            pub(crate) fit_x: f64,
            /// Depth (y) to fill; 0 is any.
            #[param(unit = "mm", default = 0.0, range = 0.0..=100_000.0)]
            pub(crate) fit_y: f64,
            /// Height (z) to fill; 0 is any.
            #[param(unit = "mm", default = 0.0, range = 0.0..=100_000.0)]
            pub(crate) fit_z: f64,
            /// What is moved to x = 0, y = 0.
            #[param(default = crate::surface::placing::Place::Keep)]
            pub(crate) place: crate::surface::placing::Place,
            /// What is moved to z = 0.
            #[param(default = crate::surface::placing::HeightPlace::Keep)]
            pub(crate) z_place: crate::surface::placing::HeightPlace,
            /// Shift to the right, last of all.
            #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
            pub(crate) shift_x: f64,
            /// Shift away.
            #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
            pub(crate) shift_y: f64,
            /// Shift up.
            #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
            pub(crate) shift_z: f64,
        }

        impl $name {
            /// What the kernel is told.
            fn placing(&self) -> carvegraph_geometry::Placing {
                use carvegraph_geometry::{DVec3, Placing};
                let any = |length: f64| if length == 0.0 { f64::INFINITY } else { length };
                let scale = self.scale / 100.0;
                Placing {
                    mirror: self.mirror.axis(),
                    turns_deg: DVec3::new(self.turn_x, self.turn_y, self.turn_z),
                    scale: DVec3::new(scale, scale, scale * self.scale_z / 100.0),
                    fit: Some(DVec3::new(any(self.fit_x), any(self.fit_y), any(self.fit_z))),
                    datum: self.place.datum(),
                    height_datum: self.z_place.datum(),
                    shift: DVec3::new(self.shift_x, self.shift_y, self.shift_z),
                }
            }
        }

        #[cfg(test)]
        impl $name {
            /// One that changes nothing.
            fn neutral() -> Self {
                use crate::surface::placing::{HeightPlace, Mirror, Place};
                Self {
                    mirror: Mirror::None,
                    turn_x: 0.0,
                    turn_y: 0.0,
                    turn_z: 0.0,
                    scale: 100.0,
                    scale_z: 100.0,
                    fit_x: 0.0,
                    fit_y: 0.0,
                    fit_z: 0.0,
                    place: Place::Keep,
                    z_place: HeightPlace::Keep,
                    shift_x: 0.0,
                    shift_y: 0.0,
                    shift_z: 0.0,
                }
            }
        }
    };
}

pub(super) use placing_params;
